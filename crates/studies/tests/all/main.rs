//! Tests of studies from outside.

mod mechanics;
mod messages;
mod stability;
