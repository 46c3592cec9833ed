//! Unilateral contacts of SPOOK in a step, with the impact stage before the solve.
//!
//! The method's step is a kick and a drift. All happens between the two: bodies come with velocities after the kick, and leave
//! with the velocities of the next step, along which they drift.
//!
//! Impacts act on the velocities v + h·f/(2m) that belong to the time of the positions. In a constant field positions and these
//! velocities lie on the exact parabola. With e = 1 a body therefore keeps its energy to rounding, wherever in a step it hits.
//!
//! The bonds of molecules are rows of the same problems, without a sign: an impulse at one site passes through them. In the impact
//! stage they are rigid, and lose the rate that they have.

use lennard_core::{DVec3, Drifted, Flight, ForceTerm, StepError, System};
use lennard_forcefield::{HitRule, Walls};

use super::bonds::SpookBonds;
use super::impulses::{Regular, spook_contacts};
use super::{Contact, Damping, Problem, Solver, TwoSided, groups, push_all, rates, work_of};
use crate::contacts::bodies::{Bodies, NearPairs, reduced_mass};

/// Bodies that approach or part by no more than so many kicks of a step rest on each other, at the depth 0.
const KICKS_OF_CONTACT: f64 = 2.0;
/// At a depth δ a body that sinks in from rest under the acceleration a has v² ≤ 2a·δ: twice as much still counts as rest.
const SINKING: f64 = 4.0;
/// Approach slower than this share of the fastest speed is rounding.
const ROUNDING: f64 = 1e-13;

/// Unilateral contacts with a restitution, a compliance and a damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnilateralLaw {
    /// Restitution e of impacts between bodies; walls have their own.
    pub restitution: f64,
    /// Compliance ε, σ²/ε.
    pub compliance: f64,
    /// The damping.
    pub damping: Damping,
    /// How each step is solved.
    pub solver: Solver,
}

/// The bonds of molecules that contacts are solved for with.
#[derive(Debug, Clone)]
pub(crate) struct HeldBonds {
    pub bonds: SpookBonds,
    /// The molecules.
    pub system: System,
}

/// How a contact is solved for.
#[derive(Clone, Copy)]
struct Rule {
    /// The plane that a body touches; `None` where two bodies touch.
    plane: Option<usize>,
    restitution: f64,
    /// Up to which rate bodies rest on each other, σ/τ.
    rest: f64,
}

/// Contacts of a step, after the bonds of molecules.
#[derive(Default)]
struct Touching {
    contacts: Vec<Contact>,
    /// How many of the first are bonds.
    bonds: usize,
    /// How each contact is solved for.
    rules: Vec<Rule>,
}

/// The rate up to which bodies at a depth δ ≥ 0 rest on each other, where a step of h has the kicks `kick`, σ/τ.
fn rate_of_rest(kick: f64, depth: f64, h: f64) -> f64 {
    KICKS_OF_CONTACT * kick + (SINKING * kick / h * depth).sqrt()
}

impl Touching {
    fn of(
        law: &UnilateralLaw,
        (bodies, held): (&Bodies, Option<&HeldBonds>),
        near: &mut NearPairs,
        walls: Option<&Walls>,
        flight: &Flight<'_>,
    ) -> Self {
        let (positions, masses) = (&*flight.positions, flight.masses);
        let kick = |body: usize| flight.h * flight.forces[body].length() / masses.of(body);
        let fastest = flight.velocities.iter().map(|v| v.length_squared());
        let rounding = ROUNDING * fastest.fold(0.0, f64::max).sqrt();
        let rest = |kick: f64, gap: f64| rate_of_rest(kick, -gap, flight.h) + rounding;
        let mut found = Self::default();
        if let Some(held) = held {
            found.take_bonds(held, positions);
        }
        for [i, j] in near.at(bodies, flight.cell, positions, 0.0).iter().copied() {
            if reduced_mass(masses, i, j).is_none() {
                continue;
            }
            let apart = flight.cell.minimum_image(positions[j] - positions[i]);
            let gap = apart.length() - bodies.distance(i, j);
            if gap > 0.0 || apart == DVec3::ZERO {
                continue;
            }
            let contact = Contact { first: Some(i), second: j, normal: apart.normalize(), gap };
            let rest = rest(kick(i) + kick(j), gap);
            found.push(contact, Rule { plane: None, restitution: law.restitution, rest });
        }
        let Some(walls) = walls else {
            return found;
        };
        for (plane, reading) in walls.walls().iter().enumerate() {
            let surface = walls.surface(plane);
            if surface.rule() != Some(HitRule::ByContacts) {
                continue;
            }
            let restitution = surface.restitution().unwrap_or(law.restitution);
            for body in (0..positions.len()).filter(|body| !masses.is_held(*body)) {
                let gap = reading.distance(positions[body]);
                if gap > 0.0 {
                    continue;
                }
                let contact = Contact { first: None, second: body, normal: -reading.normal(), gap };
                let rest = rest(kick(body), gap);
                found.push(contact, Rule { plane: Some(plane), restitution, rest });
            }
        }
        found
    }

