//! The skin near the cheapest, from a model of the costs: a function of the scene, never of a clock.

use crate::criterion::FARTHEST_TOGETHER;

/// Smallest skin that is ever chosen, σ: below it a list lasts a step or two.
const SMALLEST_SKIN: f64 = 0.05;
/// Largest skin that is ever chosen, σ.
const LARGEST_SKIN: f64 = 1.5;

/// What the choice depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkinInputs {
    /// Number of particles.
    pub n_atoms: usize,
    /// Temperature, ε/k_B, of particles of unit mass.
    pub temperature: f64,
    /// Time step, τ.
    pub dt: f64,
    /// Cutoff, σ.
    pub r_cut: f64,
    /// Cost of building the list over cost of one force loop with it, as `benches/NOTES.md` records it. The optimum is
    /// flat in it.
    pub build_over_force: f64,
}

/// The speed that the fastest of `n` particles has, typically, in units of the thermal speed √T.
///
/// The root u of n·√(2/π)·u·exp(−u²/2) = 1: the expected number of particles beyond it is one.
#[must_use]
pub fn fastest_of(n: usize) -> f64 {
    let n = n.max(2) as f64;
    let mut u = (2.0 * n.ln()).sqrt();
    for _ in 0..20 {
        let argument = n * (2.0 / std::f64::consts::PI).sqrt() * u;
        u = (2.0 * argument.max(1.5).ln()).sqrt();
    }
    u
}

/// The skin in σ that makes a step cheapest, by the model
///
/// cost(s) = (r_cut + s)³·(1 + b·2v·dt/(1.3·s)),
///
/// in which the force loop and the build (b force loops) grow with the volume of the list sphere, and a
/// list lasts for 1.3·s/(2v·dt) steps with v the speed of the fastest particle, which moves freely while it
/// crosses 0.65 of a skin.
#[must_use]
pub fn cheapest_skin(inputs: &SkinInputs) -> f64 {
    let speed = fastest_of(inputs.n_atoms) * inputs.temperature.max(0.0).sqrt();
    let closing = 2.0 * speed * inputs.dt / FARTHEST_TOGETHER;
    // d(cost)/ds = 0 is 3s² + 2k·s − k·r_cut = 0 with k = b·closing.
    let k = inputs.build_over_force * closing;
    let root = (-k + (k * k + 3.0 * k * inputs.r_cut).sqrt()) / 3.0;
    if root.is_finite() {
        root.clamp(SMALLEST_SKIN, LARGEST_SKIN)
    } else {
        LARGEST_SKIN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inputs(temperature: f64, dt: f64) -> SkinInputs {
        SkinInputs {
            n_atoms: 32_000,
            temperature,
            dt,
            r_cut: 2.5,
            build_over_force: 3.5,
        }
    }

    #[test]
    fn the_fastest_of_many_particles_follows_the_maxwell_tail() {
        // The number expected beyond u is n·(erfc(u/√2) + √(2/π)·u·exp(−u²/2)), a little over 1.
        let u = fastest_of(32_000);
        let beyond = 32_000.0 * (2.0 / std::f64::consts::PI).sqrt() * u * (-u * u / 2.0).exp();
        assert!((beyond - 1.0).abs() < 1e-6, "{beyond}");
    }

    #[test]
    fn the_chosen_skin_has_the_least_modelled_cost() {
        for (t, dt) in [(0.7, 0.005), (1.44, 0.004), (5.0, 0.001)] {
            let at = inputs(t, dt);
            let closing = 2.0 * fastest_of(at.n_atoms) * t.sqrt() * dt / FARTHEST_TOGETHER;
            let k = at.build_over_force * closing;
            let cost = |s: f64| (at.r_cut + s).powi(3) * (1.0 + k / s);
            let s = cheapest_skin(&at);
            assert!(cost(s) <= cost(s * 1.01) && cost(s) <= cost(s * 0.99));
        }
    }

    #[test]
    fn a_hotter_or_coarser_run_gets_a_thicker_skin_within_bounds() {
        assert!(cheapest_skin(&inputs(2.0, 0.005)) > cheapest_skin(&inputs(0.7, 0.005)));
        assert!(cheapest_skin(&inputs(0.7, 0.010)) > cheapest_skin(&inputs(0.7, 0.005)));
        assert_eq!(cheapest_skin(&inputs(0.0, 0.005)), SMALLEST_SKIN);
        assert_eq!(cheapest_skin(&inputs(f64::INFINITY, 0.005)), LARGEST_SKIN);
    }
}
