//! What a scene becomes where a trajectory takes the place of its run.

use std::path::Path;

use lennard_core::ForceError;
use lennard_core::number::short;
use lennard_io::{FileUnits, TrajectoryFrame};
use lennard_observables::{Frames as Needs, Remark};
use lennard_scene::{Arrangement, Scene, Stage};

use crate::EngineError;

/// Two densities that differ by more than this share are told.
const SAME_DENSITY: f64 = 1e-3;

/// A force that cannot be evaluated at the first frame.
pub(super) fn unfit(scene: &Scene, error: &ForceError) -> EngineError {
    scene.invalid("potential", error, "a trajectory whose forces are finite").into()
}

/// The scene with the frames in the place of start and stages. A step is a frame, and `every` counts frames. With it come remarks,
/// and the observables that the frames cannot give.
pub(super) fn of_frames(
    mut scene: Scene,
    first: &TrajectoryFrame,
    (file, units): (&Path, FileUnits),
    interval: f64,
    has_velocities: bool,
) -> Result<(Scene, Vec<String>, Vec<Remark>), EngineError> {
    let measured = scene.measured_stage().expect("a scene that is run has a stage").clone();
    let dt = scene.stage_dt(&measured);
    let mut remarks = vec![format!(
        "measured on the frames of {}, {} τ apart: a step is a frame",
        file.display(),
        short(interval)
    )];
    remarks.extend(other_fluid(&scene, first)?);
    let (mut kept, mut left_out) = (Vec::new(), Vec::new());
    for mut table in std::mem::take(&mut scene.observables) {
        // The times at which a run of the scene samples, as far as there are frames.
        let usual = table.every as f64 * dt;
        table.every = ((usual / interval).round() as u64).max(1);
        let needs = table.options.spec().frames;
        let why = if table.options.spec().needs_temperature {
            Some("frames do not say which temperature a bath has held".to_owned())
        } else if matches!(needs, Needs::Velocities | Needs::Flows) && !has_velocities {
            Some("the frames have no velocities".to_owned())
        } else if needs == Needs::Flows && interval > usual * (1.0 + 1e-6) {
            Some(format!(
                "a frame comes every {} τ, and the integral over time needs a sample every {} τ, as the scene says",
                short(interval),
                short(usual)
            ))
        } else {
            None
        };
        match why {
            None => kept.push(table),
            Some(why) => {
                let quantities = vec![table.options.name().to_owned()];
                left_out.push(Remark::LeftOut { quantities, why });
            }
        }
    }
    scene.observables = kept;
    scene.integrator.dt = interval;
    let stage = Stage {
        steps: 1,
        temperature_from: None,
        dt: None,
        thermostat: None,
        barostat: None,
        exchange: None,
        measure: true,
        ..measured
    };
    scene.stages = vec![stage];
    let path = file.canonicalize().unwrap_or_else(|_| file.to_owned());
    scene.system.start = Arrangement::File { path, geometry: None, units };
    scene.output.thermo_every = 1;
    scene.output.trajectory_every = None;
    scene.checkpoint.every_steps = None;
    Ok((scene, remarks, left_out))
}

/// Says that the scene describes another number of particles or another density.
fn other_fluid(scene: &Scene, first: &TrajectoryFrame) -> Result<Option<String>, EngineError> {
    let (Some(n), Some(placement)) = (scene.n_particles(), scene.placement()?) else {
        return Ok(None);
    };
    let density = |n: usize, volume: f64| n as f64 / volume;
    let here = density(n, placement.cell.volume());
    let found = first.positions.len();
    let there = first.cell.map_or(f64::NAN, |cell| density(found, cell.volume()));
    let same = n == found && (there / here - 1.0).abs() < SAME_DENSITY;
    Ok((!same).then(|| {
        format!(
            "the frames have {found} particles at density {there:.4}, and the scene {n} at {here:.4}: the frames count"
        )
    }))
}
