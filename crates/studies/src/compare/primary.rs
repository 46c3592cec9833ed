//! The quantities that readers look for first.

use lennard_observables::quantities::{QUANTITIES, Setting};
use lennard_observables::{CORRECTED, UNCORRECTED};

use super::RunFolder;

/// What the readers of a run look at first.
fn setting(run: &RunFolder) -> Setting {
    if run.has_two_phases() {
        Setting::Slab
    } else if !run.scene.walls.is_empty() {
        Setting::Walls
    } else if run.scene.half_crystal().is_some() {
        Setting::Fronts
    } else {
        Setting::Fluid
    }
}

/// What belongs first in the table of a run, besides its temperature.
pub(super) fn of(run: &RunFolder) -> impl Iterator<Item = &'static str> {
    let setting = setting(run);
    let of_setting = QUANTITIES.iter().filter(move |q| q.primary.contains(&setting));
    // Of two diffusion coefficients of one slope, the one of an infinite system comes first.
    let hidden = run.average(CORRECTED).and(Some(UNCORRECTED));
    of_setting.map(|q| q.key).filter(move |key| Some(*key) != hidden)
}
