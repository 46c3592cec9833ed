use crate::sweep::{Sweep, load, plan};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

fn inputs() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../inputs")
}

/// A file `sweep.toml` over one of the shipped scenes, read by `read`.
fn read<T>(base: &str, text: &str, read: impl FnOnce(&std::path::Path) -> T) -> T {
    let folder = tempfile::tempdir().unwrap();
    let base = inputs().join(base);
    let path = folder.path().join("sweep.toml");
    std::fs::write(&path, format!("base = {base:?}\n{text}")).unwrap();
    read(&path)
}

const STATE_POINT: &str = "verlet-1967/state-point.toml";

fn loaded(base: &str, text: &str, set: &[(&str, &str)]) -> Result<Sweep, String> {
    let owned = |(key, value): &(&str, &str)| ((*key).to_owned(), (*value).to_owned());
    let set: Vec<_> = set.iter().map(owned).collect();
    read(base, text, |path| load(path, &set).map_err(|e| e.to_string()))
}

fn sweep_of(text: &str) -> Result<Vec<String>, String> {
    let sweep = loaded(STATE_POINT, text, &[])?;
    Ok(sweep.points.iter().map(|p| p.name.to_string()).collect())
}

#[test]
fn points_and_grids_multiply() {
    let names =
        sweep_of("[[point]]\ndensity = 0.5\ntemperature = [2, 3.5]\n[grid]\nseed = [1, 2]\n")
            .unwrap();
    assert_eq!(
        names,
        ["rho0.5-T2-seed1", "rho0.5-T2-seed2", "rho0.5-T3.5-seed1", "rho0.5-T3.5-seed2"]
    );
}

#[test]
fn bonds_and_molecules_are_keys_of_a_sweep_of_molecules() {
    let of_molecules = |text: &str| loaded("dumbbell/liquid.toml", text, &[]);
    let sweep = of_molecules("[grid]\nbond_length = [0.505, 0.67]\nn_molecules = 256\n").unwrap();
    let names: Vec<&str> = sweep.points.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["M256-L0.505", "M256-L0.67"]);
    let lengths = sweep.points.iter().map(|point| {
        let molecule = point.scene.molecule.as_ref().unwrap();
        (point.atoms, molecule.topology.bonds()[0].length)
    });
    assert_eq!(lengths.collect::<Vec<_>>(), [(512, 0.505), (512, 0.67)]);
    let refused = of_molecules("[grid]\nn_atoms = 256\n").unwrap_err();
    assert!(refused.contains("does not go with `[molecule]`"), "{refused}");
    for (wrong, key) in
        [("n_molecules = [-3]", "grid.n_molecules"), ("bond_length = \"long\"", "grid.bond_length")]
    {
        let refused = of_molecules(&format!("[grid]\n{wrong}\n")).unwrap_err();
        assert!(refused.contains(&format!("sweep.toml, line 3: `{key}`")), "{refused}");
        assert!(refused.contains("\n  allowed: "), "{refused}");
    }
    let refused = sweep_of("[grid]\nbond_length = 0.67\n").unwrap_err();
    assert!(refused.contains("L0.67") && refused.contains("does not go with"), "{refused}");
}

/// Proves that every point draws noise of its own, whether the sweep names seeds or not. The seed of a point follows
/// from seed and point alone, whatever else the sweep holds, and in any order. It does not judge the noise.
#[test]
fn every_point_has_a_seed_of_its_own() {
    let seeds = |text: &str, set: &[(&str, &str)]| -> BTreeMap<String, u64> {
        let points = loaded(STATE_POINT, text, set).unwrap().points;
        points.into_iter().map(|p| (p.name.to_string(), p.scene.system.seed)).collect()
    };
    let grid = "[grid]\ndensity = [0.5, 0.6]\ntemperature = [1.5, 2]\n";
    let given = seeds(&format!("{grid}seed = [1, 2]\n"), &[]);
    let different: BTreeSet<u64> = given.values().copied().collect();
    assert_eq!((given.len(), different.len()), (8, 8));
    let one = seeds("[[point]]\ntemperature = 2\ndensity = 0.6\nseed = 2\nlonger = 2\n", &[]);
    assert_eq!(one["rho0.6-T2-seed2"], given["rho0.6-T2-seed2"]);
    // Without seeds in the sweep, the seed of the base counts, or the seed on the command line.
    let of_base = seeds(grid, &[]);
    assert_eq!(of_base.values().collect::<BTreeSet<_>>().len(), 4);
    let typed = seeds(grid, &[("system.seed", "2")]);
    assert_eq!(typed["rho0.6-T2"], given["rho0.6-T2-seed2"]);
    assert_ne!(typed["rho0.6-T2"], of_base["rho0.6-T2"]);
    // Written down: results of finished sweeps depend on it.
    assert_eq!(typed["rho0.6-T2"], 1_391_517_163_838_379_471);
}

