//! What response functions are made of, and how all of them follow from a few.

use crate::Ensemble;
use crate::thermodynamics::EndSums;

/// How Σ r²u″ follows from the energy and the virial of the same pairs: X = `of_virial`·W − `of_energy`·U.
///
/// For a Mie potential r²u″ = (n + m + 1)(−r u′) − n m u holds pair by pair, so that no sum over pairs is needed. Mean tail
/// corrections obey the same line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curvature {
    /// n + m + 1 of a Mie potential.
    pub of_virial: f64,
    /// n·m of a Mie potential.
    pub of_energy: f64,
    /// Whether the fluid is the one of the truncated potential. With a tail it is the full one, which has no end.
    pub of_truncated: bool,
}

impl Curvature {
    /// What the end of a truncated potential adds to X: −Σ U′·r²·δ(r − r_cut), and the energy that a shift took from the pairs.
    pub(crate) fn of_ends(&self, ends: &EndSums) -> f64 {
        if self.of_truncated { -ends.jump_r2 - self.of_energy * ends.shift } else { 0.0 }
    }
}

/// What response functions need to know besides the series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Setting {
    pub ensemble: Ensemble,
    /// `None` where Σ r²u″ does not follow from U and W.
    pub curvature: Option<Curvature>,
    pub n_dof: f64,
    /// Mass of a particle.
    pub mass: f64,
    /// The mean volume, σ³.
    pub volume: f64,
}

/// How many response functions there are.
pub(super) const COUNT: usize = 11;

/// Their values, c_v first; not a number where the ensemble does not give one.
pub(crate) type Values = [f64; COUNT];

/// What the others follow from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Base {
    /// σ⁻³.
    pub density: f64,
    /// ε/k_B.
    pub temperature: f64,
    /// c_v per particle, k_B.
    pub heat_capacity: f64,
    /// γ_V = ∂P/∂T at constant volume.
    pub pressure_slope: f64,
    /// ∂P/∂ρ at constant temperature.
    pub dp_drho: f64,
    /// The mass of a particle.
    pub mass: f64,
    /// ⟨δU δW⟩/√(⟨δU²⟩⟨δW²⟩) at constant temperature.
    pub correlation: f64,
}

impl Base {
    /// All response functions of atoms, by relations of thermodynamics.
    pub(super) fn all(self) -> Values {
        let Self {
            density: rho,
            temperature: t,
            heat_capacity: c_v,
            pressure_slope: gamma,
            dp_drho,
            ..
        } = self;
        let expansion = t * (gamma / rho).powi(2);
        let of_sound = dp_drho + expansion / c_v;
        let kappa_t = 1.0 / (rho * dp_drho);
        [
            c_v,
            c_v + expansion / dp_drho,
            gamma,
            kappa_t,
            1.0 / (rho * of_sound),
            gamma * kappa_t,
            (of_sound / self.mass).sqrt(),
            (t * gamma / rho - dp_drho) / (rho * (c_v * dp_drho + expansion)),
            gamma / (rho * c_v),
            (gamma / rho - 1.0) / (c_v - 1.5),
            self.correlation,
        ]
    }
}
