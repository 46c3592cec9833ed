//! From a scene to a simulation that can run.

use lennard_core::random::Streams;
use lennard_core::{
    Backend, DVec3, ForceSum, ForceTerm, PeriodicBox, SpeciesTable, State, System, Team,
};
use lennard_forcefield::{
    AllPairs, Conditions, ForceFieldOptions, ForcePlan, ListMode, Mixture, NeighborOptions,
    PairForces, Precision, Search,
};
use lennard_integrators::BondHolder;
use lennard_integrators::fire::{self, FireOptions};
use lennard_io::StartConfiguration;
use lennard_observables::{BuildContext, ChangingBox, Confined, ObservableOptions, Thermodynamics};
use lennard_scene::{Arrangement, ObservableTable, Scene};

use crate::baths::{ensemble, held_temperature, measured_baths, measured_pressure};
use crate::confinement::Confinement;
use crate::curvature::{curvature, pair_ends};
use crate::error::misfit;
use crate::own::OwnParts;
use crate::planar_tail::PlanarTail;
use crate::schedule::Observer;
use crate::simulation::{Recording, Simulation, Timers};
use crate::start::{Start, make_suit, start_with, thermal_velocities};
use crate::watchdog::ForceCheck;
use crate::{EngineError, baths, foresight, from_frames, pressure, room, together};

/// The temperature and step for which the list is laid out. They are the highest temperature and the
/// largest step of all stages, since one list serves all.
#[must_use]
pub fn conditions<'a>(
    scene: &Scene,
    cell: PeriodicBox,
    n_atoms: usize,
    mixture: Option<&'a Mixture>,
) -> Conditions<'a> {
    let is_measured = scene.measured_stages().next().is_some();
    let stages = scene.stages.iter().filter(|stage| stage.measure || !is_measured);
    let highest = stages.clone().map(|stage| stage.temperature).reduce(f64::max);
    let temperature = highest.unwrap_or(scene.system.temperature);
    let largest = stages.map(|stage| scene.stage_dt(stage)).reduce(f64::max);
    let dt = largest.unwrap_or(scene.integrator.dt);
    Conditions { cell, n_atoms, temperature, dt, mixture }
}

/// The force field of a scene for a box and its particles, beside the options in force, with the precision of the loop.
///
/// # Errors
/// [`EngineError::Scene`] where cutoff or skin do not fit the box, and where the settings for an accuracy have
/// not been chosen. [`EngineError::Memory`] where the memory of a run is not there.
pub fn forces(
    scene: &Scene,
    cell: PeriodicBox,
    species: &SpeciesTable,
) -> Result<(ForceFieldOptions, PairForces), EngineError> {
    forces_on(scene, cell, species, 1)
}

/// As [`forces`], on one of so many ranks.
fn forces_on(
    scene: &Scene,
    cell: PeriodicBox,
    species: &SpeciesTable,
    ranks: usize,
) -> Result<(ForceFieldOptions, PairForces), EngineError> {
    scene.settled()?;
    let mut options = scene.force_field();
    let mixture = scene.mixture_of(species);
    let conditions = conditions(scene, cell, species.n_particles(), mixture.as_ref());
    let built = lennard_forcefield::build(&options, &conditions).map_err(|e| scene.misfit(&e))?;
    room::is_there(scene, &cell, species.n_particles(), ranks)?;
    PlanarTail::check(scene, &cell)?;
    options.kernel.precision = built.plan().precision;
    Ok((options, built))
}

/// Builds the simulation: particles placed, relaxed where the start is random, velocities drawn
/// where the start has none.
///
/// # Errors
/// [`EngineError`] for everything about the scene that can only be seen now.
pub fn prepare(scene: Scene) -> Result<Simulation, EngineError> {
    prepare_with(scene, None, OwnParts::none())
}

