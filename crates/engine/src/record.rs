//! The run record, from a simulation and what its observables found.

use std::collections::BTreeMap;
use std::time::Duration;

use lennard_integrators::dof_of_centers;
use lennard_io::{
    AverageRecord, BarostatRecord, Conservation, Host, NeighborRecord, PairRecord, Performance,
    RUN_SCHEMA, RunRecord, SpeciesRecord, StageSeconds, ThermostatRecord,
};
use lennard_literature::units::Units;
use lennard_literature::{Compared, at_constant_pressure, at_constant_volume};
use lennard_observables::{ChangingBox, Estimate, Findings, Remark};
use lennard_scene::Stage;

use crate::Simulation;
use crate::baths::measured_baths;
use crate::simulation::Threads;

/// The record of a run that has not ended, or not well; `remarks` say how it failed.
#[must_use]
pub fn unfinished(simulation: &Simulation, remarks: impl IntoIterator<Item = String>) -> RunRecord {
    let mut record = bare(simulation);
    record.remarks.extend(remarks);
    record
}

/// The record of a run that has come to its end, or (`finished` false) was asked to stop; with the remarks `of_run`.
#[must_use]
pub fn finished(
    simulation: &Simulation,
    findings: &[Findings],
    wall: Duration,
    trajectory_frames: Option<u64>,
    finished: bool,
    of_run: &[String],
) -> RunRecord {
    let compared = compared(simulation);
    let (comparison, remarks) =
        compared.unwrap_or_else(|why| (Vec::new(), why.into_iter().collect()));
    let bare = bare(simulation);
    let wall_s = wall.as_secs_f64();
    let atom_steps = simulation.system.len() as f64 * simulation.state.step as f64;
    let remarks: Vec<Remark> = findings
        .iter()
        .flat_map(|f| f.remarks.iter().cloned())
        .chain(remarks.into_iter().map(Remark::from))
        .chain(few_accepted(simulation))
        .chain(simulation.frozen())
        .collect();
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
            ranks: simulation.ranks_record(wall_s),
            stages: stages(simulation),
        },
        units: simulation.scene.units.map(|units| in_units(&units, &averages)),
        averages,
        conservation: match simulation.frames {
            Some(_) => bare.conservation,
            None => simulation.thermodynamics().conservation(),
        },
        comparison,
        remarks: remarks.iter().map(Remark::to_string).chain(of_run.iter().cloned()).collect(),
        typed_remarks: remarks.into_iter().filter(|r| !matches!(r, Remark::Note { .. })).collect(),
        trajectory_frames,
        ..bare
    }
}

/// The means beside the equation of state of the model.
///
/// # Errors
/// Why nothing was compared; `None` where the averages say why.
fn compared(simulation: &Simulation) -> Result<Compared, Option<String>> {
    let scene = &simulation.scene;
    let described = scene.equation_of_state().map_err(Some)?;
    let thermodynamics = simulation.thermodynamics();
    let molecules = simulation.system.n_molecules();
    let mut measured = scene.measured_stages();
    if let Some(changing) = simulation.observable::<ChangingBox>() {
        let control = measured.find(|stage| !stage.is_ramp()).and_then(|s| s.barostat.as_ref());
        let on_the_way = || Some("not compared: pressure or temperature change on the way".into());
        let pressure = control.ok_or_else(on_the_way)?.pressure;
        let (n, n_dof) = (molecules as f64, simulation.view().n_dof());
        let missing = (n - dof_of_centers(&simulation.system, n_dof) / 3.0) / n;
        return at_constant_pressure(described, pressure, missing, thermodynamics, changing);
    }
    // The averages say it where a ramp, or a bath of no known ensemble, sets them.
    let scaled = measured_baths(scene).iter().any(|bath| !bath.canonical);
    if scaled || measured.any(Stage::is_ramp) {
        return Err(None);
    }
    let density = molecules as f64 / simulation.state.cell.volume();
    at_constant_volume(described, density, molecules, scene.kept(), thermodynamics)
}

/// A substance, and the averages that have a unit in its units.
fn in_units(units: &Units, averages: &BTreeMap<String, AverageRecord>) -> serde_json::Value {
    let physical = |(name, average): (&String, &AverageRecord)| {
        let (one, unit) = units.one(&average.unit)?;
        let Estimate { mean, standard_error, .. } = average.estimate;
        let value = serde_json::json!({
            "mean": one * mean,
            "standard_error": one * standard_error,
            "unit": unit,
        });
        Some((name.clone(), value))
    };
    let mut record = serde_json::json!(units);
    record["averages"] = averages.iter().filter_map(physical).collect();
    record
}

