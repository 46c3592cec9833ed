//! A chart of baths as it is written.

use serde::Serialize;

use super::point::EnsemblePoint;
use super::reference::Reference;
use crate::chart::{LeftOut, Plan};

/// Name and version of the schema of [`EnsembleChart`].
pub(super) const SCHEMA: &str = lennard_io::schema!("chart-ensembles", 1);

/// The chart.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EnsembleChart {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// Particles.
    pub atoms: usize,
    /// Temperature, ε/k_B.
    pub temperature: f64,
    /// Pressure of the barostat, ε/σ³.
    pub pressure: f64,
    /// What was run for how long.
    pub plan: Plan,
    /// Whether every point is finished.
    pub finished: bool,
    /// What density and variance of V are compared with; absent where no run is finished.
    pub reference: Option<Reference>,
    /// The points; the scene's own baths stand first.
    pub points: Vec<EnsemblePoint>,
    /// Choices that were not tried, with the reason.
    pub left_out: Vec<LeftOut>,
}
