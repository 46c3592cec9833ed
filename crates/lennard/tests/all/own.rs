//! Parts that a program brings: they act, their runs go on to the bit, and no scene file stands for them.

use std::fs;
use std::sync::atomic::AtomicBool;

use lennard::parts::{
    Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceTerm, Part, Want,
    remembers_nothing,
};
use lennard::prelude::*;
use lennard::{Ending, Progress};

use crate::examples::own_field::Wave;
use crate::examples::own_integrator::OptimisedVerlet;

/// The field of the example, or a term with a fault.
#[derive(Clone, Copy)]
pub struct Field {
    pub wave: Wave,
    pub fault: Option<&'static str>,
}

remembers_nothing!(Field);

pub const FIELD: Field = Field { wave: Wave { amplitude: 0.1 }, fault: None };

impl ForceTerm for Field {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        let mut found = self.wave.evaluate(at, part, want, forces)?;
        match self.fault {
            Some("leaves one out") => forces[3] = DVec3::NAN,
            Some("no virial") => found.virial = None,
            _ => {}
        }
        Ok(found)
    }

    fn force_on(&self, particle: usize, at: Configuration<'_>) -> DVec3 {
        let sign = if self.fault == Some("another force") { -1.0 } else { 1.0 };
        sign * self.wave.force_on(particle, at)
    }

    fn properties(&self) -> ForceProperties {
        self.wave.properties()
    }
}

/// A fluid that runs with a field and with any method.
pub fn fluid() -> SceneBuilder {
    SceneBuilder::new()
        .set("system.n_atoms", 108)
        .set("system.density", 0.4)
        .set("system.temperature", 1.5)
        .set("truncation.kind", "switch")
        .set("truncation.r_cut", 2.2)
        .stages([
            toml! { name = "melt" steps = 60 thermostat = "bussi" },
            toml! { name = "production" steps = 140 },
        ])
}

pub fn parts() -> OwnParts {
    OwnParts::none().force("wave", FIELD).method(OptimisedVerlet)
}

pub fn prepared(parts: OwnParts) -> lennard::Result<Simulation> {
    Simulation::with_parts(fluid().build()?, parts)
}

/// Asks to stop at a step.
struct StopAt<'a>(u64, &'a AtomicBool);

impl Progress for StopAt<'_> {
    fn update(&mut self, _stage: &str, done: u64, _total: u64) {
        if done >= self.0 {
            self.1.store(true, std::sync::atomic::Ordering::Relaxed);
        }
    }
}

#[test]
fn a_field_adds_its_energy_and_its_force_and_takes_a_degree_of_freedom_back() {
    let mut with = prepared(OwnParts::none().force("wave", FIELD)).unwrap();
    let mut without = prepared(OwnParts::none()).unwrap();
    let k = std::f64::consts::TAU / with.state.cell.lengths().z;
    let energy: f64 = with.state.positions.iter().map(|r| -0.1 * (k * r.z).cos()).sum();
    let difference =
        with.moment().unwrap().potential_energy - without.moment().unwrap().potential_energy;
    assert!((difference - energy / 108.0).abs() < 1e-12, "{difference}");
    with.run().unwrap();
    let record = with.results().record;
    assert_eq!(record.n_dof, 3 * 108 - 2, "momentum along z is not conserved");
    assert!(record.model.contains("with forces of a program"), "{}", record.model);
    assert!(record.comparison.is_empty(), "nothing in a field has a reference");
    let drift = record.conservation.energy_rms_per_atom;
    assert!(drift < 1e-3, "the energy of the field is conserved with the rest: {drift}");
}

#[test]
fn a_method_of_ones_own_steps_and_is_named() {
    let mut own = prepared(OwnParts::none().method(OptimisedVerlet)).unwrap();
    let mut scene = prepared(OwnParts::none()).unwrap();
    own.run().unwrap();
    scene.run().unwrap();
    assert_ne!(own.state.positions, scene.state.positions);
    assert_eq!(own.scene.method_name(), "optimised-verlet");
    let text = own.scene.resolved_toml();
    assert!(text.contains("[program]\nintegrator = \"optimised-verlet\""), "{text}");
}

#[test]
fn a_run_with_parts_goes_on_to_the_bit_in_its_program_and_nowhere_else() {
    let temporary = tempfile::tempdir().unwrap();
    let mut whole = prepared(parts()).unwrap();
    whole.run().unwrap();
    let mut piece = prepared(parts()).unwrap();
    let stop = AtomicBool::new(false);
    let ending = piece.run_watched(&stop, &mut StopAt(90, &stop)).unwrap();
    assert_eq!(ending, Ending::Stopped);
    let file = temporary.path().join("state.lennard");
    piece.save(&file).unwrap();
    let mut loaded = Simulation::load_with_parts(&file, &parts()).unwrap();
    loaded.run().unwrap();
    assert_eq!(loaded.state, whole.state);
    let refused = |parts: &OwnParts| {
        let error = Simulation::load_with_parts(&file, parts).err().expect("refused");
        error.to_string()
    };
    let without = refused(&OwnParts::none());
    assert!(without.contains("`program` does not fit"), "{without}");
    assert!(
        without.contains("field `wave`, integrator `optimised-verlet`, and the program that reads it brings no part"),
        "{without}"
    );
    let others = refused(&OwnParts::none().force("other", FIELD));
    assert!(others.contains("brings field `other`"), "{others}");
}

#[test]
fn the_command_line_refuses_the_folder_of_such_a_run_and_shows_it() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = temporary.path().join("run");
    let record = prepared(parts()).unwrap().run_in_folder(&folder).unwrap();
    assert!(
        record.remarks.iter().any(|r| r.contains("the program of this run brought field `wave`")),
        "{:?}",
        record.remarks
    );
    assert!(fs::read_to_string(folder.join("scene.toml")).unwrap().contains("[program]"));
    let path = folder.to_str().unwrap();
    let lennard = |words: &[&str]| lennard::program::main(words.iter().map(Into::into));
    assert_eq!(lennard(&["lennard", "compare", path]), 0);
    assert_eq!(lennard(&["lennard", "resume", path, "--steps", "10"]), 2);
    let scene = folder.join("scene.toml");
    let out = temporary.path().join("again");
    let again = ["lennard", "run", scene.to_str().unwrap(), "--out", out.to_str().unwrap()];
    assert_eq!(lennard(&again), 2);
    assert!(!out.exists());
}
