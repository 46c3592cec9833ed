//! Tests of the library `lennard`.

mod bits;
mod examples;
mod own;
mod program;
mod refusals;
