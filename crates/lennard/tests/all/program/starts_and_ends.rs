//! What a run says of the state that it starts from and of the one that it ends with.

use std::fs;

use crate::program::common::{Place, stderr, success};

/// What stands in the place of the particles where a file has them.
const FROM_FILE: &str = "start = { kind = \"file\", file = \"start.xyz\" }\n[system]";

const SCENE: &str = "[system]\nn_atoms = 108\ndensity = 0.8\ntemperature = 1.2\n[truncation]\nr_cut = 2.2\n\
                     [[stage]]\nname = \"production\"\nsteps = 20\n";

fn bench() -> Place {
    let from_file = SCENE.replace("[system]\nn_atoms = 108\ndensity = 0.8", FROM_FILE);
    Place::with(&[("liquid.toml", SCENE), ("from-file.toml", &from_file)])
}

fn succeed_in(bench: &Place, arguments: &[&str]) -> String {
    success(&mut bench.command(arguments))
}

fn remarks_in(bench: &Place, folder: &str) -> String {
    let record: serde_json::Value =
        serde_json::from_str(&bench.read(&format!("{folder}/run.json"))).unwrap();
    record["remarks"].to_string()
}

/// A frame with `drift` added to the velocities along x.
fn drifting(frame: &str, drift: f64) -> String {
    assert!(frame.contains("velo:R:3"), "{frame:.300}");
    let mut lines = frame.lines();
    let head: Vec<&str> = lines.by_ref().take(2).collect();
    let particles = lines.map(|line| {
        let mut fields: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        let v: f64 = fields[VX].parse().unwrap();
        fields[VX] = (v + drift).to_string();
        fields.join(" ")
    });
    let all: Vec<String> = head.into_iter().map(str::to_owned).chain(particles).collect();
    all.join("\n") + "\n"
}

/// The column of v_x: after the symbol and the position.
const VX: usize = 4;

/// A text without the ends of its lines, which a terminal chooses.
fn in_one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Proves that a run says what it takes off the velocities of a file, and that `energy` shows the temperature that the run
/// begins with. It does not judge whether a drift should be taken off.
#[test]
fn the_drift_of_a_file_is_named_and_run_and_energy_agree_on_the_temperature() {
    let bench = bench();
    succeed_in(&bench, &["run", "liquid.toml", "--quiet", "--out", "made"]);
    let frame = bench.read("made/final.xyz");
    bench.write("start.xyz", &frame);
    let json = |bench: &Place| -> serde_json::Value {
        let text = succeed_in(bench, &["energy", "from-file.toml", "--json"]);
        serde_json::from_str(&text).unwrap()
    };
    let plain = json(&bench);
    assert_eq!(plain["remarks"], serde_json::Value::Null, "no drift, no remark");
    bench.write("start.xyz", &drifting(&frame, 0.5));
    let with_drift = json(&bench);
    let temperature = plain["temperature"].as_f64().unwrap();
    assert!((with_drift["temperature"].as_f64().unwrap() - temperature).abs() < 1e-9);
    // 2K/(3N − 3) of the drift alone: N/(3N − 3) of its square.
    let before = temperature + 0.25 * 108.0 / 321.0;
    let words = format!(
        "start.xyz had a total momentum of (0.500000, 0.000000, 0.000000) per particle: removed, T changed from {before:.6} to {temperature:.6}"
    );
    let said = succeed_in(&bench, &["energy", "from-file.toml"]);
    let said = in_one_line(&said.replace("-0.000000", "0.000000"));
    assert!(said.contains(&words), "wanted {words} in\n{said}");
    let said = succeed_in(&bench, &["run", "from-file.toml", "--out", "out"]);
    let said = in_one_line(&said.replace("-0.000000", "0.000000"));
    assert!(said.contains(&words), "wanted {words} in\n{said}");
    let remarks = remarks_in(&bench, "out").replace("-0.000000", "0.000000");
    assert!(remarks.contains(&words), "wanted {words} in\n{remarks}");
    // It stays with the run that goes on.
    succeed_in(&bench, &["resume", "out", "--steps", "10", "--quiet"]);
    let remarks = remarks_in(&bench, "out").replace("-0.000000", "0.000000");
    assert!(remarks.contains(&words), "wanted {words} in\n{remarks}");
}

