//! Quantity by quantity: what it is compared with, and how far off it may be.

use lennard_core::Molecules;
use lennard_io::Comparison;
use lennard_literature::{
    EquationOfState, ModelKind, TransportProperty, equation_of_state_for, property,
};
use lennard_observables::quantities::{Beside, QUANTITIES, Setting, quantity_of};
use lennard_observables::{CORRECTED, HeldTemperature, Remark, UNCORRECTED};
use lennard_scene::PressureControl;

use super::card::spread;
use super::runs_of_others::RunsOfOthers;
use super::tail_bias::tail_bias;
use super::verdict::Tolerance;
use super::{Row, RunFolder, StateOfMatter, Verdict};

/// Energy and pressure: an equation of state that does not say how far it may be off is taken to be off by so much.
const ENERGY: Tolerance = Tolerance::new(4.0, 0.003, 0.0);
const PRESSURE: Tolerance = Tolerance::new(4.0, 0.005, 0.0);
/// The density at constant pressure: the equation of state may itself be off by so much.
const DENSITY: Tolerance = Tolerance::new(4.0, 0.0, 0.003);
/// The pressure beside the pressure of the barostat, which the mean meets exactly.
const HELD_PRESSURE: Tolerance = Tolerance::new(4.0, 0.003, 0.0);
/// The kinetic temperature beside the temperature of its bath. A run that is off by more says so of all its means.
const BATH: Tolerance = Tolerance::new(HeldTemperature::ERRORS, 0.0, HeldTemperature::PART);
const HEAT_CAPACITY: Tolerance = Tolerance::new(2.0, 0.0, 0.02);
/// Configurational against kinetic temperature. With a finite step, stiff directions make the first some 0.1 %
/// higher than the temperature of half steps. The jump of the force at the cutoff is counted with g(r_cut) = 1.
const TEMPERATURES: Tolerance = Tolerance::new(4.0, 0.0, 0.005);

/// Response functions: so many errors, and the spread of the equations; this part of the value where there is one alone.
const RESPONSE: Tolerance = Tolerance::new(3.0, 0.0, 0.0);
const RESPONSE_PART: f64 = 0.02;

/// Height of the main peak of S(k) at freezing.
pub(crate) const HANSEN_VERLET: f64 = 2.85;
const HANSEN_VERLET_SOURCE: &str =
    "J.-P. Hansen and L. Verlet, Phys. Rev. 184, 151 (1969), doi:10.1103/PhysRev.184.151";

/// A crystal or a glass has a coefficient below this part of √T; the liquid at its triple point has 0.04.
const FROZEN_DIFFUSION: f64 = 1e-3;

/// What a run is compared by.
pub(super) struct Compared<'a> {
    pub(super) run: &'a RunFolder,
    pub(super) state: &'a StateOfMatter,
    pub(super) model: ModelKind,
    /// Why no reference for a homogeneous fluid applies; `None` where it does.
    pub(super) no_reference: Option<String>,
    /// Runs of others at the same state.
    pub(super) others: RunsOfOthers<'a>,
}

/// Every average of a run, the primary ones first.
pub(super) fn all(compared: &Compared<'_>) -> Vec<Row> {
    let run = compared.run;
    let of_positions = run.temperature_name();
    let mut primary = vec![of_positions];
    primary.extend(primary_of(run).map(|key| -> &str { key }));
    let of_others: Vec<String> = compared.others.names().collect();
    for name in &of_others {
        if !primary.contains(&name.as_str()) {
            primary.push(name);
        }
    }
    let others = run.record.averages.keys().map(String::as_str);
    let mut names = primary.clone();
    names.extend(others.filter(|name| !primary.contains(name)));
    names
        .into_iter()
        .filter_map(|name| {
            let row = compared.row(name)?;
            Some(Row { primary: primary.contains(&name), ..row })
        })
        .collect()
}

