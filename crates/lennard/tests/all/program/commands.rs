//! Each command as a user types it.

use crate::program::common::{lennard, root, run_small, stderr, stdout, succeed, success};

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

#[test]
fn a_run_writes_its_folder_and_prints_the_same_record_as_json() {
    let temporary = tempfile::tempdir().unwrap();
    let out = temporary.path().join("out");
    let record = json(&success(run_small(&out).arg("--json")));
    assert_eq!(record["finished"], true);
    assert_eq!(record["steps"], 600);
    assert_eq!(record["atoms"], 256);
    let neighbor = &record["neighbor"];
    assert!(neighbor["checked_forces"].as_u64() > Some(0), "{neighbor}");
    assert!(neighbor["largest_deviation"].as_f64() <= Some(1.0), "{neighbor}");
    for key in [
        "schema",
        "scene",
        "seed",
        "version",
        "host",
        "wall_s",
        "performance",
        "averages",
        "conservation",
        "comparison",
        "n_dof",
    ] {
        assert!(!record[key].is_null(), "`{key}` is missing");
    }
    for name in [
        "temperature",
        "potential_energy",
        "potential_energy_without_tail",
        "pressure",
        "pressure_without_tail",
        "configurational_temperature",
    ] {
        let average = &record["averages"][name];
        for key in ["mean", "n_effective", "equilibration_cut"] {
            assert!(average[key].is_number(), "{name}.{key}: {average}");
        }
        // A number has an error, or the reason why it has none.
        let sound = average["standing"] == "sound";
        assert_eq!(average["standard_error"].is_number(), sound, "{average}");
        assert_eq!(average["reason"] == "", sound, "{average}");
    }
    let written = json(&std::fs::read_to_string(out.join("run.json")).unwrap());
    assert_eq!(written, record);
    for file in [
        "scene.toml",
        "thermo.csv",
        "rdf.csv",
        "msd.csv",
        "topology.gro",
        "trajectory.xyz",
        "final.xyz",
        "particles.svg",
    ] {
        assert!(out.join(file).metadata().is_ok_and(|m| m.len() > 0), "{file}");
    }
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    let picture = std::fs::read_to_string(out.join("particles.svg")).unwrap();
    assert!(picture.contains("The particles at step 600"), "{picture:.500}");
    assert!(page.contains(&picture), "the page has the picture of the particles");
    let thermo = std::fs::read_to_string(out.join("thermo.csv")).unwrap();
    assert!(thermo.starts_with("step,time,stage,temperature,"), "{thermo}");
    let rows = thermo.lines().filter(|line| !line.starts_with('#'));
    assert_eq!(rows.count(), 1 + 600 / 10, "one row every ten steps of every stage");
}

#[test]
fn the_resolved_scene_runs_again_to_the_same_bits() {
    let temporary = tempfile::tempdir().unwrap();
    let (first, second) = (temporary.path().join("first"), temporary.path().join("second"));
    success(run_small(&first).arg("--quiet"));
    let resolved = first.join("scene.toml");
    succeed(&[
        "run",
        resolved.to_str().unwrap(),
        "--quiet",
        "--threads",
        "2",
        "--out",
        second.to_str().unwrap(),
    ]);
    for file in ["final.xyz", "trajectory.xyz", "thermo.csv", "rdf.csv", "msd.csv"] {
        let read = |folder: &std::path::Path| std::fs::read(folder.join(file)).unwrap();
        assert!(read(&first) == read(&second), "{file} differs");
    }
}

#[test]
fn final_xyz_starts_a_new_run() {
    let temporary = tempfile::tempdir().unwrap();
    let (first, second) = (temporary.path().join("first"), temporary.path().join("second"));
    success(run_small(&first).arg("--quiet"));
    let scene = temporary.path().join("next.toml");
    std::fs::write(
        &scene,
        "[start]\nkind = \"file\"\nfile = \"first/final.xyz\"\n[system]\ntemperature = 0.722\n[truncation]\nr_cut = 2.5\n\
         [integrator]\ndt = 0.004\n[[stage]]\nname = \"production\"\nsteps = 100\n",
    )
    .unwrap();
    let record = json(&succeed(&[
        "run",
        scene.to_str().unwrap(),
        "--json",
        "--out",
        second.to_str().unwrap(),
    ]));
    assert_eq!(record["atoms"], 256);
    // The velocities came along: at its own temperature the melt would still be near 1.5, not 0.722 on the dot.
    let last = json(&std::fs::read_to_string(first.join("run.json")).unwrap());
    let temperature =
        |r: &serde_json::Value| r["averages"]["temperature"]["mean"].as_f64().unwrap();
    assert!((temperature(&record) - temperature(&last)).abs() < 0.1);
}

