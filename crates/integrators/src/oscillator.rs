//! The damped harmonic oscillator, in each form in which a method may be given it: as a force, as an
//! exact solution, as a constraint. The stability study and the conformance tests run on it.

use glam::DMat2;
use lennard_core::{
    Backend, Configuration, Constraint, DVec3, Energetics, ExactSolution, ForceError,
    ForceProperties, ForceTerm, Part, Want,
};

/// The force F = −k·x − c·v on every particle, towards the origin, in all three directions.
///
/// With damping it depends on velocities. It splits for RESPA into a near part of
/// [`HarmonicForces::NEAR_SHARE`]·k and a far part of the rest.
#[derive(Debug, Clone, PartialEq)]
pub struct HarmonicForces {
    stiffness: f64,
    damping: f64,
}

impl HarmonicForces {
    /// Share of the stiffness that belongs to [`Part::Near`]: most of it, as with the repulsive core
    /// of a pair force.
    pub const NEAR_SHARE: f64 = 0.75;

    /// A spring of stiffness k, in ε/σ².
    #[must_use]
    pub fn new(stiffness: f64) -> Self {
        Self { stiffness, damping: 0.0 }
    }

    /// With a damper c, in ε·τ/σ², beside the spring.
    #[must_use]
    pub fn with_damping(self, damping: f64) -> Self {
        Self { damping, ..self }
    }
}

lennard_core::remembers_nothing!(HarmonicForces { stiffness, damping });

impl ForceTerm for HarmonicForces {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        let k = self.stiffness
            * match part {
                Part::All => 1.0,
                Part::Near => Self::NEAR_SHARE,
                Part::Far => 1.0 - Self::NEAR_SHARE,
            };
        for (particle, (f, x)) in forces.iter_mut().zip(at.positions).enumerate() {
            if !x.is_finite() {
                return Err(ForceError::NonFinitePosition { particle });
            }
            *f = -k * *x;
        }
        if self.damping != 0.0 {
            let velocities = at.velocities.ok_or(ForceError::NeedsVelocities)?;
            for (f, v) in forces.iter_mut().zip(velocities) {
                *f -= self.damping * *v;
            }
        }
        let energy =
            want.energy.then(|| at.positions.iter().map(|x| 0.5 * k * x.length_squared()).sum());
        Ok(Energetics {
            potential_energy: energy,
            conserved_potential: energy,
            laplacian: want.laplacian.then_some(3.0 * k * forces.len() as f64),
            ..Energetics::default()
        })
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties {
            velocity_dependent: self.damping != 0.0,
            linear: true,
            splits: self.damping == 0.0,
            ..ForceProperties::default()
        }
    }

    fn hessian_vector(
        &mut self,
        _at: Configuration<'_>,
        direction: &[DVec3],
        out: &mut [DVec3],
    ) -> Result<(), ForceError> {
        for (o, d) in out.iter_mut().zip(direction) {
            *o = self.stiffness * *d;
        }
        Ok(())
    }
}

impl Backend for HarmonicForces {}

/// The known solution of m·ẍ = −k·x − c·ẋ, for every component of every particle.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactOscillator {
    omega_squared: f64,
    decay_rate: f64,
}

impl ExactOscillator {
    /// A spring of stiffness k (ε/σ²) and a damper c (ε·τ/σ²) on the mass m.
    #[must_use]
    pub fn new(stiffness: f64, damping: f64, mass: f64) -> Self {
        Self { omega_squared: stiffness / mass, decay_rate: damping / (2.0 * mass) }
    }

    /// The map of (x, v) over a time t:
    /// e^{−βt}·[[C + β·S, S], [−ω²·S, C − β·S]] with β = c/(2m), ω² = k/m and, by the sign of
    /// ω² − β² = ±w²: C = cos wt, S = sin(wt)/w, or their hyperbolic twins, or 1 and t at zero.
    #[must_use]
    pub fn map(&self, t: f64) -> DMat2 {
        let beta = self.decay_rate;
        let discriminant = self.omega_squared - beta * beta;
        let w = discriminant.abs().sqrt();
        let (c, s) = if discriminant > 0.0 {
            ((w * t).cos(), (w * t).sin() / w)
        } else if discriminant < 0.0 {
            ((w * t).cosh(), (w * t).sinh() / w)
        } else {
            (1.0, t)
        };
        DMat2::from_cols_array_2d(&[[c + beta * s, -self.omega_squared * s], [s, c - beta * s]])
            * (-beta * t).exp()
    }
}

impl ExactSolution for ExactOscillator {
    fn advance(&self, positions: &mut [DVec3], velocities: &mut [DVec3], dt: f64) {
        let [[xx, vx], [xv, vv]] = self.map(dt).to_cols_array_2d();
        for (x, v) in positions.iter_mut().zip(velocities) {
            (*x, *v) = (xx * *x + xv * *v, vx * *x + vv * *v);
        }
    }
}

/// The oscillator as a constraint: g(q) is the x component of particle 0, with compliance 1/k and
/// damping time c/k, so that m·ẍ = −k·x − c·ẋ where it is solved for.
#[derive(Debug, Clone, PartialEq)]
pub struct OscillatorConstraint {
    compliance: f64,
    damping_time: f64,
}

impl OscillatorConstraint {
    /// A constraint of compliance ε = 1/k (0 for a rigid one, σ²/ε) and damping time τ = c/k.
    #[must_use]
    pub fn new(compliance: f64, damping_time: f64) -> Self {
        Self { compliance, damping_time }
    }

    /// The constraint that stands for a spring of stiffness k with a damper c beside it.
    #[must_use]
    pub fn spring(stiffness: f64, damping: f64) -> Self {
        Self::new(stiffness.recip(), damping / stiffness)
    }
}

impl Constraint for OscillatorConstraint {
    fn value(&self, positions: &[DVec3]) -> f64 {
        positions[0].x
    }

    fn gradient(&self, _positions: &[DVec3], out: &mut Vec<(usize, DVec3)>) {
        out.push((0, DVec3::X));
    }

    fn compliance(&self) -> f64 {
        self.compliance
    }

    fn damping_time(&self) -> f64 {
        self.damping_time
    }
}
