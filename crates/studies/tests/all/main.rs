//! Tests of studies from outside.

mod messages;
mod stability;
