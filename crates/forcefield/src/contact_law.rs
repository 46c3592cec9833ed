//! The force of a contact at a depth: a spring, and a dashpot that is set by the restitution.

use std::f64::consts::FRAC_PI_2;

lennard_core::choices! {
    /// How the force grows with the depth δ of a contact.
    pub enum SpringLaw {
        /// F = k·δ.
        #[default]
        Linear = "linear",
        /// F = k·δ^{3/2}, the contact of elastic spheres.
        Hertz = "hertz",
    }
}

/// The smallest restitution that a dashpot is made for: its damping ratio ζ is 5.
pub const SMALLEST_SOFT_RESTITUTION: f64 = 0.01;

/// Energy, force and curvature of a spring at one depth δ, or of a wall at one distance z.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ForcePoint {
    /// U, ε.
    pub energy: f64,
    /// The force that pushes apart, ε/σ: dU/dδ or −dU/dz.
    pub force: f64,
    /// d²U/dδ² or d²U/dz², ε/σ².
    pub curvature: f64,
}

/// A spring with a dashpot, F = k·δ + c·δ̇ or k·δ^{3/2} + c·δ̇ at depth δ > 0. The contact never pulls: it ends at F = 0.
///
/// The dashpot is c = 2ζ·√(k·m) for the linear spring and c = √5·ζ·√(k·m)·δ^{1/4} for Hertz's, with the effective mass m. In the
/// variable y = √(4/5)·δ^{5/4} and the time ds = (√5/2)·δ^{1/4}·dt, Hertz's contact is the linear one. The restitution is
/// therefore the same function of ζ for both, at any speed ([`restitution_of`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactLaw {
    law: SpringLaw,
    stiffness: f64,
    damping_ratio: f64,
}

impl ContactLaw {
    /// A spring of a stiffness in ε/σ² (ε/σ^{5/2} for Hertz's) that keeps the share `restitution` of the speed.
    #[must_use]
    pub fn new(law: SpringLaw, stiffness: f64, restitution: f64) -> Self {
        Self { law, stiffness, damping_ratio: damping_ratio_for(restitution) }
    }

    /// Whether a dashpot takes energy.
    #[must_use]
    pub fn is_damped(&self) -> bool {
        self.damping_ratio > 0.0
    }

    /// ω = √(k/m) of a linear spring for an effective mass m, τ⁻¹; `None` where it depends on the speed.
    #[must_use]
    pub fn frequency(&self, mass: f64) -> Option<f64> {
        (self.law == SpringLaw::Linear).then(|| (self.stiffness / mass).sqrt())
    }

    /// The spring at a depth δ, σ; nothing at δ ≤ 0.
    #[must_use]
    pub fn at(&self, depth: f64) -> ForcePoint {
        let k = self.stiffness;
        if depth <= 0.0 {
            return ForcePoint::default();
        }
        match self.law {
            SpringLaw::Linear => {
                ForcePoint { energy: 0.5 * k * depth * depth, force: k * depth, curvature: k }
            }
            SpringLaw::Hertz => {
                let root = depth.sqrt();
                ForcePoint {
                    energy: 0.4 * k * depth * depth * root,
                    force: k * depth * root,
                    curvature: 1.5 * k * root,
                }
            }
        }
    }

    /// The speed of approach δ̇ after the dashpot alone has acted for a time h at a depth; both in reduced units.
    ///
    /// The decay is exact, δ̇·e^{−ch/m}. Where the bodies separate, the dashpot takes no more than the spring gives.
    #[must_use]
    pub fn damped(&self, depth: f64, speed: f64, mass: f64, h: f64) -> f64 {
        if !self.is_damped() || depth <= 0.0 {
            return speed;
        }
        let critical = (self.stiffness * mass).sqrt();
        let dashpot = match self.law {
            SpringLaw::Linear => 2.0 * self.damping_ratio * critical,
            SpringLaw::Hertz => {
                5.0_f64.sqrt() * self.damping_ratio * critical * depth.sqrt().sqrt()
            }
        };
        let decayed = speed * (-dashpot * h / mass).exp();
        if speed >= 0.0 { decayed } else { decayed.min(speed + self.at(depth).force * h / mass) }
    }
}

/// The restitution e of a contact with a damping ratio ζ that ends at F = 0:
/// e = exp(−2ζ·arccos ζ/√(1 − ζ²)), and with arcosh ζ/√(ζ² − 1) beyond ζ = 1.
#[must_use]
pub fn restitution_of(zeta: f64) -> f64 {
    let beside_one = 1.0 - zeta;
    let ratio = if beside_one.abs() < 1e-8 {
        1.0 + beside_one / 3.0
    } else if zeta < 1.0 {
        zeta.acos() / (1.0 - zeta * zeta).sqrt()
    } else {
        zeta.acosh() / (zeta * zeta - 1.0).sqrt()
    };
    (-2.0 * zeta * ratio).exp()
}

/// The damping ratio ζ that gives a restitution, by bisection of [`restitution_of`]; 0 for e = 1.
#[must_use]
pub fn damping_ratio_for(restitution: f64) -> f64 {
    if restitution >= 1.0 {
        return 0.0;
    }
    // ln e falls by more than π/2·ζ: the root lies below this bound while e is not tiny.
    let (mut low, mut high) = (0.0, FRAC_PI_2.mul_add(8.0, -restitution.ln()));
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if restitution_of(middle) > restitution {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn restitution_and_damping_ratio_are_inverse_and_have_known_values() {
        // exp(−(ζ/√(1−ζ²))·φ) with φ = atan2(2ζ√(1−ζ²), 2ζ²−1), and the same from the equation of motion.
        for (zeta, e) in [(0.2, 0.571_740), (0.5, 0.298_436), (0.8, 0.179_783)] {
            assert!((restitution_of(zeta) - e).abs() < 1e-6, "{zeta}");
        }
        assert!((restitution_of(1.0) - (-2.0_f64).exp()).abs() < 1e-12);
        for e in [SMALLEST_SOFT_RESTITUTION, 0.1, 0.135, 0.136, 0.5, 0.9, 0.999] {
            assert!((restitution_of(damping_ratio_for(e)) - e).abs() < 1e-12, "{e}");
        }
        assert_eq!(damping_ratio_for(1.0), 0.0);
    }

    /// The speed after a contact by many small steps of kick, dashpot, drift.
    fn rebound(law: &ContactLaw, speed: f64, h: f64) -> f64 {
        let (mut depth, mut v) = (1e-300, speed);
        while depth > 0.0 {
            v -= 0.5 * h * law.at(depth).force;
            v = law.damped(depth, v, 1.0, 0.5 * h);
            depth += h * v;
            v = law.damped(depth, v, 1.0, 0.5 * h);
            v -= 0.5 * h * law.at(depth).force;
        }
        -v
    }

    #[test]
    fn both_laws_keep_the_restitution_that_was_set_at_any_speed() {
        for law in [SpringLaw::Linear, SpringLaw::Hertz] {
            for e in [0.05, 0.5, 0.9, 1.0] {
                for speed in [0.1, 1.0, 10.0] {
                    let contact = ContactLaw::new(law, 1000.0, e);
                    let found = rebound(&contact, speed, 1e-5) / speed;
                    assert!((found - e).abs() < 2e-3, "{law:?} {e} {speed}: {found}");
                }
            }
        }
    }
}
