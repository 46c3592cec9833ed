//! `lennard study bench` as a user types it.

use crate::program::common::*;

/// As little as can be measured.
const LITTLE: &str = "study bench --quick --isa portable --threads 1 --repeats 1 --set system.n_atoms=108 --set truncation.r_cut=2.2";

#[test]
fn one_document_holds_every_number_and_the_folder_the_pictures() {
    let place = Place::with(&[]);
    let study = place.json(&format!("{LITTLE} --out out"));
    assert_eq!(study["schema"], "lennard-bench/1");
    assert_eq!(study["atoms"], 108);
    assert_eq!(study["command"], format!("lennard {LITTLE}"));
    let kernels = study["kernels"].as_array().unwrap();
    assert_eq!(kernels.len(), 1, "double: portable lanes have no mixed precision");
    for kernel in kernels {
        assert_eq!(kernel["isa"], "portable");
        for key in ["speed", "step_ns", "forces_ns", "totals_ns", "build_ns", "list_share"] {
            assert!(number(&kernel[key]["median"]) >= 0.0, "{key}");
        }
        for key in ["lanes_per_pair", "limit", "limit_share", "bytes_per_atom", "skin"] {
            assert!(number(&kernel[key]) > 0.0, "{key}");
        }
    }
    assert!(number(&study["skin"]["excess"]) >= 0.0);
    let files = "bench.json kernels.csv skins.csv report.html figures/speed.svg figures/skins.svg \
        figures/parts-portable-double.svg";
    for file in files.split(' ') {
        assert!(place.has(&format!("out/{file}")), "{file}");
    }
    let words = [
        "processor: ",
        "portable double",
        "M atom-steps/s",
        "everything in registers",
        "above the cheapest of the scan",
    ];
    contains(&place.succeed(&format!("{LITTLE} --out table")), &words);
}

#[test]
fn bad_input_is_refused_before_anything_is_made() {
    let place = Place::with(&[]);
    let mut table = vec![
        ("--isa sse9", "`kernel.isa` is not a known name"),
        ("--precision single", "`kernel.precision` is not a known name"),
        ("--repeats 0", "--repeats"),
        ("--repeats many", "--repeats"),
        ("--threads 1,0", "--threads"),
        ("--set system.n_atom=4", "nearest: n_atoms"),
        ("--set system.n_atoms=7", "error: reading the scene: "),
        ("--set truncation.r_cut=99", "`truncation.r_cut`"),
        ("nowhere.toml", "nowhere.toml"),
        ("--features", "-p lennard-benches --bin features"),
    ];
    // An instruction set that is known and not here: on any processor at least one of them.
    let here = lennard_forcefield::available_isas();
    for (isa, line) in [("avx512", "--isa avx512"), ("avx2", "--isa avx2")] {
        if !here.contains(&isa) {
            table.push((line, "allowed: auto, or one that this processor has"));
        }
    }
    for (arguments, wanted) in table {
        place.refused(&format!("study bench --quick --out out {arguments}"), &[wanted]);
        assert!(!place.has("out"), "{arguments} left a folder");
    }
}
