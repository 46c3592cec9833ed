//! File formats: trajectories, start configurations, tables, the run record, checkpoints.
//!
//! What is written is written whole. A growing file gets whole frames or whole rows, and is cut
//! back to the last whole one where a write fails. A file written once goes to a hidden file beside
//! it, is synced, and is then renamed. Sizes that a file states are checked against the size of the
//! file before memory is taken. A refusal names file, line, what was found and what is allowed.
//!
//! All quantities are in reduced units (σ, τ, ε); see [`FrameStyle::length_scale`] for the one exception.

mod atomic;
mod checkpoint;
mod checkpoint_codec;
mod checkpoint_folder;
mod claim;
mod columns;
mod configuration;
mod error;
mod extended_xyz;
mod folder;
mod foreign;
mod formats;
mod frame;
mod frames;
mod geometry;
mod gro;
mod gunzip;
mod lammps;
mod lammps_data;
mod lammps_data_writer;
mod lammps_dump;
mod lines;
mod nist;
mod particles;
mod record;
mod sink;
mod species_reader;
mod tables;
mod text_frames;
mod topology;
mod trajectory;
mod units;
mod xyz_header;

pub use atomic::{write_json_atomically, write_text_atomically};
pub use checkpoint::{
    CheckpointError, checkpoint_bytes, give_checkpoint, read_checkpoint, read_checkpoint_bytes,
    read_checkpoint_on, write_checkpoint, write_checkpoint_on,
};
pub use checkpoint_codec::{CHECKPOINT_VERSION, Checkpoint, CheckpointMetadata, CheckpointProblem};
pub use checkpoint_folder::CheckpointFolder;
pub use claim::Holder;
pub use configuration::{
    Beside, read_configuration, read_configuration_bytes, read_configuration_in,
};
pub use error::{FormatError, Shown, WriteError, in_shell, path_in_shell, shown};
pub use folder::{
    Existing, FolderError, OutputFolder, create_named_folder, create_numbered_folder,
    is_empty_folder,
};
pub use formats::{FormatSpec, Limits, TrajectoryFormat};
pub use frame::{DEFAULT_PRECISION, Frame, FrameStyle, is_element_symbol};
pub use frames::Frames;
pub use geometry::{EdgeError, box_of_edges, is_same_box};
pub use lammps_data_writer::write_lammps_data;
pub use particles::{LARGEST, StartConfiguration, TrajectoryFrame};
pub use record::{
    AverageRecord, BarostatRecord, Comparison, Conservation, Host, NeighborRecord, PairRecord,
    Performance, RUN_SCHEMA, RanksRecord, RunRecord, SpeciesRecord, StageSeconds, StatePoint,
    ThermostatRecord, cpu_name, read_run_record, read_run_record_bytes,
};
pub use sink::{FileMark, Sink};
pub use species_reader::FoundSpecies;
pub use tables::{
    TableWriter, read_table_csv, read_table_csv_bytes, read_words_csv, write_table_csv,
};
pub use topology::{give_topology_gro, write_topology_gro};
pub use trajectory::{TrajectoryWriter, give_frame, write_frame};
pub use units::FileUnits;