#[test]
fn the_isotherm_is_held_at_its_temperature() {
    let sweep = load(&inputs().join("sweep/isotherm.toml"), &[]).unwrap();
    for point in &sweep.points {
        let stage = point.scene.stages.last().unwrap();
        assert_eq!(stage.temperature, 1.5, "{}", point.name);
        let bath = stage.thermostat.as_ref().map(|bath| format!("{bath:?}"));
        let bath = bath.unwrap_or_default().to_lowercase();
        assert!(bath.contains("bussi") && bath.contains("tau: 0.2"), "{bath}");
    }
}

#[test]
fn a_grid_of_many_lists_is_refused_before_it_is_multiplied_out() {
    let numbers: Vec<String> =
        (1..1000).map(|k| format!("{}", 0.5 + 1e-4 * f64::from(k))).collect();
    let list = numbers.join(", ");
    let axes = ["density", "temperature", "r_cut", "dt"].map(|key| format!("{key} = [{list}]\n"));
    for table in ["[grid]", "[[point]]"] {
        let message = sweep_of(&format!("{table}\n{}", axes.concat())).unwrap_err();
        assert!(message.contains("more than 100000 points"), "{message}");
    }
}

#[test]
fn what_is_no_sweep_is_said_clearly() {
    for (text, wanted) in [
        ("", "no points"),
        ("[[point]]\n", "no points"),
        ("[grid]\ndensity = []\n", "no points"),
        (
            "[[point]]\ndensity = 0.5\n[grid]\ndensity = [0.4]\n",
            "found:   a key that [[point]] has too",
        ),
        ("[[point]]\nseed = 1\n[grid]\nseed = [2]\n", "allowed: each key in one of the two"),
        ("[[point]]\ndensity = 0.5\n[[point]]\ndensity = 0.5\n", "allowed: each point once"),
        (
            "[[point]]\nlonger = 2\n",
            "of density, temperature, n_atoms, n_molecules, bond_length, r_cut, dt, seed or any key of the scene, with",
        ),
        (
            "[[point]]\ndensity = 0.5\nlonger = -1\n",
            "`point.0.longer` is not allowed\n  found:   -1",
        ),
        (
            "[[point]]\ndensty = 0.5\n",
            "sweep.toml, line 3: `point.0.densty` is not a known key\n  found:   `densty`",
        ),
        ("[grid]\ndensty = [0.5]\n", "\n  nearest: density"),
        ("[grid]\ndensity = [\"a\"]\n", "sweep.toml, line 3: `grid.density` "),
        ("[grid]\n\"truncation.knd\" = [\"cut\"]\n", "`grid.truncation.knd` is not a known key"),
        ("[grid]\n\"system.density\" = [0.5]\ndensity = 0.6\n", "is written twice"),
        (
            "[zip]\ndensity = [0.5, 0.6]\ntemperature = [1, 2, 3]\n",
            "found:   3 values, and 2 of `density`",
        ),
        ("grids = 3\n", "`grids` is not a known key"),
        ("[[grid]]\ndensity = 0.5\n", "found:   `[[grid]]`"),
        (
            "reading = \"isotherm\"\n[grid]\ndensity = 0.5\n",
            "`reading` is not known\n  found:   \"isotherm\"",
        ),
        (
            "reading = \"arrhenius\"\n[grid]\ntemperature = [1, 2]\n",
            "found:   2 values of `temperature`\n  allowed: 3 values",
        ),
        ("reading = 3\n[grid]\ndensity = 0.5\n", "`reading` does not fit\n  found:   3"),
        (
            "[grid]\nseed = 99999999999999999999\n",
            "99999999999999999999, an integer beyond 64 bits",
        ),
        (
            "[set]\n\"system.seed\" = 99999999999999999999\n[[point]]\ndensity = 0.5\n",
            "an integer beyond 64 bits\n  allowed: whole numbers",
        ),
        ("[[point]]\ndensity = -1.0\n", "sweep.toml, line 3: `point.0.density`"),
        ("[set]\n\"system.densty\" = 1\n[[point]]\ndensity = 0.5\n", "densty"),
    ] {
        let message = sweep_of(text).unwrap_err();
        assert!(message.contains(wanted), "{text}: {message}");
    }
}

