//! Impulses of contacts: impacts with a restitution, in turn or all at once, forces of bodies at rest, and SPOOK's contacts.
//!
//! All problems are complementary: 0 ≤ λ ⊥ A·λ + b ≥ 0 with A = G·M⁻¹·Gᵀ ([`Problem`]).

use lennard_core::{DVec3, Masses};

use super::problem::{Problem, Solution, Solver, TwoSided};
use super::regularisation::Regularisation;
use super::rows::{Contact, push_all, rates};

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
    use crate::spook::column;

    /// Balls in a row along x that touch; the first moves with speed 1.
    fn cradle(n: usize) -> (Vec<Contact>, Masses, Vec<DVec3>) {
        let contacts = (1..n)
            .map(|second| Contact { first: Some(second - 1), second, normal: DVec3::X, gap: 0.0 })
            .collect();
        let mut v = vec![DVec3::ZERO; n];
        v[0] = DVec3::X;
        (contacts, Masses::Uniform(1.0), v)
    }

    fn close(v: &[DVec3], wanted: impl Fn(usize) -> f64) -> bool {
        v.iter().enumerate().all(|(i, v)| (*v - DVec3::new(wanted(i), 0.0, 0.0)).length() < 1e-12)
    }

    #[test]
    fn impacts_in_turn_are_the_cradle_and_newtons_rule_at_once_is_not() {
        for n in [2, 3, 5, 9] {
            let (contacts, masses, mut v) = cradle(n);
            impacts_in_turn(&contacts, &masses, &mut v, 1.0);
            assert!(close(&v, |i| f64::from(u8::from(i == n - 1))), "{v:?}");
            let (contacts, masses, mut v) = cradle(n);
            impacts_at_once(&contacts, &masses, &mut v, 1.0);
            let share = 2.0 / n as f64;
            assert!(close(&v, |i| if i == 0 { share - 1.0 } else { share }), "{v:?}");
            let energy: f64 = v.iter().map(|v| v.length_squared()).sum();
            assert!((energy - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn impacts_without_restitution_leave_one_common_velocity() {
        let (contacts, masses, mut v) = cradle(4);
        impacts_at_once(&contacts, &masses, &mut v, 0.0);
        assert!(close(&v, |_| 0.25), "{v:?}");
        // What moves apart is left alone.
        v[3].x += 1.0;
        let expected = v.clone();
        impacts_in_turn(&contacts, &masses, &mut v, 0.5);
        assert_eq!(v, expected);
    }

    /// The contacts of balls of diameter 1 at these heights over a floor at z = 0.
    fn stack(z: &[f64]) -> Vec<Contact> {
        let mut contacts = column(z.len());
        for (i, contact) in contacts.iter_mut().enumerate() {
            contact.gap = match i {
                0 => z[0] - 0.5,
                _ => z[i] - z[i - 1] - 1.0,
            };
        }
        contacts
    }

    #[test]
    fn a_stack_at_rest_carries_its_weight_and_sinks_by_compliance_times_force() {
        const G: f64 = 9.81;
        let masses = Masses::Uniform(1.0);
        let n = 5;
        let mut z: Vec<f64> = (0..n).map(|i| 0.5 + i as f64).collect();
        let forces = resting_forces(&stack(&z), &masses, &vec![DVec3::new(0.0, 0.0, -G); n]);
        for (i, f) in forces.iter().enumerate() {
            assert!((f / (G * (n - i) as f64) - 1.0).abs() < 1e-12, "{i}: {f}");
        }
        let (h, compliance) = (0.005, 1e-5);
        let mut v = vec![DVec3::ZERO; n];
        let kick = vec![DVec3::new(0.0, 0.0, -G * h); n];
        let mut impulses = Vec::new();
        for _ in 0..4000 {
            let touching: Vec<Contact> = stack(&z).into_iter().filter(|c| c.gap <= 0.0).collect();
            let regular = Regularisation::new(compliance, 2.0 * h, h);
            let exact = Solver::Exact;
            impulses =
                spook_contacts(&touching, &masses, &mut v, &kick, regular, h, exact).impulses;
            for (z, v) in z.iter_mut().zip(&v) {
                *z += h * v.z;
            }
        }
        assert_eq!(impulses.len(), n);
        for (i, contact) in stack(&z).iter().enumerate() {
            let force = G * (n - i) as f64;
            assert!((impulses[i] / h / force - 1.0).abs() < 1e-9, "{impulses:?}");
            assert!((-contact.gap / (compliance * force) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn spook_alone_bounces_by_the_phase_and_the_impact_stage_sets_the_restitution() {
        let masses = Masses::Uniform(1.0);
        let h = 0.01;
        let at =
            |phase: f64| [Contact { first: None, second: 0, normal: DVec3::Z, gap: -phase * h }];
        for (damping, gamma) in [(0.0, 1.0), (2.0, 1.0 / 9.0)] {
            for phase in [0.3, 0.6, 1.0] {
                let mut v = [DVec3::NEG_Z];
                spook_contacts(
                    &at(phase),
                    &masses,
                    &mut v,
                    &[DVec3::ZERO],
                    Regularisation::new(0.0, damping * h, h),
                    h,
                    Solver::Exact,
                );
                assert!((v[0].z - gamma * (4.0 * phase - 1.0)).abs() < 1e-12, "{v:?}");
                let mut v = [DVec3::NEG_Z];
                impacts_at_once(&at(phase), &masses, &mut v, 0.4);
                assert!((v[0].z - 0.4).abs() < 1e-14);
            }
        }
    }
}
