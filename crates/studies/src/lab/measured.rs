//! What a run under some settings measures: energy conservation, temperatures, U and P.

use lennard_engine::Unfollowed;
use lennard_literature::{ClosedBox, Expected, Kept};
use lennard_observables::{Estimate, ThermoSeries, Thermodynamics, statistics};
use lennard_scene::Scene;
use serde::{Deserialize, Serialize};

use super::slopes::Slopes;
use super::workbench::{ShortStage, Workbench};
use crate::StudyError;
use crate::settings::Settings;

/// Time between two samples, τ: about the time in which the pressure forgets itself.
const SAMPLE_INTERVAL: f64 = 0.04;
/// The fluid gets used to another truncation for this long before it is measured, τ …
const SETTLING_TIME: f64 = 1.0;
/// … or for this share of a run that is short.
const LARGEST_SETTLING_SHARE: f64 = 0.2;

/// The mean of independent values of equal weight.
#[must_use]
pub fn mean_of(values: &[Estimate]) -> Estimate {
    let n = values.len() as f64;
    Estimate::new(
        values.iter().map(|v| v.mean).sum::<f64>() / n,
        values.iter().map(|v| v.standard_error.powi(2)).sum::<f64>().sqrt() / n,
        values.iter().map(|v| v.n_effective).sum(),
    )
}

/// A difference from an equation of state, with what is known of its error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AgainstEquation {
    /// The equation.
    pub source: String,
    /// U − U_EOS at the temperature of the positions, ε.
    pub potential_energy: Estimate,
    /// P − P_EOS at the temperature of the positions, ε/σ³.
    pub pressure: Estimate,
    /// What the equation itself is off by, where that is known: U and P.
    pub own_uncertainty: Option<(f64, f64)>,
}

/// What a run measures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Simulated time that was sampled, τ.
    pub time: f64,
    /// Kinetic temperature of whole steps, ε/k_B.
    pub temperature: Estimate,
    /// Temperature of the positions, ε/k_B: half steps have it where the method has half steps, else whole steps. U and P
    /// of every run are judged at this temperature.
    pub temperature_of_positions: Estimate,
    /// Configurational temperature, ε/k_B.
    pub configurational_temperature: Estimate,
    /// The first less the second, sample by sample.
    pub temperature_difference: Estimate,
    /// Potential energy per particle, of the model with its tail where it has one, ε.
    pub potential_energy: Estimate,
    /// Pressure, of the model with its tail where it has one, ε/σ³.
    pub pressure: Estimate,
    /// The same potential energy at the temperature of [`Slopes`].
    pub potential_energy_at_reference: Estimate,
    /// The same pressure at the temperature of [`Slopes`].
    pub pressure_at_reference: Estimate,
    /// Root mean square of the energy that the forces conserve about its drift, ε per particle.
    pub energy_rms: f64,
    /// Its drift, ε/τ per particle.
    pub drift: Estimate,
    /// Beside the equation of state of this very model; absent where there is none.
    pub against_equation: Option<AgainstEquation>,
    /// Why there is none, or what belongs beside it.
    pub remarks: Vec<String>,
}

impl Workbench {
    /// Runs these settings for `time` τ in the scene's own ensemble and measures, after a while of settling.
    ///
    /// # Errors
    /// [`StudyError`] where the settings do not fit or the run fails ([`super::Failed::or`] tells which).
    pub fn measure(
        &self,
        settings: &Settings,
        time: f64,
        slopes: &Slopes,
    ) -> Result<Measured, StudyError> {
        let dt = self.stage_dt(settings);
        let settling = SETTLING_TIME.min(LARGEST_SETTLING_SHARE * time);
        let stage = |time: f64, measure: bool| ShortStage {
            steps: (time / dt).ceil().max(1.0) as u64,
            measure,
        };
        let every = ((SAMPLE_INTERVAL / dt).round() as u64).max(1);
        let stages = [stage(settling, false), stage(time, true)];
        let mut simulation = self.simulation(settings, &stages, every)?;
        simulation.follow(&mut Unfollowed)?;
        let found = simulation.thermodynamics();
        let cut = found.equilibration_cut();
        let rows = found.series();
        let (configurational, _) = statistics::ratio(&rows.squared_force, &rows.laplacian, cut);
        let conservation = found.conservation();
        let measured = self.measured(settings, rows, cut, slopes)?;
        Ok(Measured {
            time: stages[1].steps as f64 * dt,
            configurational_temperature: configurational,
            temperature_difference: temperature_difference(found, cut),
            energy_rms: conservation.energy_rms_per_atom,
            drift: Estimate {
                mean: conservation.energy_drift_per_atom_per_tau,
                standard_error: conservation.energy_drift_standard_error,
                ..measured.drift
            },
            ..measured
        })
    }

