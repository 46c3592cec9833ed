//! What runs write: whole molecules, formats at their limits, and outputs that change where a run goes on.

use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use lennard_core::{DVec3, PeriodicBox};
use lennard_engine::{
    Control, Ending, EngineError, Outcome, ResumeOptions, Simulation, go_on, resume, run,
};
use lennard_io::{Existing, FileUnits, Frames, create_named_folder, read_configuration};

use crate::common::{self, AskToStop, DUMBBELLS};

/// Runs, or goes on, until a step.
fn until(
    folder: &Path,
    step: u64,
    simulation: Option<&mut Simulation>,
    changes: &str,
) -> Result<Outcome, EngineError> {
    let stop = AtomicBool::new(false);
    let progress = &mut AskToStop(step, &stop);
    let held = &create_named_folder(folder, Existing::Keep).unwrap();
    let control = Control { stop: &stop, deadline: None, progress };
    let changed = ResumeOptions { output: common::pairs(changes), ..ResumeOptions::default() };
    match simulation {
        Some(simulation) => run(simulation, held, control),
        None => go_on(&mut resume(folder, &changed)?, held, control),
    }
}

fn prepared(text: &str, overrides: &str) -> Simulation {
    common::prepared(common::scene(text, overrides))
}

/// Bonds of dumbbells in frames as they stand there, without image flags: the longest, σ.
fn longest_bond(positions: &[DVec3]) -> f64 {
    let bonds = positions.chunks(2).map(|ends| ends[0].distance(ends[1]));
    bonds.fold(0.0, f64::max)
}

/// The positions of the last frame, as a reader takes them who knows no image flags.
fn without_flags(path: &Path) -> Vec<DVec3> {
    let text = fs::read_to_string(path).unwrap();
    let text = text.replace("map_shift", "other").replace(" ix iy iz", " a b c");
    lennard_io::read_configuration_bytes(text.as_bytes()).unwrap().positions
}

fn double(position: impl Into<[f32; 3]>) -> DVec3 {
    DVec3::from_array(position.into().map(f64::from))
}

const FRAMES: &str = "output.trajectory_every=400 stage.production.steps=800";

#[test]
fn no_frame_cuts_a_molecule_unless_the_scene_asks_for_it() {
    for (format, file) in [("xyz", "trajectory.xyz"), ("lammps-dump", "trajectory.lammpstrj")] {
        for whole in [true, false] {
            let root = tempfile::tempdir().unwrap();
            let folder = root.path();
            let keys = format!("{FRAMES} output.format={format} output.whole={whole}");
            let mut simulation = prepared(DUMBBELLS, &keys);
            until(folder, 0, Some(&mut simulation), "").unwrap();
            let cell = simulation.state.cell;
            let positions = without_flags(&folder.join(file));
            let longest = longest_bond(&positions);
            assert_eq!(longest < 0.7, whole, "{format}: {longest}");
            for ends in positions.chunks(2) {
                assert_eq!(cell.wrap(ends[0]), ends[0]);
            }
            // With image flags, and in the last state, nothing is lost.
            let last = &simulation.state.positions;
            for name in [file, "final.xyz"] {
                let read = read_configuration(&folder.join(name)).unwrap().positions;
                let apart = read.iter().zip(last).map(|(a, b)| a.distance(*b));
                assert!(apart.fold(0.0, f64::max) < 1e-13);
            }
        }
    }
}

#[test]
fn xtc_and_topology_have_whole_molecules_of_every_kind() {
    let ring = "molecule.kind=sites molecule.sites=4
        molecule.bonds=[[1, 2], [2, 3], [3, 4], [4, 1]]
        molecule.shape=[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]] molecule.bond_length=1.0
        system.density=0.05";
    let keys = format!("{ring} {FRAMES} output.format=xtc");
    let root = tempfile::tempdir().unwrap();
    let mut simulation = prepared(DUMBBELLS, &keys);
    until(root.path(), 0, Some(&mut simulation), "").unwrap();
    let mut reader = molly::XTCReader::open(root.path().join("trajectory.xtc")).unwrap();
    for frame in reader.read_all_frames().unwrap().iter() {
        let positions: Vec<DVec3> = frame.coords().map(double).collect();
        for sites in positions.chunks(4) {
            for k in 0..4 {
                let bond = sites[k].distance(sites[(k + 1) % 4]);
                assert!((bond - 1.0).abs() < 1e-3, "{bond}");
            }
        }
    }
    let topology = fs::read_to_string(root.path().join("topology.gro")).unwrap();
    let rows: Vec<&str> = topology.lines().skip(2).take(432).collect();
    let x = |row: &str| row[20..28].trim().parse::<f64>().unwrap();
    assert!(rows.chunks(4).all(|m| m.iter().all(|row| (x(row) - x(m[0])).abs() < 1.5)));
}

/// A hot gas whose particles leave the range of the precision at once.
const GAS: &str = r#"
    system = { n_atoms = 32, density = 0.001, temperature = 2.0, seed = 3 }
    truncation = { kind = "shift", r_cut = 2.5 }
    integrator = { dt = 0.01 }
    stage = [{ name = "production", steps = 4000 }]
    output = { trajectory_every = 1000, format = "xtc", unwrapped = true, precision = 500_000.0 }
"#;