impl Compared<'_> {
    /// One quantity with what it is held against; `None` where the run has not measured it.
    fn row(&self, name: &str) -> Option<Row> {
        let row = Row { scale: self.scale(name), ..Row::measured(name, self.run.average(name)?) };
        if let Some(of_others) = self.others.of(name) {
            return Some(self.others.hold(row, of_others));
        }
        let beside = quantity_of(name).map_or(Beside::Nothing, |quantity| quantity.beside);
        Some(match beside {
            Beside::Nothing => row,
            Beside::Bath => self.beside_bath(row, false),
            Beside::BathOnHalfSteps => self.beside_bath(row, true),
            Beside::PotentialEnergy => self.beside_equation(row, ENERGY),
            Beside::Pressure => self.pressure(row),
            Beside::Density => self.beside_equation(row, DENSITY),
            Beside::HeatCapacity => self.heat_capacity(row),
            Beside::ResponseFunction => self.response(row),
            Beside::KineticTemperature => self.configurational_temperature(row),
            Beside::SelfDiffusion => self.diffusion(row),
            Beside::Viscosity => self.beside_table(row, TransportProperty::ShearViscosity),
            Beside::Conductivity => self.beside_table(row, TransportProperty::ThermalConductivity),
            Beside::FreezingHeight => freezing_height(row),
            Beside::LiquidDensity
            | Beside::VaporDensity
            | Beside::VaporPressure
            | Beside::SurfaceTension => self.beside_two_phases(row, beside),
        })
    }

    /// The size beside which a difference in a quantity is small or large; `None` for the size of its reference.
    pub(super) fn scale(&self, name: &str) -> Option<f64> {
        let (density, temperature) = (self.state.density, self.state.temperature);
        let state = self.equation().map(|e| e.at(density, temperature));
        let heat_capacity = state.map_or(f64::NAN, |s| s.heat_capacity_pressure);
        let scale = property(name)?.scale;
        scale.at(density, temperature, heat_capacity)
    }

    /// The kinetic temperature beside the temperature of the bath, where the bath holds this very temperature.
    fn beside_bath(&self, row: Row, half_steps: bool) -> Row {
        let held = lennard_engine::held_temperature(&self.run.scene);
        let Some(bath) = held.filter(|bath| bath.half_steps == half_steps) else {
            return row;
        };
        row.against(bath.temperature, None, BATH, "the temperature of the bath")
    }

    /// A sound number to which no reference applies in this state says why.
    pub(super) fn or_why_none(&self, mut row: Row) -> Row {
        if row.verdict == Verdict::NoReference
            && let Some(why) = &self.no_reference
        {
            row.reason.clone_from(why);
        }
        row
    }

    fn equation(&self) -> Option<&'static dyn EquationOfState> {
        let equation = equation_of_state_for(self.model).ok();
        equation.filter(|_| self.no_reference.is_none())
    }

    /// Density, U or P beside the equation of state, as the run itself has compared it with the whole series.
    fn beside_equation(&self, row: Row, tolerance: Tolerance) -> Row {
        let of = |c: &&Comparison| c.quantity == row.quantity;
        let Some(compared) = self.run.record.comparison.iter().find(of) else {
            return self.or_why_none(row);
        };
        let Comparison { reference, standard_error, source, .. } = compared;
        let row = match self.barostat() {
            Some(_) => row
                .against_with_error(*reference, *standard_error, tolerance, source)
                .noted("at the pressure of the barostat and the measured temperature"),
            None if self.equation().is_some() => self.in_a_closed_box(row, compared, tolerance),
            None => return self.or_why_none(row),
        };
        self.where_it_applies(row)
    }

    /// U or P beside the equation of state for as many particles in a closed box.
    fn in_a_closed_box(&self, row: Row, compared: &Comparison, tolerance: Tolerance) -> Row {
        let run = self.run;
        let particles =
            crate::report::particles(run.record.atoms as usize, run.molecules() as usize);
        let is_pressure = row.quantity == "pressure";
        let mut row = row
            .against_with_error(
                compared.reference,
                compared.standard_error,
                tolerance
                    .for_reference(compared.reference_uncertainty)
                    .holding(compared.finite_size_uncertainty),
                &compared.source,
            )
            .noted(compared.finite_size.map_or(
                "for an infinite system: there is no finite-size correction of first order in this state".into(),
                |s| format!("for {particles} in a closed box: {s:+.5} beside an infinite system"),
            ));
        row.reference_error = compared.reference_uncertainty;
        row.finite_size_uncertainty = compared.finite_size_uncertainty;
        if let ModelKind::CutWithTail { r_cut } = self.model
            && let Some(bias) = tail_bias(run, r_cut)
        {
            let bias = bias[usize::from(is_pressure)];
            row = row.biased_by(bias, &format!("the tail beyond a cutoff of {r_cut} σ"));
        }
        if let Some(held) = compared.finite_size_uncertainty
            && row.is_sound()
            && row.reason.is_empty()
        {
            let why = match compared.finite_size {
                Some(_) => "near the critical point of the equation",
                None => "for so few particles",
            };
            let held = crate::report::significant(held, 2);
            row.reason = format!(
                "the tolerance holds a finite-size term of ± {held}, which is not trusted {why}"
            );
        }
        row
    }

    /// The barostat of the measured stages.
    fn barostat(&self) -> Option<&PressureControl> {
        let measured = self.run.scene.measured_stages().next()?;
        measured.barostat.as_ref()
    }

    /// P beside the equation of state, or beside the pressure of the barostat.
    fn pressure(&self, row: Row) -> Row {
        let Some(control) = self.barostat() else {
            return self.beside_equation(row, PRESSURE);
        };
        // Beside a crystal the barostat holds P_zz, and the sides of the cross-section are given.
        if control.pressure_from.is_some() || self.run.scene.half_crystal().is_some() {
            return row;
        }
        // With N_f/3 = N − 1 the mean of ρT + W/(3V) + P_tail is above P₀ by T/V.
        let record = &self.run.record;
        let missing = missing_centers(record.atoms, record.n_dof, &self.run.scene.molecules());
        let volume = self.run.average("volume").map_or(f64::INFINITY, |v| v.estimate.mean);
        let shift = missing * self.state.temperature / volume;
        row.against(control.pressure + shift, None, HELD_PRESSURE, "the pressure of the barostat")
            .noted(format!(
                "for {} particles without total momentum: {shift:+.5} beside an infinite system",
                self.run.record.atoms
            ))
    }

    /// A difference is no finding where the reference does not apply. A fluid's reference does not apply to what does not flow.
    /// A response function has none where finite-size terms are not small or not trusted.
    fn where_it_applies(&self, row: Row) -> Row {
        if row.verdict != Verdict::Differs {
            return row;
        }
        let diffusion = self.run.average(UNCORRECTED);
        let frozen = diffusion
            .filter(|d| d.estimate.mean < FROZEN_DIFFUSION * self.state.temperature.sqrt());
        let comparison = &self.run.record.comparison;
        let has_term = comparison.iter().any(|c| c.quantity == row.quantity);
        let in_doubt = comparison.iter().any(|c| c.finite_size_uncertainty.is_some());
        let reason = match frozen {
            Some(d) => format!(
                "its particles hardly diffuse (D = {}): a crystal or a glass, which this fluid equation does not describe",
                crate::report::significant(d.estimate.mean, 2)
            ),
            None if in_doubt && !has_term => {
                "its finite-size term is not known, and no longer small in this state".into()
            }
            None => return row,
        };
        Row {
            reason,
            verdict: Verdict::NoReference,
            reference: None,
            difference: None,
            in_standard_errors: None,
            predicted_bias: None,
            ..row
        }
    }

    fn heat_capacity(&self, row: Row) -> Row {
        let how = self.run.record.typed_remarks.iter().find_map(|remark| match remark {
            Remark::HeatCapacity { how } => Some(how.as_str()),
            _ => None,
        });
        let row = row.noted(how.unwrap_or_default());
        let (density, temperature) = (self.state.density, self.state.temperature);
        let Some(equation) = self.equation() else {
            return self.or_why_none(row);
        };
        let reference = equation.heat_capacity_volume(density, temperature);
        self.where_it_applies(row.against(
            reference,
            None,
            HEAT_CAPACITY,
            &equation.spec().citation(),
        ))
    }

    /// A response function beside the equation of state; the tolerance has the spread of the good equations.
    fn response(&self, row: Row) -> Row {
        let (density, temperature) = (self.state.density, self.state.temperature);
        let (Some(equation), Some(property)) = (self.equation(), property(&row.quantity)) else {
            return self.or_why_none(row);
        };
        let reference = (property.of)(&equation.at(density, temperature));
        let spread = spread(self.model, density, temperature, property);
        let own = spread.unwrap_or(RESPONSE_PART * reference.abs());
        let row = row.against(
            reference,
            None,
            RESPONSE.for_reference(Some(own)),
            &equation.spec().citation(),
        );
        self.where_it_applies(row)
    }

    fn configurational_temperature(&self, row: Row) -> Row {
        let Some(kinetic) = self.run.temperature().filter(|t| t.is_sound()) else {
            return row;
        };
        row.against(
            kinetic.estimate.mean,
            Some(kinetic.estimate.standard_error),
            TEMPERATURES,
            "the kinetic temperature of the same run (of half steps where the method has them)",
        )
    }
}

