//! Every check with one command.
fn main() {}