    /// What the rows of a run of these settings say from row `cut` on, whichever engine made them: all but the
    /// configurational temperature.
    pub(crate) fn measured(
        &self,
        settings: &Settings,
        rows: &ThermoSeries,
        cut: usize,
        slopes: &Slopes,
    ) -> Result<Measured, StudyError> {
        let of = |column: &[f64]| statistics::estimate_after(column, cut);
        let temperature = of(&rows.temperature_of_positions);
        let at_reference = |column: &[f64], slope: f64| {
            let value = statistics::about_line(column, &rows.temperature_of_positions, slope, cut);
            Estimate { mean: value.mean - slope * (temperature.mean - slopes.temperature), ..value }
        };
        let line = statistics::drift(&rows.time, &rows.conserved_energy);
        let beside = self.against_equation(&settings.apply(self.scene())?, rows, cut);
        let (against_equation, remarks) = match beside {
            Ok((found, remarks)) => (Some(found), remarks),
            Err(why) => (None, vec![why]),
        };
        Ok(Measured {
            time: rows.time.last().copied().unwrap_or(0.0),
            temperature: of(&rows.temperature),
            temperature_of_positions: temperature,
            configurational_temperature: Estimate::UNKNOWN,
            temperature_difference: Estimate::UNKNOWN,
            potential_energy: of(&rows.potential_energy),
            pressure: of(&rows.pressure),
            potential_energy_at_reference: at_reference(&rows.potential_energy, slopes.du_dt),
            pressure_at_reference: at_reference(&rows.pressure, slopes.dp_dt),
            energy_rms: line.rms,
            drift: Estimate::new(line.slope, line.standard_error, line.blocks as f64),
            against_equation,
            remarks,
        })
    }

    /// U and P from row `cut` on, less the values of the equation of state for the closed box of the run. Remarks come with them.
    ///
    /// # Errors
    /// Why there is no equation, or why it does not cover the state.
    fn against_equation(
        &self,
        scene: &Scene,
        rows: &ThermoSeries,
        cut: usize,
    ) -> Result<(AgainstEquation, Vec<String>), String> {
        let described = scene.equation_of_state()?;
        let start = self.start();
        let (n, density) =
            (start.len() / scene.molecules().sites(), start.density_of_molecules(scene));
        // A run on the workbench has no barostat.
        let bath = self.measured_stage().thermostat.as_ref();
        let kept = bath.map_or(Kept::Energy, |_| Kept::Temperature);
        let positions = &rows.temperature_of_positions;
        let closed = ClosedBox::of(described, density, &positions[cut..], n, Some(kept))?;
        let (u, p) = (closed.potential_energy, closed.pressure);
        let less = |column: &[f64], expected: Expected| {
            let Estimate { mean, standard_error, .. } = expected.difference(column, positions, cut);
            let n_effective = statistics::estimate_after(column, cut).n_effective;
            Estimate::new(mean, standard_error, n_effective)
        };
        let found = AgainstEquation {
            source: described.1.spec().citation(),
            potential_energy: less(&rows.potential_energy, u),
            pressure: less(&rows.pressure, p),
            own_uncertainty: u.own_uncertainty.zip(p.own_uncertainty),
        };
        Ok((found, closed.remarks))
    }

    /// The equation of state of the model that these settings simulate, by name; or why there is none.
    ///
    /// # Errors
    /// [`StudyError::Settings`] where the settings do not fit the scene.
    pub(crate) fn equation(
        &self,
        settings: &Settings,
    ) -> Result<Result<String, String>, StudyError> {
        let described = settings.apply(self.scene())?.equation_of_state();
        Ok(described.map(|(_, equation)| equation.spec().name.clone()))
    }
}

