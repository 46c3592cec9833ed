//! The flight of one particle under a constant acceleration: along parabolas, the event rule.

use lennard_core::random::CounterRng;
use lennard_core::{DVec3, ForceTerm, StepError};
use lennard_forcefield::Walls;

use super::events::{Arrival, Mover, fly};

/// One particle in flight over a step h of kick-drift-kick.
pub(super) struct Parabola<'a> {
    pub walls: &'a mut Walls,
    pub x: &'a mut DVec3,
    pub v: &'a mut DVec3,
    pub mass: f64,
    /// Acceleration; at rest at a plane it has no part towards the plane.
    pub free: DVec3,
    pub h: f64,
    pub random: CounterRng,
    /// The kinetic energy that hits put in, ε.
    pub heat: f64,
}

impl Parabola<'_> {
    /// Flies the particle; returns the kinetic energy that hits put in.
    ///
    /// The velocity comes with half a kick, v + (h/2)·a, and leaves as v′ − (h/2)·a, so that the closing half kick gives the
    /// exact v′ of the end. In between the flight is x + v·s + a·s²/2 from hit to hit.
    pub(super) fn fly(mut self) -> Result<f64, StepError> {
        let half_kick = 0.5 * self.h * self.free;
        let kicked = *self.v;
        *self.v -= half_kick;
        if self.arrival(0, self.h)?.is_none() {
            *self.x += self.h * kicked;
            *self.v = kicked;
            return Ok(0.0);
        }
        let h = self.h;
        fly(&mut self, 1, h)?;
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
