//! The one-step map on the oscillator: a 2×2 matrix on (x, v), and what follows from it.

use glam::{DMat2, DVec2};

/// The linear map of (x, v) over one step, and its properties.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StepMap(pub(crate) DMat2);

impl StepMap {
    pub(crate) fn trace(self) -> f64 {
        self.0.x_axis.x + self.0.y_axis.y
    }

    pub(crate) fn determinant(self) -> f64 {
        self.0.determinant()
    }

    /// The spectral radius ρ, the amplification per step: both eigenvalues λ solve λ² − T·λ + D = 0, so
    /// ρ = √D where they are complex and (|T| + √(T² − 4D))/2 where they are real.
    pub(crate) fn radius(self) -> f64 {
        let (t, d) = (self.trace(), self.determinant());
        let discriminant = t * t - 4.0 * d;
        if discriminant < 0.0 { d.sqrt() } else { 0.5 * (t.abs() + discriminant.sqrt()) }
    }

    /// The angle θ in (0, π) by which a complex eigenvalue turns per step; `None` where they are real.
    pub(crate) fn phase(self) -> Option<f64> {
        let (t, d) = (self.trace(), self.determinant());
        let discriminant = 4.0 * d - t * t;
        (discriminant > 0.0).then(|| discriminant.sqrt().atan2(t))
    }

    /// The amplitude of x_n = |λ|ⁿ·(x_0·cos nθ + B·sin nθ) from the start (x_0, v_0), which is
    /// √(x_0² + B²) with B = (x_1 − x_0·|λ|·cos θ)/(|λ|·sin θ); `None` where the eigenvalues are real.
    pub(crate) fn amplitude(self, x: f64, v: f64) -> Option<f64> {
        let theta = self.phase()?;
        let modulus = self.determinant().sqrt();
        let next = (self.0 * DVec2::new(x, v)).x;
        let b = (next - x * modulus * theta.cos()) / (modulus * theta.sin());
        Some(x.hypot(b))
    }

    /// The map that takes each of three consecutive states of one run to the next one:
    /// M = [z₁ z₂]·[z₀ z₁]⁻¹.
    pub(crate) fn from_states(z: [DVec2; 3]) -> Self {
        Self(DMat2::from_cols(z[1], z[2]) * DMat2::from_cols(z[0], z[1]).inverse())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damped_rotation_has_its_radius_phase_and_amplitude() {
        let (r, theta) = (0.97, 0.4_f64);
        let map = StepMap(DMat2::from_angle(-theta) * r);
        assert!((map.radius() - r).abs() < 1e-15);
        assert!((map.phase().unwrap() - theta).abs() < 1e-15);
        // For a pure rotation of (x, v) the amplitude is the length of the start.
        assert!((map.amplitude(3.0, 4.0).unwrap() - 5.0).abs() < 1e-14);
        let states = [0, 1, 2].map(|n| (0..n).fold(DVec2::new(1.0, 2.0), |z, _| map.0 * z));
        assert!(
            (StepMap::from_states(states).0 - map.0)
                .to_cols_array()
                .iter()
                .all(|d| d.abs() < 1e-14)
        );
    }

    #[test]
    fn real_eigenvalues_have_no_phase_and_the_larger_one_counts() {
        let map = StepMap(DMat2::from_diagonal(DVec2::new(-3.0, -1.0 / 3.0)));
        assert!((map.radius() - 3.0).abs() < 1e-15);
        assert_eq!(map.phase(), None);
        assert_eq!(map.amplitude(1.0, 0.0), None);
    }
}
