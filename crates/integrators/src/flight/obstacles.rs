//! Walls and contacts of a scene as one force term, and as the one boundary of flights.

use lennard_core::{
    BondSolver, Boundary, Configuration, DVec3, Drifted, Energetics, Flight, ForceError,
    ForceProperties, ForceTerm, Masses, Own, Part, PeriodicBox, StepError, System, WallReading,
    Want, persist,
};
use lennard_forcefield::{ContactLaw, Walls};

use super::lines::{Impacts, Lines};
use super::molecules::HeldMolecules;
use super::particles;
use crate::contacts::bodies::{Bodies, reduced_mass};
use crate::contacts::{Contacts, Response};
use crate::spook::contact_step;

/// All that particles meet in flight: walls, and other bodies.
///
/// The forces of contacts come before the forces of walls. A flight has one order of time for all events.
pub struct Obstacles {
    walls: Option<Walls>,
    contacts: Option<Contacts>,
    /// Molecules whose bonds are held in drifts, where walls act in flights.
    molecules: Option<HeldMolecules>,
}

impl Obstacles {
    /// Walls and contacts, of which either may be absent.
    #[must_use]
    pub fn new(walls: impl Into<Option<Walls>>, contacts: impl Into<Option<Contacts>>) -> Self {
        Self { walls: walls.into(), contacts: contacts.into(), molecules: None }
    }

    /// The same obstacles for the molecules of a system, whose bonds `solver` holds in drifts.
    #[must_use]
    pub fn holding(mut self, system: &System, solver: Box<dyn BondSolver>) -> Self {
        let walls = self.walls.as_ref().filter(|walls| walls.properties().bounds_flight);
        self.molecules = walls.map(|walls| HeldMolecules::new(walls, system, solver));
        self
    }

    fn terms(&self) -> impl Iterator<Item = &dyn ForceTerm> {
        let contacts = self.contacts.iter().map(|contacts| contacts as &dyn ForceTerm);
        contacts.chain(self.walls.iter().map(|walls| walls as &dyn ForceTerm))
    }
}

impl ForceTerm for Obstacles {
    lennard_core::evaluate_by_adding!();

    fn add(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        scratch: &mut Vec<DVec3>,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        match (&mut self.contacts, &mut self.walls) {
            (Some(contacts), Some(walls)) => {
                let own = contacts.add(at, part, want, scratch, forces)?;
                Ok(own.with_term(&walls.add(at, part, want, scratch, forces)?))
            }
            (Some(contacts), None) => contacts.add(at, part, want, scratch, forces),
            (None, Some(walls)) => walls.add(at, part, want, scratch, forces),
            (None, None) => Ok(Energetics::default()),
        }
    }

    fn force_on(&self, particle: usize, at: Configuration<'_>) -> DVec3 {
        self.terms().map(|term| term.force_on(particle, at)).sum()
    }

    fn properties(&self) -> ForceProperties {
        let terms = self.terms().map(ForceTerm::properties).reduce(ForceProperties::with_term);
        terms.unwrap_or_default()
    }

    fn keep(&mut self, own: &Own) {
        self.contacts.iter_mut().for_each(|contacts| contacts.keep(own));
        self.walls.iter_mut().for_each(|walls| walls.keep(own));
    }

    fn walls(&self) -> &[WallReading] {
        self.walls.as_ref().map_or(&[], |walls| walls.walls())
    }

    fn boundary(&mut self) -> Option<&mut dyn Boundary> {
        if self.properties().acts_in_flight() { Some(self) } else { None }
    }
}

impl Boundary for Obstacles {
    fn fly(&mut self, flight: Flight<'_>) -> Result<Drifted, StepError> {
        let Self { walls, contacts, molecules } = self;
        let Some(Contacts { response, bodies, near, held }) = contacts else {
            return between_walls(walls, molecules, flight);
        };
        match *response {
            Response::Impact { restitution } => {
                let impacts = Impacts { bodies, near, restitution };
                Lines::fly_bodies(impacts, walls.as_mut(), flight)
            }
            Response::Unilateral(law) => {
                let of = (&*bodies, held.as_ref());
                contact_step(&law, of, near, walls.as_mut(), flight)
            }
            Response::Spring(law) if !law.is_damped() => between_walls(walls, molecules, flight),
            Response::Spring(law) => {
                // Half a step of the dashpots before the flight, and half after it.
                let Flight { cell, positions, velocities, masses, h, .. } = flight;
                let mut dashpots = |positions: &[DVec3], velocities: &mut [DVec3], is_after| {
                    let pairs = near.at(bodies, cell, positions, 0.0);
                    let mut moving = Moving { cell, positions, velocities, masses };
                    damp(&law, bodies, pairs, &mut moving, 0.5 * h, is_after)
                };
                let before = dashpots(positions, velocities, false);
                let (positions_then, velocities_then) = (&mut *positions, &mut *velocities);
                let inner =
                    Flight { positions: positions_then, velocities: velocities_then, ..flight };
                let on_the_way = between_walls(walls, molecules, inner)?;
                let after = dashpots(positions, velocities, true);
                Ok(Drifted { heat: before + on_the_way.heat + after, ..on_the_way })
            }
        }
    }
}

/// The flight of particles that do not meet each other.
fn between_walls(
    walls: &mut Option<Walls>,
    molecules: &mut Option<HeldMolecules>,
    flight: Flight<'_>,
) -> Result<Drifted, StepError> {
    match (walls, molecules) {
        (Some(walls), Some(molecules)) => molecules.fly(walls, flight),
        (Some(walls), None) if walls.properties().bounds_flight => particles::fly(walls, flight),
        _ => {
            flight.free();
            Ok(Drifted::default())
        }
    }
}

/// Bodies in flight, as dashpots see them.
struct Moving<'a> {
    cell: &'a PeriodicBox,
    positions: &'a [DVec3],
    velocities: &'a mut [DVec3],
    masses: &'a Masses,
}

/// Lets the dashpots of all pairs act for a time h, τ, one pair after the other; returns the kinetic energy put in, 0 or less, ε.
///
/// The decay of each pair is exact. Before the flight pairs come in their order and after it in reverse, so that the whole step is
/// symmetric in time.
fn damp(
    law: &ContactLaw,
    bodies: &Bodies,
    pairs: &[[usize; 2]],
    moving: &mut Moving<'_>,
    h: f64,
    is_after: bool,
) -> f64 {
    let mut heat = 0.0;
    for k in 0..pairs.len() {
        let [i, j] = pairs[if is_after { pairs.len() - 1 - k } else { k }];
        let apart = moving.cell.minimum_image(moving.positions[j] - moving.positions[i]);
        let distance = bodies.distance(i, j);
        let r2 = apart.length_squared();
        if r2 >= distance * distance || r2 == 0.0 {
            continue;
        }
        let Some(mass) = reduced_mass(moving.masses, i, j) else {
            continue;
        };
        let r = r2.sqrt();
        let normal = apart / r;
        let approach = -normal.dot(moving.velocities[j] - moving.velocities[i]);
        let after = law.damped(distance - r, approach, mass, h);
        push(moving, (i, j), mass * (approach - after) * normal);
        heat += 0.5 * mass * (after * after - approach * approach);
    }
    heat
}

/// Hands an impulse to two bodies: to j as it is, to i with the other sign.
fn push(moving: &mut Moving<'_>, (i, j): (usize, usize), impulse: DVec3) {
    moving.velocities[i] -= impulse / moving.masses.of(i);
    moving.velocities[j] += impulse / moving.masses.of(j);
}

persist!(Obstacles { walls, contacts, fixed molecules });
