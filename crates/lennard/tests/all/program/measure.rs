//! `lennard measure`: trajectories of LAMMPS and of our own runs, and what is refused of them.

use std::collections::BTreeMap;

use serde_json::Value;

use super::common::*;

/// A liquid.
const LIQUID: &str = r#"
system = { n_atoms = 108, density = 0.8442, temperature = 0.85 }
truncation = { kind = "cut", r_cut = 2.5, tail_correction = true }
integrator = { dt = 0.004 }
"#;

/// The run of LAMMPS and what is measured of it.
const OF_LAMMPS: &str = r#"
stage = [{ name = "production", steps = 4000 }]
observable = [
    { kind = "rdf", r_max = 2.5, bins = 50 },
    { kind = "msd" },
    { kind = "vacf" },
    { kind = "bond-order" },
]
"#;

/// The runs of the tests and what they and their frames measure.
const OWN: &str = r#"
stage = [
    { name = "melt", steps = 200, temperature = 1.5, thermostat = "bussi" },
    { name = "production", steps = 10_000 },
]
output = { thermo_every = 100, trajectory_every = 100 }
observable = [
    { kind = "rdf", every = 100, r_max = 2.5, bins = 50 },
    { kind = "msd", every = 100 },
    { kind = "vacf" },
    { kind = "bond-order" },
]
"#;

fn own_scene() -> String {
    format!("{LIQUID}{OWN}")
}

/// The columns of a CSV file, by their names without units.
fn columns(place: &Place, file: &str) -> BTreeMap<String, Vec<f64>> {
    let text = place.read(file);
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names = lines.next().unwrap().split(',').map(|name| name.split(' ').next().unwrap());
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|x| x.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    let column = |(k, name): (usize, &str)| (name.to_owned(), rows.iter().map(|r| r[k]).collect());
    names.enumerate().map(column).collect()
}

fn left_out(record: &Value) -> String {
    let all = record["typed_remarks"].as_array().unwrap();
    all.iter().filter(|r| r["kind"] == "left-out").map(Value::to_string).collect()
}

#[test]
fn a_trajectory_of_lammps_has_what_its_own_computes_print_and_errors() {
    let place = Place::with(&[("liquid.toml", &format!("{LIQUID}{OF_LAMMPS}"))]);
    let data = root().join("crates/lennard/tests/lammps");
    std::fs::copy(data.join("liquid.lammpstrj.gz"), place.path("liquid.lammpstrj.gz")).unwrap();
    let out = place.succeed("measure liquid.lammpstrj.gz --scene liquid.toml --out m");
    contains(&in_one_line(&out), &["1 τ apart: a", "64 frames in"]);
    let lammps = |name: &str| -> Vec<Vec<f64>> {
        let text = std::fs::read_to_string(data.join(name)).unwrap();
        let rows = text.lines().filter(|line| !line.starts_with('#'));
        rows.map(|row| row.split(' ').map(|x| x.parse().unwrap()).collect()).collect()
    };
    let thermo = columns(&place, "m/thermo.csv");
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
    let rdf = columns(&place, "m/rdf.csv");
    let printed = lammps("rdf.txt");
    for row in printed.iter().filter(|row| row.len() == 4) {
        let k = rdf["r"].iter().position(|r| (r - row[1]).abs() < 1e-9).unwrap();
        assert!((rdf["g"][k] - row[2]).abs() <= 5e-6 * row[2], "{row:?}");
        assert!(row[2] == 0.0 || rdf["standard_error"][k] > 0.0, "{row:?}");
    }
    // The lag of 60 frames has one origin, the first frame, as the compute has.
    let msd = columns(&place, "m/msd.csv");
    let k = msd["time"].iter().position(|t| *t == 60.0).unwrap();
    let there = lammps("thermo.txt")[60][4];
    assert!((msd["msd"][k] - there).abs() < 1e-5, "{} {there}", msd["msd"][k]);

    let record = place.record("m");
    let average = &record["averages"]["potential_energy"];
    let [mean, error] = ["mean", "standard_error"].map(|key| number(&average[key]));
    let of_rows: f64 = thermo["potential_energy"].iter().sum::<f64>() / 64.0;
    assert!((mean - of_rows).abs() < 0.01 && error > 0.0, "{mean} ± {error}");
    assert!(record["trajectory"].as_str().unwrap().ends_with("liquid.lammpstrj.gz"));
    let names = ["vacf", "heat_capacity_pressure", "conserved_energy", "1 τ", "0.02 τ"];
    contains(&left_out(&record), &names);
    contains(&place.succeed("compare m"), &["64 measured"]);
    contains(&place.read("m/report.html"), &["liquid"]);
    contains(&stderr(&place.output("run m/scene.toml")), &["integrator `frames`"]);
}

