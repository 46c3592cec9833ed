//! Says what to install where MPI is missing: the bindings below stop with reasons, and name no package.

use std::env;
use std::process::{Command, Stdio};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if env::var_os("CARGO_FEATURE_MPI").is_none() {
        return;
    }
    println!("cargo::rerun-if-env-changed=MPICC");
    let compiler = env::var("MPICC").unwrap_or_else(|_| "mpicc".to_owned());
    let silent = || Stdio::null();
    let asked = Command::new(&compiler).arg("-show").stdout(silent()).stderr(silent()).status();
    if asked.is_err() {
        for line in [
            &format!("MPI is missing: `{compiler}` does not start"),
            "on Debian and Ubuntu: apt-get install libopenmpi-dev openmpi-bin libclang-dev",
            "from PyPI: pip install mpich libclang, then set MPICC, LIBCLANG_PATH and LD_LIBRARY_PATH (docs/cluster.md)",
        ] {
            println!("cargo::error={line}");
        }
    }
}
