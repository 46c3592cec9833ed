//! Sizes that a machine, a file system or a number format cannot hold.

use std::fs;

use crate::program::common::*;

/// Writes 27 particles 1.3 σ apart around a corner of a cube of a side (σ) and their scene.
fn clump(side: &str) -> Place {
    let at = |k: i32| 1.3 * f64::from(k) - 1.5;
    let rows: Vec<String> =
        (0..27).map(|i| format!("Ar {} {} {}\n", at(i % 3), at(i / 3 % 3), at(i / 9))).collect();
    let lattice = format!("Lattice=\"{side} 0 0 0 {side} 0 0 0 {side}\"");
    let start = format!("27\n{lattice} Properties=species:S:1:pos:R:3\n{}", rows.concat());
    let scene = fluid_from("clump.xyz").replace("1.2", "1e-3").replace("2.2", "1.2");
    let scene = format!("{scene}[kernel]\nprecision = \"mixed\"\n");
    Place::with(&[("clump.xyz", &start), ("clump.toml", &scene)])
}

#[test]
fn mixed_precision_in_a_wide_box_is_double_precision_and_says_so() {
    let note = "mixed precision resolves positions up to 4295 σ a side";
    for side in ["4294", "4296", "1e9", "1e30", "1e300"] {
        let place = clump(side);
        let mixed = place.succeed("energy clump.toml");
        assert_eq!(mixed.contains(note), side != "4294", "{mixed}");
        contains(&mixed, &["27 particles, 0 pairs within the cutoff"]);
        let double = place.succeed("energy clump.toml --precision double");
        assert!(mixed.starts_with(&double), "{side}: {mixed}\n{double}");
    }
    let place = clump("1e300");
    for line in ["run clump.toml --no-report", "plan clump.toml --verbose"] {
        let said = place.succeed(line);
        assert!(said.contains(note) && !said.contains("in mixed precision"), "{said}");
    }
}

#[test]
fn a_box_that_grows_too_wide_for_mixed_precision_stops_the_run_with_a_way_out() {
    let scene = "[system]\nn_atoms = 108\nbox = 4294.9\ntemperature = 1.0\n[kernel]\nprecision = \"mixed\"\n\
                 [truncation]\nkind = \"shift\"\n[[stage]]\nname = \"production\"\nsteps = 20_000\nthermostat = \"bussi\"\n\
                 barostat = { kind = \"stochastic-cell-rescaling\", pressure = 1e-12, tau = 1.0 }\n";
    let place = Place::with(&[("gas.toml", scene)]);
    let mixed = place.output("run gas.toml --no-report --quiet --out mixed");
    ended(&mixed, 3, &["take `kernel.precision = \"double\"`"]);
    place.succeed("run gas.toml --no-report --quiet --out double --precision double");
}

#[cfg(target_os = "linux")]
#[test]
fn a_system_without_memory_for_it_is_refused_with_what_would_fit() {
    let few = "[start]\nlattice = \"sc\"\n[system]\nn_atoms = 1_000\nbox = [10, 10, 10]\ntemperature = 1.0\n\
               [[stage]]\nname = \"production\"\nsteps = 10\n";
    let big = few.replace("lattice = \"sc\"", "kind = \"random\"");
    let big = big.replace("1_000", "500_000_000").replace("10, 10, 10", "600, 800, 1041.7");
    let place = Place::with(&[("few.toml", few), ("big.toml", &big)]);
    for (command, more) in [("run", ""), ("energy", ""), ("plan", ""), ("generate lammps", "out")] {
        let limited = format!("ulimit -v 6000000; exec lennard {command} big.toml {more}");
        let words = ["500000000 particles need about ", " GB can be had", "allowed: about "];
        let said = ended(&place.shell(&limited), 1, &words);
        assert!(!said.contains("backtrace"), "{command}: {said}");
    }
    assert_eq!(fs::read_dir(place.root()).unwrap().count(), 2, "nothing is written");
    let run = "ulimit -v 6000000; exec lennard run few.toml --quiet --no-report";
    ended(&place.shell(run), 0, &[]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_beyond_the_limit_of_the_shell_is_reported_by_every_command_that_writes() {
    let place = Place::with(&[]);
    for line in [
        "energy fluid/gas --forces forces.xyz",
        "generate lammps fluid/gas out",
        "run fluid/gas --out run",
    ] {
        let output = place.shell(&format!("ulimit -f 1; exec lennard {line}"));
        ended(&output, 1, &["File too large"]);
    }
}
