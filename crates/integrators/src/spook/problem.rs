//! Complementarity problems over contacts: 0 ≤ λ ⊥ (A + σ)·λ + b ≥ 0 with A = G·M⁻¹·Gᵀ.
//!
//! Contacts that share a body that moves form a group, and no group knows of another. A small group is solved directly, by
//! exchanging contacts that push for contacts that do not, until none has the wrong sign. A large one is solved by projected
//! Gauss–Seidel, and so is one whose matrix is singular, where contacts follow from others.
//!
//! Contact c has the unit normal n from its first body to its second, the gap g, and the rate G·v = n·(v_second − v_first).

use lennard_core::options::OptionError;
use lennard_core::{DVec3, Drifted, Masses, StepError};

/// What compliance and damping become for a step h: Σ = (4/h²)·ε/(1 + 4τ/h) and γ = 1/(1 + 4τ/h).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Regularisation {
    /// Σ, in units of an inverse mass.
    pub sigma: f64,
    /// γ, between 0 and 1.
    pub gamma: f64,
}

/// The damping of constraints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// A time τ.
    Time(f64),
    /// A number of time steps.
    Steps(f64),
}

impl Damping {
    /// A damping time where one is given, else a number of steps.
    #[must_use]
    pub fn new(steps: f64, time: Option<f64>) -> Self {
        match time {
            Some(time) => Self::Time(time),
            None => Self::Steps(steps),
        }
    }

    /// The regularisation of a compliance ε with this damping for a step h.
    #[must_use]
    pub fn regularised(self, compliance: f64, dt: f64) -> Regularisation {
        let time = match self {
            Self::Time(time) => time,
            Self::Steps(steps) => steps * dt,
        };
        Regularisation::new(compliance, time, dt)
    }

    /// Whether nothing is damped.
    #[must_use]
    pub fn is_none(self) -> bool {
        let (Self::Time(damping) | Self::Steps(damping)) = self;
        damping == 0.0
    }

    /// Refuses no compliance without damping: the one-step map of a rigid constraint is then a Jordan block, and |x_n| grows as 2n + 1.
    ///
    /// # Errors
    /// [`OptionError`] that names the compliance.
    pub fn suits(self, compliance: f64) -> Result<(), OptionError> {
        if compliance == 0.0 && self.is_none() {
            return Err(OptionError {
                key: "compliance",
                found: "0 without damping, which is unstable: errors grow with each step"
                    .to_owned(),
                allowed: "damping_steps of at least 0.5, or a compliance above 0".to_owned(),
            });
        }
        Ok(())
    }
}

impl Regularisation {
    /// For compliance ε, damping time τ and step h.
    #[must_use]
    pub fn new(compliance: f64, damping_time: f64, dt: f64) -> Self {
        let gamma = 1.0 / (1.0 + 4.0 * damping_time / dt);
        Self { sigma: 4.0 / (dt * dt) * compliance * gamma, gamma }
    }
}

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

/// The bodies of some contacts, ascending.
fn bodies_of(contacts: &[Contact], group: &[usize]) -> Vec<usize> {
    let of = |c: &usize| [contacts[*c].first, Some(contacts[*c].second)];
    let mut bodies: Vec<usize> = group.iter().flat_map(of).flatten().collect();
    bodies.sort_unstable();
    bodies.dedup();
    bodies
}

