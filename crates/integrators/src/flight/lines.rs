//! Straight flights: a particle between planes, and hard bodies that meet each other besides.

use lennard_core::moves::drift;
use lennard_core::random::CounterRng;
use lennard_core::{Axis, DVec3, Drifted, Flight, ForceTerm, StepError};
use lennard_forcefield::{KICKS_OF_REST, Walls};

use super::events::{Arrival, Mover, fly};
use crate::contacts::bodies::{Bodies, NearPairs, reduced_mass};
use crate::spook::{Contact, impacts_at_once, rates, work_of};

/// Bodies nearer than this share of their contact distance touch.
const TOUCHING: f64 = 1e-9;
/// Approach slower than this share of the fastest speed is rounding.
const ROUNDING: f64 = 1e-13;
/// How much faster than the fastest body at its start a flight lets bodies become, before it looks for pairs anew.
const MARGIN: f64 = 1.5;

/// Bodies that bounce off each other.
pub(super) struct Impacts<'a> {
    pub bodies: &'a Bodies,
    pub near: &'a mut NearPairs,
    /// The share of their normal speed that they keep.
    pub restitution: f64,
}

/// Particles on straight lines.
pub(super) struct Lines<'a> {
    walls: Option<&'a mut Walls>,
    impacts: Option<Impacts<'a>>,
    flight: Flight<'a>,
    /// The number of the first particle of the flight.
    first: usize,
    /// Random numbers of each particle that hit a wall.
    random: Vec<Option<CounterRng>>,
    /// The speed up to which the pairs hold, σ/τ.
    limit: f64,
    /// The fastest that any body was in this flight, σ/τ: what speeds are rounded against.
    scale: f64,
    drifted: Drifted,
}

impl<'a> Lines<'a> {
    /// Flies hard bodies, which meet each other and the walls beside them.
    pub(super) fn fly_bodies(
        impacts: Impacts<'a>,
        walls: Option<&'a mut Walls>,
        flight: Flight<'a>,
    ) -> Result<Drifted, StepError> {
        Self::fly(Some(impacts), walls, flight, 0)
    }

    /// Flies the only particle of a flight, whose number is `particle`, between walls; returns the kinetic energy that hits put in.
    pub(super) fn fly_one(
        walls: &'a mut Walls,
        flight: Flight<'a>,
        particle: usize,
    ) -> Result<f64, StepError> {
        Ok(Self::fly(None, Some(walls), flight, particle)?.heat)
    }

    fn fly(
        impacts: Option<Impacts<'a>>,
        walls: Option<&'a mut Walls>,
        flight: Flight<'a>,
        first: usize,
    ) -> Result<Drifted, StepError> {
        let (n, h) = (flight.positions.len(), flight.h);
        let random = vec![None; n];
        let (limit, scale, drifted) = (0.0, 0.0, Drifted::default());
        let mut lines = Self { walls, impacts, flight, first, random, limit, scale, drifted };
        fly(&mut lines, n, h)?;
        if let Some(walls) = &lines.walls {
            for x in lines.flight.positions.iter_mut() {
                walls.clamp_between_planes(x);
            }
        }
        Ok(lines.drifted)
    }

    fn fastest(&self) -> f64 {
        let squares = self.flight.velocities.iter().map(|v| v.length_squared());
        squares.fold(0.0, f64::max).sqrt()
    }

    fn mass(&self, unit: usize) -> f64 {
        self.flight.masses.of(self.first + unit)
    }

    /// The vector from the first to the second body of a pair, nearest image, σ.
    fn apart(&self, [i, j]: [usize; 2]) -> DVec3 {
        let x = &self.flight.positions;
        self.flight.cell.minimum_image(x[j] - x[i])
    }

    /// The speed that one kick of a step gives a body, σ/τ.
    fn kick_of(&self, body: usize) -> f64 {
        self.flight.h * self.flight.forces[body].length() / self.mass(body)
    }

    /// Appends the contacts of bodies with planes that they hit, and returns the planes.
    fn planes_touched(&self, largest: f64, contacts: &mut Vec<Contact>) -> Vec<usize> {
        let mut planes = Vec::new();
        let Some(walls) = &self.walls else {
            return planes;
        };
        for (body, x) in self.flight.positions.iter().enumerate() {
            for axis in Axis::ALL.map(Axis::index) {
                for outward in [-1.0, 1.0] {
                    let mut v = DVec3::ZERO;
                    v[axis] = outward;
                    // At unit speed, the time of the hit is the distance.
                    let hit = walls.next_hit(*x, v, TOUCHING * largest);
                    if let Some((gap, plane)) = hit.filter(|_| !self.flight.masses.is_held(body)) {
                        planes.push(plane);
                        contacts.push(Contact { first: None, second: body, normal: -v, gap });
                    }
                }
            }
        }
        planes
    }
}

