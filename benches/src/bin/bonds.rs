//! What rigid bonds cost in a step, on one thread: `bonds SCENE [STEPS] [key=value ...]` with the key `repeats`, and `lattice`,
//! `kind`, `sites`, `length`, `molecules`, `density`, `cutoff`, `dt` and `precision` in place of what the scene says.
//!
//! A state of the fluid moves under its forces of one instant, a few steps to and fro. It does so once with bonds, and once as
//! atoms by the same kicks and drifts. The difference over a whole step of the engine is the share of the bonds.

use std::io::{Write, stdout};
use std::path::Path;
use std::process::ExitCode;

use lennard_benches::arguments::{Arguments, BadArgument, exit_code};
use lennard_core::{BondSolver, BoundDrift, DVec3, Moving, StepError, System, Want, rigid};
use lennard_engine::stopwatch::{Spread, Stopwatch, in_turn};
use lennard_engine::{Simulation, bare, prepare, take};
use lennard_integrators::bonds::BondHolder;
use lennard_scene::Scene;

/// How often each part is measured.
const REPEATS: &str = "repeats";
/// Keys that replace a key of the scene.
const OF_SCENE: [(&str, &str); 9] = [
    ("lattice", "start.lattice"),
    ("kind", "molecule.kind"),
    ("sites", "molecule.sites"),
    ("length", "molecule.bond_length"),
    ("molecules", "system.n_molecules"),
    ("density", "system.density"),
    ("cutoff", "truncation.r_cut"),
    ("dt", "integrator.dt"),
    ("precision", "kernel.precision"),
];
/// Steps under the forces of one instant before the way back: forces in a fluid turn after some ten steps too.
const TO_AND_FRO: usize = 10;
/// Steps before anything is timed: a lattice melts.
const WARM_STEPS: u64 = 1000;

/// An error that may leave the thread that found it.
type Failure = Box<dyn std::error::Error + Send + Sync>;

fn main() -> ExitCode {
    exit_code(measure())
}

fn measure() -> Result<(), Box<dyn std::error::Error>> {
    let keys: Vec<&str> = OF_SCENE.iter().map(|(key, _)| *key).collect();
    let given = Arguments::read(std::env::args().skip(1), &[keys.as_slice(), &[REPEATS]].concat())?;
    let no_scene = || BadArgument("the first word is a scene".to_owned());
    let path = given.word(0).ok_or_else(no_scene)?;
    let steps = given.steps(2000, TO_AND_FRO)?;
    let repeats = given.number(REPEATS, 1)?.unwrap_or(9);
    let settings = OF_SCENE.iter().filter_map(|(key, of_scene)| {
        let value = given.value(key)?;
        Some(((*of_scene).to_owned(), value.to_owned()))
    });
    let settings: Vec<_> = settings.collect();
    let scene = bare(&Scene::load(Path::new(path), &settings)?);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| of_scene(scene, steps, repeats))
        .map_err(|error| error as Box<dyn std::error::Error>)
}

