//! Quantities with units, from the scene to the results.

use crate::program::common::*;

const ARGON: &str = r#"
[units]
substance = "argon"

[system]
n_atoms = 108
density = "1.374 g/cm3"
temperature = "94.4 K"
seed = 3

[truncation]
r_cut = "7.5 Å"

[integrator]
dt = "10 fs"

[[stage]]
name = "equilibration"
steps = 200
temperature = { from = "120 K", to = "94.4 K" }
thermostat = { kind = "bussi", tau = "1 ps" }

[[stage]]
name = "production"
steps = 400
thermostat = { kind = "bussi", tau = 0.5 }
"#;

/// Proves that units are a way of writing. A scene with units has the bits of the same scene in plain numbers, and shows its
/// results in both units.
#[test]
fn a_scene_with_units_is_the_scene_of_its_plain_numbers_and_shows_both() {
    let place = Place::with(&[("argon.toml", ARGON)]);
    let said = place.succeed("run argon.toml --out with");
    let both = "argon: σ = 3.405 Å, ε/k_B = 119.8 K, m = 39.948 u";
    contains(&said, &["argon: 94.40 K, 1.374 g/cm3, dt = 10.00 fs", both, "MPa", "kJ/mol"]);
    let resolved = place.read("with/scene.toml");
    let plain = resolved.replace("[units]\nsubstance = \"argon\"\n", "");
    assert_ne!(resolved, plain);
    place.write("plain.toml", &plain);
    place.succeed("run plain.toml --out plain --quiet");
    let [with, plain] = ["with", "plain"].map(|folder| place.record(folder));
    assert_eq!(with["averages"], plain["averages"]);
    assert!(plain.get("units").is_none());
    for (key, one, unit) in [
        ("temperature", 119.8, "K"),
        ("pressure", 41.897_56, "MPa"),
        ("potential_energy", 0.996_072, "kJ/mol"),
    ] {
        let (reduced, physical) = (&with["averages"][key], &with["units"]["averages"][key]);
        assert_eq!(physical["unit"], unit);
        let ratio = number(&physical["mean"]) / number(&reduced["mean"]);
        assert!((ratio / one - 1.0).abs() < 1e-5, "{key}: {ratio}");
    }
    assert_eq!(with["units"]["substance"], "argon");
    // The page has the table of the terminal.
    contains(&place.read("with/report.html"), &["argon: σ = 3.405 Å", "MPa"]);
}

#[test]
fn a_sweep_takes_values_with_units_and_has_numbers_in_its_table() {
    let study = "base = \"argon.toml\"\nreading = \"table\"\n[set]\n\"system.density\" = \"20 mol/L\"\n\
        [grid]\ntemperature = [\"160 K\", \"200 K\"]\n";
    let place = Place::with(&[("argon.toml", ARGON), ("study.toml", study)]);
    let points = &place.json("sweep study.toml --out out --quiet")["points"];
    for (i, kelvin) in [160.0, 200.0].into_iter().enumerate() {
        assert_eq!(points[i]["name"], format!("T{kelvin}K"));
        let setting = number(&points[i]["settings"][0]["value"]);
        assert!((setting - kelvin / 119.8).abs() < 1e-12, "{setting}");
    }
    let trouble = "base = \"argon.toml\"\n[grid]\ntemperature = [\"160 K\", \"2 bar\"]\n";
    place.write("study.toml", trouble);
    place.refused("sweep study.toml --out other", &["study.toml, line 3", "\"2 bar\""]);
}

#[test]
fn equations_of_state_take_and_give_units() {
    let state = "eos thol-2016 --substance argon -T 94.4K -d '1.374 g/cm3'";
    contains(&succeed(state), &["argon: σ = 3.405 Å", "MPa", "J/(mol K)", "m/s"]);
    let found = json(&succeed(&format!("{state} --json")));
    let columns = found["physical"][0]["columns"].as_array().unwrap();
    let column = |name: &str| columns.iter().find(|c| c["name"] == name).unwrap();
    let pressure = number(&found["states"][0]["properties"]["pressure"]);
    assert_eq!(column("pressure")["unit"], "MPa");
    let physical = number(&column("pressure")["cells"][0]);
    assert!((physical / pressure / 41.897_56 - 1.0).abs() < 1e-6, "{physical} {pressure}");
    assert!((number(&column("T")["cells"][0]) - 94.4).abs() < 1e-9);
    let argon = "eos thol-2016 --substance argon";
    let curve = succeed(&format!("{argon} -T 90:100:5K -p 40bar"));
    contains(&curve, &["T / K", "ρ / g/cm3"]);
    let two = succeed(&format!("{argon} --saturation -T '100 K'"));
    contains(&two, &["kJ/mol", "P / MPa"]);
    for (temperature, substance, words) in [
        ("94K", "", "no substance is named"),
        ("94bar", "--substance argon", "a unit of another dimension"),
        ("94kelvin", "--substance argon", "nearest: K"),
        ("94K", "--substance krypton", "in no source that was checked"),
        ("94K", "--substance argn", "did you mean `argon`?"),
    ] {
        refused(&format!("eos -T {temperature} -d 0.8 {substance}"), &[words]);
    }
}

/// Proves that a data file in real units is read where a substance is named, and refused by the name of its key elsewhere.
#[test]
fn a_file_in_real_units_starts_a_run_where_a_substance_is_named() {
    let mut data = "LAMMPS data file via write_data, units = real\n\n108 atoms\n1 atom types\n\n\
        0 17.3 xlo xhi\n0 17.3 ylo yhi\n0 17.3 zlo zhi\n\nMasses\n\n1 39.948\n\nAtoms # atomic\n\n"
        .to_owned();
    for i in 0..108 {
        let cell = [i / 4 % 3, i / 12 % 3, i / 36].map(f64::from);
        let corner =
            [[0.0, 0.0, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]][i as usize % 4];
        let [x, y, z] = [0, 1, 2].map(|k| (cell[k] + corner[k] + 0.25) * 17.3 / 3.0);
        data += &format!("{} 1 {x} {y} {z}\n", i + 1);
    }
    let scene = ARGON
        .replace("n_atoms = 108\n", "")
        .replace("density = \"1.374 g/cm3\"\n", "")
        .replace("[truncation]", "[start]\nkind = \"file\"\nfile = \"real.data\"\n\n[truncation]");
    let place = Place::with(&[("real.data", &data), ("argon.toml", &scene)]);
    assert_eq!(place.json("energy argon.toml")["atoms"], 108);
    let said = place.succeed("run argon.toml --out out --no-report");
    contains(&said, &["box 5.0808 × 5.0808 × 5.0808 σ"]);
    let plain = scene.replace("[units]\nsubstance = \"argon\"\n", "");
    let plain =
        plain.replace("\"94.4 K\"", "0.8").replace("\"120 K\"", "1.0").replace("\"1 ps\"", "0.5");
    let plain = plain.replace("\"7.5 Å\"", "2.2").replace("\"10 fs\"", "0.004");
    place.write("plain.toml", &plain);
    place.refused("run plain.toml --out plain", &["units `real`", "`units.substance`"]);
}
