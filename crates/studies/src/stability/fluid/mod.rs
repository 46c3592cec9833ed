//! The fluid part of the study: the largest step at which each method stays stable in a Lennard-Jones liquid. Below
//! it, drift and fluctuation of the energy are measured.
//!
//! A study file names scene and points: methods, steps, temperatures, truncations and precisions. Points that begin alike share one
//! equilibrated start. A run lasts as long as the measured stage with the step of the base scene. Limits are searched for each method
//! from each start where it has points. Methods whose steps iterate have limits with the smooth truncation alone. The quick study
//! searches none for them, and one for each group of equivalent methods.

mod limit;
mod run;
mod tables;

use std::cmp::Reverse;

use lennard_core::IntegratorSpec;
use lennard_forcefield::Precision;
use lennard_integrators::integrators;
use lennard_scene::Scene;

use super::groups::stands_for_itself;
use crate::claims::Measured;
use crate::fluid::FluidStudy;
use crate::jobs::side_by_side;
use crate::report::significant;
use crate::{Progress, StudyError};
use limit::{FluidLimit, LEAST_STEPS};
use run::{BELOW, FluidRun, PAST, Plan, SHOWN, SMALL};

/// Steps past the limit, as multiples of it.
const PAST_LIMIT: [f64; 4] = [1.05, 1.2, 1.5, 2.0];
/// The key of the points that show the floor of each precision: velocity Verlet at small steps.
const PRECISION: &str = "kernel.precision";
/// Shares of time at which runs below the limits, limits, and runs past them are done; before the first, starts are equilibrated.
const SHARES: [f64; 4] = [0.06, 0.5, 0.94, 1.0];

fn spec(scene: &Scene) -> &'static IntegratorSpec {
    scene.integrator.method.spec()
}

/// The place of a method in the list.
fn place(method: &str) -> Option<usize> {
    integrators().iter().position(|entry| entry.spec.name == method)
}

/// Whether a step of a method iterates: it does not declare how many evaluations it takes.
fn is_costly(plan: &Plan<'_>) -> bool {
    spec(plan.scene).force_evaluations == 0
}

/// Runs the points of a fluid and searches limits; `progress` hears shares of it.
pub(super) fn measure(
    study: &FluidStudy,
    quick: bool,
    progress: &mut dyn Progress,
    found: &mut Measured,
) -> Result<(), StudyError> {
    let (starts, of_points) = study.starts(|share| {
        progress.update("fluid: equilibration", SHARES[0] * share);
    })?;
    let mut between = |part: usize, label: &str, share: f64| {
        progress.update(label, SHARES[part - 1] + (SHARES[part] - SHARES[part - 1]) * share);
    };

    let (mut plans, mut searches): (Vec<Plan<'_>>, Vec<Plan<'_>>) = (Vec::new(), Vec::new());
    for (point, start) in study.points.iter().zip(of_points) {
        let scene = &point.scene;
        let (name, dt) = (spec(scene).name, scene.integrator.dt);
        let is_small = point.settings.iter().any(|setting| setting.key == PRECISION);
        let plan = Plan {
            part: if is_small { SMALL } else { BELOW },
            past: None,
            scene,
            start: &starts[start],
            dt,
            steps: (study.time(point) / dt).round() as u64,
        };
        plans.push(plan);
        let is_alike = |other: &Plan<'_>| {
            spec(other.scene).name == name && std::ptr::eq(other.start, plan.start)
        };
        let takes_too_long = is_costly(&plan) && (quick || scene.truncation.kind != SHOWN);
        let is_left_out = is_small || takes_too_long || quick && !stands_for_itself(name);
        if !is_left_out && !searches.iter().any(is_alike) {
            searches.push(plan);
        }
    }
    // The dearest jobs come first: a dear job at the end would keep one thread waiting.
    plans.sort_by_key(|p| {
        let evaluations = u64::from(spec(p.scene).force_evaluations);
        (evaluations != 0, Reverse(p.steps * evaluations.max(1)))
    });
    searches.sort_by_key(|p| (!is_costly(p), spec(p.scene).symplectic));

    let runs = side_by_side(&plans, run::run, |s| between(1, "fluid: drift and fluctuation", s));
    let limits =
        side_by_side(&searches, limit::find, |s| between(2, "fluid: largest stable steps", s));
    let limits = limits.into_iter().collect::<Result<Vec<_>, _>>()?;
    let mut limits: Vec<(Plan<'_>, FluidLimit)> = searches.into_iter().zip(limits).collect();
    limits.sort_by_key(|(plan, _)| place(spec(plan.scene).name));
    let mut edges = Vec::new();
    for (plan, limit) in &limits {
        let spec = spec(plan.scene);
        if plan.scene.truncation.kind == SHOWN
            && plan.scene.system.temperature == study.base.system.temperature
            && spec.symplectic
            && stands_for_itself(spec.name)
            && let Some(limit) = limit.middle()
        {
            let steps = 4 * LEAST_STEPS;
            let past = |x| Plan { part: PAST, past: Some(x), dt: x * limit, steps, ..*plan };
            edges.extend(PAST_LIMIT.map(past));
        }
    }
    let past = side_by_side(&edges, run::run, |s| between(3, "fluid: past the limits", s));
    let runs = runs.into_iter().chain(past).collect::<Result<Vec<_>, _>>();
    let mut runs: Vec<FluidRun> = runs?;
    runs.sort_by(|a, b| {
        let kind = |r: &FluidRun| (r.part, place(r.method), r.precision.name());
        let by_state = kind(a).cmp(&kind(b)).then(a.temperature.total_cmp(&b.temperature));
        by_state.then(a.truncation.cmp(b.truncation)).then(a.dt.total_cmp(&b.dt))
    });
    let limits: Vec<FluidLimit> = limits.into_iter().map(|(_, limit)| limit).collect();
    tables::add(found, &runs, &limits);
    found.word("atoms", starts[0].len().to_string());
    found.word("density", significant(starts[0].density(), 4));
    found.word("r_cut", study.base.truncation.r_cut.to_string());
    for method in ["velocity-verlet", "stormer-verlet", "leapfrog"] {
        let momentum = runs
            .iter()
            .filter(|r| r.part == BELOW && r.method == method)
            .filter_map(|r| r.momentum);
        if let Some(momentum) = momentum.reduce(f64::max) {
            found.numbers.add("momentum of the fluid", momentum).of("method", method);
        }
    }
    let of_claim = |r: &&FluidRun| {
        r.part == SMALL && r.precision == Precision::Double && r.method == "velocity-verlet"
    };
    let double: Vec<&FluidRun> = runs.iter().filter(of_claim).collect();
    let last = double.last().map(|r| (r.temperature, r.truncation));
    let alike = double.into_iter().filter(|r| Some((r.temperature, r.truncation)) == last);
    let alike: Vec<_> = alike.filter_map(|r| Some((r.dt, r.fluctuation?))).collect();
    if let [.., (coarse, a), (fine, b)] = alike[..] {
        let order = (b / a).ln() / (fine / coarse).ln();
        let number = found.numbers.add("order of the energy of the fluid", order);
        number.of("coarse", coarse).of("fine", fine);
    }
    Ok(())
}
