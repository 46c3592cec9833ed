//! One file and one line: no source outside a method's own crate names the method.
//!
//! The check sees variants of the option enums. It cannot see a method's name in quotes.

use std::error::Error;

use crate::workspace::Workspace;

/// The lists of methods: the folder whose files declare them, and the enum of their options.
const LISTS: &[(&str, &str)] = &[
    ("crates/integrators/src/", "IntegratorOptions"),
    ("crates/integrators/src/", "ThermostatOptions"),
    ("crates/integrators/src/", "BarostatOptions"),
    ("crates/integrators/src/", "BondOptions"),
    ("crates/forcefield/src/pair/potentials/", "PotentialOptions"),
    ("crates/forcefield/src/pair/truncations/", "TruncationKind"),
    ("crates/forcefield/src/pair/combining/", "CombiningOptions"),
    ("crates/forcefield/src/walls/", "WallOptions"),
    ("crates/integrators/src/contacts/kinds/", "ContactOptions"),
    ("crates/observables/src/", "ObservableOptions"),
];

/// Files that may name methods, each with the reason.
const EXPLAINED: &[(&str, &str)] = &[
    ("crates/scene/src/scene/model.rs", "which truncation the literature describes"),
    (
        "crates/scene/src/checks/features.rs",
        "which potentials and which truncation have a planar tail",
    ),
    (
        "crates/engine/src/build.rs",
        "thermodynamics is in every run, and the MSD takes a viscosity of the literature",
    ),
    (
        "crates/engine/src/curvature.rs",
        "r²u″ follows from u and −ru′ where the truncation leaves the potential as it is up to r_cut",
    ),
    ("crates/scene/src/read/stages.rs", "thermodynamics has the interval of thermo.csv"),
    ("crates/studies/src/", "a study compares the methods that it is about"),
    ("crates/lennard/examples/", "programs of a user's own name their methods"),
    ("crates/lennard/src/program/", "examples in the help, and each method that LAMMPS has too"),
    ("benches/", "cases of the benchmarks"),
    ("fuzz/", "seeds of the fuzzers"),
    ("crates/xtask/", "checks of the repository"),
];

/// Every naming of a method outside its folder that is not explained.
pub fn faults(workspace: &Workspace) -> Result<Vec<String>, Box<dyn Error>> {
    let mut faults = Vec::new();
    for name in workspace.tracked(&["*.rs"])? {
        let explained = EXPLAINED.iter().any(|(path, _)| name.starts_with(path));
        if explained || name.contains("/tests/") || name.ends_with("tests.rs") {
            continue;
        }
        let Ok(text) = std::fs::read_to_string(workspace.root.join(&name)) else {
            continue;
        };
        faults.extend(named(&name, &text));
    }
    Ok(faults)
}

/// The lines of a file that name a method of another folder.
fn named(file: &str, text: &str) -> Vec<String> {
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let mut faults = Vec::new();
    for (number, line) in (1..).zip(code.lines()) {
        let line = line.split("//").next().unwrap_or_default();
        for (folder, list) in LISTS {
            if file.starts_with(folder) || !names_a_variant(line, list) {
                continue;
            }
            faults.push(format!("{file}:{number} names a method of {list}"));
        }
    }
    faults
}

/// Whether a line has `List::Variant`; functions of the list begin with a small letter.
fn names_a_variant(line: &str, list: &str) -> bool {
    line.match_indices(&format!("{list}::"))
        .any(|(at, path)| line[at + path.len()..].starts_with(|c: char| c.is_ascii_uppercase()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variant_is_found_where_it_has_no_business() {
        let line = "if kind == TruncationKind::Switch { }\n";
        assert_eq!(named("crates/io/src/a.rs", line).len(), 1);
        assert!(named("crates/forcefield/src/pair/truncations/mod.rs", line).is_empty());
        for fine in [
            "TruncationKind::default()",
            "// TruncationKind::Switch",
            "#[cfg(test)]\nmod tests { TruncationKind::Switch }",
        ] {
            assert!(named("crates/io/src/a.rs", fine).is_empty(), "{fine}");
        }
    }
}
