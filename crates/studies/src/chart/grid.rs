//! The settings of a chart: the points of its study file that can run from the equilibrated start.

use crate::lab::Workbench;
use crate::lists::grouped;
use crate::settings::{Settings, truncation_is_free};
use crate::sweep::{LeftOut, Sweep};
use lennard_integrators::ThermostatOptions;

/// Times of this many steps of the scene are whole numbers of steps of most settings: there trajectories are compared.
pub(super) const COMMON_STEPS: f64 = 48.0;
/// Settings to be tried, and those that were left out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Grid {
    /// To be tried, each once; the settings of the scene stand first.
    pub settings: Vec<Settings>,
    /// What does not fit the scene or its box, and why.
    pub left_out: Vec<LeftOut>,
}

/// The settings of the points of a study around the settings of the workbench's scene.
pub(crate) fn grid(bench: &Workbench, study: &Sweep) -> Grid {
    let own = Settings::of(bench.scene());
    let mut grid = Grid { settings: vec![own.clone()], left_out: study.left_out.clone() };
    for point in &study.points {
        let settings = Settings::of(&point.scene);
        if grid.settings.contains(&settings) {
            continue;
        }
        if let Some(why) = why_alike(bench, &settings, &own) {
            grid.left_out.push(LeftOut { what: settings.label(), why: why.into() });
            continue;
        }
        match bench.check(&settings) {
            Ok(()) => grid.settings.push(settings),
            Err(error) => grid.left_out.push(LeftOut::of(&settings.label(), &error)),
        }
    }
    grid.left_out = together(grid.left_out);
    grid
}

/// Why settings would run as the scene's own do.
fn why_alike(bench: &Workbench, settings: &Settings, own: &Settings) -> Option<&'static str> {
    let bath = &bench.measured_stage().thermostat;
    if settings.truncation != own.truncation && !truncation_is_free(bench.scene()) {
        Some("this potential ends by itself")
    } else if settings.integrator != own.integrator
        && matches!(bath, Some(ThermostatOptions::Langevin(_)))
    {
        Some("the Langevin bath of the measured stage is a method of its own")
    } else {
        None
    }
}

/// What is left out for one reason in one entry.
fn together(left_out: Vec<LeftOut>) -> Vec<LeftOut> {
    let all = grouped(left_out.into_iter().map(|one| (one.why, one.what)));
    let in_one = |(why, mut what): (String, Vec<String>)| match (what.len(), what.swap_remove(0)) {
        (1, what) => LeftOut { what, why },
        (n, first) => LeftOut { what: format!("{first} and {} more", n - 1), why },
    };
    all.into_iter().map(in_one).collect()
}

#[cfg(test)]
mod tests;
