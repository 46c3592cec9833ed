//! The fluid part of the study: the largest step at which each method stays stable in a Lennard-Jones liquid. Below
//! it, drift and fluctuation of the energy are measured.

pub mod limit;
pub mod run;
pub mod start;
mod study;
mod tables;

use lennard_forcefield::Precision;
use lennard_integrators::{IntegratorEntry, OscillatorModel, integrators};

use crate::claims::Numbers;
use crate::jobs::side_by_side;
use crate::stability::groups::{entry, stands_for_itself};
use crate::{Progress, StudyError};
use limit::FluidLimit;
use run::{FluidRun, Plan};
use start::{FluidStart, STATES, TRUNCATIONS};
use study::{SHOWN_TRUNCATION, limit_at};

pub use study::FluidStudy;
pub(crate) use tables::{csv, give};

/// Steps of the drift and fluctuation runs, τ.
const STEPS: [f64; 8] = [0.001, 0.002, 0.004, 0.006, 0.008, 0.012, 0.016, 0.024];
/// Steps of the same runs in the quick study, τ.
const QUICK_STEPS: [f64; 3] = [0.002, 0.004, 0.016];
/// Steps of implicit Euler, each of which costs a nonlinear solve.
const IMPLICIT_STEPS: [f64; 4] = [0.002, 0.004, 0.008, 0.016];
/// Length of the runs, τ.
const TIME: f64 = 3.0;
/// Length of implicit Euler's runs, τ.
const IMPLICIT_TIME: f64 = 0.5;
/// Steps of the runs in double and mixed precision, τ.
const SMALL_STEPS: [f64; 6] = [1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3];
/// Length of these runs, τ.
const SMALL_STEP_TIME: f64 = 0.4;
/// Steps past the limit, as multiples of it.
const PAST_LIMIT: [f64; 4] = [1.05, 1.2, 1.5, 2.0];

/// A method of the study.
struct Method {
    entry: &'static IntegratorEntry,
    costly: bool,
}

fn methods() -> (Vec<Method>, Vec<(&'static str, String)>) {
    let mut left_out = Vec::new();
    let mut methods = Vec::new();
    for entry in integrators() {
        match entry.oscillator {
            OscillatorModel::ExactSolution => {
                left_out
                    .push((entry.spec.name, "no exact solution of a fluid is known".to_owned()));
            }
            OscillatorModel::Constraint => {
                let reason = "without constraints it is `symplectic-euler`, which is here";
                left_out.push((entry.spec.name, reason.to_owned()));
            }
            OscillatorModel::Force => methods.push(Method {
                entry,
                // A method that does not declare how many evaluations a step takes iterates.
                costly: entry.spec.force_evaluations == 0,
            }),
        }
    }
    (methods, left_out)
}

/// Share of each part in the time of the fluid study.
const SHARES: [f64; 4] = [0.06, 0.5, 0.94, 1.0];

/// Runs the fluid part; `progress` hears shares of it.
pub(crate) fn measure(quick: bool, progress: &mut dyn Progress) -> Result<FluidStudy, StudyError> {
    let (methods, left_out) = methods();
    let states = if quick { 1 } else { STATES.len() };
    let truncations: Vec<usize> =
        if quick { vec![SHOWN_TRUNCATION] } else { (0..TRUNCATIONS.len()).collect() };
    let places: Vec<(usize, usize)> =
        (0..states).flat_map(|s| truncations.iter().map(move |t| (s, *t))).collect();
    let starts = side_by_side(
        &places,
        |(s, t)| FluidStart::equilibrate(*s, *t, quick),
        |share| progress.update("fluid: equilibration", SHARES[0] * share),
    );
    let starts: Vec<FluidStart> = starts.into_iter().collect::<Result<_, _>>()?;

    let mut between = |part: usize, label: &str, share: f64| {
        progress.update(label, SHARES[part - 1] + (SHARES[part] - SHARES[part - 1]) * share);
    };
    let plans = plans(&methods, &starts, quick);
    let runs = side_by_side(&plans, run::run, |s| between(1, "fluid: drift and fluctuation", s));
    let mut runs: Vec<FluidRun> = runs.into_iter().collect::<Result<_, _>>()?;
    let listed = |name: &str| integrators().iter().position(|e| e.spec.name == name);
    let state = |name: &str| STATES.iter().position(|s| s.name == name);
    runs.sort_by(|a, b| {
        let place = |r: &FluidRun| (listed(r.method), state(r.state), r.truncation);
        place(a).cmp(&place(b)).then(a.dt.total_cmp(&b.dt))
    });

    let mut searches: Vec<(&Method, &FluidStart)> = starts
        .iter()
        .flat_map(|start| methods.iter().map(move |m| (m, start)))
        .filter(|(m, start)| !m.costly || start.truncation == SHOWN_TRUNCATION)
        .filter(|(m, _)| !quick || !m.costly && stands_for_itself(m.entry.spec.name))
        .collect();
    // The dearest jobs come first: a dear job at the end would keep one thread waiting.
    searches.sort_by_key(|(m, _)| (!m.costly, m.entry.spec.symplectic));
    let limits = side_by_side(
        &searches,
        |(m, start)| limit::find(m.entry, start),
        |s| between(2, "fluid: largest stable steps", s),
    );
    let mut limits: Vec<FluidLimit> = limits.into_iter().collect::<Result<_, _>>()?;
    limits.sort_by_key(|l| listed(l.method));

    let (double, mixed, past_limit) =
        edges(&methods, &starts, &limits, quick, |s| between(3, "fluid: floors and edges", s))?;
    Ok(FluidStudy { left_out, runs, limits, double, mixed, past_limit })
}

fn plans<'a>(methods: &[Method], starts: &'a [FluidStart], quick: bool) -> Vec<Plan<'a>> {
    let time = if quick { 0.25 * TIME } else { TIME };
    let steps: &[f64] = if quick { &QUICK_STEPS } else { &STEPS };
    let mut plans = Vec::new();
    for start in starts {
        for method in methods {
            let (steps, time) = match (method.costly, quick) {
                (true, true) => (&IMPLICIT_STEPS[1..2], 0.1 * IMPLICIT_TIME),
                (true, false) => (&IMPLICIT_STEPS[..], IMPLICIT_TIME),
                (false, _) => (steps, time),
            };
            plans.extend(steps.iter().map(|dt| Plan {
                entry: method.entry,
                start,
                dt: *dt,
                steps: (time / dt).round() as u64,
                precision: Precision::Double,
            }));
        }
    }
    // The dearest jobs come first: a dear job at the end would keep one thread waiting.
    plans.sort_by_key(|p| {
        std::cmp::Reverse(p.steps * u64::from(p.entry.spec.force_evaluations.max(1)))
    });
    plans.sort_by_key(|p| p.entry.spec.force_evaluations != 0);
    plans
}

