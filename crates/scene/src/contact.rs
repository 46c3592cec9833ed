//! The table `[contact]`: bodies that touch, and what must hold of them.

use lennard_contacts::{Bodies, ContactOptions, Contacts, Response};
use lennard_core::number::short;
use lennard_core::options::upper_bound;
use lennard_core::{Bonds, Integrator, PeriodicBox, SpeciesTable};
use lennard_forcefield::{HitRule, Walls};
use lennard_integrators::build;

use crate::Scene;
use crate::error::SceneError;
use crate::integrator::kinds_that;
use crate::read::Reader;
use crate::stiff::TooStiff;

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

/// What must hold of contacts beside the other tables.
pub(crate) fn check(scene: &Scene) -> Result<(), SceneError> {
    let Some(table) = &scene.contact else {
        return Ok(());
    };
    let source = &scene.source;
    if scene.accuracy.is_some() {
        return Err(source
            .refuse("accuracy", "does not go with contacts")
            .found("`[accuracy]` and `[contact]`")
            .allowed(
                "settings of your own: the predictions of errors are for fluids without contacts",
            ));
    }
    spook_has_contacts(scene, table)?;
    springs_are_stable(scene, table)?;
    if table.options.response().acts_in_flight() {
        acts_in_flight(scene, table)?;
    }
    Ok(())
}

/// Refuses the method SPOOK where it has nothing to solve for.
fn spook_has_contacts(scene: &Scene, table: &ContactTable) -> Result<(), SceneError> {
    let solves = build(&scene.integrator.method).solves_contacts();
    if !solves || scene.solves_contacts() || scene.molecule.is_some() {
        return Ok(());
    }
    Err(scene
        .source
        .refuse("integrator.kind", "has nothing to solve for")
        .found(format!(
            "{:?} with [contact] kind = {:?}",
            scene.integrator.method.name(),
            table.options.spec().name
        ))
        .allowed("[contact] kind = \"spook\", or another integrator"))
}

/// Refuses springs that are too stiff for the step of a stage: ω·h must stay below the limit of the method.
fn springs_are_stable(scene: &Scene, table: &ContactTable) -> Result<(), SceneError> {
    let Response::Spring(law) = table.options.response() else {
        return Ok(());
    };
    let lightest = scene.lightest_mass();
    // Two of the lightest bodies have half the mass of one.
    let Some(omega) = law.frequency(0.5 * lightest) else {
        return Ok(());
    };
    let Some(TooStiff { dt, limit, .. }) = scene.too_stiff(omega) else {
        return Ok(());
    };
    Err(scene
        .source
        .refuse("contact.stiffness", "is too stiff for the step")
        .found(format!(
            "ω·dt = {:.3} with ω = √(2k/m) = {omega:.3} per τ and dt = {}",
            omega * dt,
            short(dt)
        ))
        .allowed(format!(
            "a stiffness below {:.4e} ε/σ²; bodies in a row vibrate up to √2 times as fast",
            0.5 * lightest * (limit / dt).powi(2)
        )))
}

/// Refuses what does not go with impulses inside a drift.
fn acts_in_flight(scene: &Scene, table: &ContactTable) -> Result<(), SceneError> {
    let source = &scene.source;
    let name = table.options.spec().name;
    let response = table.options.response();
    let (key, what, contacts) = match response {
        Response::Impact { .. } => {
            ("contact.kind", "acts by impacts in drifts", "contacts with impacts")
        }
        Response::Unilateral(_) => {
            ("contact.kind", "acts by impulses in the step of SPOOK", "contacts of SPOOK")
        }
        Response::Spring(_) => (
            "contact.restitution",
            "below 1 acts by a dashpot in drifts",
            "contacts with a dashpot",
        ),
    };
    let suits = |integrator: &Integrator| match response {
        Response::Unilateral(_) => integrator.solves_contacts(),
        Response::Impact { .. } | Response::Spring(_) => integrator.takes_hard_walls(),
    };
    for stage in &scene.stages {
        let integrator = scene.method_of(stage);
        if suits(&integrator) {
            continue;
        }
        return Err(source
            .refuse(key, format!("{what}, which the method does not make"))
            .found(format!("{name:?} with {:?}", integrator.spec().name))
            .allowed(format!(
                "{}, or soft contacts with restitution = 1",
                kinds_that(|entry| suits(&entry.build()))
            )));
    }
    if let Some(molecule) = &scene.molecule
        && molecule.bonds.bonds() != Bonds::Springs
        && !(scene.solves_contacts() && molecule.bonds.spec().integrator.is_some())
    {
        return Err(source
            .refuse(key, format!("{what}, where the bonds are held too"))
            .found(format!("{name:?} with [bonds] method = {:?}", molecule.bonds.name()))
            .allowed("soft contacts with restitution = 1, or bonds that are explicit springs"));
    }
    for (i, stage) in scene.stages.iter().enumerate() {
        if stage.barostat.is_some() {
            return Err(source
                .refuse(&format!("stage.{i}.barostat"), "needs a virial of all forces")
                .found(format!("a barostat beside {contacts}"))
                .allowed("soft contacts with restitution = 1, or a fixed box"));
        }
    }
    for (i, wall) in scene.walls.iter().enumerate() {
        let surface = scene.surface(wall);
        let (message, rule, found, allowed) = match response {
            Response::Spring(_) => continue,
            Response::Impact { .. } => (
                "does not go with hard contacts",
                HitRule::OnLines,
                "whose hits are not where a straight flight meets the plane",
                "\"hard\" with response \"billiard\", \"thermal\", or a wall that only exerts a force",
            ),
            Response::Unilateral(_) => (
                "does not go with contacts of SPOOK",
                HitRule::ByContacts,
                "which acts in drifts",
                "\"hard\" with response = \"contact\", or a wall that only exerts a force",
            ),
        };
        let fits = surface.rule().is_none_or(|own| own == rule);
        if !(fits && surface.dashpot().is_none()) {
            return Err(source
                .refuse(&format!("wall.{i}.kind"), message)
                .found(format!("{:?}, {found}", wall.options.spec().name))
                .allowed(allowed));
        }
    }
    Ok(())
}
