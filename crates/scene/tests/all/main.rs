//! Tests of scene files from outside: reading, writing, lock files, hostile input.

mod hostile;
mod inputs;
mod keys;
mod lock;
mod reading;
