//! Tests of studies from outside.

mod mechanics;
mod stability;
