//! Features of shared libraries. There is no code here.
//!
//! Cargo compiles a library with the features that the chosen packages ask for. Another choice of packages may ask for fewer
//! features. It would then compile the library and everything above it a second time: four minutes for `cargo build` after
//! `cargo test`. The lowest crate depends on this one, so every choice asks for the same features.
