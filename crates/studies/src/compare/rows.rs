//! Quantity by quantity: what it is compared with, and how far off it may be.

use lennard_literature::{
    EquationOfState, GOOD_TAIL_CUTOFF, ModelKind, TransportProperty, equation_of_state_for,
    transport_near,
};

use super::read::HALF_STEPS;
use super::verdict::Tolerance;
use super::{Row, RunFolder, StateOfMatter, Verdict};

/// Energy and pressure: what the equation of state may itself be off by.
const ENERGY: Tolerance = Tolerance {
    errors: 4.0,
    absolute: 0.003,
    relative: 0.0,
};
const PRESSURE: Tolerance = Tolerance {
    errors: 4.0,
    absolute: 0.005,
    relative: 0.0,
};
/// Heat capacity and transport coefficients.
const HEAT_CAPACITY: Tolerance = Tolerance {
    errors: 2.0,
    absolute: 0.0,
    relative: 0.02,
};
const TRANSPORT: Tolerance = Tolerance {
    errors: 2.0,
    absolute: 0.0,
    relative: 0.03,
};
/// Configurational against kinetic temperature: with a finite step stiff directions make the first some 0.1 % higher
/// than the temperature of half steps, and the jump of the force at the cutoff is counted with g(r_cut) = 1.
const TEMPERATURES: Tolerance = Tolerance {
    errors: 4.0,
    absolute: 0.0,
    relative: 0.005,
};

/// A variance from fewer independent samples than this has an error bar that is itself unsure by a fifth and
/// more, and is skewed.
const FEW_FLUCTUATIONS: f64 = 100.0;

/// Height of the main peak of S(k) at freezing.
const HANSEN_VERLET: f64 = 2.85;
const HANSEN_VERLET_SOURCE: &str =
    "J.-P. Hansen and L. Verlet, Phys. Rev. 184, 151 (1969), doi:10.1103/PhysRev.184.151";

/// All rows of a run, in the order of a table.
pub(super) fn all(run: &RunFolder, state: &StateOfMatter, model: ModelKind) -> Vec<Row> {
    let equation = equation_of_state_for(model).ok();
    let mut rows = Vec::new();
    rows.extend(measured(run, "temperature"));
    rows.extend(measured(run, HALF_STEPS));
    rows.extend(energy_or_pressure(
        run,
        "potential_energy",
        ENERGY,
        model,
        equation,
    ));
    rows.extend(energy_or_pressure(
        run, "pressure", PRESSURE, model, equation,
    ));
    rows.extend(heat_capacity(run, state, model, equation));
    rows.extend(configurational_temperature(run));
    rows.extend(diffusion(run, state, model));
    for (name, property) in [
        ("shear_viscosity", TransportProperty::ShearViscosity),
        (
            "thermal_conductivity",
            TransportProperty::ThermalConductivity,
        ),
    ] {
        rows.extend(transport(run, state, model, name, property));
        rows.extend(cross_check(run, name));
    }
    rows.extend(structure(run));
    if !state.is_single_stable_phase() {
        for row in rows
            .iter_mut()
            .filter(|r| r.quantity != "configurational_temperature")
        {
            if matches!(
                row.verdict,
                Verdict::Agrees | Verdict::Differs | Verdict::Biased
            ) {
                row.verdict = Verdict::NotJudged;
                *row = row.clone().noted(format!("the state is {}", state.words));
            }
        }
    }
    rows
}

fn measured(run: &RunFolder, name: &str) -> Option<Row> {
    let average = run.average(name)?;
    Some(Row::measured(
        name,
        &average.unit,
        average.mean,
        average.standard_error,
    ))
}

