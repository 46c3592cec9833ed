//! The tables of a scene as types: what each holds, the keys that a scene file writes for it, and one from the other.

use serde::Serialize;

pub(crate) mod accuracy;
pub(crate) mod molecule;
pub(crate) mod output;
pub(crate) mod species;
pub(crate) mod stages;
pub(crate) mod start;
pub(crate) mod units;
pub(crate) mod walls;

/// What is written for a planar tail.
pub(crate) const PLANAR: &str = "planar";

/// A value as a scene file writes it.
pub(crate) fn as_toml(value: &impl Serialize) -> String {
    toml::Value::try_from(value).map_or_else(|error| error.to_string(), |value| value.to_string())
}