    /// Begins with the bonds: whatever their rate, they are not hit.
    fn take_bonds(&mut self, held: &HeldBonds, positions: &[DVec3]) {
        SpookBonds::rows(&held.system, positions, &mut self.contacts);
        self.bonds = self.contacts.len();
        let rule = Rule { plane: None, restitution: 0.0, rest: f64::INFINITY };
        self.rules = vec![rule; self.bonds];
    }

    fn push(&mut self, contact: Contact, rule: Rule) {
        self.contacts.push(contact);
        self.rules.push(rule);
    }

    fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    fn rates(&self, v: &[DVec3]) -> Vec<f64> {
        rates(&self.contacts, v)
    }

    /// Hands impulses of contacts to the planes among them, and counts the contacts that are hit.
    fn tell(&self, walls: Option<&mut Walls>, impulses: &[f64], is_hit: impl Fn(usize) -> bool) {
        let Some(walls) = walls else { return };
        for (c, rule) in self.rules.iter().enumerate() {
            match rule.plane {
                Some(plane) if is_hit(c) => walls.count_hit(plane, impulses[c]),
                Some(plane) => walls.take_momentum(plane, impulses[c]),
                None => {}
            }
        }
    }

    /// The contacts of `kept`, in their order.
    fn only(&self, kept: impl Fn(usize) -> bool) -> Self {
        let mut some = Self::default();
        for c in (0..self.contacts.len()).filter(|c| kept(*c)) {
            some.push(self.contacts[c], self.rules[c]);
            some.bonds += usize::from(c < self.bonds);
        }
        some
    }

    /// The bonds as they are in the impact stage.
    fn rigid_bonds(&self) -> TwoSided {
        TwoSided { contacts: self.bonds, sigma: 0.0 }
    }
}

/// Takes the contacts of a step and drifts: impacts, the solve of SPOOK, and the drift.
///
/// # Errors
/// [`StepError::ContactsNotConverged`] where a solve ends far from a solution.
pub(crate) fn step(
    law: &UnilateralLaw,
    (bodies, held): (&Bodies, Option<&HeldBonds>),
    near: &mut NearPairs,
    mut walls: Option<&mut Walls>,
    mut flight: Flight<'_>,
) -> Result<Drifted, StepError> {
    let mut touching = Touching::of(law, (bodies, held), near, walls.as_deref(), &flight);
    let mut done = Drifted::default();
    if !touching.is_empty() {
        let (forces, masses, h) = (flight.forces, flight.masses, flight.h);
        let kick: Vec<DVec3> = (0..forces.len()).map(|i| h / masses.of(i) * forces[i]).collect();
        done = impact(law, &mut touching, &mut flight, &kick, walls.as_deref_mut())?;
        let velocities = &mut *flight.velocities;
        let rates = touching.rates(&half_back(velocities, &kick));
        // Bodies that part faster than a kick explains are on their way: nothing is to push them.
        let resting = touching.only(|c| rates[c] <= touching.rules[c].rest);
        for (v, kick) in velocities.iter_mut().zip(&kick) {
            *v -= *kick;
        }
        let regular = Regular {
            contacts: law.damping.regularised(law.compliance, h),
            bonds: held.map(|held| (resting.bonds, held.bonds.regularised(h))),
        };
        let contacts = &resting.contacts;
        let solved = spook_contacts(contacts, masses, velocities, &kick, regular, h, law.solver);
        let solved = solved.settled(law.solver)?;
        done = done.and(solved.report());
        resting.tell(walls, &solved.impulses, |_| false);
    }
    flight.free();
    Ok(done)
}

