//! Tests of equations of state and tables against published numbers.

mod coexistence;
mod equations;
mod tables;
mod two_center;
