//! A simulation as an input of LAMMPS: the same state, potential, truncation, stages and baths, as far as LAMMPS has them.
//!
//! What changes energies or forces and has no equal is refused. What changes the way of a run alone gets the nearest fix, and a
//! remark names it. Source: LAMMPS documentation, one page for each command.

mod input;
mod pairs;
mod script;
mod stages;

use std::path::{Path, PathBuf};

use lennard_core::Axis;
use lennard_scene::Scene;

pub use input::scene_of_lammps;
use lennard_engine::{EngineError, Simulation};
use script::Script;

/// The state in a folder of an export.
const DATA: &str = "start.data";
/// The commands in a folder of an export.
const SCRIPT: &str = "in.lammps";

/// Skin of LAMMPS' units lj, σ, where the simulation has no list.
const USUAL_SKIN: f64 = 0.3;

/// What was exported.
#[derive(Debug, Clone, PartialEq)]
pub struct LammpsExport {
    /// The files written.
    pub files: [PathBuf; 2],
    /// What is not the same in LAMMPS, one sentence each; the script has them too.
    pub remarks: Vec<String>,
}

/// Writes the state of a simulation and an input script into an existing folder.
///
/// The script evaluates the state once (`run 0`) and then runs the stages that are left; of a finished run, the last stage
/// once more.
///
/// # Errors
/// [`EngineError::Scene`] where LAMMPS has no equal of something that energies or forces depend on, [`EngineError::Write`]
/// where a file cannot be written.
pub fn export_to_lammps(
    folder: &Path,
    simulation: &Simulation,
) -> Result<LammpsExport, EngineError> {
    let scene = &simulation.scene;
    refuse_what_has_no_equal(scene)?;
    let mut script = Script::default();
    head(&mut script, simulation);
    pairs::write(&mut script, scene)?;
    middle(&mut script, simulation);
    stages::write(&mut script, simulation)?;
    let Script { text, remarks } = script;
    let (data, input) = (folder.join(DATA), folder.join(SCRIPT));
    let title = format!(
        "Lennard {}: scene {}, step {}, units lj",
        env!("CARGO_PKG_VERSION"),
        scene.name,
        simulation.state.step
    );
    let species = simulation.system.species();
    lennard_io::write_lammps_data(&data, &title, species, &simulation.state)?;
    lennard_io::write_text_atomically(&input, &text)?;
    Ok(LammpsExport { files: [data, input], remarks })
}

fn refuse_what_has_no_equal(scene: &Scene) -> Result<(), EngineError> {
    const WITHOUT: &str = "a scene without";
    let walls = scene.walls.first().map(|wall| format!("walls across {}", Axis::name(wall.axis)));
    let exchanges = scene.stages.iter().any(|stage| stage.exchange.is_some());
    let periodic = "a box that is periodic in all directions";
    let rows = [
        (scene.molecule.is_some(), "molecule", "molecules", "atoms"),
        (scene.contact.is_some(), "contact", "contacts", WITHOUT),
        (!scene.system.held.is_empty(), "system.held", "held particles", WITHOUT),
        (scene.planar_tail, "truncation.tail_correction", "the planar tail", WITHOUT),
        (exchanges, "stage", "exchanges of velocities", WITHOUT),
        (walls.is_some(), "wall.0.kind", walls.as_deref().unwrap_or_default(), periodic),
    ];
    match rows.into_iter().find(|(there, ..)| *there) {
        None => Ok(()),
        Some((_, key, words, allowed)) => {
            let found = format!("{words}, in an export to LAMMPS");
            Err(scene.source.invalid(key, found, allowed).into())
        }
    }
}

fn head(script: &mut Script, simulation: &Simulation) {
    let scene = &simulation.scene;
    let version = env!("CARGO_PKG_VERSION");
    script.comment(format!("Lennard {version}: scene {}", scene.name));
    script.comment(scene.model_name());
    script.comment(format!("lmp -in {SCRIPT}"));
    script.gap();
    script.command("units", "lj");
    script.command("atom_style", "atomic");
    script.command("atom_modify", "map array");
    script.command("boundary", "p p p");
    script.command("read_data", DATA);
    script.gap();
}

fn middle(script: &mut Script, simulation: &Simulation) {
    let scene = &simulation.scene;
    let skin = simulation.list.skin.unwrap_or(USUAL_SKIN);
    script.gap();
    script.command("neighbor", format!("{skin:?} bin"));
    script.command("neigh_modify", "delay 0 every 1 check yes");
    script.gap();
    script.command("thermo_style", "custom step time temp pe ke etotal press vol");
    script.command("thermo_modify", "norm no format float %.15g");
    script.command("thermo", scene.output.thermo_every.to_string());
    script.gap();
    let step = simulation.state.step;
    script.comment("One evaluation. Energies are of the whole system, tails included.");
    script.command("reset_timestep", step.to_string());
    script.command("run", "0");
    for observable in &scene.observables {
        let name = observable.options.name();
        script.remark(format!("the observable {name} is not exported"));
    }
}