/// As [`prepare`], with a start in memory in the place of the file that the scene names, and with parts of a program.
///
/// # Errors
/// As [`prepare`], and where a part does not keep its contract.
pub fn prepare_with(
    scene: Scene,
    start: Option<StartConfiguration>,
    own: OwnParts,
) -> Result<Simulation, EngineError> {
    let start = start_with(&scene, start, None)?;
    prepare_own_from(scene, start, own, None)
}

/// As [`prepare`], on one of several ranks where there is a team. Every rank has to call it, and keeps some of the particles.
///
/// # Errors
/// As [`prepare`]; [`EngineError::Ranks`] where the ranks do not have the same scene, or are more than can be kept busy;
/// [`EngineError::Scene`] for what one process alone can run.
pub fn prepare_on(scene: Scene, team: Option<&Team>) -> Result<Simulation, EngineError> {
    if let Some(team) = team {
        together::can_share(&scene, team)?;
    }
    let start = together::alike(team, start_with(&scene, None, team))?;
    prepare_own_from(scene, start, OwnParts::none(), team)
}

/// Builds the simulation around particles that have their places, whatever start the scene names.
///
/// # Errors
/// As [`prepare`].
pub fn prepare_from(scene: Scene, start: Start) -> Result<Simulation, EngineError> {
    prepare_own_from(scene, start, OwnParts::none(), None)
}

/// As [`prepare_from`], with parts of a program.
pub(crate) fn prepare_own_from(
    scene: Scene,
    start: Start,
    own: OwnParts,
    team: Option<&Team>,
) -> Result<Simulation, EngineError> {
    let scene = own.enter(scene)?;
    let Start { cell, mut positions, mut velocities, species, relax: moves_apart, mut remarks } =
        start;
    let n = species.n_particles();
    let ranks = team.map_or(1, Team::ranks);
    let (options, provider) = together::alike(team, forces_on(&scene, cell, &species, ranks))?;
    remarks.extend(pressure::foresee(&scene, &cell, n, provider.plan().skin)?);
    remarks.extend(provider.plan().remark.clone());
    if !scene.program.is_empty() && own.method_name() != Some(from_frames::NAME) {
        let parts = scene.program.in_words();
        remarks.push(format!(
            "the program of this run brought {parts}; its scene file alone is another run"
        ));
    }
    if moves_apart {
        together::alike(team, relax(&scene, cell, &species, &mut positions))?;
    }
    let mixture = scene.mixture_of(&species);
    let (mut system, confinement) = Confinement::with_system(&scene, &cell, species);
    system = confinement.pushes(system, own.pushed());
    if let Some(team) = team {
        let kept = together::can_keep(team, n)?;
        let numbers = kept.numbers();
        let both = [Some(&mut positions), velocities.as_mut()];
        for array in both.into_iter().flatten().filter(|array| array.len() != numbers.len()) {
            *array = array[numbers.clone()].to_vec();
        }
        system = system.keeping(kept);
    }
    remarks.extend(foresight::of_scene(&scene, &system, &cell, &positions));
    let streams = Streams::new(scene.system.seed);
    let velocities = match velocities {
        Some(mut given) => {
            make_suit(&system, &positions, &mut given);
            given
        }
        None => {
            let temperature = scene.system.temperature;
            if let Arrangement::File { path, .. } = &scene.system.start {
                remarks.push(format!(
                    "{} has no velocities: they are drawn at T = {temperature} with seed {}",
                    path.display(),
                    scene.system.seed
                ));
            }
            thermal_velocities(&system, &positions, temperature, streams)
        }
    };
    own.check_forces(&scene, &cell, &positions, &velocities)?;
    let observers = observers(&scene, cell, &system, &own)?;
    let isa = provider.plan().isa.to_string();
    team.map_or(Ok(()), |team| together::same_isa(team, &isa))?;
    let list = planned_list(&scene, provider.plan());
    let all_pairs =
        AllPairs::new(&options, mixture.as_ref()).map_err(|e| misfit(&scene.source, &e))?;
    let mut forces = with_others(&scene, confinement.beside(provider), &own);
    if let Some(team) = team {
        forces.keep(system.own());
        together::share(&mut forces, team, &cell)?;
    }
    let simulation = Simulation {
        state: State::new(cell, positions, velocities),
        scene,
        system,
        start_cell: cell,
        forces: Box::new(forces),
        force_check: ForceCheck::new(all_pairs),
        list,
        force_field: options,
        mixture,
        streams,
        stage: None,
        observers,
        measured_steps: 0,
        remarks,
        timers: Timers::default(),
        isa,
        own,
        recording: Recording::default(),
        frames: None,
        threads: None,
    };
    check_own(&simulation)?;
    Ok(simulation)
}

