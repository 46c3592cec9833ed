//! What takes the homogeneity of a fluid away: walls, fields, held particles, contacts and planar tails.

use lennard_core::options::upper_bound;
use lennard_core::random::Streams;
use lennard_core::{DVec3, Masses, PeriodicBox, SpeciesTable};
use lennard_forcefield::{ConstantField, SlitPlanes, Surface, WallContext, WallPair, Walls};
use lennard_integrators::{Bodies, Contacts, Response};

use crate::tables::PLANAR;
use crate::tables::walls::FieldKeys;
use crate::{Scene, SceneError, WallTable};

impl Scene {
    /// What takes the fluid's homogeneity away, in words with the key of each.
    pub(crate) fn confining(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let all = [
            (!self.walls.is_empty(), "wall", "walls"),
            (
                self.acceleration != DVec3::ZERO || !self.program.fields.is_empty(),
                "field",
                "a field",
            ),
            (!self.system.held.is_empty(), "system.held", "held particles"),
        ];
        all.into_iter().filter_map(|(there, key, words)| there.then_some((key, words)))
    }

    /// What takes the fluid's homogeneity away, in words; `None` where it is periodic along all axes, in no field and free to move.
    #[must_use]
    pub fn confined_by(&self) -> Option<String> {
        let words: Vec<&str> = self.confining().map(|(_, words)| words).collect();
        match words.split_last()? {
            (last, []) => Some((*last).to_owned()),
            (last, others) => Some(format!("{} and {last}", others.join(", "))),
        }
    }

    /// Refuses molecules, contacts, and a fluid between walls or in a field, for a study of homogeneous fluids of atoms.
    ///
    /// # Errors
    /// [`SceneError`] with the table that confines the fluid.
    pub fn homogeneous_for(&self, study: &str) -> Result<(), SceneError> {
        const OF_ATOMS: &str = "a scene of atoms, without walls and field";
        self.unconfined_for(study, OF_ATOMS)?;
        match self.molecule {
            Some(_) => Err(self.not_for(study, "molecule", "molecules", OF_ATOMS)),
            None => Ok(()),
        }
    }

    /// Refuses contacts, and a fluid between walls or in a field, for a study of homogeneous fluids; `allowed` says of which.
    ///
    /// # Errors
    /// [`SceneError`] with the table that confines the fluid.
    pub fn unconfined_for(&self, study: &str, allowed: &str) -> Result<(), SceneError> {
        self.planar_tail_for(study)?;
        match (self.confining().next(), self.confined_by()) {
            (Some((key, _)), Some(found)) => Err(self.not_for(study, key, &found, allowed)),
            _ if self.contact.is_some() => Err(self.not_for(study, "contact", "contacts", allowed)),
            _ => Ok(()),
        }
    }

    fn not_for(&self, study: &str, key: &str, found: &str, allowed: &str) -> SceneError {
        self.refuse(key, format!("does not go with `{study}`"))
            .found(format!("a fluid with {found}"))
            .allowed(allowed)
    }

    /// The contact distance of two species, σ; 0 where bodies do not touch.
    #[must_use]
    pub fn contact_distance(&self, a: usize, b: usize) -> f64 {
        let diameter = self.contact.as_ref().map_or(0.0, |table| table.diameter);
        diameter * self.species_pair(a, b).sigma
    }

    /// The largest contact distance of all pairs of species, σ; 0 where bodies do not touch.
    #[must_use]
    pub fn largest_contact(&self) -> f64 {
        match self.contact {
            None => 0.0,
            Some(_) => {
                (self.species_pairs()).map(|[a, b]| self.contact_distance(a, b)).fold(0.0, f64::max)
            }
        }
    }

    /// Whether contacts are solved for in the step of SPOOK.
    #[must_use]
    pub fn solves_contacts(&self) -> bool {
        let response = self.contact.as_ref().map(|table| table.options.response());
        matches!(response, Some(Response::Unilateral(_)))
    }

    /// Whether contacts act in flights: their impulses are then in no virial.
    #[must_use]
    pub fn contacts_act_in_flight(&self) -> bool {
        let response = self.contact.as_ref().map(|table| table.options.response());
        response.is_some_and(|response| response.acts_in_flight())
    }

    /// The contacts between particles of these species; `None` where the scene has none.
    #[must_use]
    pub fn contacts_of(&self, species: &SpeciesTable) -> Option<Contacts> {
        let table = self.contact.as_ref()?;
        let exclusions = self.molecules().exclusions();
        let bodies = match species.is_mixture() {
            false => Bodies::alike(self.contact_distance(0, 0), exclusions),
            true => {
                Bodies::of_species(species.clone(), |a, b| self.contact_distance(a, b), exclusions)
            }
        };
        Some(Contacts::new(table.options.response(), bodies))
    }

    /// Whether the contacts fit a box: a body touches one image of another at most.
    ///
    /// # Errors
    /// [`SceneError`] where the largest contact distance exceeds half the shortest side.
    pub fn contact_fits(&self, cell: &PeriodicBox) -> Result<(), SceneError> {
        let (found, largest) = (self.largest_contact(), cell.largest_cutoff());
        if found <= largest {
            return Ok(());
        }
        Err(self
            .refuse("contact.diameter", "exceeds half the shortest box side")
            .found(format!("bodies that touch at {found} σ"))
            .allowed(format!("at most {} σ, or a larger box", upper_bound(largest))))
    }

    /// The contacts in words, at the end of a model's name.
    pub(crate) fn contacts_in_words(&self) -> Option<String> {
        let table = self.contact.as_ref()?;
        let unit = if self.mixture.is_some() { "σ_ab" } else { "σ" };
        let words = table.options.in_words();
        Some(format!("{words}, at {} {unit}", table.diameter))
    }
}

/// The key.
pub(crate) const KEY: &str = "truncation.tail_correction";

impl Scene {
    /// Refuses a planar tail for a study of homogeneous fluids.
    pub(crate) fn planar_tail_for(&self, study: &str) -> Result<(), SceneError> {
        if !self.planar_tail {
            return Ok(());
        }
        Err(self
            .refuse(KEY, format!("does not go with `{study}`"))
            .found(format!("\"{PLANAR}\""))
            .allowed("a homogeneous fluid, with true or false"))
    }

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
