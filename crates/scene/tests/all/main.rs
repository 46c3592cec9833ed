//! Tests of scene files from outside: reading, writing, lock files, hostile input, error texts.

mod hostile;
mod inputs;
mod keys;
mod lock;
mod messages;
mod reading;
