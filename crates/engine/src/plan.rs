//! What a scene computes, what it leaves out and why, how much memory it takes and about how long.

mod ranks;
mod shares;

pub use ranks::{Network, OnRanks, Ranks};
pub use shares::{PATIENCE, watching_seconds};

use lennard_core::number::short;
use lennard_core::{DVec3, TooManyRanks};
use lennard_forcefield::{ForcePlan, Search};
use lennard_observables::Observable;
use lennard_scene::{Scene, Stage};
use ranks::OneRank;
use serde::Serialize;
use shares::{Costs, Part, THERMODYNAMICS, barostat_name, bath_name};

use crate::error::RanksError;
use crate::planar_tail::PlanarTail;
use crate::run::SET_ASIDE_BYTES;
use crate::simulation::Simulation;
use crate::{EngineError, build, watchdog};

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
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Plan {
    /// Schema of this document.
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// The model in words.
    pub model: String,
    /// Number of particles.
    pub atoms: usize,
    /// Number of molecules; of particles where there are none.
    pub molecules: usize,
    /// Number density, σ⁻³, of molecules where there are some.
    pub density: f64,
    /// Steps of all stages.
    pub steps: u64,
    /// Threads.
    pub threads: usize,
    /// Parts of the work.
    pub items: Vec<PlanItem>,
    /// Bytes that a run holds at most: its state, a second state set aside, and the forces with their lists. On top comes a
    /// checkpoint under way, the text of the last state, or the neighbors that tell whether it froze. What observables gather
    /// is not counted.
    pub bytes: u64,
    /// Bytes that the program itself holds, with its libraries, whatever the scene.
    pub program_bytes: u64,
    /// Median time of a step with everything off, seconds; `None` where steps are too slow to measure.
    pub seconds_per_step: Option<f64>,
    /// Steps in the measurement, without the first.
    pub measured_steps: u64,
    /// Estimated wall time of the whole run, seconds; `None` where steps are too slow to measure.
    pub estimated_seconds: Option<f64>,
    /// What is known of the start, and what speaks against the run, a sentence each.
    pub remarks: Vec<String>,
    /// Sides of the box at the start, σ.
    pub lengths: DVec3,
    /// The distance that forces and lists reach, σ.
    pub reach: f64,
    /// What several ranks make of the scene, where the command asks for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ranks: Option<Ranks>,
}

/// Bytes that a process of the program holds without particles: 12.2 to 12.6 MB with 256 of them, on Linux.
const PROGRAM_BYTES: u64 = 12_000_000;
/// Bytes of the state for each particle: position, velocity and force.
const STATE_BYTES: usize = 3 * size_of::<DVec3>();

/// Makes the plan of a scene. What is on and off follows from the scene alone; a short measurement of its first steps and
/// of each part says what they cost. `network` asks what several ranks would make of the scene.
///
/// # Errors
/// [`EngineError`] for everything that is wrong with the scene, and where ranks do not run it.
pub fn plan(
    simulation: &mut Simulation,
    threads: usize,
    network: Option<Network>,
) -> Result<Plan, EngineError> {
    let scene = simulation.scene.clone();
    let (_, mut provider) =
        build::forces(&scene, simulation.state.cell, simulation.system.species())?;
    let mut items = items(&scene, simulation, provider.plan(), threads);
    let foreseen = simulation.foreseen();
    let particles = simulation.state.len();
    let r_list = provider.plan().r_list;
    let coordinate_bytes = if provider.plan().kernel == "cluster" { 12.0 } else { 24.0 };
    let most = provider.most_ranks(&simulation.state.cell);
    if let Some(Network { ranks, .. }) = network {
        scene.check_for_ranks()?;
        let least = lennard_forcefield::LEAST_OF_A_RANK;
        if let Some(ranks) = ranks.filter(|ranks| *ranks > most) {
            return Err(RanksError::from(TooManyRanks { ranks, particles, least, most }).into());
        }
    }
    let costs = Costs::measure(simulation)?;
    let total = costs.parts.as_ref().map(|all| all.iter().map(Part::of_run).sum::<f64>());
    for item in items.iter_mut().filter(|item| item.on) {
        let all = costs.parts.iter().flatten().filter(|part| part.name == item.part);
        let seconds = all.map(Part::of_run).reduce(|a, b| a + b);
        item.share = seconds.zip(total).map(|(s, t)| s / t);
    }
    let (n, molecules) = (particles, simulation.system.n_molecules());
    let state = n * STATE_BYTES;
    let set_aside = n * SET_ASIDE_BYTES;
    // A checkpoint and the look at the last state come one after the other.
    let at_times = costs.checkpoint_bytes.max(simulation.bytes_to_look());
    let bytes_to_write = (set_aside + at_times) as u64;
    let bytes = state as u64 + bytes_to_write + costs.force_bytes;
    let one = |core_seconds| OneRank {
        atoms: n,
        lengths: simulation.state.cell.lengths(),
        r_list,
        core_seconds,
        coordinate_bytes,
        building: costs.building,
        builds: costs.builds,
        rows: 1.0 / scene.output.thermo_every as f64,
        bytes,
        program_bytes: PROGRAM_BYTES,
    };
    let measured = network.zip(costs.mean_step);
    let ranks = measured.map(|(on, step)| one(step * threads as f64).on(on, most));
    Ok(Plan {
        schema: lennard_io::schema!("plan", 4),
        scene: scene.name.to_string(),
        model: scene.model_name(),
        atoms: n,
        molecules,
        density: molecules as f64 / simulation.state.cell.volume(),
        steps: scene.total_steps(),
        threads,
        items,
        bytes,
        program_bytes: PROGRAM_BYTES,
        seconds_per_step: total.map(|_| costs.median_step),
        measured_steps: costs.steps,
        estimated_seconds: total,
        remarks: [simulation.remarks.clone(), foreseen].concat(),
        lengths: simulation.state.cell.lengths(),
        reach: r_list,
        ranks,
    })
}

