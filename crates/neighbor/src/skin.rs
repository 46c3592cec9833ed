//! The cheapest skin, from a model of the costs: a function of the scene, never of a clock.

use std::f64::consts::PI;

/// Smallest skin of the model, σ: a list with a thinner skin lasts one or two steps.
const SMALLEST_SKIN: f64 = 0.05;
/// Largest skin of the model, σ.
const LARGEST_SKIN: f64 = 1.5;

/// The speed that one particle in [`Limits::far_among`](crate::validity::Limits) exceeds, in units of the thermal speed.
///
/// A list expires when so many particles have moved by more than half the skin.
const FEW_EXCEED: f64 = 2.975;

/// Neighbors below which registers of a loop are seldom full.
const FULL_LISTS: f64 = 20.0;

/// The arguments of the cost model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkinInputs {
    /// Number of particles.
    pub n_atoms: usize,
    /// Density, σ⁻³.
    pub density: f64,
    /// Temperature, ε/k_B, of particles of unit mass.
    pub temperature: f64,
    /// Time step, τ.
    pub dt: f64,
    /// Cutoff, σ.
    pub r_cut: f64,
    /// Cost of one list build over cost of one force loop, as `benches/NOTES.md` records it.
    ///
    /// The cheapest skin depends on it weakly.
    pub build_over_force: f64,
}

/// The typical closing speed of the fastest pair among `pairs`, in units of the thermal speed √T.
///
/// It is √2·u, where u is the root of pairs·φ(u)/u³ = 1 and φ is the normal density.
/// N·2πr²ρ·s pairs start beyond r_list, within a skin s of it. One of them is expected to have crossed the skin.
#[must_use]
pub fn fastest_closing(pairs: f64) -> f64 {
    let mut u = 3.0_f64;
    for _ in 0..50 {
        let argument = pairs / ((2.0 * PI).sqrt() * u.powi(3));
        u = (2.0 * argument.max(1.5).ln()).sqrt();
    }
    2.0_f64.sqrt() * u
}

/// The speed at which a skin of `skin` σ is used up, σ/τ.
///
/// It is the speed of the fastest pair, or the speed at which too many particles have moved far.
fn closing(inputs: &SkinInputs, skin: f64) -> f64 {
    let radius = inputs.r_cut + skin;
    let pairs = inputs.n_atoms as f64 * 2.0 * PI * radius * radius * inputs.density * skin;
    let thermal = inputs.temperature.max(0.0).sqrt();
    fastest_closing(pairs).max(2.0 * FEW_EXCEED) * thermal
}

/// The skin in σ that makes a step cheapest, by the model
///
/// cost(s) = (r_cut + s)³·(1 + b·c·dt/s),
///
/// The force loop and the build (b force loops) grow with the volume of the list sphere.
/// A list lasts for s/(c·dt) steps, where c is the speed of the pair that closes in fastest, in free flight.
///
/// A list of n < 20 neighbors counts as (n + 20)/2 of them: it has constant costs, and its last register is not full.
#[must_use]
pub fn cheapest_skin(inputs: &SkinInputs) -> f64 {
    let skin = skin_of_full_lists(inputs);
    if neighbors(inputs, skin) < FULL_LISTS { skin_of_short_lists(inputs, skin) } else { skin }
}

/// The mean number of neighbors in a list, n = (4/3)π·ρ·(r_cut + s)³.
fn neighbors(inputs: &SkinInputs, skin: f64) -> f64 {
    4.0 / 3.0 * PI * inputs.density * (inputs.r_cut + skin).powi(3)
}

/// The cheapest skin of thin gases and small cutoffs, at least `from`, by the same model with
///
/// cost(s) = max(n, (n + n_full)/2)·(1 + b·c·dt/s).
///
/// Each list has a constant cost, and its last register is not full: n neighbors cost no less than half of n_full more do.
/// Measured with AVX2 at r_cut = 2.5 and densities of 0.02, 0.05 and 0.1, and for the soft repulsion of Weeks, Chandler and
/// Andersen at 0.8 (`benches/NOTES.md`).
fn skin_of_short_lists(inputs: &SkinInputs, from: f64) -> f64 {
    let cost = |skin: f64| {
        let n = neighbors(inputs, skin);
        let builds = inputs.build_over_force * closing(inputs, skin) * inputs.dt / skin;
        n.max(0.5 * (n + FULL_LISTS)) * (1.0 + builds)
    };
    // The golden section: one minimum lies between the bounds.
    let section = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (from, LARGEST_SKIN);
    for _ in 0..40 {
        let [left, right] = [high - section * (high - low), low + section * (high - low)];
        if cost(left) <= cost(right) {
            high = right;
        } else {
            low = left;
        }
    }
    0.5 * (low + high)
}

