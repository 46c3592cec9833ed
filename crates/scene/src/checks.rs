//! What must hold between tables: rows of features that do not go together, and numbers that must fit each other.

use lennard_core::number::short;
use lennard_core::options::MOST_STEPS;
use lennard_core::options::quoted;
use lennard_core::{Axis, PeriodicBox};
use lennard_forcefield::SHALLOWEST_ROOM;
use lennard_integrators::Response;
use lennard_integrators::{spook, thermostats};
use lennard_io::Limits;

use crate::{Arrangement, MoleculeKind, PressureControl, Scene, SceneError, Stage};

mod features;
mod rules;

/// The fewest relaxation times of the volume's proposals: below, the box jumps by more than it fluctuates.
const FEWEST_INTERVALS: f64 = 20.0;

/// ω·h of the spring of a wall up to which a hit changes the energy by less than 10⁻⁴ on average.
const ACCURATE_PHASE: f64 = 0.2;

impl Scene {
    /// Whether all tables go together, for a scene that was changed after it was read. It checks stages and tail
    /// correction. Where the scene itself names the box, it checks that cutoff, skin and observables fit.
    ///
    /// # Errors
    /// [`SceneError`] for the first thing that is wrong; never for a scene as it was read.
    pub fn check(&self) -> Result<(), SceneError> {
        whole_scene(self)?;
        measures(self)
    }

    /// Whether several ranks can run the scene.
    ///
    /// # Errors
    /// [`SceneError`] for the first thing that one process alone runs.
    pub fn check_for_ranks(&self) -> Result<(), SceneError> {
        rules::check_for_ranks(self)
    }
}

/// Everything that can be said before a configuration file is read.
pub(crate) fn whole_scene(scene: &Scene) -> Result<(), SceneError> {
    stages(scene)?;
    steps_of_spook(scene)?;
    trajectory_steps(scene)?;
    bodies(scene)?;
    rules::check(scene)?;
    molecules(scene)?;
    barostats(scene)?;
    walls(scene)?;
    springs(scene)?;
    if let Some(placement) = scene.placement()? {
        fits(scene, placement.cell, scene.n_particles().unwrap_or(0))?;
    }
    Ok(())
}

fn stages(scene: &Scene) -> Result<(), SceneError> {
    let mut total: u64 = 0;
    for (i, stage) in scene.stages.iter().enumerate() {
        let key = |key: &str| format!("stage.{i}.{key}");
        if let Some(first) = scene.stages[..i].iter().position(|s| s.name == stage.name) {
            let first = format!("stage.{first}.name");
            return Err(scene.source.twice(&key("name"), &stage.name, &first));
        }
        total = total.saturating_add(stage.steps);
        if total > MOST_STEPS as u64 {
            return Err(scene
                .refuse(&key("steps"), "makes the run too long")
                .found(format!("{total} steps up to the end of this stage"))
                .allowed(format!("at most {MOST_STEPS} in all stages together")));
        }
        if stage.thermostat.is_some() && stage.temperature <= 0.0 {
            return Err(scene
                .refuse(&key("thermostat"), "has no temperature to hold")
                .found(format!("temperature {}", stage.temperature))
                .allowed("a `temperature` above 0, of this stage or of the system"));
        }
    }
    let mut measured = scene.stages.iter().enumerate().filter(|(_, s)| s.measure);
    let Some((_, first)) = measured.next() else {
        return Ok(());
    };
    for (i, stage) in measured {
        let alike = scene.stage_dt(stage) == scene.stage_dt(first)
            && stage.thermostat == first.thermostat
            && stage.barostat == first.barostat
            && stage.exchange == first.exchange
            && stage.temperature_from == first.temperature_from
            && (stage.thermostat.is_none() || stage.temperature == first.temperature);
        if !alike {
            return Err(scene.refuse(&format!("stage.{i}.measure"), "would pool samples of unlike stages")
                .found(format!(
                    "stages {:?} and {:?}, both measured, that differ in dt, thermostat, barostat, exchange or temperature",
                    first.name, stage.name
                ))
                .allowed("measured stages that are alike in dt, thermostat, barostat, exchange and temperature"));
        }
    }
    Ok(())
}

