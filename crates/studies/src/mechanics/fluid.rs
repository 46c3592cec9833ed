//! Fluids of dumbbells: drift of the energy under each way, the law of the projection, and the equations of state.

use lennard_core::{DVec3, State, Want};
use lennard_engine::{Unfollowed, bare, measured_stage, prepare};
use lennard_integrators::BondOptions;
use lennard_integrators::bonds::relaxation::{self, Direction};
use lennard_literature::{EquationOfState, two_center};
use lennard_observables::{Cell, Estimate, Table};
use lennard_scene::Scene;

use super::bodies::{rig, shipped};
use crate::StudyError;
use crate::claims::Measured;
use crate::fluid::FluidStudy;
use crate::jobs::side_by_side;
use crate::lab::{Rig, Start, drift_of};
use crate::sweep::{Point, SettingValue};

/// A way to hold bonds in a fluid at constant energy.
struct FluidDrift {
    way: String,
    /// Density of molecules, σ⁻³.
    density: f64,
    /// h, τ.
    dt: f64,
    /// Slope of the energy per molecule, ε/τ; this and what follows is not a number where the run failed.
    drift: Estimate,
    /// RMS about the straight line, ε per molecule.
    rms: f64,
    /// −h·⟨T_b·r·Ω²⟩, ε/τ per molecule, with the tension T_b of the bond.
    law: f64,
}

/// A way to hold bonds, with the settings that tell it apart.
fn name_of(bonds: &BondOptions) -> String {
    match bonds {
        BondOptions::Relaxation(o) if o.direction == Direction::New => {
            "relaxation, new direction".to_owned()
        }
        BondOptions::Relaxation(relaxation::Options { tolerance: Some(tolerance), .. }) => {
            format!("relaxation, {tolerance:e}")
        }
        BondOptions::Spook(o) => format!("spook, τ = {}h", o.damping_steps),
        other => other.name().to_owned(),
    }
}

/// Σ T_b·r·Ω² over all bonds at one instant, per molecule: T_b = −λ·r with the instantaneous multiplier λ of unit masses.
fn tension_times_turning(state: &State) -> f64 {
    let pairs = |of: &[DVec3]| -> Vec<DVec3> { of.chunks(2).map(|m| m[1] - m[0]).collect() };
    let (d, w, f) = (pairs(&state.positions), pairs(&state.velocities), pairs(&state.forces));
    let each = (0..d.len()).map(|m| {
        let (r2, w2) = (d[m].length_squared(), w[m].length_squared());
        let multiplier = -0.5 * (w2 + d[m].dot(f[m])) / r2;
        -multiplier * w2
    });
    each.sum::<f64>() / d.len() as f64
}

/// A point with its start.
type Begun<'a> = (&'a Point, &'a Start);

/// Density of molecules at a point as its file says it, or of its start, σ⁻³.
fn density((point, start): Begun<'_>) -> f64 {
    let said = point.settings.iter().find(|setting| setting.key == "density");
    match said.map(|setting| &setting.value) {
        Some(SettingValue::Number(density)) => *density,
        _ => start.density_of_molecules(&point.scene),
    }
}

impl FluidDrift {
    /// A run at constant energy for so long.
    fn of(point: &Point, start: &Start, time: f64) -> Result<Self, StudyError> {
        const EVERY: u64 = 5;
        let (scene, dt) = (&point.scene, point.scene.integrator.dt);
        let mut found = Self {
            way: scene.molecule.as_ref().map_or(String::new(), |m| name_of(&m.bonds)),
            density: density((point, start)),
            dt,
            drift: Estimate::UNKNOWN,
            rms: f64::NAN,
            law: f64::NAN,
        };
        let mut rig = rig(scene, start, dt)?;
        let n = rig.system.n_molecules() as f64;
        let (mut energies, mut law) = (Vec::new(), 0.0);
        for step in 1..=(time / dt).round() as u64 {
            let is_sampled = step.is_multiple_of(EVERY);
            rig.want = if is_sampled { Want::ENERGY } else { Want::NOTHING };
            if rig.try_step().is_err() {
                return Ok(found);
            }
            if is_sampled {
                energies.push((step as f64 * dt, rig.energy() / n));
                law -= dt * tension_times_turning(&rig.state);
            }
        }
        (found.drift, found.rms) = drift_of(&energies);
        found.law = law / energies.len() as f64;
        Ok(found)
    }
}

