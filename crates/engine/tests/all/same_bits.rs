//! A run in parts and on other numbers of threads leaves the bytes of one run, for everything that a scene can name.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use lennard_engine::{Control, Ending, EngineError, ResumeOptions, go_on, prepare, resume, run};
use lennard_io::{Existing, create_named_folder};
use lennard_scene::Scene;

use crate::common::{self, AskToStop, DUMBBELLS, MTK, TRIANGLE};

/// A small liquid; short, since there are many of it.
const LIQUID: &str = r#"
    system = { n_atoms = 108, density = 0.8442, temperature = 1.2, seed = 11 }
    truncation = { kind = "switch", r_cut = 2.2 }
    neighbor = { mode = "verlet" }
    integrator = { dt = 0.002 }
    stage = [
        { name = "melt", steps = 60, thermostat = "bussi" },
        { name = "production", steps = 140 },
    ]
    output = { thermo_every = 9, trajectory_every = 20 }
"#;

/// Observables of all kinds of memory.
const ALL_OBSERVABLES: &str = r#"[{kind="rdf", every=10}, {kind="msd", every=5}, {kind="vacf", every=5}, {kind="pressure-tensor", every=2}]"#;

/// Steps at which runs in parts stop: in both stages, at the end of one, and beside every interval.
const STOPS: [u64; 4] = [37, 60, 61, 133];

/// Runs the scene of a folder until a step (0: to its end), anew or from its checkpoint.
fn until(
    folder: &Path,
    step: u64,
    threads: usize,
    scene: Option<Scene>,
    options: &ResumeOptions,
) -> Result<Ending, EngineError> {
    common::on_threads(threads, || {
        let stop = AtomicBool::new(false);
        let progress = &mut AskToStop(step, &stop);
        let simulation = scene.map(prepare).transpose()?;
        let folder = &create_named_folder(folder, Existing::Keep).unwrap();
        let control = Control { stop: &stop, deadline: None, progress };
        let outcome = match simulation {
            Some(mut simulation) => run(&mut simulation, folder, control)?,
            None => go_on(&mut resume(folder.path(), options)?, folder, control)?,
        };
        Ok(outcome.ending)
    })
}

fn goes_on(folder: &Path, step: u64, threads: usize, options: &ResumeOptions) -> Ending {
    until(folder, step, threads, None, options).unwrap_or_else(|e| panic!("{e}"))
}

/// All files but the checkpoints before the last, which are where a run stopped.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = common::contents(folder);
    let checkpoints: Vec<_> = files.keys().filter(|n| n.ends_with(".lennard")).cloned().collect();
    let (_, before) = checkpoints.split_last().expect("a checkpoint of the end");
    before.iter().for_each(|name| drop(files.remove(name)));
    files
}

/// One run on one thread, against a run in five parts on two and three threads. An error where the scene does not run.
fn same(base: &str, overrides: &str) -> Result<(), String> {
    let root = common::folder();
    let [whole, parts] = ["whole", "parts"].map(|name| root.path().join(name));
    let never = &ResumeOptions::default();
    let scene = common::parse(base, overrides).map_err(|e| e.to_string())?;
    until(&whole, 0, 1, Some(scene.clone()), never).map_err(|e| e.to_string())?;
    let stops: Vec<u64> = STOPS.into_iter().filter(|at| *at < scene.total_steps()).collect();
    let begun = until(&parts, stops[0], 3, Some(scene), never);
    assert_eq!(begun.unwrap_or_else(|e| panic!("{e}")), Ending::Stopped);
    for (at, threads) in stops[1..].iter().zip([2, 3, 3]) {
        assert_eq!(goes_on(&parts, *at, threads, never), Ending::Stopped);
        assert!(!parts.join("final.xyz").exists(), "nothing looks finished");
    }
    // Going on with a finished run changes nothing.
    for what in ["in parts", "once more"] {
        assert_eq!(goes_on(&parts, 0, 3, never), Ending::Finished);
        common::same_files(&results(&whole), &results(&parts), &format!("{overrides:?} {what}"));
    }
    Ok(())
}

/// As [`same`], for the liquid.
fn liquid(overrides: &str) -> Result<(), String> {
    same(LIQUID, overrides)
}

