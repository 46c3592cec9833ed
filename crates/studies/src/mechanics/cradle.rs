//! Balls that touch: rows that one ball hits, a stack at rest, and the contacts of SPOOK.

use lennard_core::{DVec3, Masses};
use lennard_integrators::spook::Regularisation;
use lennard_integrators::spook::{self, Contact, Solver};
use lennard_observables::{Cell, Table};

use super::bodies::{rig, shipped};
use crate::StudyError;
use crate::measured::Measured;

/// A row of touching balls by springs, in small steps of velocity Verlet.
fn by_springs(n: usize, law: &str) -> Result<Vec<f64>, StudyError> {
    let mut v = vec![DVec3::ZERO; n];
    v[0] = DVec3::X;
    let x: Vec<DVec3> = (0..n).map(|i| DVec3::new(i as f64, 0.0, 0.0)).collect();
    let scene = shipped("mechanics/cradle-hertz", &[("contact.law", law.to_owned())])?;
    let mut rig = rig(&scene, 100.0, (&x, &v), 2e-5)?;
    rig.steps(60_000)?;
    Ok(rig.state.velocities.iter().map(|v| v.x).collect())
}

fn row(n: usize) -> Vec<Contact> {
    (1..n)
        .map(|second| Contact { first: Some(second - 1), second, normal: DVec3::X, gap: 0.0 })
        .collect()
}

/// Rows of balls after the first hit the second, by how hits are resolved.
fn cradles(all: &mut Measured) -> Result<(), StudyError> {
    let masses = Masses::Uniform(1.0);
    let resolved = |n: usize, resolve: &dyn Fn(&[Contact], &mut [DVec3])| -> Vec<f64> {
        let mut v = vec![DVec3::ZERO; n];
        v[0] = DVec3::X;
        resolve(&row(n), &mut v);
        v.iter().map(|v| v.x).collect()
    };
    let in_turn = |c: &[Contact], v: &mut [DVec3]| spook::impacts_in_turn(c, &masses, v, 1.0);
    let at_once = |c: &[Contact], v: &mut [DVec3]| {
        spook::impacts_at_once(c, &masses, v, 1.0);
    };
    let rows: [(&str, Vec<f64>, &[f64]); 5] = [
        ("in turn, e = 1", resolved(5, &in_turn), &[0.0, 0.0, 0.0, 0.0, 1.0]),
        ("all at once, e = 1", resolved(5, &at_once), &[-0.6, 0.4, 0.4, 0.4, 0.4]),
        ("linear springs", by_springs(3, "linear")?, &[-0.1303, 0.1502, 0.9800]),
        ("Hertz, three balls", by_springs(3, "hertz")?, &[-0.0709, 0.0764, 0.9946]),
        (
            "Hertz, five balls",
            by_springs(5, "hertz")?,
            &[-0.0711, -0.0303, -0.0145, 0.1270, 0.9888],
        ),
    ];
    for (rule, velocities, known) in &rows {
        let off = velocities.iter().zip(*known).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let number = all.numbers.add("velocities of a row of balls", off);
        number.of("rule", rule).of("velocities", format!("{velocities:?}"));
    }
    let words = |values: &[f64]| {
        let words: Vec<String> = values.iter().map(|v| format!("{v:.4}")).collect();
        Cell::figures(words.join(", "))
    };
    let table = Table::rows_of("cradles", &rows)
        .caption("Equal balls in a row that touch; the first has speed 1.")
        .column("Rule", |(rule, ..)| *rule)
        .column("Velocities after", |(_, velocities, _)| words(velocities))
        .column("Known", |(.., known)| words(known));
    all.tables.push(table.table());
    Ok(())
}

/// The largest deviation of the contact forces of a stack of five balls at rest, relative.
fn stack() -> f64 {
    const G: f64 = 9.81;
    let fall = [DVec3::new(0.0, 0.0, -G); 5];
    let forces = spook::resting_forces(&spook::column(5), &Masses::Uniform(1.0), &fall);
    let off = forces.iter().zip([5.0, 4.0, 3.0, 2.0, 1.0]).map(|(f, n)| (f / (n * G) - 1.0).abs());
    off.fold(0.0, f64::max)
}

/// The largest rebound of SPOOK's contact alone over phases and the speed, at a damping in steps.
fn spook_rebound(damping: f64) -> f64 {
    let h = 0.01;
    let rebounds = (1..=100).map(|k| {
        let contact =
            [Contact { first: None, second: 0, normal: DVec3::Z, gap: -f64::from(k) / 100.0 * h }];
        let (masses, mut v) = (Masses::Uniform(1.0), [DVec3::NEG_Z]);
        let regular = Regularisation::new(0.0, damping * h, h);
        let (still, exact) = ([DVec3::ZERO], Solver::Exact);
        spook::spook_contacts(&contact, &masses, &mut v, &still, regular, h, exact);
        v[0].z
    });
    rebounds.fold(0.0, f64::max)
}

/// Measures everything.
pub(super) fn measure(all: &mut Measured) -> Result<(), StudyError> {
    cradles(all)?;
    all.numbers.add("forces of a stack", stack());
    all.numbers.add("rebound of SPOOK alone", spook_rebound(2.0)).of("damping", "2h");
    all.numbers.add("rebound of SPOOK alone", spook_rebound(0.0)).of("damping", "0");
    Ok(())
}
