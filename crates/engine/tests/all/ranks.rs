//! Several ranks in one run: the same files as one process, whatever the number of ranks and threads.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use lennard_core::{Team, team_of_threads};
use lennard_engine::{
    Control, Ending, EngineError, ResumeOptions, Simulation, go_on, go_on_beside, prepare, resume,
    run, run_beside,
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
    if team.is_some_and(|team| !team.leads()) {
        if goes_on {
            let mut resumed = resume(folder, &ResumeOptions::default())?;
            shared(&mut resumed.simulation)?;
            return go_on_beside(&mut resumed, &stop);
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