/// What the points of the study show: those at constant energy the drift of each way, the others a state beside the equations.
pub(super) fn measure(
    study: &FluidStudy,
    quick: bool,
    all: &mut Measured,
) -> Result<(), StudyError> {
    let (starts, of_points) = study.starts(|_| {})?;
    let begun = study.points.iter().zip(of_points.iter().map(|start| &starts[*start]));
    let is_state = |(point, _): &Begun<'_>| measured_stage(&point.scene).thermostat.is_some();
    let (states, drifting): (Vec<Begun<'_>>, Vec<Begun<'_>>) = begun.partition(is_state);
    let drift = |(point, start): &Begun<'_>| FluidDrift::of(point, start, study.time(point));
    let found = side_by_side(&drifting, drift, |_| {}).into_iter();
    drifts(&found.collect::<Result<Vec<_>, _>>()?, all);
    let found = side_by_side(&states, |begun| StateResults::of(*begun), |_| {}).into_iter();
    beside_equations(&found.collect::<Result<Vec<_>, _>>()?, quick, all);
    Ok(())
}

/// Drifts of all ways, as tables and numbers.
fn drifts(found: &[FluidDrift], all: &mut Measured) {
    let of = |way: &'static str, dt: f64| found.iter().filter(move |d| d.way == way && d.dt == dt);
    for run in of("relaxation, new direction", 0.002) {
        let number = all.numbers.add("drift along the new bond", run.drift.mean);
        number.of("density", run.density).of("law", run.law).of("size", run.law.abs());
        number.of("error", run.drift.standard_error);
    }
    for run in of("direct", 0.002) {
        let drift = run.drift.mean.abs() - 3.0 * run.drift.standard_error;
        all.numbers.add("drift of the direct solve", drift).of("density", run.density);
    }
    // Both at the largest density that has both steps.
    let order = |way, of_run: fn(&FluidDrift) -> f64| {
        let last = |dt| Some(of_run(of(way, dt).next_back()?));
        Some((last(0.004)? / last(0.002)?).log2())
    };
    let numbers = [
        ("order of the energy of a fluid", order("direct", |run| run.rms)),
        ("order of the drift of SPOOK", order("spook, τ = 2h", |run| run.drift.mean)),
    ];
    for (key, order) in numbers {
        order.map(|order| all.numbers.add(key, order));
    }
    let table = Table::rows_of("drifts", found)
        .column("way", |d| &d.way)
        .column("density [1/sigma^3]", |d| d.density)
        .column("dt [tau]", |d| d.dt)
        .column("drift [epsilon/tau per molecule]", |d| d.drift.mean)
        .column("error of the drift", |d| d.drift.standard_error)
        .column("RMS [epsilon per molecule]", |d| d.rms)
        .column("-h <T r Omega^2>", |d| d.law);
    let in_a_line = Table::rows_of("drifts-in-a-line", found)
        .caption("Fluids of dumbbells at constant energy. The error is of the slope of ten means.")
        .column("Way", |d| &d.way)
        .column("ρ [σ⁻³]", |d| Cell::rounded(d.density, 3))
        .column("h [τ]", |d| Cell::rounded(d.dt, 3))
        .column("drift [ε/τ per molecule]", |d| match d.drift.standard_error.is_finite() {
            true => d.drift.into(),
            false => Cell::words("failed"),
        })
        .column("RMS [ε per molecule]", |d| Cell::rounded(d.rms, 3));
    all.tables.push(table.table());
    all.given.tables.push(in_a_line.table());
}

/// A state point beside the equations of state.
struct StateResults {
    /// Density of molecules, σ⁻³.
    density: f64,
    /// Temperature of half steps, ε/k_B.
    temperature: f64,
    /// u per molecule, ε.
    energy: Estimate,
    /// p, ε/σ³.
    pressure: Estimate,
    /// u and p by Lísal 2004 and by Mecke 1997.
    by: [[f64; 2]; 2],
}

impl StateResults {
    fn of((point, start): Begun<'_>) -> Result<Self, StudyError> {
        let density = density((point, start));
        let mut scene = Scene { observables: Vec::new(), ..point.scene.clone() };
        scene.stages.retain(|stage| stage.measure);
        let mut simulation = start.simulation(scene)?;
        simulation.follow(&mut Unfollowed)?;
        let averages = simulation.observers[0].observable.finish(0.0).averages;
        let value = |name: &str| {
            let found = averages.iter().find(|a| a.name == name);
            found.map_or(Estimate::UNKNOWN, |a| a.estimate)
        };
        let temperature = value("temperature_half_steps").mean;
        let bonds = point.scene.molecules();
        let equations = bonds.bonds().first().and_then(|bond| two_center(bond.length));
        let by = equations.map(|both| {
            let states = both.map(|equation| equation.at(density, temperature));
            states.map(|state| [state.potential_energy, state.pressure])
        });
        Ok(Self {
            density,
            temperature,
            energy: value("potential_energy"),
            pressure: value("pressure"),
            by: by.unwrap_or([[f64::NAN; 2]; 2]),
        })
    }
}

