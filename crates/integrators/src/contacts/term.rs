//! Contacts as a force term and as the boundary of flights, with the walls beside them.

use lennard_core::{
    Boundary, Configuration, DMat3, DVec3, Drifted, Energetics, Flight, ForceError,
    ForceProperties, ForceTerm, Part, StepError, System, WallReading, Want, persist, sweeps,
};
use lennard_forcefield::{ContactLaw, Walls};

use super::dashpots::{Moving, damp};
use super::impacts;
use super::near::NearPairs;
use super::{Bodies, Response};
use crate::spook::{HeldBonds, SpookBonds, contact_step};

/// The deepest overlap of bodies that give way, as a share of the contact distance: beyond, bodies would come out on the other side.
const DEEPEST: f64 = 0.5;

/// What contacts have done since the start of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ContactReading {
    /// Impacts of hard and of unilateral contacts.
    pub impacts: u64,
}

/// The contacts of all bodies, and the walls beside them.
///
/// Springs add F = F(δ)·n to each of two bodies that overlap by δ, and their energy and virial to the sums over pairs. A dashpot
/// acts half before a flight and half after it. Impacts happen in flights. Neither dashpots nor impacts are in the virial.
#[derive(Debug, Clone)]
pub struct Contacts {
    response: Response,
    bodies: Bodies,
    walls: Option<Walls>,
    near: NearPairs,
    reading: ContactReading,
    held: Option<HeldBonds>,
}

/// What one pair adds.
struct Touch {
    pair: [usize; 2],
    energy: f64,
    /// r_ij = r_i − r_j, σ.
    apart: DVec3,
    /// −U′/r, ε/σ².
    force: f64,
    /// ∇_i²U, ε/σ².
    laplacian: f64,
}

impl Touch {
    /// What two bodies feel where they overlap; `None` where they do not.
    fn of(
        law: &ContactLaw,
        bodies: &Bodies,
        pair: [usize; 2],
        at: &Configuration<'_>,
    ) -> Option<Self> {
        let [i, j] = pair;
        let apart = at.cell.minimum_image(at.positions[i] - at.positions[j]);
        let distance = bodies.distance(i, j);
        let r2 = apart.length_squared();
        if r2.is_nan() || r2 >= distance * distance {
            return None;
        }
        let r = r2.sqrt();
        let point = law.at(distance - r);
        let force = point.force / r;
        Some(Self {
            pair,
            energy: point.energy,
            apart,
            force,
            laplacian: point.curvature - 2.0 * force,
        })
    }
}

impl Contacts {
    /// Contacts of bodies, with the walls of the scene beside them.
    #[must_use]
    pub fn new(response: Response, bodies: Bodies, walls: Option<Walls>) -> Self {
        Self {
            near: NearPairs::of(&bodies),
            response,
            bodies,
            walls,
            reading: ContactReading::default(),
            held: None,
        }
    }

    /// The same contacts, solved for together with the bonds of the molecules of a system. The method is then told of no bonds.
    #[must_use]
    pub fn with_bonds(self, bonds: SpookBonds, system: System) -> Self {
        Self { held: Some(HeldBonds { bonds, system }), ..self }
    }

    /// What the contacts have done so far.
    #[must_use]
    pub fn reading(&self) -> ContactReading {
        self.reading
    }

    fn touches(&mut self, at: &Configuration<'_>) -> Vec<Touch> {
        let Response::Spring(law) = &self.response else {
            return Vec::new();
        };
        let pairs = self.near.at(&self.bodies, at.cell, at.positions, 0.0);
        let all = pairs.iter().map(|pair| pair.map(|body| body as usize));
        all.filter_map(|pair| Touch::of(law, &self.bodies, pair, at)).collect()
    }

    /// Refuses bodies of unilateral contacts that overlap too deeply: the first pair of them.
    fn none_too_deep(&mut self, at: &Configuration<'_>) -> Result<(), ForceError> {
        let pairs = self.near.at(&self.bodies, at.cell, at.positions, 0.0);
        let apart = |[i, j]: [usize; 2]| {
            let apart = at.positions[i] - at.positions[j];
            at.cell.minimum_image(apart)
        };
        let mut pairs = pairs.iter().map(|pair| pair.map(|body| body as usize));
        let first = pairs.find(|pair| {
            let deepest = (1.0 - DEEPEST) * self.bodies.distance(pair[0], pair[1]);
            apart(*pair).length_squared() < deepest * deepest
        });
        first.map_or(Ok(()), |pair| self.too_deep(pair, apart(pair), at))
    }

    /// Refuses an overlap beyond half the contact distance, for the vector from the second body to the first.
    fn too_deep(
        &self,
        [first, second]: [usize; 2],
        apart: DVec3,
        at: &Configuration<'_>,
    ) -> Result<(), ForceError> {
        let distance = self.bodies.distance(first, second);
        let (depth, deepest) = (distance - apart.length(), DEEPEST * distance);
        if depth <= deepest {
            return Ok(());
        }
        let middle = at.positions[first] - 0.5 * apart;
        Err(ForceError::ContactTooDeep { first, second, depth, deepest, at: at.cell.wrap(middle) })
    }
}

fn virial_of(touch: &Touch) -> DMat3 {
    let (r, f) = (touch.apart, touch.force * touch.apart);
    DMat3::from_cols(r * f.x, r * f.y, r * f.z)
}

impl ForceTerm for Contacts {
    lennard_core::evaluate_by_adding!();

