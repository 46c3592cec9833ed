//! A4: a step that changes, under the plain, the time-corrected and the more exact rule.

use lennard_integrators::stormer_verlet::StepRule;
use lennard_observables::Table;

use super::fit::ErrorLine;
use super::groups::entry;
use super::oscillator::Spring;
use crate::StudyError;
use crate::claims::Measured;

/// Steps of one length before the other length takes over.
const BLOCK: u32 = 4;
/// Short step over long step.
const RATIO: f64 = 0.5;
/// End of the runs, τ, at ω = 1 τ⁻¹: a whole number of blocks for every long step below.
const END: f64 = 12.0;
/// Long steps of the order measurement, τ.
const LONG_STEPS: u32 = 7;
/// Long step of the figure, τ.
const SHOWN_STEP: f64 = 0.125;
/// Start (x, v): neither at rest nor at zero.
const START: (f64, f64) = (1.0, 0.3);

/// The step of each step: blocks of the long one and of the short one by turns.
fn schedule(long: f64) -> Vec<f64> {
    let blocks = (END / (f64::from(BLOCK) * long * (1.0 + RATIO))).round() as u32;
    (0..blocks)
        .flat_map(|_| {
            let block = |h: f64| std::iter::repeat_n(h, BLOCK as usize);
            block(long).chain(block(RATIO * long))
        })
        .collect()
}

fn exact(t: f64) -> f64 {
    START.0 * t.cos() + START.1 * t.sin()
}

/// The plain rule by its own recurrence, since the method that has it refuses a changing step.
fn plain_path(steps: &[f64]) -> Vec<(f64, f64)> {
    let (x, v) = START;
    let h = steps[0];
    let (mut now, mut before, mut last, mut t) = (x, x - h * v - 0.5 * h * h * x, h, 0.0);
    let mut path = vec![(0.0, x)];
    for h in steps {
        let (inertia, push) = StepRule::Plain.factors(*h, last);
        (now, before) = (now + inertia * (now - before) - push * now, now);
        last = *h;
        t += h;
        path.push((t, now));
    }
    path
}

fn path(method: &'static str, steps: &[f64]) -> Result<Vec<(f64, f64)>, StudyError> {
    let spring = Spring::Stiffness(1.0);
    let mut rig = spring.start(entry(method)?, START, steps[0])?;
    let mut path = vec![(0.0, START.0)];
    for h in steps {
        rig.dt = *h;
        let z = rig.next_point()?;
        path.push((rig.state.time, z.x));
    }
    Ok(path)
}

/// Runs every rule; the plain one is refused by `stormer-verlet`, as it must be. The errors against the long step come back.
pub(super) fn measure(found: &mut Measured) -> Result<Vec<ErrorLine>, StudyError> {
    let at = |i: u32| END * f64::from(i) / 240.0;
    let mut shown: Vec<_> = (0..=240).map(|i| ("analytic", at(i), exact(at(i)))).collect();
    let mut lines = Vec::new();
    for (rule, method) in [
        ("plain rule", None),
        ("time-corrected", Some("stormer-verlet-time-corrected")),
        ("more exact", Some("stormer-verlet-variable")),
        ("velocity Verlet", Some("velocity-verlet")),
    ] {
        let path = |long: f64| {
            let steps = schedule(long);
            method.map_or_else(|| Ok(plain_path(&steps)), |m| path(m, &steps))
        };
        let error = |i: u32| {
            let long = 0.25 * 0.5_f64.powi(i as i32);
            let errors = path(long)?.into_iter().map(|(t, x)| (x - exact(t)).abs());
            Ok((long, errors.fold(0.0, f64::max)))
        };
        let errors = (0..LONG_STEPS).map(error).collect::<Result<_, StudyError>>()?;
        let line = ErrorLine { kind: "changing step", name: rule.into(), theory: None, errors };
        found.numbers.add("order with a changing step", line.order()).of("rule", rule);
        lines.push(line);
        shown.extend(path(SHOWN_STEP)?.into_iter().map(|(t, x)| (rule, t, x)));
    }
    let table = Table::rows_of("variable-step", &shown)
        .column("rule", |p| p.0)
        .column("time [τ]", |p| p.1)
        .column("x [σ]", |p| p.2);
    found.curves.push(table.table());
    found.numbers.add("refused changes of the step", refused_changes()?);
    Ok(lines)
}

/// The share of changes of its step that SPOOK refuses, after one step of another length.
fn refused_changes() -> Result<f64, StudyError> {
    let changes = [0.5, 1.001, 2.0];
    let mut refused = 0.0;
    for change in changes {
        let mut rig = Spring::Stiffness(1.0).start(entry("spook")?, START, SHOWN_STEP)?;
        rig.step()?;
        rig.dt = change * SHOWN_STEP;
        refused += f64::from(u8::from(rig.try_step().is_err()));
    }
    Ok(refused / changes.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schedules_end_where_they_should() {
        for i in 0..LONG_STEPS {
            let total: f64 = schedule(0.25 * 0.5_f64.powi(i as i32)).iter().sum();
            assert_eq!(total, END);
        }
    }

    #[test]
    fn only_the_corrected_rules_converge() {
        let lines = measure(&mut Measured::default()).unwrap();
        let order = |i: usize| lines[i].order();
        assert!(order(0).abs() < 0.05, "the plain rule has order {}", order(0));
        assert!((order(1) - 1.0).abs() < 0.05, "time-corrected: {}", order(1));
        assert!((order(2) - 2.0).abs() < 0.05, "more exact: {}", order(2));
        assert!((order(3) - 2.0).abs() < 0.05, "velocity Verlet: {}", order(3));
    }
}
