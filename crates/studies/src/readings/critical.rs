//! The critical point from coexisting densities.

use lennard_observables::statistics::Line;
use serde::Serialize;

/// The exponent β of ρ_l − ρ_v ∝ (T_c − T)^β in the universality class of fluids.
///
/// Source: A. Pelissetto and E. Vicari, Phys. Rep. 368, 549 (2002), table 5 (0.3265).
const BETA: f64 = 0.326;
/// The fewest temperatures from which a critical point is estimated.
const FEWEST: usize = 3;

/// Vapor and liquid at one temperature, with errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    pub temperature: f64,
    pub vapor: [f64; 2],
    pub liquid: [f64; 2],
}

impl Pair {
    /// ½(ρ_l + ρ_v), σ⁻³, with its error.
    pub fn diameter(&self) -> [f64; 2] {
        [0.5 * (self.liquid[0] + self.vapor[0]), 0.5 * self.error()]
    }

    fn error(&self) -> f64 {
        self.liquid[1].hypot(self.vapor[1])
    }
}

/// A critical point with standard errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct CriticalEstimate {
    /// T_c, ε/k_B.
    pub temperature: f64,
    /// Its standard error.
    pub temperature_error: f64,
    /// ρ_c, σ⁻³.
    pub density: f64,
    /// Its standard error.
    pub density_error: f64,
    /// Temperatures that it comes from.
    pub temperatures: usize,
}

/// The critical point by (ρ_l − ρ_v)^{1/β} = B·(T_c − T) and by the law of rectilinear diameters, ½(ρ_l + ρ_v) = ρ_c + A·(T_c − T).
///
/// Both laws hold near the critical point. Points far below bias the estimate by more than its statistical error.
pub(super) fn estimate(pairs: &[Pair]) -> Option<CriticalEstimate> {
    if pairs.len() < FEWEST {
        return None;
    }
    let power = 1.0 / BETA;
    let contrasts: Vec<(f64, f64, f64)> = pairs
        .iter()
        .map(|p| {
            let contrast = p.liquid[0] - p.vapor[0];
            let slope = power * contrast.powf(power - 1.0);
            (p.temperature, contrast.powf(power), slope * p.error())
        })
        .collect();
    let diameters: Vec<(f64, f64, f64)> = pairs
        .iter()
        .map(|p| {
            let [value, error] = p.diameter();
            (p.temperature, value, error)
        })
        .collect();
    let closing = Line::with_errors(&contrasts)?;
    let diameter = Line::with_errors(&diameters)?;
    let (temperature, temperature_error) = closing.zero();
    let hottest = pairs.iter().map(|p| p.temperature).fold(0.0, f64::max);
    (closing.slope() < 0.0 && temperature > hottest).then(|| CriticalEstimate {
        temperature,
        temperature_error,
        density: diameter.at(temperature),
        density_error: diameter.error_at(temperature).hypot(diameter.slope() * temperature_error),
        temperatures: pairs.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(temperature: f64, error: f64) -> Pair {
        let below = 1.08 - temperature;
        let (middle, half) = (0.32 + 0.2 * below, 0.5 * 1.1 * below.powf(BETA));
        Pair { temperature, vapor: [middle - half, error], liquid: [middle + half, error] }
    }

    #[test]
    fn the_laws_themselves_give_back_the_critical_point() {
        let pairs = [0.9, 0.95, 1.0, 1.04].map(|t| exact(t, 1e-3));
        let found = estimate(&pairs).unwrap();
        assert!((found.temperature - 1.08).abs() < 1e-10, "{found:?}");
        assert!((found.density - 0.32).abs() < 1e-10, "{found:?}");
        assert!(found.temperature_error > 0.0 && found.temperature_error < 0.01);
        assert!(found.density_error > 0.0 && found.density_error < 0.01);
        assert_eq!(estimate(&pairs[..2]), None);
    }

    #[test]
    fn the_errors_cover_noise_of_the_size_that_is_stated() {
        let seeds = 400;
        let mut within = [0; 2];
        for seed in 0..seeds {
            let mut pairs = [0.9, 0.94, 0.98, 1.02].map(|t| exact(t, 2e-3));
            let mut noise = lennard_core::random::Streams::new(seed).sequential("noise");
            for pair in &mut pairs {
                for density in [&mut pair.vapor[0], &mut pair.liquid[0]] {
                    // Twelve uniform numbers less six have unit variance.
                    let normal: f64 = (0..12)
                        .map(|_| {
                            (rand::Rng::next_u64(&mut noise) >> 11) as f64 / (1_u64 << 53) as f64
                        })
                        .sum::<f64>()
                        - 6.0;
                    *density += 2e-3 * normal;
                }
            }
            let found = estimate(&pairs).unwrap();
            within[0] += usize::from((found.temperature - 1.08).abs() < found.temperature_error);
            within[1] += usize::from((found.density - 0.32).abs() < found.density_error);
        }
        // 68 % where errors are right, and more where chance widens them.
        for count in within {
            let share = count as f64 / seeds as f64;
            assert!((0.60..0.85).contains(&share), "{within:?}");
        }
    }

    #[test]
    fn densities_that_do_not_close_have_no_critical_point() {
        let mut pairs = [0.9, 0.95, 1.0].map(|t| exact(t, 1e-3));
        pairs.reverse();
        for (pair, t) in pairs.iter_mut().zip([0.9, 0.95, 1.0]) {
            pair.temperature = t;
        }
        assert_eq!(estimate(&pairs), None);
    }
}
