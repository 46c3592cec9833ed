//! `lennard measure`: trajectories of LAMMPS and of our own runs, and what is refused of them.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use super::common::{Place, root, stderr, stdout, success};

/// The liquid that LAMMPS ran.
const SCENE: &str = r#"
[system]
n_atoms = 108
density = 0.8442
temperature = 0.85
[truncation]
kind = "cut"
r_cut = 2.5
tail_correction = true
[integrator]
dt = 0.004
[[stage]]
name = "production"
steps = 4000
[[observable]]
kind = "rdf"
r_max = 2.5
bins = 50
[[observable]]
kind = "msd"
[[observable]]
kind = "vacf"
[[observable]]
kind = "bond-order"
"#;

/// What the runs of the tests have beside.
const RUN: &str = r#"
[[stage]]
name = "melt"
steps = 200
temperature = 1.5
thermostat = "bussi"
[[stage]]
name = "production"
steps = 10_000
[output]
thermo_every = 100
trajectory_every = 100
"#;

fn own_scene() -> String {
    let (system, observables) = SCENE.split_once("[[stage]]").unwrap();
    let observables = observables.split_once("[[observable]]").unwrap().1;
    format!("{system}{RUN}[[observable]]{observables}")
        .replace("kind = \"rdf\"", "kind = \"rdf\"\nevery = 100")
        .replace("kind = \"msd\"", "kind = \"msd\"\nevery = 100")
}

/// The columns of a CSV file, by their names without units.
fn columns(path: &Path) -> BTreeMap<String, Vec<f64>> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names = lines.next().unwrap().split(',').map(|name| name.split(' ').next().unwrap());
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|x| x.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    let column = |(k, name): (usize, &str)| (name.to_owned(), rows.iter().map(|r| r[k]).collect());
    names.enumerate().map(column).collect()
}

fn record(folder: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.join("run.json")).unwrap()).unwrap()
}

fn average(record: &Value, name: &str) -> [f64; 2] {
    let of = |key: &str| record["averages"][name][key].as_f64().unwrap_or(f64::NAN);
    [of("mean"), of("standard_error")]
}

fn left_out(record: &Value) -> String {
    let all = record["typed_remarks"].as_array().unwrap();
    all.iter().filter(|r| r["kind"] == "left-out").map(Value::to_string).collect()
}

#[test]
fn a_trajectory_of_lammps_has_what_its_own_computes_print_and_errors() {
    let place = Place::with(&[("liquid.toml", SCENE)]);
    let data = root().join("crates/lennard/tests/lammps");
    let trajectory = data.join("liquid.lammpstrj.gz");
    let trajectory = trajectory.to_str().unwrap();
    let out = success(&mut place.command(&[
        "measure",
        trajectory,
        "--scene",
        "liquid.toml",
        "--out",
        "m",
    ]));
    // Where a line breaks depends on the length of the path of the trajectory.
    let words = out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("1 τ apart: a") && words.contains("64 frames in"), "{out}");
    let lammps = |name: &str| -> Vec<Vec<f64>> {
        let text = std::fs::read_to_string(data.join(name)).unwrap();
        let rows = text.lines().filter(|line| !line.starts_with('#'));
        rows.map(|row| row.split(' ').map(|x| x.parse().unwrap()).collect()).collect()
    };
    let thermo = columns(&place.path("m/thermo.csv"));
    let printed = lammps("thermo.txt");
    assert_eq!(printed.len(), 64);
    let volume = 108.0 / 0.8442;
    for (k, row) in printed.iter().enumerate() {
        let [_, temperature, energy, pressure, _] = row[..] else { panic!("{row:?}") };
        assert!((thermo["temperature"][k] - temperature).abs() < 1e-7);
        assert!((thermo["potential_energy"][k] - energy).abs() < 1e-6);
        // LAMMPS counts N − 1 particles in the kinetic part, and we count N.
        let pressure = pressure + temperature / volume;
        assert!((thermo["pressure"][k] - pressure).abs() < 1e-5, "{k}: {pressure}");
    }
    let rdf = columns(&place.path("m/rdf.csv"));
    let printed = lammps("rdf.txt");
    for row in printed.iter().filter(|row| row.len() == 4) {
        let k = rdf["r"].iter().position(|r| (r - row[1]).abs() < 1e-9).unwrap();
        assert!((rdf["g"][k] - row[2]).abs() <= 5e-6 * row[2], "{row:?}");
        assert!(row[2] == 0.0 || rdf["standard_error"][k] > 0.0, "{row:?}");
    }
    // The lag of 60 frames has one origin, the first frame, as the compute has.
    let msd = columns(&place.path("m/msd.csv"));
    let k = msd["time"].iter().position(|t| *t == 60.0).unwrap();
    let there = lammps("thermo.txt")[60][4];
    assert!((msd["msd"][k] - there).abs() < 1e-5, "{} {there}", msd["msd"][k]);

    let record = record(&place.path("m"));
    let [mean, error] = average(&record, "potential_energy");
    let of_rows: f64 = thermo["potential_energy"].iter().sum::<f64>() / 64.0;
    assert!((mean - of_rows).abs() < 0.01 && error > 0.0, "{mean} ± {error}");
    assert!(record["trajectory"].as_str().unwrap().ends_with("liquid.lammpstrj.gz"));
    let left_out = left_out(&record);
    for name in ["vacf", "heat_capacity_pressure", "conserved_energy", "1 τ", "0.02 τ"] {
        assert!(left_out.contains(name), "{name}: {left_out}");
    }
    assert!(success(&mut place.command(&["compare", "m"])).contains("64 measured"));
    let page = place.read("m/report.html");
    assert!(page.contains("liquid"), "no page");
    let again = place.output(&["run", "m/scene.toml"]);
    assert!(stderr(&again).contains("integrator `frames`"), "{}", stderr(&again));
}

