//! Remarks on a run before its first step: a long step, an unstable state, means without an error, frames without precision.

use std::f64::consts::PI;

use lennard_core::number::short;
use lennard_core::{DVec3, PeriodicBox, System};
use lennard_literature::freezing_lines_of;
use lennard_scene::{ObservableTable, Output, Scene, Stage};

use crate::Simulation;

/// A step above this part of the stability limit makes the energy drift, and a hot pair ends the run.
const SAFE_PART: f64 = 0.25;
/// Fewer molecules are bodies whose motion is looked at, and no fluid with means.
const FEWEST_OF_A_FLUID: usize = 12;

impl Simulation {
    /// What speaks against the run as the scene plans it, a sentence each.
    #[must_use]
    pub fn foreseen(&self) -> Vec<String> {
        if self.system.n_molecules() < FEWEST_OF_A_FLUID {
            return Vec::new();
        }
        let stages = &self.scene.stages;
        let long_step = stages.iter().find_map(|stage| self.long_step(stage));
        let mut measured = (0..stages.len()).filter(|i| stages[*i].measure);
        let state = measured.clone().find_map(|i| self.no_stable_fluid(i));
        let too_short = measured.next_back().map(|last| self.without_errors(last));
        let states = long_step.into_iter().chain(state);
        states.chain(too_short.into_iter().flatten()).collect()
    }

    /// Says that the step of a stage is above a quarter of the stability limit of its method.
    fn long_step(&self, stage: &Stage) -> Option<String> {
        if self.own.method_name().is_some() {
            return None;
        }
        let method = self.scene.method_of(stage);
        let temperature =
            stage.temperature_from.map_or(stage.temperature, |from| from.max(stage.temperature));
        let limit = self.rough_stable_dt(method.spec(), temperature)?;
        let (name, dt) = (method.spec().name, self.scene.stage_dt(stage));
        if limit == 0.0 {
            return Some(format!(
                "{name} gains energy at every step: take another `integrator.kind`"
            ));
        }
        (dt > SAFE_PART * limit).then(|| {
            format!(
                "dt = {dt} τ of the stage {} is above a quarter of the stability limit of {name}, about {limit:.3} τ at T = {temperature}: take at most {:.4} τ",
                stage.name,
                SAFE_PART * limit
            )
        })
    }

    /// The temperature of a stage: its own where a bath holds it, else the one that the last bath before it left.
    fn temperature_of(&self, index: usize) -> f64 {
        let mut before = self.scene.stages[..=index].iter().rev();
        let held = before.find(|stage| stage.thermostat.is_some() || stage.barostat.is_some());
        held.map_or(self.scene.system.temperature, |stage| stage.temperature)
    }

    /// The density of a stage, σ⁻³, where its barostat does not change it.
    fn density(&self) -> f64 {
        self.system.n_molecules() as f64 / self.state.cell.volume()
    }

    /// Says that the state of a stage is no stable fluid by the equation of state of the model.
    fn no_stable_fluid(&self, index: usize) -> Option<String> {
        let stage = &self.scene.stages[index];
        if self.scene.surfaces().is_some() {
            return None;
        }
        let (_, equation) = self.scene.equation_of_state().ok()?;
        let temperature = self.temperature_of(index);
        let density = match &stage.barostat {
            Some(control) => equation.density(control.pressure, temperature)?,
            None => self.density(),
        };
        let lines = freezing_lines_of(equation);
        if equation.check(density, temperature).is_err() {
            let triple = lines.first()?.t_triple;
            return (temperature < triple).then(|| {
                format!("T = {temperature:.4} is below the triple temperature {triple}, where no liquid is stable")
            });
        }
        let words = equation.unstable(density, temperature)?;
        let melting = lines.first().and_then(|line| line.melting_density(temperature));
        Some(match melting.filter(|melting| density > *melting) {
            Some(melting) => format!(
                "{words}, and above melting: the crystal is stable from ρ = {melting:.4} on"
            ),
            None => words,
        })
    }

    /// Says which means of the measured part, whose last stage this is, will have no error.
    fn without_errors(&self, last: usize) -> Vec<String> {
        let scene = &self.scene;
        let dt = scene.stage_dt(&scene.stages[last]);
        let steps = scene.measured_steps();
        let length = steps as f64 * dt;
        let rows = steps / scene.output.thermo_every;
        let temperature = self.temperature_of(last);
        let doubt = self.thermodynamics().foreseen(length, rows, self.density(), temperature);
        if let Some(doubt) = doubt {
            return vec![format!("no mean will have an error: {}", doubt.reason(steps))];
        }
        let too_short = |table: &ObservableTable| {
            let (name, least) = (table.options.name(), table.options.least_length());
            let words = format!("{length:.1} τ are measured where {least:.1} τ are needed");
            (length < least).then(|| format!("{name} will have no error: {words}"))
        };
        scene.observables.iter().filter_map(too_short).collect()
    }
}

