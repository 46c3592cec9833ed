//! What studies, sweeps and comparisons say when they cannot go on.

use std::fs;
use std::path::Path;

use lennard_core::StepError;
use lennard_scene::Scene;
use lennard_studies::StudyError;
use lennard_studies::bench::BenchError;
use lennard_studies::chart::ChartError;
use lennard_studies::compare::RunFolder;
use lennard_studies::settings::Settings;
use lennard_studies::sweep;
use lennard_studies::tune::TuneError;

#[test]
fn a_study_that_fails_says_where() {
    let none = std::io::Error::from(std::io::ErrorKind::PermissionDenied);
    let boxless = lennard_core::PeriodicBox::new(lennard_core::DVec3::ZERO).unwrap_err();
    for (error, wanted) in [
        (
            StudyError::Step { method: "leapfrog", dt: 0.1, source: StepError::BadStep(0.1) },
            "`leapfrog` failed at dt = 0.1: dt must be",
        ),
        (StudyError::NoSuchMethod("leapfrog"), "the list of integrators has no `leapfrog`"),
        (StudyError::Box(boxless), "the fluid of the study: a box side"),
        (
            StudyError::ForceField(lennard_forcefield::ForceFieldError::NoParticles),
            "the fluid of the study: there is no particle",
        ),
        (
            StudyError::Folder { path: "runs/x".into(), source: none },
            "cannot create the folder runs/x: ",
        ),
    ] {
        assert!(error.to_string().contains(wanted), "{error}");
    }
}

#[test]
fn a_benchmark_that_fails_says_in_which_part() {
    let lost = lennard_core::ForceError::NonFiniteForce { particle: 3 };
    for (error, wanted) in [
        (
            BenchError::Force(lost.clone()),
            "the forces failed while they were timed: the force on particle 3",
        ),
        (BenchError::Step(lost.into()), "the bare loop failed: the force on particle 3"),
    ] {
        assert!(error.to_string().contains(wanted), "{error}");
    }
}

#[test]
fn a_sweep_file_that_is_not_there_is_named() {
    let message = sweep::load(Path::new("nowhere/sweep.toml"), &[]).unwrap_err().to_string();
    assert!(message.starts_with("nowhere/sweep.toml: cannot be read: "), "{message}");
}

#[test]
fn a_folder_that_is_no_run_says_what_would_be() {
    let folder = tempfile::tempdir().unwrap();
    let message = RunFolder::open_any(folder.path()).unwrap_err().to_string();
    for wanted in [
        "holds no run: it has no run.json",
        "allowed: the output folder of a run, such as runs/triple-point-1",
    ] {
        assert!(message.contains(wanted), "{message}");
    }
    fs::write(folder.path().join("run.json"), "{}").unwrap();
    let message = RunFolder::open_any(folder.path()).unwrap_err().to_string();
    assert!(message.contains("run.json"), "{message}");
}

#[test]
fn a_chart_or_a_tuning_that_cannot_be_made_says_why() {
    let lost = || lennard_core::ForceError::NonFiniteForce { particle: 3 };
    let folder = ChartError::Folder {
        folder: "out".into(),
        found: "it holds something that is no chart".into(),
    };
    let allowed = "allowed: an empty folder, or one that holds this chart; give another --out, or --force to begin anew";
    assert!(folder.to_string().starts_with("out: it holds something"));
    assert!(folder.to_string().ends_with(allowed));
    let none = ChartError::NothingToCompare { found: 1, why: ": the box is too small".into() };
    assert_eq!(
        none.to_string(),
        "there is nothing to compare: 1 of the settings around this scene can run: the box is too small"
    );
    let forces = StudyError::Force { label: "leapfrog, dt 0.1".into(), source: lost() };
    let wanted = "the forces of leapfrog, dt 0.1: the force on particle 3";
    assert!(forces.to_string().starts_with(wanted), "{forces}");
    let refused = rayon::ThreadPoolBuilder::new()
        .spawn_handler(|_| Err(std::io::Error::other("no more of them")))
        .build();
    let threads = StudyError::Threads(refused.unwrap_err().into());
    assert_eq!(threads.to_string(), "starting threads: no more of them");
    let sample = TuneError::Force(lost().to_string());
    let wanted = "the forces of the sample: the force on particle 3";
    assert!(sample.to_string().starts_with(wanted), "{sample}");
}

#[test]
fn settings_that_do_not_go_together_are_refused() {
    let text = "[system]\nn_atoms = 256\ndensity = 0.8\ntemperature = 1.0\n\n[[stage]]\nname = \"run\"\nsteps = 10\n";
    let scene = Scene::parse(text, "plain.toml", &[]).unwrap();
    let usual = Settings::of(&scene);
    let still = Settings { dt: 0.0, ..usual.clone() };
    let refused = still.apply(&scene).unwrap_err().to_string();
    assert!(refused.contains("dt must be above 0, found 0"), "{refused}");
    let split = Settings {
        split: Some(lennard_forcefield::SplitOptions { r_split: 1.5, width: 0.3 }),
        ..usual
    };
    let refused = split.apply(&scene).unwrap_err().to_string();
    let wanted = "a split of the force belongs to `respa`, and `respa` needs one";
    assert!(refused.contains(wanted), "{refused}");
}
