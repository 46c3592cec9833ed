//! What a scene computes, what it leaves out and why, how much memory it takes and about how long.

use std::time::{Duration, Instant};

use lennard_core::{DVec3, Observable, Want};
use lennard_forcefield::{Precision, Search};
use lennard_scene::Scene;
use serde::Serialize;

use crate::simulation::{Follower, Simulation, Verdict};
use crate::{EngineError, build};

/// How long the short measurement takes at most.
const MEASURE_FOR: Duration = Duration::from_millis(400);

/// One part of the work.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlanItem {
    /// What it is.
    pub part: String,
    /// Whether the scene pays for it.
    pub on: bool,
    /// How, or why not.
    pub why: String,
}

/// What a scene computes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plan {
    /// Schema of this document.
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// The model in words.
    pub model: String,
    /// Number of particles.
    pub atoms: usize,
    /// Number density, σ⁻³.
    pub density: f64,
    /// Steps of all stages.
    pub steps: u64,
    /// Threads.
    pub threads: usize,
    /// Parts of the work.
    pub items: Vec<PlanItem>,
    /// Bytes held by state, lists and private copies.
    pub bytes: u64,
    /// Median time of a step in the measurement, seconds.
    pub seconds_per_step: f64,
    /// Steps in the measurement.
    pub measured_steps: u64,
    /// Estimated wall time of the whole run, seconds.
    pub estimated_seconds: f64,
}

/// Stops after a while, asks for nothing.
struct ForAWhile {
    end: Instant,
    last: Instant,
    steps: Vec<f64>,
}

impl Follower for ForAWhile {
    fn want(&self, _scene: &Scene, _step: u64, _measured: bool) -> Want {
        Want::NOTHING
    }

    fn after_step(&mut self, _simulation: &mut Simulation) -> Result<Verdict, EngineError> {
        let now = Instant::now();
        self.steps.push((now - self.last).as_secs_f64());
        self.last = now;
        Ok(if now >= self.end {
            Verdict::Stop
        } else {
            Verdict::Continue
        })
    }
}

/// Makes the plan of a scene, with a short measurement of its first steps.
///
/// # Errors
/// [`EngineError`] for everything that is wrong with the scene.
pub fn plan(simulation: &mut Simulation, threads: usize) -> Result<Plan, EngineError> {
    let scene = simulation.scene.clone();
    let (options, provider) = build::forces(&scene, simulation.cell, simulation.state.len())?;
    let items = items(&scene, simulation, provider.plan());
    let now = Instant::now();
    let mut follower = ForAWhile {
        end: now + MEASURE_FOR,
        last: now,
        steps: Vec::new(),
    };
    simulation.run(&mut follower)?;
    let n = simulation.state.len();
    // The first step also builds the list and warms the caches.
    let mut times = follower
        .steps
        .split_off(1.min(follower.steps.len().saturating_sub(1)));
    times.sort_by(f64::total_cmp);
    let mean = times.iter().sum::<f64>() / times.len() as f64;
    let vectors_a_particle = 3;
    let state_bytes = (n * vectors_a_particle * size_of::<DVec3>()) as u64;
    Ok(Plan {
        schema: "lennard-plan-1",
        scene: scene.name.clone(),
        model: lennard_forcefield::model_name(&options),
        atoms: n,
        density: n as f64 / simulation.cell.volume(),
        steps: scene.total_steps(),
        threads,
        items,
        bytes: state_bytes + simulation.forces.statistics().bytes,
        seconds_per_step: times[times.len() / 2],
        measured_steps: times.len() as u64,
        estimated_seconds: mean * scene.total_steps() as f64,
    })
}

fn item(part: &str, on: bool, why: impl Into<String>) -> PlanItem {
    PlanItem {
        part: part.to_owned(),
        on,
        why: why.into(),
    }
}

fn neighbor_in_words(forces: &lennard_forcefield::ForcePlan) -> String {
    if forces.search == Search::Verlet {
        format!(
            "list radius {:.3} σ (skin {:.3} σ): {}",
            forces.r_list, forces.skin, forces.reason
        )
    } else {
        forces.reason.clone()
    }
}

fn items(
    scene: &Scene,
    simulation: &Simulation,
    forces: &lennard_forcefield::ForcePlan,
) -> Vec<PlanItem> {
    let output = &scene.output;
    let spec = scene.integrator.method.spec();
    let mut items = vec![
        item("pair forces", true, {
            let precision = match forces.precision {
                Precision::Double => "double",
                Precision::Mixed => "mixed",
            };
            format!(
                "every step, `{}` loop, {} in {precision} precision",
                forces.kernel, forces.isa
            )
        }),
        item(
            "neighbor list",
            forces.search == Search::Verlet,
            neighbor_in_words(forces),
        ),
        item(
            "integrator",
            true,
            format!("{}, dt = {} τ", spec.name, scene.integrator.dt),
        ),
        item(
            "energy and virial",
            true,
            format!(
                "on every {}th step, for thermo.csv and the averages; not between",
                output.thermo_every
            ),
        ),
    ];
    let want = simulation.thermodynamics.want();
    items.push(if want.laplacian {
        item(
            "configurational temperature",
            true,
            format!(
                "Laplacian on every {}th step of measured stages",
                output.thermo_every
            ),
        )
    } else {
        item(
            "configurational temperature",
            false,
            "switched off in the scene",
        )
    });
    items.push(match simulation.tail {
        Some(tail) => item(
            "tail correction",
            true,
            format!(
                "computed once: {:.4} ε a particle, {:.4} ε/σ³",
                tail.energy_per_particle, tail.pressure
            ),
        ),
        None if scene.truncation.tail_correction => {
            item("tail correction", false, "the potential has none")
        }
        None => item(
            "tail correction",
            false,
            "not asked for, or not a plain cutoff",
        ),
    });
    for stage in &scene.stages {
        let bath = match &stage.thermostat {
            Some(t) => format!("{} at T = {}", t.name(), stage.temperature),
            None => "constant energy, no thermostat".into(),
        };
        let measured = if stage.measure {
            ", measured"
        } else {
            ", not measured: no observable runs"
        };
        items.push(item(
            &format!("stage {}", stage.name),
            true,
            format!("{} steps, {bath}{measured}", stage.steps),
        ));
    }
    for table in &scene.observables {
        items.push(item(
            table.options.name(),
            true,
            format!("every {} steps", table.every),
        ));
    }
    for spec in lennard_observables::observables() {
        let named = scene
            .observables
            .iter()
            .any(|o| o.options.name() == spec.name);
        if !named && spec.name != "thermodynamics" {
            items.push(item(spec.name, false, "not in the scene"));
        }
    }
    items.push(match output.trajectory_every {
        Some(every) => item(
            "trajectory",
            true,
            format!("a frame every {every} steps of measured stages"),
        ),
        None => item("trajectory", false, "no `trajectory_every` in [output]"),
    });
    items.push(item(
        "image flags",
        false,
        "positions are kept unwrapped; flags are made only where a frame is written",
    ));
    items
}