/// What a scene must say to get the same list in other conditions, such as another temperature.
fn planned_list(scene: &Scene, plan: &ForcePlan) -> NeighborOptions {
    match plan.search {
        Search::Nothing | Search::Reference => scene.neighbor,
        Search::Direct => NeighborOptions { mode: ListMode::Direct, skin: None },
        Search::Verlet => NeighborOptions { skin: Some(plan.skin), ..scene.neighbor },
    }
}

/// Adds the springs that hold bonds, where the scene has some, and the forces of the program.
pub(crate) fn with_others<B: Backend>(
    scene: &Scene,
    mut forces: ForceSum<B>,
    own: &OwnParts,
) -> ForceSum<B> {
    let molecule = scene.molecule.as_ref();
    match molecule.map(|molecule| molecule.bonds.build(&molecule.molecules())) {
        Some(
            BondHolder::Spring(term)
            | BondHolder::InDrift(_, term)
            | BondHolder::Spook(_, Some(term)),
        ) => forces.push(term),
        Some(BondHolder::Drift(_) | BondHolder::Spook(_, None)) | None => {}
    }
    own.make_forces().for_each(|term| forces.push(term));
    forces
}

/// Relaxes a random start until nothing overlaps. It works in double precision whatever the scene runs in. In single precision,
/// the force of two particles at nearly the same place is no number.
fn relax(
    scene: &Scene,
    cell: PeriodicBox,
    species: &SpeciesTable,
    positions: &mut [DVec3],
) -> Result<(), EngineError> {
    let mut relaxing = scene.clone();
    relaxing.kernel.precision = Precision::Double;
    let (_, mut provider) = forces(&relaxing, cell, species)?;
    fire::relax(&cell, positions, &mut provider, &FireOptions::default()).map(|_| ()).map_err(|e| {
        scene
            .invalid(
                "start.kind",
                format!("`random`, which could not be relaxed: {e}"),
                "a lattice, or a lower density",
            )
            .into()
    })
}

/// The time step of the measured stage, τ.
fn measured_dt(scene: &Scene) -> f64 {
    scene.measured_stage().map_or(scene.integrator.dt, |s| scene.stage_dt(s))
}

/// The thermodynamics of a scene, nothing seen yet.
pub(crate) fn thermodynamics(
    scene: &Scene,
    cell: PeriodicBox,
    species: &SpeciesTable,
    own: &OwnParts,
) -> Result<Thermodynamics, EngineError> {
    let of_thermodynamics = |table: &ObservableTable| match &table.options {
        ObservableOptions::Thermodynamics(options) => Some(options.clone()),
        _ => None,
    };
    let options = scene.observables.iter().find_map(of_thermodynamics);
    let mut options = options.unwrap_or_default();
    let molecules = scene.molecules();
    let has_no_force = scene.longest_cutoff() == 0.0;
    if molecules.are_rigid() || molecules.hide_forces() || has_no_force {
        // Constraint forces are no gradient of a potential: ⟨|∇U|²⟩/⟨∇²U⟩ is no temperature. Without pair forces it is 0/0.
        options.configurational_temperature = false;
    }
    let context =
        scene.observable_context(cell, species, measured_dt(scene), scene.output.thermo_every);
    let mut thermodynamics = Thermodynamics::with_options(&options, &context);
    thermodynamics.set_ends(pair_ends(scene, species)?);
    thermodynamics.set_curvature(curvature(scene)?);
    thermodynamics
        .set_ensemble(scene.measured_stage().and_then(|stage| ensemble(scene, stage, own)));
    thermodynamics.set_bath(held_temperature(scene));
    let is_confined = scene.confined_by().is_some();
    let confined = (is_confined || scene.contacts_act_in_flight()).then(|| Confined {
        is_inhomogeneous: is_confined,
        by_hits: Confinement::with_system(scene, &cell, species.clone())
            .1
            .properties()
            .acts_in_flight(),
    });
    thermodynamics.set_confined(confined);
    Ok(thermodynamics)
}

