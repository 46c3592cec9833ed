//! Tests of file formats from outside: reading, writing, checkpoints, hostile input, error texts.

mod checkpoints;
mod columns;
mod common;
mod foreign;
mod formats;
mod hostile;
mod lammps;
mod messages;
mod reading;
mod tables_and_record;
mod trajectory;
mod xtc;
