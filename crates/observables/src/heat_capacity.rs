//! The heat capacity from fluctuations, in the ensemble that the run samples.

use crate::{Average, BuildContext, Estimate, Remark, ThermoSeries};
use lennard_core::{Momentum, System};

use crate::averages::{FEWEST_FLUCTUATIONS, estimate_of_fluctuations, of_fluctuations};
use crate::statistics::{estimate_after, less_control, mean};

/// The ensemble that a run samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ensemble {
    /// Constant energy: no thermostat.
    Microcanonical,
    /// Constant temperature, by a thermostat that is known to sample it.
    Canonical,
    /// Constant temperature and constant pressure (ε/σ³), by a barostat with its thermostat.
    Isobaric {
        /// The pressure that is held.
        pressure: f64,
    },
}

impl Ensemble {
    /// Which formula was used, with the degrees of freedom.
    pub(crate) fn remark(self, context: &BuildContext, n_dof: f64) -> Remark {
        let kinetic = kinetic_part(context);
        let how = match self {
            Self::Microcanonical => format!(
                "from the fluctuations of the kinetic energy at constant energy (Lebowitz, Percus and Verlet 1967), n_dof = {n_dof}"
            ),
            Self::Isobaric { .. } => format!(
                "c_p from the fluctuations of the enthalpy at constant pressure, less Tα²/(ρκ_T) from the fluctuations of the volume, n_dof = {n_dof}"
            ),
            Self::Canonical => format!(
                "{kinetic} and the fluctuations of the potential energy at constant temperature, n_dof = {n_dof}"
            ),
        };
        Remark::HeatCapacity { how }
    }
}

/// The kinetic part of c_v in the thermodynamic limit: half the degrees of freedom of a molecule, 3/2 for atoms.
fn kinetic_part(context: &BuildContext) -> f64 {
    let molecule = System::of_molecules(context.molecules.sites(), context.molecules.clone());
    0.5 * molecule.n_dof(Momentum::Free)
}

/// The isochoric heat capacity c_v per particle in k_B, with the kinetic part of the thermodynamic limit, 3/2.
///
/// With f degrees of freedom and per-particle energies k and u:
///
/// - constant energy: C_V = (f/2)/(1 − x), x = f ⟨δk²⟩/(2 ⟨k⟩²), from ⟨δK²⟩ = f T²/2 · (1 − f/(2C_V)) with
///   ⟨K⟩ = f T/2 (J. L. Lebowitz, J. K. Percus and L. Verlet, "Ensemble dependence of fluctuations with
///   application to machine computations", Phys. Rev. 153, 250 (1967), equation 3.7, where f = 3N);
/// - constant temperature: C_V = f/2 + N² ⟨δu²⟩/T². Kinetic and potential energy are independent there, and the kinetic part
///   is known: what noise adds to it need not be measured. u is the potential of which the forces are the gradient. For a
///   plain cutoff this is the shifted potential: the cut energy jumps where pairs cross the cutoff, and no force knows of
///   it. T is the temperature of the positions. What the variance owes to a correlation with K, which is zero, is taken out.
///
/// C_V has the kinetic part f/2 of the system; c_v = (C_V − f/2)/N + 3/2 replaces it by 3/2 per particle. For molecules, N
/// is their number and 3/2 half the degrees of freedom of one.
///
/// The variance about the mean of n independent samples is too small by one part in n, for which it is corrected. The
/// error is the error of the mean of the linearised formula, correlation included. An error s is widened to s·(1 + s/x),
/// with the excess x over the kinetic part: where x is too small by chance, so is s. At constant pressure there is no
/// value here.
pub(crate) fn average(
    ensemble: Ensemble,
    rows: &ThermoSeries,
    cut: usize,
    context: &BuildContext,
    n_dof: f64,
) -> Option<Average> {
    let n = context.n_molecules() as f64;
    let from = cut.min(rows.time.len());
    let (value, influence): (f64, Vec<f64>) = match ensemble {
        // It follows from c_p there: the response functions have it.
        Ensemble::Isobaric { .. } => return None,
        Ensemble::Microcanonical => {
            let kinetic = &rows.kinetic_energy[from..];
            let k = mean(kinetic);
            let squares = centred_squares(kinetic, &rows.kinetic_energy_squared[from..], k);
            let v = unbiased(mean(&squares), kinetic);
            let x = n_dof * v / (2.0 * k * k);
            let slope = 0.5 * n_dof / (1.0 - x).powi(2);
            let influence = squares
                .iter()
                .zip(kinetic)
                .map(|(s, ki)| slope * (n_dof / (2.0 * k * k) * (s - v) - 2.0 * x / k * (ki - k)))
                .collect();
            (0.5 * n_dof * x / (1.0 - x), influence)
        }
        Ensemble::Canonical => {
            let potential = &rows.sampled_potential_energy[from..];
            let temperatures = &rows.temperature_of_positions[from..];
            let temperature = mean(temperatures);
            let squares = centred_squares(
                potential,
                &rows.sampled_potential_energy_squared[from..],
                mean(potential),
            );
            let excess = n * n * unbiased(mean(&squares), potential) / temperature.powi(2);
            let influence = squares
                .iter()
                .zip(temperatures)
                .map(|(s, t)| {
                    n * n * s / temperature.powi(2)
                        - excess
                        - 2.0 * excess * (t - temperature) / temperature
                })
                .collect();
            less_control(excess, influence, &rows.exchange(from))
        }
    };
    let error = estimate_of_fluctuations(&influence);
    // A variance that is too small by chance has an error that is too small by the same part.
    let widened = error.standard_error * (1.0 + error.standard_error / value.abs());
    let estimate = Estimate {
        mean: value / n + kinetic_part(context),
        standard_error: if value == 0.0 { error.standard_error } else { widened } / n,
        equilibration_cut: from as u64,
        ..error
    };
    Some(of_fluctuations(
        "heat_capacity",
        context.heat_capacity_unit(),
        estimate,
        &influence,
        FEWEST_FLUCTUATIONS,
    ))
}