/// The height of the first peak of S(k), with that at which a fluid freezes said beside it.
fn freezing_height(row: Row) -> Row {
    let side = if row.measured < HANSEN_VERLET { "below" } else { "above" };
    row.noted(format!(
        "{side} {HANSEN_VERLET}, the height at which a fluid freezes ({HANSEN_VERLET_SOURCE})"
    ))
}

/// The number of centres of mass less a third of their degrees of freedom: 1 where the total momentum is zero, 0 where it is thermal.
fn missing_centers(sites: u64, n_dof: u64, molecules: &Molecules) -> f64 {
    let rigid = match molecules.are_rigid() {
        true => sites / molecules.sites() as u64 * molecules.bonds().len() as u64,
        false => 0,
    };
    sites as f64 - (n_dof + rigid) as f64 / 3.0
}

/// What the readers of a run look at first.
fn setting(run: &RunFolder) -> Setting {
    if run.has_two_phases() {
        Setting::Slab
    } else if !run.scene.walls.is_empty() {
        Setting::Walls
    } else if run.scene.half_crystal().is_some() {
        Setting::Fronts
    } else {
        Setting::Fluid
    }
}

/// What belongs first in the table of a run, besides its temperature.
fn primary_of(run: &RunFolder) -> impl Iterator<Item = &'static str> {
    let setting = setting(run);
    let of_setting = QUANTITIES.iter().filter(move |q| q.primary.contains(&setting));
    // Of two diffusion coefficients of one slope, the one of an infinite system comes first.
    let hidden = run.average(CORRECTED).and(Some(UNCORRECTED));
    of_setting.map(|q| q.key).filter(move |key| Some(*key) != hidden)
}

#[cfg(test)]
mod tests {
    use lennard_core::Bonds;

    use super::*;

    #[test]
    fn one_center_is_missing_without_total_momentum_whatever_the_bonds() {
        assert_eq!(missing_centers(864, 3 * 864 - 3, &Molecules::ATOMS), 1.0);
        assert_eq!(missing_centers(864, 3 * 864, &Molecules::ATOMS), 0.0);
        let chains = |bonds| Molecules::chains(3, 1.0, bonds);
        assert_eq!(missing_centers(300, 900 - 200 - 3, &chains(Bonds::Rigid)), 1.0);
        assert_eq!(missing_centers(300, 900 - 3, &chains(Bonds::Springs)), 1.0);
    }
}