/// The observables of a scene: thermodynamics, which every run has, and then the others that it names.
pub(crate) fn observers(
    scene: &Scene,
    cell: PeriodicBox,
    system: &System,
    own: &OwnParts,
) -> Result<Vec<Observer>, EngineError> {
    let (species, n_atoms) = (system.species(), system.len());
    let context = |every| BuildContext {
        own: system.own().clone(),
        ..scene.observable_context(cell, species, measured_dt(scene), every)
    };
    let every = scene.output.thermo_every;
    let thermodynamics = thermodynamics(scene, cell, species, own)?;
    let mut observers = vec![Observer { every, observable: Box::new(thermodynamics) }];
    let keeps_motion = measured_baths(scene).iter().all(|bath| bath.keeps_motion);
    for (index, table) in scene.observables.iter().enumerate() {
        let mut options = table.options.clone();
        match &mut options {
            ObservableOptions::Thermodynamics(_) => continue,
            // With friction there is no flow around a particle that a closed box could slow down.
            ObservableOptions::Msd(o) if o.viscosity.is_none() && keeps_motion => {
                o.viscosity = scene.viscosity_near(n_atoms as f64 / cell.volume());
            }
            _ => {}
        }
        let observable =
            lennard_observables::build(&options, &context(table.every)).map_err(|e| {
                scene.invalid(&format!("observable.{index}.{}", e.key()), e.found(), e.allowed())
            })?;
        observers.push(Observer { every: table.every, observable });
    }
    // Behind the others, so that these stand as in the scene.
    if let Some(pressure) = measured_pressure(scene) {
        observers.push(Observer {
            every,
            observable: Box::new(ChangingBox::new(pressure, scene.molecules().energy_unit())),
        });
    }
    if let Some(profile) = baths::profile_of_exchange(scene, &context(every)) {
        observers.push(Observer { every, observable: Box::new(profile) });
    }
    observers.extend(own.make_observers());
    Ok(observers)
}

/// As many threads as pay for so many particles on this machine.
#[must_use]
pub fn recommended_threads(n_atoms: usize) -> usize {
    let available = lennard_core::parallel::processors();
    lennard_forcefield::recommended_threads(n_atoms, available)
}

/// Refuses baths and barostats that take the place of a method of the program, and an observable with the name of another.
fn check_own(simulation: &Simulation) -> Result<(), EngineError> {
    let Simulation { scene, own, observers, .. } = simulation;
    for (index, stage) in scene.stages.iter().enumerate().filter(|_| own.method_name().is_some()) {
        let there = simulation.stage_run_for(index).integrator.spec().name;
        if let Some(own) = own.method_name().filter(|own| *own != there) {
            let table = if stage.barostat.is_some() { "barostat" } else { "thermostat" };
            let found = format!("`{there}`, which steps in the place of `{own}`");
            let allowed = "none, or a bath that acts between steps, such as `bussi`";
            let key = format!("stage.{index}.{table}");
            return Err(scene.invalid(&key, found, allowed).into());
        }
    }
    let names: Vec<&str> = observers.iter().map(|o| o.observable.spec().name).collect();
    let is_double = |name: &&str| names.iter().filter(|n| *n == name).count() > 1;
    own.observable_names().find(is_double).map_or(Ok(()), |name| {
        let allowed = "a name that no other observable of the run has";
        Err(scene.invalid("program.observables", format!("`{name}`"), allowed).into())
    })
}
