//! `lennard chart`: speed against accuracy, for one scene with many settings.
//!
//! All runs begin at one equilibrated start. What each finishes is stored in the output folder, so that the same command
//! goes on where it was stopped.

mod advice;
mod figures;
mod grid;
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
    Advice, Axis, Chart, ChartOptions, ChartedPoint, Errors, Lengths, Mark, Panel, Size, Tightest,
};

use lennard_scene::Scene;

use lennard_observables::Table;

use crate::report::Page;
use crate::sweep::Sweep;
use crate::{Progress, Study, StudyError};

/// Measures the points of a study that are not measured yet, all from one start of its scene, and writes the chart. Where it was
/// stopped, the chart has what there is.
///
/// # Errors
/// [`StudyError`] where the scene cannot be run, the folder holds something else, or a file cannot be written.
pub fn run(
    scene: &Scene,
    study: &Sweep,
    options: &ChartOptions<'_>,
    progress: &mut dyn Progress,
) -> Result<Chart, StudyError> {
    let chart = measure::all(scene, study, options, progress)?;
    chart.write(options.folder)?;
    Ok(chart)
}

impl Study for Chart {
    fn tables(&self) -> Vec<Table> {
        let panels = self.panels.iter().map(|panel| tables::panel(self, panel));
        std::iter::once(tables::points(self)).chain(panels).collect()
    }

    fn page(&self) -> Result<Page, StudyError> {
        Ok(page::page(self))
    }
}
