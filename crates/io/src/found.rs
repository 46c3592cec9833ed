//! What readers of frames and of start configurations return.

use std::collections::BTreeMap;

use lennard_core::{DVec3, PeriodicBox};

/// The species of the particles, as a file names them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FoundSpecies {
    /// The names, in the order in which they appear; none where the file names none.
    pub names: Vec<String>,
    /// The type of LAMMPS beside each name, where a file has both; an element may have several types.
    pub types: Vec<String>,
    /// The number of the name of each particle, `[N]`; empty where there is one name at most.
    pub of_particle: Vec<u8>,
    /// The mass of the particles with each name; one mass where there is no name, and none where the file has no masses.
    pub masses: Vec<f64>,
}

impl FoundSpecies {
    /// Whether no two types have one name.
    #[must_use]
    pub fn elements_tell_apart(&self) -> bool {
        (1..self.types.len()).all(|k| !self.names[..k].contains(&self.names[k]))
    }

    /// The number of the name of particle `i`.
    #[must_use]
    pub fn of(&self, i: usize) -> usize {
        self.of_particle.get(i).map_or(0, |a| usize::from(*a))
    }
}

/// A frame as read, in reduced units: a `length_scale` of the header is taken out.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryFrame {
    /// The periodic box; `None` where the header names none.
    pub cell: Option<PeriodicBox>,
    /// Positions, `[N]`, σ, unwrapped by the image flags where the file has them.
    pub positions: Vec<DVec3>,
    /// Velocities, `[N]`, σ/τ.
    pub velocities: Option<Vec<DVec3>>,
    /// Momenta, `[N]`, m σ/τ, where the file has no masses that make velocities of them.
    pub momenta: Option<Vec<DVec3>>,
    /// Forces, `[N]`, ε/σ.
    pub forces: Option<Vec<DVec3>>,
    /// The species of the particles.
    pub species: FoundSpecies,
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
    /// Momenta, `[N]`, m σ/τ, where the file has no masses that make velocities of them.
    pub momenta: Option<Vec<DVec3>>,
    /// Number of the step, where the file has one.
    pub step: Option<u64>,
    /// Time in τ, where the file has one.
    pub time: Option<f64>,
    /// The species of the particles.
    pub species: FoundSpecies,
    /// Number of frames in the file, of which this is the last.
    pub frames: u64,
}
