//! Critical and triple points by others.

use serde::Deserialize;

use crate::model::{ModelKind, THOL_2015_CUTOFF};
use crate::tables::rows;

/// A critical or a triple point that others have found. Densities and pressures are absent where they were not read.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownPoint {
    /// Whether it is a critical point, or else a triple point.
    pub is_critical: bool,
    /// Temperature, ε/k_B.
    pub temperature: f64,
    /// Density, σ⁻³.
    pub density: Option<f64>,
    /// Pressure, ε/σ³.
    pub pressure: Option<f64>,
    /// Who found it.
    pub source: String,
}

/// The columns that are read of the table `critical-and-triple-points`. A number may have its error in brackets.
#[derive(Debug, Deserialize)]
struct Row {
    system: String,
    point: String,
    source: String,
    #[serde(rename = "T")]
    temperature: String,
    rho: String,
    p: String,
}

/// A number without the error in brackets behind it.
fn number(text: &str) -> Option<f64> {
    text.split('(').next()?.trim().parse().ok()
}

/// The points of a model: the rows of the table `critical-and-triple-points`. Forces alone decide the phases of a simulation, so that a
/// plain cutoff without a tail has the points of the shifted potential.
#[must_use]
pub fn known_points(model: ModelKind) -> Vec<KnownPoint> {
    let system = match model {
        ModelKind::CutWithTail { .. } => "full LJ",
        ModelKind::Shifted { r_cut } | ModelKind::CutWithoutTail { r_cut }
            if r_cut == THOL_2015_CUTOFF =>
        {
            "LJ cut-and-shifted rc=2.5"
        }
        _ => return Vec::new(),
    };
    rows::<Row>("critical-and-triple-points")
        .into_iter()
        .filter(|row| row.system == system)
        .filter_map(|row| {
            Some(KnownPoint {
                is_critical: row.point == "critical",
                temperature: number(&row.temperature)?,
                density: number(&row.rho),
                pressure: number(&row.p),
                source: row.source,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_others_lie_near_the_ones_of_the_equations() {
        let models = [
            (ModelKind::CutWithTail { r_cut: 4.0 }, 1.32, 3, 1),
            (ModelKind::Shifted { r_cut: 2.5 }, 1.086, 2, 2),
        ];
        for (model, critical, points, critical_points) in models {
            let found = known_points(model);
            assert_eq!(found.len(), points, "{found:?}");
            let of_critical: Vec<_> = found.iter().filter(|p| p.is_critical).collect();
            assert_eq!(of_critical.len(), critical_points);
            for point in of_critical {
                assert!((point.temperature - critical).abs() < 0.02, "{point:?}");
                assert!(point.density.is_some(), "{point:?}");
            }
            let mut triple = found.iter().filter(|p| !p.is_critical);
            assert!(triple.all(|p| (p.temperature - 0.69).abs() < 0.01));
        }
        assert!(known_points(ModelKind::ForceShifted { r_cut: 2.5 }).is_empty());
    }
}
