//! The flight of a particle under a constant acceleration: along parabolas, the event rule.

use lennard_core::DVec3;
use lennard_core::random::CounterRng;

use super::flight::MOST_HITS;
use super::{HitRule, Surface, Walls};

impl Walls {
    /// Whether particles fly along parabolas from hit to hit.
    pub(super) fn follows_parabolas(&self) -> bool {
        let parabolic = |s: &Surface| s.rule() == Some(HitRule::OnParabolas);
        self.pairs.iter().any(|pair| pair.surfaces.iter().any(parabolic))
    }

    /// Flies one particle of acceleration a over a whole step h of kick-drift-kick; returns the kinetic energy that hits put in.
    ///
    /// The velocity comes with half a kick, v + (h/2)·a, and leaves as v′ − (h/2)·a, so that the closing half kick gives the
    /// exact v′ of the end. In between the flight is x + v·s + a·s²/2 from hit to hit.
    pub(super) fn fall_one(
        &mut self,
        x: &mut DVec3,
        v: &mut DVec3,
        mass: f64,
        a: DVec3,
        h: f64,
        random: &mut CounterRng,
    ) -> f64 {
        let half_kick = 0.5 * h * a;
        if self.next_fall(*x, *v - half_kick, a, h).is_none() {
            *x += h * *v;
            return 0.0;
        }
        *v -= half_kick;
        let (mut left, mut heat) = (h, 0.0);
        // Acceleration of a particle that rests at a plane has no part towards the plane.
        let mut free = a;
        for hits in 0.. {
            let Some((time, index)) = self.next_fall(*x, *v, free, left) else {
                break;
            };
            *x += time * *v + 0.5 * time * time * free;
            *v += time * free;
            left -= time;
            let (axis, outward) = (self.readings[index].axis, self.readings[index].outward());
            x[axis] = self.readings[index].position;
            let before = v.length_squared();
            self.strike(index, v, mass, random);
            let pull = outward * free[axis];
            // The next flight would be shorter than two steps, or there are too many in this one.
            let loses = self.takes_energy(index) && v[axis].abs() < pull * h;
            if pull > 0.0 && (loses || hits >= MOST_HITS) {
                self.take_momentum(index, mass * (pull * left + outward * v[axis]));
                v[axis] = 0.0;
                free[axis] = 0.0;
            }
            heat += 0.5 * mass * (v.length_squared() - before);
            if hits >= 2 * MOST_HITS {
                break;
            }
        }
        *x += left * *v + 0.5 * left * left * free;
        *v += left * free;
        self.clamp_between_planes(x);
        *v -= half_kick;
        heat
    }

    /// The time of the next hit within `left` τ under an acceleration, with the index of the wall.
    fn next_fall(&self, x: DVec3, v: DVec3, a: DVec3, left: f64) -> Option<(f64, usize)> {
        self.first_hit(x, left, |z, axis, outward| {
            time_to_plane(z.max(0.0), outward * v[axis], outward * a[axis])
        })
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
