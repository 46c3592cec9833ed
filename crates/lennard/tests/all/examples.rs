//! Every example runs; what an example asserts about its numbers is tested with it.

#[path = "../../examples/own_field.rs"]
mod own_field;
#[path = "../../examples/own_integrator.rs"]
mod own_integrator;
#[path = "../../examples/own_observable.rs"]
mod own_observable;
#[path = "../../examples/run.rs"]
mod run;

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