/// The groups of contacts that share bodies that move, each in the order of its contacts, in the order of their first contacts.
#[must_use]
pub fn groups(contacts: &[Contact], masses: &Masses) -> Vec<Vec<usize>> {
    let all: Vec<usize> = (0..contacts.len()).collect();
    let bodies = bodies_of(contacts, &all);
    let place = |body: usize| bodies.binary_search(&body).unwrap_or_default();
    let mut parents: Vec<usize> = (0..bodies.len()).collect();
    let root = |parents: &mut [usize], mut of: usize| {
        while parents[of] != of {
            parents[of] = parents[parents[of]];
            of = parents[of];
        }
        of
    };
    let moving = |body: Option<usize>| body.filter(|body| !masses.is_held(*body));
    for contact in contacts {
        if let (Some(i), Some(j)) = (moving(contact.first), moving(Some(contact.second))) {
            let (a, b) = (root(&mut parents, place(i)), root(&mut parents, place(j)));
            parents[a.max(b)] = a.min(b);
        }
    }
    let mut of_root: Vec<Option<usize>> = vec![None; bodies.len()];
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (c, contact) in contacts.iter().enumerate() {
        let body = moving(Some(contact.second)).or(moving(contact.first));
        // Two held bodies have nothing to solve for.
        let Some(body) = body else { continue };
        let root = root(&mut parents, place(body));
        let group = *of_root[root].get_or_insert_with(|| {
            groups.push(Vec::new());
            groups.len() - 1
        });
        groups[group].push(c);
    }
    groups
}

/// Contacts of a group up to which a direct solve costs less than sweeps.
const MOST_DIRECT: usize = 32;
/// Sweeps after which a solution is taken as it is.
const MOST_SWEEPS: u32 = 20_000;
/// Changes smaller than this share of the largest rate are rounding. In a group of n contacts impulses grow up to n times as large, and
/// their rounding with them.
const SETTLED: f64 = 4.0 * f64::EPSILON;
/// Sweeps in which changes of that rounding do not fall, after which they will not.
const STALLED: u32 = 1000;
/// A solution that a sweep still changes by more than this share of the largest rate is none.
const UNSOLVED: f64 = 1e-6;
/// A pivot below this share of its diagonal element is none.
const SINGULAR: f64 = 1e-12;
/// Exchanges of all contacts of the wrong sign that may fail to lower their number, before one is exchanged at a time.
const TRIES: u32 = 2;

/// How a problem is solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Solver {
    /// To rounding: directly where a group is small, else by sweeps until nothing changes.
    Exact,
    /// By so many sweeps of projected Gauss–Seidel, from λ = 0.
    Sweeps(u32),
}

/// A solution, and what it took.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Solution {
    /// λ of each contact.
    pub impulses: Vec<f64>,
    /// The most sweeps that a group needed; 0 where all were solved directly.
    pub sweeps: u32,
    /// The largest change of the last sweep over the largest |b|: 0 where all were solved directly.
    pub residual: f64,
    /// Contacts of the group with this residual.
    contacts: usize,
}

impl Solution {
    /// The solution, where it is one: so many sweeps as were asked for always are.
    ///
    /// # Errors
    /// [`StepError::ContactsNotConverged`] where a solution to rounding was asked for, and sweeps ended far from it.
    pub fn settled(self, solver: Solver) -> Result<Self, StepError> {
        match solver {
            Solver::Exact if self.residual > UNSOLVED => Err(StepError::ContactsNotConverged {
                contacts: self.contacts,
                iterations: self.sweeps,
                residual: self.residual,
                wanted: UNSOLVED,
            }),
            Solver::Exact | Solver::Sweeps(_) => Ok(self),
        }
    }

    /// What the solution took, as the report of a drift says it.
    #[must_use]
    pub fn report(&self) -> Drifted {
        Drifted { iterations: self.sweeps, residual: self.residual, heat: 0.0 }
    }
}

/// The first contacts of a problem, which pull as well as push: bonds. Their rows are equations, (A·λ + σ·λ + b)_c = 0.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TwoSided {
    /// How many they are.
    pub contacts: usize,
    /// Their σ, in units of an inverse mass.
    pub sigma: f64,
}

/// The problem of contacts with a regularisation σ on the diagonal and a right side b.
#[derive(Debug, Clone, Copy)]
pub struct Problem<'a> {
    /// The contacts.
    pub contacts: &'a [Contact],
    /// The masses of the bodies.
    pub masses: &'a Masses,
    /// σ, in units of an inverse mass.
    pub sigma: f64,
    /// b, one number per contact.
    pub b: &'a [f64],
    /// The bonds among the contacts.
    pub bonds: TwoSided,
}

