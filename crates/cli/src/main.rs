//! The program `lennard`.

use std::process::ExitCode;

fn main() -> ExitCode {
    lennard_cli::main(std::env::args_os()).into()
}
