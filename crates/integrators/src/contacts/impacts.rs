//! Flights of hard bodies: from impact to impact in the order of time, between bodies and at walls.

use crate::spook::{Contact, impacts_at_once, rates};
use lennard_core::random::CounterRng;
use lennard_core::{Axis, DVec3, Drifted, Flight, ForceTerm};
use lennard_forcefield::{KICKS_OF_REST, Walls};

use super::bodies::Bodies;
use super::bodies::reduced_mass;
use super::near::NearPairs;

/// Impacts of one body in one flight, after which it and all that it touches come to rest on each other.
const MOST_IMPACTS: u32 = 16;
/// Impacts of all bodies in one flight, for each body, after which the flight goes on without impacts.
const MOST_EVENTS: u64 = 1000;
/// Bodies nearer than this share of their contact distance touch.
const TOUCHING: f64 = 1e-9;
/// Approach slower than this share of the fastest speed is rounding.
const ROUNDING: f64 = 1e-13;
/// How much faster than the fastest body at its start a flight lets bodies become, before it looks for pairs anew.
const MARGIN: f64 = 1.5;

/// What became of a flight.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Flown {
    /// What solvers took, and the kinetic energy that impacts put in; negative where they take it out.
    pub drifted: Drifted,
    /// Impacts between bodies; for unilateral contacts those with planes too.
    pub impacts: u64,
}

/// The kinetic energy that impulses λ of contacts put in, ε: ½·Σ λ·(G·v + G·v′).
pub(crate) fn work_of(impulses: &[f64], before: &[f64], after: &[f64]) -> f64 {
    let rates = before.iter().zip(after).map(|(before, after)| before + after);
    0.5 * impulses.iter().zip(rates).map(|(i, r)| i * r).sum::<f64>()
}

/// What happens next.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Event {
    /// The bodies of a pair of the list meet.
    Meeting(usize),
    /// A body hits a plane.
    Wall { body: usize, plane: usize },
}

/// Flies all bodies from impact to impact.
pub(crate) fn fly(
    bodies: &Bodies,
    restitution: f64,
    near: &mut NearPairs,
    walls: Option<&mut Walls>,
    flight: Flight<'_>,
) -> Flown {
    let n = flight.positions.len();
    let mut run = Run {
        bodies,
        restitution,
        near,
        pairs: Vec::new(),
        meetings: Vec::new(),
        at_walls: vec![None; n],
        random: vec![None; n],
        flown: vec![0.0; n],
        hits: vec![0; n],
        walls,
        flight,
        limit: 0.0,
        scale: 0.0,
        done: Flown::default(),
    };
    run.look_for_pairs(0.0);
    let mut events = 0;
    while let Some((time, event)) = run.next()
        && events < MOST_EVENTS * n as u64
    {
        run.happen(time, event);
        events += 1;
    }
    let end = run.flight.h;
    for body in 0..n {
        run.advance(body, end);
        if let Some(walls) = &run.walls {
            walls.clamp_between_planes(&mut run.flight.positions[body]);
        }
    }
    run.done
}

struct Run<'a> {
    bodies: &'a Bodies,
    restitution: f64,
    near: &'a mut NearPairs,
    walls: Option<&'a mut Walls>,
    flight: Flight<'a>,
    /// The pairs that may meet.
    pairs: Vec<[u32; 2]>,
    /// When each of them meets, τ since the start of the flight; infinite for never.
    meetings: Vec<f64>,
    /// When each body hits which plane.
    at_walls: Vec<Option<(f64, usize)>>,
    /// Random numbers of each body that hit a wall.
    random: Vec<Option<CounterRng>>,
    /// The time up to which each body has flown, τ.
    flown: Vec<f64>,
    hits: Vec<u32>,
    /// The speed up to which the pairs hold, σ/τ.
    limit: f64,
    /// The fastest that any body was in this flight, σ/τ: what speeds are rounded against.
    scale: f64,
    done: Flown,
}