fn item(part: &str, on: bool, why: impl Into<String>) -> PlanItem {
    PlanItem { part: part.to_owned(), on, why: why.into(), share: None }
}

/// A part that is on where there are words how, else off.
fn item_where(part: &str, how: Option<String>, why_not: &str) -> PlanItem {
    let on = how.is_some();
    item(part, on, how.unwrap_or_else(|| why_not.to_owned()))
}

fn items(
    scene: &Scene,
    simulation: &Simulation,
    forces: &ForcePlan,
    threads: usize,
) -> Vec<PlanItem> {
    let mut items = Vec::from(of_steps(scene, simulation, forces));
    if let Some(molecule) = &scene.molecule {
        let bonds = molecule.molecules().bonds().len() * simulation.system.n_molecules();
        let words = format!("{bonds} bonds, {}", molecule.bonds.spec().name);
        items.push(item("bonds", true, words));
    }
    items.extend(of_species(simulation));
    for stage in &scene.stages {
        items.extend(of_stage(stage));
    }
    items.extend(of_observables(scene));
    items.extend(of_output(scene));
    items.push(item("watchdog", true, watchdog::what_is_done()));
    let more_threads = format!(
        "{threads} at work; {} pay for {} particles",
        forces.recommended_threads,
        simulation.state.len()
    );
    items.push(item("more than one thread", threads > 1, more_threads));
    items.push(item(
        "image flags",
        false,
        "positions are kept unwrapped; flags are made only where a frame is written",
    ));
    items
}

/// The particles of each species, where the scene names species.
fn of_species(simulation: &Simulation) -> Option<PlanItem> {
    simulation.mixture.as_ref()?;
    let species = simulation.system.species();
    let each: Vec<String> = (0..species.n_species())
        .map(|a| {
            let (count, mass) = (species.count(a), species.species(a).mass);
            format!("{count} of {} with mass {mass}", species.name(a))
        })
        .collect();
    Some(item("species", true, each.join(", ")))
}

