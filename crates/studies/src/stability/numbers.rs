//! The measured numbers that judge the claims about integrators, by the keys of `claims.csv`.

use super::amplification::mean_growth;
use super::displacement::STEP;
use super::fluid::FluidStudy;
use super::groups::entry;
use super::orders::OrderLine;
use super::study::OscillatorStudy;
use crate::StudyError;
use crate::claims::Numbers;

/// A number that a diverged run does not have.
fn or_infinity(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::INFINITY)
}

/// The numbers of the oscillator.
pub(super) fn on_the_oscillator(study: &OscillatorStudy) -> Result<Numbers, StudyError> {
    let mut all = Numbers::default();
    orders(study, &mut all);
    let growth = &study.growth[study.growth.len() / 2];
    for (key, measured) in [
        ("growth of the error from q₊", growth.exact_start_coefficient),
        ("growth of the error from the Taylor start", growth.taylor_start_coefficient),
        ("offset of the Taylor start", growth.taylor_start_offset),
    ] {
        all.add(key, measured).of("wh", growth.wh).theory(1.0 / 24.0);
    }
    all.add("refused changes of the step", study.refused_changes);
    stiffnesses(study, &mut all)?;
    one_eigenvector(study, &mut all);
    limits(study, &mut all);
    Ok(all)
}

fn orders(study: &OscillatorStudy, all: &mut Numbers) {
    let o = &study.orders;
    let mut add = |name: &str, line: &OrderLine| {
        let order = line.measured.unwrap_or(f64::NAN);
        all.add("order", order).of("name", name).theory(line.theory);
    };
    let lines = o.starts.iter().chain(&o.velocity_estimates).chain(&o.local).chain([&o.energy]);
    lines.for_each(|line| add(&line.name, line));
    for (of, lines) in [("x", &o.positions), ("v", &o.velocities)] {
        lines.iter().for_each(|line| add(&format!("{of} under `{}`", line.name), line));
    }
    for run in &study.step_rules {
        let order = run.order.unwrap_or(f64::NAN);
        all.add("order with a changing step", order).of("rule", run.rule);
    }
    let difference = o.velocity_verlet_against_stormer;
    all.add("difference of velocity Verlet from Störmer–Verlet", difference);
    for (n, errors) in &o.accumulation {
        let sum = f64::from(n * (n + 1) / 2);
        all.add("added local errors", *errors).of("n", n).theory(sum);
    }
    all.add("drift of the energy", o.energy_drift_share);
}

/// The numbers at each finite stiffness.
fn stiffnesses(study: &OscillatorStudy, all: &mut Numbers) -> Result<(), StudyError> {
    for case in &study.cases {
        for s in &case.summaries {
            let mut add = |key, measured, theory: Option<f64>| {
                let number = all.add(key, measured).theory(theory);
                number.of("case", case.name).of("title", case.title).of("method", s.method);
                // The amplitude of SPOOK just outside the limit of symplectic Euler, where (ωh)² = 4 + h².
                number.of("swing", (2.0 + 0.25 * STEP * STEP).sqrt());
            };
            add("period", s.measured_period_ratio.unwrap_or(f64::NAN), s.theory_period_ratio);
            add("growth of halves", or_infinity(s.growth_of_halves), None);
            add("amplitude", or_infinity(s.measured_amplitude), s.theory_amplitude);
            // Elsewhere a run that grows leaves the range of numbers within these steps.
            if case.name == "k-100" {
                let growth = mean_growth(entry(s.method)?, case.omega_h)?;
                add("growth per step", growth, Some(s.theory_radius));
            }
        }
    }
    Ok(())
}

/// The numbers where a one-step map has one eigenvector: at the limit of symplectic Euler, and of SPOOK at k = ∞.
fn one_eigenvector(study: &OscillatorStudy, all: &mut Numbers) {
    let at_infinity = &study.infinite;
    let n = f64::from(at_infinity.steps);
    let mut add = |at: &str, growth: f64| {
        let theory = (2.0 * n + 1.0) / (n + 1.0);
        all.add("growth with one eigenvector", growth).of("at", at).theory(theory);
    };
    add("k = 4m/h²", at_infinity.at_limit.growth_of_halves);
    let (undamped, damped): (Vec<_>, Vec<_>) =
        at_infinity.rigid.iter().partition(|run| run.damping_steps == 0.0);
    undamped.iter().for_each(|run| add("k = ∞", run.growth_of_halves));
    for run in damped {
        let number = all.add("radius at k = ∞", run.measured_radius);
        number.of("tau", run.damping_steps).theory(run.theory_radius);
    }
}

/// The stability limit of each method beside the limit that it declares.
fn limits(study: &OscillatorStudy, all: &mut Numbers) {
    for m in &study.methods {
        let measured = match (m.declared_limit, m.bounded_at_1000) {
            (None, Some(false)) => 1000.0,
            _ => or_infinity(m.measured_limit),
        };
        let declared = m.declared_limit.map_or("none".to_owned(), |limit| limit.to_string());
        let number = all.add("stability limit", measured).of("method", m.method);
        number.of("declared", declared).theory(m.theory_limit.unwrap_or(f64::NAN));
    }
}

/// Adds the numbers of the fluid, a conservative system of many particles.
pub(super) fn on_the_fluid(study: &FluidStudy, all: &mut Numbers) {
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
