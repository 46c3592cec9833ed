//! Tests of studies from outside.

mod figures;
mod mechanics;
mod messages;
mod stability;
