//! Every example runs; what an example asserts about its numbers is tested with it.

#[path = "../../examples/argon.rs"]
mod argon;
#[path = "../../examples/own_field.rs"]
pub(crate) mod own_field;
#[path = "../../examples/own_integrator.rs"]
pub(crate) mod own_integrator;
#[path = "../../examples/own_observable.rs"]
mod own_observable;
#[path = "../../examples/run.rs"]
mod run;

use lennard::prelude::*;

/// Positions, velocities and energies without a scene have the bits of the scene's run.
#[test]
fn argon_without_a_scene_has_the_bits_of_its_scene() {
    let scene = SceneBuilder::new()
        .set("system.n_atoms", 256)
        .set("system.density", 0.8072)
        .set("system.temperature", 1.5)
        .set("system.seed", 1)
        .set("truncation.kind", "shift")
        .set("integrator.dt", 0.0046)
        .set("output.thermo_every", 10)
        .stages([toml! { name = "production" steps = 200 }])
        .build()
        .unwrap();
    let mut fluid = Simulation::new(scene).unwrap();
    let (cell, start) = (fluid.state.cell, fluid.state.positions.clone());
    fluid.run().unwrap();
    let (state, energies) = argon::argon(cell, start, 1.5, 20).unwrap();
    assert_eq!(state.step, 200);
    assert_eq!(state.positions, fluid.state.positions);
    assert_eq!(state.velocities, fluid.state.velocities);
    let thermo = fluid.thermo();
    let per_particle = |of: fn(&[f64; 2]) -> f64| -> Vec<f64> {
        energies.iter().map(|row| of(row) / 256.0).collect()
    };
    let potential = per_particle(|[potential, _]| *potential);
    let total = per_particle(|[potential, kinetic]| kinetic + potential);
    for (name, ours) in [("potential_energy", potential), ("conserved_energy", total)] {
        let theirs = thermo.numbers(name).unwrap();
        assert_eq!(ours, theirs[theirs.len() - 20..], "{name}");
    }
}

#[test]
fn argon_without_a_scene_keeps_its_energy() {
    argon::main().unwrap();
}

#[test]
fn the_example_of_a_run_runs() {
    run::main().unwrap();
}

#[test]
fn a_field_of_ones_own_makes_the_barometric_density() {
    own_field::main().unwrap();
}

#[test]
fn an_integrator_of_ones_own_beats_verlet_at_the_same_cost() {
    own_integrator::main().unwrap();
}

#[test]
fn an_observable_of_ones_own_agrees_with_maxwell() {
    own_observable::main().unwrap();
}
