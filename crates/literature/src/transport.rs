//! Transport coefficients of the full Lennard-Jones fluid from tables.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::tables::rows;

/// A transport coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TransportProperty {
    /// Shear viscosity η, √(mε)/σ².
    ShearViscosity,
    /// Self-diffusion coefficient D, σ√(ε/m).
    SelfDiffusion,
    /// Thermal conductivity λ, k_B√(ε/m)/σ².
    ThermalConductivity,
}

/// A tabulated value, or one between two tabulated ones, with the state that it belongs to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TransportValue {
    /// The coefficient in the units of its [`TransportProperty`].
    pub value: f64,
    /// One standard deviation, where the source gives one.
    pub uncertainty: Option<f64>,
    /// Density of the tabulated state, σ⁻³.
    pub rho: f64,
    /// Temperature of the state, ε/k_B: the tabulated one, or the one asked for between two.
    pub temperature: f64,
    /// The two tabulated temperatures that it lies between, where it is interpolated.
    pub between: Option<(f64, f64)>,
    /// Authors, title, DOI, and how the number was obtained.
    pub source: String,
}

impl TransportValue {
    /// Which tabulated state or states it is from, in words.
    #[must_use]
    pub fn state_words(&self) -> String {
        match self.between {
            None => format!("tabulated at ρ = {}, T = {}", self.rho, self.temperature),
            Some((low, high)) => format!(
                "tabulated at ρ = {}, T = {low} and {high}, and taken on the line between them",
                self.rho
            ),
        }
    }
}

/// How far in density (σ⁻³) a tabulated state may lie to be called near.
pub const NEAR_DENSITY: f64 = 0.01;
/// How far in temperature, relative, a tabulated state may lie to be called near.
pub const NEAR_TEMPERATURE: f64 = 0.05;
/// How far apart two densities may be to be called the same: the digits of the tables, in σ⁻³.
pub const SAME_DENSITY: f64 = 0.0005;
/// The largest ratio of two tabulated temperatures between which a line is drawn.
pub const SAME_LINE: f64 = 1.35;

const CHAPARRO_MUELLER: &str = "G. Chaparro, E. A. Müller, J. Phys. Chem. B (2023), \
    DOI 10.1021/acs.jpcb.3c06813, database of the authors, read directly";

#[derive(Debug)]
struct Row {
    property: TransportProperty,
    value: TransportValue,
}

/// The state columns of the tables of Chaparro and Müller; the third from the fifth column on
/// bears the property's name.
#[derive(Debug, Deserialize)]
struct ChaparroRow {
    rho: f64,
    #[serde(rename = "T")]
    temperature: f64,
    #[serde(alias = "shear_viscosity", alias = "self_diffusivity", alias = "thermal_conductivity")]
    value: f64,
    #[serde(
        alias = "shear_viscosity_std",
        alias = "self_diffusivity_std",
        alias = "thermal_conductivity_std"
    )]
    standard_deviation: f64,
    phase: String,
    flag: Option<String>,
}

#[derive(Debug, Deserialize)]
struct OtherRow {
    quantity: TransportProperty,
    rho: f64,
    #[serde(rename = "T")]
    temperature: f64,
    value: f64,
    uncertainty: Option<f64>,
    citation: String,
    doi: String,
    status: String,
}

static TABLE: LazyLock<Vec<Row>> = LazyLock::new(|| {
    let files = [
        (TransportProperty::ShearViscosity, "shear-viscosity"),
        (TransportProperty::SelfDiffusion, "self-diffusion"),
        (TransportProperty::ThermalConductivity, "thermal-conductivity"),
    ];
    let mut table = Vec::new();
    for (property, name) in files {
        for row in rows::<ChaparroRow>(name) {
            // Flagged rows contradict the equation of state; inside the dome a homogeneous value
            // has no meaning.
            if row.flag.is_some() || row.phase != "stable_fluid" {
                continue;
            }
            table.push(Row {
                property,
                value: TransportValue {
                    value: row.value,
                    uncertainty: Some(row.standard_deviation),
                    rho: row.rho,
                    temperature: row.temperature,
                    between: None,
                    source: CHAPARRO_MUELLER.to_owned(),
                },
            });
        }
    }
    for row in rows::<OtherRow>("transport-other") {
        table.push(Row {
            property: row.quantity,
            value: TransportValue {
                value: row.value,
                uncertainty: row.uncertainty,
                rho: row.rho,
                temperature: row.temperature,
                between: None,
                source: format!("{}, DOI {}, {}", row.citation, row.doi, row.status),
            },
        });
    }
    table
});

