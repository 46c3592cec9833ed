//! Hits of particles at walls: where they happen, and what they do.

use lennard_core::DVec3;
use lennard_core::random::CounterRng;

use super::{Hit, HitRule, SlitPlanes, Surface, Walls};

/// A particle that arrives by no more than so many kicks of the flight rests at a plane that takes energy.
pub const KICKS_OF_REST: f64 = 1.0 + 1e-9;

impl Walls {
    /// The next hit of a particle that flies straight from `x` (σ) with `v` (σ/τ) for `left` τ. It gives the time until then, τ, and
    /// the index of the plane in [`lennard_core::ForceTerm::walls`].
    #[must_use]
    pub fn next_hit(&self, x: DVec3, v: DVec3, left: f64) -> Option<(f64, usize)> {
        self.first_hit(x, left, |z, axis, outward| {
            let towards = outward * v[axis];
            (towards > 0.0).then(|| (z / towards).max(0.0))
        })
    }

    /// Random numbers of a particle in a flight that begins after `step` steps; a second flight of a step draws others.
    #[must_use]
    pub fn noise_of(&self, particle: usize, step: u64, is_later: bool) -> CounterRng {
        let counter = 2 * step + u64::from(is_later);
        self.noise.at(counter, particle as u32)
    }

    /// Counts the momentum, m·σ/τ along the outward normal, that a particle hands to a plane where it comes to rest.
    pub fn take_momentum(&mut self, index: usize, momentum: f64) {
        self.readings[index].impulse += momentum;
    }

    /// Counts a hit that hands this momentum to a plane, m·σ/τ along the outward normal.
    pub fn count_hit(&mut self, index: usize, momentum: f64) {
        self.take_momentum(index, momentum);
        self.readings[index].hits += 1;
    }

    /// Takes the speed across a plane off a particle, and hands the momentum to the wall.
    pub fn stop(&mut self, index: usize, v: &mut DVec3, mass: f64) {
        let reading = self.readings[index];
        self.take_momentum(index, reading.outward() * mass * v[reading.axis]);
        v[reading.axis] = 0.0;
    }

    /// Whether a particle that arrives at a plane with an outward speed rests there. The forces change its velocity by `kick` in a
    /// flight.
    ///
    /// It rests where the plane takes energy and the kick alone has brought the speed. That kick did no work on a particle at rest.
    #[must_use]
    pub fn rests(&self, index: usize, towards: f64, kick: DVec3) -> bool {
        let reading = &self.readings[index];
        self.takes_energy(index)
            && towards <= KICKS_OF_REST * reading.outward() * kick[reading.axis]
    }

    /// Whether hits of a plane take energy: its restitution is below 1.
    #[must_use]
    pub fn takes_energy(&self, index: usize) -> bool {
        self.surface(index).restitution().is_some_and(|e| e < 1.0)
    }

    /// The hit of a particle at a plane: it bounces, or it rests where the `kick` of the flight alone, σ/τ, pressed it there.
    ///
    /// Returns the kinetic energy put in, ε: nothing where it rests.
    pub fn hit(
        &mut self,
        index: usize,
        v: &mut DVec3,
        mass: f64,
        kick: DVec3,
        random: &mut CounterRng,
    ) -> f64 {
        let reading = &self.readings[index];
        if self.rests(index, reading.outward() * v[reading.axis], kick) {
            self.stop(index, v, mass);
            return 0.0;
        }
        let before = v.length_squared();
        self.strike(index, v, mass, random);
        0.5 * mass * (v.length_squared() - before)
    }

    /// Gives a particle at a plane the velocity after the hit, and the wall the momentum.
    pub fn strike(&mut self, index: usize, v: &mut DVec3, mass: f64, random: &mut CounterRng) {
        let Surface::Hit(wall) = &self.pairs[index / 2].surfaces[index % 2] else {
            return;
        };
        let reading = &self.readings[index];
        let (axis, outward) = (reading.axis, reading.outward());
        let after = wall.leave(Hit { axis, outward, velocity: *v, mass, random });
        self.count_hit(index, outward * mass * (v[axis] - after[axis]));
        *v = after;
    }

    /// Takes off what rounding put behind a plane.
    pub fn clamp_between_planes(&self, x: &mut DVec3) {
        for pair in self.pairs.iter().filter(|pair| pair.is_hit_on_the_way()) {
            let SlitPlanes { axis, lower, upper, .. } = pair.planes;
            x[axis] = x[axis].clamp(lower, upper);
        }
    }

    /// The earliest time within `left` τ at which a particle at x arrives at a wall that is hit, with the index of the wall.
    ///
    /// `time` gives the time of arrival at a plane from the distance, the axis and the outward direction along it.
    pub fn first_hit(
        &self,
        x: DVec3,
        left: f64,
        time: impl Fn(f64, usize, f64) -> Option<f64>,
    ) -> Option<(f64, usize)> {
        let mut first: Option<(f64, usize)> = None;
        for (p, pair) in self.pairs.iter().enumerate() {
            for (end, z) in pair.distances(x).into_iter().enumerate() {
                if !pair.surfaces[end].rule().is_some_and(HitRule::is_on_the_way) {
                    continue;
                }
                let arrival = time(z, pair.planes.axis, [-1.0, 1.0][end]);
                if let Some(time) = arrival.filter(|time| *time <= left)
                    && first.is_none_or(|(earlier, _)| time < earlier)
                {
                    first = Some((time, 2 * p + end));
                }
            }
        }
        first
    }
}