#[test]
fn frames_of_a_run_have_the_tables_of_the_run() {
    let place = Place::with(&[("own.toml", &own_scene())]);
    success(&mut place.command(&["run", "own.toml", "--out", "run"]));
    let folded = place.read("run/trajectory.xyz");
    success(&mut place.command(&[
        "measure",
        "run/trajectory.xyz",
        "--scene",
        "own.toml",
        "--out",
        "measured",
    ]));
    assert_eq!(place.read("run/rdf.csv"), place.read("measured/rdf.csv"));
    let [run, measured] =
        ["run", "measured"].map(|of| columns(&place.path(&format!("{of}/thermo.csv"))));
    let skip = run["time"].len() - measured["time"].len();
    for name in ["temperature", "potential_energy"] {
        assert_eq!(run[name][skip..], measured[name], "{name}");
    }
    // Without image flags, paths follow from the nearest images, and are the same.
    let bare = folded.replace(":map_shift:I:3", ":other:I:3");
    place.write("bare.xyz", &bare);
    let out = success(&mut place.command(&[
        "measure",
        "bare.xyz",
        "--scene",
        "own.toml",
        "--out",
        "bare",
        "--verbose",
    ]));
    assert!(out.contains("the largest displacement between two frames is"), "{out}");
    let [of_run, measured, of_bare] =
        ["run", "measured", "bare"].map(|of| columns(&place.path(&format!("{of}/msd.csv"))));
    for (k, wanted) in of_run["msd"].iter().enumerate() {
        for found in [measured["msd"][k], of_bare["msd"][k]] {
            assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        }
    }
    // Particles that change places go further than a quarter of the box.
    let lines: Vec<&str> = bare.lines().collect();
    let (first, second) = (&lines[..110], &lines[110..112]);
    let turned = [first, second, &first[40..], &first[2..40]].concat().join("\n") + "\n";
    place.write("turned.xyz", &turned);
    let arguments = ["measure", "turned.xyz", "--scene", "own.toml", "--out", "none"];
    let said = stderr(&place.output(&arguments));
    assert!(said.contains("frame 2: found a displacement of 0."), "{said}");
    assert!(said.contains("xu yu zu") && !place.path("none").exists(), "{said}");
    place.write("no-msd.toml", &own_scene().replace("\"msd\"", "\"structure-factor\""));
    let arguments = ["measure", "turned.xyz", "--scene", "no-msd.toml", "--out", "folded"];
    success(&mut place.command(&arguments));
}