fn of_scene(scene: Scene, steps: usize, repeats: usize) -> Result<(), Failure> {
    let mut simulation = prepare(scene)?;
    take(&mut simulation, WARM_STEPS, Want::NOTHING)?;
    let mut frozen = Frozen::of(&simulation)?;
    let mut found = [const { Vec::new() }; 4];
    in_turn(found.len(), repeats, 1, |turn| -> Result<(), Failure> {
        let watch = Stopwatch::start();
        match turn.item {
            0 => take(&mut simulation, steps as u64, Want::NOTHING)?,
            1 => frozen.atoms(steps),
            2 => frozen.rigid(steps, Stages::Both)?,
            _ => frozen.rigid(steps, Stages::Velocities)?,
        }
        found[turn.item].push(watch.on_processor() / (steps * frozen.x.len()) as f64);
        Ok(())
    })?;
    let spread = |of: &Vec<f64>| Spread::of(of.iter().copied()).expect("one repeat at least");
    let [step, atoms, bonds, velocities] = found.each_ref().map(|of| spread(of).scaled(1e9));
    writeln!(
        stdout(),
        "{} sites in molecules of {}; ns of a processor per site and step, medians of {repeats} (lowest):",
        frozen.x.len(),
        simulation.system.molecules.sites(),
    )?;
    for (name, time) in [
        ("whole step", step),
        ("kicks and drift of atoms", atoms),
        ("kicks, drift and both stages of bonds", bonds),
        ("second kick and velocity stage of these", velocities),
    ] {
        let (median, lowest) = (time.median, time.lowest);
        writeln!(stdout(), "  {name:<40} {median:7.2} ({lowest:.2})")?;
    }
    let share = |of: fn(Spread) -> f64| 100.0 * (of(bonds) - of(atoms)) / of(step);
    writeln!(
        stdout(),
        "  bonds less atoms, of a whole step        {:6.1} % ({:.1} %); at most {} iterations, residual {:.1e}",
        share(|time| time.median),
        share(|time| time.lowest),
        frozen.iterations,
        frozen.residual,
    )?;
    Ok(())
}

/// Which parts of a step are taken.
#[derive(Clone, Copy, PartialEq)]
enum Stages {
    Both,
    Velocities,
}

/// A fluid that moves under the forces of one instant.
struct Frozen {
    system: System,
    x: Vec<DVec3>,
    v: Vec<DVec3>,
    f: Vec<DVec3>,
    dt: f64,
    solver: Box<dyn BondSolver>,
    iterations: u32,
    residual: f64,
}

impl Frozen {
    fn of(simulation: &Simulation) -> Result<Self, BadArgument> {
        let not_rigid = || BadArgument("the bonds of the scene are not held in drifts".to_owned());
        let molecule = simulation.scene.molecule.as_ref().ok_or_else(not_rigid)?;
        let BondHolder::Drift(solver) = molecule.bonds.build(&simulation.system.molecules) else {
            return Err(not_rigid());
        };
        let state = &simulation.state;
        Ok(Self {
            system: simulation.system.clone(),
            x: state.positions.clone(),
            v: state.velocities.clone(),
            f: state.forces.clone(),
            dt: simulation.scene.integrator.dt,
            solver,
            iterations: 0,
            residual: 0.0,
        })
    }

    fn turn(&mut self, step: usize) {
        if step % TO_AND_FRO == TO_AND_FRO - 1 {
            self.v.iter_mut().for_each(|v| *v = -*v);
        }
    }

    /// Steps of the sites without bonds; they return to where they began.
    fn atoms(&mut self, steps: usize) {
        let (x, v) = (self.x.clone(), self.v.clone());
        let (masses, h) = (self.system.masses.clone(), self.dt);
        for step in 0..steps {
            let Self { x, v, f, .. } = self;
            let moving = Moving { positions: &mut *x, velocities: &mut *v, forces: f };
            moving.kick_and_drift(&masses, 0.5 * h, h);
            Moving { positions: x, velocities: v, forces: f }.kick(&masses, 0.5 * h);
            self.turn(step);
        }
        (self.x, self.v) = (x, v);
    }

    /// Steps of RATTLE, or its second half alone.
    fn rigid(&mut self, steps: usize, stages: Stages) -> Result<(), StepError> {
        let h = self.dt;
        for step in 0..steps {
            if stages == Stages::Both {
                let moving = BoundDrift {
                    positions: &mut self.x,
                    velocities: &mut self.v,
                    forces: &self.f,
                    kick: Some(0.5 * h),
                    h,
                };
                let drifted = self.solver.drift(&self.system, moving)?;
                self.iterations = self.iterations.max(drifted.iterations);
                self.residual = self.residual.max(drifted.residual);
            }
            rigid::kick_and_project(&self.system, &self.x, &mut self.v, &self.f, 0.5 * h);
            self.turn(step);
        }
        Ok(())
    }
}
