//! What `lennard list` says of one method.

use serde::Serialize;

/// One method of a list.
#[derive(Debug, Serialize)]
pub struct Entry {
    /// Name in scene files.
    pub name: String,
    /// One sentence.
    pub summary: String,
    /// Its equations, if it has any to show.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub equation: Option<String>,
    /// What it declares about itself.
    #[serde(skip_serializing_if = "serde_json::Map::is_empty")]
    pub properties: serde_json::Map<String, serde_json::Value>,
    /// Where it comes from; empty for what is itself a list.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub source: String,
}
