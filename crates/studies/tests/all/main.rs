//! Tests of studies from outside.

mod figures;
mod mechanics;
mod settings;
mod stability;
