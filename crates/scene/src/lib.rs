//! The scene file as typed tables, with errors that name file, line, key, value and what is allowed.
//!
//! A scene is read in four moves. Text becomes values of TOML, with the place of each ([`Scene::parse`]).
//! Overrides are written over them. Each table is checked by [`mod@reference`] and becomes a type by serde, where
//! each method's options type lives beside the method. At last, tables are checked against each other.
//! [`mod@reference`] holds every table and key with default, unit and what is allowed; messages and
//! `inputs/README.md` are made from it.

mod builder;
mod checks;
mod document;
mod error;
mod lattice;
mod limits;
mod load;
mod lock;
mod methods;
mod name;
mod names;
mod read;
pub mod reference;
mod removed;
mod resolved;
mod scene;
mod schema;
mod section;
pub mod shipped;
pub mod study;
mod tables;
mod units;

pub use builder::SceneBuilder;
pub use error::{Place, SceneError, Source};
pub use lock::{Chosen, Judged, Lock, UsedLock};
pub use name::Name;
pub use names::nearest;
pub use removed::{Removed, RemovedKind, all_removed, removed};
pub use scene::Scene;
pub use scene::model::model_kind;
pub use schema::schema;
pub use tables::accuracy::Accuracy;
pub use tables::molecule::{Molecule, MoleculeKind, MoleculeOptions};
pub use tables::output::{Checkpoint, Output, ProgramParts};
pub use tables::species::{Amount, MixtureTables, PairEntry, SpeciesEntry};
pub use tables::stages::{DEFAULT_SPLIT, IntegratorTable, ObservableTable, PressureControl, Stage};
pub use tables::start::{Arrangement, Geometry, HalfCrystal, Lattice, Placement, Slab, System};
pub use tables::walls::{ContactTable, WallTable};
pub use units::{unit_in_words, why_no_substance};
