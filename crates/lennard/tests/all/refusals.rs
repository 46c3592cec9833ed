//! What the library refuses, and in which words.

use lennard::parts::{Findings, Observable, ObservableSpec, View, Want, remembers_nothing};
use lennard::prelude::*;

use crate::examples::own_integrator::OptimisedVerlet;
use crate::own::{FIELD, Field, fluid, parts, prepared};
use crate::program::common::contains;

static SPEC: ObservableSpec = ObservableSpec {
    name: "speed",
    summary: "nothing",
    equation: "0",
    source: "none",
    ..ObservableSpec::PLAIN
};

/// An observable that finds nothing.
#[derive(Clone)]
struct Speed;

remembers_nothing!(Speed);

impl Observable for Speed {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn want(&self) -> Want {
        Want::NOTHING
    }

    fn sample(&mut self, _view: &View<'_>) {}

    fn finish(&self, _discarded: f64) -> Findings {
        Findings::default()
    }
}

fn refused(made: lennard::Result<Simulation>) -> String {
    made.err().expect("refused").to_string()
}

fn with_fault(fault: &'static str) -> String {
    let field = Field { fault: Some(fault), ..FIELD };
    refused(prepared(OwnParts::none().force("wave", field)))
}

#[test]
fn a_force_that_breaks_its_contract_is_refused_before_the_first_step() {
    contains(
        &with_fault("no virial"),
        &["`program.fields` does not fit", "`wave`, which gives no virial", "0 where it has none"],
    );
    contains(
        &with_fault("another force"),
        &["whose `force_on` gives", "the same force by both: the watchdog checks one by the other"],
    );
    contains(
        &with_fault("leaves one out"),
        &["whose force on particle 4 is", "a finite force for each particle"],
    );
}

#[test]
fn a_field_goes_with_no_tail_and_a_bath_inside_the_step_with_no_method_of_ones_own() {
    let tail = fluid().set("truncation.kind", "cut").build().unwrap();
    contains(
        &refused(Simulation::with_parts(tail, parts())),
        &["`truncation.tail_correction` assumes a homogeneous fluid", "with a field"],
    );
    let langevin = fluid().set("stage.melt.thermostat", "langevin").build().unwrap();
    let own = OwnParts::none().method(OptimisedVerlet);
    contains(
        &refused(Simulation::with_parts(langevin, own)),
        &[
            "`stage.melt.thermostat` does not fit",
            "`langevin`, which steps in the place of `optimised-verlet`",
            "none, or a bath that acts between steps, such as `bussi`",
        ],
    );
}

#[test]
fn two_observables_of_one_name_are_refused() {
    let twice = OwnParts::none().observable(10, Speed).observable(20, Speed);
    contains(
        &refused(prepared(twice)),
        &["`program.observables` does not fit", "`speed`", "a name that no other observable"],
    );
    assert!(prepared(OwnParts::none().observable(10, Speed)).is_ok());
}

#[test]
fn a_name_that_no_result_has_is_told_with_the_nearest() {
    let mut fluid = prepared(OwnParts::none()).unwrap();
    fluid.step(100).unwrap();
    let results = fluid.results();
    contains(
        &results.average("presure").unwrap_err().to_string(),
        &["the run has no average `presure`", "nearest: pressure"],
    );
    contains(
        &results.average("shear_viscosity_einstein_helfand").unwrap_err().to_string(),
        &["allowed: `shear_viscosity`, the Green–Kubo integral"],
    );
    contains(&format!("{:?}", results.table("rdf").unwrap_err()), &["the run has no table `rdf`"]);
}

#[test]
fn a_folder_takes_whole_runs_alone_and_none_that_is_there() {
    let temporary = tempfile::tempdir().unwrap();
    let mut begun = prepared(OwnParts::none()).unwrap();
    begun.step(5).unwrap();
    let folder = temporary.path().join("run");
    let error = begun.run_in_folder(&folder).unwrap_err().to_string();
    contains(
        &error,
        &["a folder holds a run from its first step, and this simulation has done 5 steps"],
    );
    assert!(!folder.exists());
    let error = Simulation::load(&folder).err().expect("refused").to_string();
    contains(&error, &["run"]);
}
