//! Pressure along the isotherms of a sweep, beside the equation of state.

use lennard_observables::quantities::quantity_of;

use super::blocks::Blocks;
use super::properties;
use super::study::StudyPoints;

/// Fewest densities that make an isotherm.
const FEWEST: usize = 3;

/// P(ρ) for each temperature with several densities.
pub(super) fn read(study: &StudyPoints<'_>) -> Blocks {
    let pressure = quantity_of("pressure");
    let drawn = pressure.and_then(|p| properties::along(study, "density", p, FEWEST));
    Blocks::of_figures(drawn)
}
