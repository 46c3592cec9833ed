//! From a scene to a simulation that can run.

use std::path::Path;

use lennard_core::random::Streams;
use lennard_core::{Backend, DVec3, ForceSum, PeriodicBox, State, System, rigid};
use lennard_forcefield::{AllPairs, Conditions, ForceFieldOptions, Model, PairForces, Precision};
use lennard_integrators::BondHolder;
use lennard_integrators::fire::{self, FireOptions};
use lennard_io::StartConfiguration;
use lennard_observables::{BuildContext, ChangingBox, Confined, ObservableOptions, Thermodynamics};
use lennard_scene::{Geometry, Lattice, ObservableTable, Scene, Stage, Start};

use crate::baths::{ensemble, held_temperature, measured_baths, measured_pressure};
use crate::confinement::{Confinement, place_between_walls};
use crate::error::misfit;
use crate::force_check::ForceCheck;
use crate::initial::{self, closest_pair};
use crate::schedule::Observer;
use crate::simulation::Simulation;
use crate::timers::Timers;
use crate::{EngineError, compare, pressure};

/// Start positions nearer than this (σ) are refused: U(0.5 σ) = 16,128 ε would blow any step up.
pub const SMALLEST_START_DISTANCE: f64 = 0.5;

/// Where the particles are, and how fast, before the first step.
pub struct Beginning {
    /// The box.
    pub cell: PeriodicBox,
    /// Positions, σ.
    pub positions: Vec<DVec3>,
    /// Velocities, if the start has any.
    pub velocities: Option<Vec<DVec3>>,
    /// Whether the positions must be relaxed first.
    pub relax: bool,
}

/// Places the particles as the scene says.
///
/// # Errors
/// [`EngineError`] where a configuration cannot be read, does not fit the box, or overlaps.
pub fn begin(scene: &Scene) -> Result<Beginning, EngineError> {
    Ok(begin_with_remarks(scene)?.0)
}

/// The same with what is to be known of it: which frame of a file it is, and what its velocities lose.
pub(crate) fn begin_with_remarks(scene: &Scene) -> Result<(Beginning, Vec<String>), EngineError> {
    match &scene.system.start {
        Start::Lattice {
            lattice, n_atoms, ..
        } => {
            let placement = scene.placement()?.expect("a lattice start has a placement");
            let cell = placement.cell;
            if *lattice == Lattice::Random {
                let filled = PeriodicBox::new(placement.filled).map_err(|e| {
                    scene
                        .source
                        .invalid("system.box", e, "finite positive lengths")
                })?;
                let streams = Streams::new(scene.system.seed);
                let points =
                    initial::random_points(&filled, *n_atoms, streams).ok_or_else(|| {
                        scene.source.invalid(
                            "system.density",
                            "points that do not fit at random",
                            "a lower density",
                        )
                    })?;
                let positions = points.into_iter().map(|r| r + placement.corner).collect();
                let beginning = Beginning {
                    cell,
                    positions,
                    velocities: None,
                    relax: true,
                };
                return Ok((beginning, Vec::new()));
            }
            let cells = placement.cells.expect("a lattice has cells");
            let centers =
                initial::lattice_sites(placement.corner, placement.filled, cells, lattice.basis());
            let molecules = scene.molecules();
            let positions = match molecules.are_atoms() {
                true => centers,
                false => {
                    initial::molecules_about(&centers, molecules.sites(), molecules.bond_length())
                }
            };
            refuse_overlap_of_molecules(scene, &cell, &positions)?;
            let beginning = Beginning {
                cell,
                positions,
                velocities: None,
                relax: false,
            };
            Ok((beginning, Vec::new()))
        }
        Start::Configuration { path, geometry } => {
            let given = match geometry {
                Some(Geometry::Box(sides)) => {
                    Some(PeriodicBox::new(DVec3::from_array(*sides)).map_err(|e| {
                        scene
                            .source
                            .invalid("system.box", e, "finite positive lengths")
                    })?)
                }
                Some(Geometry::Density(_)) | None => None,
            };
            // Read without the scene's box first: where both name one and they differ, the scene is to blame.
            let read = match lennard_io::read_configuration(path) {
                Err(_) if given.is_some() => lennard_io::read_configuration_in(path, given)?,
                read => read?,
            };
            let remarks = remarks(path, &read);
            let mut beginning = from_configuration(scene, path, read, given)?;
            place_between_walls(scene, &beginning.cell, &mut beginning.positions)?;
            Ok((beginning, remarks))
        }
    }
}

