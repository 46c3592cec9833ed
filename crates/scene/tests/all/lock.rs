//! Accuracies and lock files: what is left to be chosen, what a lock brings, and which lock is refused.

use crate::keys::beside;
use lennard_forcefield::{ListMode, NeighborOptions, Precision, TruncationKind, TruncationOptions};
use lennard_scene::{Chosen, Judged, Lock, Scene};

const ASKING: &str = r#"accuracy = { potential_energy = 1e-3, drift = 1e-5 }
[system]
n_atoms = 864
density = 0.8
temperature = 1.0

[[stage]]
name = "heat"
steps = 10
thermostat = "bussi"

[[stage]]
name = "production"
steps = 20
"#;

const ALL_FREE: [&str; 5] = [
    "truncation.kind",
    "truncation.r_cut",
    "truncation.tail_correction",
    "integrator.dt",
    "kernel.precision",
];

fn parse(text: &str, overrides: &[(&str, &str)]) -> Scene {
    Scene::parse(text, "asking.toml", &beside(overrides)).unwrap_or_else(|e| panic!("{e}"))
}

fn chosen() -> Chosen {
    Chosen {
        truncation: TruncationOptions::new(TruncationKind::Cut, 3.25),
        dt: 0.0052,
        precision: Precision::Mixed,
        neighbor: NeighborOptions { mode: ListMode::Verlet, skin: Some(0.41) },
        threads: 3,
    }
}

#[test]
fn a_scene_with_settings_can_be_freed_of_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("own.toml");
    let text = ASKING.lines().skip(1).collect::<Vec<_>>().join("\n")
        + "\n[truncation]\nkind = \"shift\"\nr_cut = 2.5\n[integrator]\nkind = \"leapfrog\"\ndt = 0.003\n";
    std::fs::write(&path, text).unwrap();
    let freed = Scene::load_freed(&path, &[]).unwrap();
    assert_eq!(freed.accuracy, Some(lennard_scene::Accuracy::USUAL));
    assert_eq!(freed.free, ALL_FREE);
    // What is no setting stays, and so does what is given beside the file.
    assert_eq!(freed.integrator.method.name(), "leapfrog");
    let given = beside(&[("truncation.r_cut", "3.0")]);
    let partly = Scene::load_freed(&path, &given).unwrap();
    assert!(!partly.free.contains(&"truncation.r_cut"));
    assert_eq!(partly.truncation.r_cut, 3.0);
    // As overrides, what was chosen for it settles a scene without any lock.
    let all: Vec<_> = given.into_iter().chain(chosen().overrides()).collect();
    let settled = Scene::load(&path, &all).unwrap();
    assert_eq!(settled.truncation, chosen().truncation);
    assert_eq!(settled.neighbor, chosen().neighbor);
    assert_eq!(settled.integrator.dt, chosen().dt);
    assert_eq!(settled.kernel.precision, Precision::Mixed);
}

#[test]
fn an_accuracy_that_nobody_typed_is_named_as_no_override() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cold.toml");
    let text = ASKING.lines().skip(1).collect::<Vec<_>>().join("\n");
    std::fs::write(&path, text.replace("thermostat = \"bussi\"\n", "")).unwrap();
    let cold = beside(&[("system.temperature", "0")]);
    let message = Scene::load_freed(&path, &cold).unwrap_err().to_string();
    assert!(message.contains("cold.toml: `accuracy` has no state"), "{message}");
}

fn judged() -> Vec<Judged> {
    vec![Judged {
        quantity: "potential_energy".into(),
        unit: "ε per particle".into(),
        target: 1e-3,
        predicted: 4e-4,
        predicted_error: 1e-4,
        measured: 5e-4,
        measured_error: 3e-4,
    }]
}

fn lock_of(scene: &Scene) -> Lock {
    let text = Lock::text(scene, &chosen(), &judged(), "a processor");
    Lock::parse(&text, "asking.lock.toml").unwrap_or_else(|e| panic!("{e}\n{text}"))
}