#[test]
fn frames_that_reach_too_far_go_on_with_less_precision_and_a_remark() {
    let root = tempfile::tempdir().unwrap();
    let (whole, parts) = (root.path().join("whole"), root.path().join("parts"));
    let remark = "frames of trajectory.xtc with coordinates above 33.6 σ have the precision 50000 in place of 500000";
    let mut simulation = prepared(GAS, "");
    let foreseen = simulation.remarks.join("\n");
    assert!(foreseen.contains("unwrapped positions may reach 311 σ: frames"), "{foreseen}");
    let outcome = until(&whole, 0, Some(&mut simulation), "").unwrap();
    assert_eq!(outcome.ending, Ending::Finished);
    let found = outcome.record.remarks.iter().filter(|r| *r == remark);
    assert_eq!(found.count(), 1, "{:?}", outcome.record.remarks);
    let mut reader = molly::XTCReader::open(whole.join("trajectory.xtc")).unwrap();
    let frames = reader.read_all_frames().unwrap();
    assert_eq!(frames.len(), 4);
    let last = frames.iter().last().unwrap();
    assert_eq!(last.precision, 50_000.0);
    for (read, written) in last.coords().zip(&simulation.state.positions) {
        let apart = double(read) - *written;
        assert!(apart.abs().max_element() < 2e-5, "{apart}");
    }
    // In parts, the same bytes and the same remarks.
    until(&parts, 2500, Some(&mut prepared(GAS, "")), "").unwrap();
    let again = until(&parts, 0, None, "").unwrap();
    assert_eq!(again.record.remarks, outcome.record.remarks);
    let bytes = |folder: &Path| fs::read(folder.join("trajectory.xtc")).unwrap();
    assert!(bytes(&whole) == bytes(&parts));
}

#[test]
fn a_liquid_and_a_trajectory_inside_the_box_foresee_nothing() {
    let liquid = "system.density=0.8442 system.temperature=0.7 system.n_atoms=256
        output.precision=10000 stage.production.steps=1000000";
    for keys in [liquid, "output.unwrapped=false"] {
        let remarks = prepared(GAS, keys).remarks;
        assert!(!remarks.iter().any(|r| r.contains("may reach")), "{remarks:?}");
    }
}

#[test]
fn a_run_goes_on_with_another_trajectory_or_without_one() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("parts");
    let keys = "output.trajectory_every=50 stage.production.steps=400 output.format=xtc
        output.precision=1000";
    let (mut whole, mut parts) = (prepared(DUMBBELLS, keys), prepared(DUMBBELLS, keys));
    until(&root.path().join("whole"), 0, Some(&mut whole), "").unwrap();
    until(&folder, 100, Some(&mut parts), "").unwrap();
    // Stopped at once, before a checkpoint of its own: the change is kept all the same.
    until(&folder, 100, None, r#"output.format="xyz""#).unwrap();
    until(&folder, 200, None, "").unwrap();
    let scene = fs::read_to_string(folder.join("scene.toml")).unwrap();
    assert!(scene.contains("format = \"xyz\"") && !scene.contains("precision = 1000"));
    let steps = || {
        let path = folder.join("trajectory.xyz");
        let mut frames = Frames::open(&path, FileUnits::default()).unwrap();
        let next = || frames.next_frame().unwrap()?.step;
        std::iter::from_fn(next).collect::<Vec<_>>()
    };
    assert_eq!(steps(), [150, 200]);
    until(&folder, 300, None, "output.trajectory_every=0").unwrap();
    assert_eq!(steps().len(), 2);
    // The file that was left stands in the way of a new one of its name.
    let refused = until(&folder, 0, None, "output.trajectory_every=50");
    let message = refused.err().unwrap().to_string();
    assert!(message.contains("an earlier trajectory.xyz"), "{message}");
    let xtc = "output.trajectory_every=50 output.format=xtc";
    assert!(until(&folder, 0, None, xtc).is_err(), "frames before lie there");
    let end = until(&folder, 0, None, "").unwrap();
    assert_eq!(end.ending, Ending::Finished);
    // What was written changes no bit.
    for file in ["thermo.csv", "rdf.csv", "final.xyz"] {
        let bytes = |folder: &Path| fs::read(folder.join(file)).unwrap();
        assert!(bytes(&folder) == bytes(&root.path().join("whole")), "{file}");
    }
}

#[test]
fn a_run_that_goes_on_changes_nothing_but_its_trajectory() {
    let root = tempfile::tempdir().unwrap();
    let mut simulation = prepared(DUMBBELLS, FRAMES);
    until(root.path(), 50, Some(&mut simulation), "").unwrap();
    let allowed = "keys of [output] other than thermo_every";
    for (change, words) in [
        ("output.thermo_every=5", allowed),
        ("system.density=0.3", allowed),
        ("output.foramt=xtc", "nearest: format"),
        ("output.format=xct", "nearest: xtc"),
        ("output.precision=100", "does not go with the format"),
    ] {
        let message = until(root.path(), 0, None, change).err().unwrap().to_string();
        let (key, _) = change.split_once('=').unwrap();
        assert!(message.contains(words) && message.contains(key), "{message}");
    }
    let end = until(root.path(), 0, None, "").unwrap();
    assert_eq!(end.ending, Ending::Finished);
}

#[test]
fn a_box_in_file_and_scene_may_be_rounded_apart() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("start.xyz");
    let rows = "Ar 1 1 1\nAr 3 3 3\n";
    fs::write(&path, format!("2\nLattice=\"6 0 0 0 6 0 0 0 6\"\n{rows}")).unwrap();
    let text = |side: &str| {
        format!(
            "[start]\nkind = \"file\"\nfile = \"{}\"\n[system]\nbox = {side}\ntemperature = 1.0\n\
             [truncation]\nr_cut = 2.5\n[[stage]]\nname = \"production\"\nsteps = 1\n",
            path.display()
        )
    };
    let near = prepared(&text("6.0000000005"), "");
    let file = PeriodicBox::new(DVec3::splat(6.0)).unwrap();
    assert_eq!(near.state.cell, file);
    let far = lennard_engine::prepare(common::scene(&text("6.000000001"), ""));
    assert!(far.err().unwrap().to_string().contains("the box of the file"));
}
