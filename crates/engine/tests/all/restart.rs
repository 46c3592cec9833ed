//! A run in two goes leaves the same bytes as a run in one, for everything that a scene can name.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use lennard_engine::{
    Ending, Outcome, ResumeOptions, RunOptions, Simulation, go_on, prepare, resume, run,
};
use lennard_io::{Existing, create_named_folder};

use crate::common::{self, AskToStop};

/// A small liquid; short, since there are many of it.
const LIQUID: &str = r#"
    [system]
    n_atoms = 108
    density = 0.8442
    temperature = 1.2
    seed = 11
    [truncation]
    kind = "switch"
    r_cut = 2.2
    [neighbor]
    mode = "verlet"
    [integrator]
    dt = 0.002
    [[stage]]
    name = "melt"
    steps = 60
    thermostat = "bussi"
    [[stage]]
    name = "production"
    steps = 140
    [output]
    thermo_every = 9
    trajectory_every = 20
"#;

const ALL_OBSERVABLES: &str = r#"[{kind="rdf", every=10}, {kind="msd", every=5}, {kind="vacf", every=5}, {kind="pressure-tensor", every=2}]"#;

fn scene(overrides: &[(&str, &str)]) -> Option<Simulation> {
    let scene = common::parse(LIQUID, overrides).ok()?;
    prepare(scene).ok()
}

/// Runs, or goes on, until a step.
fn until(
    folder: &Path,
    step: u64,
    simulation: Option<&mut Simulation>,
    options: &ResumeOptions,
) -> Outcome {
    let stop = AtomicBool::new(false);
    let progress = &mut AskToStop(step, &stop);
    let held = &create_named_folder(folder, Existing::Keep).unwrap();
    let run_options =
        RunOptions { folder: held, threads: 1, stop: &stop, deadline: None, progress };
    match simulation {
        Some(simulation) => run(simulation, run_options),
        None => go_on(&mut resume(folder, options).unwrap_or_else(|e| panic!("{e}")), run_options),
    }
    .unwrap_or_else(|e| panic!("{e}"))
}

/// All files, run.json without what depends on the clock; checkpoints by their names alone.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    common::contents(folder, |_| Vec::new())
}

fn same(whole: &Path, parts: &Path, what: &str) {
    let (mut whole, mut parts) = (contents(whole), contents(parts));
    // The last checkpoint must be there; the one before it is where the run was stopped, or nowhere.
    let checkpoints = |files: &mut BTreeMap<String, Vec<u8>>| {
        let names: Vec<String> =
            files.keys().filter(|n| n.ends_with(".lennard")).cloned().collect();
        names.iter().for_each(|n| drop(files.remove(n)));
        names.last().cloned()
    };
    assert_eq!(checkpoints(&mut whole), checkpoints(&mut parts), "{what}");
    let names = |files: &BTreeMap<String, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&whole), names(&parts), "{what}");
    for (name, bytes) in &whole {
        assert!(*bytes == parts[name], "{what}: {name} differs");
    }
}

/// Stops in both stages, at a stage's end, and beside every interval; wants the bytes of one go.
fn in_parts(overrides: &[(&str, &str)]) -> bool {
    let root = tempfile::tempdir().unwrap();
    let (whole, parts) = (root.path().join("whole"), root.path().join("parts"));
    let Some(mut first) = scene(overrides) else {
        return false;
    };
    for folder in [&whole, &parts] {
        fs::create_dir(folder).unwrap();
    }
    let never = ResumeOptions::default();
    let stop = AtomicBool::new(false);
    let held = create_named_folder(&whole, Existing::Keep).unwrap();
    let options =
        RunOptions { folder: &held, threads: 1, stop: &stop, deadline: None, progress: &mut () };
    let ran = run(&mut first, options);
    drop(held);
    if ran.is_err() {
        // Some methods cannot run a fluid at all, which other tests are about.
        return false;
    }
    let mut again = scene(overrides).unwrap();
    assert_eq!(until(&parts, 37, Some(&mut again), &never).ending, Ending::Stopped);
    for step in [60, 61, 133] {
        assert_eq!(until(&parts, step, None, &never).ending, Ending::Stopped);
        assert!(!parts.join("final.xyz").exists(), "nothing looks finished");
    }
    assert_eq!(until(&parts, 0, None, &never).ending, Ending::Finished);
    same(&whole, &parts, &format!("{overrides:?}"));
    // Going on with a finished run changes nothing.
    assert_eq!(until(&parts, 0, None, &never).ending, Ending::Finished);
    same(&whole, &parts, &format!("{overrides:?} once more"));
    true
}

