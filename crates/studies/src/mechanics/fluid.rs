//! Fluids of dumbbells: drift of the energy under each way, the law of the projection, and the equations of state.

use lennard_core::{Backend, DVec3, Integrator, State, System, Want};
use lennard_engine::{Simulation, Unfollowed, prepare};
use lennard_integrators::{BondHolder, BondOptions, IntegratorOptions, build, spook};
use lennard_literature::{EquationOfState, two_center};
use lennard_observables::statistics::Line;
use lennard_scene::Scene;
use serde::Serialize;

use super::ways::{damped, projected, relaxed};
use crate::{StudyError, jobs};

/// Bond length of all fluids, σ.
const LENGTH: f64 = 0.67;

/// A way to hold bonds in a fluid at constant energy.
#[derive(Debug, Clone, Serialize)]
pub struct FluidDrift {
    /// The way.
    pub way: &'static str,
    /// Density of molecules, σ⁻³.
    pub density: f64,
    /// h, τ.
    pub dt: f64,
    /// Slope of the energy per molecule, ε/τ; not a number where the run failed.
    pub drift: f64,
    /// Standard error of the slope, from the slopes of ten parts.
    pub error: f64,
    /// RMS about the straight line, ε per molecule.
    pub rms: f64,
    /// −h·⟨T_b·r·Ω²⟩, ε/τ per molecule, with the tension T_b of the bond.
    pub law: f64,
}

/// A state point beside the equations of state.
#[derive(Debug, Clone, Serialize)]
pub struct StateResults {
    /// Density of molecules, σ⁻³.
    pub density: f64,
    /// Temperature of half steps, ε/k_B.
    pub temperature: f64,
    /// u per molecule with its standard error, ε.
    pub energy: (f64, f64),
    /// p with its standard error, ε/σ³.
    pub pressure: (f64, f64),
    /// u and p by Lísal 2004.
    pub lisal: (f64, f64),
    /// u and p by Mecke 1997.
    pub mecke: (f64, f64),
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

fn scene(text: &str) -> Result<Scene, StudyError> {
    Scene::parse(text, "the fluid of the study", &[]).map_err(|e| StudyError::Settings {
        label: "the fluid of dumbbells".into(),
        reason: e.to_string(),
    })
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

/// The slope of values at equal distances, its error, and the RMS about the line.
fn slope(values: &[f64], spacing: f64) -> (f64, f64, f64) {
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
    (whole.slope() / spacing, error / spacing, whole.rms())
}

/// A run at constant energy from an equilibrated fluid.
fn drift(
    start: &mut Simulation,
    (way, bonds): (&'static str, &BondOptions),
    (density, dt, time): (f64, f64, f64),
) -> FluidDrift {
    const EVERY: u32 = 5;
    let system = &start.system;
    let mut state = start.state.clone();
    let forces: &mut dyn Backend = start.forces.as_mut();
    let mut integrator = holding(bonds, system);
    let mut found = FluidDrift {
        way,
        density,
        dt,
        drift: f64::NAN,
        error: f64::NAN,
        rms: f64::NAN,
        law: f64::NAN,
    };
    if integrator.start(system, &mut state, forces, dt, Want::ENERGY).is_err() {
        return found;
    }
    let n = system.n_molecules() as f64;
    let (mut energies, mut law) = (Vec::new(), 0.0);
    for step in 1..=(time / dt).round() as u32 {
        let want = match step % EVERY {
            0 => Want::ENERGY,
            _ => Want::NOTHING,
        };
        if integrator.step(system, &mut state, forces, dt, want).is_err() {
            return found;
        }
        if let Some(potential) = state.energetics.potential_energy.filter(|_| step % EVERY == 0) {
            energies.push((system.kinetic_energy(&state.velocities) + potential) / n);
            law -= dt * tension_times_turning(&state);
        }
    }
    (found.drift, found.error, found.rms) = slope(&energies, dt * f64::from(EVERY));
    found.law = law / energies.len() as f64;
    found
}

/// Drifts of all ways that are charted.
pub(crate) fn drifts(quick: bool) -> Result<Vec<FluidDrift>, StudyError> {
    let densities: &[f64] =
        if quick { &[0.05, 0.52] } else { &[0.05, 0.15, 0.30, 0.40, 0.458, 0.52] };
    let (molecules, settle, time) = if quick { (108, 1000, 4.0) } else { (108, 8000, 20.0) };
    let of_density = |density: &f64| -> Result<Vec<FluidDrift>, StudyError> {
        let mut fluid = equilibrated(*density, molecules, settle)?;
        let mut at =
            |way, bonds: &BondOptions, dt| drift(&mut fluid, (way, bonds), (*density, dt, time));
        let direct = BondOptions::default();
        let mut all = vec![
            at("direct", &direct, 0.002),
            at("relaxation, new direction", &projected(), 0.002),
        ];
        let is_last = densities.last() == Some(density);
        if is_last || (!quick && *density == 0.458) {
            all.extend([
                at("direct", &direct, 0.004),
                at("relaxation, 10⁻⁶", &relaxed(1e-6), 0.002),
                at("spook, τ = 2h", &damped(2.0), 0.002),
                at("spook, τ = 2h", &damped(2.0), 0.004),
                at("spook, τ = h/2", &damped(0.5), 0.002),
            ]);
        }
        Ok(all)
    };
    let found = jobs::side_by_side_quietly(densities, of_density);
    let found: Vec<Vec<FluidDrift>> = found.into_iter().collect::<Result<_, _>>()?;
    Ok(found.concat())
}

/// State points beside the equations of state.
pub(crate) fn states(quick: bool) -> Result<Vec<StateResults>, StudyError> {
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
        let by = |which: usize| -> (f64, f64) {
            let equations = two_center(LENGTH).map(|both| both[which].at(*density, temperature));
            equations.map_or((f64::NAN, f64::NAN), |s| (s.potential_energy, s.pressure))
        };
        Ok(StateResults {
            density: *density,
            temperature,
            energy: value("potential_energy"),
            pressure: value("pressure"),
            lisal: by(0),
            mecke: by(1),
        })
    };
    jobs::side_by_side_quietly(densities, of_density).into_iter().collect()
}
