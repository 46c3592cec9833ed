//! Fluids of dumbbells: drift of the energy under each way, the law of the projection, and the equations of state.

use lennard_core::{Backend, DVec3, Integrator, State, System, Want};
use lennard_engine::{EngineError, Simulation, Unfollowed, prepare};
use lennard_integrators::{BondHolder, BondOptions, IntegratorOptions, build, spook};
use lennard_literature::{EquationOfState, two_center};
use lennard_observables::statistics::Line;
use lennard_observables::{Cell, Table};
use lennard_scene::Scene;

use super::bodies::{damped, projected, relaxed};
use crate::lab::Rig;
use crate::measured::Measured;
use crate::{StudyError, jobs};

/// Bond length of all fluids, σ.
const LENGTH: f64 = 0.67;

/// A way to hold bonds in a fluid at constant energy.
#[derive(Clone)]
struct FluidDrift {
    way: &'static str,
    /// Density of molecules, σ⁻³.
    density: f64,
    /// h, τ.
    dt: f64,
    /// Slope of the energy per molecule with its error, ε/τ; this and what follows is not a number where the run failed.
    drift: (f64, f64),
    /// RMS about the straight line, ε per molecule.
    rms: f64,
    /// −h·⟨T_b·r·Ω²⟩, ε/τ per molecule, with the tension T_b of the bond.
    law: f64,
}

/// A fluid of dumbbells in equilibrium.
fn equilibrated(density: f64, molecules: usize, steps: u32) -> Result<Simulation, StudyError> {
    let text = format!(
        "[system]\nn_molecules = {molecules}\ndensity = {density:?}\ntemperature = 2.0\nseed = 7\n\
         [molecule]\nkind = \"dumbbell\"\nbond_length = {LENGTH:?}\n\
         [truncation]\nkind = \"force-shift\"\nr_cut = 2.5\n\
         [integrator]\ndt = 0.002\n\
         [[stage]]\nname = \"equilibrate\"\nsteps = {steps}\nthermostat = {{ kind = \"bussi\", tau = 0.1 }}\n"
    );
    let mut simulation = prepare(scene(&text)?)?;
    simulation.follow(&mut Unfollowed)?;
    Ok(simulation)
}

/// The scene of a fluid.
pub(super) fn scene(text: &str) -> Result<Scene, StudyError> {
    let scene = Scene::parse(text, "the fluid of the study", &[]);
    Ok(scene.map_err(EngineError::from)?)
}