impl Problem<'_> {
    /// The solution λ.
    #[must_use]
    pub fn solve(&self, solver: Solver) -> Solution {
        let mut solution =
            Solution { impulses: vec![0.0; self.contacts.len()], ..Solution::default() };
        for group in groups(self.contacts, self.masses) {
            let direct = match solver {
                Solver::Exact if group.len() <= MOST_DIRECT => self.exchange(&group),
                Solver::Exact | Solver::Sweeps(_) => None,
            };
            if let Some(found) = direct {
                for (c, found) in group.iter().zip(found) {
                    solution.impulses[*c] = found;
                }
            } else {
                self.sweep(&group, solver, &mut solution);
            }
        }
        solution
    }

    /// Whether a contact pulls as well as it pushes.
    fn pulls(&self, contact: usize) -> bool {
        contact < self.bonds.contacts
    }

    /// σ of a contact.
    fn sigma_of(&self, contact: usize) -> f64 {
        match self.pulls(contact) {
            true => self.bonds.sigma,
            false => self.sigma,
        }
    }

    /// Projected Gauss–Seidel over one group: λ_c ← max(0, λ_c − (A·λ + σ·λ + b)_c/(A_cc + σ)).
    fn sweep(&self, group: &[usize], solver: Solver, solution: &mut Solution) {
        let most = match solver {
            Solver::Exact => MOST_SWEEPS,
            Solver::Sweeps(sweeps) => sweeps,
        };
        let bodies = bodies_of(self.contacts, group);
        let place = |body: usize| bodies.binary_search(&body).unwrap_or_default();
        let ends: Vec<(Option<usize>, usize)> = group
            .iter()
            .map(|c| &self.contacts[*c])
            .map(|c| (c.first.map(place), place(c.second)))
            .collect();
        let diagonal: Vec<f64> = group
            .iter()
            .map(|c| {
                let contact = &self.contacts[*c];
                contact.coupling(contact, self.masses) + self.sigma_of(*c)
            })
            .collect();
        // M⁻¹·Gᵀ·λ of each body.
        let mut moved = vec![DVec3::ZERO; bodies.len()];
        let scale = self.scale(group);
        let (mut largest, mut done) = (0.0_f64, 0);
        let rounding = SETTLED * scale;
        let (mut least, mut since) = (f64::INFINITY, 0);
        for _ in 0..most {
            largest = 0.0;
            for (k, c) in group.iter().enumerate() {
                let contact = &self.contacts[*c];
                let (first, second) = ends[k];
                let from = first.map_or(DVec3::ZERO, |i| moved[i]);
                let now = solution.impulses[*c];
                let sigma = self.sigma_of(*c);
                let rate = contact.normal.dot(moved[second] - from) + sigma * now + self.b[*c];
                let free = now - rate / diagonal[k];
                let next = if self.pulls(*c) { free } else { free.max(0.0) };
                let change = next - now;
                if change == 0.0 {
                    continue;
                }
                largest = largest.max(change.abs() * diagonal[k]);
                solution.impulses[*c] = next;
                moved[second] += change / self.masses.of(contact.second) * contact.normal;
                if let (Some(i), Some(body)) = (first, contact.first) {
                    moved[i] -= change / self.masses.of(body) * contact.normal;
                }
            }
            done += 1;
            if largest < least {
                (least, since) = (largest, 0);
            }
            since += 1;
            // Changes that fall no more are the rounding of impulses that are larger than rates.
            let is_stalled = since > STALLED && largest <= group.len() as f64 * rounding;
            if largest <= rounding || is_stalled {
                break;
            }
        }
        solution.sweeps = solution.sweeps.max(done);
        if scale > 0.0 && largest / scale > solution.residual {
            (solution.residual, solution.contacts) = (largest / scale, group.len());
        }
    }

    /// The largest |b| of a group.
    fn scale(&self, group: &[usize]) -> f64 {
        group.iter().fold(0.0, |m, c| m.max(self.b[*c].abs()))
    }

    /// The direct solution of one group; `None` where its matrix is singular.
    ///
    /// Contacts that push solve A·λ = −b, as bonds do, and the others have λ = 0. All contacts of the wrong sign change sides at once, while
    /// their number falls. Then the last of them changes alone, which ends for every positive definite matrix (K. G. Murty, Linear Algebra
    /// Appl. 7, 65 (1974)).
    fn exchange(&self, group: &[usize]) -> Option<Vec<f64>> {
        let n = group.len();
        let matrix: Vec<f64> = (0..n * n)
            .map(|k| {
                let (i, j) = (k / n, k % n);
                let own = if i == j { self.sigma_of(group[i]) } else { 0.0 };
                self.contacts[group[i]].coupling(&self.contacts[group[j]], self.masses) + own
            })
            .collect();
        let b: Vec<f64> = group.iter().map(|c| self.b[*c]).collect();
        let rounding = SETTLED * n as f64 * self.scale(group);
        let pulls: Vec<bool> = group.iter().map(|c| self.pulls(*c)).collect();
        let mut pushes: Vec<bool> = (0..n).map(|i| pulls[i] || b[i] < 0.0).collect();
        let (mut fewest, mut tries) = (n + 1, TRIES);
        // In theory Murty's rule may take 2ⁿ exchanges; in practice it takes few.
        for _ in 0..100 + 20 * n {
            let active: Vec<usize> = (0..n).filter(|i| pushes[*i]).collect();
            let found = solve_active(&matrix, n, &b, &active)?;
            let has_wrong_sign = |i: &usize| match pushes[*i] {
                true => !pulls[*i] && found[*i] * matrix[*i * n + *i] < -rounding,
                false => {
                    let row = &matrix[*i * n..(*i + 1) * n];
                    let rate: f64 = row.iter().zip(&found).map(|(a, x)| a * x).sum();
                    rate + b[*i] < -rounding
                }
            };
            let wrong: Vec<usize> = (0..n).filter(has_wrong_sign).collect();
            let Some(last) = wrong.last() else {
                let found = found.iter().zip(&pulls);
                return Some(found.map(|(x, p)| if *p { *x } else { x.max(0.0) }).collect());
            };
            let at_once = match wrong.len() < fewest {
                true => {
                    (fewest, tries) = (wrong.len(), TRIES);
                    true
                }
                false if tries > 0 => {
                    tries -= 1;
                    true
                }
                false => false,
            };
            let change: &[usize] = if at_once { &wrong } else { &[*last] };
            change.iter().for_each(|i| pushes[*i] = !pushes[*i]);
        }
        None
    }
}