/// What is known before and whatever happens.
fn bare(simulation: &Simulation) -> RunRecord {
    let scene = &simulation.scene;
    let statistics = simulation.forces.statistics();
    let seen = simulation.force_check.seen();
    let threads = simulation.threads.as_ref();
    let threads = threads.map_or_else(rayon::current_num_threads, Threads::count);
    let stage = simulation.stage.as_ref();
    let bath = stage.and_then(|s| scene.stages[s.index].thermostat.as_ref().map(|t| (t, s.heat)));
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
        atoms: simulation.system.len() as u64,
        species: species(simulation),
        pairs: pairs(simulation),
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
        units: None,
        conservation: Conservation {
            energy_drift_per_atom_per_tau: f64::NAN,
            energy_drift_standard_error: f64::NAN,
            energy_rms_per_atom: f64::NAN,
            momentum_per_atom: f64::NAN,
        },
        thermostat: bath.map(|(options, heat)| ThermostatRecord {
            name: options.name().to_owned(),
            heat,
            conserved_quantity: conserved(simulation),
        }),
        barostat: barostat(simulation),
        tables: Vec::new(),
        comparison: Vec::new(),
        remarks: Vec::new(),
        typed_remarks: Vec::new(),
        trajectory_frames: None,
        trajectory: simulation.frames.as_ref().map(|frames| frames.file.clone()),
    }
}

/// The species of a mixture, with the numbers of particles.
fn species(simulation: &Simulation) -> Vec<SpeciesRecord> {
    if simulation.mixture.is_none() {
        return Vec::new();
    }
    let table = simulation.system.species();
    let of = table.all().iter().enumerate();
    let records = of.map(|(a, s)| SpeciesRecord {
        name: s.name.clone(),
        element: s.element.clone(),
        count: table.count(a) as u64,
        fraction: table.fraction(a),
        mass: s.mass,
    });
    records.collect()
}

/// What acts between the species of a mixture.
fn pairs(simulation: &Simulation) -> Vec<PairRecord> {
    if simulation.mixture.is_none() {
        return Vec::new();
    }
    let (scene, table) = (&simulation.scene, simulation.system.species());
    let records = scene.species_pairs().map(|[a, b]| {
        let pair = scene.species_pair(a, b);
        PairRecord {
            a: table.name(a).to_owned(),
            b: table.name(b).to_owned(),
            sigma: pair.sigma,
            epsilon: pair.epsilon,
            r_cut: pair.r_cut,
        }
    });
    records.collect()
}

fn conserved(simulation: &Simulation) -> String {
    let stage = simulation.stage.as_ref().map(|s| s.index);
    let changes = stage.is_some_and(|i| simulation.scene.stages[i].barostat.is_some());
    let molecule = simulation.scene.molecule.as_ref();
    let by_bonds = match molecule.is_some_and(|molecule| molecule.bonds.damps_vibrations()) {
        true => " + heat that bonds have taken",
        false => "",
    };
    if changes {
        format!(
            "total energy + V·P_tail − heat and work that thermostat and barostat have put in{by_bonds}"
        )
    } else {
        format!("total energy − heat that the thermostat has put in{by_bonds}")
    }
}

/// What the barostat of the last stage did.
fn barostat(simulation: &Simulation) -> Option<BarostatRecord> {
    let stage = simulation.stage.as_ref()?;
    let control = simulation.scene.stages[stage.index].barostat.as_ref()?;
    let moves = stage.integrator.box_moves();
    Some(BarostatRecord {
        name: control.options.name().to_owned(),
        pressure: control.pressure,
        proposed: moves.map(|m| m.tried),
        accepted: moves.map(|m| m.accepted),
        lengths: simulation.state.cell.lengths().to_array(),
    })
}

/// An acceptance below this says that the box changes too seldom for its relaxation time.
const LOWEST_ACCEPTANCE: f64 = 0.7;
/// The acceptance that a changed interval aims at; the refused part grows as the interval to the power 3/2.
const GOOD_ACCEPTANCE: f64 = 0.9;

/// What to change where too few changes of the box are accepted.
fn few_accepted(simulation: &Simulation) -> Option<Remark> {
    let stage = simulation.stage.as_ref()?;
    let control = simulation.scene.stages[stage.index].barostat.as_ref()?;
    let moves = stage.integrator.box_moves().filter(|m| m.tried > 0)?;
    let accepted = moves.acceptance();
    if accepted >= LOWEST_ACCEPTANCE {
        return None;
    }
    let factor = ((1.0 - accepted) / (1.0 - GOOD_ACCEPTANCE)).powf(2.0 / 3.0);
    let (interval, tau) = (control.options.interval(), control.options.tau());
    let fewer = (interval as f64 / factor).floor().max(1.0);
    Some(Remark::SlowBox { acceptance: accepted, interval: fewer, tau: tau * factor })
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
