//! Tests of file formats from outside: reading, writing, checkpoints, hostile input.

mod checkpoints;
mod columns;
mod common;
mod foreign;
mod formats;
mod frames;
mod hostile;
mod lammps;
mod reading;
mod refusals;
mod tables_and_record;
mod trajectory;
mod xtc;
