//! Which phase of a crystal beside its liquid grows, by the order of bonds.

use lennard_core::{Average, Doubt, Estimate, Findings, Fronts, Remark};
use lennard_observables::statistics::drift;

use crate::Simulation;

/// The share of solid-like particles is followed while both phases are there: between these bounds.
const BOTH_PHASES: [f64; 2] = [0.15, 0.85];
/// Standard errors by which a velocity must differ from zero.
const ERRORS: f64 = 2.0;
/// Fewest samples of the share that tell a velocity.
const FEWEST: usize = 30;
/// Two fronts, since the box is periodic.
const FRONTS: f64 = 2.0;

/// What the share of solid-like particles tells of the fronts.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Motion {
    /// Velocity of each front into the liquid, σ/τ.
    velocity: f64,
    /// Its standard error; not a number with too few samples.
    error: f64,
    /// Samples with both phases.
    samples: usize,
    /// The parts of the run whose slopes tell the error.
    blocks: usize,
    /// The first and the last share of the whole run.
    shares: [f64; 2],
}

impl Motion {
    /// From the share against time; `per_share` is the length that a front moves while the share grows from 0 to 1.
    fn of(time: &[f64], share: &[f64], per_share: f64) -> Option<Self> {
        let is_mixed = |share: &&f64| (BOTH_PHASES[0]..=BOTH_PHASES[1]).contains(*share);
        let samples = share.iter().take_while(is_mixed).count();
        let line = drift(&time[..samples], &share[..samples]);
        Some(Self {
            velocity: line.slope * per_share,
            error: match samples >= FEWEST {
                true => line.standard_error * per_share,
                false => f64::NAN,
            },
            samples,
            blocks: line.blocks,
            shares: [*share.first()?, *share.last()?],
        })
    }

    fn average(&self) -> Average {
        let blocks = self.blocks as f64;
        let estimate = Estimate {
            mean: self.velocity,
            standard_error: self.error,
            n_effective: blocks,
            least_effective: blocks,
            freedom: self.blocks.saturating_sub(1) as f64,
            equilibration_cut: 0,
        };
        // A longer run has no more of them: one phase is gone.
        let few = self.too_few().map(Doubt::Incomplete);
        Average::new("front_velocity", "σ/τ", estimate).doubted(few)
    }

    /// Why no velocity is told; `None` where there are samples enough.
    fn too_few(&self) -> Option<String> {
        self.error.is_nan().then(|| {
            format!(
                "{} samples with both phases where {FEWEST} are needed: look more often",
                self.samples
            )
        })
    }

    fn told(&self) -> Fronts {
        let (velocity, standard_error, solid_shares) = (self.velocity, self.error, self.shares);
        match self.too_few() {
            Some(why) => Fronts::TooFew { why, solid_shares },
            None if velocity.abs() > ERRORS * standard_error => {
                Fronts::Moving { velocity, standard_error, solid_shares }
            }
            None => Fronts::Neither { solid_shares },
        }
    }
}

impl Simulation {
    /// Adds the velocity of the fronts to the findings of a start with a crystal beside its liquid, and says which phase grows. What
    /// moves is in no equilibrium: no test of one speaks against it.
    pub(crate) fn add_front(&self, findings: &mut [Findings]) {
        let Some(start) = self.scene.half_crystal() else {
            return;
        };
        let per_share =
            start.n_atoms as f64 / (start.crystal_density * start.side().powi(2)) / FRONTS;
        let tables = findings.iter().enumerate();
        let found = tables.into_iter().find_map(|(at, f)| {
            let table = f.tables.iter().find(|t| t.name == "bond_order")?;
            let (time, share) = (table.numbers("time")?, table.numbers("solid_share")?);
            Some((at, Motion::of(&time, &share, per_share)?))
        });
        match found {
            Some((at, motion)) => {
                findings[at].averages.push(motion.average());
                findings[at].remark(Remark::Fronts(motion.told()));
            }
            None => {
                if let Some(first) = findings.first_mut() {
                    first.remark(Remark::Fronts(Fronts::NotMeasured));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A share that changes by `rate` per sample, with noise, up to its bounds.
    fn motion(rate: f64, samples: usize) -> Motion {
        let time: Vec<f64> = (0..samples).map(|i| 0.5 * i as f64).collect();
        let mut noise = 1_u64;
        let share: Vec<f64> = (0..samples)
            .map(|i| {
                noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                let noise = (noise >> 33) as f64 / 2.0_f64.powi(31) - 0.5;
                (0.5 + rate * i as f64 + 0.01 * noise).clamp(0.03, 0.98)
            })
            .collect();
        Motion::of(&time, &share, 12.0).unwrap()
    }

    #[test]
    fn a_front_has_its_velocity_while_both_phases_are_there() {
        for rate in [2e-3, -1e-3] {
            // The share ends at a bound, where nothing moves any more.
            let found = motion(rate, 1000);
            let exact = rate / 0.5 * 12.0;
            assert!(found.samples < 500, "{found:?}");
            assert!((found.velocity - exact).abs() < 0.02 * exact.abs(), "{found:?}");
            assert!(found.error < 0.5 * exact.abs(), "{found:?}");
            let words = found.told().to_string();
            assert_eq!(words.starts_with("the crystal grows"), rate > 0.0, "{words}");
            let average = found.average();
            assert_eq!(average.doubt, None);
            // The error is of ten slopes, and is itself known to 1/√18.
            assert_eq!((average.estimate.freedom, average.estimate.n_effective), (9.0, 10.0));
        }
        let still = motion(0.0, 1000);
        assert!(matches!(still.told(), Fronts::Neither { .. }), "{still:?}");
    }

    #[test]
    fn too_few_samples_give_no_error() {
        let found = motion(2e-2, 1000);
        assert!(found.samples < FEWEST && found.error.is_nan(), "{found:?}");
        let Some(Doubt::Incomplete(why)) = found.average().doubt else { panic!("no doubt") };
        assert!(why.contains("look more often"), "{why}");
        let words = found.told().to_string();
        assert!(words.contains("98 % at the end"), "{words}");
        // The share rises from 50 to 98 %: it is not said that nothing grows.
        assert!(words.contains("no velocity is told") && !words.contains("neither"), "{words}");
    }
}
