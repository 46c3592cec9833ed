//! A slab beside what the literature has for vapor and liquid in equilibrium.

use lennard_literature::TwoPhaseSource;
use lennard_observables::quantities::Beside;

use super::Row;
use super::rows::Compared;
use super::verdict::Tolerance;

const LIQUID_DENSITY: Tolerance = Tolerance::new(2.0, 0.0, 0.005);
/// The vapor, its pressure and the surface tension change steeply with temperature: sources differ by so much.
const STEEP: Tolerance = Tolerance::new(2.0, 0.0, 0.03);

impl Compared<'_> {
    /// A number of a slab beside the literature at the measured temperature.
    ///
    /// The normal pressure of a flat interface is the vapor pressure, since it is the same on both sides.
    pub(super) fn beside_two_phases(&self, row: Row, beside: Beside) -> Row {
        if !self.run.has_two_phases() {
            return row;
        }
        let source = match TwoPhaseSource::of(self.model) {
            Ok(source) => source,
            Err(none) => return row.without_reference(none.to_string()),
        };
        let Some(phases) = source.at(self.state.temperature) else {
            let none = format!("{} has no two phases at this temperature", source.name());
            return row.without_reference(none);
        };
        let saturation = phases.saturation;
        let (reference, tolerance) = match beside {
            Beside::LiquidDensity => (Some(saturation.liquid_density), LIQUID_DENSITY),
            Beside::VaporDensity => (Some(saturation.vapor_density), STEEP),
            Beside::VaporPressure => (Some(saturation.pressure), STEEP),
            _ => (phases.surface_tension, STEEP),
        };
        match reference {
            Some(reference) => row.against(reference, None, tolerance, &phases.source),
            None => {
                row.without_reference("no source with a surface tension of this model was read")
            }
        }
        .noted(format!("of {}", self.run.record.model))
    }
}
