//! How U and P change with the temperature.

use serde::{Deserialize, Serialize};

use super::workbench::Workbench;
use crate::StudyError;
use crate::settings::Settings;

/// Factor of the kinetic energy, and of the bath's temperature, in the second run for the slopes.
const HOTTER: f64 = 1.2;

/// How U and P change with the temperature at constant density. Runs at constant energy each settle at a
/// temperature of their own; with these slopes they can be compared.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Slopes {
    /// The temperature of the positions at which all are compared, ε/k_B.
    pub temperature: f64,
    /// ∂U/∂T, k_B.
    pub du_dt: f64,
    /// ∂P/∂T, k_B/σ³.
    pub dp_dt: f64,
    /// Where they come from.
    pub source: String,
}

impl Workbench {
    /// How U and P change with temperature, from the equation of state of the full Lennard-Jones fluid where it covers
    /// the state. Elsewhere, two runs of `tight` settings give it: the second has more kinetic energy and a hotter
    /// bath.
    ///
    /// # Errors
    /// [`StudyError`] where those runs cannot be made or fail.
    pub(crate) fn slopes(&self, tight: &Settings, time: f64) -> Result<Slopes, StudyError> {
        let temperature = self.measured_stage().temperature;
        let equation = lennard_literature::thol_2016();
        let density = self.start().density();
        let scene = self.scene();
        let is_one_fluid = scene.molecule.is_none() && scene.cutoff_of_one_fluid().is_some();
        if is_one_fluid
            && scene.potential.spec().is_lennard_jones
            && equation.check(density, temperature).is_ok()
        {
            let state = equation.at(density, temperature);
            return Ok(Slopes {
                temperature,
                du_dt: state.du_dt,
                dp_dt: state.dp_dt,
                source: equation.spec().name.clone(),
            });
        }
        let none = Slopes { temperature, du_dt: 0.0, dp_dt: 0.0, source: String::new() };
        let colder = self.measure(tight, time, &none)?;
        let (mut scene, mut start) = (self.scene().clone(), self.start().clone());
        for stage in &mut scene.stages {
            stage.temperature *= HOTTER;
        }
        for v in &mut start.velocities {
            *v *= HOTTER.sqrt();
        }
        let hotter = Self::with_start(&scene, start).measure(tight, time, &none)?;
        let rise = hotter.temperature_of_positions.mean - colder.temperature_of_positions.mean;
        Ok(Slopes {
            du_dt: (hotter.potential_energy.mean - colder.potential_energy.mean) / rise,
            dp_dt: (hotter.pressure.mean - colder.pressure.mean) / rise,
            source: format!("two runs, the second {rise:.3} ε/k_B hotter"),
            temperature,
        })
    }
}

#[cfg(test)]
mod tests {
    use lennard_integrators::ThermostatOptions;

    use super::*;
    use crate::settings::tests::scene;

    #[test]
    fn slopes_without_an_equation_come_from_two_runs() {
        let free = scene(&[("potential.kind", "wca")]);
        let mut held = free.clone();
        for stage in &mut held.stages {
            stage.thermostat = Some(ThermostatOptions::Bussi(Default::default()));
        }
        for scene in [free, held] {
            let bench = Workbench::new(&scene).unwrap();
            let slopes = bench.slopes(&Settings::of(&scene), 4.0).unwrap();
            assert!(slopes.source.contains("two runs"), "{slopes:?}");
            // Repulsive spheres at this density: both rise with temperature.
            assert!(slopes.du_dt > 0.0 && slopes.dp_dt > 1.0, "{slopes:?}");
        }
    }
}
