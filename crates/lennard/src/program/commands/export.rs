//! `lennard generate lammps`: a scene or a run as the input of LAMMPS.

use std::path::Path;

use lennard_engine::{ResumeOptions, Simulation};
use lennard_io::{Existing, FolderError, create_named_folder, path_in_shell};
use serde_json::json;

use crate::program::args::LammpsArgs;
use crate::program::commands::{answer, load_locked, on_threads};
use crate::program::failure::{Failure, INPUT};
use crate::program::lammps::{LammpsExport, export_to_lammps};

/// Writes the files of LAMMPS.
pub fn to_lammps(args: &LammpsArgs) -> Result<u8, Failure> {
    let from = &args.scene.scene;
    let is_run = from.is_dir();
    if is_run && !args.scene.overrides().is_empty() {
        return Err(Failure::new(
            "exporting a run",
            format!(
                "the state of {} belongs to its own scene\n  found:   an override of a key\n  allowed: no override, or a scene",
                from.display()
            ),
            INPUT,
        ));
    }
    let threads = args.scene.threads.map_or(1, usize::from);
    let simulation = match is_run {
        true => {
            let resumed = lennard_engine::resume(from, &ResumeOptions::default());
            resumed
                .map(|resumed| resumed.simulation)
                .map_err(|e| Failure::new("exporting a run", &e, e.exit_code()))?
        }
        false => {
            let (scene, lock) = load_locked(&args.scene)?;
            args.scene.inputs(&scene, lock.as_ref()).not_in(&args.folder)?;
            on_threads(threads, || Ok(lennard_engine::prepare(scene)?))?
        }
    };
    let done = write(args, &args.folder, &simulation)?;
    let files: Vec<String> = done.files.iter().map(|f| f.display().to_string()).collect();
    let schema = lennard_io::schema!("lammps", 1);
    let document = json!({ "schema": schema, "files": files, "remarks": done.remarks });
    answer(args.scene.json, false, &document, || {
        println!(
            "{}: {} particles at step {}, and the commands to go on",
            files.join(", "),
            simulation.state.len(),
            simulation.state.step
        );
        for remark in &done.remarks {
            println!("  not the same: {remark}");
        }
        println!("  cd {} && lmp -in in.lammps", path_in_shell(&args.folder));
    })
}

fn write(
    args: &LammpsArgs,
    folder: &Path,
    simulation: &Simulation,
) -> Result<LammpsExport, Failure> {
    let existing = match args.force {
        true => Existing::Keep,
        false => Existing::Refuse,
    };
    let making = |e: FolderError| Failure::new("making the output folder", e, INPUT);
    let held = create_named_folder(folder, existing).map_err(making)?;
    Ok(export_to_lammps(held.path(), simulation)?)
}
