//! Sweeps and comparisons as a user types them.

use std::path::Path;
use std::process::{Command, Output};

const BASE: &str = r#"
[system]
lattice = "fcc"
n_atoms = 108
density = 0.7
temperature = 1.5

[truncation]
r_cut = 2.5

[integrator]
kind = "velocity-verlet"
dt = 0.004

[[stage]]
name = "equilibrate"
steps = 200
thermostat = { kind = "bussi", tau = 0.1 }

[[stage]]
name = "production"
steps = 1500
"#;

fn lennard(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lennard"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn prepared(sweep: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("base.toml"), BASE).unwrap();
    std::fs::write(folder.path().join("sweep.toml"), sweep).unwrap();
    folder
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_sweep_runs_its_points_once_and_every_run_has_a_page() {
    let folder =
        prepared("base = \"base.toml\"\n[grid]\ndensity = [0.5, 0.7]\ntemperature = 1.5\n");
    let first = lennard(
        folder.path(),
        &["sweep", "sweep.toml", "--out", "out", "--json", "--quiet"],
    );
    assert!(first.status.success(), "{}", text(&first.stderr));
    let record: serde_json::Value = serde_json::from_slice(&first.stdout).unwrap();
    assert_eq!(record["points"].as_array().unwrap().len(), 2);
    assert_eq!(record["ending"], "finished");
    let page = std::fs::read_to_string(folder.path().join("out/rho0.5-T1.5/report.html")).unwrap();
    assert!(page.contains("<svg") && !page.contains("src=\"http"));
    assert!(
        folder.path().join("out/report.html").exists()
            && folder.path().join("out/table.csv").exists()
    );

    let again = lennard(
        folder.path(),
        &["sweep", "sweep.toml", "--out", "out", "--json", "--quiet"],
    );
    let again: serde_json::Value = serde_json::from_slice(&again.stdout).unwrap();
    assert!(
        again["points"]
            .as_array()
            .unwrap()
            .iter()
            .all(|p| p["kept"] == true)
    );

    // Another scene must not be taken for the finished one, nor overwrite it unasked.
    let other = [
        "sweep",
        "sweep.toml",
        "--out",
        "out",
        "--quiet",
        "--set",
        "truncation.r_cut=2.2",
    ];
    let refused = lennard(folder.path(), &other);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("another scene"));
}

#[test]
fn comparing_refuses_what_did_not_finish_and_names_a_truncation_without_reference() {
    let folder = prepared("");
    let run = |extra: &[&str]| {
        let all: Vec<&str> = ["run", "base.toml", "--quiet"]
            .iter()
            .chain(extra)
            .copied()
            .collect();
        lennard(folder.path(), &all)
    };
    assert!(
        run(&[
            "--out",
            "shifted",
            "--no-report",
            "--set",
            "truncation.kind=force-shift"
        ])
        .status
        .success()
    );
    assert!(!folder.path().join("shifted/report.html").exists());
    let compared = lennard(folder.path(), &["compare", "shifted"]);
    assert!(compared.status.success());
    let said = text(&compared.stdout);
    assert!(
        said.contains("no equation of state for Lennard-Jones with shifted force"),
        "{said}"
    );
    assert!(!said.contains("Thol"), "{said}");

    // As a killed run leaves it.
    let path = folder.path().join("shifted/run.json");
    let record = std::fs::read_to_string(&path)
        .unwrap()
        .replace("\"finished\": true", "\"finished\": false");
    std::fs::write(&path, record).unwrap();
    let refused = lennard(folder.path(), &["compare", "shifted"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        text(&refused.stderr).contains("did not finish"),
        "{}",
        text(&refused.stderr)
    );
    assert!(refused.stdout.is_empty());
}
