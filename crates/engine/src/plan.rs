//! What a scene computes, what it leaves out and why, how much memory it takes and about how long.

mod shares;

use lennard_core::{DVec3, Observable};
use lennard_forcefield::Search;
use lennard_scene::Scene;
use serde::Serialize;

use crate::run::SET_ASIDE_BYTES;
use crate::simulation::Simulation;
use crate::watchdog;
use crate::{EngineError, build};
use shares::{Costs, bath_name};

pub use shares::watching_seconds;

/// One part of the work.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlanItem {
    /// What it is.
    pub part: String,
    /// Whether the scene pays for it.
    pub on: bool,
    /// How, or why not.
    pub why: String,
    /// Its share of the time of the whole run, as measured now; `None` for what is off or has no cost of its own.
    pub share: Option<f64>,
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
    /// Bytes that a run holds at most, but for what observables gather: its state and the one set aside, the forces with their
    /// lists, and a checkpoint while it is written.
    pub bytes: u64,
    /// Median time of a step with everything off, seconds.
    pub seconds_per_step: f64,
    /// Steps in the measurement.
    pub measured_steps: u64,
    /// Estimated wall time of the whole run, seconds.
    pub estimated_seconds: f64,
}

/// Bytes of the state for each particle: position, velocity and force.
const STATE_BYTES: usize = 3 * size_of::<DVec3>();

/// Makes the plan of a scene. What is on and off follows from the scene alone; a short measurement of its first steps and
/// of each part says what they cost.
///
/// # Errors
/// [`EngineError`] for everything that is wrong with the scene.
pub fn plan(simulation: &mut Simulation, threads: usize) -> Result<Plan, EngineError> {
    let scene = simulation.scene.clone();
    let (options, provider) = build::forces(&scene, simulation.cell, simulation.state.len())?;
    let mut items = items(&scene, simulation, provider.plan(), threads);
    let costs = Costs::measure(simulation)?;
    let seconds = costs.of_run(&scene);
    let total: f64 = seconds.values().sum();
    for item in &mut items {
        item.share = seconds
            .get(&item.part)
            .filter(|_| item.on)
            .map(|s| s / total);
    }
    let n = simulation.state.len();
    let state = n * STATE_BYTES;
    let set_aside = n * SET_ASIDE_BYTES;
    Ok(Plan {
        schema: "lennard-plan-2",
        scene: scene.name.clone(),
        model: lennard_forcefield::model_name(&options),
        atoms: n,
        density: n as f64 / simulation.cell.volume(),
        steps: scene.total_steps(),
        threads,
        items,
        bytes: (state + set_aside + costs.checkpoint_bytes) as u64 + costs.force_bytes,
        seconds_per_step: costs.median_step,
        measured_steps: costs.steps,
        estimated_seconds: total,
    })
}

fn item(part: &str, on: bool, why: impl Into<String>) -> PlanItem {
    PlanItem {
        part: part.to_owned(),
        on,
        why: why.into(),
        share: None,
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
    threads: usize,
) -> Vec<PlanItem> {
    let output = &scene.output;
    let spec = scene.integrator.method.spec();
    let mut items = vec![
        item("pair forces", true, {
            format!(
                "every step, `{}` loop, {} in {} precision",
                forces.kernel,
                forces.isa,
                forces.precision.name()
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
                "computed once: {:.4} ε per particle, {:.4} ε/σ³",
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
        if let Some(thermostat) = &stage.thermostat {
            items.push(item(
                &bath_name(stage, thermostat.name()),
                true,
                "once a step, or as often as its table says; one that is an integrator costs what the integrator does",
            ));
        }
    }
    items.push(item(
        "thermodynamics",
        scene.stages.iter().any(|s| s.measure),
        format!(
            "averages on every {}th step of measured stages",
            output.thermo_every
        ),
    ));
    for table in scene
        .observables
        .iter()
        .filter(|o| o.options.name() != "thermodynamics")
    {
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
    items.push(
        match (scene.checkpoint.every_steps, scene.checkpoint.every_seconds) {
            (None, None) => item(
                "checkpoints",
                false,
                "at the end alone, or when the run is stopped",
            ),
            (steps, seconds) => {
                let steps = steps.map(|n| format!("every {n} steps"));
                let seconds = seconds.map(|s| format!("every {s} s"));
                let both: Vec<String> = steps.into_iter().chain(seconds).collect();
                item(
                    "checkpoints",
                    true,
                    format!(
                        "{}, and at the end; their cost is that of the disk",
                        both.join(" and ")
                    ),
                )
            }
        },
    );
    items.push(item("watchdog", true, watchdog::what_is_done()));
    items.push(item(
        "more than one thread",
        threads > 1,
        format!(
            "{threads} at work; {} pay for {} particles",
            forces.recommended_threads,
            simulation.state.len()
        ),
    ));
    items.push(item(
        "image flags",
        false,
        "positions are kept unwrapped; flags are made only where a frame is written",
    ));
    items
}