#[test]
fn the_energy_of_a_published_configuration_is_printed_with_all_digits() {
    let report = json(&succeed(&["energy", "inputs/fluid/from-configuration.toml", "--json"]));
    for key in ["potential_energy", "tail_energy", "virial", "tail_virial", "pressure", "pairs"] {
        assert!(report[key].is_number(), "{key}");
    }
    // NIST SRSW reference calculation 4 at r_cut = 4, five digits as printed there: U = −17.060, U_LRC = −0.23008.
    assert_eq!(format!("{:.4e}", report["potential_energy"].as_f64().unwrap()), "-1.7060e1");
    assert_eq!(format!("{:.4e}", report["tail_energy"].as_f64().unwrap()), "-2.3008e-1");
    assert_eq!(report["temperature_from"], "scene-temperature");
}

#[test]
fn forces_are_written_at_full_precision() {
    let temporary = tempfile::tempdir().unwrap();
    let path = temporary.path().join("forces.xyz");
    succeed(&[
        "energy",
        "inputs/fluid/from-configuration.toml",
        "--forces",
        path.to_str().unwrap(),
        "--json",
    ]);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.lines().nth(1).unwrap().contains("forces:R:3"), "{text}");
    // Newton's third law over the file: the sum of forces vanishes to rounding of numbers of order ten.
    let mut sum = [0.0_f64; 3];
    for line in text.lines().skip(2) {
        let fields: Vec<f64> =
            line.split_whitespace().skip(1).map(|f| f.parse().unwrap()).collect();
        for axis in 0..3 {
            sum[axis] += fields[fields.len() - 3 + axis];
        }
    }
    assert!(sum.iter().all(|s| s.abs() < 1e-11), "{sum:?}");
}

#[test]
fn plan_says_what_is_on_and_off_and_why() {
    // In short, a part that takes little time is only counted.
    let text = succeed(&["plan", "inputs/verlet-1967/triple-point.toml", "--verbose"]);
    for wanted in ["neighbor list", "tail correction", "rdf", "off", "memory", "time: about"] {
        assert!(text.contains(wanted), "{wanted} in\n{text}");
    }
    let plan = json(&succeed(&["plan", "inputs/fluid/gas.toml", "--json"]));
    assert!(plan["items"].as_array().unwrap().iter().any(|i| i["on"] == false));
}

#[test]
fn a_plan_for_several_machines_has_a_line_for_each_number_and_refuses_what_does_not_fit() {
    let scene = "inputs/bench/fluid-864.toml";
    let text = succeed(&["plan", scene, "--nodes", "8", "--latency", "500ns"]);
    for wanted in ["halo", "gathering", "more machines pay up to", "not measured"] {
        assert!(text.contains(wanted), "{wanted} in\n{text}");
    }
    let plan = json(&succeed(&["plan", scene, "--nodes", "8", "--json"]));
    let steps = plan["nodes"]["steps"].as_array().unwrap();
    let numbers: Vec<_> = steps.iter().map(|step| step["nodes"].as_u64().unwrap()).collect();
    assert_eq!(numbers, [1, 2, 4, 8]);
    assert!(steps[3]["ghosts"].as_f64().unwrap() > 0.0);
    assert_eq!(steps[0]["efficiency"], 1.0);
    for (arguments, wanted) in [
        (["--nodes", "1000"], "up to 18 here"),
        (["--nodes=2", "--set=neighbor.mode=direct"], "have no form that several machines share"),
        (["--nodes", "0"], "0 is not in"),
        (["--latency", "1us"], "--nodes"),
        (["--bandwidth", "25"], "wanted a rate above zero"),
    ] {
        let output = lennard(&[&["plan", scene], &arguments[..]].concat()).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(wanted), "{}", stderr(&output));
    }
    let output = lennard(&["plan", scene, "--nodes", "1000"]).output().unwrap();
    let expected = "planning for several machines: too few particles for so many machines\n  found:   --nodes 1000\n  \
                    allowed: up to 18 here, since each takes 48 particles or more";
    assert!(stderr(&output).contains(expected), "{}", stderr(&output));
}

#[test]
fn every_list_names_its_methods() {
    for (what, wanted) in [
        ("integrators", "stormer-verlet"),
        ("thermostats", "bussi"),
        ("potentials", "soft-sphere"),
        ("truncations", "force-shift"),
        ("observables", "rdf"),
        ("equations-of-state", "Thol 2016"),
    ] {
        assert!(succeed(&["list", what]).contains(wanted), "{what}");
        let entries = json(&succeed(&["list", what, "--json"]));
        assert!(
            entries["entries"]
                .as_array()
                .unwrap()
                .iter()
                .all(|e| e["name"].is_string() && e["source"].is_string())
        );
    }
    // What a scene should take unless it has a reason.
    let integrators = json(&succeed(&["list", "integrators", "--json"]));
    assert_eq!(integrators["entries"][0]["name"], "velocity-verlet");
}

