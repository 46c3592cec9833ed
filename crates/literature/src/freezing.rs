//! Freezing and melting lines of the full Lennard-Jones potential.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::bisection::bisect;
use crate::equation::EquationOfState;
use crate::saturation::Saturation;

/// The triple point is looked for between the lowest temperature of an equation and this one, ε/k_B.
const ABOVE_TRIPLE: f64 = 0.8;
/// Halvings of the range of temperatures: to 10⁻⁹.
const HALVINGS: usize = 30;

/// Densities at which the liquid freezes and the crystal melts,
/// ρ = β^{−1/4} Σ c_k βᵏ with β = 1/T (E. A. Mastny, J. J. de Pablo, Melting line of the
/// Lennard-Jones system, infinite size, and full potential, J. Chem. Phys. 127, 104504, 2007,
/// Eqs. 20 and 21, and an older fit of the same form).
#[derive(Debug, Clone, Deserialize)]
pub struct FreezingLine {
    /// A short name for legends.
    pub name: String,
    /// Where it comes from.
    pub citation: String,
    /// Its DOI; `None` where it is not known.
    pub doi: Option<String>,
    /// How the coefficients were obtained.
    pub status: String,
    /// Temperature of the triple point in ε/k_B, below which the line has no meaning.
    pub t_triple: f64,
    /// How the triple temperature was obtained.
    pub t_triple_status: String,
    solid: Vec<f64>,
    liquid: Vec<f64>,
}

impl FreezingLine {
    /// The density in σ⁻³ above which the liquid at `temperature` (ε/k_B) is only metastable;
    /// `None` below the triple point.
    #[must_use]
    pub fn freezing_density(&self, temperature: f64) -> Option<f64> {
        self.on_line(&self.liquid, temperature)
    }

    /// The density in σ⁻³ below which the crystal at `temperature` (ε/k_B) begins to melt;
    /// `None` below the triple point.
    #[must_use]
    pub fn melting_density(&self, temperature: f64) -> Option<f64> {
        self.on_line(&self.solid, temperature)
    }

    fn on_line(&self, coefficients: &[f64], temperature: f64) -> Option<f64> {
        (temperature >= self.t_triple).then(|| series(coefficients, temperature))
    }

    /// Where the line crosses the saturated liquid of an equation; `None` where it does not, and for equations of other models.
    #[must_use]
    pub fn triple_point(&self, equation: &dyn EquationOfState) -> Option<Saturation> {
        if !equation.has_freezing_line() {
            return None;
        }
        let excess = |t: f64| {
            let liquid = equation.saturation(t)?.liquid_density;
            Some(liquid - series(&self.liquid, t))
        };
        // The saturated liquid is denser than the freezing one below the triple point.
        let (low, high) = (equation.spec().range.t_min, ABOVE_TRIPLE);
        if !(excess(low)? > 0.0 && excess(high)? < 0.0) {
            return None;
        }
        let [low, high] = bisect(low, high, HALVINGS, |t| excess(t).is_some_and(|x| x > 0.0));
        equation.saturation(0.5 * (low + high))
    }
}

/// β^{−1/4} Σ c_k βᵏ.
fn series(coefficients: &[f64], temperature: f64) -> f64 {
    let beta = 1.0 / temperature;
    let series = coefficients.iter().rev().fold(0.0, |sum, c| sum * beta + c);
    series * beta.powf(-0.25)
}

static LINE: LazyLock<FreezingLine> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../data/freezing-mastny-de-pablo-2007.json"))
        .expect("the shipped freezing line is well formed: a test reads it")
});

static OLDER: LazyLock<FreezingLine> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../data/freezing-van-der-hoef-2000.json"))
        .expect("the shipped freezing line is well formed: a test reads it")
});

/// All freezing lines of the full Lennard-Jones potential, the one that judges phases first.
#[must_use]
pub fn freezing_lines() -> [&'static FreezingLine; 2] {
    [&LINE, &OLDER]
}

/// The freezing lines of the model of an equation, the one that judges phases first; none where the model has no known line.
#[must_use]
pub fn freezing_lines_of(equation: &dyn EquationOfState) -> Vec<&'static FreezingLine> {
    let lines = freezing_lines().into_iter();
    lines.filter(|_| equation.has_freezing_line()).collect()
}

/// The freezing line of the full Lennard-Jones potential that judges phases.
#[must_use]
pub fn freezing_line() -> &'static FreezingLine {
    &LINE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn freezing_and_melting_densities_are_the_tabulated_ones() {
        // Evaluated independently from the same coefficients, five digits.
        for (t, freeze, melt) in
            [(0.7, 0.84750, 0.96151), (1.0, 0.91857, 1.00628), (2.74, 1.13886, 1.20239)]
        {
            let line = freezing_line();
            assert!((line.freezing_density(t).unwrap() - freeze).abs() < 5e-6);
            assert!((line.melting_density(t).unwrap() - melt).abs() < 5e-6);
        }
    }

    #[test]
    fn both_lines_meet_the_saturated_liquid_at_a_triple_point_near_their_own() {
        let equation = crate::thol_2016();
        for (line, pressure) in freezing_lines().into_iter().zip([0.00125, 0.00113]) {
            let found = line.triple_point(equation).unwrap();
            assert!((found.temperature - line.t_triple).abs() < 5e-4, "{found:?}");
            assert!((found.pressure - pressure).abs() < 2e-5, "{found:?}");
            let freezing = series(&line.liquid, found.temperature);
            assert!((found.liquid_density - freezing).abs() < 1e-8);
            // Lines of the full potential say nothing of another model.
            assert!(line.triple_point(crate::thol_2015()).is_none());
        }
        assert_eq!(freezing_lines_of(equation).len(), 2);
        assert!(freezing_lines_of(crate::thol_2015()).is_empty());
    }

    #[test]
    fn there_is_no_freezing_liquid_below_the_triple_point() {
        assert_eq!(freezing_line().freezing_density(0.6), None);
        assert_eq!(freezing_line().freezing_density(f64::NAN), None);
    }
}
