//! Vapor and liquid side by side: densities, vapor pressure and surface tension of a model.

use serde::Deserialize;

use crate::fluid_state::CriticalPoint;
use crate::model::{ModelKind, NoReference, THOL_2015_CUTOFF, equation_of_state_for};
use crate::saturation::Saturation;
use crate::tables::reference_table;

/// What the literature says of two phases at one temperature.
#[derive(Debug, Clone, PartialEq)]
pub struct TwoPhases {
    /// Densities of both phases, and the vapor pressure.
    pub saturation: Saturation,
    /// Surface tension in ε/σ²; `None` where no source was read for the model.
    pub surface_tension: Option<f64>,
    /// Where the numbers are from.
    pub source: String,
}

/// Which source describes two phases of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TwoPhaseSource {
    /// The correlations of Vrabec et al. 2006 for the potential truncated at 2.5 σ and shifted.
    Vrabec,
    /// The equation of state of the model, which has no surface tension.
    Equation(ModelKind),
}

impl TwoPhaseSource {
    /// The source for a model.
    ///
    /// Particles move by forces. A plain cutoff without tail corrections has the forces of the truncated and shifted
    /// potential, and therefore its phases.
    ///
    /// # Errors
    /// [`NoReference`] where no source describes the model.
    pub fn of(model: ModelKind) -> Result<Self, NoReference> {
        match model {
            ModelKind::Shifted { r_cut } | ModelKind::CutWithoutTail { r_cut }
                if r_cut == THOL_2015_CUTOFF =>
            {
                Ok(Self::Vrabec)
            }
            other => equation_of_state_for(other).map(|_| Self::Equation(other)),
        }
    }

    /// Vapor and liquid at a temperature (ε/k_B); `None` outside the range of the source.
    #[must_use]
    pub fn at(self, temperature: f64) -> Option<TwoPhases> {
        match self {
            Self::Vrabec => vrabec(temperature),
            Self::Equation(model) => {
                let equation = equation_of_state_for(model).ok()?;
                Some(TwoPhases {
                    saturation: equation.saturation(temperature)?,
                    surface_tension: None,
                    source: equation.spec().citation(),
                })
            }
        }
    }

    /// The critical point of the source.
    #[must_use]
    pub fn critical(self) -> CriticalPoint {
        match self {
            Self::Vrabec => CRITICAL,
            Self::Equation(model) => {
                equation_of_state_for(model).map_or(CRITICAL, |e| e.spec().critical)
            }
        }
    }

    /// A short name for a legend.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Vrabec => "Vrabec 2006".into(),
            Self::Equation(model) => {
                equation_of_state_for(model).map_or_else(|e| e.model, |e| e.spec().name.to_owned())
            }
        }
    }
}

const CRITICAL: CriticalPoint = CriticalPoint { temperature: 1.0779, density: 0.3190 };
/// The lowest temperature of the correlations, ε/k_B: their simulations end there.
const COLDEST: f64 = 0.62;
const VRABEC: &str = "J. Vrabec, G. K. Kedia, G. Fuchs, H. Hasse, Mol. Phys. 104, 1509 (2006), doi:10.1080/00268970600556774";

/// Equations 4, 5 and 15 of the paper and its vapor pressure, read from a copy. A test compares them with the table.
fn vrabec(temperature: f64) -> Option<TwoPhases> {
    let t = temperature;
    if !(COLDEST..CRITICAL.temperature).contains(&t) {
        return None;
    }
    let below = CRITICAL.temperature - t;
    let (root, power) = (below.cbrt(), below.powf(1.5));
    let saturation = Saturation {
        temperature,
        pressure: (3.1664 - 5.9809 / t + 0.01498 / t.powi(3)).exp(),
        vapor_density: CRITICAL.density - 0.5649 * root + 0.2128 * below + 0.0702 * power,
        liquid_density: CRITICAL.density + 0.5649 * root + 0.1314 * below + 0.0413 * power,
    };
    Some(TwoPhases {
        saturation,
        surface_tension: Some(2.08 * (1.0 - t / CRITICAL.temperature).powf(1.21)),
        source: VRABEC.to_owned(),
    })
}

/// The columns that are read of the table `interfaces`.
#[derive(Debug, Deserialize)]
struct Row {
    #[serde(rename = "T")]
    temperature: f64,
    gamma: f64,
}

/// Temperature (ε/k_B) and surface tension (ε/σ²) of single simulations of the potential truncated at 2.5 σ and shifted:
/// the rows of the table `interfaces`.
///
/// # Panics
/// Where the shipped table is not well formed, which a test excludes.
#[must_use]
pub fn surface_tensions_by_simulation() -> Vec<(f64, f64)> {
    let table = reference_table("interfaces").map_or("", |table| table.csv);
    csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_reader(table.as_bytes())
        .deserialize()
        .map(|row| {
            let row: Row = row.expect("the shipped table is well formed: a test reads it");
            (row.temperature, row.gamma)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Deserialize)]
    struct Full {
        #[serde(rename = "T")]
        t: f64,
        gamma: f64,
        gamma_fit: f64,
        rho_liq_fit: f64,
        rho_vap_fit: f64,
        psat_fit: f64,
    }

    #[test]
    fn the_correlations_are_the_tabulated_ones_and_lie_near_the_equation() {
        let table = reference_table("interfaces").unwrap().csv;
        let rows: Vec<Full> = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .from_reader(table.as_bytes())
            .deserialize()
            .collect::<Result<_, _>>()
            .unwrap();
        assert_eq!(rows.len(), surface_tensions_by_simulation().len());
        assert_eq!(rows.len(), 18);
        for row in rows {
            let found = vrabec(row.t).unwrap();
            let s = found.saturation;
            let tension = found.surface_tension.unwrap();
            // Half a unit of the last digit of the table, and of a rounded one.
            assert!((s.liquid_density - row.rho_liq_fit).abs() < 6e-6, "{row:?}");
            assert!((s.vapor_density - row.rho_vap_fit).abs() < 6e-7, "{row:?}");
            assert!((s.pressure - row.psat_fit).abs() < 6e-7, "{row:?}");
            assert!((tension - row.gamma_fit).abs() < 6e-5, "{row:?}");
            // Single simulations scatter about the fit.
            assert!((tension - row.gamma).abs() < 0.012, "{row:?}");
            let equation = crate::thol_2015().saturation(row.t).unwrap();
            assert!((s.pressure / equation.pressure - 1.0).abs() < 0.02);
            let gap = (s.liquid_density - equation.liquid_density).abs();
            assert!(gap < if row.t < 1.0 { 0.002 } else { 0.01 }, "{row:?}");
        }
    }

    #[test]
    fn like_is_compared_with_like() {
        let of = |model| TwoPhaseSource::of(model);
        assert_eq!(of(ModelKind::CutWithoutTail { r_cut: 2.5 }), Ok(TwoPhaseSource::Vrabec));
        assert!(of(ModelKind::CutWithoutTail { r_cut: 4.0 }).is_err());
        assert!(of(ModelKind::Shifted { r_cut: 3.0 }).is_err());
        let full = of(ModelKind::CutWithTail { r_cut: 2.5 }).unwrap();
        let at = full.at(0.85).unwrap();
        assert!((at.saturation.liquid_density - 0.77633).abs() < 1e-4);
        assert_eq!(at.surface_tension, None);
        assert_eq!(full.at(1.4), None);
        assert_eq!(TwoPhaseSource::Vrabec.at(1.08), None);
        assert_eq!(TwoPhaseSource::Vrabec.at(0.5), None);
    }
}
