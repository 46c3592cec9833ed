//! The program `lennard`.

use std::process::ExitCode;

fn main() -> ExitCode {
    lennard::program::main(std::env::args_os()).into()
}