/// Temperatures of the remark are over the degrees of freedom of the run: bonds take some.
#[test]
fn the_drift_of_a_file_of_molecules_has_the_temperatures_of_molecules() {
    let scene =
        SCENE.replace("n_atoms = 108\ndensity = 0.8", "n_molecules = 108\ndensity = 0.4").replace(
            "[truncation]",
            "[molecule]\nkind = \"dumbbell\"\nbond_length = 0.6\n[truncation]",
        );
    let from_file = scene.replace("[system]\nn_molecules = 108\ndensity = 0.4", FROM_FILE);
    let bench = Place::with(&[("liquid.toml", &scene), ("from-file.toml", &from_file)]);
    succeed_in(&bench, &["run", "liquid.toml", "--quiet", "--out", "made"]);
    bench.write("start.xyz", &drifting(&bench.read("made/final.xyz"), 0.5));
    let json = succeed_in(&bench, &["energy", "from-file.toml", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let after = json["temperature"].as_f64().unwrap();
    // 5·108 − 3 degrees of freedom, and 216 particles.
    let before = after + 0.25 * 216.0 / 537.0;
    let words = format!("removed, T changed from {before:.6} to {after:.6}");
    let said = json["remarks"].to_string();
    assert!(said.contains(&words), "wanted {words} in {said}");
}

/// A wall takes up the momentum across it: a run keeps that drift, and must not claim to remove it.
#[test]
fn the_drift_across_walls_stays_and_no_remark_claims_otherwise() {
    let wall = "[[wall]]\naxis = \"x\"\nkind = \"hard\"\n[[stage]]";
    let scene = SCENE
        .replace("r_cut = 2.2", "r_cut = 2.2\ntail_correction = false")
        .replace("[[stage]]", wall);
    let from_file = scene.replace("[system]\nn_atoms = 108\ndensity = 0.8", FROM_FILE);
    let bench = Place::with(&[("slit.toml", &scene), ("from-file.toml", &from_file)]);
    succeed_in(&bench, &["run", "slit.toml", "--quiet", "--out", "made"]);
    let frame = bench.read("made/final.xyz");
    let temperature = |bench: &Place| -> (f64, serde_json::Value) {
        let text = succeed_in(bench, &["energy", "from-file.toml", "--json"]);
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        (json["temperature"].as_f64().unwrap(), json["remarks"].clone())
    };
    bench.write("start.xyz", &frame);
    let (still, _) = temperature(&bench);
    bench.write("start.xyz", &drifting(&frame, 0.5));
    let (moving, remarks) = temperature(&bench);
    assert!((moving - still).abs() > 1e-3, "{moving} {still}");
    assert_eq!(remarks, serde_json::Value::Null);
}

#[test]
fn the_frame_of_a_file_with_many_is_named() {
    let bench = bench();
    let made =
        ["run", "liquid.toml", "--quiet", "--out", "made", "--set", "output.trajectory_every=5"];
    succeed_in(&bench, &made);
    bench.write("start.xyz", &bench.read("made/trajectory.xyz"));
    let words = "the start is frame 4 of 4 of ";
    let said = succeed_in(&bench, &["run", "from-file.toml", "--out", "out"]);
    assert!(said.contains(words) && said.contains("start.xyz"), "{said}");
    assert!(remarks_in(&bench, "out").contains(words), "{}", remarks_in(&bench, "out"));
    bench.write("start.xyz", &bench.read("made/final.xyz"));
    let said = succeed_in(&bench, &["run", "from-file.toml", "--out", "other"]);
    assert!(!said.contains("the start is frame"), "{said}");
}

/// Proves that the last state is written with its energies, whatever the steps of rows and samples. The state has the
/// same bits as where rows and samples fall on the last step.
#[test]
fn the_last_state_has_its_energies_whenever_samples_are_taken() {
    let bench = bench();
    let header = |text: &str, key: &str| -> f64 {
        let line = text.lines().nth(1).unwrap();
        let at = line.find(&format!("{key}=")).unwrap_or_else(|| panic!("no {key} in {line}"));
        let value = line[at + key.len() + 1..].split_whitespace().next().unwrap();
        value.parse().unwrap()
    };
    for more in [&[][..], &["--set", "kernel.precision=mixed"]] {
        let run = |every: &str, out: &str| {
            let every = format!("output.thermo_every={every}");
            let run = ["run", "liquid.toml", "--quiet", "--out", out, "--set", &every];
            succeed_in(&bench, &[&run[..], more, &["--set", "stage.0.steps=40"]].concat());
            let text = bench.read(&format!("{out}/final.xyz"));
            fs::remove_dir_all(bench.path(out)).unwrap();
            text
        };
        let (on, off) = (run("10", "on"), run("7", "off"));
        for key in ["total_potential_energy", "total_kinetic_energy", "pressure"] {
            assert_eq!(header(&on, key), header(&off, key), "{key}");
        }
        let particles = |text: &str| text.lines().skip(2).map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(particles(&on), particles(&off));
    }
}

#[test]
fn going_on_is_advised_only_where_there_is_a_checkpoint() {
    let bench = bench();
    succeed_in(&bench, &["run", "liquid.toml", "--quiet", "--out", "out"]);
    let record = bench.read("out/run.json");
    bench.write("out/run.json", &record.replace("\"finished\": true", "\"finished\": false"));
    let said = stderr(&bench.output(&["compare", "out"]));
    assert!(said.contains("to go on: lennard resume out"), "{said}");
    for (_, path) in lennard_io::CheckpointFolder::new(&bench.path("out")).list().unwrap() {
        fs::remove_file(path).unwrap();
    }
    let said = stderr(&bench.output(&["compare", "out"]));
    assert!(!said.contains("lennard resume"), "{said}");
    let again = "it has no checkpoint to go on from; to start again: lennard run out/scene.toml --out FOLDER";
    assert!(said.contains(again), "{said}");
}
