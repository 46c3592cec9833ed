//! Whether a run was in equilibrium, long enough, and at the temperature of its bath.

use std::f64::consts::PI;

use crate::Doubt;
use lennard_core::number::{plus_minus, short, significant};

use super::Thermodynamics;
use crate::averages::{FEWEST_INDEPENDENT, changes};
use crate::statistics::{self, equilibration};

/// Collisions of each particle that a run must last. In a gas the energy comes from pairs that meet, and from pairs that
/// stay bound until a third particle comes by. Its correlation lasts about one and a half mean collision times. With 40
/// collisions a run has 13 independent stretches of this slow part, from which its error is known to a fifth.
const FEWEST_COLLISIONS: f64 = 40.0;

/// Relaxation times of its bath that a run must last. The bath acts on the kinetic energy, and the total energy follows
/// c_v/(3/2) times as slowly. This factor is 1.0 in a gas and 1.75 in a dense liquid. 40 relaxation times give some 13
/// independent values of the energy.
const FEWEST_RELAXATIONS: f64 = 40.0;

/// The temperature that a heat bath holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldTemperature {
    /// In ε/k_B.
    pub temperature: f64,
    /// Whether it is the temperature of half steps, and not of whole steps.
    pub half_steps: bool,
    /// Time in τ in which the bath brings the kinetic energy back to its mean.
    pub relaxation: f64,
}

impl HeldTemperature {
    /// A mean temperature misses its bath where it is off by more than this many of its standard errors, and by more than
    /// [`Self::PART`].
    pub const ERRORS: f64 = 4.0;
    /// A finite step moves temperatures by some tenths of a per cent.
    pub const PART: f64 = 0.003;
}

/// What is discarded of a run, and what speaks against all of its means.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// Rows of the series to discard at the start.
    pub cut: usize,
    /// The same as a part of the run, from 0 to 1: one part for every observable.
    pub discarded: f64,
    /// Why no mean of the run is a result; `None` where nothing speaks against it.
    pub doubt: Option<Doubt>,
}

/// The mean time between two collisions of a particle in a dilute gas of spheres of diameter σ, 1/(4ρσ²√(πT)), in τ.
///
/// Source: S. Chapman and T. G. Cowling, The Mathematical Theory of Non-Uniform Gases, 3rd ed. (1970), section 5.21.
fn collision_time(density: f64, temperature: f64) -> f64 {
    1.0 / (4.0 * density * (PI * temperature).sqrt())
}

impl Thermodynamics {
    /// Tells the temperature that the bath of the measured stages holds; `None`, the default, without a bath.
    pub fn set_bath(&mut self, bath: Option<HeldTemperature>) {
        self.bath = bath;
    }

    /// The part to discard, and the verdict on the rest.
    ///
    /// U and P (and T where a bath holds it) are each tested by [`statistics::equilibration`]; the latest cut counts for everything.
    /// A run is not in equilibrium where one of them still changes, or where its mean temperature misses the bath. A run is too
    /// short where a particle collides less than 40 times, or where it lasts less than 40 relaxation times of the bath.
    #[must_use]
    pub fn equilibrium(&self) -> Equilibrium {
        let rows = self.series.rows();
        let watched = [
            ("U", Some(&rows.potential_energy_without_tail)),
            ("P", Some(&rows.pressure_without_tail)),
            ("T", self.bath.map(|_| &rows.temperature_of_positions)),
        ];
        let mut cut = 0;
        let mut doubt: Option<Doubt> = None;
        let mut most = 0.0;
        for (name, column) in watched.into_iter().filter_map(|(n, c)| Some((n, c?))) {
            let found = equilibration(column);
            cut = cut.max(found.cut);
            if let Some(trend) = found.trend.filter(|trend| trend.errors > most) {
                most = trend.errors;
                doubt = Some(Doubt::NotInEquilibrium(changes(name, &trend)));
            }
        }
        let n = rows.time.len();
        let doubt = doubt.or_else(|| self.not_at_bath(cut)).or_else(|| {
            let density = self.context.n_atoms as f64 / self.seen.volume();
            let temperature = statistics::mean(&rows.temperature[cut..]);
            self.too_short(self.length(cut), density, temperature)
        });
        Equilibrium { cut, discarded: if n == 0 { 0.0 } else { cut as f64 / n as f64 }, doubt }
    }

    /// The equilibration cut that all averages share, in rows of [`Thermodynamics::series`].
    #[must_use]
    pub fn equilibration_cut(&self) -> usize {
        self.equilibrium().cut
    }

    fn not_at_bath(&self, cut: usize) -> Option<Doubt> {
        let bath = self.bath?;
        let rows = self.series.rows();
        let column =
            if bath.half_steps { &rows.temperature_of_positions } else { &rows.temperature };
        let found = statistics::estimate_after(column, cut);
        // Without an error nothing is known of how far off the mean is: the run is too short, not out of equilibrium.
        if !found.standard_error.is_finite() {
            return None;
        }
        let off = (found.mean - bath.temperature).abs();
        let allowed = (HeldTemperature::ERRORS * found.standard_error)
            .max(HeldTemperature::PART * bath.temperature);
        (off > allowed).then(|| {
            Doubt::NotInEquilibrium(format!(
                "T is {} where its bath has {}",
                plus_minus(found.mean, found.standard_error),
                short(bath.temperature)
            ))
        })
    }

