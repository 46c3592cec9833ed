//! `lennard generate lammps`: the files for another program, and what is refused. LAMMPS itself judges them in `validation/test_lammps.py`.

use std::fs;
use std::path::Path;

use crate::program::common::{lennard, stderr, stdout};

const SCENE: &str = r#"
[system]
n_atoms = 54
density = 0.8
temperature = 1.2
seed = 5

[start]
lattice = "bcc"
[truncation]
kind = "shift"
r_cut = 2.0
[neighbor]
mode = "direct"
[integrator]
kind = "leapfrog"
dt = 0.002
[[stage]]
name = "melt"
steps = 20
temperature = { from = 2.0, to = 1.2 }
thermostat = { kind = "rescale", every = 5 }
[[stage]]
name = "production"
steps = 30
thermostat = { kind = "nose-hoover", tau = 0.4, chain = 2 }
[[observable]]
kind = "rdf"
[output]
trajectory_every = 10
thermo_every = 5
"#;

/// A folder with the scene in it, changed by these replacements.
fn bench(changes: &[(&str, &str)]) -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    let mut text = SCENE.to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    fs::write(root.path().join("liquid.toml"), text).unwrap();
    root
}

fn export(root: &Path, arguments: &[&str]) -> std::process::Output {
    lennard(&[&["generate", "lammps"], arguments].concat()).current_dir(root).output().unwrap()
}

fn script(root: &Path, folder: &str) -> String {
    fs::read_to_string(root.join(folder).join("in.lammps")).unwrap()
}