/// State points beside the equations of state, as a table and numbers.
fn beside_equations(found: &[StateResults], quick: bool, all: &mut Measured) {
    // A short run has no error, or one that may not cover.
    let slack = if quick { 0.1 } else { 0.0 };
    for state in found {
        for (i, (of, value)) in [("u", state.energy), ("p", state.pressure)].into_iter().enumerate()
        {
            let off = state.by.map(|by| (value.mean - by[i]).abs());
            let nearer = off.into_iter().fold(f64::INFINITY, f64::min);
            let error = Some(value.standard_error).filter(|error| error.is_finite());
            let off = nearer - 3.0 * error.unwrap_or(0.0);
            let number = all.numbers.add("difference from the equation of state", off);
            number.of("of", of).of("density", state.density).of("slack", slack);
        }
    }
    let table = Table::rows_of("states", found)
        .column("density [1/sigma^3]", |s| s.density)
        .column("T of half steps [epsilon/k_B]", |s| s.temperature)
        .measured("u [epsilon per molecule]", |s| Some(s.energy))
        .measured("p [epsilon/sigma^3]", |s| Some(s.pressure))
        .column("u by Lisal", |s| s.by[0][0])
        .column("p by Lisal", |s| s.by[0][1])
        .column("u by Mecke", |s| s.by[1][0])
        .column("p by Mecke", |s| s.by[1][1]);
    all.tables.push(table.table());
}

/// Step of the fluid between walls, τ.
const DT: f64 = 0.004;

/// The virial theorem in discrete time for a fluid between hard walls: P of walls and P of the virial along z. The
/// moment Σ(z − z_m)·v_z about the middle of the slit changes by kinetic and virial terms and by the impulses of the hits.
pub(super) fn pressure(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    let scene = shipped(
        "walls/hard",
        &[
            ("system.n_atoms", "108".to_owned()),
            ("system.seed", "3".to_owned()),
            ("truncation.r_cut", "2.2".to_owned()),
        ],
    )?;
    let start = Start::from(prepare(bare(&scene))?);
    let slit = scene.slits(&start.cell)[0];
    let lengths = start.cell.lengths();
    let (middle, area) = (0.5 * (slit.lower + slit.upper), lengths.x * lengths.y);
    let mut rig = rig(&scene, &start, DT)?;
    rig.want = Want::NOTHING;
    let sum = |state: &State, of: &dyn Fn(DVec3, DVec3, DVec3) -> f64| -> f64 {
        let all = state.positions.iter().zip(&state.velocities);
        all.zip(&state.forces).map(|((r, v), f)| of(*r, *v, *f)).sum()
    };
    let moment = |state: &State| sum(state, &|r, v, _| (r.z - middle) * v.z);
    let virial = |state: &State| sum(state, &|r, _, f| (r.z - middle) * f.z);
    let steps = if quick { 2000_u32 } else { 40_000 };
    // The lattice melts first: its steps count for nothing.
    rig.steps(u64::from(steps / 4))?;
    let impulse = |rig: &Rig| rig.forces.walls().iter().map(|w| w.impulse).sum::<f64>();
    let (first_moment, first_impulse) = (moment(&rig.state), impulse(&rig));
    let (mut kinetic, mut forced, mut before) = (0.0, 0.0, virial(&rig.state));
    let mut points = Vec::new();
    let mut identity = f64::NAN;
    for step in 1..=steps {
        kinetic += DT * sum(&rig.state, &|_, v, f| (v.z + 0.5 * DT * f.z).powi(2));
        rig.step()?;
        let now = virial(&rig.state);
        forced += 0.5 * DT * (before + now);
        before = now;
        let is_shown = step.is_power_of_two() || step % (steps / 40) == 0;
        if step >= 50 && is_shown {
            let time = DT * f64::from(step);
            let volume = area * slit.width();
            let impulse = impulse(&rig) - first_impulse;
            let boundary = moment(&rig.state) - first_moment;
            let of_walls = impulse / (2.0 * area * time);
            let with_boundary = (kinetic + forced - boundary) / (volume * time);
            identity = (with_boundary - of_walls).abs() * volume * time / kinetic;
            let of_virial = (kinetic + forced) / (volume * time);
            points.push([time, of_walls, of_virial, with_boundary]);
        }
    }
    all.numbers.add("pressure on walls against the virial", identity);
    let table = Table::rows_of("wall-pressure", &points)
        .column("time [tau]", |p| p[0])
        .column("P of walls", |p| p[1])
        .column("P of virial", |p| p[2])
        .column("P of virial less boundary term", |p| p[3]);
    all.tables.push(table.table());
    Ok(())
}