#[test]
fn frames_of_a_run_have_the_tables_of_the_run() {
    let place = Place::with(&[("own.toml", &own_scene())]);
    place.succeed("run own.toml --out run");
    let folded = place.read("run/trajectory.xyz");
    place.succeed("measure run/trajectory.xyz --scene own.toml --out measured");
    place.same("run", "measured", &["rdf.csv"]);
    let [run, measured] =
        ["run", "measured"].map(|of| columns(&place, &format!("{of}/thermo.csv")));
    let skip = run["time"].len() - measured["time"].len();
    for name in ["temperature", "potential_energy"] {
        assert_eq!(run[name][skip..], measured[name], "{name}");
    }
    // Without image flags, paths follow from the nearest images, and are the same.
    let bare = folded.replace(":map_shift:I:3", ":other:I:3");
    place.write("bare.xyz", &bare);
    let out = place.succeed("measure bare.xyz --scene own.toml --out bare --verbose");
    contains(&out, &["the largest displacement between two frames is"]);
    let [of_run, measured, of_bare] =
        ["run", "measured", "bare"].map(|of| columns(&place, &format!("{of}/msd.csv")));
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
    let measure = "measure turned.xyz --scene";
    let words = ["frame 2: found a displacement of 0.", "xu yu zu"];
    contains(&stderr(&place.output(&format!("{measure} own.toml --out none"))), &words);
    assert!(!place.has("none"));
    place.write("no-msd.toml", &own_scene().replace("\"msd\"", "\"structure-factor\""));
    place.succeed(&format!("{measure} no-msd.toml --out folded"));
}

#[test]
fn without_velocities_temperatures_are_left_out_and_rounding_is_told_or_leaves_u_and_p_out() {
    let place = Place::with(&[("own.toml", &own_scene())]);
    place.succeed("run own.toml --out run");
    // The scene that wrote a trajectory in nm says so.
    for (precision, scale, is_kept) in [("100.0", "1.0", true), ("30.0", "0.3405", false)] {
        let (run, out) = (format!("run-{precision}"), format!("out-{precision}"));
        place.succeed(&format!(
            "run own.toml --out {run} --set output.format=xtc --set output.precision={precision} \
             --set output.length_scale={scale}"
        ));
        let measure = format!("measure {run}/trajectory.xtc --scene {run}/scene.toml");
        place.succeed(&format!("{measure} --out {out}"));
        let record = place.record(&out);
        let left_out = left_out(&record);
        contains(&left_out, &["\"temperature\"", "no velocities"]);
        assert_eq!(record["averages"].get("potential_energy").is_some(), is_kept, "{left_out}");
        let remarks = record["remarks"].to_string();
        contains(&remarks, &["positions are rounded to", "in the first 8 frames"]);
        let energies = &columns(&place, &format!("{out}/thermo.csv"))["potential_energy"];
        // The bias that was found at the first frames is the bias of the mean, up to higher orders and chance.
        let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
        let at = remarks.find("changes U by ").unwrap() + "changes U by ".len();
        let told: f64 = remarks[at..].split(' ').next().unwrap().parse().unwrap();
        let exact = &columns(&place, "run/thermo.csv")["potential_energy"];
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
    place.succeed("run own.toml --out run --set output.format=lammps-dump");
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
    let later_words = "frame 3: found the step or time 550; allowed: 500: frames at equal times";
    for (name, text, more, wanted) in [
        ("half", half, "own.toml", "reading the trajectory"),
        ("shorter", &shorter, "own.toml", "shorter.dump:"),
        ("later", &later, "own.toml", later_words),
        (
            "wide",
            &wide,
            "own.toml",
            "for constant pressure a run of the scene with `[stage.barostat]`",
        ),
        ("steps", &dump, "no-dt.toml", "steps without times, and no `integrator.dt` in the scene"),
        ("zero", &dump, "own.toml --interval=0", "wanted a number above zero"),
    ] {
        place.write(&format!("{name}.dump"), text);
        place.refused(&format!("measure {name}.dump --out none --scene {more}"), &[wanted]);
        assert!(!place.has("none"), "{name} left files");
    }
    let measure = "measure run/trajectory.lammpstrj --out j --scene";
    let quiet = "--interval 0.4 --quiet --no-report";
    let record = place.json(&format!("{measure} no-dt.toml {quiet}"));
    assert_eq!((record["steps"].as_u64(), record["finished"].as_bool()), (Some(100), Some(true)));
    place.refused(&format!("{measure} own.toml"), &[]);
}