#[test]
fn every_integrator_with_every_bath() {
    for entry in lennard_integrators::integrators() {
        let name = entry.spec.name;
        // Small enough for explicit Euler, whose energy grows at any step.
        let method = format!(
            "integrator.kind={name} integrator.dt=0.0005
            observable={ALL_OBSERVABLES}"
        );
        // These two move the oscillator or contacts alone: a scene that names one is refused.
        let moves_fluids = !["analytic", "spook"].contains(&name);
        assert_eq!(liquid(&method).is_ok(), moves_fluids, "{name}");
        for bath in lennard_integrators::thermostats() {
            let ran = liquid(&format!("{method} stage.production.thermostat={}", bath.name));
            assert_eq!(ran.is_ok(), moves_fluids, "{name}, {}: {ran:?}", bath.name);
        }
    }
}

#[test]
fn every_barostat_with_every_bath_and_ramps() {
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
                let held = |stage: &str| {
                    format!("{stage}.thermostat={} {stage}.barostat={barostat}", bath.name)
                };
                let (melt, production) = (held("stage.melt"), held("stage.production"));
                let ramp = "stage.melt.temperature={ from = 2.0, to = 1.2 }";
                let seen =
                    r#"observable=[{kind="rdf", every=10}, {kind="pressure-tensor", every=2}]"#;
                assert_eq!(liquid(&format!("{melt} {production} {ramp} {seen}")), Ok(()));
            }
        }
        assert!(ran > 0, "{} ran with no bath", spec.name);
    }
    let ramp = r#"stage.production.thermostat=bussi
        stage.production.temperature={ from = 1.2, to = 1.5 }
        stage.production.barostat={ kind = "stochastic-cell-rescaling", pressure = { from = 2.0, to = 5.0 },
            tau = 0.2, interval = 5, coupling = "z" }"#;
    for method in ["leapfrog", "stormer-verlet", "pefrl"] {
        assert_eq!(liquid(&format!("integrator.kind={method} {ramp}")), Ok(()));
    }
}

#[test]
fn every_observable_list_state_and_precision() {
    for overrides in [
        &*format!("observable={ALL_OBSERVABLES}"),
        "neighbor.mode=direct",
        "kernel.precision=mixed",
        "kernel.isa=portable",
        "start.kind=random",
        "output.velocities=true output.forces=true output.unwrapped=true",
        // A list that is rebuilt often, and measured stages that begin at once.
        "neighbor.skin=0.05 stage.melt.measure=false stage.melt.steps=1",
    ] {
        assert_eq!(liquid(overrides), Ok(()));
    }
    let refused = lennard_observables::observables().iter().filter(|observable| {
        let one = format!("[{{kind=\"{}\"}}]", observable.name);
        liquid(&format!("observable={one}")).is_err()
    });
    let refused: Vec<&str> = refused.map(|observable| observable.name).collect();
    // They are for walls, molecules, a bath and two species.
    let of_others =
        ["wall-pressure", "molecules", "orientation", "chemical-potential", "mutual-diffusion"];
    assert_eq!(refused, of_others);
}

#[test]
fn trial_particles_at_constant_temperature_and_pressure_and_in_mixtures() {
    let trials = r#"observable=[{kind="chemical-potential", insertions=50}]"#;
    let bath = "stage.production.thermostat=nose-hoover";
    for more in [
        "",
        r#"stage.production.barostat={ kind = "mtk", pressure = 4.0, tau = 0.5 }"#,
        r#"species=[{ name = "A", fraction = 0.7 }, { name = "B", fraction = 0.3 }]
            mixing={ rule = "lorentz-berthelot" }"#,
    ] {
        assert_eq!(liquid(&format!("{trials} {bath} {more}")), Ok(()));
    }
    assert!(liquid(trials).is_err(), "at constant energy it is refused");
}

#[test]
fn trajectories_of_every_format() {
    for format in lennard_io::TrajectoryFormat::ALL {
        let name = format!("output.format={}", format.name());
        assert_eq!(liquid(&name), Ok(()));
        if format.spec().holds_ase {
            assert_eq!(liquid(&format!("{name} output.ase=true")), Ok(()));
        }
    }
}

