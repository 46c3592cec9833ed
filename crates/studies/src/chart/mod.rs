//! `lennard chart`: speed against accuracy, for one scene with many settings.
//!
//! All runs begin at one equilibrated start. What each finishes is stored in the output folder, so that the same command
//! goes on where it was stopped.

mod advice;
mod figures;
mod grid;
mod kinds;
mod measure;
mod page;
mod panels;
mod peers;
mod store;
mod tables;
mod types;

pub use page::summary;
pub use store::{POINTS, has_points};
pub use types::{
    Advice, Axis, Chart, ChartError, ChartOptions, ChartedPoint, Errors, Lengths, Mark, Outcome,
    Panel, Size, Tightest,
};

use lennard_scene::Scene;

use crate::sweep::Sweep;
use crate::{Progress, files};

/// Measures the points of a study that are not measured yet, all from one start of its scene, and writes the chart; where it was stopped, with what there is.
///
/// # Errors
/// [`ChartError`] where the scene cannot be run, the folder holds something else, or a file cannot be written.
pub fn run(
    scene: &Scene,
    study: &Sweep,
    options: &ChartOptions<'_>,
    progress: &mut dyn Progress,
) -> Result<Chart, ChartError> {
    let chart = measure::all(scene, study, options, progress)?;
    let mut tables = vec![tables::points(&chart)];
    tables.extend(chart.panels.iter().map(|p| tables::panel(&chart, p)));
    let page = page::page(&chart, &options.command);
    files::write_all(options.folder, &tables, ("study.json", &chart), &page)?;
    for panel in &chart.panels {
        let path = options.folder.join(format!("{}.json", panel.name));
        lennard_io::write_json_atomically(&path, &tables::panel_json(&chart, panel))?;
    }
    Ok(chart)
}