/// The velocities that belong to the time of the positions, from those after the kick.
fn half_back(velocities: &[DVec3], kick: &[DVec3]) -> Vec<DVec3> {
    let both = velocities.iter().zip(kick);
    both.map(|(v, kick)| *v - 0.5 * *kick).collect()
}

/// The impact stage: Newton's rule for all contacts of a group at once that do not part, wherever one of them is hit,
/// 0 ≤ λ ⊥ A·λ + b ≥ 0. Contacts that are hit have b = (1 + e)·G·v. The others do not approach faster than before: b = max(G·v, 0).
///
/// Where an impact leaves no speed, bodies go back to where they touch, the shortest way in the metric of the masses.
fn impact(
    law: &UnilateralLaw,
    touching: &mut Touching,
    flight: &mut Flight<'_>,
    kick: &[DVec3],
    walls: Option<&mut Walls>,
) -> Result<Drifted, StepError> {
    let masses = flight.masses;
    let solved = |struck: &Touching, b: &[f64]| {
        let problem = Problem {
            contacts: &struck.contacts,
            masses,
            sigma: 0.0,
            b,
            bonds: struck.rigid_bonds(),
        };
        problem.solve(law.solver).settled(law.solver)
    };
    let before = half_back(flight.velocities, kick);
    // Bodies that part already carry no impact: it would put energy in.
    let rates = touching.rates(&before);
    let together = touching.only(|c| rates[c] <= touching.rules[c].rest);
    let rates = together.rates(&before);
    let mut in_motion = vec![false; rates.len()];
    for group in groups(&together.contacts, masses) {
        let is_hit = |c: &usize| rates[*c] < -together.rules[*c].rest;
        if group.iter().any(is_hit) {
            group.iter().for_each(|c| in_motion[*c] = true);
        }
    }
    let struck = together.only(|c| in_motion[c]);
    if struck.is_empty() {
        return Ok(Drifted::default());
    }
    let rates = struck.rates(&before);
    let is_hit = |c: usize| rates[c] < -struck.rules[c].rest;
    let b: Vec<f64> = (0..rates.len())
        .map(|c| match is_hit(c) {
            true => (1.0 + struck.rules[c].restitution) * rates[c],
            false if c < struck.bonds => rates[c],
            false => rates[c].max(0.0),
        })
        .collect();
    let solution = solved(&struck, &b)?;
    let impulses = &solution.impulses;
    let mut after = before;
    push_all(&struck.contacts, impulses, masses, &mut after);
    push_all(&struck.contacts, impulses, masses, flight.velocities);
    struck.tell(walls, impulses, is_hit);
    let mut drifted = solution.report();
    drifted.heat = work_of(impulses, &rates, &struck.rates(&after));
    let stays =
        |c: usize| is_hit(c) && -struck.rules[c].restitution * rates[c] <= struck.rules[c].rest;
    let gaps: Vec<f64> = (0..rates.len())
        .map(|c| match stays(c) {
            true => struck.contacts[c].gap,
            false => 0.0,
        })
        .collect();
    if gaps.iter().any(|gap| *gap < 0.0) {
        let shifts = solved(&struck, &gaps)?;
        drifted = drifted.and(shifts.report());
        let mut moved = vec![DVec3::ZERO; flight.positions.len()];
        push_all(&struck.contacts, &shifts.impulses, masses, &mut moved);
        for (x, moved) in flight.positions.iter_mut().zip(&moved) {
            *x += *moved;
        }
        for contact in &mut touching.contacts {
            contact.gap += contact.rate(&moved);
        }
    }
    Ok(drifted)
}