type Edges = (Vec<FluidRun>, Vec<FluidRun>, Vec<(f64, FluidRun)>);

/// The floors of double and mixed precision, and what happens past the limit.
fn edges(
    methods: &[Method],
    starts: &[FluidStart],
    limits: &[FluidLimit],
    quick: bool,
    done: impl FnMut(f64),
) -> Result<Edges, StudyError> {
    let verlet = entry("velocity-verlet")?;
    let smooth =
        starts.iter().find(|s| s.state_point == 0 && s.truncation == TRUNCATIONS.len() - 1);
    let shown = starts.iter().find(|s| s.state_point == 0 && s.truncation == SHOWN_TRUNCATION);
    let mut plans: Vec<(Option<f64>, Plan<'_>)> = Vec::new();
    if let Some(start) = smooth.or(shown) {
        let time = if quick { 0.5 * SMALL_STEP_TIME } else { SMALL_STEP_TIME };
        for precision in [Precision::Double, Precision::Mixed] {
            plans.extend(SMALL_STEPS.iter().map(|dt| {
                let plan = Plan {
                    entry: verlet,
                    start,
                    dt: *dt,
                    steps: (time / dt).round() as u64,
                    precision,
                };
                (None, plan)
            }));
        }
    }
    if let Some(start) = shown {
        for method in methods
            .iter()
            .filter(|m| m.entry.spec.symplectic && stands_for_itself(m.entry.spec.name))
        {
            let limit = limit_at(limits, method.entry.spec.name, 0, SHOWN_TRUNCATION);
            let Some(limit) = limit.and_then(FluidLimit::middle) else {
                continue;
            };
            plans.extend(PAST_LIMIT.iter().map(|factor| {
                let plan = Plan {
                    entry: method.entry,
                    start,
                    dt: factor * limit,
                    steps: limit::LEAST_STEPS * 4,
                    precision: Precision::Double,
                };
                (Some(*factor), plan)
            }));
        }
    }
    let found = side_by_side(&plans, |(_, plan)| run::run(plan), done);
    let (mut double, mut mixed, mut past) = (Vec::new(), Vec::new(), Vec::new());
    for ((factor, plan), run) in plans.iter().zip(found) {
        match (factor, plan.precision) {
            (Some(factor), _) => past.push((*factor, run?)),
            (None, Precision::Double) => double.push(run?),
            (None, Precision::Mixed) => mixed.push(run?),
        }
    }
    Ok((double, mixed, past))
}

/// Adds the numbers that judge claims: the fluid is a conservative system of many particles.
pub(super) fn numbers(study: &FluidStudy, all: &mut Numbers) {
    for name in ["velocity-verlet", "stormer-verlet", "leapfrog"] {
        let runs = study.runs.iter().filter(|r| r.method == name && r.completed());
        let momentum = runs.filter_map(|r| r.momentum).fold(f64::NAN, f64::max);
        all.add("momentum of the fluid", momentum).of("method", name);
    }
    let last = study.double.len().saturating_sub(2);
    if let [coarse, fine] = &study.double[last..]
        && let (Some(a), Some(b)) = (coarse.fluctuation, fine.fluctuation)
    {
        let order = (b / a).ln() / (fine.dt / coarse.dt).ln();
        let number = all.add("order of the energy of the fluid", order);
        number.of("coarse", coarse.dt).of("fine", fine.dt);
    }
}
