//! Several ranks in one run: the same files as one process, whatever the number of ranks and threads.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use lennard_core::{Team, team_of_threads};
use lennard_engine::{
    Control, Ending, EngineError, Progress, ResumeOptions, go_on, prepare_on, resume_on, run,
};
use lennard_io::{Existing, create_named_folder};

use crate::common::{self, AskToStop, contents};

/// A liquid of as few particles as ranks take, with rows, frames and checkpoints at odd places.
const LIQUID: &str = r#"
    system = { n_atoms = 4000, density = 0.8442, temperature = 1.2, seed = 11 }
    truncation = { kind = "shift", r_cut = 2.5 }
    integrator = { dt = 0.004 }
    stage = [
        { name = "melt", steps = 20, thermostat = "bussi" },
        { name = "production", steps = 40 },
    ]
    output = { thermo_every = 9, trajectory_every = 20 }
    checkpoint = { every_steps = 45 }
    observable = [{ kind = "pressure-tensor", every = 10 }]
"#;

/// A slab of liquid beside its vapor.
const SLAB: &str = r#"
    system = { n_atoms = 4000, temperature = 0.8, seed = 7 }
    start = { kind = "slab" }
    truncation = { kind = "cut", r_cut = 2.5, tail_correction = "planar" }
    integrator = { dt = 0.004 }
    stage = [{ name = "production", steps = 60, thermostat = "bussi" }]
    observable = [{ kind = "interface", every = 10 }]
    output = { thermo_every = 9, trajectory_every = 20 }
    checkpoint = { every_steps = 45 }
"#;

/// A scene and its overrides.
type Case<'a> = (&'a str, &'a str);

type Ended = Result<Ending, EngineError>;

/// Runs or goes on in a folder up to a step (0: to the end) as one rank of a team, or alone.
fn on_rank(case: Case<'_>, folder: &Path, until: u64, team: Option<&Team>) -> Ended {
    let goes_on = folder.join("scene.toml").exists();
    if let Some(team) = team {
        // Rank 0 makes files at once.
        assert!(!team.any(false));
    }
    let stop = AtomicBool::new(false);
    let mut progress = AskToStop(until, &stop);
    let options = ResumeOptions::default();
    let prepared = || prepare_on(common::scene(case.0, case.1), team);
    let leads = team.is_none_or(Team::leads);
    let held = leads.then(|| create_named_folder(folder, Existing::Keep).unwrap());
    let progress: &mut dyn Progress = if leads { &mut progress } else { &mut () };
    let control = Control { stop: &stop, deadline: None, progress };
    let outcome = match goes_on {
        true => go_on(&mut resume_on(folder, &options, team)?, held.as_ref(), control)?,
        false => run(&mut prepared()?, held.as_ref(), control)?,
    };
    let ranks = outcome.record.performance.ranks;
    assert_eq!(ranks.map(|r| r.ranks), team.map(|t| t.ranks() as u64));
    Ok(outcome.ending)
}

/// The same on all ranks of a team of threads, each with a pool of its own.
fn on_ranks(case: Case<'_>, folder: &Path, until: u64, [ranks, threads]: [usize; 2]) -> Vec<Ended> {
    team_of_threads(ranks, |team| {
        common::on_threads(threads, || on_rank(case, folder, until, Some(&team)))
    })
}

fn ended(all: Vec<Ended>, wanted: Ending) {
    for ended in all {
        assert_eq!(ended.unwrap_or_else(|e| panic!("{e}")), wanted);
    }
}

/// Compares teams with one process in whole runs, and in runs that go on with another number of ranks.
fn ranks_are_one_process(case: Case<'_>, teams: &[[usize; 2]]) {
    let root = common::folder();
    let alone = root.path().join("alone");
    ended(vec![on_rank(case, &alone, 0, None)], Ending::Finished);
    let alone = contents(&alone);
    for (k, team) in teams.iter().enumerate() {
        let what = format!("{:?} on {team:?}", case.1);
        let folder = root.path().join(format!("team-{k}"));
        ended(on_ranks(case, &folder, 0, *team), Ending::Finished);
        common::same_files(&alone, &contents(&folder), &what);
    }
    // Stopped on several ranks, gone on alone, stopped again, and ended on another number of ranks.
    let parts = root.path().join("parts");
    ended(on_ranks(case, &parts, 23, [3, 1]), Ending::Stopped);
    ended(vec![on_rank(case, &parts, 38, None)], Ending::Stopped);
    ended(on_ranks(case, &parts, 0, [2, 1]), Ending::Finished);
    let parts = contents(&parts);
    let last = alone.keys().rfind(|name| name.ends_with(".lennard"));
    for name in ["final.xyz", "thermo.csv", last.unwrap()] {
        assert!(alone[name] == parts[name], "{:?}: {name}", case.1);
    }
}

