//! What must hold between tables.

use lennard_core::{DVec3, PeriodicBox};
use lennard_io::Limits;

use crate::lattice::{NoLattice, cells};
use crate::reference::{LONGEST_SIDE, MOST_STEPS};
use crate::{
    Geometry, Placement, Scene, SceneError, Start, accuracy, bath_checks, bodies, contact,
    exchange, half_crystal, integrator, mixture, molecule_checks, planar, slab, walls,
};

impl Scene {
    /// Whether all tables go together, for a scene that was changed after it was read. It checks stages and tail
    /// correction. Where the scene itself names the box, it checks that cutoff, skin and observables fit.
    ///
    /// # Errors
    /// [`SceneError`] for the first thing that is wrong; never for a scene as it was read.
    pub fn check(&self) -> Result<(), SceneError> {
        whole_scene(self)
    }

    /// The box and the part of it that particles fill at the start; `None` for a start from a configuration file. A start that the
    /// scene lists has the part between the walls.
    ///
    /// # Errors [`SceneError`] where the particles make no whole lattice or the box is impossible. A
    /// scene that was read from a file has been checked, and never fails.
    pub fn placement(&self) -> Result<Option<Placement>, SceneError> {
        let (lattice, n_atoms, geometry, vacuum) = match &self.system.start {
            Start::Lattice { lattice, n_atoms, geometry, vacuum } => {
                (Some(lattice), n_atoms, geometry, vacuum)
            }
            Start::Slab(slab) => return self.slab_placement(slab).map(Some),
            Start::HalfCrystal(start) => return self.crystal_placement(start).map(Some),
            Start::Listed { sides, positions, .. } => {
                (None, &positions.len(), &Geometry::Box(*sides), &0.0)
            }
            Start::Configuration { .. } => return Ok(None),
        };
        let (filled, key) = match geometry {
            Geometry::Density(density) => {
                let side = (*n_atoms as f64 / density).cbrt();
                (DVec3::splat(side), "system.density")
            }
            Geometry::Box(sides) => (DVec3::from_array(*sides), "system.box"),
        };
        let mut lengths = filled;
        lengths.z += vacuum;
        let (room, clear) = self.room_of_walls(lattice.is_some());
        lengths += room;
        let refuse = |found: f64| {
            let key = if filled.max_element() > LONGEST_SIDE || *vacuum == 0.0 {
                key
            } else {
                "system.vacuum"
            };
            self.source
                .refuse(key, "makes an impossible box")
                .found(format!("a side of {found:.4} σ"))
                .allowed(format!("sides above 0 and at most {LONGEST_SIDE} σ"))
        };
        for side in lengths.to_array() {
            if !(side > 0.0 && side <= LONGEST_SIDE) {
                return Err(refuse(side));
            }
        }
        let cell = PeriodicBox::new(lengths).map_err(|_| refuse(f64::NAN))?;
        let cells = match lattice {
            Some(lattice) => cells(*lattice, *n_atoms, filled)
                .map_err(|none| self.no_lattice(*n_atoms, &none))?,
            None => None,
        };
        Ok(Some(Placement {
            cell,
            corner: clear + DVec3::new(0.0, 0.0, 0.5 * vacuum),
            filled,
            cells,
        }))
    }

    fn no_lattice(&self, found: usize, none: &NoLattice) -> SceneError {
        let nearest = match (none.below, none.above) {
            (Some(below), Some(above)) => format!("{below} below, {above} above"),
            (None, Some(only)) | (Some(only), None) => only.to_string(),
            (None, None) => "none near".to_owned(),
        };
        let (key, or) = match self.molecule {
            None => ("system.n_atoms", "; or any number with lattice = \"random\""),
            Some(_) => ("system.n_molecules", ""),
        };
        self.source
            .refuse(key, "makes no whole lattice")
            .found(found)
            .allowed(format!("{}{or}", none.rule))
            .suggestion(Some(nearest))
    }
}