#[test]
fn every_integrator_with_every_bath_goes_on_to_the_bit() {
    let mut ran = Vec::new();
    for entry in lennard_integrators::integrators() {
        let name = entry.spec.name;
        let method = ("integrator.kind", name);
        if in_parts(&[method]) {
            ran.push(name);
        }
        for bath in lennard_integrators::thermostats() {
            in_parts(&[method, ("stage.production.thermostat", bath.name)]);
        }
    }
    for wanted in
        ["velocity-verlet", "stormer-verlet", "leapfrog", "respa", "pefrl", "bit-reversible-verlet"]
    {
        assert!(ran.contains(&wanted), "{wanted} did not run: {ran:?}");
    }
}

#[test]
fn every_barostat_with_every_bath_and_ramps_go_on_to_the_bit() {
    for spec in lennard_integrators::barostats() {
        let barostat =
            format!("{{ kind = \"{}\", pressure = 3.0, tau = 0.2, interval = 5 }}", spec.name);
        let barostat = if spec.thermostat.is_some() {
            barostat.replace(", interval = 5", "")
        } else {
            barostat
        };
        let suits = |name: &str| spec.thermostat.is_none_or(|wanted| wanted == name);
        let mut ran = 0;
        for bath in lennard_integrators::thermostats() {
            if bath.canonical && suits(bath.name) {
                ran += 1;
                assert!(in_parts(&[
                    ("stage.melt.thermostat", bath.name),
                    ("stage.melt.barostat", &barostat),
                    ("stage.melt.temperature", "{ from = 2.0, to = 1.2 }"),
                    ("stage.production.thermostat", bath.name),
                    ("stage.production.barostat", &barostat),
                    (
                        "observable",
                        r#"[{kind="rdf", every=10}, {kind="pressure-tensor", every=2}]"#
                    ),
                ]));
            }
        }
        assert!(ran > 0, "{} ran with no bath", spec.name);
    }
    let ramp = "{ kind = \"stochastic-cell-rescaling\", pressure = { from = 2.0, to = 5.0 }, tau = 0.2, interval = 5, coupling = \"z\" }";
    for method in ["leapfrog", "stormer-verlet", "pefrl"] {
        assert!(in_parts(&[
            ("integrator.kind", method),
            ("stage.production.thermostat", "bussi"),
            ("stage.production.temperature", "{ from = 1.2, to = 1.5 }"),
            ("stage.production.barostat", ramp),
        ]));
    }
}

#[test]
fn every_observable_list_state_and_precision_goes_on_to_the_bit() {
    assert!(in_parts(&[("observable", ALL_OBSERVABLES)]));
    assert!(in_parts(&[("neighbor.mode", "direct")]));
    assert!(in_parts(&[("kernel.precision", "mixed")]));
    assert!(in_parts(&[("kernel.isa", "portable")]));
    assert!(in_parts(&[("system.lattice", "random")]));
    assert!(in_parts(&[
        ("output.velocities", "true"),
        ("output.forces", "true"),
        ("output.unwrapped", "true")
    ]));
    // A list that is rebuilt often, and measured stages that begin at once.
    assert!(in_parts(&[
        ("neighbor.skin", "0.05"),
        ("stage.melt.measure", "false"),
        ("stage.melt.steps", "1")
    ]));
    for observable in lennard_observables::observables() {
        let one = format!("[{{kind=\"{}\"}}]", observable.name);
        in_parts(&[("observable", &one)]);
    }
}

