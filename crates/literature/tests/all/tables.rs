//! The tables that come along: whole, named, read from somewhere, and in agreement with the equations of state.

use std::collections::BTreeSet;
use std::path::Path;

use lennard_literature::{Status, reference_table, reference_tables, thol_2016};
use serde::Deserialize;

fn rows<T: for<'a> Deserialize<'a>>(name: &str) -> Vec<T> {
    csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_reader(reference_table(name).unwrap().csv.as_bytes())
        .deserialize()
        .collect::<Result<_, _>>()
        .unwrap()
}

/// All CSV files below a folder, as text.
fn csv_files(folder: &Path, into: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            csv_files(&path, into);
        } else if path.extension().is_some_and(|e| e == "csv") {
            into.push(std::fs::read_to_string(path).unwrap());
        }
    }
}

#[test]
fn every_table_that_comes_along_is_listed_with_source_and_status_and_none_is_recalled() {
    let mut files = Vec::new();
    csv_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("data"), &mut files);
    assert_eq!(files.len(), reference_tables().len());
    let mut names = BTreeSet::new();
    for table in reference_tables() {
        assert!(files.iter().any(|text| text == table.csv), "{}", table.name);
        assert!(names.insert(table.name), "{} twice", table.name);
        assert!(table.csv.starts_with('#'), "{}: no line that says what it holds", table.name);
        assert!(!table.source.is_empty() && !table.licence.is_empty());
        assert!(table.doi.is_none_or(|doi| doi.starts_with("10.")));
        let rows = table.csv.lines().filter(|l| !l.starts_with('#'));
        for row in rows {
            assert!(!row.contains("from memory") && !row.contains("Verlet 1967"), "{row}");
        }
        if table.status == Status::Verified {
            assert!(
                !table.csv.lines().filter(|l| !l.starts_with('#')).any(|l| l.contains("secondary"))
            );
        }
    }
}

#[derive(Deserialize)]
struct Energy {
    #[serde(rename = "T")]
    t: f64,
    rho: f64,
    #[serde(rename = "U")]
    u: f64,
    #[serde(rename = "U_blockstd")]
    error: f64,
}

#[test]
fn energies_by_monte_carlo_are_those_of_thol_2016() {
    let table: Vec<Energy> = rows("monte-carlo-energies");
    assert_eq!(table.len(), 10);
    for row in table {
        let found = thol_2016().at(row.rho, row.t).potential_energy;
        // The equation's own distance from simulation, as its authors and NIST's data have it.
        assert!(
            (found - row.u).abs() < 0.0025 + 2.0 * row.error,
            "{} {}: {found} {}",
            row.rho,
            row.t,
            row.u
        );
    }
}

#[test]
fn critical_points_of_the_full_potential_lie_around_that_of_the_equation() {
    #[derive(Deserialize)]
    struct Row {
        system: String,
        point: String,
        #[serde(rename = "T")]
        t: String,
    }
    let table: Vec<Row> = rows("critical-and-triple-points");
    let ours = thol_2016().spec().critical.temperature;
    let found: Vec<f64> = table
        .iter()
        .filter(|r| r.system == "full LJ" && r.point == "critical")
        .map(|r| r.t.split('(').next().unwrap().parse().unwrap())
        .collect();
    assert!(!found.is_empty());
    assert!(found.iter().all(|t| (t - ours).abs() < 0.015), "{found:?} {ours}");
}
