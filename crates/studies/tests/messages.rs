//! What studies, sweeps and comparisons say when they cannot go on.

use std::fs;
use std::path::Path;

use lennard_core::StepError;
use lennard_studies::StudyError;
use lennard_studies::bench::BenchError;
use lennard_studies::compare::RunFolder;
use lennard_studies::sweep;

#[test]
fn a_study_that_fails_says_where() {
    let none = std::io::Error::from(std::io::ErrorKind::PermissionDenied);
    let boxless = lennard_core::PeriodicBox::new(lennard_core::DVec3::ZERO).unwrap_err();
    for (error, wanted) in [
        (
            StudyError::Step {
                method: "leapfrog",
                dt: 0.1,
                source: StepError::BadStep(0.1),
            },
            "`leapfrog` failed at dt = 0.1: dt must be",
        ),
        (
            StudyError::NoSuchMethod("leapfrog"),
            "the list of integrators has no `leapfrog`",
        ),
        (
            StudyError::Box(boxless),
            "the fluid of the study: a box side",
        ),
        (
            StudyError::ForceField(lennard_forcefield::ForceFieldError::NoParticles),
            "the fluid of the study: there is no particle",
        ),
        (
            StudyError::Folder {
                path: "runs/x".into(),
                source: none,
            },
            "cannot create the folder runs/x: ",
        ),
        (
            StudyError::Csv {
                name: "orders",
                reason: "why".into(),
            },
            "cannot write orders: why",
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
        (
            BenchError::Step(lost.into()),
            "the bare loop failed: the force on particle 3",
        ),
    ] {
        assert!(error.to_string().contains(wanted), "{error}");
    }
}

#[test]
fn a_sweep_file_that_is_not_there_is_named() {
    let message = sweep::load(Path::new("nowhere/sweep.toml"), &[])
        .unwrap_err()
        .to_string();
    assert!(
        message.starts_with("nowhere/sweep.toml: cannot be read: "),
        "{message}"
    );
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
