//! SPOOK at k = ∞ (ε = 0): the one-step map derived, and measured over many steps. Without damping it is the map of
//! symplectic Euler at its limit k = 4m/h².

use lennard_observables::Table;

use super::displacement::{MASS, STEP};
use super::groups::entry;
use super::map::StepMap;
use super::oscillator::{Spring, map_of};
use crate::StudyError;
use crate::claims::Measured;
use crate::report::significant;

const SPOOK: &str = "spook";
/// Steps of the runs with ε = 0.
const STEPS: u32 = 100_000;
/// Damping times of the runs, in steps: none, one with complex eigenvalues, the critical one, one beyond.
const DAMPING_STEPS: [f64; 5] = [0.0, 0.1, 1.0, 2.0, 10.0];
/// Stiffnesses on the way to ∞, as ωh.
const APPROACH: [f64; 4] = [10.0, 1e2, 1e3, 1e4];
/// Steps shown in figures.
const SHOWN: u32 = 10_000;

/// The map at ε = 0 on (x, h·v): [[1 − 4γ, γ], [−4γ, γ]], whose eigenvalues solve
/// λ² − (1 − 3γ)·λ + γ = 0.
pub(crate) fn rigid_map(gamma: f64) -> StepMap {
    StepMap(glam::DMat2::from_cols_array_2d(&[[1.0 - 4.0 * gamma, -4.0 * gamma], [gamma, gamma]]))
}

fn shown_steps() -> Vec<u32> {
    let mut steps: Vec<u32> =
        (0..=160).map(|i| f64::from(SHOWN).powf(f64::from(i) / 160.0).round() as u32).collect();
    steps.dedup();
    steps
}

/// A run, and what theory has for it.
struct Run {
    name: String,
    /// |x| from the start on, one per step, σ.
    x: Vec<f64>,
    /// The one-step map that its first states show.
    map: StepMap,
    /// The spectral radius by theory.
    radius: Option<f64>,
    /// max |x| in σ, by theory and over enough steps for more than a whole beat.
    amplitude: Option<(f64, f64)>,
}

fn largest(x: &[f64]) -> f64 {
    x.iter().copied().fold(0.0, f64::max)
}

impl Run {
    fn of(
        method: &'static str,
        name: String,
        spring: Spring,
        steps: u32,
    ) -> Result<Self, StudyError> {
        let path = spring.path(entry(method)?, START, STEP, steps)?;
        let x = path.iter().map(|z| z.x.abs()).collect();
        Ok(Self { name, x, map: map_of(&path), radius: None, amplitude: None })
    }

    /// max |x| of the second half of the run over the same of the first half: 2 for linear growth.
    fn growth(&self) -> f64 {
        let (first, second) = self.x[1..].split_at(self.x.len() / 2);
        largest(second) / largest(first)
    }

    /// Largest relative deviation of |x_n| from 2n + 1.
    fn off_the_line(&self) -> f64 {
        let off = |(n, x): (usize, &f64)| (x / (2.0 * n as f64 + 1.0) - 1.0).abs();
        self.x.iter().enumerate().map(off).fold(0.0, f64::max)
    }
}

/// Where all runs start: x = 1 σ, at rest.
const START: (f64, f64) = (1.0, 0.0);

