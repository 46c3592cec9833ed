//! `lennard chart --ensemble`: settings of barostat and thermostat, for accuracy against the cost of a step.
//!
//! Every choice samples the same ensemble if it is right. Its ⟨P⟩, density and variance of V stand beside one reference, with their
//! errors. Its pace is the number of independent volumes in a τ.

mod found;
mod grid;
mod measure;
mod page;
mod point;
mod reference;
mod series;

pub use found::EnsembleChart;
pub use page::summary;
pub use point::{Baths, EnsemblePoint, Sampled};
pub use reference::Reference;

use lennard_scene::Scene;

use super::{ChartError, ChartOptions};
use crate::Progress;

/// Refuses a scene whose measured stage holds no pressure that can be sampled with other settings.
///
/// # Errors
/// [`lennard_scene::SceneError`] where it has no barostat, where pressure or temperature change on the way, or where two phases stand side
/// by side.
pub fn suits(scene: &Scene) -> Result<(), lennard_scene::SceneError> {
    grid::pressure_of(scene).map(drop)
}

/// Measures what is not measured yet, and writes the chart; where it was stopped, with what there is.
///
/// # Errors
/// [`ChartError`] where the scene holds no pressure or cannot be run, the folder holds something else, or a file cannot be written.
pub fn run(
    scene: &Scene,
    options: &ChartOptions<'_>,
    progress: &mut dyn Progress,
) -> Result<EnsembleChart, ChartError> {
    let chart = measure::all(scene, options, progress)?;
    page::write(&chart, options)?;
    Ok(chart)
}
