//! The tables `[[wall]]` and `[field]`: what confines a fluid, and what must hold of it.

use lennard_core::number::short;
use lennard_core::random::Streams;
use lennard_core::{Axis, DVec3, Integrator, Masses, PeriodicBox};
use lennard_forcefield::{
    ConstantField, HitRule, SHALLOWEST_ROOM, SlitPlanes, Surface, WallContext, WallOptions,
    WallPair, Walls,
};
use lennard_observables::Surroundings;
use toml::Value;

use crate::error::SceneError;
use crate::integrator::kinds_that;
use crate::read::Reader;
use crate::reference::LONGEST_SIDE;
use crate::section::Section;
use crate::stiff::TooStiff;
use crate::{Lattice, Scene, Start};

/// What the walls take of the box along their axis beyond the cutoff, σ, where the scene does not say.
const DEFAULT_ROOM: f64 = 1.0;

/// ω·h of the spring of a wall up to which a hit changes the energy by less than 10⁻⁴ on average.
const ACCURATE_PHASE: f64 = 0.2;

/// A table `[[wall]]`: walls at both ends of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct WallTable {
    /// The axis of the normal.
    pub axis: Axis,
    /// Length of the box along the axis behind the planes, σ: the distance between the images of the fluid.
    pub thickness: f64,
    /// The walls with their own keys.
    pub options: WallOptions,
}

lennard_core::options! {
    /// The keys of `[[wall]]` that all kinds have.
    pub(crate) struct WallKeys {
        /// The axis across which the walls stand.
        axis: Axis = Axis::Z, Names(Axis::names);
        /// Length of the box behind the planes, which keeps the fluid out of reach of its images; at least `r_cut` + 0.1.
        thickness: Option<f64> = None, else "`r_cut` + 1.0", Between(1e-6, LONGEST_SIDE), in "σ";
    }
}

lennard_core::options! {
    /// The keys of `[field]`.
    pub(crate) struct FieldKeys {
        /// Acceleration of every particle.
        acceleration: Vec<f64> = vec![0.0; 3], Words("three finite numbers [gx, gy, gz]; 0 along an axis without walls"), in "σ/τ²";
    }
}

impl From<&WallTable> for WallKeys {
    fn from(table: &WallTable) -> Self {
        Self { axis: table.axis, thickness: Some(table.thickness) }
    }
}

impl Reader<'_> {
    /// The walls, for forces that end at `r_cut`.
    pub fn walls(&self, r_cut: f64) -> Result<Vec<WallTable>, SceneError> {
        let mut walls: Vec<WallTable> = Vec::new();
        for (i, table) in self.list("wall")?.into_iter().enumerate() {
            let path = format!("wall.{i}");
            let section = Section::new(self.source, &path, "wall");
            let mut table = table.clone();
            let WallKeys { axis, thickness } = section.take(&mut table)?;
            let options = section.method(&table)?;
            if let Some(first) = walls.iter().position(|other| other.axis == axis) {
                let first = format!("wall.{first}.axis");
                let twice = self.source.twice(&section.name("axis"), axis.name(), &first);
                return Err(twice);
            }
            walls.push(WallTable {
                axis,
                thickness: thickness.unwrap_or(r_cut + DEFAULT_ROOM),
                options,
            });
        }
        Ok(walls)
    }

    /// The acceleration of the constant field, σ/τ²; zero without one.
    pub fn field(&self) -> Result<DVec3, SceneError> {
        let section = self.section("field");
        let table = self.table("field");
        let is_vector = |value: &Value| {
            let vector: Result<[f64; 3], _> = value.clone().try_into();
            vector.is_ok_and(|g| g.iter().all(|x| x.is_finite()))
        };
        // A number alone is refused as a vector, whatever its sign.
        if let Some(written) = table.get("acceleration").filter(|value| !is_vector(value)) {
            return Err(section.not_allowed("acceleration", written));
        }
        let keys: FieldKeys = section.read(table)?;
        Ok(DVec3::from_slice(&keys.acceleration))
    }
}

impl Scene {
    /// The constant field as its table says it; `None` without one.
    pub(crate) fn field_keys(&self) -> Option<FieldKeys> {
        (self.acceleration != DVec3::ZERO)
            .then(|| FieldKeys { acceleration: self.acceleration.to_array().to_vec() })
    }

