//! Which phase a state is in, so that a metastable or two-phase state is said to be one.

use serde::Serialize;

use crate::bisection::bisect;
use crate::fluid_state::{CriticalPoint, FluidState};
use crate::saturation::Saturation;

/// Where a state lies in the phase diagram of an equation of state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// Stable, below the critical temperature, less dense than the saturated vapor.
    Gas,
    /// Stable, below the critical temperature, denser than the saturated liquid and not frozen.
    Liquid,
    /// Stable, above the critical temperature and not frozen.
    Supercritical,
    /// Between binodal and spinodal on the side of the vapor: condenses in the end.
    MetastableVapor,
    /// Between binodal and spinodal on the side of the liquid: boils or cavitates in the end.
    MetastableLiquid,
    /// Inside the spinodal: separates into vapor and liquid at once.
    InsideDome,
    /// Denser than the freezing liquid: crystal, or crystal and liquid, in equilibrium.
    AboveFreezing,
    /// Dense, below the triple temperature: an undercooled liquid.
    BelowTriplePoint,
    /// The equation does not cover this state.
    OutsideRange,
}

impl Phase {
    /// Whether the state is a single stable fluid phase, so that a run may be judged by the equation.
    #[must_use]
    pub fn is_stable(self) -> bool {
        matches!(self, Self::Gas | Self::Liquid | Self::Supercritical)
    }

    /// One phrase for a table or a message.
    #[must_use]
    pub fn describe(self) -> &'static str {
        match self {
            Self::Gas => "stable gas",
            Self::Liquid => "stable liquid",
            Self::Supercritical => "stable supercritical fluid",
            Self::MetastableVapor => "metastable vapor, denser than the saturated one",
            Self::MetastableLiquid => "metastable liquid, less dense than the saturated one",
            Self::InsideDome => "inside the vapor–liquid dome, unstable",
            Self::AboveFreezing => "denser than the freezing liquid, metastable as a fluid",
            Self::BelowTriplePoint => "below the triple temperature, metastable as a liquid",
            Self::OutsideRange => "outside the range of the equation of state",
        }
    }
}

impl std::fmt::Display for Phase {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.describe())
    }
}

/// The densities in σ⁻³ at which vapor and liquid become unstable, where ∂p/∂ρ first vanishes between the binodal
/// densities, from either side.
pub(crate) fn spinodal(
    state_at: &dyn Fn(f64, f64) -> FluidState,
    saturation: Saturation,
) -> Option<[f64; 2]> {
    const STEPS: usize = 256;
    const HALVINGS: usize = 48;
    let Saturation { temperature, vapor_density: vapor, liquid_density: liquid, .. } = saturation;
    let stable = |rho: f64| state_at(rho, temperature).dp_drho > 0.0;
    let first_unstable = |from: f64, to: f64| {
        let at = |step: usize| from + (to - from) * step as f64 / STEPS as f64;
        let step = (1..STEPS).find(|step| !stable(at(*step)))?;
        Some(bisect(at(step - 1), at(step), HALVINGS, stable)[0])
    };
    Some([first_unstable(vapor, liquid)?, first_unstable(liquid, vapor)?])
}

/// What [`classify`] needs to know.
pub(crate) struct Question<'a> {
    pub state_at: &'a dyn Fn(f64, f64) -> FluidState,
    pub critical: CriticalPoint,
    pub saturation: Option<Saturation>,
    pub freezing_density: Option<f64>,
    pub freezing_known: bool,
    pub rho: f64,
    pub temperature: f64,
}

/// Densities tried between a state and the binodal. The equations have several loops inside the
/// dome, so the slope at the state alone decides nothing.
const LOOKS: usize = 64;

pub(crate) fn classify(q: &Question<'_>) -> Phase {
    if q.freezing_density.is_some_and(|freezing| q.rho > freezing) {
        return Phase::AboveFreezing;
    }
    if q.temperature >= q.critical.temperature {
        return Phase::Supercritical;
    }
    let Some(saturation) = q.saturation else {
        // Within a hair of the critical point, or no coexistence found: only the slope is left.
        return if (q.state_at)(q.rho, q.temperature).dp_drho <= 0.0 {
            Phase::InsideDome
        } else if q.rho > q.critical.density {
            Phase::Liquid
        } else {
            Phase::Gas
        };
    };
    let stable_up_to = |binodal: f64| {
        (0..=LOOKS).all(|i| {
            let way = i as f64 / LOOKS as f64;
            (q.state_at)(q.rho + way * (binodal - q.rho), q.temperature).dp_drho > 0.0
        })
    };
    if q.rho <= saturation.vapor_density {
        Phase::Gas
    } else if q.rho < saturation.liquid_density {
        if stable_up_to(saturation.liquid_density) {
            Phase::MetastableLiquid
        } else if stable_up_to(saturation.vapor_density) {
            Phase::MetastableVapor
        } else {
            Phase::InsideDome
        }
    } else if q.freezing_known && q.freezing_density.is_none() {
        Phase::BelowTriplePoint
    } else {
        Phase::Liquid
    }
}
