//! The `lennard` command line.
fn main() {}
