//! `lennard energy`: one evaluation.

use lennard_engine::Evaluated;
use lennard_io::{Frame, FrameStyle};

use crate::program::args::EnergyArgs;
use crate::program::commands::{answer, load_locked, on_threads};
use crate::program::failure::Failure;
use crate::program::show::{self, Style};

/// Evaluates the start configuration once and prints energy, virial and pressure.
pub fn energy(args: &EnergyArgs) -> Result<u8, Failure> {
    let (scene, lock) = load_locked(&args.scene)?;
    if let Some(file) = &args.forces {
        args.scene.inputs(&scene, lock.as_ref()).are_not(file)?;
    }
    let threads = args.scene.threads.map_or(1, usize::from);
    let evaluated = on_threads(threads, || Ok(lennard_engine::evaluate_energy(&scene)?))?;
    if let Some(path) = &args.forces {
        let Evaluated { report, species, state } = &evaluated;
        let style = FrameStyle {
            forces: true,
            wrapped: false,
            species: species.clone(),
            sites_per_molecule: scene.molecules().sites(),
            ..Default::default()
        };
        let extra = [("total_potential_energy", report.potential_energy)];
        lennard_io::write_frame(path, &style, &Frame { state, extra: &extra })?;
    }
    answer(args.scene.json, false, &evaluated.report, || {
        show::print(&show::energy(&evaluated.report), Style::Ruled);
    })
}