    /// Where pair forces and contacts end, σ: the longest cutoff of two species, or the largest contact distance.
    pub(crate) fn end_of_pairs(&self) -> f64 {
        self.longest_cutoff().max(self.largest_contact())
    }

    /// The walls of this scene in a box; `None` where it has none.
    #[must_use]
    pub fn walls_in(&self, cell: &PeriodicBox) -> Option<Walls> {
        let context = self.context_of_walls();
        let pairs = self
            .walls
            .iter()
            .map(|table| WallPair::new(&table.options, self.planes(table, cell), &context));
        let noise = Streams::new(self.system.seed).noise("walls");
        (!self.walls.is_empty()).then(|| Walls::new(pairs.collect(), noise))
    }

    fn context_of_walls(&self) -> WallContext {
        WallContext { temperature: self.system.temperature }
    }

    /// What the walls of a table do to a particle, at the lower end.
    pub(crate) fn surface(&self, table: &WallTable) -> Surface {
        table.options.surface(&self.context_of_walls(), false)
    }

    /// The planes of each pair of walls in a box.
    #[must_use]
    pub fn slits(&self, cell: &PeriodicBox) -> Vec<SlitPlanes> {
        let tables = self.walls.iter();
        tables.map(|table| self.planes(table, cell)).collect()
    }

    fn planes(&self, table: &WallTable, cell: &PeriodicBox) -> SlitPlanes {
        let r_cut = self.end_of_pairs();
        SlitPlanes::new(cell, table.axis.index(), table.thickness, r_cut)
    }

    /// The field of this scene for particles of these masses; `None` where it has none.
    #[must_use]
    pub fn field_on(&self, masses: &Masses) -> Option<ConstantField> {
        let g = self.acceleration;
        (g != DVec3::ZERO).then(|| ConstantField::new(g, masses.clone()))
    }

    /// What the walls add to the box and to the lower corner of the filled part, σ; a lattice stands clear of them.
    pub(crate) fn room_of_walls(&self, is_lattice: bool) -> (DVec3, DVec3) {
        let (mut sides, mut corner) = (DVec3::ZERO, DVec3::ZERO);
        for table in &self.walls {
            let axis = table.axis.index();
            let clearance = match is_lattice {
                true => self.surface(table).clearance(),
                false => 0.0,
            };
            sides[axis] += table.thickness + 2.0 * clearance;
            corner[axis] += 0.5 * table.thickness + clearance;
        }
        (sides, corner)
    }
}

/// Refuses observables that mean nothing in these surroundings.
fn observables_suit(scene: &Scene) -> Result<(), SceneError> {
    for (i, table) in scene.observables.iter().enumerate() {
        let (message, allowed) = match (table.options.surroundings(), scene.confined_by()) {
            (Surroundings::Walls, _) if scene.walls.is_empty() => {
                ("measures walls, and the scene has none", "a scene with `[[wall]]`")
            }
            (Surroundings::Periodic, Some(_)) => {
                ("assumes a homogeneous fluid", "a scene without walls and field")
            }
            _ => continue,
        };
        return Err(scene
            .source
            .refuse(&format!("observable.{i}.kind"), message)
            .found(format!("{:?}", table.options.name()))
            .allowed(allowed));
    }
    Ok(())
}