/// U or P beside the equation of state for as many particles. The error of the difference is that which the run itself
/// has found: it needs the whole series.
fn energy_or_pressure(
    run: &RunFolder,
    name: &str,
    tolerance: Tolerance,
    model: ModelKind,
    equation: Option<&dyn EquationOfState>,
) -> Option<Row> {
    let row = measured(run, name)?;
    let compared = run.record.comparison.iter().find(|c| c.quantity == name);
    let (Some(compared), Some(equation)) = (compared, equation) else {
        return Some(row);
    };
    let (density, temperature) = (compared.at.density, compared.at.temperature);
    let atoms = run.record.atoms as usize;
    let state = equation.at(density, temperature);
    let shift = lennard_engine::finite_size(&run.scene, equation, density, temperature, atoms);
    let (infinite, shift) = if name == "pressure" {
        (state.pressure, shift.map(|s| s.pressure))
    } else {
        (state.potential_energy, shift.map(|s| s.potential_energy))
    };
    let mut row = row
        .against(
            infinite + shift.unwrap_or(0.0),
            None,
            compared.standard_error,
            tolerance,
            &compared.source,
        )
        .noted(shift.map_or(
            "for an infinite system: there is no finite-size correction of first order in this state".into(),
            |s| format!("for {atoms} particles in a closed box: {s:+.5} beside an infinite system"),
        ));
    row.reference_error = compared.reference_uncertainty;
    Some(biased_by_cutoff(row, model))
}

/// What differs where the tail stands for too much of the potential is biased by that: the tail is a constant, and takes
/// g(r) = 1 (c_v lacks its share of the fluctuations, most of all near the critical point).
fn biased_by_cutoff(mut row: Row, model: ModelKind) -> Row {
    if let ModelKind::CutWithTail { r_cut } = model
        && r_cut < GOOD_TAIL_CUTOFF
        && row.verdict == Verdict::Differs
    {
        row.verdict = Verdict::Biased;
        row = row.noted(format!("judge at r_cut ≥ {GOOD_TAIL_CUTOFF} σ"));
    }
    row
}

fn heat_capacity(
    run: &RunFolder,
    state: &StateOfMatter,
    model: ModelKind,
    equation: Option<&dyn EquationOfState>,
) -> Option<Row> {
    let row = measured(run, "heat_capacity")?;
    let how = run
        .record
        .remarks
        .iter()
        .find_map(|r| r.strip_prefix("heat_capacity: "))
        .unwrap_or_default();
    let row = row.noted(how);
    let Some(equation) = equation.filter(|e| e.check(state.density, state.temperature).is_ok())
    else {
        return Some(row);
    };
    let reference = equation.heat_capacity_volume(state.density, state.temperature);
    let error = row.standard_error;
    let row = row.against(reference, None, error, HEAT_CAPACITY, &source(equation));
    let mut row = biased_by_cutoff(row, model);
    let independent = run.average("heat_capacity").map_or(0.0, |a| a.n_effective);
    if independent < FEW_FLUCTUATIONS {
        row.verdict = Verdict::NotJudged;
        row = row.noted(format!(
            "only {independent:.0} independent samples of the fluctuations: too few to judge"
        ));
    }
    Some(row)
}

fn source(equation: &dyn EquationOfState) -> String {
    format!("{}, doi:{}", equation.spec().name, equation.spec().doi)
}

fn configurational_temperature(run: &RunFolder) -> Option<Row> {
    let kinetic = run.temperature()?;
    let row = measured(run, "configurational_temperature")?;
    let error = row.standard_error;
    Some(row.against(
        kinetic.mean,
        Some(kinetic.standard_error),
        error,
        TEMPERATURES,
        "the kinetic temperature of the same run (of half steps where the method has them)",
    ))
}

/// The tables of transport coefficients are those of the full potential: for which models they are a reference, and
/// why not for others.
fn full_potential(model: ModelKind) -> Result<(), String> {
    match model {
        ModelKind::CutWithTail { .. } | ModelKind::CutWithoutTail { .. } => Ok(()),
        _ => Err("the tables of transport coefficients are for the full Lennard-Jones potential, this model is another: not compared".into()),
    }
}