/// The cheapest skin of the model whose lists cost as much as their neighbors.
fn skin_of_full_lists(inputs: &SkinInputs) -> f64 {
    let mut skin = 0.1 * inputs.r_cut;
    // The iteration converges quickly, since the speed depends weakly on the skin.
    for _ in 0..20 {
        // d(cost)/ds = 0 is 3s² + 2k·s − k·r_cut = 0 with k = b·c·dt.
        let k = inputs.build_over_force * closing(inputs, skin) * inputs.dt;
        let root = (-k + (k * k + 3.0 * k * inputs.r_cut).sqrt()) / 3.0;
        if !root.is_finite() {
            return LARGEST_SKIN;
        }
        skin = root.clamp(SMALLEST_SKIN, LARGEST_SKIN);
    }
    skin
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::validity::Limits;

    fn inputs(temperature: f64, dt: f64) -> SkinInputs {
        SkinInputs {
            n_atoms: 32_000,
            density: 0.8442,
            temperature,
            dt,
            r_cut: 2.5,
            build_over_force: 3.5,
        }
    }

    #[test]
    fn one_pair_is_expected_to_have_closed_in() {
        for (pairs, least) in [(1e3, 3.2), (3e5, 5.0), (1e8, 6.5)] {
            let c = fastest_closing(pairs);
            let u = c / 2.0_f64.sqrt();
            let expected = pairs * (-0.5 * u * u).exp() / (2.0 * PI).sqrt() / u.powi(3);
            assert!((expected - 1.0).abs() < 1e-6, "{expected}");
            assert!((least..1.25 * least).contains(&c), "{c}");
        }
        // With hardly any pairs, the result is neither near zero nor NaN.
        assert!((1.0..2.0).contains(&fastest_closing(0.0)));
    }

    #[test]
    fn as_many_are_fast_as_the_criterion_lets_move_far() {
        // The Maxwell density √(2/π)·u²·exp(−u²/2) by the midpoint rule; speeds above 12 do not occur.
        let width = 1e-3;
        let steps = ((12.0 - FEW_EXCEED) / width) as usize;
        let density = |u: f64| (2.0 / PI).sqrt() * u * u * (-0.5 * u * u).exp();
        let chance: f64 =
            (0..steps).map(|k| width * density(FEW_EXCEED + (k as f64 + 0.5) * width)).sum();
        assert!((chance * Limits::SMALL.far_among as f64 - 1.0).abs() < 0.01, "{chance}");
    }

    #[test]
    fn the_chosen_skin_has_the_least_modelled_cost() {
        for (t, dt) in [(0.7, 0.005), (1.44, 0.004), (5.0, 0.001)] {
            let at = inputs(t, dt);
            let s = cheapest_skin(&at);
            let k = at.build_over_force * closing(&at, s) * dt;
            let cost = |s: f64| (at.r_cut + s).powi(3) * (1.0 + k / s);
            assert!(cost(s) <= cost(s * 1.01) && cost(s) <= cost(s * 0.99));
        }
    }

    #[test]
    fn short_lists_get_thicker_skins_and_full_lists_keep_theirs() {
        let gas =
            |density: f64| SkinInputs { density, build_over_force: 6.5, ..inputs(1.5, 0.005) };
        for density in [0.25, 0.4, 0.8442] {
            let full = skin_of_full_lists(&gas(density));
            assert_eq!(cheapest_skin(&gas(density)), full, "{density}");
        }
        // The cheapest skins that were measured, within the range where a step costs the same.
        for (density, range) in [(0.02, 1.0..1.5), (0.05, 0.65..1.0), (0.1, 0.5..0.8)] {
            let found = cheapest_skin(&gas(density));
            assert!(range.contains(&found), "{density}: {found}");
        }
        let soft = SkinInputs { r_cut: 2.0_f64.powf(1.0 / 6.0), ..gas(0.8) };
        let found = cheapest_skin(&soft);
        assert!((0.35..0.6).contains(&found), "{found}");
        let cold = SkinInputs { temperature: 0.0, ..soft };
        assert!(cheapest_skin(&cold) < SMALLEST_SKIN * (1.0 + 1e-6));
    }

    #[test]
    fn a_hotter_or_coarser_run_gets_a_thicker_skin_within_bounds() {
        assert!(cheapest_skin(&inputs(2.0, 0.005)) > cheapest_skin(&inputs(0.7, 0.005)));
        assert!(cheapest_skin(&inputs(0.7, 0.010)) > cheapest_skin(&inputs(0.7, 0.005)));
        assert_eq!(cheapest_skin(&inputs(0.0, 0.005)), SMALLEST_SKIN);
        assert_eq!(cheapest_skin(&inputs(f64::INFINITY, 0.005)), LARGEST_SKIN);
    }
}
