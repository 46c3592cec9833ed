//! The help of `cargo xtask`.

/// Every command with what it does.
pub const HELP: &str = include_str!("help.txt");