/// Whether at least one stage is measured.
pub(crate) fn measures(scene: &Scene) -> Result<(), SceneError> {
    let refuse = |what, found: &str, allowed: &str| {
        Err(scene.refuse("stage", what).found(found).allowed(allowed))
    };
    if scene.stages.is_empty() {
        let allowed = "at least one `[[stage]]` with `name` and `steps`";
        return refuse("is missing", "no stage", allowed);
    }
    if scene.measured_stages().next().is_none() {
        let allowed = "`measure = true` in at least one stage";
        return refuse("has no measured stage", "measure = false in every stage", allowed);
    }
    Ok(())
}

/// What must hold of the method SPOOK in all stages, and of its damping.
///
/// Its velocities stand half a step behind the positions, and compliance and damping act by steps. A stage with another step would
/// begin with an error in both.
fn steps_of_spook(scene: &Scene) -> Result<(), SceneError> {
    let name = spook::SPEC.name;
    let source = &scene.source;
    for (i, stage) in scene.stages.iter().enumerate() {
        let (dt, usual) = (scene.stage_dt(stage), scene.integrator.dt);
        if dt != usual && scene.method_of(stage).spec().name == name {
            return Err(source
                .refuse(
                    &format!("stage.{i}.dt"),
                    "changes the step of a method that needs a fixed one",
                )
                .found(format!("{dt} with {name:?} and integrator.dt = {usual}"))
                .allowed(format!("{usual} in every stage, or another integrator")));
        }
    }
    for table in ["bonds", "contact"] {
        let both = ["damping_steps", "damping_time"].map(|key| format!("{table}.{key}"));
        if both.iter().all(|key| source.wrote(key)) {
            return Err(source
                .refuse(&both[1], "is given twice")
                .found(format!("`{}` and `{}`", both[0], both[1]))
                .allowed("one of them"));
        }
    }
    Ok(())
}

/// What must hold of listed and held particles.
fn bodies(scene: &Scene) -> Result<(), SceneError> {
    if let Some(n) = scene.n_particles() {
        scene.held_are_among(n)?;
    }
    let sites = scene.molecules().sites();
    if let Arrangement::Listed { positions, .. } = &scene.system.start
        && !positions.len().is_multiple_of(sites)
    {
        return Err(scene
            .refuse("start.positions", "makes no whole molecules")
            .found(format!("{} positions", positions.len()))
            .allowed(format!("a multiple of molecule.sites = {sites}")));
    }
    Ok(())
}

/// Whether bonds end below the cutoff, and fit the way they are held.
fn molecules(scene: &Scene) -> Result<(), SceneError> {
    let Some(molecule) = &scene.molecule else {
        return Ok(());
    };
    let lengths = molecule.topology.bonds().iter().map(|bond| bond.length);
    let length = lengths.fold(0.0, f64::max);
    let r_cut = scene.truncation.r_cut;
    let acts = scene.potential.own_end().is_none_or(|end| end.r > 0.0);
    if acts && length >= r_cut {
        return Err(scene
            .refuse(molecule.key_of_size(), "is not below the cutoff")
            .found(length)
            .allowed(format!("below truncation.r_cut = {r_cut}")));
    }
    let by_shape = molecule.options.kind == MoleculeKind::Sites;
    let on_lattice = matches!(scene.system.start, Arrangement::Lattice { .. });
    if by_shape && on_lattice && molecule.options.shape.is_none() {
        return Err(scene
            .refuse("molecule.shape", "is missing")
            .found("nothing, and a start on a lattice")
            .allowed("the places of the sites of one molecule, or `start.file` with a file"));
    }
    molecule.bonds.check_for(&molecule.topology).map_err(|e| {
        let refused = scene.refuse(&format!("bonds.{}", e.key), "is not allowed");
        refused.found(e.found).allowed(e.allowed)
    })
}

/// Whether each barostat has the bath and the interval that it needs.
fn barostats(scene: &Scene) -> Result<(), SceneError> {
    for (i, stage) in scene.stages.iter().enumerate() {
        if let Some(control) = &stage.barostat {
            has_its_thermostat(scene, i, stage, control)?;
            is_slow_enough(scene, i, stage, control)?;
        }
    }
    Ok(())
}

