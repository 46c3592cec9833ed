//! What is chosen last, since no error depends on it: the list and the number of threads.

use lennard_forcefield::ListMode;
use lennard_scene::Scene;

use crate::StudyError;
use crate::lab::{Cost, Workbench, costs};
use crate::settings::Settings;

/// Another list or number of threads must be this much cheaper to be taken.
const WORTHWHILE: f64 = 0.95;
/// Skins tried, as multiples of the one that the cost model chooses.
const SKINS: [f64; 2] = [0.7, 1.4];
/// Timings at the end: repeats, and seconds of each.
pub(super) const FINAL_TIMING: (usize, f64) = (3, 0.15);

/// The settings with the longest cutoff that fits the box of a workbench.
pub(super) fn fitting(settings: &Settings, bench: &Workbench) -> Settings {
    let mut fitted = settings.clone();
    let largest = bench.start().cell.largest_cutoff() / bench.scene().cutoff_unit();
    fitted.truncation.r_cut = fitted.truncation.r_cut.min(largest * (1.0 - 1e-6));
    fitted
}

/// The list and the number of threads that make the settings cheapest, where the scene leaves them open.
pub(super) fn list_and_threads(
    scene: &Scene,
    bench: &Workbench,
    settings: &Settings,
    threads: usize,
) -> Result<(Settings, usize), StudyError> {
    let fixed = |key: &str| scene.source.wrote(key);
    let mut tried = vec![settings.clone()];
    if !fixed("neighbor.skin") && !fixed("neighbor.mode") {
        let applied = settings.apply(bench.scene())?;
        let start = bench.start();
        let skin = start.forces(&applied)?.plan().skin;
        for factor in SKINS {
            let rounded = (100.0 * factor * skin).round() / 100.0;
            let other =
                Settings { list: ListMode::Verlet, skin: Some(rounded), ..settings.clone() };
            if rounded > 0.0 && bench.check(&other).is_ok() {
                tried.push(other);
            }
        }
    }
    let (repeats, seconds) = FINAL_TIMING;
    let lowest =
        |cost: &Result<Cost, _>| cost.as_ref().map_or(f64::INFINITY, |c: &Cost| c.wall.lowest);
    let found = costs(bench, &tried, 1, repeats, seconds, 2)?;
    let mut best = 0;
    for i in 1..tried.len() {
        if lowest(&found[i]) < WORTHWHILE * lowest(&found[0])
            && lowest(&found[i]) < lowest(&found[best])
        {
            best = i;
        }
    }
    let chosen = tried.swap_remove(best);
    if threads == 1 {
        return Ok((chosen, 1));
    }
    let all = std::slice::from_ref(&chosen);
    let together = costs(bench, all, threads, repeats, seconds, 3)?;
    let pays = lowest(&together[0]) < WORTHWHILE * lowest(&found[best]);
    Ok((chosen, if pays { threads } else { 1 }))
}