    /// Contacts change quickly in space: their force belongs to the near part.
    fn add(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        scratch: &mut Vec<DVec3>,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        if part != Part::Far && matches!(self.response, Response::Unilateral(_)) {
            self.none_too_deep(&at)?;
        }
        let touches = match part {
            Part::Far => Vec::new(),
            Part::All | Part::Near => self.touches(&at),
        };
        let mut each = want.per_particle.then(|| vec![(0.0, DMat3::ZERO); forces.len()]);
        let (mut energy, mut virial, mut laplacian) = (0.0, DMat3::ZERO, 0.0);
        for touch in &touches {
            self.too_deep(touch.pair, touch.apart, &at)?;
            let ([i, j], force) = (touch.pair, touch.force * touch.apart);
            forces[i] += force;
            forces[j] -= force;
            energy += touch.energy;
            laplacian += 2.0 * touch.laplacian;
            if want.virial || want.per_particle {
                let own = virial_of(touch);
                virial += own;
                for slot in each.iter_mut() {
                    for body in [i, j] {
                        slot[body].0 += 0.5 * touch.energy;
                        slot[body].1 += 0.5 * own;
                    }
                }
            }
        }
        let own = Energetics {
            potential_energy: want.energy.then_some(energy),
            conserved_potential: want.energy.then_some(energy),
            virial: want.virial.then_some(virial),
            laplacian: want.laplacian.then_some(laplacian),
            virial_trace: None,
            pairs: None,
            per_particle: each,
        };
        match &mut self.walls {
            None => Ok(own),
            Some(walls) => Ok(own.with_term(&walls.add(at, part, want, scratch, forces)?)),
        }
    }

    /// The sum over all other bodies: no list can hide one.
    fn force_on(&self, particle: usize, at: Configuration<'_>) -> DVec3 {
        let excluded = |j: usize| self.bodies.exclusions().exclude(particle, j);
        // In the order of the pairs, so that the sum has the same bits.
        let others = (0..at.positions.len()).filter(|j| *j != particle && !excluded(*j));
        let contacts: DVec3 = others
            .filter_map(|j| {
                let Response::Spring(law) = &self.response else {
                    return None;
                };
                let pair = [particle.min(j), particle.max(j)];
                let touch = Touch::of(law, &self.bodies, pair, &at)?;
                let force = touch.force * touch.apart;
                Some(if particle == pair[0] { force } else { -force })
            })
            .sum();
        let walls = self.walls.as_ref().map(|w| w.force_on(particle, at));
        contacts + walls.unwrap_or_default()
    }

    fn properties(&self) -> ForceProperties {
        let needs_solved_contacts = matches!(self.response, Response::Unilateral(_));
        let own = ForceProperties {
            splits: true,
            bounds_flight: self.response.acts_in_flight() && !needs_solved_contacts,
            needs_solved_contacts,
            holds_bonds: needs_solved_contacts && self.held.is_some(),
            ..ForceProperties::default()
        };
        match &self.walls {
            None => own,
            Some(walls) => own.with_term(walls.properties()),
        }
    }

    fn walls(&self) -> &[WallReading] {
        self.walls.as_ref().map_or(&[], |walls| walls.walls())
    }

    fn boundary(&mut self) -> Option<&mut dyn Boundary> {
        if self.response.acts_in_flight() {
            return Some(self);
        }
        self.walls.as_mut().and_then(|walls| walls.boundary())
    }
}

impl Boundary for Contacts {
    fn fly(&mut self, flight: Flight<'_>) -> Result<Drifted, StepError> {
        let (near, bodies, walls) = (&mut self.near, &self.bodies, self.walls.as_mut());
        let flown = match self.response {
            Response::Impact { restitution } => {
                impacts::fly(bodies, restitution, near, walls, flight)
            }
            Response::Unilateral(law) => {
                let of = (bodies, self.held.as_ref());
                contact_step(&law, of, near, walls, flight)?
            }
            Response::Spring(law) => {
                return between_dashpots(&law, bodies, near, walls, flight);
            }
        };
        self.reading.impacts += flown.impacts;
        Ok(flown.drifted)
    }
}

/// The flight of soft bodies, with half a step of their dashpots before it and half after it.
fn between_dashpots(
    law: &ContactLaw,
    bodies: &Bodies,
    near: &mut NearPairs,
    walls: Option<&mut Walls>,
    flight: Flight<'_>,
) -> Result<Drifted, StepError> {
    let Flight { cell, positions, velocities, masses, h, .. } = flight;
    let half = 0.5 * h;
    let mut dashpots = |positions: &[DVec3], velocities: &mut [DVec3], is_after: bool| {
        let pairs = near.at(bodies, cell, positions, 0.0);
        let mut moving = Moving { cell, positions, velocities, masses };
        match is_after {
            false => damp(law, bodies, pairs.iter(), &mut moving, half),
            true => damp(law, bodies, pairs.iter().rev(), &mut moving, half),
        }
    };
    let before = dashpots(positions, velocities, false);
    let on_the_way = match walls.and_then(|walls| walls.boundary()) {
        Some(walls) => walls.fly(Flight {
            positions: &mut *positions,
            velocities: &mut *velocities,
            ..flight
        })?,
        None => {
            sweeps::drift(positions, velocities, h);
            Drifted::default()
        }
    };
    let after = dashpots(positions, velocities, true);
    Ok(Drifted { heat: before + on_the_way.heat + after, ..on_the_way })
}

persist!(Contacts { ..reading, walls, fixed response, bodies, near, held });
persist!(ContactReading { impacts });