fn has_its_thermostat(
    scene: &Scene,
    index: usize,
    stage: &Stage,
    control: &PressureControl,
) -> Result<(), SceneError> {
    let spec = control.options.spec();
    let suits =
        |name: &str, canonical: bool| canonical && spec.thermostat.is_none_or(|t| t == name);
    let bath = stage.thermostat.as_ref().map(|t| t.spec());
    if bath.is_some_and(|bath| suits(bath.name, bath.canonical)) {
        return Ok(());
    }
    let all = thermostats().iter();
    let fit: Vec<&str> = all.filter(|t| suits(t.name, t.canonical)).map(|t| t.name).collect();
    Err(scene
        .refuse(
            &format!("stage.{index}.barostat"),
            "needs a thermostat that samples the canonical ensemble beside it",
        )
        .found(bath.map_or_else(
            || format!("`{}` in a stage without thermostat", spec.name),
            |bath| format!("`{}` with thermostat `{}`", spec.name, bath.name),
        ))
        .allowed(match fit.as_slice() {
            [one] => format!("thermostat = {one:?}"),
            several => format!("thermostat = one of {}", quoted(several)),
        }))
}

fn is_slow_enough(
    scene: &Scene,
    index: usize,
    stage: &Stage,
    control: &PressureControl,
) -> Result<(), SceneError> {
    let (tau, interval) = (control.options.tau(), control.options.interval());
    let shortest = FEWEST_INTERVALS * interval as f64 * scene.stage_dt(stage);
    if tau >= shortest * (1.0 - 1e-12) {
        return Ok(());
    }
    Err(scene
        .refuse(
            &format!("stage.{index}.barostat.tau"),
            "is too short for the steps between two changes of the box",
        )
        .found(format!("tau = {tau} τ with {interval} steps of {} τ", scene.stage_dt(stage)))
        .allowed(format!(
            "at least {FEWEST_INTERVALS}·interval·dt = {} τ, or a smaller `interval`",
            short(shortest)
        )))
}

/// Whether walls keep the fluid out of reach of its images, and a field has walls to end at.
fn walls(scene: &Scene) -> Result<(), SceneError> {
    let source = &scene.source;
    for (i, table) in scene.walls.iter().enumerate() {
        let smallest = scene.end_of_pairs() + SHALLOWEST_ROOM;
        if table.thickness < smallest {
            return Err(source
                .refuse(
                    &format!("wall.{i}.thickness"),
                    "brings the fluid in reach of its image across the wall",
                )
                .found(table.thickness)
                .allowed(format!("{smallest} σ or more: the cutoff and {SHALLOWEST_ROOM} σ")));
        }
    }
    for axis in Axis::ALL {
        let g = scene.acceleration[axis.index()];
        let bounded =
            scene.all_are_tethered() || scene.walls.iter().any(|table| table.axis == axis);
        let axis = axis.name();
        if g != 0.0 && !bounded {
            return Err(source
                .refuse(
                    "field.acceleration",
                    format!("has no potential along {axis}, where the box is periodic"),
                )
                .found(format!("{g} along {axis}"))
                .allowed(format!("0 along {axis}, or walls across {axis}")));
        }
    }
    Ok(())
}

/// Refuses springs of walls, contacts and bonds that are too stiff for the step of a stage.
fn springs(scene: &Scene) -> Result<(), SceneError> {
    let lightest = scene.lightest_mass();
    for (i, table) in scene.walls.iter().enumerate() {
        let Some(omega) = scene.surface(table).frequency() else {
            continue;
        };
        if let Some(step) = too_stiff(scene, omega / lightest.sqrt()) {
            return Err(step.refuse_spring(scene, &format!("wall.{i}.stiffness"), "√(k/m)").allowed(
                format!(
                    "a stiffness below {:.4e} ε/σ²; hits keep their energy to 10⁻⁴ below {:.4e} ε/σ²",
                    lightest * step.square_at(step.limit),
                    lightest * step.square_at(ACCURATE_PHASE)
                ),
            ));
        }
    }
    // Two of the lightest bodies have half the mass of one.
    let reduced = 0.5 * lightest;
    if let Some(Response::Spring(law)) =
        scene.contact.as_ref().map(|table| table.options.response())
        && let Some(omega) = law.frequency(reduced)
        && let Some(step) = too_stiff(scene, omega)
    {
        return Err(step.refuse_spring(scene, "contact.stiffness", "√(2k/m)").allowed(format!(
            "a stiffness below {:.4e} ε/σ²; bodies in a row vibrate up to √2 times as fast",
            reduced * step.square_at(step.limit)
        )));
    }
    if let Some(molecule) = &scene.molecule
        && let Some(TooStiff { stage, dt, omega, limit }) =
            too_stiff(scene, molecule.fastest_vibration())
    {
        let key = match scene.stages[stage].dt {
            Some(_) => format!("stage.{stage}.dt"),
            None => "integrator.dt".to_owned(),
        };
        return Err(scene
            .refuse(&key, "is too long for the springs")
            .found(format!("{dt}: ω·dt = {:.3}, with ω = {omega:.3} per τ", omega * dt))
            .allowed(format!("below {:.3e} τ, or softer springs", limit / omega)));
    }
    Ok(())
}

