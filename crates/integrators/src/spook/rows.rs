//! Contacts as rows of a problem.
//!
//! Contact c has the unit normal n from its first body to its second, the gap g, and the rate G·v = n·(v_second − v_first).

use lennard_core::{DVec3, Masses};

/// Two bodies that touch, or a body that touches something fixed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The first body; `None` where it is fixed.
    pub first: Option<usize>,
    /// The second body.
    pub second: usize,
    /// Unit vector from the first to the second.
    pub normal: DVec3,
    /// Distance between the surfaces, σ; negative where they overlap.
    pub gap: f64,
}

impl Contact {
    /// The rate of the gap, G·v, σ/τ: negative where the bodies approach.
    #[must_use]
    pub fn rate(&self, v: &[DVec3]) -> f64 {
        let first = self.first.map_or(DVec3::ZERO, |i| v[i]);
        self.normal.dot(v[self.second] - first)
    }

    /// Adds an impulse λ along the normal: apart for λ > 0.
    pub fn push(&self, impulse: f64, masses: &Masses, v: &mut [DVec3]) {
        v[self.second] += impulse / masses.of(self.second) * self.normal;
        if let Some(i) = self.first {
            v[i] -= impulse / masses.of(i) * self.normal;
        }
    }

    /// The element of G·M⁻¹·Gᵀ for two contacts.
    pub(super) fn coupling(&self, other: &Self, masses: &Masses) -> f64 {
        let ends = |c: &Self| [(Some(c.second), 1.0), (c.first, -1.0)];
        let mut sum = 0.0;
        for (body, sign) in ends(self) {
            for (same, other_sign) in ends(other) {
                if let Some(i) = body.filter(|_| body == same) {
                    sum += sign * other_sign / masses.of(i);
                }
            }
        }
        sum * self.normal.dot(other.normal)
    }
}

/// The rates of contacts, σ/τ.
#[must_use]
pub fn rates(contacts: &[Contact], v: &[DVec3]) -> Vec<f64> {
    contacts.iter().map(|c| c.rate(v)).collect()
}

/// The contacts of n balls that stand on each other and on a floor: from below, along z.
#[must_use]
pub fn column(n: usize) -> Vec<Contact> {
    (0..n)
        .map(|second| Contact { first: second.checked_sub(1), second, normal: DVec3::Z, gap: 0.0 })
        .collect()
}

/// Adds an impulse of each contact to velocities.
pub fn push_all(contacts: &[Contact], impulses: &[f64], masses: &Masses, v: &mut [DVec3]) {
    for (contact, impulse) in contacts.iter().zip(impulses) {
        contact.push(*impulse, masses, v);
    }
}

/// The kinetic energy that impulses λ of contacts put in, ε: ½·Σ λ·(G·v + G·v′).
pub(crate) fn work_of(impulses: &[f64], before: &[f64], after: &[f64]) -> f64 {
    let rates = before.iter().zip(after).map(|(before, after)| before + after);
    0.5 * impulses.iter().zip(rates).map(|(i, r)| i * r).sum::<f64>()
}