/// T − T_conf with its error: to first order it fluctuates as T_i − (F²_i − T_conf·L_i)/⟨L⟩, with F² the mean square
/// force and L the Laplacian of a particle.
fn temperature_difference(found: &Thermodynamics, cut: usize) -> Estimate {
    let rows = found.series();
    let ratio = statistics::ratio(&rows.squared_force, &rows.laplacian, cut).0.mean;
    let from = cut.min(rows.laplacian.len());
    let laplacian = statistics::mean(&rows.laplacian[from..]);
    let differences: Vec<f64> = (from..rows.laplacian.len())
        .map(|i| {
            let configurational =
                ratio + (rows.squared_force[i] - ratio * rows.laplacian[i]) / laplacian;
            rows.temperature[i] - configurational
        })
        .collect();
    statistics::estimate_stationary(&differences)
}

#[cfg(test)]
mod tests {
    use lennard_forcefield::TruncationKind;
    use lennard_literature::FiniteSize;

    use super::*;
    use crate::testing::bench;

    #[test]
    fn energy_errors_fall_with_the_step_and_temperatures_agree() {
        let (bench, base) = bench(&[]);
        let base = base.with_truncation(TruncationKind::Switch, 2.5, false);
        let slopes = bench.slopes(&base, 1.0).unwrap();
        assert!(slopes.source.contains("Thol"), "{slopes:?}");
        let run = |dt: f64| {
            let settings = Settings { dt, ..base.clone() };
            bench.measure(&settings, 3.0, &slopes).unwrap()
        };
        let (coarse, fine) = (run(0.008), run(0.004));
        let gain = coarse.energy_rms / fine.energy_rms;
        // The square of the step, within what the next order and three τ of chance add.
        assert!((gain / 4.0 - 1.0).abs() < 0.25, "{gain}");
        let d = fine.temperature_difference;
        assert!(d.mean.abs() < 5.0 * d.standard_error, "{d:?}");
        assert!((0.001..0.1).contains(&d.standard_error));
        // U and P are carried to the temperature at which all are compared.
        let off = fine.temperature_of_positions.mean - slopes.temperature;
        let moved = fine.pressure.mean - fine.pressure_at_reference.mean;
        assert!((moved - slopes.dp_dt * off).abs() < 1e-12);
        assert!(fine.against_equation.is_none() && !fine.remarks.is_empty());
    }

    #[test]
    fn rows_of_any_engine_stand_beside_the_equation_of_a_closed_box() {
        let (bench, base) = bench(&[]);
        let base = base.with_truncation(TruncationKind::Shift, 2.5, false);
        let (temperature, pressure) = (0.75, 0.5);
        let mut rows = ThermoSeries::default();
        for i in 0..40 {
            rows.time.push(0.04 * f64::from(i));
            rows.temperature.push(temperature);
            rows.temperature_of_positions.push(temperature);
            rows.potential_energy.push(-5.0);
            rows.pressure.push(pressure);
            rows.conserved_energy.push(-4.0);
        }
        let found = bench.measured(&base, &rows, 0, &Slopes::default()).unwrap();
        let beside = found.against_equation.unwrap();
        assert!(beside.source.contains("doi:"), "{}", beside.source);
        let (equation, density) = (lennard_literature::thol_2015(), bench.start().density());
        let n = bench.start().len();
        let term = FiniteSize::of(equation, density, temperature, n, Kept::Energy).unwrap();
        let plain = pressure - equation.at(density, temperature).pressure;
        assert!((beside.pressure.mean - (plain - term.pressure)).abs() < 1e-12, "{beside:?}");
        assert!((1e-4..0.1).contains(&term.pressure.abs()), "{term:?}");
    }

    #[test]
    fn u_at_the_temperature_of_positions_hardly_knows_the_step() {
        // At the temperature of whole steps, U would be off by the difference of the two temperatures times ∂U/∂T.
        let (bench, base) = bench(&[]);
        let base = base.with_truncation(TruncationKind::Switch, 2.5, false);
        let slopes = bench.slopes(&base, 1.0).unwrap();
        let run = |dt: f64| {
            let settings = Settings { dt, ..base.clone() };
            bench.measure(&settings, 90.0, &slopes).unwrap()
        };
        let (coarse, fine) = (run(0.02), run(0.004));
        let heat = coarse.temperature_of_positions.mean - coarse.temperature.mean;
        let seen = slopes.du_dt * heat;
        let off = coarse.potential_energy_at_reference.minus(&fine.potential_energy_at_reference);
        assert!(seen > 5.0 * off.standard_error, "{seen} {off:?}");
        assert!(off.mean.abs() < 0.5 * seen + 3.0 * off.standard_error, "{seen} {off:?}");
    }
}