#[test]
fn every_exchange() {
    for spec in lennard_integrators::exchanges() {
        let exchange = format!("{{ kind = {:?}, every = 7, slabs = 12, axis = \"y\" }}", spec.name);
        assert_eq!(
            liquid(&format!("stage.production.exchange={exchange} observable={ALL_OBSERVABLES}")),
            Ok(())
        );
    }
}

#[test]
fn mixtures_by_every_rule_with_steps_of_two_lengths_and_in_a_changing_box() {
    let species = r#"[{ name = "A", fraction = 0.7 }, { name = "B", fraction = 0.3, sigma = 0.9, mass = 4.0 }]"#;
    let pair = r#"[{ a = "B", b = "A", sigma = 0.97, epsilon = 1.1 }]"#;
    let followed = r#"[{ kind = "msd", every = 5 }, { kind = "vacf", every = 5, window = 0.1 }, { kind = "structure-factor", every = 50 },
        { kind = "kirkwood-buff", every = 50 }, { kind = "mutual-diffusion", every = 1, window = 0.1 }]"#;
    let respa =
        r#"{ kind = "respa", dt = 0.006, inner_steps = 3, r_split = 1.6, split_width = 0.3 }"#;
    let barostat = r#"{ kind = "stochastic-cell-rescaling", pressure = 2.0 }"#;
    let changing = format!(
        "system.n_atoms=256 observable={followed} stage.production.thermostat=bussi
            stage.production.barostat={barostat}"
    );
    let rows = ["", &format!("integrator={respa}"), &changing];
    for rule in lennard_forcefield::combining_rules() {
        let mixing = format!("{{ rule = {:?} }}", rule.name);
        let mixture =
            format!("species={species} mixing={mixing} pair={pair} truncation.r_cut_in=pair");
        for row in rows {
            assert_eq!(liquid(&format!("{mixture} {row}")), Ok(()), "{mixing} {row}");
        }
    }
}

#[test]
fn many_particles() {
    let many = "system.n_atoms=6912 stage.melt.steps=50 stage.production.steps=20";
    for precision in ["double", "mixed"] {
        assert_eq!(liquid(&format!("{many} kernel.precision={precision}")), Ok(()));
    }
}

/// Responses of walls beside the one that is the default.
const RESPONSES: [&str; 3] = [
    r#"[{kind="hard", response="mirror", restitution=0.9}]"#,
    r#"[{kind="hard", response="project"}]"#,
    r#"[{kind="soft", restitution=0.5}]"#,
];

#[test]
fn every_wall() {
    let more = r#"observable=[{kind="wall-pressure"}, {kind="density-profile"}]
        field.acceleration=[0.0, 0.0, -0.1]"#;
    let between = |wall: &str, bath: &str| {
        let scene = format!("wall={wall} stage.production.thermostat={bath} {more}");
        assert_eq!(liquid(&scene), Ok(()), "{wall} {bath}");
    };
    for wall in lennard_forcefield::walls() {
        let one = format!("[{{kind={:?}}}]", wall.name);
        ["bussi", "langevin"].iter().for_each(|bath| between(&one, bath));
    }
    RESPONSES.iter().for_each(|wall| between(wall, "bussi"));
}

/// Contacts of every kind, as overrides of the liquid.
const CONTACTS: [(&str, &str); 6] = [
    ("soft", "contact.stiffness=200.0"),
    ("soft", "contact.law=hertz contact.restitution=0.8"),
    ("hard", "contact.restitution=0.9"),
    ("hard", r#"wall=[{kind="thermal"}]"#),
    ("spook", "integrator.kind=spook"),
    (
        "spook",
        r#"integrator.kind=spook contact.restitution=0.6 contact.sweeps=20
            wall=[{kind="hard", response="contact"}]"#,
    ),
];

#[test]
fn every_contact_between_walls_too() {
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
            let scene = format!(
                "system.n_atoms=500 contact.kind={kind} contact.diameter=0.9 {more}
                    stage.production.thermostat={bath}"
            );
            assert_eq!(liquid(&scene), Ok(()), "{kind} {more}");
        }
    }
    // Bodies without a pair potential, some of them held.
    let bodies =
        r#"potential={ kind = "none" } truncation={} contact.kind=hard system.held=[1, 2, 30]"#;
    assert_eq!(liquid(bodies), Ok(()));
}