/// The commands, each with single blanks.
fn commands(script: &str) -> Vec<String> {
    let lines = script.lines().filter(|l| !l.is_empty() && !l.starts_with('#'));
    lines.map(|l| l.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
}

#[test]
fn a_scene_becomes_the_commands_of_its_model_and_its_stages() {
    let root = bench(&[]);
    let output = export(root.path(), &["liquid.toml", "out"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(
        commands(&script(root.path(), "out")),
        [
            "units lj",
            "atom_style atomic",
            "atom_modify map array",
            "boundary p p p",
            "read_data start.data",
            "pair_style lj/cut 2.0",
            "pair_modify shift yes tail no",
            "pair_coeff 1 1 1.0 1.0 2.0",
            "neighbor 0.3 bin",
            "neigh_modify delay 0 every 1 check yes",
            "thermo_style custom step time temp pe ke etotal press vol",
            "thermo_modify norm no format float %.15g",
            "thermo 5",
            "reset_timestep 0",
            "run 0",
            "timestep 0.002",
            "fix move all nve",
            "fix bath all temp/rescale 5 2.0 1.2 0.0 1.0",
            "run 20",
            "unfix bath",
            "unfix move",
            "timestep 0.002",
            "fix move all nvt temp 1.2 1.2 0.4 tchain 2",
            "dump frames all custom 10 production.lammpstrj id type x y z ix iy iz vx vy vz",
            "dump_modify frames sort id format float %.17g",
            "run 30",
            "undump frames",
            "unfix move",
        ]
    );
    let said = stdout(&output);
    for remark in [
        "54 particles at step 0",
        "not the same: the integrator leapfrog of stage melt is velocity Verlet (`fix nve`)",
        "not the same: the observable rdf is not exported",
        "cd out && lmp -in in.lammps",
    ] {
        assert!(said.contains(remark), "wanted `{remark}` in\n{said}");
    }
}

/// Every other line that a scene can become: what is changed, and a command that must be there.
#[test]
fn each_potential_truncation_and_bath_has_its_command() {
    let mixture = "[[species]]\nname = \"A\"\nfraction = 0.5\n[[species]]\nname = \"B\"\nfraction = 0.5\nsigma = 0.5\n\
        [mixing]\nrule = \"lorentz-berthelot\"\n[truncation]";
    let bath = "thermostat = { kind = \"rescale\", every = 5 }";
    let measured = "thermostat = { kind = \"nose-hoover\", tau = 0.4, chain = 2 }";
    let mie = "[potential]\nkind = \"mie\"\nrepulsive = 14\nattractive = 7\n[truncation]";
    let wca = "[potential]\nkind = \"wca\"\n[truncation]";
    let mtk = format!("{measured}\nbarostat = {{ kind = \"mtk\", pressure = 1.5, tau = 0.8 }}");
    let cells = "thermostat = \"bussi\"\nbarostat = { kind = \"stochastic-cell-rescaling\", pressure = 1.5 }";
    for (from, to, wanted) in [
        ("kind = \"shift\"", "kind = \"cut\"", "pair_modify shift no tail yes"),
        ("kind = \"shift\"", "kind = \"force-shift\"", "pair_style lj/smooth/linear 2.0"),
        ("[truncation]", mie, "pair_coeff 1 1 1.0 1.0 14 7 2.0"),
        ("[truncation]", wca, "pair_coeff 1 1 1.0 1.0 1.122462048309373"),
        ("[truncation]", mixture, "pair_coeff 1 2 1.0 0.75 2.0"),
        (
            bath,
            "thermostat = { kind = \"bussi\", tau = 0.3 }",
            "fix bath all temp/csvr 2.0 1.2 0.3 6",
        ),
        (
            bath,
            "thermostat = { kind = \"langevin\", friction = 0.5 }",
            "fix bath all langevin 2.0 1.2 2.0 6",
        ),
        (
            bath,
            "thermostat = { kind = \"langevin\", friction = 0.5 }",
            "compute_modify thermo_temp extra/dof 3",
        ),
        (measured, &mtk, "fix move all npt temp 1.2 1.2 0.4 tchain 2 iso 1.5 1.5 0.8 pchain 3"),
        (measured, cells, "fix move all npt temp 1.2 1.2 0.5 tchain 3 iso 1.5 1.5 1.0 pchain 3"),
    ] {
        let root = bench(&[(from, to)]);
        let output = export(root.path(), &["liquid.toml", "out", "--json"]);
        assert!(output.status.success(), "{to}: {}", stderr(&output));
        let written = commands(&script(root.path(), "out"));
        assert!(written.iter().any(|c| c == wanted), "wanted `{wanted}` in\n{written:#?}");
    }
}

#[test]
fn the_data_file_is_a_start_with_the_same_energy() {
    let root = bench(&[("leapfrog", "velocity-verlet")]);
    let run = lennard(&["run", "liquid.toml", "--quiet", "--out", "run"])
        .current_dir(root.path())
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", stderr(&run));
    let output = export(root.path(), &["run", "later", "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let document: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(document["files"], serde_json::json!(["later/start.data", "later/in.lammps"]));
    let text = script(root.path(), "later");
    assert!(text.contains("The run is finished: its last stage once more."), "{text}");
    assert!(commands(&text).contains(&"reset_timestep 50".to_owned()));
    let energy = |file: &str| -> serde_json::Value {
        let text = SCENE
            .replace("n_atoms = 54\ndensity = 0.8", "")
            .replace("lattice = \"bcc\"", &format!("kind = \"file\"\nfile = {file:?}"));
        fs::write(root.path().join("start.toml"), text).unwrap();
        let output =
            lennard(&["energy", "start.toml", "--json"]).current_dir(root.path()).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let mut report: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
        report.as_object_mut().unwrap().remove("remarks");
        report
    };
    assert_eq!(energy("later/start.data"), energy("run/final.xyz"));
}

#[test]
fn a_run_that_was_stopped_is_exported_with_the_stages_that_are_left() {
    let root = bench(&[("steps = 30", "steps = 2000000")]);
    let run = lennard(&["run", "liquid.toml", "--quiet", "--out", "run", "--max-walltime", "1s"])
        .current_dir(root.path())
        .output()
        .unwrap();
    assert_eq!(run.status.code(), Some(4), "{}", stderr(&run));
    let output = export(root.path(), &["run", "later"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let written = commands(&script(root.path(), "later"));
    let number = |name: &str, nth: usize| -> u64 {
        let found = written.iter().filter_map(|c| c.strip_prefix(name)).nth(nth);
        found.unwrap().trim().parse().unwrap()
    };
    let step = number("reset_timestep ", 0);
    assert!(step > 20, "the first stage is done");
    assert_eq!(number("run ", 1) + step, 2_000_020);
}

#[test]
fn what_lammps_does_not_have_is_refused_and_nothing_is_written() {
    let molecules = ("n_atoms = 54", "n_molecules = 54");
    let verlet = ("leapfrog", "velocity-verlet");
    let bond = ("[integrator]", "[molecule]\nbond_length = 0.6\n[integrator]");
    let wall = ("[integrator]", "[[wall]]\nkind = \"wca\"\naxis = \"y\"\n[integrator]");
    let measured = "thermostat = { kind = \"nose-hoover\", tau = 0.4, chain = 2 }";
    let z = "thermostat = \"bussi\"\nbarostat = { kind = \"stochastic-cell-rescaling\", pressure = 1.0, coupling = \"z\" }";
    let soft = "[potential]\nkind = \"soft-sphere\"\n[truncation]";
    for (changes, found, allowed) in [
        (
            vec![("kind = \"shift\"", "kind = \"switch\"")],
            "\"switch\" of the potential \"lennard-jones\", which LAMMPS does not have",
            "\"cut\" or \"shift\"; for \"lennard-jones\" also \"force-shift\"",
        ),
        (
            vec![("[truncation]", soft)],
            "\"soft-sphere\", in an export to LAMMPS",
            "\"lennard-jones\", \"mie\" or \"wca\"",
        ),
        (
            vec![molecules, verlet, bond, ("density = 0.8", "density = 0.4")],
            "molecules, in an export to LAMMPS",
            "atoms",
        ),
        (
            vec![wall, ("kind = \"rdf\"", "kind = \"momentum\"")],
            "walls across y, in an export to LAMMPS",
            "a box that is periodic in all directions",
        ),
        (
            vec![
                ("kind = \"shift\"", "kind = \"cut\"\ntail_correction = \"planar\""),
                ("lattice = \"bcc\"", "lattice = \"bcc\"\nvacuum = 10.0"),
                ("kind = \"rdf\"", "kind = \"momentum\""),
            ],
            "the planar tail, in an export to LAMMPS",
            "a scene without",
        ),
        (vec![(measured, z)], "\"z\", in an export to LAMMPS", "\"isotropic\""),
    ] {
        let root = bench(&changes);
        let output = export(root.path(), &["liquid.toml", "out"]);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        for word in [found, allowed] {
            assert!(message.contains(word), "wanted `{word}` in\n{message}");
        }
        assert!(!root.path().join("out").exists(), "{message}");
    }
}

#[test]
fn a_folder_that_holds_something_is_written_to_by_force_alone() {
    let root = bench(&[]);
    fs::create_dir(root.path().join("out")).unwrap();
    fs::write(root.path().join("out/notes.txt"), "mine").unwrap();
    let refused = export(root.path(), &["liquid.toml", "out"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("making the output folder"), "{}", stderr(&refused));
    let forced = export(root.path(), &["liquid.toml", "out", "--force"]);
    assert!(forced.status.success(), "{}", stderr(&forced));
    assert_eq!(fs::read(root.path().join("out/notes.txt")).unwrap(), b"mine");
    let overridden = export(root.path(), &["out", "other", "--seed", "3"]);
    assert_eq!(overridden.status.code(), Some(2));
    let message = stderr(&overridden);
    for word in [
        "exporting a run: the state of out belongs to its own scene",
        "an override of a key",
        "no override, or a scene",
    ] {
        assert!(message.contains(word), "wanted `{word}` in\n{message}");
    }
    let no_run = export(root.path(), &["out", "other"]);
    assert!(stderr(&no_run).contains("out holds no run"), "{}", stderr(&no_run));
}
