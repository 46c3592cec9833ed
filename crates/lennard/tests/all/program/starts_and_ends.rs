//! What a run says of the state that it starts from and of the one that it ends with.

use std::fs;

use crate::program::common::*;

/// The column of v_x: after the symbol and the position.
const VX: usize = 4;

/// A frame with a drift of 0.5 added to the velocities along x.
fn drifting(frame: &str) -> String {
    assert!(frame.contains("velo:R:3"), "{frame:.300}");
    let particle = |line: &str| {
        let mut fields: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        let v: f64 = fields[VX].parse().unwrap();
        fields[VX] = (v + 0.5).to_string();
        fields.join(" ")
    };
    let of = |(k, line): (usize, &str)| match k {
        0 | 1 => line.to_owned() + "\n",
        _ => particle(line) + "\n",
    };
    frame.lines().enumerate().map(of).collect()
}

/// A scene with the same particles from a file, and the last frame of its run in that file.
fn bench(scene: &str, changes: &[(&str, &str)]) -> (Place, String) {
    let changed = |mut text: String| {
        for (from, to) in changes {
            text = text.replace(from, to);
        }
        text
    };
    let from_file = changed(fluid_from("start.xyz"));
    let place = Place::with(&[("liquid.toml", scene), ("from-file.toml", &from_file)]);
    place.succeed("run liquid.toml --quiet --out made");
    let frame = place.read("made/final.xyz");
    place.write("start.xyz", &frame);
    (place, frame)
}

/// Proves that a run says what it takes off the velocities of a file, and that `energy` shows the temperature that the run
/// begins with. It does not judge whether a drift should be taken off.
#[test]
fn the_drift_of_a_file_is_named_and_run_and_energy_agree_on_the_temperature() {
    let (place, frame) = bench(FLUID, &[]);
    let plain = place.json("energy from-file.toml");
    assert!(plain["remarks"].is_null(), "no drift, no remark");
    place.write("start.xyz", &drifting(&frame));
    let temperature = number(&plain["temperature"]);
    let with_drift = number(&place.json("energy from-file.toml")["temperature"]);
    assert!((with_drift - temperature).abs() < 1e-9);
    // 2K/(3N − 3) of the drift alone: N/(3N − 3) of its square.
    let before = temperature + 0.25 * 108.0 / 321.0;
    let words = format!(
        "start.xyz had a total momentum of (0.500000, 0.000000, 0.000000) per particle: removed, T changed from {before:.6} to {temperature:.6}"
    );
    let told = |said: &str| {
        contains(&in_one_line(&said.replace("-0.000000", "0.000000")), &[&words]);
    };
    told(&place.succeed("energy from-file.toml"));
    told(&place.succeed("run from-file.toml --out out"));
    told(&place.record("out")["remarks"].to_string());
    // It stays with the run that goes on.
    place.succeed("resume out --steps 10 --quiet");
    told(&place.record("out")["remarks"].to_string());
}

/// Temperatures of the remark are over the degrees of freedom of the run: bonds take some.
#[test]
fn the_drift_of_a_file_of_molecules_has_the_temperatures_of_molecules() {
    let molecule = "[molecule]\nkind = \"dumbbell\"\nbond_length = 0.6\n[truncation]";
    let changes = [("[truncation]", molecule)];
    let scene = FLUID.replace("n_atoms = 108\ndensity = 0.8", "n_molecules = 108\ndensity = 0.4");
    let (place, frame) = bench(&scene.replace("[truncation]", molecule), &changes);
    place.write("start.xyz", &drifting(&frame));
    let document = place.json("energy from-file.toml");
    let after = number(&document["temperature"]);
    // 5·108 − 3 degrees of freedom, and 216 particles.
    let before = after + 0.25 * 216.0 / 537.0;
    let words = format!("removed, T changed from {before:.6} to {after:.6}");
    contains(&document["remarks"].to_string(), &[&words]);
}

/// A wall takes up the momentum across it: a run keeps that drift, and must not claim to remove it.
#[test]
fn the_drift_across_walls_stays_and_no_remark_claims_otherwise() {
    let changes = [
        ("r_cut = 2.2", "r_cut = 2.2\ntail_correction = false"),
        ("[[stage]]", "[[wall]]\naxis = \"x\"\nkind = \"hard\"\n[[stage]]"),
    ];
    let slit = changes.iter().fold(FLUID.to_owned(), |text, (from, to)| text.replace(from, to));
    let (place, frame) = bench(&slit, &changes);
    let still = place.json("energy from-file.toml");
    place.write("start.xyz", &drifting(&frame));
    let moving = place.json("energy from-file.toml");
    let [still, hot] = [&still, &moving].map(|document| number(&document["temperature"]));
    assert!((hot - still).abs() > 1e-3, "{hot} {still}");
    assert!(moving["remarks"].is_null());
}

#[test]
fn the_frame_of_a_file_with_many_is_named() {
    let (place, _) = bench(FLUID, &[]);
    let said = place.succeed("run from-file.toml --out other");
    assert!(!said.contains("the start is frame"), "{said}");
    place.succeed("run liquid.toml --quiet --out many --set output.trajectory_every=50");
    place.write("start.xyz", &place.read("many/trajectory.xyz"));
    let words = "the start is frame 4 of 4 of ";
    contains(&place.succeed("run from-file.toml --out out"), &[words, "start.xyz"]);
    contains(&place.record("out")["remarks"].to_string(), &[words]);
}

/// Proves that the last state is written with its energies, whatever the steps of rows and samples. The state has the
/// same bits as where rows and samples fall on the last step.
#[test]
fn the_last_state_has_its_energies_whenever_samples_are_taken() {
    let place = Place::with(&[("liquid.toml", FLUID)]);
    let value = |text: &str, key: &str| -> f64 {
        let line = text.lines().nth(1).unwrap();
        let (_, after) = line.split_once(&format!("{key}=")).unwrap();
        after.split_whitespace().next().unwrap().parse().unwrap()
    };
    for precision in ["double", "mixed"] {
        let [on, off] = [10, 7].map(|every| {
            let out = format!("{precision}-{every}");
            place.succeed(&format!(
                "run liquid.toml --quiet --out {out} --set output.thermo_every={every} \
                 --precision {precision} --set stage.0.steps=40"
            ));
            place.read(&format!("{out}/final.xyz"))
        });
        for key in ["total_potential_energy", "total_kinetic_energy", "pressure"] {
            assert_eq!(value(&on, key), value(&off, key), "{key}");
        }
        assert!(on.lines().skip(2).eq(off.lines().skip(2)));
    }
}

#[test]
fn going_on_is_advised_only_where_there_is_a_checkpoint() {
    let place = Place::with(&[("liquid.toml", FLUID)]);
    place.succeed("run liquid.toml --quiet --out out");
    let record = place.read("out/run.json");
    place.write("out/run.json", &record.replace("\"finished\": true", "\"finished\": false"));
    let said = || {
        let output = place.output("compare out");
        assert_eq!(stdout(&output), "");
        ended(&output, 2, &["did not finish"])
    };
    contains(&said(), &["to go on: lennard resume out"]);
    for path in checkpoints(&place.path("out")) {
        fs::remove_file(path).unwrap();
    }
    let again = "it has no checkpoint to go on from; to start again: lennard run out/scene.toml --out FOLDER";
    contains(&said(), &[again]);
    assert!(!said().contains("lennard resume"));
}
