//! Hostile input: what each reader is given, and what must hold whatever it is.
//!
//! A body is a plain function of bytes that panics where something is wrong. `cargo xtask fuzz` feeds it
//! seeded mutations of the files in `fuzz/corpus` on stable Rust and counts them; `fuzz/libfuzzer` hands the same
//! bodies to cargo-fuzz.

mod mutate;
mod restart;
mod targets;

pub use mutate::Mutator;
pub use targets::{Reshape, TARGETS, Target, read};
