//! Runs with a potential from a table, from the first step to a file that has changed.

use std::fs;
use std::path::Path;
use std::process::Output;

use crate::program::common::{lennard, stderr};

const SCENE: &str = r#"
[system]
n_atoms = 108
density = 0.8442
temperature = 1.2
[potential]
kind = "table"
file = "tables/fluid.table"
[truncation]
kind = "switch"
r_cut = 2.2
[integrator]
dt = 0.002
[[stage]]
name = "production"
steps = 300
[output]
trajectory_every = 20
[checkpoint]
every_steps = 100
"#;

/// Writes a table of Lennard-Jones times a factor.
fn write_table(folder: &Path, factor: f64) {
    let row = |k: u32| {
        let r = 0.7 + 0.01 * f64::from(k);
        let u = 4.0 * (r.powi(-12) - r.powi(-6));
        let f = (48.0 * r.powi(-12) - 24.0 * r.powi(-6)) / r;
        format!("{r} {} {}\n", factor * u, factor * f)
    };
    let rows: String = (0..200).map(row).collect();
    fs::create_dir_all(folder.join("tables")).unwrap();
    fs::write(folder.join("tables/fluid.table"), rows).unwrap();
}

fn call(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = lennard(arguments);
    command.current_dir(folder).output().unwrap()
}

fn ok(output: &Output) {
    assert!(output.status.success(), "{}", stderr(output));
}

#[test]
fn a_run_goes_on_to_the_byte_with_its_table_and_not_with_a_changed_one() {
    let temporary = tempfile::tempdir().unwrap();
    let at = temporary.path();
    write_table(at, 1.0);
    fs::write(at.join("scene.toml"), SCENE).unwrap();
    let run = ["run", "scene.toml", "--quiet", "--out"];
    let steps = ["--set", "stage.production.steps=200"];
    ok(&call(at, &[&run[..], &["whole"]].concat()));
    ok(&call(at, &[&run[..], &["parts"], &steps].concat()));
    let resume = ["resume", "parts", "--quiet", "--steps", "100"];
    ok(&call(at, &resume));
    let read = |file: &str| fs::read(at.join(file)).unwrap();
    assert!(read("whole/trajectory.xyz") == read("parts/trajectory.xyz"));
    let record = fs::read_to_string(at.join("whole/run.json")).unwrap();
    for part in ["fluid.table", "\"checksum\"", "spline within"] {
        assert!(record.contains(part), "no {part} in {record}");
    }
    write_table(at, 1.1);
    let refused = call(at, &resume);
    assert!(!refused.status.success());
    let message = stderr(&refused);
    let wanted = "fluid.table with the checksum";
    assert!(message.contains(wanted), "{message}");
}

#[test]
fn a_table_that_begins_too_far_out_for_the_temperature_says_so() {
    let temporary = tempfile::tempdir().unwrap();
    let at = temporary.path();
    write_table(at, 1.0);
    fs::write(at.join("scene.toml"), SCENE).unwrap();
    let said = |temperature: &str, out: &str| {
        let set = format!("system.temperature={temperature}");
        let run = ["run", "scene.toml", "--out", out, "--set", &set];
        let output = call(at, &[&run[..], &["--set", "stage.production.steps=2"]].concat());
        ok(&output);
        String::from_utf8_lossy(&output.stdout).into_owned() + &stderr(&output)
    };
    // U is 255 ε at the first row, r = 0.7 σ.
    assert!(!said("25.0", "warm").contains("the table begins"));
    let hot = said("26.0", "hot");
    assert!(
        hot.contains("the table begins at r = 0.7 σ with U = 254.991 ε, below 10·T = 260.000 ε"),
        "{hot}"
    );
}