/// Number of particles and their density in σ⁻³, as the scene's start has them; reads the file of a `configuration`.
///
/// # Errors
/// [`EngineError`] where the start cannot be made.
pub fn size_and_density(scene: &Scene) -> Result<(usize, f64), EngineError> {
    let (n, cell) = match (&scene.system.start, scene.placement()?) {
        (Start::Lattice { n_atoms, .. }, Some(placement)) => {
            (*n_atoms * scene.molecules().sites(), placement.cell)
        }
        _ => {
            let beginning = begin(scene)?;
            (beginning.positions.len(), beginning.cell)
        }
    };
    Ok((n, n as f64 / cell.volume()))
}

/// What is to be known of a start that was read from a file.
fn remarks(path: &Path, read: &StartConfiguration) -> Vec<String> {
    let file = path.display();
    let frame =
        (read.frames > 1).then(|| format!("the start is frame {0} of {0} of {file}", read.frames));
    let drift = read.velocities.as_deref().and_then(|velocities| {
        let system = System::atoms(velocities.len());
        initial::Drift::of(&system, velocities).map(|drift| drift.in_words(&file.to_string()))
    });
    frame.into_iter().chain(drift).collect()
}

fn from_configuration(
    scene: &Scene,
    path: &Path,
    read: StartConfiguration,
    given: Option<PeriodicBox>,
) -> Result<Beginning, EngineError> {
    if let Some(given) = given
        && given != read.cell
    {
        let sides = given.lengths().to_array();
        let found = format!(
            "{sides:?}, where {} has {:?}",
            path.display(),
            read.cell.lengths().to_array()
        );
        return Err(scene
            .source
            .invalid(
                "system.box",
                found,
                "the box of the file, or no `box` at all",
            )
            .into());
    }
    let mut read = read;
    take_molecules(scene, path, &mut read)?;
    let exclusions = scene.molecules().exclusions();
    if let Some(pair) = closest_pair(
        &read.cell,
        &read.positions,
        exclusions,
        SMALLEST_START_DISTANCE,
    ) {
        let found = format!(
            "particles {} and {} of {} at a distance of {:.4} σ (counted from 1)",
            pair.i + 1,
            pair.j + 1,
            path.display(),
            pair.distance
        );
        let allowed = format!("no pair nearer than {SMALLEST_START_DISTANCE} σ");
        return Err(scene
            .source
            .invalid("system.configuration", found, allowed)
            .into());
    }
    Ok(Beginning {
        cell: read.cell,
        positions: read.positions,
        velocities: read.velocities,
        relax: false,
    })
}

/// Checks that a file has whole molecules with bonds of the right length, and moves the sites of each together.
fn take_molecules(
    scene: &Scene,
    path: &Path,
    read: &mut StartConfiguration,
) -> Result<(), EngineError> {
    let molecules = scene.molecules();
    if molecules.are_atoms() {
        return Ok(());
    }
    let (n, sites) = (read.positions.len(), molecules.sites());
    let refuse = |found: String, allowed: String| -> EngineError {
        let key = "system.configuration";
        scene.source.invalid(key, found, allowed).into()
    };
    if !n.is_multiple_of(sites) {
        return Err(refuse(
            format!("{n} particles in {}", path.display()),
            format!("a multiple of molecule.sites = {sites}"),
        ));
    }
    initial::unfold_molecules(&read.cell, sites, &mut read.positions);
    if !molecules.are_rigid() {
        return Ok(());
    }
    /// Bonds of a file may be off by this share: the first step brings them to their length.
    const LARGEST_STRAIN: f64 = 1e-3;
    let wanted = molecules.bond_length();
    for (m, molecule) in read.positions.chunks(sites).enumerate() {
        for (k, pair) in molecule.windows(2).enumerate() {
            let length = (pair[1] - pair[0]).length();
            if (length / wanted - 1.0).abs() > LARGEST_STRAIN {
                let first = m * sites + k + 1;
                return Err(refuse(
                    format!(
                        "a bond of {length:.6} σ between particles {first} and {} of {} (counted from 1)",
                        first + 1,
                        path.display()
                    ),
                    format!("molecule.bond_length = {wanted} σ, within 0.1 %"),
                ));
            }
        }
    }
    Ok(())
}