#[test]
fn without_velocities_temperatures_are_left_out_and_rounding_is_told_or_leaves_u_and_p_out() {
    let place = Place::with(&[("own.toml", &own_scene())]);
    success(&mut place.command(&["run", "own.toml", "--out", "run"]));
    // The scene that wrote a trajectory in nm says so.
    for (precision, scale, is_kept) in [("100.0", "1.0", true), ("30.0", "0.3405", false)] {
        let (run, out) = (format!("run-{precision}"), format!("out-{precision}"));
        success(&mut place.command(&[
            "run",
            "own.toml",
            "--out",
            &run,
            "--set",
            "output.format=xtc",
            "--set",
            &format!("output.precision={precision}"),
            "--set",
            &format!("output.length_scale={scale}"),
        ]));
        success(&mut place.command(&[
            "measure",
            &format!("{run}/trajectory.xtc"),
            "--scene",
            &format!("{run}/scene.toml"),
            "--out",
            &out,
        ]));
        let record = record(&place.path(&out));
        let left_out = left_out(&record);
        assert!(
            left_out.contains("\"temperature\"") && left_out.contains("no velocities"),
            "{left_out}"
        );
        assert_eq!(record["averages"].get("potential_energy").is_some(), is_kept, "{left_out}");
        let remarks = record["remarks"].to_string();
        assert!(remarks.contains("positions are rounded to"), "{remarks}");
        assert!(remarks.contains("in the first 8 frames"), "{remarks}");
        let energies = &columns(&place.path(&format!("{out}/thermo.csv")))["potential_energy"];
        // The bias that was found at the first frames is the bias of the mean, up to higher orders and chance.
        let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
        let at = remarks.find("changes U by ").unwrap() + "changes U by ".len();
        let told: f64 = remarks[at..].split(' ').next().unwrap().parse().unwrap();
        let exact = &columns(&place.path("run/thermo.csv"))["potential_energy"];
        let bias = mean(energies) - mean(&exact[exact.len() - energies.len()..]);
        assert!((told / bias - 1.0).abs() < 0.5, "told {told}, found {bias}");
        let last = place.read(&format!("{out}/final.xyz"));
        assert!(!last.contains("velo"), "velocities that no frame has");
    }
}

#[test]
fn what_cannot_be_measured_is_refused_and_nothing_is_written() {
    let place = Place::with(&[
        ("own.toml", &own_scene()),
        ("no-dt.toml", &own_scene().replace("dt = 0.004", "")),
    ]);
    success(&mut place.command(&[
        "run",
        "own.toml",
        "--out",
        "run",
        "--set",
        "output.format=lammps-dump",
    ]));
    let dump = place.read("run/trajectory.lammpstrj");
    let frames: Vec<&str> = dump.split_inclusive("ITEM: TIMESTEP\n").collect();
    assert!(frames.len() > 10);
    let half = &dump[..dump.len() / 2];
    let shorter = dump.replacen("\n108\n", "\n107\n", 2).replacen("\n107\n", "\n108\n", 1);
    let later = dump.replacen("ITEM: TIMESTEP\n500\n", "ITEM: TIMESTEP\n550\n", 1);
    let wide = {
        let at = dump.rfind("ITEM: BOX BOUNDS").unwrap();
        let (before, after) = dump.split_at(at);
        let side = after.lines().nth(1).unwrap().split(' ').nth(1).unwrap();
        format!("{before}{}", after.replacen(side, "5.5", 1))
    };
    for (name, text, scene, more, wanted) in [
        ("half", half, "own.toml", "", "reading the trajectory"),
        ("shorter", &shorter, "own.toml", "", "shorter.dump:"),
        (
            "later",
            &later,
            "own.toml",
            "",
            "frame 3: found the step or time 550; allowed: 500: frames at equal times",
        ),
        (
            "wide",
            &wide,
            "own.toml",
            "",
            "for constant pressure a run of the scene with `[stage.barostat]`",
        ),
        (
            "steps",
            &dump,
            "no-dt.toml",
            "",
            "steps without times, and no `integrator.dt` in the scene",
        ),
        ("zero", &dump, "own.toml", "--interval=0", "wanted a number above zero"),
    ] {
        let file = format!("{name}.dump");
        place.write(&file, text);
        let mut arguments = vec!["measure", &file, "--scene", scene, "--out", "none"];
        arguments.extend((!more.is_empty()).then_some(more));
        let output = place.output(&arguments);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{name}: {said}");
        assert!(said.contains(wanted), "{name}: {said}");
        assert!(!place.path("none").exists(), "{name} left files");
    }
    let json = place.output(&[
        "measure",
        "run/trajectory.lammpstrj",
        "--scene",
        "no-dt.toml",
        "--interval",
        "0.4",
        "--out",
        "j",
        "--json",
        "--quiet",
        "--no-report",
    ]);
    let record: Value = serde_json::from_str(&stdout(&json)).unwrap();
    assert_eq!((record["steps"].as_u64(), record["finished"].as_bool()), (Some(100), Some(true)));
    let taken =
        place.output(&["measure", "run/trajectory.lammpstrj", "--scene", "own.toml", "--out", "j"]);
    assert_eq!(taken.status.code(), Some(2), "{}", stderr(&taken));
}