/// What must hold of walls and field beside the other tables.
pub(crate) fn check(scene: &Scene) -> Result<(), SceneError> {
    observables_suit(scene)?;
    let Some(confined) = scene.confined_by() else {
        return Ok(());
    };
    let confined = confined.as_str();
    let source = &scene.source;
    for (i, stage) in scene.stages.iter().enumerate() {
        if stage.barostat.is_some() {
            return Err(source
                .refuse(&format!("stage.{i}.barostat"), "needs a homogeneous fluid")
                .found(format!("a barostat with {confined}"))
                .allowed("a scene without walls and field, or a fixed box"));
        }
    }
    if scene.accuracy.is_some() {
        return Err(source
            .refuse("accuracy", "is judged in a homogeneous fluid")
            .found(format!("a fluid with {confined}"))
            .allowed("a scene without walls and field, or settings written by hand"));
    }
    if scene.truncation.tail_correction {
        let key = "truncation.tail_correction";
        let first = scene.confining().next().map_or(key, |(key, _)| key);
        let (found, place) = match source.wrote(key) {
            true => ("true", key),
            false => ("true, the default with kind \"cut\"", first),
        };
        return Err(source
            .refuse(key, "assumes a homogeneous fluid")
            .at(source.place(place).cloned())
            .found(format!("{found}, with {confined}"))
            .allowed("false with walls, a field or held particles"));
    }
    if let Start::Lattice { lattice, vacuum, .. } = &scene.system.start
        && !scene.walls.is_empty()
    {
        if *vacuum > 0.0 {
            return Err(source
                .refuse("system.vacuum", "does not go with walls")
                .found(vacuum)
                .allowed("0: the walls make the box longer by their `thickness`"));
        }
        if *lattice == Lattice::Random {
            return Err(source
                .refuse("system.lattice", "does not go with walls")
                .found("\"random\", whose relaxation knows no walls")
                .allowed("\"fcc\", \"sc\" or \"bcc\""));
        }
    }
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
        hard_walls_suit(scene, i, table)?;
        springs_are_stable(scene, i, table)?;
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

/// Refuses walls whose spring is too stiff for the step of a stage: ω·h must stay below the limit of the method.
fn springs_are_stable(scene: &Scene, i: usize, table: &WallTable) -> Result<(), SceneError> {
    let Some(omega) = scene.surface(table).frequency() else {
        return Ok(());
    };
    let lightest = scene.lightest_mass();
    let omega = omega / lightest.sqrt();
    let Some(TooStiff { dt, limit, .. }) = scene.too_stiff(omega) else {
        return Ok(());
    };
    Err(scene
        .source
        .refuse(&format!("wall.{i}.stiffness"), "is too stiff for the step")
        .found(format!(
            "ω·dt = {:.3} with ω = √(k/m) = {omega:.3} per τ and dt = {}",
            omega * dt,
            short(dt)
        ))
        .allowed(format!(
            "a stiffness below {:.4e} ε/σ²; hits keep their energy to 10⁻⁴ below {:.4e} ε/σ²",
            lightest * (limit / dt).powi(2),
            lightest * (ACCURATE_PHASE / dt).powi(2)
        )))
}

/// Refuses walls that are hit under a method or a start that does not suit their flight.
fn hard_walls_suit(scene: &Scene, i: usize, table: &WallTable) -> Result<(), SceneError> {
    let surface = scene.surface(table);
    if scene.solves_contacts() {
        return Ok(());
    }
    if surface.rule() == Some(HitRule::ByContacts) {
        return Err(without_contacts_of_spook(scene, i));
    }
    let (rule, message) = match (surface.rule(), surface.dashpot()) {
        (Some(rule), _) => (rule, "is hit in drifts of a kind that the method does not make"),
        (None, Some(_)) => {
            (HitRule::OnLines, "has a dashpot, which acts in drifts that the method does not make")
        }
        (None, None) => return Ok(()),
    };
    let suits = |integrator: &Integrator| {
        let kicks = integrator.spec().is_kick_drift_kick || !rule.needs_kick_drift_kick();
        integrator.takes_hard_walls() && kicks
    };
    for stage in &scene.stages {
        let integrator = scene.method_of(stage);
        if !suits(&integrator) {
            return Err(scene
                .source
                .refuse(&format!("wall.{i}.kind"), message)
                .found(format!("{:?} with {:?}", table.options.spec().name, integrator.spec().name))
                .allowed(format!(
                    "{}, or a wall that only exerts a force",
                    kinds_that(|entry| suits(&entry.build()))
                )));
        }
    }
    let is_single = scene.system.start.count() == Some(1);
    if rule == HitRule::OnParabolas && !is_single {
        return Err(scene
            .source
            .refuse(&format!("wall.{i}.response"), "is for one particle in a constant field alone")
            .found("\"event\" with other particles")
            .allowed("\"billiard\", or `system.n_atoms` = 1"));
    }
    Ok(())
}

/// What is said of planes that contacts are to solve for, where no contacts of SPOOK are.
fn without_contacts_of_spook(scene: &Scene, i: usize) -> SceneError {
    let found = match &scene.contact {
        Some(table) => format!("\"contact\" with [contact] kind = {:?}", table.options.spec().name),
        None => "\"contact\" without `[contact]`".to_owned(),
    };
    scene
        .source
        .refuse(&format!("wall.{i}.response"), "is for planes that contacts of SPOOK solve for")
        .found(found)
        .allowed("[contact] kind = \"spook\", or response = \"billiard\"")
}