/// A variance about the mean of the same `series`, corrected for what that mean takes away.
fn unbiased(variance: f64, series: &[f64]) -> f64 {
    let independent = estimate_after(series, 0).n_effective.max(2.0);
    variance / (1.0 - 1.0 / independent)
}

/// ⟨(x − m)²⟩ of each row from the row means of x² and x.
fn centred_squares(values: &[f64], squares: &[f64], m: f64) -> Vec<f64> {
    values.iter().zip(squares).map(|(x, xx)| xx - 2.0 * m * x + m * m).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lennard_core::random::Streams;
    use rand_distr::{ChiSquared, Distribution};

    /// Energies of N particles with f kinetic and g harmonic degrees of freedom: canonical at T, or (`total`
    /// given) at that energy, by scaling.
    fn series(n: f64, f: f64, g: f64, t: f64, total: Option<f64>, seed: u64) -> ThermoSeries {
        let noise = Streams::new(seed).noise("heat capacity");
        let mut rows = ThermoSeries::default();
        for s in 0..20_000 {
            let mut rng = noise.at(s, 0);
            let mut draw = |dof: f64| 0.5 * t * ChiSquared::new(dof).unwrap().sample(&mut rng);
            let (mut k, mut u) = (draw(f), draw(g));
            if let Some(total) = total {
                let scale = total / (k + u);
                (k, u) = (k * scale, u * scale);
            }
            rows.time.push(s as f64);
            rows.temperature_of_positions.push(2.0 * k / f);
            rows.kinetic_energy.push(k / n);
            rows.sampled_potential_energy.push(u / n);
            rows.sampled_energy_kinetic.push(u / n * k / n);
            rows.kinetic_energy_squared.push((k / n).powi(2));
            rows.sampled_potential_energy_squared.push((u / n).powi(2));
        }
        rows
    }

    fn estimate(
        ensemble: Ensemble,
        rows: &ThermoSeries,
        cut: usize,
        n_atoms: usize,
        n_dof: f64,
    ) -> Estimate {
        let found =
            average(ensemble, rows, cut, &crate::testing::context(10.0, n_atoms), n_dof).unwrap();
        assert_eq!(found.doubt, None);
        found.estimate
    }

    #[test]
    fn harmonic_degrees_of_freedom_have_their_exact_heat_capacity_in_both_ensembles() {
        let (n, t) = (100.0, 0.8);
        let (f, g) = (297.0, 200.0);
        // Canonical: C_V = (f + g)/2 exactly.
        let found = estimate(Ensemble::Canonical, &series(n, f, g, t, None, 1), 0, 100, f);
        let exact = 0.5 * g / n + 1.5;
        assert!((found.mean - exact).abs() < 4.0 * found.standard_error, "{found:?} {exact}");
        assert!(found.standard_error < 0.02 * exact);
        // Constant energy: K/E follows a beta distribution of variance 2fg/((f + g)²(f + g + 2)), so that
        // x = g/(f + g + 2) exactly.
        let found = estimate(
            Ensemble::Microcanonical,
            &series(n, f, g, t, Some(0.5 * (f + g) * t), 2),
            0,
            100,
            f,
        );
        let exact = (0.5 * f / (1.0 - g / (f + g + 2.0)) - 0.5 * f) / n + 1.5;
        assert!((found.mean - exact).abs() < 4.0 * found.standard_error, "{found:?} {exact}");
        assert!(found.standard_error < 0.02 * exact);
    }

    #[test]
    fn jumps_of_the_cut_energy_at_the_cutoff_are_no_fluctuations() {
        let mut rows = series(100.0, 297.0, 200.0, 0.8, None, 1);
        let before = estimate(Ensemble::Canonical, &rows, 0, 100, 297.0);
        // Pairs that cross a plain cutoff add noise to the cut energy alone.
        rows.potential_energy = (0..rows.time.len())
            .map(|i| rows.sampled_potential_energy[i] + 0.5 * f64::from(i as u32 % 7))
            .collect();
        assert_eq!(estimate(Ensemble::Canonical, &rows, 0, 100, 297.0), before);
    }

    #[test]
    fn a_short_run_has_no_error_and_is_never_below_its_kinetic_part() {
        for seed in 0..40 {
            let mut rows = series(100.0, 297.0, 3.0, 1.0, None, 200 + seed);
            for column in [
                &mut rows.time,
                &mut rows.temperature_of_positions,
                &mut rows.sampled_potential_energy,
                &mut rows.sampled_potential_energy_squared,
            ] {
                column.truncate(60);
            }
            let found =
                average(Ensemble::Canonical, &rows, 0, &crate::testing::context(10.0, 100), 297.0)
                    .unwrap();
            assert!(found.estimate.mean >= 1.5);
            assert!(found.doubt.is_some(), "seed {seed}: {found:?}");
        }
    }

    #[test]
    fn the_error_covers_the_scatter_over_seeds() {
        let (n, f, g) = (100.0, 297.0, 200.0);
        let found: Vec<Estimate> = (0..30)
            .map(|seed| {
                let mut rows = series(n, f, g, 1.0, Some(0.5 * (f + g)), 100 + seed);
                // Shorter runs, to be quick about it.
                for column in [
                    &mut rows.time,
                    &mut rows.temperature,
                    &mut rows.kinetic_energy,
                    &mut rows.kinetic_energy_squared,
                ] {
                    column.truncate(2000);
                }
                estimate(Ensemble::Microcanonical, &rows, 0, 100, f)
            })
            .collect();
        let (_, ratio) = crate::statistics::synthetic::printed_and_spread(&found);
        // 30 seeds know their spread to 13 %: three of these.
        assert!((ratio - 1.0).abs() < 0.4, "{ratio}");
    }

    #[test]
    fn an_ideal_gas_at_constant_energy_has_three_halves() {
        let mut rows = series(50.0, 147.0, 10.0, 1.0, None, 3);
        rows.kinetic_energy.fill(1.47);
        rows.kinetic_energy_squared.fill(1.47 * 1.47);
        let found = estimate(Ensemble::Microcanonical, &rows, 0, 50, 147.0);
        // Rounding of the square.
        assert!((found.mean - 1.5).abs() < 1e-10);
    }
}
