//! Sizes that a machine, a file system or a number format cannot hold.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::program::common::*;

/// What a command of a shell does in `folder`, where `lennard` is the program.
#[cfg(target_os = "linux")]
fn in_shell(folder: &Path, command: &str) -> Output {
    let command = command.replace("lennard", env!("CARGO_BIN_EXE_lennard"));
    let mut shell = Command::new("sh");
    shell.args(["-c", &command]).current_dir(folder);
    shell.output().unwrap()
}

/// Writes 27 particles 1.3 σ apart around a corner of a cube of a side (σ) and their scene.
fn write_clump(folder: &Path, side: &str) {
    let at = |k: i32| 1.3 * f64::from(k) - 1.5;
    let rows: Vec<String> =
        (0..27).map(|i| format!("Ar {} {} {}\n", at(i % 3), at(i / 3 % 3), at(i / 9))).collect();
    let lattice = format!("Lattice=\"{side} 0 0 0 {side} 0 0 0 {side}\"");
    let start = format!("27\n{lattice} Properties=species:S:1:pos:R:3\n{}", rows.concat());
    fs::write(folder.join("clump.xyz"), start).unwrap();
    let scene = "[start]\nkind = \"file\"\nfile = \"clump.xyz\"\n[system]\ntemperature = 1e-3\n[truncation]\nr_cut = 1.2\n\
                 [kernel]\nprecision = \"mixed\"\n[[stage]]\nname = \"production\"\nsteps = 20\n";
    fs::write(folder.join("clump.toml"), scene).unwrap();
}

#[test]
fn mixed_precision_in_a_wide_box_is_double_precision_and_says_so() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = temporary.path();
    let note = "mixed precision resolves positions up to 4295 σ a side";
    for side in ["4294", "4296", "1e9", "1e30", "1e300"] {
        write_clump(folder, side);
        let energy = |more: &[&str]| {
            let output = lennard_in(folder, &[&["energy", "clump.toml"], more].concat());
            assert!(output.status.success(), "{side}: {}", stderr(&output));
            stdout(&output)
        };
        let mixed = energy(&[]);
        assert_eq!(mixed.contains(note), side != "4294", "{mixed}");
        let pairs = "27 particles, 0 pairs within the cutoff";
        assert!(mixed.contains(pairs), "{side}: {mixed}");
        let double = energy(&["--precision", "double"]);
        assert!(mixed.starts_with(&double), "{side}: {mixed}\n{double}");
    }
    for arguments in
        [&["run", "clump.toml", "--no-report"][..], &["plan", "clump.toml", "--verbose"]]
    {
        let output = lennard_in(folder, arguments);
        let said = stdout(&output);
        assert!(output.status.success() && said.contains(note), "{said}{}", stderr(&output));
        assert!(!said.contains("in mixed precision"), "{said}");
    }
}

#[test]
fn a_box_that_grows_too_wide_for_mixed_precision_stops_the_run_with_a_way_out() {
    let temporary = tempfile::tempdir().unwrap();
    let scene = "[system]\nn_atoms = 108\nbox = 4294.9\ntemperature = 1.0\n[kernel]\nprecision = \"mixed\"\n\
                 [truncation]\nkind = \"shift\"\n[[stage]]\nname = \"production\"\nsteps = 20_000\nthermostat = \"bussi\"\n\
                 barostat = { kind = \"stochastic-cell-rescaling\", pressure = 1e-12, tau = 1.0 }\n";
    fs::write(temporary.path().join("gas.toml"), scene).unwrap();
    let run = ["run", "gas.toml", "--no-report", "--quiet", "--out"];
    let mixed = lennard_in(temporary.path(), &[&run[..], &["mixed"]].concat());
    let said = stderr(&mixed);
    assert_eq!(mixed.status.code(), Some(3), "{said}");
    assert!(said.contains("take `kernel.precision = \"double\"`"), "{said}");
    let double = ["double", "--precision", "double"];
    let double = lennard_in(temporary.path(), &[&run[..], &double].concat());
    assert!(double.status.success(), "{}", stderr(&double));
}

#[cfg(target_os = "linux")]
#[test]
fn a_system_without_memory_for_it_is_refused_with_what_would_fit() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = temporary.path();
    let scene = "[start]\nlattice = \"sc\"\n[system]\nn_atoms = 500_000_000\nbox = [600, 800, 1041.7]\ntemperature = 1.0\n\
                 [[stage]]\nname = \"production\"\nsteps = 10\n";
    fs::write(folder.join("big.toml"), scene.replace("lattice = \"sc\"", "kind = \"random\""))
        .unwrap();
    fs::write(
        folder.join("few.toml"),
        scene.replace("500_000_000", "1_000").replace("600, 800, 1041.7", "10, 10, 10"),
    )
    .unwrap();
    for command in ["run", "energy", "plan", "generate lammps"] {
        let more = if command == "generate lammps" { "lammps" } else { "" };
        let limited = format!("ulimit -v 6000000; exec lennard {command} big.toml {more}");
        let output = in_shell(folder, &limited);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{command}: {said}");
        for word in ["500000000 particles need about ", " GB can be had", "allowed: about "] {
            assert!(said.contains(word), "{command}: {said}");
        }
        assert!(!said.contains("backtrace"), "{command}: {said}");
    }
    let mut left: Vec<_> = fs::read_dir(folder).unwrap().map(|f| f.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["big.toml", "few.toml"]);
    let few = in_shell(folder, "ulimit -v 6000000; exec lennard run few.toml --quiet --no-report");
    assert!(few.status.success(), "{}", stderr(&few));
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_beyond_the_limit_of_the_shell_is_reported_by_every_command_that_writes() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = temporary.path();
    fs::copy(root().join("inputs/fluid/gas.toml"), folder.join("gas.toml")).unwrap();
    for command in [
        "energy gas.toml --forces forces.xyz",
        "generate lammps gas.toml lammps",
        "run gas.toml --out run",
    ] {
        let output = in_shell(folder, &format!("ulimit -f 1; exec lennard {command}"));
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{command}: {said}");
        assert!(said.contains("File too large"), "{command}: {said}");
    }
}