/// What is to be known of frames whose coordinates are too large for the precision asked for.
pub(crate) fn less_precision(output: &Output, kept: f64) -> Option<String> {
    let (limits, precision) = output.format.spec().limits.zip(output.precision)?;
    (kept < precision).then(|| {
        format!(
            "frames of {} with coordinates above {:.1} σ have the precision {kept} in place of {precision}",
            output.format.spec().file,
            limits.multiples / precision
        )
    })
}

/// What is to be known of a scene and its start, a sentence each.
pub(crate) fn of_scene(
    scene: &Scene,
    system: &System,
    cell: &PeriodicBox,
    positions: &[DVec3],
) -> impl Iterator<Item = String> {
    let temperatures = scene.stages.iter().map(|stage| stage.temperature);
    let hottest = temperatures.fold(scene.system.temperature, f64::max);
    let of_bonds = [remark_on_springs(scene), remark_on_damping(scene)];
    let beyond = scene.potential.remark_at(hottest);
    let of_frames = remark_on_reach(scene, hottest, system, cell, positions);
    of_bonds.into_iter().chain([beyond, of_frames]).flatten()
}

/// Standard deviations of a displacement that the farthest of all particles does not pass, nearly always.
const DEVIATIONS: f64 = 5.0;

/// How far the lightest particles may move along an axis in a run at temperature T, σ.
///
/// The estimate is five standard deviations: √(T/m)·t in free flight, and √(2Dt) with D = 3/(8ρσ²)·√(T/(πm)) of hard spheres
/// of diameter σ, whichever is less. A denser fluid diffuses more slowly.
/// Source: Chapman and Cowling, The mathematical theory of non-uniform gases, first approximation.
fn displacement(time: f64, temperature: f64, mass: f64, density: f64) -> f64 {
    let diffusion = 3.0 / (8.0 * density) * (temperature / (PI * mass)).sqrt();
    let flight = (temperature / mass).sqrt() * time;
    DEVIATIONS * flight.min((2.0 * diffusion * time).sqrt())
}

/// A remark where unwrapped positions may grow too large for the precision of the trajectory.
fn remark_on_reach(
    scene: &Scene,
    temperature: f64,
    system: &System,
    cell: &PeriodicBox,
    positions: &[DVec3],
) -> Option<String> {
    let output = &scene.output;
    let (limits, precision) = output.format.spec().limits.zip(output.precision)?;
    if output.trajectory_every.is_none() || !output.unwrapped {
        return None;
    }
    let start = positions.iter().map(|r| r.abs().max_element());
    let masses = system.species().all().iter().map(|one| one.mass);
    let time: f64 =
        (scene.stages.iter()).map(|stage| stage.steps as f64 * scene.stage_dt(stage)).sum();
    let moved = displacement(
        time,
        temperature,
        masses.fold(f64::INFINITY, f64::min),
        system.len() as f64 / cell.volume(),
    );
    let reach = system.own().largest(start.fold(0.0, f64::max)) + moved;
    let kept = limits.precision_for(precision, reach);
    let remark = less_precision(output, kept)?;
    Some(format!("unwrapped positions may reach {reach:.0} σ: {remark}"))
}

/// ω·dt of a spring above which a step is said to be long for it.
const LONG_STEP: f64 = 0.5;

/// A remark where a step is long for the springs of bonds, though stable: the vibration is then off by (ω·dt)²/24 or more.
fn remark_on_springs(scene: &Scene) -> Option<String> {
    let omega = scene.molecule.as_ref()?.fastest_vibration();
    let steps = scene.stages.iter().map(|stage| scene.stage_dt(stage));
    let dt = steps.fold(0.0, f64::max);
    (omega * dt > LONG_STEP).then(|| {
        format!(
            "dt = {} τ is long for the springs of the bonds: ω·dt = {:.2}, and their vibration is off by {:.0} %; \
             at {:.2e} τ it is off by 1 %",
            short(dt),
            omega * dt,
            100.0 * (omega * dt).powi(2) / 24.0,
            LONG_STEP / omega
        )
    })
}

/// A remark where bonds lose energy: who reads a conserved energy that stays must know that the energy does not.
fn remark_on_damping(scene: &Scene) -> Option<String> {
    let bonds = &scene.molecule.as_ref()?.bonds;
    let counted = match bonds.spec().integrator.is_some() && scene.solves_contacts() {
        false => "the conserved energy counts it as heat",
        true => "beside contacts no heat is counted, and the conserved energy falls by it",
    };
    bonds.damps_vibrations().then(|| {
        format!(
            "[bonds] method = {:?} takes energy from vibrations: {counted}, and no bath keeps vibrations at its temperature",
            bonds.name()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gas_flies_and_a_liquid_diffuses() {
        let flight = displacement(0.1, 2.0, 4.0, 0.001);
        assert!((flight - 0.5 * 0.5_f64.sqrt()).abs() < 1e-12);
        // D of argon near its triple point is 0.03 σ²/τ, a fifth of the estimate.
        let liquid = displacement(1e4, 0.7, 1.0, 0.85);
        assert!(liquid > 5.0 * (2.0 * 0.03 * 1e4_f64).sqrt() && liquid < 500.0);
    }
}
