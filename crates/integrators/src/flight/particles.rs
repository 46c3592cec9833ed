//! The flight of single particles between walls, one after the other.

use lennard_core::random::CounterRng;
use lennard_core::{DVec3, Drifted, Flight, ForceTerm, StepError, WallReading};
use lennard_forcefield::{ContactLaw, HitRule, Walls};

use super::events::{self, Arrival, Mover};
use super::lines::Lines;

/// What planes do in flights, by their index.
struct Planes {
    on_the_way: Vec<WallReading>,
    /// Whether particles fly along parabolas from hit to hit.
    along_parabolas: bool,
    at_end: Vec<(usize, HitRule)>,
    dashpots: Vec<(usize, ContactLaw)>,
}

impl Planes {
    fn of(walls: &Walls) -> Self {
        let all = 0..walls.walls().len();
        let rules = all.clone().filter_map(|plane| Some((plane, walls.surface(plane).rule()?)));
        let rules: Vec<_> = rules.collect();
        let on_the_way = rules.iter().filter(|(_, rule)| rule.is_on_the_way());
        Self {
            on_the_way: on_the_way.map(|(plane, _)| walls.walls()[*plane]).collect(),
            along_parabolas: rules.iter().any(|(_, rule)| *rule == HitRule::OnParabolas),
            at_end: rules.into_iter().filter(|(_, rule)| rule.is_at_end()).collect(),
            dashpots: all
                .filter_map(|plane| Some((plane, *walls.surface(plane).dashpot()?)))
                .collect(),
        }
    }
}

/// Flies all particles.
pub(super) fn fly(walls: &mut Walls, flight: Flight<'_>) -> Result<Drifted, StepError> {
    let planes = Planes::of(walls);
    let Flight { cell, positions, velocities, forces, masses, h, step, is_later } = flight;
    let (is_damped, acts_at_end) = (!planes.dashpots.is_empty(), !planes.at_end.is_empty());
    let mut heat = 0.0;
    for i in (0..positions.len()).filter(|i| !masses.is_held(*i)) {
        let (mass, force) = (masses.of(i), forces[i]);
        let (x, v) = (&mut positions[i], &mut velocities[i]);
        let start = *x;
        if is_damped {
            heat += damp(walls, &planes, start, v, mass, 0.5 * h);
        }
        let end = start + h * *v;
        if planes.along_parabolas {
            let random = walls.noise_of(i, step, is_later);
            let free = force / mass;
            heat += Parabola { walls, x, v, mass, free, h, random, heat: 0.0 }.fly()?;
        } else if end.is_finite() && planes.on_the_way.iter().any(|p| p.distance(end) <= 0.0) {
            let flight = Flight {
                cell,
                positions: &mut positions[i..=i],
                velocities: &mut velocities[i..=i],
                forces: &forces[i..=i],
                masses,
                h,
                step,
                is_later,
            };
            heat += Lines::fly_one(walls, flight, i)?;
        } else {
            *x = end;
        }
        if acts_at_end {
            let kick = h / mass * force;
            let now = (start, &mut positions[i]);
            heat += end_one(walls, &planes, now, &mut velocities[i], kick, h, mass);
        }
        if is_damped {
            heat += damp(walls, &planes, positions[i], &mut velocities[i], mass, 0.5 * h);
        }
    }
    Ok(Drifted::with_heat(heat))
}

/// Mirrors or projects one particle that has flown from `start` to `x` in a time h; returns the kinetic energy put in.
///
/// The velocity of kick-drift-kick lacks its closing half kick here. The mirror takes the whole-step velocity v + `kick`/2,
/// which is exact in a constant field, and leaves v′ − `kick`/2. A particle that the kick of the step alone, σ/τ, pressed to a
/// plane that takes energy rests there, and no heat is counted.
fn end_one(
    walls: &mut Walls,
    planes: &Planes,
    (start, x): (DVec3, &mut DVec3),
    v: &mut DVec3,
    kick: DVec3,
    h: f64,
    mass: f64,
) -> f64 {
    let (half_kick, mut heat) = (0.5 * kick, 0.0);
    for (plane, rule) in &planes.at_end {
        let reading = walls.walls()[*plane];
        let z = reading.distance(*x);
        if z >= 0.0 {
            continue;
        }
        let (axis, outward) = (reading.axis, reading.outward());
        match rule {
            HitRule::Mirrored { restitution } => {
                x[axis] = reading.position + outward * restitution * z;
                v[axis] += half_kick[axis];
                if walls.rests(*plane, outward * v[axis], kick) {
                    x[axis] = reading.position;
                    walls.stop(*plane, v, mass);
                }
                if outward * v[axis] > 0.0 {
                    let (towards, before) = (v[axis], v.length_squared());
                    v[axis] *= -restitution;
                    walls.count_hit(*plane, outward * mass * (towards - v[axis]));
                    heat += 0.5 * mass * (v.length_squared() - before);
                }
                v[axis] -= half_kick[axis];
            }
            HitRule::Projected => {
                let before = v[axis];
                x[axis] = reading.position;
                v[axis] = (x[axis] - start[axis]) / h;
                let momentum = outward * mass * (before - v[axis]);
                if walls.rests(*plane, outward * before, kick) {
                    walls.take_momentum(*plane, momentum);
                } else {
                    walls.count_hit(*plane, momentum);
                    heat += 0.5 * mass * (v[axis] * v[axis] - before * before);
                }
            }
            HitRule::OnLines | HitRule::OnParabolas | HitRule::ByContacts => {}
        }
    }
    heat
}