/// λ with A·λ = −b on the active rows and 0 on the others, by Cholesky's factors; `None` where the matrix is singular.
fn solve_active(matrix: &[f64], n: usize, b: &[f64], active: &[usize]) -> Option<Vec<f64>> {
    let m = active.len();
    let mut factor = vec![0.0; m * m];
    let mut x: Vec<f64> = active.iter().map(|i| -b[*i]).collect();
    for row in 0..m {
        for column in 0..=row {
            let mut sum = matrix[active[row] * n + active[column]];
            let whole = sum;
            for k in 0..column {
                sum -= factor[row * m + k] * factor[column * m + k];
            }
            factor[row * m + column] = match row == column {
                true if sum <= SINGULAR * whole || sum.is_nan() => return None,
                true => sum.sqrt(),
                false => sum / factor[column * m + column],
            };
        }
        for k in 0..row {
            x[row] -= factor[row * m + k] * x[k];
        }
        x[row] /= factor[row * m + row];
    }
    for row in (0..m).rev() {
        for k in row + 1..m {
            x[row] -= factor[k * m + row] * x[k];
        }
        x[row] /= factor[row * m + row];
    }
    let mut found = vec![0.0; n];
    for (i, x) in active.iter().zip(x) {
        found[*i] = x;
    }
    Some(found)
}

#[cfg(test)]
mod tests;