/// A stage whose step does not bear a spring: ω·h must stay below the limit of its method.
struct TooStiff {
    /// Index of the stage.
    stage: usize,
    /// Its step, τ.
    dt: f64,
    /// ω of the spring, per τ.
    omega: f64,
    /// The limit of ω·h under its method.
    limit: f64,
}

/// The first stage whose step does not bear a vibration of ω per τ.
fn too_stiff(scene: &Scene, omega: f64) -> Option<TooStiff> {
    scene.stages.iter().enumerate().find_map(|(stage, table)| {
        // A bath that stands inside the step takes the place of the integrator.
        let limit = scene.method_of(table).spec().stability_limit?;
        let dt = scene.stage_dt(table);
        (omega * dt >= limit).then_some(TooStiff { stage, dt, omega, limit })
    })
}

impl TooStiff {
    /// ω² of a spring for which ω·h is this phase, τ⁻².
    fn square_at(&self, phase: f64) -> f64 {
        (phase / self.dt).powi(2)
    }

    fn refuse_spring(&self, scene: &Scene, key: &str, formula: &str) -> SceneError {
        let Self { dt, omega, .. } = *self;
        scene.refuse(key, "is too stiff for the step").found(format!(
            "ω·dt = {:.3} with ω = {formula} = {omega:.3} per τ and dt = {}",
            omega * dt,
            short(dt)
        ))
    }
}

/// What a trajectory that rounds positions can hold; `None` where no such one is written.
fn limits_of_trajectory(scene: &Scene) -> Option<&'static Limits> {
    scene.output.trajectory_every?;
    scene.output.format.spec().limits
}

/// Whether the steps of the run can stand in the trajectory.
fn trajectory_steps(scene: &Scene) -> Result<(), SceneError> {
    let total = scene.total_steps();
    match limits_of_trajectory(scene) {
        Some(limits) if total > limits.last_step => Err(scene
            .refuse("output.format", "cannot count the steps of the run")
            .found(format!("{total} steps, with format {:?}", scene.output.format.name()))
            .allowed(format!("at most {} steps, or another format", limits.last_step))),
        _ => Ok(()),
    }
}

/// Whether positions in the box can stand in the trajectory with the precision asked for.
fn trajectory_fits(scene: &Scene, cell: PeriodicBox) -> Result<(), SceneError> {
    let side = cell.lengths().max_element();
    match limits_of_trajectory(scene).zip(scene.output.precision) {
        Some((limits, precision)) if side * precision >= limits.multiples => Err(scene
            .refuse("output.precision", "is finer than single precision in this box")
            .found(format!("{precision}, with a side of {side:.4} σ"))
            .allowed(format!("at most {:.1}", limits.multiples / side))),
        _ => Ok(()),
    }
}

/// Whether cutoff, skin, observables and trajectory fit the box.
fn fits(scene: &Scene, cell: PeriodicBox, n_atoms: usize) -> Result<(), SceneError> {
    trajectory_fits(scene, cell)?;
    // Measured stages are alike, so one stands for all.
    let measured = scene.measured_stages().next();
    let dt = measured.map_or(scene.integrator.dt, |stage| scene.stage_dt(stage));
    scene.contact_fits(&cell)?;
    let counts = scene.counts(n_atoms)?;
    let species = scene.species_in_order(&counts);
    let mixture = scene.mixture_of(&species);
    let conditions = lennard_forcefield::Conditions {
        cell,
        n_atoms,
        temperature: scene.system.temperature,
        dt,
        mixture: mixture.as_ref(),
    };
    lennard_forcefield::check(&scene.force_field(), &conditions).map_err(|e| scene.misfit(&e))?;
    for (i, table) in scene.observables.iter().enumerate() {
        let context = scene.observable_context(cell, &species, dt, table.every);
        lennard_observables::build(&table.options, &context).map_err(|e| {
            scene
                .refuse(&format!("observable.{i}.{}", e.key()), "is not allowed")
                .found(e.found())
                .allowed(e.allowed())
        })?;
    }
    Ok(())
}