/// Refuses a lattice of molecules whose sites overlap.
fn refuse_overlap_of_molecules(
    scene: &Scene,
    cell: &PeriodicBox,
    positions: &[DVec3],
) -> Result<(), EngineError> {
    let molecules = scene.molecules();
    if molecules.are_atoms() {
        return Ok(());
    }
    /// U(0.8 σ) is 43 ε: nearer sites of a lattice would heat the fluid beyond use.
    const SMALLEST_ON_A_LATTICE: f64 = 0.8;
    let within = SMALLEST_ON_A_LATTICE;
    match closest_pair(cell, positions, molecules.exclusions(), within) {
        None => Ok(()),
        Some(pair) => Err(scene
            .source
            .invalid(
                "molecule.bond_length",
                format!(
                    "sites {} and {} of the lattice at a distance of {:.4} σ (counted from 1)",
                    pair.i + 1,
                    pair.j + 1,
                    pair.distance
                ),
                format!(
                    "no pair nearer than {within} σ: a lower density, shorter bonds, or lattice = \"sc\" for chains"
                ),
            )
            .into()),
    }
}

/// The temperature and step for which the list is laid out: the hottest of all stages and the largest
/// of all steps, since the list must serve them all.
#[must_use]
pub fn conditions(scene: &Scene, cell: PeriodicBox, n_atoms: usize) -> Conditions {
    let measured: Vec<&Stage> = scene.stages.iter().filter(|s| s.measure).collect();
    let stages: Vec<&Stage> = if measured.is_empty() {
        scene.stages.iter().collect()
    } else {
        measured
    };
    let temperature = stages.iter().map(|s| s.temperature).fold(0.0, f64::max);
    let dt = stages.iter().map(|s| scene.stage_dt(s)).fold(0.0, f64::max);
    Conditions {
        cell,
        n_atoms,
        temperature,
        dt,
    }
}

/// The force field of a scene for a box.
///
/// # Errors
/// [`EngineError::Scene`] where cutoff or skin do not fit the box, and where the settings for an accuracy have
/// not been chosen.
pub fn forces(
    scene: &Scene,
    cell: PeriodicBox,
    n_atoms: usize,
) -> Result<(ForceFieldOptions, PairForces), EngineError> {
    scene.settled()?;
    let options = scene.force_field();
    let built = lennard_forcefield::build(&options, &conditions(scene, cell, n_atoms))
        .map_err(|e| misfit(&scene.source, &e))?;
    Ok((options, built))
}

/// Builds the simulation: particles placed, relaxed where the start is random, velocities drawn
/// where the start has none.
///
/// # Errors
/// [`EngineError`] for everything about the scene that can only be seen now.
pub fn prepare(scene: Scene) -> Result<Simulation, EngineError> {
    let (beginning, remarks) = begin_with_remarks(&scene)?;
    let mut simulation = prepare_from(scene, beginning)?;
    simulation.remarks.splice(0..0, remarks);
    Ok(simulation)
}

/// Builds the simulation around particles that have their places, whatever start the scene names.
///
/// # Errors
/// As [`prepare`].
pub fn prepare_from(scene: Scene, mut beginning: Beginning) -> Result<Simulation, EngineError> {
    let n = beginning.positions.len();
    let cell = beginning.cell;
    let (options, provider) = forces(&scene, cell, n)?;
    let remarks = pressure::foresee(&scene, &cell, n, provider.plan().skin)?;
    if beginning.relax {
        relax(&scene, cell, &mut beginning.positions)?;
    }
    let system = System::of_molecules(n, scene.molecules());
    let confinement = Confinement::of(&scene, &cell, &system.masses);
    let system = system.pushed_along(confinement.properties().breaks_momentum);
    let streams = Streams::new(scene.system.seed);
    let velocities = match beginning.velocities {
        Some(mut given) => {
            rigid::project_velocities(&system, &beginning.positions, &mut given);
            initial::remove_drift(&system, &mut given);
            given
        }
        None => initial::thermal_velocities(
            &system,
            &beginning.positions,
            scene.system.temperature,
            streams,
        ),
    };
    let observers = observers(&scene, &confinement, cell, n)?;
    let isa = provider.plan().isa.to_string();
    let all_pairs = AllPairs::new(&options).map_err(|e| misfit(&scene.source, &e))?;
    let forces = with_springs(&scene, confinement.beside(provider));
    Ok(Simulation {
        state: State::new(cell, beginning.positions, velocities),
        scene,
        system,
        start_cell: cell,
        forces: Box::new(forces),
        force_check: ForceCheck::new(all_pairs),
        force_field: options,
        streams,
        stage: None,
        observers,
        measured_steps: 0,
        remarks,
        timers: Timers::default(),
        isa,
    })
}