#[test]
fn a_fluid_has_the_bytes_of_one_process() {
    ranks_are_one_process((LIQUID, ""), &[[1, 1], [2, 1], [4, 2]]);
}

#[test]
fn fluids_under_baths_have_the_bytes_of_one_process() {
    for precision in ["double", "mixed"] {
        for bath in ["none", "bussi", "langevin", "nose-hoover", "rescale"] {
            let keys = format!("kernel.precision={precision} stage.production.thermostat={bath}");
            ranks_are_one_process((LIQUID, &keys), &[[2, 1], [3, 2]]);
        }
    }
}

#[test]
fn methods_have_the_bytes_of_one_process() {
    for kind in ["stormer-verlet", "leapfrog", "pefrl", "velocity-verlet-short"] {
        let keys = format!("integrator.kind={kind} neighbor.skin=0.2");
        ranks_are_one_process((LIQUID, &keys), &[[3, 1]]);
    }
}

#[test]
fn boxes_that_change_have_the_bytes_of_one_process() {
    let rescaling = r#"{ kind = "stochastic-cell-rescaling", pressure = 1.19, interval = 5 }"#;
    let mtk = r#"{ kind = "mtk", pressure = 1.0, tau = 0.5 }"#;
    for (bath, barostat) in [("bussi", rescaling), ("nose-hoover", mtk)] {
        let keys = format!(
            "stage.production.thermostat={bath} stage.production.barostat={barostat}
                observable=[{{kind=\"msd\",every=5,longest_lag=0.1,particles=900}}]"
        );
        ranks_are_one_process((LIQUID, &keys), &[[2, 2], [4, 1]]);
    }
}

#[test]
fn mixtures_have_the_bytes_of_one_process() {
    let alike = r#"[{ name = "A", fraction = 0.7 }, { name = "B", fraction = 0.3, sigma = 0.9, epsilon = 0.6 }]"#;
    let heavy = r#"[{ name = "A", fraction = 0.7 }, { name = "B", fraction = 0.3, sigma = 0.9, mass = 4.0 }]"#;
    let mixing = r#"{ rule = "lorentz-berthelot" }"#;
    let seen = r#"[{ kind = "structure-factor", every = 20 }, { kind = "vacf", every = 1, window = 0.02, particles = 700 },
        { kind = "mutual-diffusion", every = 1, window = 0.2 }, { kind = "rdf", every = 10 }]"#;
    for (species, precision) in [(alike, "mixed"), (heavy, "double"), (heavy, "mixed")] {
        let keys = format!(
            "species={species} mixing={mixing} kernel.precision={precision} observable={seen}"
        );
        ranks_are_one_process((LIQUID, &keys), &[[3, 2]]);
    }
}

#[test]
fn fluids_between_walls_have_the_bytes_of_one_process() {
    let seen =
        r#"[{ kind = "density-profile" }, { kind = "wall-pressure" }, { kind = "momentum" }]"#;
    for more in ["", "field={acceleration=[0.0,0.0,-0.1]}", "stage.production.thermostat=langevin"]
    {
        let keys = format!(r#"wall=[{{ kind = "wca", axis = "z" }}] observable={seen} {more}"#);
        ranks_are_one_process((LIQUID, &keys), &[[3, 1]]);
    }
}

#[test]
fn slabs_with_a_planar_tail_have_the_bytes_of_one_process() {
    for precision in ["double", "mixed"] {
        let keys = format!("kernel.precision={precision}");
        ranks_are_one_process((SLAB, &keys), &[[3, 1], [2, 2]]);
    }
}

#[test]
fn observables_have_the_bytes_of_one_process() {
    let seen = r#"[{ kind = "pressure-tensor", every = 7 }, { kind = "structure-factor", every = 15 },
        { kind = "msd", every = 3, longest_lag = 0.2 }, { kind = "vacf", every = 1, window = 0.02 },
        { kind = "einstein-frequency" }, { kind = "momentum" }, { kind = "density-profile", axis = "x" },
        { kind = "shear-viscosity", every = 1, window = 0.2 }]"#;
    ranks_are_one_process((LIQUID, &format!("observable={seen}")), &[[2, 1], [4, 1]]);
}

#[test]
fn frames_of_every_format_have_the_bytes_of_one_process() {
    for format in ["xyz", "xyz.gz", "lammps-dump", "xtc"] {
        let vectors = format == "xyz" || format == "lammps-dump";
        let keys = format!(
            r#"output.format="{format}" output.forces={vectors} output.velocities={vectors}"#
        );
        ranks_are_one_process((LIQUID, &keys), &[[3, 1]]);
    }
}

#[test]
fn a_run_that_was_stopped_goes_on_with_any_other_number_of_ranks() {
    let seen = r#"[{ kind = "msd", every = 3, longest_lag = 0.1, particles = 1111 }, { kind = "vacf", every = 2, window = 0.04 }]"#;
    let keys = format!(
        "kernel.precision=mixed stage.melt.steps=10 stage.production.steps=20
        stage.production.thermostat=langevin observable={seen}"
    );
    let case = (LIQUID, keys.as_str());
    let root = common::folder();
    let alone = root.path().join("alone");
    ended(vec![on_rank(case, &alone, 0, None)], Ending::Finished);
    let alone = contents(&alone);
    for before in 1..5 {
        for after in (1..5).filter(|after| *after != before) {
            let folder = root.path().join(format!("{before}-{after}"));
            ended(on_ranks(case, &folder, 17, [before, 1]), Ending::Stopped);
            ended(on_ranks(case, &folder, 0, [after, 1]), Ending::Finished);
            let found = contents(&folder);
            for name in
                ["final.xyz", "thermo.csv", "trajectory.xyz", "msd.csv", "vacf.csv", "run.json"]
            {
                assert!(alone[name] == found[name], "{before} to {after}: {name}");
            }
        }
    }
}

#[test]
fn a_failure_of_physics_is_met_by_all_ranks_and_one_of_them_tells_it() {
    let overrides = "integrator.dt=0.06 stage.production.thermostat=none";
    let root = common::folder();
    let alone = on_rank((LIQUID, overrides), &root.path().join("alone"), 0, None).unwrap_err();
    let text = alone.to_string();
    assert_eq!(alone.exit_code(), 3, "{text}");
    let first = |text: &str| text.lines().next().unwrap_or_default().to_owned();
    for ended in on_ranks((LIQUID, overrides), &root.path().join("team"), 0, [3, 1]) {
        let error = ended.unwrap_err();
        assert_eq!(error.exit_code(), 3);
        assert_eq!(first(&error.to_string()), first(&text));
    }
}

#[test]
fn ranks_that_cannot_run_together_are_told_apart() {
    let told = |overrides: [&str; 2]| -> Vec<String> {
        team_of_threads(3, |team| {
            let of_rank = overrides[team.rank().min(1)];
            let scene = common::scene(LIQUID, of_rank);
            let error = prepare_on(scene, Some(&team)).err().expect("an error");
            assert_eq!(error.exit_code(), 2);
            error.to_string()
        })
    };
    for text in told(["", "system.seed=12"]) {
        assert_eq!(
            text,
            "rank 1 has another scene or version of the program than rank 0: all ranks need the same program, input and kind \
             of processor"
        );
    }
}

#[test]
fn what_one_process_alone_runs_is_refused_by_name_with_the_way_out() {
    let cases = [
        (
            "system.n_atoms=864",
            "864 particles on several ranks",
            "4000 to 1000000000 particles, or one process",
        ),
        (
            "neighbor.mode=direct",
            "`neighbor.mode` is for one process alone",
            "one process, or \"verlet\"",
        ),
        (
            "kernel.kernel=reference",
            "`kernel.kernel` is for one process alone",
            "one process, or \"auto\"",
        ),
        ("integrator.kind=respa", "`integrator.kind` is for one process alone", "velocity-verlet"),
        ("integrator.kind=implicit-euler", "found:   \"implicit-euler\"", "velocity-verlet"),
        (
            "observable=[{kind=\"bond-order\"}]",
            "it looks at neighbors",
            "a scene without this observable",
        ),
        (
            "observable=[] contact={kind=\"hard\"}",
            "`contact` is for one process alone",
            "a scene without contacts",
        ),
        (
            "observable=[] wall=[{kind=\"hard\",axis=\"z\"}]",
            "hits count one after another",
            "a wall that only exerts a force",
        ),
        (
            "stage.production.thermostat=none stage.production.exchange={kind=\"heat\",every=10}",
            "`stage.production.exchange` is for one process alone",
            "a scene without exchanges",
        ),
    ];
    for (overrides, said, way_out) in cases {
        for ranks in [2, 3] {
            team_of_threads(ranks, |team| {
                let scene = common::scene(LIQUID, overrides);
                let error = prepare_on(scene, Some(&team)).err().expect(overrides);
                let text = error.to_string();
                assert_eq!(error.exit_code(), 2, "{text}");
                assert!(text.contains(said) && text.contains(way_out), "{overrides}: {text}");
            });
        }
    }
    let molecules = common::scene(common::DUMBBELLS, "");
    team_of_threads(2, |team| {
        let text = prepare_on(molecules.clone(), Some(&team)).err().expect("an error").to_string();
        assert!(text.contains("bonds join particles that ranks keep apart"), "{text}");
    });
}

/// Each observable says whether ranks sample it; those that do have no error in a run on ranks.
#[test]
fn every_observable_runs_on_ranks_or_says_why_not() {
    for spec in lennard_observables::observables() {
        let options = match spec.name {
            "thermodynamics" => continue,
            "msd" => ", longest_lag = 0.1",
            "vacf" | "mutual-diffusion" | "shear-viscosity" | "thermal-conductivity" => {
                ", every = 1, window = 0.2"
            }
            _ => "",
        };
        let walls = match spec.name {
            "wall-pressure" => r#"wall=[{ kind = "wca", axis = "z" }]"#,
            _ => "",
        };
        let species = match spec.species[0] {
            1 => "",
            _ => {
                r#"mixing={ rule = "lorentz-berthelot" }
                species=[{ name = "A", fraction = 0.7 }, { name = "B", fraction = 0.3, mass = 2.0 }]"#
            }
        };
        let keys = format!(
            "stage.melt.steps=4 stage.production.steps=16 stage.production.thermostat=bussi
            observable=[{{kind=\"{}\"{options}}}] {walls} {species}",
            spec.name
        );
        let Ok(scene) = common::parse(LIQUID, &keys) else {
            // Observables of molecules and of surfaces.
            assert!(spec.alone.is_some(), "{}", spec.name);
            continue;
        };
        let case = (LIQUID, keys.as_str());
        let root = common::folder();
        match spec.alone {
            Some(why) => {
                team_of_threads(2, |team| {
                    let error = prepare_on(scene.clone(), Some(&team)).err().expect(spec.name);
                    assert!(error.to_string().contains(why), "{error}");
                });
            }
            None => {
                let [alone, team] = ["alone", "team"].map(|name| root.path().join(name));
                ended(vec![on_rank(case, &alone, 0, None)], Ending::Finished);
                ended(on_ranks(case, &team, 0, [3, 1]), Ending::Finished);
                common::same_files(&contents(&alone), &contents(&team), spec.name);
            }
        }
    }
}

/// Blocks a checkpoint: a folder stands where it should be.
struct Block<'a>(&'a Path);

impl Progress for Block<'_> {
    fn update(&mut self, _stage: &str, done: u64, _total: u64) {
        if done == 45 {
            std::fs::create_dir_all(self.0.join("checkpoint-000000000050.lennard/full")).unwrap();
        }
    }
}

#[test]
fn a_disk_that_takes_no_more_ends_all_ranks_and_leaves_the_last_checkpoint_whole() {
    let root = common::folder();
    let folder = root.path().join("run");
    let case = (LIQUID, "checkpoint.every_steps=25");
    let stop = AtomicBool::new(false);
    let told = team_of_threads(3, |team| {
        assert!(!team.any(false));
        let mut simulation = prepare_on(common::scene(case.0, case.1), Some(&team)).unwrap();
        let held = team.leads().then(|| create_named_folder(&folder, Existing::Keep).unwrap());
        let (mut block, mut nothing) = (Block(&folder), ());
        let progress: &mut dyn Progress = if team.leads() { &mut block } else { &mut nothing };
        let control = Control { stop: &stop, deadline: None, progress };
        let error = run(&mut simulation, held.as_ref(), control).err().expect("a failed write");
        assert_eq!(error.exit_code(), 1);
        error.to_string()
    });
    assert!(told[0].contains("checkpoint-000000000050.lennard"), "{told:?}");
    assert_eq!(told[1..], ["another rank failed", "another rank failed"]);
    std::fs::remove_dir_all(folder.join("checkpoint-000000000050.lennard")).unwrap();
    ended(on_ranks(case, &folder, 0, [2, 1]), Ending::Finished);
    let alone = root.path().join("alone");
    ended(vec![on_rank(case, &alone, 0, None)], Ending::Finished);
    common::same_files(&contents(&alone), &contents(&folder), "after a full disk");
}