/// The finite-size correction ξT/(6πηL) of D in a cubic box, ξ = 2.837297, with the viscosity of the run itself, in σ²/τ
/// (I.-C. Yeh and G. Hummer, J. Phys. Chem. B 108, 15873 (2004), equation 12); `None` where the run has no viscosity
/// or the box is no cube.
fn own_correction(run: &RunFolder, state: &StateOfMatter) -> Option<f64> {
    const XI: f64 = 2.837_297;
    let side = run.shortest_side;
    let volume = run.record.atoms as f64 / run.density;
    // Roundings of the cube of a length.
    let is_cube = (side.powi(3) / volume - 1.0).abs() < 1e-9;
    let viscosity = run.average("shear_viscosity")?.mean;
    is_cube.then(|| XI * state.temperature / (6.0 * std::f64::consts::PI * viscosity * side))
}

fn diffusion(run: &RunFolder, state: &StateOfMatter, model: ModelKind) -> Option<Row> {
    let corrected = run.average("diffusion_coefficient")?;
    let plain = run.average("diffusion_coefficient_uncorrected");
    let row = measured(run, "diffusion_coefficient")?;
    let row = match plain {
        Some(plain) => row.noted(format!(
            "corrected for finite size after Yeh and Hummer by +{:.4}, {:.4} before",
            corrected.mean - plain.mean,
            plain.mean
        )),
        None => row.noted("not corrected for finite size"),
    };
    if let Err(why) = full_potential(model) {
        return Some(row.noted(why));
    }
    let Some(value) = transport_near(
        TransportProperty::SelfDiffusion,
        state.density,
        state.temperature,
    ) else {
        return Some(row.noted("no tabulated state is near"));
    };
    let error = row.standard_error;
    let mut row = row
        .against(
            value.value,
            value.uncertainty,
            error,
            TRANSPORT,
            &value.source,
        )
        .noted(value.state_words());
    // A source that does not say whether it corrected for finite size lies between the two.
    let between = match plain {
        Some(plain) => Some((plain.mean, corrected.mean)),
        None => own_correction(run, state).map(|added| (corrected.mean, corrected.mean + added)),
    };
    if let Some((low, high)) = between {
        row = row.between(low, high).noted(format!(
            "the source does not say that it is corrected: the difference is that from the stretch between the uncorrected and the corrected value, {low:.4} to {high:.4}"
        ));
    }
    Some(row)
}

fn transport(
    run: &RunFolder,
    state: &StateOfMatter,
    model: ModelKind,
    name: &str,
    property: TransportProperty,
) -> Option<Row> {
    let row = measured(run, name)?;
    if let Err(why) = full_potential(model) {
        return Some(row.noted(why));
    }
    let Some(value) = transport_near(property, state.density, state.temperature) else {
        return Some(row.noted("no tabulated state is near"));
    };
    let error = row.standard_error;
    Some(
        row.against(
            value.value,
            value.uncertainty,
            error,
            TRANSPORT,
            &value.source,
        )
        .noted(value.state_words()),
    )
}

/// Einstein–Helfand beside Green–Kubo: the same fluctuations by another road, so that their errors do not add up.
fn cross_check(run: &RunFolder, name: &str) -> Option<Row> {
    let green_kubo = run.average(name)?;
    let row = measured(run, &format!("{name}_einstein_helfand"))?;
    let error = row.standard_error.max(green_kubo.standard_error);
    Some(row.against(
        green_kubo.mean,
        None,
        error,
        TRANSPORT,
        "Green–Kubo from the same run",
    ))
}

fn structure(run: &RunFolder) -> Vec<Row> {
    let mut rows = Vec::new();
    rows.extend(measured(run, "rdf_first_peak"));
    rows.extend(measured(run, "coordination_number"));
    if let Some(row) = measured(run, "structure_factor_first_peak") {
        let mut row = row;
        row.reference = Some(HANSEN_VERLET);
        row.difference = Some(row.measured - HANSEN_VERLET);
        row.verdict = Verdict::NotJudged;
        row.source = HANSEN_VERLET_SOURCE.into();
        let side = if row.measured < HANSEN_VERLET {
            "below"
        } else {
            "above"
        };
        rows.push(row.noted(format!("{side} the height at which the fluid freezes")));
    }
    rows
}
