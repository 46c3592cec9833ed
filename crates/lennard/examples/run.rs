//! A liquid near its triple point: means with errors beside the equation of state, and the first peak of g(r).
#![allow(clippy::print_stdout)] // printing is what this program is for

use lennard::prelude::*;

pub(crate) fn main() -> lennard::Result<()> {
    let scene = SceneBuilder::open("verlet-1967/triple-point")
        .set("system.n_atoms", 256)
        .set("stage.production.steps", 3000)
        .observables([toml! { kind = "rdf" every = 20 }])
        .build()?;
    let mut liquid = Simulation::new(scene)?;
    liquid.run()?;

    let results = liquid.results();
    for row in &results.record.comparison {
        println!(
            "{}: {:.3} ± {:.3} {}, {:.3} by {}",
            row.quantity, row.measured, row.standard_error, row.unit, row.reference, row.source
        );
    }
    let g = results.table("rdf")?.numbers("g").unwrap_or_default();
    println!("first peak of g(r): {:.2}", g.iter().fold(0.0_f64, |peak, g| peak.max(*g)));

    liquid.add_stage(toml! { name = "hot" steps = 500 temperature = 2.0 thermostat = "bussi" })?;
    liquid.run()?;
    println!("T after heating: {:.2}", liquid.moment()?.temperature);
    Ok(())
}
