//! Impulses of contacts: impacts with a restitution, in turn or all at once, forces of bodies at rest, and SPOOK's contacts.
//!
//! All problems are complementary: 0 ≤ λ ⊥ A·λ + b ≥ 0 with A = G·M⁻¹·Gᵀ ([`Problem`]).

use lennard_core::{DVec3, Masses};

use super::{Contact, Problem, Regularisation, Solution, Solver, TwoSided, push_all, rates};

/// Impacts in turn after which bodies are taken to rest on each other.
const MOST_IMPACTS: usize = 100_000;
/// Approach slower than this share of the fastest is rounding.
const ROUNDING: f64 = 1e-14;

/// Impacts one after the other: the contact that approaches fastest takes v → −e·v until none approaches.
pub fn impacts_in_turn(contacts: &[Contact], masses: &Masses, v: &mut [DVec3], restitution: f64) {
    let fastest = rates(contacts, v).iter().fold(0.0_f64, |m, r| m.max(r.abs()));
    for _ in 0..MOST_IMPACTS {
        let now = rates(contacts, v);
        let worst = (0..now.len()).min_by(|i, j| now[*i].total_cmp(&now[*j]));
        let Some(c) = worst.filter(|c| now[*c] < -ROUNDING * fastest) else {
            return;
        };
        let contact = &contacts[c];
        let inverse_mass = contact.coupling(contact, masses);
        contact.push(-(1.0 + restitution) * now[c] / inverse_mass, masses, v);
    }
}

/// Impacts of all contacts at once by Newton's rule: 0 ≤ λ ⊥ A·λ + (1 + e)·G·v ≥ 0. Returns the impulses, and what they took.
///
/// Hard contacts that come to rest use it with e = 0.
pub fn impacts_at_once(
    contacts: &[Contact],
    masses: &Masses,
    v: &mut [DVec3],
    restitution: f64,
) -> Solution {
    let b: Vec<f64> = contacts.iter().map(|c| (1.0 + restitution) * c.rate(v)).collect();
    let solution = exactly(contacts, masses, &b);
    push_all(contacts, &solution.impulses, masses, v);
    solution
}

fn exactly(contacts: &[Contact], masses: &Masses, b: &[f64]) -> Solution {
    let problem = Problem { contacts, masses, sigma: 0.0, b, bonds: TwoSided::default() };
    problem.solve(Solver::Exact)
}

/// The forces with which bodies at rest push each other apart: 0 ≤ f ⊥ A·f + G·a ≥ 0 for the accelerations a without contacts.
#[must_use]
pub fn resting_forces(contacts: &[Contact], masses: &Masses, accelerations: &[DVec3]) -> Vec<f64> {
    exactly(contacts, masses, &rates(contacts, accelerations)).impulses
}

/// How SPOOK regularises contacts, and the bonds that stand before them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Regular {
    /// Of contacts.
    pub contacts: Regularisation,
    /// How many of the contacts are bonds, and their regularisation; `None` without bonds.
    pub bonds: Option<(usize, Regularisation)>,
}

impl From<Regularisation> for Regular {
    fn from(contacts: Regularisation) -> Self {
        Self { contacts, bonds: None }
    }
}

/// The contacts of SPOOK in a step h. It takes velocities before the kick, and the change by the kick. It writes the velocities
/// of the next step, and returns the impulses λ. The forces are λ/h.
///
/// 0 ≤ λ ⊥ S·λ − b ≥ 0 with S = G·M⁻¹·Gᵀ + Σ and b = −(4/h)·γ·g + γ·G·v − G·(v + kick). For bonds S·λ = b.
pub fn spook_contacts(
    contacts: &[Contact],
    masses: &Masses,
    v: &mut [DVec3],
    kick: &[DVec3],
    regular: impl Into<Regular>,
    dt: f64,
    solver: Solver,
) -> Solution {
    let Regular { contacts: Regularisation { sigma, gamma }, bonds } = regular.into();
    let (n_bonds, of_bonds) = bonds.unwrap_or((0, Regularisation { sigma, gamma }));
    let before = rates(contacts, v);
    for (v, kick) in v.iter_mut().zip(kick) {
        *v += *kick;
    }
    let b: Vec<f64> = contacts
        .iter()
        .zip(&before)
        .enumerate()
        .map(|(i, (c, rate))| {
            let gamma = if i < n_bonds { of_bonds.gamma } else { gamma };
            4.0 / dt * gamma * c.gap - gamma * rate + c.rate(v)
        })
        .collect();
    let problem = Problem {
        contacts,
        masses,
        sigma,
        b: &b,
        bonds: TwoSided { contacts: n_bonds, sigma: of_bonds.sigma },
    };
    let solution = problem.solve(solver);
    push_all(contacts, &solution.impulses, masses, v);
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impacts_without_restitution_leave_one_common_velocity() {
        // Balls in a row along x that touch; the first moves.
        let touch =
            |second| Contact { first: Some(second - 1), second, normal: DVec3::X, gap: 0.0 };
        let (contacts, masses): (Vec<Contact>, _) =
            ((1..4).map(touch).collect(), Masses::Uniform(1.0));
        let mut v = [DVec3::X, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO];
        impacts_at_once(&contacts, &masses, &mut v, 0.0);
        assert!(v.iter().all(|v| (*v - 0.25 * DVec3::X).length() < 1e-12), "{v:?}");
        // What moves apart is left alone.
        v[3].x += 1.0;
        let expected = v;
        impacts_in_turn(&contacts, &masses, &mut v, 0.5);
        assert_eq!(v, expected);
    }
}