impl Mover for Lines<'_> {
    fn arrival(&mut self, unit: usize, left: f64) -> Result<Option<Arrival>, StepError> {
        let Some(walls) = &self.walls else {
            return Ok(None);
        };
        if self.flight.masses.is_held(self.first + unit) {
            return Ok(None);
        }
        let slow = ROUNDING * self.scale;
        let with_direction = |v: f64| if v.abs() <= slow { 0.0 } else { v };
        let v = self.flight.velocities[unit].map(with_direction);
        let hit = walls.next_hit(self.flight.positions[unit], v, left);
        Ok(hit.map(|(after, plane)| Arrival { after, site: 0, plane }))
    }

    fn advance(&mut self, unit: usize, by: f64) -> Result<(), StepError> {
        // A particle that flies undisturbed moves by h·v in one go.
        let Flight { positions, velocities, .. } = &mut self.flight;
        drift(&mut positions[unit..=unit], &velocities[unit..=unit], by);
        Ok(())
    }

    fn hit(&mut self, unit: usize, Arrival { plane, .. }: Arrival, _left: f64, is_tired: bool) {
        let (mass, is_alone) = (self.mass(unit), self.impacts.is_none());
        let kick = self.flight.h / mass * self.flight.forces[unit];
        let Some(walls) = self.walls.as_deref_mut() else {
            return;
        };
        let reading = walls.walls()[plane];
        self.flight.positions[unit][reading.axis] = reading.position;
        let v = &mut self.flight.velocities[unit];
        let heat = &mut self.drifted.heat;
        if is_tired && is_alone {
            *heat -= 0.5 * mass * v[reading.axis].powi(2);
            walls.stop(plane, v, mass);
            return;
        }
        let (particle, step) = (self.first + unit, self.flight.step);
        let is_later = self.flight.is_later;
        let random = &mut self.random[unit];
        let random = random.get_or_insert_with(|| walls.noise_of(particle, step, is_later));
        *heat += walls.hit(plane, v, mass, kick, random);
    }

    fn pairs(&mut self, left: f64) -> Vec<[usize; 2]> {
        if self.impacts.is_none() {
            return Vec::new();
        }
        self.limit = MARGIN * self.fastest();
        self.scale = self.scale.max(self.limit);
        let (cell, x) = (self.flight.cell, &*self.flight.positions);
        let Some(Impacts { bodies, near, .. }) = &mut self.impacts else {
            return Vec::new();
        };
        near.at(bodies, cell, x, left * self.limit).to_vec()
    }

    /// The first root of |r + w·s| = d with s ≥ 0.
    fn meeting(&self, [i, j]: [usize; 2], behind: [f64; 2]) -> f64 {
        let Some(impacts) = &self.impacts else {
            return f64::INFINITY;
        };
        let (x, v) = (&self.flight.positions, &self.flight.velocities);
        let w = v[j] - v[i];
        let r = (x[j] + behind[1] * v[j]) - (x[i] + behind[0] * v[i]);
        let r = self.flight.cell.minimum_image(r);
        let (b, w2) = (r.dot(w), w.length_squared());
        let distance = impacts.bodies.distance(i, j);
        let c = r.length_squared() - distance * distance;
        if b >= -ROUNDING * distance * self.scale {
            return f64::INFINITY;
        }
        if c <= 0.0 {
            return 0.0;
        }
        let discriminant = b * b - w2 * c;
        if discriminant < 0.0 {
            return f64::INFINITY;
        }
        // The form without cancellation.
        c / (discriminant.sqrt() - b)
    }

    /// The impact of two bodies: n·w → −e·n·w.
    ///
    /// Bodies that approach by no more than kicks of this step rest on each other, unless e is 1. No energy is lost there: the
    /// kick that pressed them together did no work.
    fn meet(&mut self, [i, j]: [usize; 2]) {
        let masses = self.flight.masses;
        let (Some(mass), Some(impacts)) = (reduced_mass(masses, i, j), &self.impacts) else {
            return;
        };
        let normal = self.apart([i, j]).normalize_or_zero();
        let rate = normal.dot(self.flight.velocities[j] - self.flight.velocities[i]);
        let kick = self.kick_of(i) + self.kick_of(j);
        let rests = impacts.restitution < 1.0 && -rate <= KICKS_OF_REST * kick;
        let e = if rests { 0.0 } else { impacts.restitution };
        let impulse = -(1.0 + e) * mass * rate * normal;
        let velocities = &mut self.flight.velocities;
        velocities[i] -= impulse / masses.of(i);
        velocities[j] += impulse / masses.of(j);
        if rests {
            return;
        }
        self.drifted.heat += 0.5 * mass * rate * rate * (e * e - 1.0);
    }

    fn outruns_pairs(&self, unit: usize) -> bool {
        self.impacts.is_some() && self.flight.velocities[unit].length() > self.limit
    }

    /// Ends a sequence of very many impacts, each smaller than the one before. All bodies that touch take velocities at which none approaches, by
    /// impacts without restitution, all at once.
    fn come_to_rest(&mut self, pairs: &[[usize; 2]]) -> bool {
        let Some(Impacts { bodies, .. }) = &self.impacts else {
            return false;
        };
        let masses = self.flight.masses;
        let mut contacts = Vec::new();
        for [i, j] in pairs {
            let (apart, distance) = (self.apart([*i, *j]), bodies.distance(*i, *j));
            let gap = apart.length() - distance;
            if gap <= TOUCHING * distance && reduced_mass(masses, *i, *j).is_some() {
                let normal = apart.normalize_or_zero();
                contacts.push(Contact { first: Some(*i), second: *j, normal, gap });
            }
        }
        let n = self.flight.positions.len();
        let kick = (0..n).map(|body| self.kick_of(body)).fold(0.0, f64::max);
        let of_bodies = contacts.len();
        let planes = self.planes_touched(bodies.largest(), &mut contacts);
        let velocities = &mut *self.flight.velocities;
        let before = rates(&contacts, velocities);
        let fastest = before.iter().fold(0.0, |most: f64, rate| most.max(-rate));
        // Where the solve ends early, bodies still approach, and the flight goes on with impacts.
        let solution = impacts_at_once(&contacts, masses, velocities, 0.0);
        let impulses = &solution.impulses;
        self.drifted = self.drifted.and(solution.report());
        if fastest > KICKS_OF_REST * kick {
            self.drifted.heat += work_of(impulses, &before, &rates(&contacts, velocities));
        }
        if let Some(walls) = self.walls.as_deref_mut() {
            for (plane, impulse) in planes.iter().zip(&impulses[of_bodies..]) {
                walls.take_momentum(*plane, *impulse);
            }
        }
        true
    }
}