/// The value at a density (σ⁻³) and temperature (ε/k_B) of the full Lennard-Jones fluid, if the tables have one near.
///
/// Two tabulated states of that density (within [`SAME_DENSITY`]) may enclose the temperature, no further apart than a
/// factor [`SAME_LINE`]. The value then lies on the line between them, with the errors of both in proportion. Along the
/// tables' densities D differs from such a line by 0.2 %, η and λ by less than their errors. Elsewhere it is the nearest
/// state within [`NEAR_DENSITY`] and [`NEAR_TEMPERATURE`], by the smallest (Δρ/0.01)² + (ΔT/0.05 T)². The coefficients
/// change fastest in the dense liquid. Over that distance η differs there by about a tenth at most, as large as its own
/// error. The finite-size correction of D uses η and is itself a tenth of D, so it differs by less than 1 % of D.
///
/// Rows that contradict the equation of state or lie inside the vapor–liquid dome are left out. Values of the full
/// potential are no reference for a truncated one.
#[must_use]
pub fn transport_near(
    property: TransportProperty,
    rho: f64,
    temperature: f64,
) -> Option<TransportValue> {
    let of_property =
        || TABLE.iter().filter(move |row| row.property == property).map(|row| &row.value);
    let same_density = || of_property().filter(|v| (v.rho - rho).abs() <= SAME_DENSITY);
    let below = same_density()
        .filter(|v| v.temperature <= temperature)
        .max_by(|a, b| a.temperature.total_cmp(&b.temperature));
    let above = same_density()
        .filter(|v| v.temperature > temperature)
        .min_by(|a, b| a.temperature.total_cmp(&b.temperature));
    if let (Some(low), Some(high)) = (below, above)
        && high.temperature <= SAME_LINE * low.temperature
        && low.source == high.source
    {
        return Some(between(low, high, temperature));
    }
    let distance = |v: &TransportValue| {
        let density = (v.rho - rho) / NEAR_DENSITY;
        let warmth = (v.temperature - temperature) / (NEAR_TEMPERATURE * temperature);
        (density.abs() <= 1.0 && warmth.abs() <= 1.0).then_some(density * density + warmth * warmth)
    };
    of_property()
        .filter_map(|value| Some((distance(value)?, value)))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, value)| value.clone())
}

/// The value on the line between two states of one density.
fn between(low: &TransportValue, high: &TransportValue, temperature: f64) -> TransportValue {
    let share = (temperature - low.temperature) / (high.temperature - low.temperature);
    let uncertainty =
        low.uncertainty.zip(high.uncertainty).map(|(l, h)| ((1.0 - share) * l).hypot(share * h));
    TransportValue {
        value: (1.0 - share) * low.value + share * high.value,
        uncertainty,
        rho: low.rho,
        temperature,
        between: Some((low.temperature, high.temperature)),
        source: low.source.clone(),
    }
}

/// Shear viscosity in √(mε)/σ² near a state, as [`transport_near`] finds it; for the finite-size
/// correction of the diffusion coefficient (I.-C. Yeh, G. Hummer, System-size dependence of
/// diffusion coefficients and viscosities from molecular dynamics simulations with periodic boundary
/// conditions, J. Phys. Chem. B 108, 15873, 2004).
#[must_use]
pub fn viscosity_near(rho: f64, temperature: f64) -> Option<TransportValue> {
    transport_near(TransportProperty::ShearViscosity, rho, temperature)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_hold_the_stable_rows_and_no_flagged_one() {
        let count = |p| TABLE.iter().filter(|r| r.property == p).count();
        // 253, 304 and 231 rows in the files, less those inside the dome or flagged, plus Meier's.
        assert_eq!(count(TransportProperty::ShearViscosity), 227 + 1);
        assert!(count(TransportProperty::SelfDiffusion) > 200);
        assert!(count(TransportProperty::ThermalConductivity) > 150);
        assert!(TABLE.iter().all(|r| r.value.value > 0.0));
    }

    #[test]
    fn the_nearest_row_is_found_with_its_own_state_and_source() {
        let v = viscosity_near(0.848, 1.001).unwrap();
        assert_eq!((v.rho, v.temperature), (0.85, 0.999984));
        assert_eq!((v.value, v.uncertainty), (2.88621, Some(0.37)));
        assert!(v.source.contains("Chaparro") && v.between.is_none());
    }

    #[test]
    fn between_two_temperatures_of_one_density_a_line_is_drawn() {
        let d = |t| transport_near(TransportProperty::SelfDiffusion, 0.85, t).unwrap();
        let (low, high) = (d(0.8999), d(1.1));
        assert!(low.between.is_none(), "below the first there is no line");
        let (cold, hot) = d(1.0).between.unwrap();
        assert!((cold - 0.9).abs() < 0.01 && (hot - 1.1).abs() < 0.01);
        let share = (1.0 - cold) / (hot - cold);
        let line = low.value + share * (high.value - low.value);
        // 1.1 itself lies on the next line, a hair from its lower end.
        assert!((d(1.0).value - line).abs() < 1e-4, "{}", d(1.0).value);
        // Independent errors of the two ends: smaller between them than at either.
        let error = |v: &TransportValue| v.uncertainty.unwrap();
        assert!(error(&d(1.0)) < error(&low).max(error(&high)));
        assert!(d(1.0).state_words().contains("between"));
    }

    #[test]
    fn what_was_not_read_in_the_paper_says_so() {
        let v = viscosity_near(0.8442, 0.722).unwrap();
        assert_eq!(v.value, 3.258);
        assert!(v.source.contains("secondary"));
    }

    #[test]
    fn a_state_with_nothing_near_gives_nothing() {
        assert_eq!(viscosity_near(0.8442, 0.80), None);
        assert_eq!(viscosity_near(0.70, 0.5), None);
        assert_eq!(viscosity_near(f64::NAN, 1.0), None);
        // The only row near this state lies inside the dome.
        assert_eq!(viscosity_near(0.819, 0.7396), None);
    }

    #[test]
    fn diffusion_is_looked_up_in_its_own_table() {
        let d = transport_near(TransportProperty::SelfDiffusion, 0.8442, 0.722).unwrap();
        assert_eq!(d.value, 0.0325);
        assert_eq!(
            transport_near(TransportProperty::SelfDiffusion, 0.01, 2.89978).unwrap().value,
            38.1662
        );
    }
}