fn holding(bonds: &BondOptions, system: &System) -> Integrator {
    let method = build(&IntegratorOptions::default());
    match bonds.build(&system.molecules) {
        BondHolder::Drift(solver) | BondHolder::InDrift(solver, _) => method.with_bonds(solver),
        BondHolder::Spook(bonds, _) => spook::with_bonds(bonds),
        BondHolder::Spring(_) => method,
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

/// The slope of values at equal distances with its error, and the RMS about the line.
fn slope(values: &[f64], spacing: f64) -> ((f64, f64), f64) {
    let line = |values: &[f64]| {
        let points: Vec<_> = values.iter().enumerate().map(|(i, y)| (i as f64, *y)).collect();
        Line::through(&points)
    };
    let whole = line(values);
    // Ten means of parts on a line: what their residuals say of its slope.
    let part = values.len() / 10;
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let means: Vec<f64> = values.chunks_exact(part).map(mean).collect();
    let error = line(&means).error_of_slope() / part as f64;
    ((whole.slope() / spacing, error / spacing), whole.rms())
}

/// Drift, RMS and law of a run at constant energy from an equilibrated fluid; `None` where it fails.
fn drift(
    start: &mut Simulation,
    bonds: &BondOptions,
    (dt, time): (f64, f64),
) -> Option<((f64, f64), f64, f64)> {
    const EVERY: u32 = 5;
    let system = &start.system;
    let mut state = start.state.clone();
    let forces: &mut dyn Backend = start.forces.as_mut();
    let mut integrator = holding(bonds, system);
    integrator.start(system, &mut state, forces, dt, Want::ENERGY).ok()?;
    let n = system.n_molecules() as f64;
    let (mut energies, mut law) = (Vec::new(), 0.0);
    for step in 1..=(time / dt).round() as u32 {
        let is_sampled = step % EVERY == 0;
        let want = if is_sampled { Want::ENERGY } else { Want::NOTHING };
        integrator.step(system, &mut state, forces, dt, want).ok()?;
        if let Some(potential) = state.energetics.potential_energy.filter(|_| is_sampled) {
            energies.push((system.kinetic_energy(&state.velocities) + potential) / n);
            law -= dt * tension_times_turning(&state);
        }
    }
    let (drift, rms) = slope(&energies, dt * f64::from(EVERY));
    Some((drift, rms, law / energies.len() as f64))
}

/// Drifts of all ways that are charted.
pub(super) fn drifts(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    let densities: &[f64] =
        if quick { &[0.05, 0.52] } else { &[0.05, 0.15, 0.30, 0.40, 0.458, 0.52] };
    let (molecules, settle, time) = if quick { (108, 1000, 4.0) } else { (108, 8000, 20.0) };
    let (direct, new) = ("direct", "relaxation, new direction");
    let few = [(direct, BondOptions::default(), 0.002), (new, projected(), 0.002)];
    let more = [
        (direct, BondOptions::default(), 0.004),
        ("relaxation, 10⁻⁶", relaxed(1e-6), 0.002),
        ("spook, τ = 2h", damped(2.0), 0.002),
        ("spook, τ = 2h", damped(2.0), 0.004),
        ("spook, τ = h/2", damped(0.5), 0.002),
    ];
    let of_density = |density: &f64| -> Result<Vec<FluidDrift>, StudyError> {
        let mut fluid = equilibrated(*density, molecules, settle)?;
        let has_more = densities.last() == Some(density) || (!quick && *density == 0.458);
        let ways = few.iter().chain(more.iter().filter(|_| has_more));
        let run = |(way, bonds, dt): &(&'static str, BondOptions, f64)| {
            let found = drift(&mut fluid, bonds, (*dt, time));
            let (drift, rms, law) = found.unwrap_or(((f64::NAN, f64::NAN), f64::NAN, f64::NAN));
            FluidDrift { way, density: *density, dt: *dt, drift, rms, law }
        };
        Ok(ways.map(run).collect())
    };
    let found = jobs::side_by_side_quietly(densities, of_density);
    let found: Vec<Vec<FluidDrift>> = found.into_iter().collect::<Result<_, _>>()?;
    let found = found.concat();
    let of = |way: &'static str, dt: f64| found.iter().filter(move |d| d.way == way && d.dt == dt);
    for run in of(new, 0.002) {
        let number = all.numbers.add("drift along the new bond", run.drift.0);
        number.of("density", run.density).of("law", run.law).of("size", run.law.abs());
        number.of("error", run.drift.1);
    }
    for run in of(direct, 0.002) {
        let drift = run.drift.0.abs() - 3.0 * run.drift.1;
        all.numbers.add("drift of the direct solve", drift).of("density", run.density);
    }
    let rms = |dt| of(direct, dt).next_back().map_or(f64::NAN, |run| run.rms);
    all.numbers.add("order of the energy of a fluid", (rms(0.004) / rms(0.002)).log2());
    let drift = |dt| of("spook, τ = 2h", dt).next_back().map_or(f64::NAN, |run| run.drift.0);
    all.numbers.add("order of the drift of SPOOK", (drift(0.004) / drift(0.002)).log2());
    let table = Table::rows_of("drifts", &found)
        .column("way", |d| d.way)
        .column("density [1/sigma^3]", |d| d.density)
        .column("dt [tau]", |d| d.dt)
        .column("drift [epsilon/tau per molecule]", |d| d.drift.0)
        .column("error of the drift", |d| d.drift.1)
        .column("RMS [epsilon per molecule]", |d| d.rms)
        .column("-h <T r Omega^2>", |d| d.law);
    let in_a_line = Table::rows_of("drifts-in-a-line", &found)
        .caption(
            "Fluids of 108 dumbbells at constant energy. The error is of the slope of ten means.",
        )
        .column("Way", |d| d.way)
        .column("ρ [σ⁻³]", |d| Cell::rounded(d.density, 3))
        .column("h [τ]", |d| Cell::rounded(d.dt, 3))
        .column("drift [ε/τ per molecule]", |d| match d.drift.1.is_finite() {
            true => Cell::measured(d.drift.0, d.drift.1),
            false => Cell::words("failed"),
        })
        .column("RMS [ε per molecule]", |d| Cell::rounded(d.rms, 3));
    all.tables.push(table.table());
    all.given.tables.push(in_a_line.table());
    Ok(())
}

/// A state point beside the equations of state.
struct StateResults {
    /// Density of molecules, σ⁻³.
    density: f64,
    /// Temperature of half steps, ε/k_B.
    temperature: f64,
    /// u per molecule with its standard error, ε.
    energy: (f64, f64),
    /// p with its standard error, ε/σ³.
    pressure: (f64, f64),
    /// u and p by Lísal 2004 and by Mecke 1997.
    by: [(f64, f64); 2],
}

/// State points beside the equations of state.
pub(super) fn states(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    let densities: &[f64] = if quick { &[0.30] } else { &[0.05, 0.15, 0.30, 0.458, 0.52] };
    let (molecules, settle, steps) = if quick { (108, 1000, 2000) } else { (256, 10_000, 60_000) };
    let of_density = |density: &f64| -> Result<StateResults, StudyError> {
        let text = format!(
            "[system]\nn_molecules = {molecules}\ndensity = {density:?}\ntemperature = 2.4\nseed = 11\n\
             [molecule]\nkind = \"dumbbell\"\nbond_length = {LENGTH:?}\n\
             [truncation]\nkind = \"cut\"\nr_cut = {}\n\
             [integrator]\ndt = 0.002\n\
             [[stage]]\nname = \"equilibrate\"\nsteps = {settle}\nthermostat = {{ kind = \"bussi\", tau = 0.2 }}\n\
             [[stage]]\nname = \"production\"\nsteps = {steps}\nthermostat = {{ kind = \"bussi\", tau = 0.2 }}\n",
            if quick { 2.8 } else { 3.5 }
        );
        let mut simulation = prepare(scene(&text)?)?;
        simulation.follow(&mut Unfollowed)?;
        let averages = simulation.observers[0].observable.finish(0.0).averages;
        let value = |name: &str| -> (f64, f64) {
            let found = averages.iter().find(|a| a.name == name);
            found.map_or((f64::NAN, f64::NAN), |a| (a.estimate.mean, a.estimate.standard_error))
        };
        let temperature = value("temperature_half_steps").0;
        let equations = two_center(LENGTH).map(|both| both.map(|e| e.at(*density, temperature)));
        let by = equations.map(|both| both.map(|state| (state.potential_energy, state.pressure)));
        Ok(StateResults {
            density: *density,
            temperature,
            energy: value("potential_energy"),
            pressure: value("pressure"),
            by: by.unwrap_or([(f64::NAN, f64::NAN); 2]),
        })
    };
    let found = jobs::side_by_side_quietly(densities, of_density);
    let found: Vec<StateResults> = found.into_iter().collect::<Result<_, _>>()?;
    let slack = if quick { 0.1 } else { 0.0 };
    for state in &found {
        let off = |(mean, error): (f64, f64), by: [f64; 2]| {
            let nearer = by.map(|e| (mean - e).abs()).into_iter().fold(f64::INFINITY, f64::min);
            nearer - 3.0 * if error.is_finite() { error } else { 0.0 }
        };
        for (of, off) in [
            ("u", off(state.energy, state.by.map(|by| by.0))),
            ("p", off(state.pressure, state.by.map(|by| by.1))),
        ] {
            let number = all.numbers.add("difference from the equation of state", off);
            number.of("of", of).of("density", state.density).of("slack", slack);
        }
    }
    let table = Table::rows_of("states", &found)
        .column("density [1/sigma^3]", |s| s.density)
        .column("T of half steps [epsilon/k_B]", |s| s.temperature)
        .measured("u [epsilon per molecule]", |s| Some(s.energy))
        .measured("p [epsilon/sigma^3]", |s| Some(s.pressure))
        .column("u by Lisal", |s| s.by[0].0)
        .column("p by Lisal", |s| s.by[0].1)
        .column("u by Mecke", |s| s.by[1].0)
        .column("p by Mecke", |s| s.by[1].1);
    all.tables.push(table.table());
    Ok(())
}

/// Time step, τ.
const DT: f64 = 0.004;

/// Runs a fluid of 108 atoms between hard walls, z counted from the middle of the slit.
///
/// The pressure of the walls is the momentum of their hits over 2A·t. The virial's is (Σ m·v_z² + Σ z·F_z)/(A·L), with half-step
/// speeds and trapezoid weights. The boundary term is [Σ m·z·v_z]/(A·L·t).
pub(super) fn pressure(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    let text = "[system]\nn_atoms = 108\ndensity = 0.6\ntemperature = 1.5\nseed = 3\n\
                [truncation]\nkind = \"shift\"\nr_cut = 2.2\n\
                [integrator]\ndt = 0.004\n\
                [[wall]]\nkind = \"hard\"\n\
                [[stage]]\nname = \"production\"\nsteps = 1\n";
    let simulation = prepare(scene(text)?)?;
    let cell = simulation.state.cell;
    let slit = simulation.scene.slits(&cell)[0];
    let (middle, area) = (0.5 * (slit.lower + slit.upper), cell.lengths().x * cell.lengths().y);
    let method = build(&IntegratorOptions::default());
    let at = (simulation.system, simulation.state);
    let mut rig = Rig::start(method, at, simulation.forces, DT, Want::NOTHING)?;
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
