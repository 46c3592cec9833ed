//! What a check found.

/// A check's name and what it found wrong.
pub type Finding = (&'static str, Vec<String>);
