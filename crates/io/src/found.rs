//! What readers of frames and of start configurations return.

use std::collections::BTreeMap;

use lennard_core::{DVec3, PeriodicBox};

/// A frame as read, in reduced units: a `length_scale` of the header is taken out.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryFrame {
    /// The periodic box; `None` where the header names none.
    pub cell: Option<PeriodicBox>,
    /// Positions, `[N]`, σ, unwrapped by the image flags where the file has them.
    pub positions: Vec<DVec3>,
    /// Velocities, `[N]`, σ/τ.
    pub velocities: Option<Vec<DVec3>>,
    /// Forces, `[N]`, ε/σ.
    pub forces: Option<Vec<DVec3>>,
    /// The one species of all particles; `None` where the file names none.
    pub species: Option<String>,
    /// Number of the step.
    pub step: Option<u64>,
    /// Time in τ.
    pub time: Option<f64>,
    /// The other entries of the header, as text.
    pub info: BTreeMap<String, String>,
}

/// Where a run starts, as read from a file; reduced units.
#[derive(Debug, Clone, PartialEq)]
pub struct StartConfiguration {
    /// The periodic box.
    pub cell: PeriodicBox,
    /// Positions, `[N]`, σ, unwrapped by the image flags where the file has them.
    pub positions: Vec<DVec3>,
    /// Velocities, `[N]`, σ/τ, where the file has them.
    pub velocities: Option<Vec<DVec3>>,
    /// Number of the step, where the file has one.
    pub step: Option<u64>,
    /// Time in τ, where the file has one.
    pub time: Option<f64>,
    /// The one species of all particles, where the file names one.
    pub species: Option<String>,
    /// Number of frames in the file, of which this is the last.
    pub frames: u64,
}
