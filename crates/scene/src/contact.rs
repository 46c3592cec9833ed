//! The table `[contact]`: bodies that touch, and what must hold of them.

use lennard_contacts::{Bodies, ContactOptions, Contacts, Response};
use lennard_core::options::upper_bound;
use lennard_core::{PeriodicBox, SpeciesTable};
use lennard_forcefield::Walls;

use crate::Scene;
use crate::error::SceneError;
use crate::read::Reader;

/// The table `[contact]`.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactTable {
    /// Distance of two centres at which bodies touch, σ; times σ_ab for two species.
    pub diameter: f64,
    /// What happens then.
    pub options: ContactOptions,
}

lennard_core::options! {
    /// The keys of `[contact]` that all kinds have.
    pub(crate) struct ContactKeys {
        /// Distance of two centres at which bodies touch; for two species it is times their σ. At most half the shortest box side.
        diameter: f64 = 1.0, Between(0.01, 100.0), in "σ";
    }
}

impl From<&ContactTable> for ContactKeys {
    fn from(table: &ContactTable) -> Self {
        Self { diameter: table.diameter }
    }
}

impl Reader<'_> {
    /// The contacts; `None` where the scene has no such table.
    pub fn contact(&self) -> Result<Option<ContactTable>, SceneError> {
        if !self.source.wrote("contact") {
            return Ok(None);
        }
        let section = self.section("contact");
        let mut table = self.table("contact").clone();
        let ContactKeys { diameter } = section.take(&mut table)?;
        let options = section.method(&table)?;
        Ok(Some(ContactTable { diameter, options }))
    }
}

impl Scene {
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

    /// The contacts between particles of these species, with the walls beside them; the walls alone where there are no contacts.
    ///
    /// # Errors
    /// The walls as they were, where the scene has no contacts.
    pub fn contacts_beside(
        &self,
        species: &SpeciesTable,
        walls: Option<Walls>,
    ) -> Result<Contacts, Option<Walls>> {
        let Some(table) = &self.contact else {
            return Err(walls);
        };
        let exclusions = self.molecules().exclusions();
        let bodies = match species.is_mixture() {
            false => Bodies::alike(self.contact_distance(0, 0), exclusions),
            true => {
                Bodies::of_species(species.clone(), |a, b| self.contact_distance(a, b), exclusions)
            }
        };
        Ok(Contacts::new(table.options.response(), bodies, walls))
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
            .source
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
