//! Remarks on a run before its first step: a step that is too long, an unstable state, or means without an error.

use lennard_literature::freezing_lines_of;
use lennard_scene::Stage;

use crate::Simulation;
use crate::compare::{equation_for, unstable};

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
        let (_, equation) = equation_for(&self.scene).ok()?;
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
        let words = unstable(equation, density, temperature)?;
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
        let measured = scene.stages.iter().filter(|stage| stage.measure);
        let steps: u64 = measured.map(|stage| stage.steps).sum();
        let length = steps as f64 * dt;
        let rows = steps / scene.output.thermo_every;
        let temperature = self.temperature_of(last);
        let doubt = self.thermodynamics().foreseen(length, rows, self.density(), temperature);
        if let Some(doubt) = doubt {
            return vec![format!("no mean will have an error: {}", doubt.reason(steps))];
        }
        let short = scene.observables.iter().filter(|table| length < table.options.least_length());
        let words =
            |least: f64| format!("{length:.1} τ are measured where {least:.1} τ are needed");
        short
            .map(|table| {
                format!(
                    "{} will have no error: {}",
                    table.options.name(),
                    words(table.options.least_length())
                )
            })
            .collect()
    }
}
