//! An observable of one's own: the share of particles that are faster than twice the thermal speed.
#![allow(clippy::print_stdout)] // printing is what this program is for

use lennard::parts::{Average, Estimate, Findings, Observable, ObservableSpec, View, persist};
use lennard::prelude::*;
use lennard::statistics;

static SPEC: ObservableSpec = ObservableSpec {
    name: "fast-share",
    summary: "share of particles that are faster than twice the thermal speed √(T/m)",
    equation: "⟨number of particles with v > 2·√(T/m)⟩ / N",
    source: "the distribution of Maxwell: erfc(√2) + √(8/π)·exp(−2) = 0.26146",
    ..ObservableSpec::PLAIN
};

#[derive(Clone)]
struct FastShare {
    temperature: f64,
    samples: Vec<f64>,
}

impl Observable for FastShare {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn sample(&mut self, view: &View<'_>) {
        let velocities = &view.state.velocities;
        let masses = &view.system.masses;
        let is_fast =
            |i: &usize| masses.of(*i) * velocities[*i].length_squared() > 4.0 * self.temperature;
        let fast = (0..velocities.len()).filter(is_fast).count();
        self.samples.push(fast as f64 / velocities.len() as f64);
    }

    fn finish(&self, discarded: f64) -> Findings {
        let cut = (discarded * self.samples.len() as f64) as usize;
        let estimate = statistics::estimate_after(&self.samples, cut);
        Findings { averages: vec![Average::new("fast_share", "", estimate)], ..Findings::default() }
    }
}

persist!(FastShare { samples, fixed temperature });

pub(crate) fn main() -> lennard::Result<()> {
    let temperature = 1.5;
    let scene = SceneBuilder::new()
        .set("system.n_atoms", 256)
        .set("system.density", 0.6)
        .set("system.temperature", temperature)
        .stages([
            toml! { name = "melt" steps = 500 thermostat = { kind = "bussi", tau = 0.2 } },
            toml! { name = "production" steps = 3000 thermostat = { kind = "bussi", tau = 0.2 } },
        ])
        .build()?;
    let share = FastShare { temperature, samples: Vec::new() };
    let mut fluid = Simulation::with_parts(scene, OwnParts::none().observable(10, share))?;
    fluid.run()?;

    let results = fluid.results();
    let share = results.average("fast_share")?;
    assert_eq!(share.reason, "", "nothing speaks against the mean");
    let Estimate { mean, standard_error, .. } = share.estimate;
    println!("fast particles: {mean:.4} ± {standard_error:.4}, by Maxwell 0.2615");
    assert!((mean - 0.261_46).abs() < 5.0 * standard_error);
    Ok(())
}
