//! A3: the discretisation error of Störmer–Verlet on ẍ = w²x, whose solution e^{wt} is known.

use lennard_observables::Table;
use lennard_observables::statistics::Line;

use super::groups::entry;
use super::oscillator::Spring;
use crate::StudyError;
use crate::claims::Measured;

/// The steps, as wh.
const STEPS: [f64; 4] = [0.2, 0.1, 0.05, 0.025];
/// The end of the runs, as wt.
const END: f64 = 8.0;
/// wt from which the line is fitted to the Taylor start's error: before it, the decaying root e^{−2wt}
/// of the start is still there.
const FIT_FROM: f64 = 4.0;

/// Runs both starts at every step, with w = 1: from x_1 = q₊ the error is ln(x_n/e^{wt}) = −c·(wh)²·wt with c = 1/24. The
/// Taylor start has the same slope over wt and an offset near −(wh)²/16.
pub(super) fn measure(found: &mut Measured) -> Result<(), StudyError> {
    let (mut coefficients, mut errors) = (Vec::new(), Vec::new());
    for z in STEPS {
        // The method starts from x(−h) = x − h·v + ½h²·a: this velocity makes it 1/q₊, and so x(h) = q₊.
        let exact_velocity = (1.0 + 0.5 * z * z - growing_root(z).recip()) / z;
        let exact = logarithms(z, exact_velocity)?;
        let taylor = logarithms(z, 1.0)?;
        let last = exact[exact.len() - 1];
        let late: Vec<(f64, f64)> = taylor.iter().copied().filter(|p| p.0 >= FIT_FROM).collect();
        let line = Line::through(&late);
        let square = z * z;
        coefficients.push((
            z,
            -last.1 / (square * last.0),
            -line.slope() / square,
            line.intercept() / square,
        ));
        let both = exact.iter().zip(taylor);
        errors.extend(both.map(|(e, t)| (z, e.0, e.1.exp_m1().abs(), t.1.exp_m1().abs())));
    }
    let judged = coefficients[STEPS.len() / 2];
    for (key, measured) in [
        ("growth of the error from q₊", judged.1),
        ("growth of the error from the Taylor start", judged.2),
        ("offset of the Taylor start", judged.3),
    ] {
        found.numbers.add(key, measured).of("wh", judged.0).theory(1.0 / 24.0);
    }
    let coefficients = Table::rows_of("exponential-growth", &coefficients)
        .column("wh", |c| c.0)
        .column("coefficient from the growing root", |c| c.1)
        .column("coefficient from the Taylor start", |c| c.2)
        .column("offset of the Taylor start", |c| c.3);
    found.tables.push(coefficients.table());
    let errors = Table::rows_of("exponential-error", &errors)
        .column("wh", |e| e.0)
        .column("wt", |e| e.1)
        .column("relative error from the growing root", |e| e.2)
        .column("relative error from the Taylor start", |e| e.3)
        .column("from q₊", |e| e.2 / (e.0 * e.0))
        .column("from the Taylor start", |e| e.3 / (e.0 * e.0))
        .column("wt/24", |e| e.1 / 24.0)
        .column("wt/24 + 1/16", |e| e.1 / 24.0 + 1.0 / 16.0);
    found.curves.push(errors.table());
    Ok(())
}

/// q₊ = 1 + ½z² + z·√(1 + ¼z²), the growing root of the recurrence.
fn growing_root(z: f64) -> f64 {
    1.0 + 0.5 * z * z + z * (1.0 + 0.25 * z * z).sqrt()
}

/// (wt, ln x_n − wt) at each step from x = 1.
fn logarithms(z: f64, velocity: f64) -> Result<Vec<(f64, f64)>, StudyError> {
    let (method, steps) = (entry("stormer-verlet")?, (END / z).round() as u32);
    let path = Spring::Stiffness(-1.0).path(method, (1.0, velocity), z, steps)?;
    let times = (1..=steps).map(|n| f64::from(n) * z);
    Ok(times.zip(&path[1..]).map(|(t, at)| (t, at.x.ln() - t)).collect())
}