#[test]
fn an_accuracy_leaves_free_what_is_not_written() {
    assert_eq!(parse(ASKING, &[]).free, ALL_FREE);
    let free = |set: &[(&str, &str)]| parse(ASKING, set).free;
    assert!(!free(&[("integrator.dt", "0.003")]).contains(&"integrator.dt"));
    assert!(!free(&[("stage.production.dt", "0.003")]).contains(&"integrator.dt"));
    // Another truncation than the plain cutoff has no tail to choose, the reference loop no precision.
    assert!(!free(&[("truncation.kind", "switch")]).contains(&"truncation.tail_correction"));
    assert!(!free(&[("kernel.kernel", "reference")]).contains(&"kernel.precision"));
    let wca = free(&[("potential.kind", "wca")]);
    assert_eq!(wca, ["integrator.dt", "kernel.precision"]);
    // Without an accuracy nothing is.
    let plain = ASKING.replace("accuracy = { potential_energy = 1e-3, drift = 1e-5 }\n", "");
    let plain = parse(&plain, &[]);
    assert!(plain.free.is_empty() && plain.settled().is_ok());
}

#[test]
fn whose_pressure_is_wanted_depends_on_what_is_fixed() {
    let full = |set: &[(&str, &str)]| parse(ASKING, set).wants_full_potential();
    assert!(full(&[]) && full(&[("truncation.r_cut", "2.5")]));
    assert!(!full(&[("truncation.r_cut", "2.5"), ("truncation.kind", "shift")]));
    assert!(!full(&[("potential.kind", "wca")]));
}

#[test]
fn nothing_may_be_run_before_a_lock_has_brought_the_settings() {
    let scene = parse(ASKING, &[]);
    let error = scene.settled().unwrap_err();
    assert_eq!((error.key_path(), error.line()), (Some("accuracy"), Some(1)));
    assert!(error.to_string().contains("lennard tune asking.toml"), "{error}");
    let settled = lock_of(&scene).settle(&scene).unwrap();
    assert!(settled.settled().is_ok());
    assert_eq!(settled.truncation, chosen().truncation);
    assert_eq!(settled.integrator.dt, 0.0052);
    assert_eq!(settled.kernel.precision, Precision::Mixed);
    assert_eq!(settled.neighbor, chosen().neighbor);
    assert_eq!(settled.accuracy, scene.accuracy);
    // What the run writes beside its results needs no lock any more.
    let again = parse(&settled.resolved_toml(), &[("name", "asking")]);
    assert_eq!(again, Scene { name: "asking".into(), ..settled });
}

#[test]
fn what_is_fixed_by_hand_stays_as_it_is() {
    let scene = parse(ASKING, &[("integrator.dt", "0.001"), ("neighbor.skin", "0.2")]);
    let settled = lock_of(&scene).settle(&scene).unwrap();
    assert_eq!(settled.integrator.dt, 0.001);
    assert_eq!(settled.neighbor.skin, Some(0.2));
    assert_eq!(settled.truncation.r_cut, 3.25);
}

#[test]
fn seed_lengths_and_outputs_may_change_and_nothing_else() {
    let lock = lock_of(&parse(ASKING, &[]));
    for (key, value) in [
        ("system.seed", "99"),
        ("stage.production.steps", "123456"),
        ("output.thermo_every", "7"),
        ("checkpoint.every_steps", "100"),
        ("kernel.isa", "portable"),
        ("name", "other"),
    ] {
        let scene = parse(ASKING, &[(key, value)]);
        assert!(lock.settle(&scene).is_ok(), "{key}");
    }
    for (key, value) in [
        ("system.density", "0.7"),
        ("system.n_atoms", "500"),
        ("accuracy.drift", "1e-6"),
        ("stage.heat.temperature", "2.0"),
        ("integrator.dt", "0.001"),
        ("integrator.kind", "leapfrog"),
        ("neighbor.skin", "0.3"),
    ] {
        let scene = parse(ASKING, &[(key, value)]);
        let error = lock.settle(&scene).unwrap_err();
        let named = key.replace("heat", "0");
        assert_eq!(error.key_path(), Some(named.as_str()), "{error}");
        assert_eq!(error.file(), "asking.lock.toml");
        assert!(error.message().contains("belongs to another"), "{error}");
        let text = error.to_string();
        assert!(text.contains(value) && text.contains("lennard tune asking.toml"), "{text}");
    }
}