/// Everything that can be said before a configuration file is read.
pub(crate) fn whole_scene(scene: &Scene) -> Result<(), SceneError> {
    stages(scene)?;
    integrator::check_spook(scene)?;
    trajectory_steps(scene)?;
    mixture::check(scene)?;
    molecule_checks::check(scene)?;
    bath_checks::barostats_fit(scene)?;
    bath_checks::temperatures_are_held(scene)?;
    exchange::exchanges_fit(scene)?;
    accuracy::check(scene)?;
    bodies::check(scene)?;
    walls::check(scene)?;
    slab::check(scene)?;
    half_crystal::check(scene)?;
    contact::check(scene)?;
    planar::check(scene)?;
    if let Some(placement) = scene.placement()? {
        homogeneous(scene)?;
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
                .source
                .refuse(&key("steps"), "makes the run too long")
                .found(format!("{total} steps up to the end of this stage"))
                .allowed(format!("at most {MOST_STEPS} in all stages together")));
        }
        if stage.thermostat.is_some() && stage.temperature <= 0.0 {
            return Err(scene
                .source
                .refuse(&key("thermostat"), "has no temperature to hold")
                .found(format!("temperature {}", stage.temperature))
                .allowed("a `temperature` above 0, of this stage or of the system"));
        }
    }
    let mut measured = scene.stages.iter().enumerate().filter(|(_, s)| s.measure);
    let Some((_, first)) = measured.next() else {
        return Err(scene
            .source
            .refuse("stage", "has no measured stage")
            .found("measure = false in every stage")
            .allowed("`measure = true` in at least one stage"));
    };
    for (i, stage) in measured {
        let alike = scene.stage_dt(stage) == scene.stage_dt(first)
            && stage.thermostat == first.thermostat
            && stage.barostat == first.barostat
            && stage.exchange == first.exchange
            && stage.temperature_from == first.temperature_from
            && (stage.thermostat.is_none() || stage.temperature == first.temperature);
        if !alike {
            return Err(scene
                .source
                .refuse(&format!("stage.{i}.measure"), "would pool samples of unlike stages")
                .found(format!(
                    "stages {:?} and {:?}, both measured, that differ in dt, thermostat, barostat, exchange or temperature",
                    first.name, stage.name
                ))
                .allowed("measured stages that are alike in dt, thermostat, barostat, exchange and temperature"));
        }
    }
    Ok(())
}

fn homogeneous(scene: &Scene) -> Result<(), SceneError> {
    if let Some(surfaces) = scene.surfaces()
        && scene.truncation.tail_correction
    {
        let key = "truncation.tail_correction";
        let found = match scene.source.wrote(key) {
            true => "true",
            false => "true, the default with kind \"cut\"",
        };
        let place = match scene.source.wrote(key) {
            true => scene.source.place(key),
            false => scene.source.place(scene.key_of_surfaces()),
        };
        return Err(scene
            .source
            .refuse(key, "assumes a homogeneous fluid, and this one has surfaces")
            .at(place.cloned())
            .found(format!("{found}, with {surfaces}"))
            .allowed("\"planar\" with kind \"cut\", or false"));
    }
    Ok(())
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
            .source
            .refuse("output.format", "cannot count the steps of the run")
            .found(format!("{total} steps, with format {:?}", scene.output.format.name()))
            .allowed(format!("at most {} steps, or another format", limits.last_step))),
        _ => Ok(()),
    }
}

/// Whether positions in the box can stand in the trajectory with the precision asked for.
fn trajectory_fits(scene: &Scene, cell: PeriodicBox) -> Result<(), SceneError> {
    let precision = scene.output.precision;
    let side = cell.lengths().max_element();
    match limits_of_trajectory(scene) {
        Some(limits) if side * precision >= limits.multiples => Err(scene
            .source
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
    let measured = scene.stages.iter().find(|stage| stage.measure);
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
                .source
                .refuse(&format!("observable.{i}.{}", e.key()), "is not allowed")
                .found(e.found())
                .allowed(e.allowed())
        })?;
    }
    Ok(())
}
