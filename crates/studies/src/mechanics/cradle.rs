//! Balls that touch: rows that one ball hits, a stack at rest, and the contacts of SPOOK.

use lennard_core::{DVec3, Masses};
use lennard_forcefield::{ContactLaw, SpringLaw};
use lennard_integrators::spook::Regularisation;
use lennard_integrators::spook::{self, Contact, Solver};
use serde::Serialize;

use super::bodies::{Bodies, BodyForces};
use crate::StudyError;

/// A row of balls after the first hit the second.
#[derive(Debug, Clone, Serialize)]
pub struct Cradle {
    /// How the hits are resolved.
    pub rule: &'static str,
    /// Velocities after the hit; before it the first ball has velocity 1.
    pub velocities: Vec<f64>,
    /// What is known.
    pub known: Vec<f64>,
}

/// A row of touching balls by springs, in small steps of velocity Verlet.
fn by_springs(n: usize, law: SpringLaw) -> Result<Vec<f64>, StudyError> {
    let mut v = vec![DVec3::ZERO; n];
    v[0] = DVec3::X;
    let contact = Some(ContactLaw::new(law, 1e4, 1.0));
    let bodies = Bodies {
        bond_length: 1.0,
        x: (0..n).map(|i| DVec3::new(i as f64, 0.0, 0.0)).collect(),
        v,
        forces: BodyForces { sites: 1, contact, ..BodyForces::default() },
    };
    let mut rig = bodies.start_free(2e-5)?;
    rig.steps(60_000)?;
    Ok(rig.state.velocities.iter().map(|v| v.x).collect())
}

fn row(n: usize) -> Vec<Contact> {
    (1..n)
        .map(|second| Contact { first: Some(second - 1), second, normal: DVec3::X, gap: 0.0 })
        .collect()
}

pub(crate) fn cradles() -> Result<Vec<Cradle>, StudyError> {
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
    Ok(vec![
        Cradle {
            rule: "in turn, e = 1",
            velocities: resolved(5, &in_turn),
            known: vec![0.0, 0.0, 0.0, 0.0, 1.0],
        },
        Cradle {
            rule: "all at once, e = 1",
            velocities: resolved(5, &at_once),
            known: vec![-0.6, 0.4, 0.4, 0.4, 0.4],
        },
        Cradle {
            rule: "linear springs",
            velocities: by_springs(3, SpringLaw::Linear)?,
            known: vec![-0.1303, 0.1502, 0.9800],
        },
        Cradle {
            rule: "Hertz, three balls",
            velocities: by_springs(3, SpringLaw::Hertz)?,
            known: vec![-0.0709, 0.0764, 0.9946],
        },
        Cradle {
            rule: "Hertz, five balls",
            velocities: by_springs(5, SpringLaw::Hertz)?,
            known: vec![-0.0711, -0.0303, -0.0145, 0.1270, 0.9888],
        },
    ])
}

/// The largest deviation of the contact forces of a stack of five balls at rest, relative.
pub(crate) fn stack() -> f64 {
    const G: f64 = 9.81;
    let fall = [DVec3::new(0.0, 0.0, -G); 5];
    let forces = spook::resting_forces(&spook::column(5), &Masses::Uniform(1.0), &fall);
    let off = forces.iter().zip([5.0, 4.0, 3.0, 2.0, 1.0]).map(|(f, n)| (f / (n * G) - 1.0).abs());
    off.fold(0.0, f64::max)
}

/// The rebounds of SPOOK's contact alone over phases, at a damping in steps.
pub(crate) fn spook_rebound(damping: f64) -> impl Iterator<Item = f64> {
    let h = 0.01;
    (1..=100).map(move |k| {
        let contact =
            [Contact { first: None, second: 0, normal: DVec3::Z, gap: -f64::from(k) / 100.0 * h }];
        let (masses, mut v) = (Masses::Uniform(1.0), [DVec3::NEG_Z]);
        let regular = Regularisation::new(0.0, damping * h, h);
        let (still, exact) = ([DVec3::ZERO], Solver::Exact);
        spook::spook_contacts(&contact, &masses, &mut v, &still, regular, h, exact);
        v[0].z
    })
}