fn of_steps(scene: &Scene, simulation: &Simulation, forces: &ForcePlan) -> [PlanItem; 6] {
    let rows = scene.output.thermo_every;
    let (on, tail) = match simulation.tail() {
        Some(tail) => {
            let volume = "from the volume of each sample; at the start";
            let when = if simulation.box_changes() { volume } else { "once" };
            let unit = simulation.system.molecules.energy_unit();
            let (energy, pressure) = (tail.energy_per_particle, tail.pressure);
            (true, format!("computed {when}: {energy:.4} {unit}, {pressure:.4} ε/σ³"))
        }
        None if scene.planar_tail => {
            let tail = PlanarTail::of(scene, &simulation.state.cell);
            let waves = tail.map_or(0, |tail| tail.n_modes());
            (
                true,
                format!(
                    "a force across the surfaces, of {waves} waves along z, on every step; steps are not fused"
                ),
            )
        }
        None if scene.truncation.tail_correction => (false, "the potential has none".to_owned()),
        None => (false, "not asked for, or not a plain cutoff".to_owned()),
    };
    let ForcePlan { kernel, isa, precision, reason, r_list, skin, .. } = forces;
    let list = format!("list radius {r_list:.3} σ (skin {skin:.3} σ): {reason}");
    let wants_laplacian = simulation.thermodynamics().want().laplacian;
    let laplacian = format!("Laplacian on every {rows}th step of measured stages");
    let molecules = &simulation.system.molecules;
    let no_laplacian = if molecules.are_rigid() || molecules.hide_forces() {
        "not of rigid bonds and implicit springs: what holds them is not among the forces"
    } else {
        "switched off in the scene"
    };
    let pairs = format!("every step, `{kernel}` loop, {isa} in {} precision", precision.name());
    let integrator = format!("{}, dt = {} τ", scene.method_name(), short(scene.integrator.dt));
    let energies = format!("on every {rows}th step, for thermo.csv and the averages; not between");
    [
        item("pair forces", true, pairs),
        item_where("neighbor list", (forces.search == Search::Verlet).then_some(list), reason),
        item("integrator", true, integrator),
        item("energy and virial", true, energies),
        item_where(
            "configurational temperature",
            wants_laplacian.then_some(laplacian),
            no_laplacian,
        ),
        item("tail correction", on, tail),
    ]
}

fn of_stage(stage: &Stage) -> impl Iterator<Item = PlanItem> {
    let bath = match &stage.thermostat {
        Some(t) => format!("{} at {}", t.name(), stage.temperature_in_words()),
        None => "constant energy, no thermostat".into(),
    };
    let measured = if stage.measure { ", measured" } else { ", not measured: no observable runs" };
    let itself = item(
        &format!("stage {}", stage.name),
        true,
        format!("{} steps, {bath}{measured}", stage.steps),
    );
    let bath = stage.thermostat.as_ref().map(|thermostat| {
        let how = "once a step, or as often as its table says; one that is an integrator costs what the integrator does";
        item(&bath_name(stage, thermostat.name()), true, how)
    });
    let barostat = stage.barostat.as_ref().map(|control| {
        let how = match control.options.evaluations() {
            0 => "at each step, which asks the forces for energy and virial".to_owned(),
            _ => format!(
                "every {} steps, with one evaluation of forces, energy and virial",
                control.options.interval()
            ),
        };
        let how = format!("{}, {how}", control.pressure_in_words());
        item(&barostat_name(stage, control.options.name()), true, how)
    });
    let exchange = stage.exchange.as_ref().map(|exchange| {
        let how = format!(
            "of {} along {}, every {} steps, between 2 of {} slabs",
            exchange.kind.name(),
            exchange.axis.name(),
            exchange.every,
            exchange.slabs
        );
        item(&format!("exchange of {}", stage.name), true, how)
    });
    [itself].into_iter().chain(bath).chain(barostat).chain(exchange)
}

fn of_observables(scene: &Scene) -> Vec<PlanItem> {
    let rows = scene.output.thermo_every;
    let averages = format!("averages on every {rows}th step of measured stages");
    let mut items = vec![item(THERMODYNAMICS, scene.measured_stages().next().is_some(), averages)];
    let tables = scene.observables.iter();
    let named = tables.map(|table| (table.options.name(), table.every));
    let named: Vec<_> = named.filter(|(name, _)| *name != THERMODYNAMICS).collect();
    for (name, every) in &named {
        items.push(item(name, true, format!("every {every} steps")));
    }
    for spec in lennard_observables::observables() {
        if spec.name != THERMODYNAMICS && named.iter().all(|(name, _)| *name != spec.name) {
            items.push(item(spec.name, false, "not in the scene"));
        }
    }
    items
}

fn of_output(scene: &Scene) -> [PlanItem; 2] {
    let frames = |every| format!("a frame every {every} steps of measured stages");
    let trajectory = scene.output.trajectory_every.map(frames);
    let (steps, seconds) = (scene.checkpoint.every_steps, scene.checkpoint.every_seconds);
    let when: Vec<String> = steps
        .map(|n| format!("every {n} steps"))
        .into_iter()
        .chain(seconds.map(|s| format!("every {s} s")))
        .collect();
    let checkpoints =
        format!("{}, and at the end; what they cost depends on the disk", when.join(" and "));
    let alone = "at the end alone, or when the run is stopped";
    [
        item_where("trajectory", trajectory, "no `trajectory_every` in [output]"),
        item_where("checkpoints", (!when.is_empty()).then_some(checkpoints), alone),
    ]
}