#[test]
fn slabs_with_their_tail_as_a_force_and_half_crystals() {
    let planar = "truncation.kind=cut truncation.tail_correction=planar";
    let slab = r#"system={ n_atoms = 700, temperature = 0.8, seed = 7 } start.kind=slab
        truncation={ kind = "shift", r_cut = 2.5 } observable=[{ kind = "interface", every = 4 }]"#;
    for more in ["", planar, &format!("{planar} integrator.kind=respa")] {
        assert_eq!(liquid(&format!("{slab} {more}")), Ok(()), "{more}");
    }
    let crystal = r#"system={ n_atoms = 700, temperature = 1.0, seed = 7 } truncation={ r_cut = 2.5 }
        start={ kind = "half-crystal", cells = 4, layers = 6 } stage.production.thermostat=bussi
        observable=[{ kind = "bond-order", every = 4 }] stage.production.barostat={
            kind = "stochastic-cell-rescaling", pressure = 4.0, coupling = "z" }"#;
    assert_eq!(liquid(crystal), Ok(()));
}

/// A square ring with a tail, as overrides.
const RING_WITH_A_TAIL: &str = "molecule.kind=sites molecule.sites=5 molecule.bond_length=1.0
    molecule.bonds=[[1, 2], [2, 3], [3, 4], [1, 4], [5, 4]] system.density=0.04
    molecule.shape=[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [-0.6, 1.8, 0]]
    integrator.kind=velocity-verlet";

/// Springs with dashpots.
const DAMPED: &str = "bonds.method=spring bonds.damping=3.0";

/// Chains.
const CHAIN: &str = "molecule.kind=chain molecule.sites=4 molecule.bond_length=1.0
    system.density=0.1";

/// Dumbbells between walls have observables of their own.
const BETWEEN: &str = "truncation.tail_correction=false observable=[]";

/// Ways to hold bonds, and molecules of each kind, as overrides.
fn ways() -> Vec<String> {
    let deterministic = format!("stage.0.thermostat=nose-hoover stage.0.barostat={MTK}");
    let rescaled = r#"stage.0.thermostat=bussi
        stage.0.barostat={ kind = "stochastic-cell-rescaling",
        pressure = 1.0, tau = 0.5, interval = 5 }"#;
    let mut all = vec![
        format!("{DAMPED}"),
        format!("{DAMPED} bonds.scheme=midpoint integrator.kind=leapfrog"),
        format!("{DAMPED} bonds.scheme=linearly-implicit"),
        format!("{DAMPED} integrator.kind=respa"),
        format!("{DAMPED} wall=[{{ kind = \"hard\", restitution = 0.9 }}] observable=[]"),
        format!("{DAMPED} {deterministic}"),
        format!("{deterministic}"),
        format!("{deterministic} bonds.method=spring bonds.scheme=midpoint"),
        format!("contact.diameter=0.8 contact.stiffness=500.0 system.held=[1, 40] {BETWEEN}"),
        format!(
            r#"bonds.method=spook integrator.kind=spook contact.kind=spook contact.diameter=0.8
                wall=[{{ kind = "hard", response = "contact", restitution = 0.5 }}] {BETWEEN}"#
        ),
        format!("{CHAIN}"),
        format!("{CHAIN} molecule.sites=3 bonds.method=relaxation"),
        format!("{CHAIN} bonds.max_group=2"),
        format!("{TRIANGLE}"),
        format!("{RING_WITH_A_TAIL} bonds.method=direct"),
        format!("{RING_WITH_A_TAIL} bonds.method=relaxation"),
        format!("{RING_WITH_A_TAIL} bonds.method=spring"),
        format!("{RING_WITH_A_TAIL} bonds.method=spook integrator.kind=spook"),
    ];
    let plain = [
        "bonds.method=direct",
        "bonds.method=relaxation",
        "bonds.method=relaxation bonds.direction=new",
        "bonds.method=relaxation bonds.sweeps=3",
        "bonds.method=spring",
        "bonds.method=spring bonds.scheme=midpoint",
        "bonds.method=spring bonds.scheme=linearly-implicit",
        "bonds.method=spook integrator.kind=spook",
        "bonds.method=direct kernel.precision=mixed",
        "bonds.method=direct integrator.kind=leapfrog",
        "bonds.method=relaxation integrator.kind=stormer-verlet",
        "bonds.method=spring bonds.scheme=midpoint integrator.kind=leapfrog",
        "bonds.method=direct integrator.kind=respa",
        "bonds.method=spring bonds.scheme=midpoint integrator.kind=respa",
        r#"wall=[{ kind = "soft", restitution = 0.5 }] observable=[]"#,
        r#"observable=[{ kind = "orientation", every = 4, window = 0.1, origins = 3 }]"#,
        r#"wall=[{ kind = "wca" }] observable=[]"#,
        r#"bonds.method=spring wall=[{ kind = "hard" }] observable=[]"#,
        r#"wall=[{ kind = "hard", restitution = 0.9 }] observable=[]"#,
        r#"wall=[{ kind = "thermal" }] observable=[]"#,
        r#"bonds.method=spring bonds.scheme=midpoint wall=[{ kind = "hard" }] observable=[]"#,
        rescaled,
    ];
    all.extend(plain.map(str::to_owned));
    all
}