#[test]
fn options_that_only_clusters_need_stand_apart_in_the_help() {
    for (command, first, last) in
        [("sweep", "--points", "--emit <SCHEDULER>"), ("plan", "--nodes", "--bandwidth")]
    {
        let help = succeed(&[command, "--help"]);
        let (everyday, of_clusters) = help.split_once("\nOn a cluster:\n").unwrap();
        for option in [first, last] {
            assert!(of_clusters.contains(&format!("  {option}")), "{option}: {help}");
        }
        assert!(!everyday.contains(&format!("  {first}")), "{help}");
    }
}

#[test]
fn list_alone_names_every_list() {
    let said = succeed(&["list"]);
    assert!(said.contains("scenes  "), "{said}");
    assert!(said.contains("Rules for σ and ε of unlike species"), "{said}");
    assert!(said.lines().all(|l| l.chars().count() <= 100), "{said}");
    let entries = json(&succeed(&["list", "--json"]));
    for entry in entries["entries"].as_array().unwrap() {
        let name = entry["name"].as_str().unwrap();
        assert!(!succeed(&["list", name]).is_empty(), "{name}");
        // A command is no source.
        assert_eq!(entry["properties"]["command"], format!("lennard list {name}"));
        assert_eq!(entry.get("source"), None);
    }
    let refused = lennard(&["list", "--verbose"]).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("<WHAT>"), "{}", stderr(&refused));
}

#[test]
fn a_list_has_a_line_for_each_and_a_name_tells_everything() {
    let list = succeed(&["list", "integrators"]);
    assert!(list.lines().all(|l| l.chars().count() <= 100), "{list}");
    assert!(!list.contains("source:"), "{list}");
    let one = succeed(&["list", "integrators", "leapfrog"]);
    assert!(one.contains("source:") && !one.contains("stormer"), "{one}");
    assert!(succeed(&["list", "integrators", "--verbose"]).contains("source:"));
    let refused = lennard(&["list", "integrators", "leap-frog"]).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
    let said = stderr(&refused);
    assert!(
        said.contains("reading a list: nothing in the list has this name")
            && said.contains("nearest: leapfrog"),
        "{said}"
    );
}

#[test]
fn a_plan_is_ten_lines_and_verbose_tells_every_part() {
    let scene = "inputs/bench/fluid-864.toml";
    let short = succeed(&["plan", scene]);
    assert!(short.lines().count() <= 10, "{short}");
    assert!(short.contains("pair forces") && short.contains("time: about"), "{short}");
    let all = succeed(&["plan", scene, "--verbose"]);
    assert!(all.contains("wall-pressure") && all.contains("not in the scene"), "{all}");
}

#[test]
fn completions_and_version_are_printed() {
    assert!(succeed(&["generate", "completions", "bash"]).contains("lennard"));
    assert!(succeed(&["version"]).contains(env!("CARGO_PKG_VERSION")));
    assert!(json(&succeed(&["version", "--json"]))["isa"].is_array());
}

#[test]
fn the_default_folder_is_the_first_free_one() {
    let temporary = tempfile::tempdir().unwrap();
    let scene = root().join("inputs/verlet-1967/triple-point.toml");
    for n in 1..=2 {
        let mut command = lennard(&["run", scene.to_str().unwrap()]);
        let output = command
            .args(crate::program::common::SMALL)
            .current_dir(temporary.path())
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let folder = format!("runs/triple-point-{n}");
        assert!(stdout(&output).contains(&folder), "{}", stdout(&output));
        assert!(temporary.path().join(folder).join("run.json").exists());
    }
}

#[test]
fn progress_comes_as_plain_lines_where_there_is_no_terminal_and_not_at_all_when_quiet() {
    let temporary = tempfile::tempdir().unwrap();
    let run = |name: &str, more: &[&str]| {
        let mut command = run_small(&temporary.path().join(name));
        command.args(more).output().unwrap()
    };
    let plain = run("plain", &[]);
    assert!(stderr(&plain).contains("production: step 600 of 600 (100 %)"), "{}", stderr(&plain));
    assert!(!stderr(&plain).contains('\u{1b}'), "no control codes in a file");
    assert!(!stdout(&plain).contains('\u{1b}'), "no control codes in a file");
    let quiet = run("quiet", &["--quiet"]);
    assert_eq!((stdout(&quiet), stderr(&quiet)), (String::new(), String::new()));
}

#[test]
fn a_run_that_physics_stops_ends_with_exit_code_3_and_the_cause() {
    let temporary = tempfile::tempdir().unwrap();
    let out = temporary.path().join("out");
    let output = run_small(&out).args(["--quiet", "--set", "integrator.dt=0.08"]).output().unwrap();
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{message}");
    assert!(message.contains("likely cause: dt = 0.08 τ is too large"), "{message}");
    assert!(json(&std::fs::read_to_string(out.join("run.json")).unwrap())["finished"] == false);
    let thermo = std::fs::read_to_string(out.join("thermo.csv")).unwrap();
    assert!(!thermo.contains("nan"), "{thermo}");
}