    /// Length of the run after `cut` rows, τ.
    fn length(&self, cut: usize) -> f64 {
        let samples = (self.series.len() - cut) as f64 * self.series.stride() as f64;
        samples * self.context.sample_interval()
    }

    /// Why no mean of a run of this length in τ has an error, whatever its samples are.
    fn too_short(&self, length: f64, density: f64, temperature: f64) -> Option<Doubt> {
        let collisions = length / collision_time(density, temperature);
        let few = self.context.n_atoms > 1 && collisions < FEWEST_COLLISIONS;
        let few_collisions = few.then(|| Doubt::TooShort {
            why: format!(
                "a particle collides {} times where {FEWEST_COLLISIONS} are needed",
                significant(collisions, 2)
            ),
            longer: FEWEST_COLLISIONS / collisions,
        });
        let slow_bath = self.bath.and_then(|bath| {
            let times = length / bath.relaxation;
            (times < FEWEST_RELAXATIONS).then(|| Doubt::TooShort {
                why: format!(
                    "{} relaxation times of its bath where {FEWEST_RELAXATIONS} are needed",
                    significant(times, 2)
                ),
                longer: FEWEST_RELAXATIONS / times,
            })
        });
        Doubt::graver(few_collisions, slow_bath)
    }

    /// Why no mean of a run will have an error, from its measured length in τ, its rows, and the density
    /// (σ⁻³) and temperature (ε/k_B) of the scene. `None` where it may have one.
    #[must_use]
    pub fn foreseen(
        &self,
        length: f64,
        rows: u64,
        density: f64,
        temperature: f64,
    ) -> Option<Doubt> {
        let few_rows = (rows as f64) < FEWEST_INDEPENDENT;
        let few_rows = few_rows.then(|| Doubt::TooShort {
            why: format!("{rows} samples where {FEWEST_INDEPENDENT} independent ones are needed"),
            longer: FEWEST_INDEPENDENT / rows.max(1) as f64,
        });
        Doubt::graver(few_rows, self.too_short(length, density, temperature))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ThermoSeries;
    use crate::series::Columns;
    use crate::statistics::synthetic::Ar1;
    use crate::testing::context;

    /// A stationary run at T = 1 with a step of a hundredth of τ between samples, in a box of this side.
    fn run(side: f64, samples: usize) -> Thermodynamics {
        let mut run = Thermodynamics::new(&context(side, 100));
        let noise = [0, 1, 2].map(|seed| Ar1::new(0.5, seed).series(samples));
        let names = ThermoSeries::default().names();
        for ((t, u), p) in noise[0].iter().zip(&noise[1]).zip(&noise[2]) {
            let row: Vec<f64> = names
                .iter()
                .map(|name| match *name {
                    "temperature" | "temperature_of_positions" => 1.0 + 0.05 * t,
                    "potential_energy_without_tail" => -5.0 + 0.1 * u,
                    "pressure_without_tail" => 2.0 + 0.3 * p,
                    _ => 0.0,
                })
                .collect();
            run.series.push(&row);
        }
        run
    }

    fn with_bath(temperature: f64, relaxation: f64) -> Option<Doubt> {
        let mut run = run(5.0, 4000);
        run.set_bath(Some(HeldTemperature { temperature, half_steps: false, relaxation }));
        run.equilibrium().doubt
    }

    #[test]
    fn a_run_that_is_not_at_the_temperature_of_its_bath_says_so() {
        assert_eq!(with_bath(1.0, 0.5), None);
        let Some(Doubt::NotInEquilibrium(why)) = with_bath(1.02, 0.5) else { panic!("no doubt") };
        assert!(why.starts_with("T is ") && why.ends_with("where its bath has 1.02"), "{why}");
    }

    #[test]
    fn a_mean_without_an_error_is_not_said_to_miss_its_bath() {
        for samples in 1..4 {
            let mut run = run(5.0, samples);
            run.set_bath(Some(HeldTemperature {
                temperature: 2.0,
                half_steps: false,
                relaxation: 0.5,
            }));
            let Some(Doubt::TooShort { why, .. }) = run.equilibrium().doubt else {
                panic!("{:?}", run.equilibrium().doubt)
            };
            assert!(!why.contains("NaN"), "{why}");
        }
    }

    #[test]
    fn a_run_shorter_than_40_relaxation_times_of_its_bath_is_too_short() {
        // 40 τ.
        let Some(Doubt::TooShort { longer, why }) = with_bath(1.0, 2.0) else { panic!("no doubt") };
        assert!((longer - 2.0).abs() < 1e-9 && why.contains("20 relaxation times"), "{why}");
    }

    #[test]
    fn a_gas_needs_40_collisions() {
        assert_eq!(run(5.0, 4000).equilibrium().doubt, None);
        // ρ = 0.0125: a collision each 1/(4·0.0125·√π) = 11.3 τ.
        let Some(Doubt::TooShort { longer, .. }) = run(20.0, 4000).equilibrium().doubt else {
            panic!("no doubt")
        };
        assert!((longer - 11.284).abs() < 0.01, "{longer}");
    }
}