#[test]
fn a_longer_point_has_more_measured_steps_and_no_other_name() {
    let text = "[[point]]\ndensity = 0.5\nlonger = 2.5\n[[point]]\ndensity = 0.6\n";
    let sweep = loaded(STATE_POINT, text, &[("stage.production.steps", "1001")]).unwrap();
    let found: Vec<_> = sweep
        .points
        .iter()
        .map(|p| (p.name.as_str(), p.scene.stages[2].steps, p.scene.stages[1].steps))
        .collect();
    assert_eq!(found, [("rho0.5", 2503, 10_000), ("rho0.6", 1001, 10_000)]);
}

#[test]
fn a_start_from_a_file_has_its_density_and_number_of_particles() {
    let text = "[grid]\ntemperature = [1.0, 1.2]\n";
    for point in loaded("fluid/from-configuration.toml", text, &[]).unwrap().points {
        // NIST's number 4: 30 particles in a cube of side 8.
        assert_eq!(point.atoms, 30);
        assert!((point.density - 30.0 / 512.0).abs() < 1e-12, "{}", point.density);
    }
}

#[test]
fn the_sweeps_that_come_along_are_whole() {
    for (file, points) in [
        ("verlet-1967/table.toml", 38),
        ("sweep/isotherm.toml", 8),
        ("sweep/transport.toml", 8),
        ("sweep/time-step.toml", 4),
        ("sweep/heat-capacity.toml", 4),
    ] {
        let sweep = load(&inputs().join(file), &[]).unwrap();
        assert_eq!(sweep.points.len(), points, "{file}");
    }
    let table =
        load(&inputs().join("verlet-1967/table.toml"), &[("truncation.r_cut".into(), "4".into())])
            .unwrap();
    assert!(table.points.iter().all(|p| p.scene.truncation.r_cut == 4.0));
}

/// Proves that a study changes any key of the scene, multiplied or together with others, by words, numbers, tables and lists.
#[test]
fn any_key_of_the_scene_changes_from_point_to_point() {
    let names = sweep_of(
        "[grid]\n\"truncation.kind\" = [\"cut\", \"shift\"]\n\"truncation.tail_correction\" = false\ndt = [0.002, 0.004]\n",
    )
    .unwrap();
    assert_eq!(names[0], "cut-tail_correction-false-dt0.002");
    assert_eq!((names.len(), names[3].as_str()), (4, "shift-tail_correction-false-dt0.004"));
    let names = sweep_of(
        "[zip]\nname = [\"energy\", \"bath\"]\n\"stage.production.thermostat\" = [\"none\", { kind = \"bussi\", tau = 0.5 }]\n\
         [grid]\n\"stage.production.steps\" = [200, 400]\nseed = [1, 2]\n",
    )
    .unwrap();
    assert_eq!(names.len(), 8);
    assert_eq!(names[0], "energy-steps200-seed1");
    assert_eq!(names[7], "bath-steps400-seed2");
    let unnamed = sweep_of(
        "[grid]\n\"stage.production.thermostat\" = [{ kind = \"bussi\", tau = 0.5 }]\n\"system.box\" = [[10.0, 10.0, 10.0]]\n",
    )
    .unwrap();
    assert_eq!(unnamed, ["bussi-tau0.5-10-10-10"]);
}

/// Proves that a full name of a key with a short name is the same axis: names and seeds do not depend on the spelling.
#[test]
fn short_names_and_full_names_are_one_key() {
    let short = sweep_of("[grid]\ndensity = [0.5]\nseed = 1\n").unwrap();
    let full = sweep_of("[grid]\n\"system.seed\" = 1\nsystem.density = [0.5]\n").unwrap();
    assert_eq!(short, full);
}

#[test]
fn more_points_than_one_process_runs_are_listed_for_many() {
    let seeds: Vec<String> = (1..=10_001).map(|seed| seed.to_string()).collect();
    let text = format!("[grid]\nseed = [{}]\n", seeds.join(", "));
    let planned = read(STATE_POINT, &text, |path| plan(path, &[]).unwrap().points.len());
    assert_eq!(planned, 10_001);
    let refused = loaded(STATE_POINT, &text, &[]).unwrap_err();
    assert!(refused.contains("found:   more than 10000 points"), "{refused}");
    assert!(refused.contains("`--points`"), "{refused}");
}

#[test]
fn a_value_with_hundreds_of_digits_names_no_point() {
    for grid in ["dt = [1e-250]", "temperature = [1e250, 1e251]"] {
        let refused = sweep_of(&format!("[grid]\n{grid}\n")).unwrap_err();
        for words in ["values that name the point", "values that make a name: at most 200 letters"]
        {
            assert!(refused.contains(words), "{refused}");
        }
    }
}
