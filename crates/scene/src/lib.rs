//! The scene file as typed tables, with errors that name file, line, key, value and what is allowed.
//!
//! A scene is read in four moves. Text becomes values of TOML, with the place of each ([`Scene::parse`]).
//! Overrides are written over them. Each table is checked by [`mod@reference`] and becomes a type by serde, where
//! each method's options type lives beside the method. At last, tables are checked against each other.
//! [`mod@reference`] holds every table and key with default, unit and what is allowed; messages and
//! `inputs/README.md` are made from it.

mod accuracy;
mod baths;
mod bodies;
mod builder;
mod checks;
mod confined;
mod contact;
mod document;
mod error;
mod exchange;
mod half_crystal;
mod insertion;
mod integrator;
mod lattice;
mod lock;
mod methods;
mod mixture;
mod model_kind;
mod molecule;
mod name;
mod names;
mod observable;
mod output;
mod phases;
mod planar;
mod program;
mod read;
mod read_molecule;
pub mod reference;
mod removed;
mod resolved;
mod scene;
mod schema;
mod section;
pub mod shipped;
mod slab;
mod stage;
mod start;
pub mod study;
mod system;
mod walls;

pub use accuracy::Accuracy;
pub use builder::SceneBuilder;
pub use contact::ContactTable;
pub use error::{Place, SceneError, Source};
pub use half_crystal::HalfCrystal;
pub use integrator::DEFAULT_SPLIT;
pub use lock::{Chosen, Judged, Lock, UsedLock};
pub use mixture::{Amount, MixtureTables, PairEntry, SpeciesEntry};
pub use model_kind::model_kind;
pub use molecule::{Molecule, MoleculeKind, MoleculeOptions};
pub use name::Name;
pub use names::nearest;
pub use program::ProgramParts;
pub use removed::{Removed, RemovedKind, all_removed, removed};
pub use scene::{
    Checkpoint, Geometry, IntegratorTable, Lattice, ObservableTable, Output, Placement,
    PressureControl, Scene, Stage, System,
};
pub use schema::schema;
pub use slab::Slab;
pub use start::Start;
pub use walls::WallTable;
