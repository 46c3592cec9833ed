//! Tests of integrators and thermostats from outside, on an oscillator and on a small cluster.

mod barostats;
mod bonds;
mod common;
mod conformance;
mod contacts;
mod fire;
mod force_terms;
mod implicit_and_constrained;
mod many_chains;
mod measure;
mod refusals;
mod shapes;
mod thermostats;
mod verlet_family;
