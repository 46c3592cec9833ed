//! Names of the files in an output folder.

/// The scene as resolved.
pub(crate) const SCENE: &str = "scene.toml";

/// Instantaneous values.
pub(crate) const THERMO: &str = "thermo.csv";

/// The run record.
pub(crate) const RECORD: &str = "run.json";

/// Names and box for mdtraj.
pub(crate) const TOPOLOGY: &str = "topology.gro";
