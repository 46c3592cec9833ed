//! SPOOK at k = ∞ (ε = 0): the one-step map derived, and measured over many steps. Without damping it is the map of
//! symplectic Euler at its limit k = 4m/h².

use serde::Serialize;

use super::displacement::{MASS, STEP};
use super::groups::entry;
use super::map::StepMap;
use super::oscillator::{Spring, excursion, next_map};
use crate::StudyError;

const SPOOK: &str = "spook";
/// Steps of the runs with ε = 0.
const STEPS: u32 = 100_000;
/// Damping times of the runs, in steps: none, one with complex eigenvalues, the critical one, one beyond.
const DAMPING_STEPS: [f64; 5] = [0.0, 0.1, 1.0, 2.0, 10.0];
/// Stiffnesses on the way to ∞, as ωh.
const APPROACH: [f64; 4] = [10.0, 1e2, 1e3, 1e4];
/// Steps shown in figures.
const SHOWN: u32 = 10_000;

/// One damping time at ε = 0.
#[derive(Debug, Clone, Serialize)]
pub struct RigidRun {
    /// τ/h.
    pub damping_steps: f64,
    /// γ = 1/(1 + 4τ/h).
    pub gamma: f64,
    /// Spectral radius of the map [[1 − 4γ, hγ], [−4γ/h, γ]].
    pub theory_radius: f64,
    /// The same from three consecutive states.
    pub measured_radius: f64,
    /// |x_n| at the last step, σ.
    pub last_displacement: f64,
    /// max |x| of the second half of the run over the same of the first half: 2 for linear growth.
    pub growth_of_halves: f64,
    /// |x| in σ at the steps of [`Infinite::shown_steps`].
    #[serde(skip)]
    pub displacements: Vec<f64>,
}

/// Symplectic Euler at its limit: its map on (x, h·v) is [[−3, 1], [−4, 1]], the one of SPOOK at ε = 0 and τ = 0.
#[derive(Debug, Clone, Serialize)]
pub struct AtLimit {
    /// max |x| of the second half of the run over the same of the first half: 2 for linear growth.
    pub growth_of_halves: f64,
    /// Largest relative deviation of |x_n| from 2n + 1.
    pub deviation_from_linear: f64,
}

/// One large finite stiffness, τ = 0.
#[derive(Debug, Clone, Serialize)]
pub struct StiffRun {
    /// ωh.
    pub omega_h: f64,
    /// √(1 + (ωh/2)²), σ.
    pub theory_amplitude: f64,
    /// max |x| over enough steps for more than a whole beat, σ.
    pub measured_amplitude: f64,
    /// |x| in σ at the steps of [`Infinite::shown_steps`].
    #[serde(skip)]
    pub displacements: Vec<f64>,
}

/// What was found at k = ∞ and on the way there.
#[derive(Debug, Clone, Serialize)]
pub struct Infinite {
    /// Steps of the runs with ε = 0.
    pub steps: u32,
    /// Steps at which displacements are kept, about evenly spaced in their logarithm.
    #[serde(skip)]
    pub shown_steps: Vec<u32>,
    /// ε = 0 with each damping time.
    pub rigid: Vec<RigidRun>,
    /// Largest relative deviation of |x_n| from 2n + 1 over the run with τ = 0.
    pub deviation_from_linear: f64,
    /// Symplectic Euler at k = 4m/h².
    pub at_limit: AtLimit,
    /// Finite stiffnesses.
    pub stiff: Vec<StiffRun>,
}

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

/// Where all runs start: x = 1 σ, at rest.
const START: (f64, f64) = (1.0, 0.0);

/// |x| after each of the steps, σ.
fn displacements(method: &'static str, spring: Spring, steps: u32) -> Result<Vec<f64>, StudyError> {
    let mut rig = spring.start(entry(method)?, START, STEP)?;
    (0..steps).map(|_| Ok(rig.next_point()?.x.abs())).collect()
}

fn growth_of_halves(x: &[f64]) -> f64 {
    let largest = |x: &[f64]| x.iter().copied().fold(0.0, f64::max);
    let (first, second) = x.split_at(x.len() / 2);
    largest(second) / largest(first)
}

fn deviation_from_linear(x: &[f64]) -> f64 {
    let off = (1..).zip(x).map(|(n, x)| (x / (2.0 * f64::from(n) + 1.0) - 1.0).abs());
    off.fold(0.0, f64::max)
}

/// The values at the steps that are shown.
fn shown(values: &[f64], steps: &[u32]) -> Vec<f64> {
    let at = |n: &u32| values.get(*n as usize - 1).copied();
    steps.iter().filter_map(at).collect()
}

/// Measures everything.
pub(crate) fn measure(quick: bool) -> Result<Infinite, StudyError> {
    let spook = entry(SPOOK)?;
    let steps = if quick { STEPS / 5 } else { STEPS };
    let shown_steps = shown_steps();
    let mut undamped_deviation = f64::NAN;
    let mut rigid = Vec::new();
    for damping_steps in DAMPING_STEPS {
        let damping_time = damping_steps * STEP;
        let spring = Spring::Constraint { compliance: 0.0, damping_time };
        let gamma = 1.0 / (1.0 + 4.0 * damping_steps);
        let x = displacements(SPOOK, spring, steps)?;
        if damping_steps == 0.0 {
            undamped_deviation = deviation_from_linear(&x);
        }
        rigid.push(RigidRun {
            damping_steps,
            gamma,
            theory_radius: rigid_map(gamma).radius(),
            measured_radius: next_map(&mut spring.start(spook, START, STEP)?)?.radius(),
            last_displacement: x.last().copied().unwrap_or(f64::NAN),
            growth_of_halves: growth_of_halves(&x),
            displacements: shown(&x, &shown_steps),
        });
    }
    let stiff = APPROACH
        .iter()
        .map(|omega_h| {
            let spring = Spring::Stiffness((omega_h / STEP).powi(2));
            // Near the end of the line x turns by π − 4/(ωh) per step: a beat takes π·ωh/4 steps.
            let enough = (4.0 * omega_h) as u32 + 1000;
            Ok(StiffRun {
                omega_h: *omega_h,
                theory_amplitude: 1.0_f64.hypot(0.5 * omega_h),
                measured_amplitude: excursion(spook, spring, STEP, enough, f64::INFINITY)?
                    .largest(),
                displacements: shown(&displacements(SPOOK, spring, SHOWN)?, &shown_steps),
            })
        })
        .collect::<Result<_, StudyError>>()?;
    let limit = Spring::Stiffness(4.0 * MASS / (STEP * STEP));
    let at_limit = displacements("symplectic-euler", limit, steps)?;
    Ok(Infinite {
        steps,
        shown_steps,
        rigid,
        deviation_from_linear: undamped_deviation,
        at_limit: AtLimit {
            growth_of_halves: growth_of_halves(&at_limit),
            deviation_from_linear: deviation_from_linear(&at_limit),
        },
        stiff,
    })
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