/// Lets the dashpots of soft walls act on one particle for a time h; returns the kinetic energy put in, 0 or less.
fn damp(walls: &mut Walls, planes: &Planes, x: DVec3, v: &mut DVec3, mass: f64, h: f64) -> f64 {
    let mut heat = 0.0;
    for (plane, contact) in &planes.dashpots {
        let reading = walls.walls()[*plane];
        let (axis, outward) = (reading.axis, reading.outward());
        let before = outward * v[axis];
        let after = contact.damped(-reading.distance(x), before, mass, h);
        v[axis] = outward * after;
        walls.take_momentum(*plane, mass * (before - after));
        heat += 0.5 * mass * (after * after - before * before);
    }
    heat
}

/// One particle in flight over a step h of kick-drift-kick.
struct Parabola<'a> {
    walls: &'a mut Walls,
    x: &'a mut DVec3,
    v: &'a mut DVec3,
    mass: f64,
    /// Acceleration; at rest at a plane it has no part towards the plane.
    free: DVec3,
    h: f64,
    random: CounterRng,
    /// The kinetic energy that hits put in, ε.
    heat: f64,
}

impl Parabola<'_> {
    /// Flies the particle; returns the kinetic energy that hits put in.
    ///
    /// The velocity comes with half a kick, v + (h/2)·a, and leaves as v′ − (h/2)·a, so that the closing half kick gives the
    /// exact v′ of the end. In between the flight is x + v·s + a·s²/2 from hit to hit.
    fn fly(mut self) -> Result<f64, StepError> {
        let half_kick = 0.5 * self.h * self.free;
        let kicked = *self.v;
        *self.v -= half_kick;
        if self.arrival(0, self.h)?.is_none() {
            *self.x += self.h * kicked;
            *self.v = kicked;
            return Ok(0.0);
        }
        let h = self.h;
        events::fly(&mut self, 1, h)?;
        self.walls.clamp_between_planes(self.x);
        *self.v -= half_kick;
        Ok(self.heat)
    }
}

impl Mover for Parabola<'_> {
    fn arrival(&mut self, _unit: usize, left: f64) -> Result<Option<Arrival>, StepError> {
        let (v, a) = (*self.v, self.free);
        let hit = self.walls.first_hit(*self.x, left, |z, axis, outward| {
            time_to_plane(z.max(0.0), outward * v[axis], outward * a[axis])
        });
        Ok(hit.map(|(after, plane)| Arrival { after, site: 0, plane }))
    }

    fn advance(&mut self, _unit: usize, by: f64) -> Result<(), StepError> {
        *self.x += by * *self.v + 0.5 * by * by * self.free;
        *self.v += by * self.free;
        Ok(())
    }

    fn hit(&mut self, _unit: usize, Arrival { plane, .. }: Arrival, left: f64, is_tired: bool) {
        let reading = self.walls.walls()[plane];
        let (axis, outward) = (reading.axis, reading.outward());
        self.x[axis] = reading.position;
        let before = self.v.length_squared();
        self.walls.strike(plane, self.v, self.mass, &mut self.random);
        let pull = outward * self.free[axis];
        // The next flight would be shorter than two steps, or there are too many in this one.
        let loses = self.walls.takes_energy(plane) && self.v[axis].abs() < pull * self.h;
        if pull > 0.0 && (loses || is_tired) {
            let momentum = self.mass * (pull * left + outward * self.v[axis]);
            self.walls.take_momentum(plane, momentum);
            self.v[axis] = 0.0;
            self.free[axis] = 0.0;
        }
        self.heat += 0.5 * self.mass * (self.v.length_squared() - before);
    }
}

/// The first time at which a particle at a distance d ≥ 0 arrives at a plane: d = u·s + b·s²/2 with an outward speed
/// u + b·s > 0 there. All in reduced units.
fn time_to_plane(d: f64, u: f64, b: f64) -> Option<f64> {
    let square = u * u + 2.0 * b * d;
    if square < 0.0 {
        return None;
    }
    let speed_at_plane = square.sqrt();
    if u > 0.0 {
        // The form without cancellation.
        Some(2.0 * d / (u + speed_at_plane))
    } else if b > 0.0 {
        Some((speed_at_plane - u) / b)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::time_to_plane;

    #[test]
    fn arrival_is_the_first_root_with_outward_speed() {
        assert_eq!(time_to_plane(1.0, 2.0, 0.0), Some(0.5));
        assert_eq!(time_to_plane(1.0, -2.0, 0.0), None);
        assert_eq!(time_to_plane(2.0, 0.0, 1.0), Some(2.0));
        // Thrown away from the plane at 1 with acceleration back: returns after 2.
        assert_eq!(time_to_plane(0.0, -1.0, 1.0), Some(2.0));
        // Slowed down before it arrives.
        assert_eq!(time_to_plane(1.0, 1.0, -1.0), None);
    }
}
