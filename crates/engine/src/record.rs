//! The run record, from a simulation and what its observables found.

use std::collections::BTreeMap;
use std::time::Duration;

use lennard_core::Findings;
use lennard_io::{
    AverageRecord, Conservation, Host, NeighborRecord, Performance, RUN_SCHEMA, RunRecord,
    StageSeconds, ThermostatRecord,
};

use crate::{Simulation, compare};

/// The record of a run that has not ended, or not well; `remarks` say how it failed.
#[must_use]
pub fn unfinished(
    simulation: &Simulation,
    threads: usize,
    remarks: impl IntoIterator<Item = String>,
) -> RunRecord {
    let mut record = bare(simulation, threads);
    record.remarks.extend(remarks);
    record
}

/// The record of a run that has come to its end, or (`finished` false) was asked to stop.
#[must_use]
pub fn finished(
    simulation: &Simulation,
    findings: &[Findings],
    threads: usize,
    wall: Duration,
    trajectory_frames: Option<u64>,
    finished: bool,
) -> RunRecord {
    let molecules = simulation.system.n_molecules();
    let density = molecules as f64 / simulation.state.cell.volume();
    let compared = compare::with_equation_of_state(
        &simulation.scene,
        density,
        molecules,
        simulation.thermodynamics(),
    );
    let conservation = simulation.thermodynamics().conservation();
    let wall_s = wall.as_secs_f64();
    let atom_steps = simulation.state.len() as f64 * simulation.state.step as f64;
    let averages: BTreeMap<String, AverageRecord> = findings
        .iter()
        .flat_map(|f| &f.averages)
        .map(|average| {
            let record = AverageRecord::new(average, simulation.measured_steps);
            (average.name.clone(), record)
        })
        .collect();
    RunRecord {
        finished,
        wall_s,
        performance: Performance {
            atom_steps_per_s: atom_steps / wall_s,
            ns_per_atom_step: 1e9 * wall_s / atom_steps,
            stages: stages(simulation),
        },
        averages,
        conservation: Conservation {
            energy_drift_per_atom_per_tau: conservation.energy_drift_per_atom_per_tau,
            energy_drift_standard_error: conservation.energy_drift_standard_error,
            energy_rms_per_atom: conservation.energy_rms_per_atom,
            momentum_per_atom: conservation.momentum_per_atom,
        },
        comparison: compared.entries,
        remarks: findings
            .iter()
            .flat_map(|f| f.remarks.iter().cloned())
            .chain(compared.remarks)
            .collect(),
        trajectory_frames,
        ..bare(simulation, threads)
    }
}

/// What is known before and whatever happens.
fn bare(simulation: &Simulation, threads: usize) -> RunRecord {
    let scene = &simulation.scene;
    let statistics = simulation.forces.statistics();
    let seen = simulation.force_check.seen();
    let stage = simulation.stage.as_ref();
    let bath = stage.and_then(|s| {
        scene.stages[s.index]
            .thermostat
            .as_ref()
            .map(|t| (t, s.heat))
    });
    RunRecord {
        schema: RUN_SCHEMA.to_owned(),
        finished: false,
        // The resolved text is ours: where it did not parse, the record would still hold it as text.
        scene: toml::from_str(&scene.resolved_toml())
            .unwrap_or_else(|_| serde_json::Value::String(scene.resolved_toml())),
        model: scene.model_name(),
        seed: scene.system.seed,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        host: Host {
            cpu: lennard_io::cpu_name(),
            isa: simulation.isa.clone(),
            threads: threads as u64,
        },
        steps: simulation.state.step,
        atoms: simulation.state.len() as u64,
        n_dof: simulation.view().n_dof() as u64,
        wall_s: 0.0,
        performance: Performance::default(),
        neighbor: NeighborRecord {
            builds: statistics.builds,
            checked_forces: seen.forces,
            largest_deviation: (seen.forces > 0).then_some(seen.largest_deviation),
            skin: (statistics.builds > 0).then_some(statistics.skin),
        },
        averages: BTreeMap::new(),
        conservation: Conservation {
            energy_drift_per_atom_per_tau: f64::NAN,
            energy_drift_standard_error: f64::NAN,
            energy_rms_per_atom: f64::NAN,
            momentum_per_atom: f64::NAN,
        },
        thermostat: bath.map(|(options, heat)| ThermostatRecord {
            name: options.name().to_owned(),
            heat,
            conserved_quantity: "total energy − heat that the thermostat has put in".to_owned(),
        }),
        comparison: Vec::new(),
        remarks: Vec::new(),
        trajectory_frames: None,
    }
}

/// Where the time went, in seconds.
fn stages(simulation: &Simulation) -> StageSeconds {
    let statistics = simulation.forces.statistics();
    let timers = simulation.timers;
    StageSeconds {
        force: statistics.force_seconds,
        neighbor: statistics.neighbor_seconds,
        integrate: (timers.step.as_secs_f64()
            - statistics.force_seconds
            - statistics.neighbor_seconds)
            .max(0.0),
        observe: timers.observe.as_secs_f64(),
        write: timers.write.as_secs_f64(),
    }
}