#[test]
fn a_lock_that_was_written_over_is_checked_like_a_scene() {
    let scene = parse(ASKING, &[]);
    let text = Lock::text(&scene, &chosen(), &judged(), "a processor");
    let with = |from: &str, to: &str| {
        let changed = text.replacen(from, to, 1);
        assert_ne!(text, changed, "{from}");
        let lock = Lock::parse(&changed, "hand.lock.toml");
        lock.and_then(|lock| lock.settle(&scene)).unwrap_err()
    };
    let cases = [
        (with("dt = 0.0052", "dt = -0.0052"), "integrator.dt", "is negative"),
        (with("dt = 0.0052", "dt = nan"), "integrator.dt", "is not a finite number"),
        (with("r_cut = 3.25", "r_cut = 5.5"), "truncation.r_cut", "does not fit"),
        (with("r_cut = 3.25", "r_kut = 3.25"), "truncation.r_kut", "is not a known key"),
        (with("threads = 3", "threads = 0"), "threads", "is not allowed"),
        (with("lennard-lock/1", "lennard-lock/9"), "schema", "is not one"),
    ];
    for (error, key, message) in cases {
        assert_eq!(error.key_path(), Some(key), "{error}");
        assert!(error.message().contains(message), "{error}");
        assert!(error.file() == "hand.lock.toml" && error.line().is_some(), "{error}");
    }
    let no_lock = Lock::parse(ASKING, "x.toml").unwrap_err();
    assert!(no_lock.message().contains("no lock file"), "{no_lock}");
    // Dropping a setting brings its default, dropping the step nothing.
    let missing = with("dt = 0.0052\n", "");
    assert_eq!((missing.key_path(), missing.message()), (Some("integrator.dt"), "is missing"));
}

#[test]
fn a_scene_that_leaves_nothing_open_has_no_use_for_a_lock() {
    let lock = lock_of(&parse(ASKING, &[]));
    let plain = ASKING.replace("accuracy = { potential_energy = 1e-3, drift = 1e-5 }\n", "");
    let error = lock.settle(&parse(&plain, &[])).unwrap_err();
    assert_eq!(error.key_path(), Some("accuracy"));
    assert!(error.to_string().contains("no [accuracy]"), "{error}");
}

#[test]
fn a_lock_file_that_cannot_serve_says_what_would() {
    let message = |error: lennard_scene::SceneError| error.to_string();
    let missing = message(Lock::load(std::path::Path::new("no/such.lock.toml")).unwrap_err());
    assert!(missing.contains("the lock file cannot be read"), "{missing}");
    let other = message(Lock::parse("name = 1\n", "x.lock.toml").unwrap_err());
    assert!(other.contains("this is no lock file"), "{other}");
    assert!(other.contains(", as `lennard tune` writes it"), "{other}");

    let lock = lock_of(&parse(ASKING, &[]));
    let all: Vec<(&str, &str)> = vec![
        ("truncation.kind", "\"cut\""),
        ("truncation.r_cut", "3.0"),
        ("truncation.tail_correction", "true"),
        ("integrator.dt", "0.004"),
        ("kernel.precision", "\"double\""),
        ("neighbor.mode", "\"verlet\""),
        ("neighbor.skin", "0.3"),
    ];
    let full = message(lock.settle(&parse(ASKING, &all)).unwrap_err());
    assert!(full.contains("every setting written in asking.toml"), "{full}");
    assert!(full.contains("a scene with [accuracy] and settings left out"), "{full}");
}
