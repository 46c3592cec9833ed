//! `lennard study bench` as a user types it.

use crate::program::common::{lennard, stderr, stdout};

/// As little as can be measured.
const LITTLE: &[&str] = &[
    "study",
    "bench",
    "--quick",
    "--isa",
    "portable",
    "--threads",
    "1",
    "--repeats",
    "1",
    "--set",
    "system.n_atoms=108",
    "--set",
    "truncation.r_cut=2.2",
];

#[test]
fn one_document_holds_every_number_and_the_folder_the_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let arguments = [LITTLE, &["--json", "--out", out.to_str().unwrap()]].concat();
    let output = lennard(&arguments).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let study: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(study["schema"], "lennard-bench/1");
    assert_eq!(study["atoms"], 108);
    assert_eq!(study["command"], format!("lennard {}", LITTLE.join(" ")));
    let kernels = study["kernels"].as_array().unwrap();
    assert_eq!(kernels.len(), 1, "double: portable lanes have no mixed precision");
    for kernel in kernels {
        assert_eq!(kernel["isa"], "portable");
        for key in ["speed", "step_ns", "forces_ns", "totals_ns", "build_ns", "list_share"] {
            assert!(kernel[key]["median"].as_f64().unwrap() >= 0.0, "{key}");
        }
        for key in ["lanes_per_pair", "limit", "limit_share", "bytes_per_atom", "skin"] {
            assert!(kernel[key].as_f64().unwrap() > 0.0, "{key}");
        }
    }
    assert!(study["skin"]["excess"].as_f64().unwrap() >= 0.0);
    for file in ["bench.json", "kernels.csv", "skins.csv", "report.html", "figures/speed.svg"] {
        assert!(out.join(file).exists(), "{file}");
    }
}

#[test]
fn the_table_names_machine_kernels_limit_and_skin() {
    let folder = tempfile::tempdir().unwrap();
    let output = lennard(LITTLE)
        .args(["--out", folder.path().join("out").to_str().unwrap()])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let said = stdout(&output);
    for wanted in [
        "processor: ",
        "portable double",
        "M atom-steps/s",
        "everything in registers",
        "above the cheapest of the scan",
    ] {
        assert!(said.contains(wanted), "wanted `{wanted}` in\n{said}");
    }
}

#[test]
fn bad_input_is_refused_before_anything_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let mut table = vec![
        (vec!["--isa", "sse9"], "`kernel.isa` is not a known name"),
        (vec!["--precision", "single"], "`kernel.precision` is not a known name"),
        (vec!["--repeats", "0"], "--repeats"),
        (vec!["--repeats", "many"], "--repeats"),
        (vec!["--threads", "1,0"], "--threads"),
        (vec!["--set", "system.n_atom=4"], "nearest: n_atoms"),
        (vec!["--set", "truncation.r_cut=99"], "`truncation.r_cut`"),
        (vec!["nowhere.toml"], "nowhere.toml"),
        (vec!["--features"], "-p lennard-benches --bin features"),
    ];
    // An instruction set that is known and not here: on any processor at least one of them.
    let here = lennard_forcefield::available_isas();
    for isa in ["avx512", "avx2"] {
        if !here.contains(&isa) {
            table.push((vec!["--isa", isa], "allowed: auto, or one that this processor has"));
        }
    }
    for (arguments, wanted) in table {
        let output = lennard(&["study", "bench", "--quick", "--out", out.to_str().unwrap()])
            .args(&arguments)
            .output()
            .unwrap();
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(wanted), "{arguments:?}: wanted `{wanted}` in\n{message}");
        assert!(!out.exists(), "{arguments:?} left a folder");
    }
}
