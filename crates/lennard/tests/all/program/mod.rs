//! Black-box tests: `lennard` as a user runs it.

mod bad_input;
mod bad_scenes;
mod bench;
mod chart;
mod commands;
mod common;
mod documents;
mod eos;
mod export;
mod faults;
mod first_steps;
mod limits;
mod literature;
mod messages;
mod mixtures;
mod numbers;
mod output_folders;
mod ranks;
mod restart;
mod shared_sweeps;
mod signals;
mod starts_and_ends;
mod tables;
mod texts_of_users;
mod tune;
mod verdicts;
