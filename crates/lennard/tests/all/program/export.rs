//! `lennard generate lammps`: the files for another program, and what is refused. LAMMPS itself judges them in `validation/test_lammps.py`.

use serde_json::Value;

use crate::program::common::*;

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

const EXPORT: &str = "generate lammps liquid.toml out";

/// A folder with the scene in it, changed by these replacements.
fn bench(changes: &[(&str, &str)]) -> Place {
    let mut text = SCENE.to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    Place::with(&[("liquid.toml", &text)])
}

/// The commands of the script in a folder, each with single blanks.
fn commands(place: &Place, folder: &str) -> Vec<String> {
    let script = place.read(&format!("{folder}/in.lammps"));
    let lines = script.lines().filter(|l| !l.is_empty() && !l.starts_with('#'));
    lines.map(in_one_line).collect()
}

#[test]
fn a_scene_becomes_the_commands_of_its_model_and_its_stages() {
    let place = bench(&[]);
    let said = place.succeed(EXPORT);
    assert_eq!(
        commands(&place, "out"),
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
    let words = [
        "54 particles at step 0",
        "not the same: the integrator leapfrog of stage melt is velocity Verlet (`fix nve`)",
        "not the same: the observable rdf is not exported",
        "cd out && lmp -in in.lammps",
    ];
    contains(&said, &words);
}

/// Every other line that a scene can become: what is changed, and a command that must be there.
#[test]
fn each_potential_truncation_and_bath_has_its_command() {
    let mixture = "[[species]]\nname = \"A\"\nfraction = 0.5\n[[species]]\nname = \"B\"\nfraction = 0.5\nsigma = 0.5\n\
        [mixing]\nrule = \"lorentz-berthelot\"\n[truncation]";
    let bath = "thermostat = { kind = \"rescale\", every = 5 }";
    let bussi = "thermostat = { kind = \"bussi\", tau = 0.3 }";
    let langevin = "thermostat = { kind = \"langevin\", friction = 0.5 }";
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
        (bath, bussi, "fix bath all temp/csvr 2.0 1.2 0.3 6"),
        (bath, langevin, "fix bath all langevin 2.0 1.2 2.0 6"),
        (bath, langevin, "compute_modify thermo_temp extra/dof 3"),
        (measured, &mtk, "fix move all npt temp 1.2 1.2 0.4 tchain 2 iso 1.5 1.5 0.8 pchain 3"),
        (measured, cells, "fix move all npt temp 1.2 1.2 0.5 tchain 3 iso 1.5 1.5 1.0 pchain 3"),
    ] {
        let place = bench(&[(from, to)]);
        place.json(EXPORT);
        let written = commands(&place, "out");
        assert!(written.iter().any(|c| c == wanted), "wanted `{wanted}` in\n{written:#?}");
    }
}

#[test]
fn the_data_file_is_a_start_with_the_same_energy() {
    let place = bench(&[("leapfrog", "velocity-verlet")]);
    place.succeed("run liquid.toml --quiet --out run");
    let document = place.json("generate lammps run later");
    assert_eq!(document["files"], serde_json::json!(["later/start.data", "later/in.lammps"]));
    let words = ["The run is finished: its last stage once more."];
    contains(&place.read("later/in.lammps"), &words);
    assert!(commands(&place, "later").contains(&"reset_timestep 50".to_owned()));
    let energy = |file: &str| -> Value {
        let text = SCENE
            .replace("n_atoms = 54\ndensity = 0.8", "")
            .replace("lattice = \"bcc\"", &format!("kind = \"file\"\nfile = {file:?}"));
        place.write("start.toml", &text);
        let mut report = place.json("energy start.toml");
        report.as_object_mut().unwrap().remove("remarks");
        report
    };
    assert_eq!(energy("later/start.data"), energy("run/final.xyz"));
}

#[test]
fn a_run_that_was_stopped_is_exported_with_the_stages_that_are_left() {
    let place = bench(&[("steps = 30", "steps = 2000000")]);
    ended(&place.output("run liquid.toml --quiet --out run --max-walltime 1s"), 4, &[]);
    place.succeed("generate lammps run later");
    let written = commands(&place, "later");
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
        let place = bench(&changes);
        place.refused(EXPORT, &[found, allowed]);
        assert!(!place.has("out"), "{found}");
    }
}

#[test]
fn a_folder_that_holds_something_is_written_to_by_force_alone() {
    let place = bench(&[]);
    place.write("out/notes.txt", "mine");
    place.refused(EXPORT, &["making the output folder"]);
    place.succeed(&format!("{EXPORT} --force"));
    assert_eq!(place.read("out/notes.txt"), "mine");
    let words = [
        "exporting a run: the state of out belongs to its own scene",
        "an override of a key",
        "no override, or a scene",
    ];
    place.refused("generate lammps out other --seed 3", &words);
    contains(&stderr(&place.output("generate lammps out other")), &["out holds no run"]);
}
