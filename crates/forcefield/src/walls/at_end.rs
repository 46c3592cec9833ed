//! What walls do at the ends of a flight: mirrors, projections and dashpots.

use lennard_core::DVec3;
use lennard_core::random::CounterRng;

use super::{HitRule, Surface, Walls};

impl Walls {
    /// Whether a wall mirrors or projects at the end of a flight.
    pub(super) fn acts_at_end(&self) -> bool {
        self.any_surface(|s| s.rule().is_some_and(HitRule::is_at_end))
    }

    /// Whether a wall has a dashpot.
    pub(super) fn has_dashpots(&self) -> bool {
        self.any_surface(|s| s.dashpot().is_some())
    }

    pub(super) fn any_surface(&self, wanted: impl Fn(&Surface) -> bool) -> bool {
        self.pairs.iter().any(|pair| pair.surfaces.iter().any(&wanted))
    }

    /// Mirrors or projects one particle that has flown from `start` to `x` in a time h; returns the kinetic energy put in.
    ///
    /// The velocity of kick-drift-kick lacks its closing half kick here. The mirror takes the whole-step velocity v + `kick`/2,
    /// which is exact in a constant field, and leaves v′ − `kick`/2. A particle that the kick of the step alone, σ/τ, pressed to a
    /// plane that takes energy rests there, and no heat is counted.
    pub(super) fn end_one(
        &mut self,
        (start, x): (DVec3, &mut DVec3),
        v: &mut DVec3,
        kick: DVec3,
        h: f64,
        mass: f64,
        random: &mut CounterRng,
    ) -> f64 {
        let (half_kick, mut heat) = (0.5 * kick, 0.0);
        for index in 0..self.readings.len() {
            let (pair, end) = (&self.pairs[index / 2], index % 2);
            let (Some(rule), z) = (pair.surfaces[end].rule(), pair.distances(*x)[end]) else {
                continue;
            };
            if z >= 0.0 {
                continue;
            }
            let reading = self.readings[index];
            let (axis, outward) = (reading.axis, reading.outward());
            match rule {
                HitRule::Mirrored { restitution } => {
                    x[axis] = reading.position + outward * restitution * z;
                    v[axis] += half_kick[axis];
                    if self.rests(index, outward * v[axis], kick) {
                        x[axis] = reading.position;
                        self.stop(index, v, mass);
                    }
                    if outward * v[axis] > 0.0 {
                        let before = v.length_squared();
                        self.strike(index, v, mass, random);
                        heat += 0.5 * mass * (v.length_squared() - before);
                    }
                    v[axis] -= half_kick[axis];
                }
                HitRule::Projected => {
                    let before = v[axis];
                    x[axis] = reading.position;
                    v[axis] = (x[axis] - start[axis]) / h;
                    let momentum = outward * mass * (before - v[axis]);
                    if self.rests(index, outward * before, kick) {
                        self.take_momentum(index, momentum);
                    } else {
                        self.count_hit(index, momentum);
                        heat += 0.5 * mass * (v[axis] * v[axis] - before * before);
                    }
                }
                HitRule::OnLines | HitRule::OnParabolas | HitRule::ByContacts => {}
            }
        }
        heat
    }

    /// Lets the dashpots of soft walls act on one particle for a time h; returns the kinetic energy put in, 0 or less.
    pub(super) fn damp(&mut self, x: DVec3, v: &mut DVec3, mass: f64, h: f64) -> f64 {
        let mut heat = 0.0;
        for (pair, readings) in self.pairs.iter().zip(self.readings.chunks_mut(2)) {
            let ends = pair.surfaces.iter().zip(pair.distances(x)).zip(readings);
            for ((surface, z), reading) in ends {
                let Some(contact) = surface.dashpot() else {
                    continue;
                };
                let (axis, outward) = (reading.axis, reading.outward());
                let before = outward * v[axis];
                let after = contact.damped(-z, before, mass, h);
                v[axis] = outward * after;
                reading.impulse += mass * (before - after);
                heat += 0.5 * mass * (after * after - before * before);
            }
        }
        heat
    }
}