#[test]
fn molecules_whatever_holds_their_bonds() {
    // Several tasks of molecules.
    let size = "system.n_molecules=500 stage.0.steps=45";
    for way in ways() {
        let by_spook = way.contains("bonds.method=spook");
        for bath in ["bussi", "langevin"] {
            if by_spook && bath == "langevin" {
                continue;
            }
            let scene = format!("{size} stage.0.thermostat={bath} {way}");
            assert_eq!(same(DUMBBELLS, &scene), Ok(()));
        }
    }
}

/// Begins the liquid in a new folder below a root and runs it until a step.
fn begun(root: &Path, name: &str, step: u64, overrides: &str) -> PathBuf {
    let folder = root.join(name);
    let scene = common::scene(LIQUID, overrides);
    let ending = until(&folder, step, 1, Some(scene), &ResumeOptions::default());
    let expected = if step == 0 { Ending::Finished } else { Ending::Stopped };
    assert_eq!(ending.unwrap_or_else(|e| panic!("{e}")), expected);
    folder
}

#[test]
fn checkpoints_on_the_way_change_no_bit() {
    let root = tempfile::tempdir().unwrap();
    let files = ["0", "1", "7"].map(|every| {
        let folder = begun(root.path(), every, 0, &format!("checkpoint.every_steps={every}"));
        let mut files = results(&folder);
        files.retain(|name, _| {
            !(name.ends_with(".lennard") || name == "scene.toml" || name == "run.json")
        });
        files
    });
    assert!(files.windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn a_run_made_longer_is_the_longer_run() {
    let root = tempfile::tempdir().unwrap();
    let more = format!("observable={ALL_OBSERVABLES}");
    let longer = format!("{more} stage.production.steps=340");
    let whole = begun(root.path(), "whole", 0, &longer);
    let parts = begun(root.path(), "parts", 0, &more);
    let options = ResumeOptions { more_steps: 200, ..ResumeOptions::default() };
    // Stopped on the way: the longer scene is in the checkpoint by then.
    assert_eq!(goes_on(&parts, 250, 1, &options), Ending::Stopped);
    assert_eq!(goes_on(&parts, 0, 1, &ResumeOptions::default()), Ending::Finished);
    common::same_files(
        &results(&whole),
        &results(&parts),
        "140 + 200 production steps against 340",
    );
}

#[test]
fn a_run_goes_on_without_its_start_configuration() {
    let root = tempfile::tempdir().unwrap();
    let start = begun(root.path(), "first", 0, "").join("final.xyz");
    let start_file = format!("start={{ kind = \"file\", file = {start:?} }}");
    let overrides = format!("system={{ temperature = 1.2 }} {start_file}");
    let second = begun(root.path(), "second", 50, &overrides);
    fs::remove_file(&start).unwrap();
    assert_eq!(goes_on(&second, 0, 1, &ResumeOptions::default()), Ending::Finished);
}
