//! Several ranks in one run: the same files as one process, whatever the number of ranks and threads.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use lennard_core::{Team, team_of_threads};
use lennard_engine::{
    Control, Ending, EngineError, ResumeOptions, Simulation, go_on, prepare, resume, run,
    run_beside,
};
use lennard_io::{Existing, create_named_folder};

use crate::common::{self, AskToStop, DUMBBELLS, contents};

/// A liquid of few chunks, with rows, frames and checkpoints at odd places.
const LIQUID: &str = r#"
    system = { n_atoms = 256, density = 0.8442, temperature = 1.2, seed = 11 }
    truncation = { kind = "shift", r_cut = 2.5 }
    integrator = { dt = 0.004 }
    stage = [
        { name = "melt", steps = 60, thermostat = "bussi" },
        { name = "production", steps = 140 },
    ]
    output = { thermo_every = 9, trajectory_every = 50 }
    checkpoint = { every_steps = 130 }
    observable = [{ kind = "pressure-tensor", every = 20 }, { kind = "rdf", every = 40 }]
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
    let shared = |simulation: &mut Simulation| team.map_or(Ok(()), |team| simulation.share(team));
    if let Some(team) = team
        && !team.leads()
    {
        if goes_on {
            let mut resumed = resume(folder, &ResumeOptions::default())?;
            shared(&mut resumed.simulation)?;
            return run_beside(&mut resumed.simulation, &stop);
        }
        let mut simulation = prepare(common::scene(case.0, case.1))?;
        shared(&mut simulation)?;
        return run_beside(&mut simulation, &stop);
    }
    let held = create_named_folder(folder, Existing::Keep).unwrap();
    let control = Control { stop: &stop, deadline: None, progress: &mut progress };
    let outcome = if goes_on {
        let mut resumed = resume(folder, &ResumeOptions::default())?;
        shared(&mut resumed.simulation)?;
        go_on(&mut resumed, &held, control)?
    } else {
        let mut simulation = prepare(common::scene(case.0, case.1))?;
        shared(&mut simulation)?;
        run(&mut simulation, &held, control)?
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

/// Compares teams with one process in whole runs, and in runs that go on with another number of ranks.
fn ranks_are_one_process(case: Case<'_>, teams: &[[usize; 2]]) {
    let root = common::folder();
    let alone = root.path().join("alone");
    let ending = on_rank(case, &alone, 0, None).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(ending, Ending::Finished);
    for (k, team) in teams.iter().enumerate() {
        let what = format!("{:?} on {team:?}", case.1);
        let folder = root.path().join(format!("team-{k}"));
        for ended in on_ranks(case, &folder, 0, *team) {
            assert_eq!(ended.unwrap_or_else(|e| panic!("{e}")), Ending::Finished);
        }
        common::same_files(&contents(&alone), &contents(&folder), &what);
    }
    // Stopped on several ranks, gone on alone, stopped again, and ended on another number of ranks.
    let parts = root.path().join("parts");
    for ended in on_ranks(case, &parts, 77, [3, 1]) {
        assert_eq!(ended.unwrap_or_else(|e| panic!("{e}")), Ending::Stopped);
    }
    let stopped = on_rank(case, &parts, 150, None).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(stopped, Ending::Stopped);
    for ended in on_ranks(case, &parts, 0, [2, 1]) {
        assert_eq!(ended.unwrap_or_else(|e| panic!("{e}")), Ending::Finished);
    }
    let (alone, parts) = (contents(&alone), contents(&parts));
    let last = alone.keys().rfind(|name| name.ends_with(".lennard"));
    for name in ["final.xyz", "thermo.csv", last.unwrap()] {
        assert!(alone[name] == parts[name], "{:?}: {name}", case.1);
    }
}

#[test]
fn fluids_under_baths_have_the_bytes_of_one_process() {
    for precision in ["double", "mixed"] {
        for bath in ["none", "bussi", "langevin", "nose-hoover"] {
            let keys = format!("kernel.precision={precision} stage.production.thermostat={bath}");
            ranks_are_one_process((LIQUID, &keys), &[[1, 1], [2, 1], [4, 2]]);
        }
    }
}

#[test]
fn more_kinds_of_fluids_have_the_bytes_of_one_process() {
    let barostat = r#"{ kind = "stochastic-cell-rescaling", pressure = 1.19 }"#;
    let species = r#"[{ name = "A", fraction = 0.7 }, { name = "B", fraction = 0.3, sigma = 0.9, epsilon = 0.6 }]"#;
    let heavy = r#"[{ name = "A", fraction = 0.7 }, { name = "B", fraction = 0.3, sigma = 0.9, mass = 4.0 }]"#;
    let mixing = r#"{ rule = "lorentz-berthelot" }"#;
    let cases = [
        &format!("stage.production.thermostat=bussi stage.production.barostat={barostat}"),
        &format!("species={species} mixing={mixing} kernel.precision=mixed"),
        &format!("species={heavy} mixing={mixing}"),
        "integrator.kind=stormer-verlet",
        "integrator.kind=leapfrog neighbor.skin=0.2",
        "integrator.kind=respa integrator.dt=0.008",
        r#"wall=[{ kind = "wca", axis = "z" }] observable=[{ kind = "density-profile" }]"#,
        // Forces that are not shared: each rank computes all of them.
        "neighbor.mode=direct",
    ];
    for overrides in cases {
        ranks_are_one_process((LIQUID, overrides), &[[3, 2]]);
    }
}

#[test]
fn dumbbells_have_the_bytes_of_one_process() {
    for precision in ["double", "mixed"] {
        for bonds in ["direct", "spring"] {
            let overrides = format!(
                "stage.production.steps=200
                stage.production.thermostat=bussi kernel.precision={precision}
                bonds.method={bonds}"
            );
            ranks_are_one_process((DUMBBELLS, &overrides), &[[2, 1], [3, 2]]);
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
            let mut simulation = prepare(common::scene(LIQUID, of_rank)).unwrap();
            let error = simulation.share(&team).unwrap_err();
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
    let few = "system.n_atoms=32 truncation.r_cut=1.6";
    for text in told([few, few]) {
        assert_eq!(
            text,
            "3 ranks for 32 particles\n  allowed: at most 1, since each rank takes 48 neighbors in space or more"
        );
    }
}