impl Run<'_> {
    fn position_at(&self, body: usize, time: f64) -> DVec3 {
        self.flight.positions[body] + (time - self.flown[body]) * self.flight.velocities[body]
    }

    fn advance(&mut self, body: usize, time: f64) {
        // A body that flies undisturbed moves by h·v in one go, as in a drift.
        let position = self.position_at(body, time);
        self.flight.positions[body] = position;
        self.flown[body] = time;
    }

    fn fastest(&self) -> f64 {
        let squares = self.flight.velocities.iter().map(|v| v.length_squared());
        squares.fold(0.0, f64::max).sqrt()
    }

    /// Finds the pairs that may meet from a time on, and when they do.
    fn look_for_pairs(&mut self, time: f64) {
        let n = self.flight.positions.len();
        if time > 0.0 {
            (0..n).for_each(|body| self.advance(body, time));
        }
        self.limit = MARGIN * self.fastest();
        self.scale = self.scale.max(self.limit);
        let travel = (self.flight.h - time) * self.limit;
        let pairs = self.near.at(self.bodies, self.flight.cell, self.flight.positions, travel);
        self.pairs.clear();
        self.pairs.extend_from_slice(pairs);
        self.meetings = (0..self.pairs.len()).map(|k| self.meeting(k, time)).collect();
        (0..n).for_each(|body| self.look_for_wall(body, time));
    }

    /// The vector from the first to the second body of a pair at a time, nearest image, σ.
    fn apart(&self, [i, j]: [usize; 2], time: f64) -> DVec3 {
        let cell = self.flight.cell;
        cell.minimum_image(self.position_at(j, time) - self.position_at(i, time))
    }

    fn bodies_of(&self, pair: usize) -> [usize; 2] {
        self.pairs[pair].map(|body| body as usize)
    }

    /// When a pair meets, from a time on at which both still fly: the first root of |r + w·s| = d with s ≥ 0.
    fn meeting(&self, pair: usize, time: f64) -> f64 {
        let [i, j] = self.bodies_of(pair);
        let velocities = &self.flight.velocities;
        let w = velocities[j] - velocities[i];
        let r = self.apart([i, j], time);
        let (b, w2) = (r.dot(w), w.length_squared());
        let distance = self.bodies.distance(i, j);
        let c = r.length_squared() - distance * distance;
        if b >= -ROUNDING * distance * self.scale {
            return f64::INFINITY;
        }
        if c <= 0.0 {
            return time;
        }
        let discriminant = b * b - w2 * c;
        if discriminant < 0.0 {
            return f64::INFINITY;
        }
        // The form without cancellation.
        time + c / (discriminant.sqrt() - b)
    }

    fn look_for_wall(&mut self, body: usize, time: f64) {
        let Some(walls) = &self.walls else { return };
        if self.flight.masses.is_held(body) {
            return;
        }
        let x = self.position_at(body, time);
        let left = self.flight.h - time;
        let slow = ROUNDING * self.scale;
        let with_direction = |v: f64| if v.abs() <= slow { 0.0 } else { v };
        let v = self.flight.velocities[body].map(with_direction);
        let hit = walls.next_hit(x, v, left);
        self.at_walls[body] = hit.map(|(after, plane)| (time + after, plane));
    }

    /// The earliest event before the end of the flight.
    fn next(&self) -> Option<(f64, Event)> {
        let mut first = (self.flight.h, None);
        for (pair, time) in self.meetings.iter().enumerate() {
            if *time < first.0 {
                first = (*time, Some(Event::Meeting(pair)));
            }
        }
        for (body, hit) in self.at_walls.iter().enumerate() {
            if let Some((time, plane)) = *hit
                && time < first.0
            {
                first = (time, Some(Event::Wall { body, plane }));
            }
        }
        first.1.map(|event| (first.0, event))
    }

    fn happen(&mut self, time: f64, event: Event) {
        let struck = match event {
            Event::Meeting(pair) => {
                let [i, j] = self.bodies_of(pair);
                self.bounce([i, j], time);
                [i, j]
            }
            Event::Wall { body, plane } => {
                self.hit_wall(body, plane, time);
                [body; 2]
            }
        };
        struck.iter().for_each(|body| self.hits[*body] += 1);
        let tired = struck.iter().any(|body| self.hits[*body] > MOST_IMPACTS);
        if tired {
            self.come_to_rest(time);
        }
        let fast = |body: &usize| self.flight.velocities[*body].length() > self.limit;
        if tired || struck.iter().any(fast) {
            self.look_for_pairs(time);
            return;
        }
        for pair in 0..self.pairs.len() {
            if self.bodies_of(pair).iter().any(|b| struck.contains(b)) {
                self.meetings[pair] = self.meeting(pair, time);
            }
        }
        struck.iter().for_each(|b| self.look_for_wall(*b, time));
    }

    /// The speed that one kick of a step gives a body, σ/τ.
    fn kick_of(&self, body: usize) -> f64 {
        self.flight.h * self.flight.forces[body].length() / self.flight.masses.of(body)
    }

    /// The impact of two bodies: n·w → −e·n·w.
    ///
    /// Bodies that approach by no more than kicks of this step rest on each other, unless e is 1. No energy is lost there: the
    /// kick that pressed them together did no work.
    fn bounce(&mut self, [i, j]: [usize; 2], time: f64) {
        self.advance(i, time);
        self.advance(j, time);
        let masses = self.flight.masses;
        let Some(mass) = reduced_mass(masses, i, j) else {
            return;
        };
        let normal = self.apart([i, j], time).normalize_or_zero();
        let velocities = &self.flight.velocities;
        let rate = normal.dot(velocities[j] - velocities[i]);
        let kick = self.kick_of(i) + self.kick_of(j);
        let velocities = &mut self.flight.velocities;
        let rests = self.restitution < 1.0 && -rate <= KICKS_OF_REST * kick;
        let e = if rests { 0.0 } else { self.restitution };
        let impulse = -(1.0 + e) * mass * rate * normal;
        velocities[i] -= impulse / masses.of(i);
        velocities[j] += impulse / masses.of(j);
        if rests {
            return;
        }
        self.done.drifted.heat += 0.5 * mass * rate * rate * (e * e - 1.0);
        self.done.impacts += 1;
    }

    fn hit_wall(&mut self, body: usize, plane: usize, time: f64) {
        self.advance(body, time);
        let (step, is_later) = (self.flight.step, self.flight.is_later);
        let mass = self.flight.masses.of(body);
        let kick = self.flight.h / mass * self.flight.forces[body];
        let Some(walls) = self.walls.as_deref_mut() else {
            return;
        };
        let drawn = self.random[body].take();
        let mut random = drawn.unwrap_or_else(|| walls.noise_of(body, step, is_later));
        let reading = walls.walls()[plane];
        self.flight.positions[body][reading.axis] = reading.position;
        let v = &mut self.flight.velocities[body];
        self.done.drifted.heat += walls.hit(plane, v, mass, kick, &mut random);
        self.random[body] = Some(random);
    }

    /// Ends a sequence of very many impacts, each smaller than the one before. All bodies that touch take velocities at which none approaches, by
    /// impacts without restitution, all at once.
    fn come_to_rest(&mut self, time: f64) {
        let n = self.flight.positions.len();
        (0..n).for_each(|body| self.advance(body, time));
        let mut contacts = Vec::new();
        for pair in 0..self.pairs.len() {
            let [i, j] = self.bodies_of(pair);
            let apart = self.apart([i, j], time);
            let gap = apart.length() - self.bodies.distance(i, j);
            if gap <= TOUCHING * self.bodies.distance(i, j)
                && reduced_mass(self.flight.masses, i, j).is_some()
            {
                contacts.push(Contact {
                    first: Some(i),
                    second: j,
                    normal: apart.normalize_or_zero(),
                    gap,
                });
            }
        }
        let kick = (0..n).map(|body| self.kick_of(body)).fold(0.0, f64::max);
        let of_bodies = contacts.len();
        let planes = self.planes_touched(&mut contacts);
        let velocities = &mut *self.flight.velocities;
        let masses = self.flight.masses;
        let before = rates(&contacts, velocities);
        let fastest = before.iter().fold(0.0, |most: f64, rate| most.max(-rate));
        // Where the solve ends early, bodies still approach, and the flight goes on with impacts.
        let solution = impacts_at_once(&contacts, masses, velocities, 0.0);
        let impulses = &solution.impulses;
        self.done.drifted = self.done.drifted.and(solution.report());
        if fastest > KICKS_OF_REST * kick {
            self.done.drifted.heat += work_of(impulses, &before, &rates(&contacts, velocities));
        }
        if let Some(walls) = self.walls.as_deref_mut() {
            for (plane, impulse) in planes.iter().zip(&impulses[of_bodies..]) {
                walls.take_momentum(*plane, *impulse);
            }
        }
        self.hits.fill(0);
    }

    /// Appends the contacts of bodies with planes that they hit, and returns the planes.
    fn planes_touched(&self, contacts: &mut Vec<Contact>) -> Vec<usize> {
        let mut planes = Vec::new();
        let Some(walls) = &self.walls else {
            return planes;
        };
        let largest = self.bodies.largest();
        for body in 0..self.flight.positions.len() {
            let x = self.flight.positions[body];
            for axis in Axis::ALL.map(Axis::index) {
                for outward in [-1.0, 1.0] {
                    let mut v = DVec3::ZERO;
                    v[axis] = outward;
                    // At unit speed, the time of the hit is the distance.
                    let hit = walls.next_hit(x, v, TOUCHING * largest);
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