/// Adds the springs that hold bonds, where the scene has some.
pub(crate) fn with_springs<B: Backend>(scene: &Scene, mut forces: ForceSum<B>) -> ForceSum<B> {
    if let Some(molecule) = &scene.molecule
        && let BondHolder::Spring(term) = molecule.bonds.build(&molecule.molecules())
    {
        forces.push(term);
    }
    forces
}

/// Relaxes a random start until nothing overlaps, in double precision whatever the scene runs in: of two that lie nearly on top of
/// each other the force is no number in single precision.
fn relax(scene: &Scene, cell: PeriodicBox, positions: &mut [DVec3]) -> Result<(), EngineError> {
    let mut relaxing = scene.clone();
    relaxing.kernel.precision = Precision::Double;
    let (_, mut provider) = forces(&relaxing, cell, positions.len())?;
    fire::relax(&cell, positions, &mut provider, &FireOptions::default())
        .map(|_| ())
        .map_err(|e| {
            scene
                .source
                .invalid(
                    "system.lattice",
                    format!("`random`, which could not be relaxed: {e}"),
                    "a lattice, or a lower density",
                )
                .into()
        })
}

/// The observables of a scene: thermodynamics, which every run has, and then the others that it names.
fn observers(
    scene: &Scene,
    confinement: &Confinement,
    cell: PeriodicBox,
    n_atoms: usize,
) -> Result<Vec<Observer>, EngineError> {
    let mut measured = scene.stages.iter().rev().filter(|s| s.measure);
    let measured = measured.next().or(scene.stages.last());
    let dt = measured.map_or(scene.integrator.dt, |s| scene.stage_dt(s));
    let context = |every| BuildContext {
        cell,
        n_atoms,
        dt,
        every,
        r_cut: scene.truncation.r_cut,
        molecules: scene.molecules(),
    };
    let of_thermodynamics = |table: &ObservableTable| match &table.options {
        ObservableOptions::Thermodynamics(options) => Some(options.clone()),
        _ => None,
    };
    let options = scene.observables.iter().find_map(of_thermodynamics);
    let mut options = options.unwrap_or_default();
    if scene.molecules().are_rigid() {
        // Constraint forces are no gradient of a potential: ⟨|∇U|²⟩/⟨∇²U⟩ is no temperature.
        options.configurational_temperature = false;
    }
    let every = scene.output.thermo_every;
    let mut thermodynamics = Thermodynamics::with_options(&options, &context(every));
    thermodynamics.set_force_jump(force_jump(scene)?);
    thermodynamics.set_ensemble(measured.and_then(|stage| ensemble(scene, stage)));
    thermodynamics.set_bath(held_temperature(scene));
    thermodynamics.set_confined(scene.confined_by().map(|_| Confined {
        by_hits: confinement.properties().bounds_flight,
    }));
    let mut observers = vec![Observer {
        every,
        observable: Box::new(thermodynamics),
    }];
    let keeps_motion = measured_baths(scene).iter().all(|bath| bath.keeps_motion);
    for (index, table) in scene.observables.iter().enumerate() {
        let mut options = table.options.clone();
        match &mut options {
            ObservableOptions::Thermodynamics(_) => continue,
            // With friction there is no flow around a particle that a closed box could slow down.
            ObservableOptions::Msd(o) if o.viscosity.is_none() && keeps_motion => {
                o.viscosity = compare::viscosity_for(scene, n_atoms as f64 / cell.volume());
            }
            _ => {}
        }
        let observable =
            lennard_observables::build(&options, &context(table.every)).map_err(|e| {
                scene.source.invalid(
                    &format!("observable.{index}.{}", e.key()),
                    e.found(),
                    e.allowed(),
                )
            })?;
        observers.push(Observer {
            every: table.every,
            observable,
        });
    }
    // The last, so that the others stand as in the scene.
    if let Some(pressure) = measured_pressure(scene) {
        observers.push(Observer {
            every,
            observable: Box::new(ChangingBox::new(pressure)),
        });
    }
    Ok(observers)
}

/// U′(r_cut) just inside the cutoff, where the force drops to zero with a jump (plain and shifted
/// cutoffs); zero where the force is continuous.
fn force_jump(scene: &Scene) -> Result<f64, EngineError> {
    let model =
        Model::new(&scene.potential, &scene.truncation).map_err(|e| misfit(&scene.source, &e))?;
    let pair = model.eval(model.r_cut * model.r_cut);
    Ok(-pair.force * model.r_cut)
}

/// As many threads as pay for so many particles on this machine.
#[must_use]
pub fn recommended_threads(n_atoms: usize) -> usize {
    let available = lennard_core::parallel::processors();
    lennard_forcefield::recommended_threads(n_atoms, available)
}
