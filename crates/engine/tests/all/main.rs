//! Tests of runs from outside: invariants, restart, watching, hostile input, error texts.

mod hostile;
mod invariants;
mod messages;
mod pressure;
mod restart;
mod watching;