#[test]
fn trial_particles_go_on_to_the_bit_at_constant_temperature_and_pressure_and_in_mixtures() {
    let trials = ("observable", r#"[{kind="chemical-potential", insertions=50}]"#);
    let bath = ("stage.production.thermostat", "nose-hoover");
    let barostat = r#"{ kind = "mtk", pressure = 4.0, tau = 0.5 }"#;
    let species = r#"[{ name = "A", fraction = 0.7 }, { name = "B", fraction = 0.3 }]"#;
    let mixing = r#"{ rule = "lorentz-berthelot" }"#;
    assert!(in_parts(&[trials, bath]));
    assert!(in_parts(&[trials, bath, ("stage.production.barostat", barostat)]));
    assert!(in_parts(&[trials, bath, ("species", species), ("mixing", mixing)]));
    assert!(!in_parts(&[trials]), "at constant energy it is refused");
}

#[test]
fn trajectories_of_every_format_go_on_to_the_byte() {
    for format in lennard_io::TrajectoryFormat::ALL {
        let name = ("output.format", format.name());
        assert!(in_parts(&[name]), "{name:?}");
        if format.spec().holds_ase {
            assert!(in_parts(&[name, ("output.ase", "true")]), "{name:?}");
        }
    }
}

#[test]
fn exchanges_go_on_to_the_bit() {
    for spec in lennard_integrators::exchanges() {
        let exchange = format!("{{ kind = {:?}, every = 7, slabs = 12, axis = \"y\" }}", spec.name);
        assert!(in_parts(&[
            ("stage.production.exchange", &exchange),
            ("observable", ALL_OBSERVABLES),
        ]));
    }
}

#[test]
fn mixtures_go_on_to_the_bit() {
    let species = r#"[{ name = "A", fraction = 0.7 }, { name = "B", fraction = 0.3, sigma = 0.9, mass = 2.0 }]"#;
    for rule in lennard_forcefield::combining_rules() {
        let mixing = format!("{{ rule = {:?} }}", rule.name);
        let pair = r#"[{ a = "B", b = "A", sigma = 0.97, epsilon = 1.1 }]"#;
        assert!(in_parts(&[
            ("species", species),
            ("mixing", &mixing),
            ("pair", pair),
            ("truncation.r_cut_in", "pair"),
        ]));
    }
}

#[test]
fn every_wall_goes_on_to_the_bit() {
    let more = [
        ("observable", r#"[{kind="wall-pressure"}, {kind="density-profile"}]"#),
        ("field.acceleration", "[0.0, 0.0, -0.1]"),
    ];
    for wall in lennard_forcefield::walls() {
        let one = format!("[{{kind=\"{}\"}}]", wall.name);
        for bath in ["bussi", "langevin"] {
            let scene = [("wall", &one[..]), ("stage.production.thermostat", bath)];
            assert!(in_parts(&[&scene[..], &more].concat()), "{}", wall.name);
        }
    }
    for other in [
        r#"[{kind="hard", response="mirror", restitution=0.9}]"#,
        r#"[{kind="hard", response="project"}]"#,
        r#"[{kind="soft", restitution=0.5}]"#,
    ] {
        let scene = [("wall", other), ("stage.production.thermostat", "bussi")];
        assert!(in_parts(&[&scene[..], &more].concat()), "{other}");
    }
}

/// Contacts of every kind, as overrides of the liquid.
const CONTACTS: [(&str, &[(&str, &str)]); 6] = [
    ("soft", &[("contact.stiffness", "200.0")]),
    ("soft", &[("contact.law", "hertz"), ("contact.restitution", "0.8")]),
    ("hard", &[("contact.restitution", "0.9")]),
    ("hard", &[("wall", "[{kind=\"thermal\"}]")]),
    ("spook", &[("integrator.kind", "spook")]),
    (
        "spook",
        &[
            ("integrator.kind", "spook"),
            ("contact.restitution", "0.6"),
            ("contact.sweeps", "20"),
            ("wall", "[{kind=\"hard\", response=\"contact\"}]"),
        ],
    ),
];

#[test]
fn every_contact_goes_on_to_the_bit_between_walls_too() {
    for spec in lennard_integrators::contacts() {
        assert!(CONTACTS.iter().any(|(kind, _)| *kind == spec.name));
    }
    for (kind, more) in CONTACTS {
        // The bath of Langevin takes the place of the method that solves for contacts.
        let baths = match kind {
            "spook" => &["bussi"][..],
            _ => &["bussi", "langevin"],
        };
        for bath in baths {
            let scene = [
                ("contact.kind", kind),
                ("contact.diameter", "0.9"),
                ("stage.production.thermostat", bath),
            ];
            assert!(in_parts(&[&scene[..], more].concat()), "{kind} {more:?}");
        }
    }
    // Bodies without a pair potential, some of them held.
    assert!(in_parts(&[
        ("potential", "{ kind = \"none\" }"),
        ("truncation", "{}"),
        ("contact.kind", "hard"),
        ("system.held", "[1, 2, 30]"),
    ]));
}

#[test]
fn contacts_have_the_same_bits_on_any_number_of_threads() {
    for (kind, more) in CONTACTS {
        let run = |threads| {
            common::on_threads(threads, || {
                let scene = [
                    ("contact.kind", kind),
                    ("contact.diameter", "0.9"),
                    ("system.n_atoms", "500"),
                ];
                let mut simulation = scene_of(&[&scene[..], more].concat());
                simulation.run(&mut lennard_engine::Unfollowed).unwrap();
                common::bits(&simulation)
            })
        };
        let one = run(1);
        for threads in [2, 3, 8] {
            assert!(run(threads) == one, "{kind} {more:?} on {threads} threads");
        }
    }
}

fn scene_of(overrides: &[(&str, &str)]) -> Simulation {
    scene(overrides).unwrap_or_else(|| panic!("{overrides:?}"))
}

#[test]
fn checkpoints_on_the_way_change_no_bit() {
    let root = tempfile::tempdir().unwrap();
    let mut folders = Vec::new();
    for every in ["0", "1", "7"] {
        let folder = root.path().join(every);
        fs::create_dir(&folder).unwrap();
        let mut simulation = scene(&[("checkpoint.every_steps", every)]).unwrap();
        until(&folder, 0, Some(&mut simulation), &ResumeOptions::default());
        let mut files = contents(&folder);
        files.retain(|name, _| {
            !name.ends_with(".lennard") && name != "scene.toml" && name != "run.json"
        });
        folders.push(files);
    }
    assert!(folders.windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn a_run_made_longer_is_the_longer_run() {
    let root = tempfile::tempdir().unwrap();
    let (whole, parts) = (root.path().join("whole"), root.path().join("parts"));
    for folder in [&whole, &parts] {
        fs::create_dir(folder).unwrap();
    }
    let more = [("observable", ALL_OBSERVABLES)];
    let longer = [more[0], ("stage.production.steps", "340")];
    until(&whole, 0, scene(&longer).as_mut(), &ResumeOptions::default());
    until(&parts, 0, scene(&more).as_mut(), &ResumeOptions::default());
    let options = ResumeOptions { more_steps: 200, ..ResumeOptions::default() };
    // Stopped on the way: the longer scene is in the checkpoint by then.
    assert_eq!(until(&parts, 250, None, &options).ending, Ending::Stopped);
    assert_eq!(until(&parts, 0, None, &ResumeOptions::default()).ending, Ending::Finished);
    same(&whole, &parts, "140 + 200 production steps against 340");
}

#[test]
fn a_run_goes_on_without_its_start_configuration() {
    let root = tempfile::tempdir().unwrap();
    let (first, second) = (root.path().join("first"), root.path().join("second"));
    for folder in [&first, &second] {
        fs::create_dir(folder).unwrap();
    }
    until(&first, 0, scene(&[]).as_mut(), &ResumeOptions::default());
    let start = root.path().join("start.xyz");
    fs::rename(first.join("final.xyz"), &start).unwrap();
    let text = LIQUID
        .replace("n_atoms = 108", &format!("configuration = \"{}\"", start.display()))
        .replace("density = 0.8442", "");
    let mut simulation = common::prepared(common::scene(&text, &[]));
    assert_eq!(
        until(&second, 50, Some(&mut simulation), &ResumeOptions::default()).ending,
        Ending::Stopped
    );
    fs::remove_file(&start).unwrap();
    assert_eq!(until(&second, 0, None, &ResumeOptions::default()).ending, Ending::Finished);
}
