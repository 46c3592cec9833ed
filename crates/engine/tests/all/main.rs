//! Tests of runs from outside: invariants, same bits, watching, hostile input.

mod bodies;
mod collisions;
mod common;
mod crystals;
mod damped_bonds;
mod exchange;
mod foreign_starts;
mod growing;
mod hostile;
mod invariants;
mod mixtures;
mod molecules;
mod output;
mod pressure;
mod ranks;
mod refusals;
mod response;
mod same_bits;
mod slabs;
mod structure_tail;
mod walls;
mod watching;