/// Measures SPOOK at ε = 0 with each damping time and at large finite stiffnesses, and symplectic Euler at its limit. The
/// limit has the map [[−3, 1], [−4, 1]] on (x, h·v), which SPOOK has at ε = 0 and τ = 0.
pub(super) fn measure(quick: bool, found: &mut Measured) -> Result<(), StudyError> {
    let steps = if quick { STEPS / 5 } else { STEPS };
    let limit = Spring::Stiffness(4.0 * MASS / (STEP * STEP));
    let at_limit = Run::of("symplectic-euler", "k = 4m/h²".into(), limit, steps)?;
    let mut runs = Vec::new();
    for damping_steps in DAMPING_STEPS {
        let damping_time = damping_steps * STEP;
        let spring = Spring::Constraint { compliance: 0.0, damping_time };
        let radius = rigid_map(1.0 / (1.0 + 4.0 * damping_steps)).radius();
        let name = format!("k = inf, tau/h = {damping_steps}");
        let run = Run::of(SPOOK, name, spring, steps)?;
        if damping_steps != 0.0 {
            let number = found.numbers.add("radius at k = ∞", run.map.radius());
            number.of("tau", damping_steps).theory(radius);
        }
        runs.push(Run { radius: Some(radius), ..run });
    }
    let n = f64::from(steps);
    for (at, run) in [("k = 4m/h²", &at_limit), ("k = ∞", &runs[0])] {
        let number = found.numbers.add("growth with one eigenvector", run.growth());
        number.of("at", at).theory((2.0 * n + 1.0) / (n + 1.0));
    }
    found.word("steps at infinity", steps.to_string());
    found.word("last displacement", significant(runs[0].x[steps as usize], 7));
    found.word("deviation", significant(runs[0].off_the_line(), 1));
    found.word("deviation at the limit", significant(at_limit.off_the_line(), 1));
    for omega_h in APPROACH {
        let spring = Spring::Stiffness((omega_h / STEP).powi(2));
        // Near the end of the line x turns by π − 4/(ωh) per step: a beat takes π·ωh/4 steps.
        let enough = (4.0 * omega_h) as u32 + 1000;
        let run = Run::of(SPOOK, format!("omega h = {omega_h}"), spring, enough.max(SHOWN))?;
        let measured = largest(&run.x[..=enough as usize]);
        runs.push(Run { amplitude: Some((1.0_f64.hypot(0.5 * omega_h), measured)), ..run });
    }
    let mut shown = Vec::new();
    for run in &runs {
        let mut largest = 0.0_f64;
        for n in shown_steps() {
            let x = run.x[n as usize];
            largest = largest.max(x);
            shown.push((&run.name, n, x, largest));
        }
    }
    let curves = Table::rows_of("infinite-stiffness", &shown)
        .column("run", |p| p.0)
        .column("step", |p| p.1)
        .column("|x| [σ]", |p| p.2)
        .column("largest |x|", |p| p.3)
        .column("2n + 1", |p| 2.0 * f64::from(p.1) + 1.0);
    found.curves.push(curves.table());
    runs.push(at_limit);
    let table = Table::rows_of("at-infinity", &runs)
        .column("run", |r| &r.name)
        .column("radius by theory", |r| r.radius)
        .column("radius measured", |r| r.map.radius())
        .column("amplitude by theory [σ]", |r| r.amplitude.map(|amplitude| amplitude.0))
        .column("amplitude measured [σ]", |r| r.amplitude.map(|amplitude| amplitude.1))
        .column("growth of halves", Run::growth)
        .column("last |x| [σ]", |r| r.x.last().copied())
        .column("deviation from 2n + 1", Run::off_the_line);
    found.tables.push(table.table());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rigid_map_without_damping_is_a_defective_reflection() {
        let map = rigid_map(1.0);
        assert_eq!((map.trace(), map.determinant()), (-2.0, 1.0));
        // (M + 1)² = 0 while M + 1 ≠ 0: Mⁿ = (−1)ⁿ·(1 − n·(M + 1)), linear in n.
        let nilpotent = map.0 + glam::DMat2::IDENTITY;
        assert_eq!(nilpotent * nilpotent, glam::DMat2::ZERO);
        assert_ne!(nilpotent, glam::DMat2::ZERO);
    }

    #[test]
    fn damping_makes_the_rigid_map_a_contraction() {
        for gamma in [0.9, 0.5, 1.0 / 9.0 + 1e-9] {
            assert!((rigid_map(gamma).radius() - gamma.sqrt()).abs() < 1e-6);
        }
        assert!((rigid_map(0.01).radius() - 0.959).abs() < 1e-3);
        for i in 1..1000 {
            assert!(rigid_map(f64::from(i) / 1000.0).radius() < 1.0);
        }
    }
}
