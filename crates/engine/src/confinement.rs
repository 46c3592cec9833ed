//! Walls and fields of a scene: force terms beside the pairs.

use lennard_core::{ForceProperties, ForceSum, ForceTerm, PeriodicBox, SpeciesTable, System};
use lennard_forcefield::{ConstantField, PairForces, Walls};
use lennard_integrators::{BondHolder, BondOptions, Contacts, Obstacles};
use lennard_scene::Scene;

use crate::planar_tail::PlanarTail;

/// The forces beside pair forces: walls and field on single particles, contacts of bodies, and the tail across flat surfaces.
#[derive(Debug, Clone, Default)]
pub struct Confinement {
    walls: Option<Walls>,
    contacts: Option<Contacts>,
    field: Option<ConstantField>,
    planar_tail: Option<PlanarTail>,
    /// Whether the total momentum is free along all axes: particles are held, or the scene lists velocities.
    is_anchored: bool,
    /// How bonds are held, and the molecules: walls that are hit need both. `None` without walls.
    bonds: Option<(BondOptions, System)>,
}

impl Confinement {
    /// Walls, contacts and field of a scene in a box, and the system of particles whose momentum they change.
    ///
    /// Velocities that the scene lists keep their total momentum: its components then count as degrees of freedom.
    #[must_use]
    pub fn with_system(scene: &Scene, cell: &PeriodicBox, species: SpeciesTable) -> (System, Self) {
        let (walls, contacts) = (scene.walls_in(cell), scene.contacts_of(&species));
        let system = System::of_species(species).bonded(scene.molecules());
        // Held particles before the field, which they do not feel.
        let held = system.holding(&scene.system.held);
        let contacts = contacts.map(|contacts| with_bonds(contacts, scene, &held));
        let molecule = scene.molecule.as_ref().filter(|_| walls.is_some());
        let confinement = Self {
            walls,
            contacts,
            field: scene.field_on(&held.masses),
            planar_tail: PlanarTail::of(scene, cell),
            is_anchored: scene.system.start.lists_velocities() || !scene.system.held.is_empty(),
            bonds: molecule.map(|molecule| (molecule.bonds.clone(), held.clone())),
        };
        (confinement.pushes(held, [false; 3]), confinement)
    }

    /// The system of particles whose momentum other forces change too, along these axes.
    #[must_use]
    pub(crate) fn pushes(&self, system: System, others: [bool; 3]) -> System {
        let own = self.properties().breaks_momentum;
        let pushed = |axis: usize| self.is_anchored || own[axis] || others[axis];
        system.pushed_along(std::array::from_fn(pushed))
    }

    /// What kind of forces these are.
    #[must_use]
    pub fn properties(&self) -> ForceProperties {
        let walls = self.walls.as_ref().map(ForceTerm::properties);
        let contacts = self.contacts.as_ref().map(ForceTerm::properties);
        let field = self.field.as_ref().map(ForceTerm::properties);
        let terms = walls.into_iter().chain(contacts).chain(field);
        terms.fold(ForceProperties::default(), ForceProperties::with_term)
    }

    /// Pair forces with these forces after them.
    #[must_use]
    pub fn beside(self, pairs: PairForces) -> ForceSum<PairForces> {
        let mut sum = ForceSum::new(pairs);
        if self.walls.is_some() || self.contacts.is_some() {
            let mut obstacles = Obstacles::new(self.walls, self.contacts);
            if let Some((bonds, system)) = self.bonds
                && let BondHolder::Drift(solver) | BondHolder::InDrift(solver, _) =
                    bonds.build(&system.molecules)
            {
                obstacles = obstacles.holding(&system, solver);
            }
            sum = sum.with(obstacles);
        }
        if let Some(field) = self.field {
            sum = sum.with(field);
        }
        match self.planar_tail {
            Some(tail) => sum.with(tail),
            None => sum,
        }
    }
}

/// Contacts of SPOOK with the bonds of SPOOK, which they are solved for with; other contacts as they are.
fn with_bonds(contacts: Contacts, scene: &Scene, system: &System) -> Contacts {
    let is_solved = contacts.properties().needs_solved_contacts;
    let molecule = scene.molecule.as_ref().filter(|_| is_solved);
    match molecule.map(|molecule| molecule.bonds.build(&system.molecules)) {
        Some(BondHolder::Spook(bonds, _)) => contacts.with_bonds(bonds, system.clone()),
        _ => contacts,
    }
}
