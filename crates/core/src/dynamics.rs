//! What an integrator may know of the system: masses, degrees of freedom, constraints, the exact solution.

use std::sync::Arc;

use glam::DVec3;

/// The masses of the particles.
#[derive(Debug, Clone, PartialEq)]
pub enum Masses {
    /// All particles have this mass.
    Uniform(f64),
    /// One mass a particle, `[N]`.
    Each(Vec<f64>),
}

impl Masses {
    /// The mass of particle `i`.
    #[inline]
    #[must_use]
    pub fn of(&self, i: usize) -> f64 {
        match self {
            Self::Uniform(m) => *m,
            Self::Each(m) => m[i],
        }
    }
}

/// A known solution of the equations of motion, against which methods are measured.
pub trait ExactSolution: Send + Sync + std::fmt::Debug {
    /// Advances positions and velocities exactly by `dt`.
    fn advance(&self, positions: &mut [DVec3], velocities: &mut [DVec3], dt: f64);
}

/// One holonomic constraint ε·λ + g(q) + τ·ġ(q) = 0 with G = ∂g/∂q
/// (Lacoursière, Ghosts and Machines, 2007; compliance ε = 1/k, damping time τ = c/k).
pub trait Constraint: Send + Sync + std::fmt::Debug {
    /// The constraint's value g(q).
    fn value(&self, positions: &[DVec3]) -> f64;
    /// Its gradient G = ∂g/∂q, `[N]`, written to `out`.
    fn gradient(&self, positions: &[DVec3], out: &mut [DVec3]);
    /// Compliance ε ≥ 0, the inverse of a stiffness.
    fn compliance(&self) -> f64;
    /// Damping time τ ≥ 0.
    fn damping_time(&self) -> f64;
}

/// What stays the same while a system moves.
#[derive(Debug, Clone)]
pub struct Dynamics {
    /// Particle masses.
    pub masses: Masses,
    /// Degrees of freedom in T = 2K/n_dof: 3N − 3 where total momentum is conserved (and zero), 3N otherwise.
    pub n_dof: f64,
    /// Constraints, for the methods that solve for them.
    pub constraints: Vec<Arc<dyn Constraint>>,
    /// The exact solution, if one is known.
    pub exact: Option<Arc<dyn ExactSolution>>,
}

impl Dynamics {
    /// A free system of `n` particles of unit mass whose total momentum is conserved: n_dof = 3N − 3
    /// (and 3 for a single particle, which has nothing to share its momentum with).
    #[must_use]
    pub fn fluid(n: usize) -> Self {
        let n_dof = if n > 1 { 3.0 * n as f64 - 3.0 } else { 3.0 };
        Self {
            masses: Masses::Uniform(1.0),
            n_dof,
            constraints: Vec::new(),
            exact: None,
        }
    }

    /// The kinetic energy K = Σ ½ m v² in ε, summed in the order of the particles.
    #[must_use]
    pub fn kinetic_energy(&self, velocities: &[DVec3]) -> f64 {
        crate::parallel::ordered_sum(velocities.len(), |range| {
            range
                .map(|i| 0.5 * self.masses.of(i) * velocities[i].length_squared())
                .sum()
        })
    }

    /// The kinetic temperature T = 2K/n_dof, in ε/k_B.
    #[must_use]
    pub fn temperature(&self, velocities: &[DVec3]) -> f64 {
        2.0 * self.kinetic_energy(velocities) / self.n_dof
    }

    /// The total momentum Σ m v.
    #[must_use]
    pub fn momentum(&self, velocities: &[DVec3]) -> DVec3 {
        crate::parallel::ordered_sum(velocities.len(), |range| {
            range.map(|i| self.masses.of(i) * velocities[i]).sum()
        })
    }
}
