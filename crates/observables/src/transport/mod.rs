//! Transport coefficients from the fluctuations of fluxes at equilibrium.

mod conductivity;
mod green_kubo;
mod helfand;
mod mutual_diffusion;
mod of_flux;
mod viscosity;

pub use conductivity::{ThermalConductivity, ThermalConductivityOptions};
pub use mutual_diffusion::MutualDiffusionOptions;
pub use viscosity::{ShearViscosity, ShearViscosityOptions};

use lennard_core::number::short;

use crate::error::positive;
use crate::{BuildContext, ObservableError};

/// The longest lag in τ where the scene names none: several times the longest relaxation of a dense liquid
/// near its triple point.
const DEFAULT_WINDOW: f64 = 10.0;

/// Sampling intervals that a window must hold at least.
const FEWEST_LAGS: f64 = 32.0;

/// The interval between samples, where the window suits it.
fn checked_interval(window: f64, context: &BuildContext) -> Result<f64, ObservableError> {
    positive("window", Some(window))?;
    let interval = context.sample_interval();
    if window < FEWEST_LAGS * interval {
        return Err(ObservableError::new(
            "window",
            window,
            format!(
                "at least {FEWEST_LAGS} sampling intervals of {} τ (change `window` or `every`)",
                short(interval)
            ),
        ));
    }
    Ok(interval)
}
