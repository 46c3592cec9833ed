//! Unilateral contacts of SPOOK in a step, with the impact stage before the solve.
//!
//! The method's step is a kick and a drift. All happens between the two: bodies come with velocities after the kick, and leave
//! with the velocities of the next step, along which they drift.
//!
//! Impacts act on the velocities v + h·f/(2m) that belong to the time of the positions. In a constant field positions and these
//! velocities lie on the exact parabola. With e = 1 a body therefore keeps its energy to rounding, wherever in a step it hits.

use lennard_core::{DVec3, Flight, ForceTerm, Masses, sweeps};
use lennard_forcefield::{HitRule, Walls};
use lennard_integrators::contacts::{Contact, Problem, Solver, groups, push_all, spook_contacts};
use lennard_integrators::spook::Damping;

use crate::Bodies;
use crate::bodies::reduced_mass;
use crate::near::NearPairs;

/// Bodies that approach or part by no more than so many kicks of a step rest on each other, at the depth 0.
const KICKS_OF_REST: f64 = 2.0;
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

/// What became of a step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Stepped {
    /// Kinetic energy that impacts put in, ε; 0 or less.
    pub heat: f64,
    /// Impacts: contacts at which bodies met faster than a kick explains.
    pub impacts: u64,
}

/// Contacts of a step, those with planes last.
struct Touching {
    contacts: Vec<Contact>,
    /// The plane of each contact with one.
    planes: Vec<usize>,
    restitutions: Vec<f64>,
    /// Up to which rate bodies rest on each other, σ/τ.
    rest: Vec<f64>,
}

/// The rate up to which bodies at a depth δ ≥ 0 rest on each other, where a step of h has the kicks `kick`, σ/τ.
fn rate_of_rest(kick: f64, depth: f64, h: f64) -> f64 {
    KICKS_OF_REST * kick + (SINKING * kick / h * depth).sqrt()
}

impl Touching {
    fn of(
        law: &UnilateralLaw,
        bodies: &Bodies,
        near: &mut NearPairs,
        walls: Option<&Walls>,
        flight: &Flight<'_>,
    ) -> Self {
        let (positions, masses) = (&*flight.positions, flight.masses);
        let kick = |body: usize| flight.h * flight.forces[body].length() / masses.of(body);
        let fastest = flight.velocities.iter().map(|v| v.length_squared());
        let rounding = ROUNDING * fastest.fold(0.0, f64::max).sqrt();
        let mut found = Self {
            contacts: Vec::new(),
            planes: Vec::new(),
            restitutions: Vec::new(),
            rest: Vec::new(),
        };
        // The order of a list depends on when it was built, and no bit may.
        let mut pairs: Vec<[usize; 2]> = near
            .at(bodies, flight.cell, positions, 0.0)
            .iter()
            .map(|pair| pair.map(|body| body as usize))
            .filter(|[i, j]| reduced_mass(masses, *i, *j).is_some())
            .collect();
        pairs.sort_unstable();
        for [i, j] in pairs {
            let apart = flight.cell.minimum_image(positions[j] - positions[i]);
            let gap = apart.length() - bodies.distance(i, j);
            if gap > 0.0 || apart == DVec3::ZERO {
                continue;
            }
            found.contacts.push(Contact {
                first: Some(i),
                second: j,
                normal: apart.normalize(),
                gap,
            });
            found.restitutions.push(law.restitution);
            let rest = rate_of_rest(kick(i) + kick(j), -gap, flight.h);
            found.rest.push(rest + rounding);
        }
        for (plane, reading) in walls.iter().flat_map(|w| w.walls().iter().enumerate()) {
            let surface = walls.map(|walls| walls.surface(plane));
            let Some(surface) = surface.filter(|s| s.rule() == Some(HitRule::ByContacts)) else {
                continue;
            };
            let mut normal = DVec3::ZERO;
            normal[reading.axis] = -reading.outward();
            for body in (0..positions.len()).filter(|body| !masses.is_held(*body)) {
                let gap = -reading.outward() * (positions[body][reading.axis] - reading.position);
                if gap > 0.0 {
                    continue;
                }
                found.planes.push(plane);
                found.contacts.push(Contact {
                    first: None,
                    second: body,
                    normal,
                    gap,
                });
                found
                    .restitutions
                    .push(surface.restitution().unwrap_or(law.restitution));
                let rest = rate_of_rest(kick(body), -gap, flight.h);
                found.rest.push(rest + rounding);
            }
        }
        found
    }

    fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    fn rates(&self, v: &[DVec3]) -> Vec<f64> {
        self.contacts.iter().map(|c| c.rate(v)).collect()
    }

    /// Hands impulses of contacts to the planes among them, and counts the contacts that are hit.
    fn tell(&self, walls: Option<&mut Walls>, impulses: &[f64], is_hit: impl Fn(usize) -> bool) {
        let Some(walls) = walls else { return };
        let of_bodies = self.contacts.len() - self.planes.len();
        for (c, plane) in (of_bodies..).zip(&self.planes) {
            match is_hit(c) {
                true => walls.count_hit(*plane, impulses[c]),
                false => walls.take_momentum(*plane, impulses[c]),
            }
        }
    }

    /// The contacts of `kept`, in their order.
    fn only(&self, kept: impl Fn(usize) -> bool) -> Self {
        let of_bodies = self.contacts.len() - self.planes.len();
        let all: Vec<usize> = (0..self.contacts.len()).filter(|c| kept(*c)).collect();
        let planes = all.iter().filter(|c| **c >= of_bodies);
        Self {
            contacts: all.iter().map(|c| self.contacts[*c]).collect(),
            planes: planes.map(|c| self.planes[c - of_bodies]).collect(),
            restitutions: all.iter().map(|c| self.restitutions[*c]).collect(),
            rest: all.iter().map(|c| self.rest[*c]).collect(),
        }
    }
}

/// Takes the contacts of a step and drifts: impacts, the solve of SPOOK, and the drift.
pub(crate) fn step(
    law: &UnilateralLaw,
    bodies: &Bodies,
    near: &mut NearPairs,
    mut walls: Option<&mut Walls>,
    flight: Flight<'_>,
) -> Stepped {
    let mut touching = Touching::of(law, bodies, near, walls.as_deref(), &flight);
    let Flight {
        positions,
        velocities,
        forces,
        masses,
        h,
        ..
    } = flight;
    let mut done = Stepped::default();
    if !touching.is_empty() {
        let kick: Vec<DVec3> = (0..forces.len())
            .map(|i| h / masses.of(i) * forces[i])
            .collect();
        let mut stage = Impacts {
            touching: &mut touching,
            law,
            masses,
        };
        done = stage.act(positions, velocities, &kick, walls.as_deref_mut());
        let rates = touching.rates(&half_back(velocities, &kick));
        // Bodies that part faster than a kick explains are on their way: nothing is to push them.
        let resting = touching.only(|c| rates[c] <= touching.rest[c]);
        for (v, kick) in velocities.iter_mut().zip(&kick) {
            *v -= *kick;
        }
        let regular = law.damping.regularised(law.compliance, h);
        let contacts = &resting.contacts;
        let solved = spook_contacts(contacts, masses, velocities, &kick, regular, h, law.solver);
        resting.tell(walls, &solved.impulses, |_| false);
    }
    sweeps::drift(positions, velocities, h);
    done
}

/// The velocities that belong to the time of the positions, from those after the kick.
fn half_back(velocities: &[DVec3], kick: &[DVec3]) -> Vec<DVec3> {
    let both = velocities.iter().zip(kick);
    both.map(|(v, kick)| *v - 0.5 * *kick).collect()
}

/// The impact stage.
struct Impacts<'a> {
    touching: &'a mut Touching,
    law: &'a UnilateralLaw,
    masses: &'a Masses,
}

impl Impacts<'_> {
    /// Newton's rule for all contacts of a group at once that do not part, wherever one of them is hit: 0 ≤ λ ⊥ A·λ + b ≥ 0.
    /// Contacts that are hit have b = (1 + e)·G·v. The others do not approach faster than before: b = max(G·v, 0).
    ///
    /// Where an impact leaves no speed, bodies go back to where they touch, the shortest way in the metric of the masses.
    fn act(
        &mut self,
        positions: &mut [DVec3],
        velocities: &mut [DVec3],
        kick: &[DVec3],
        walls: Option<&mut Walls>,
    ) -> Stepped {
        let before = half_back(velocities, kick);
        // Bodies that part already carry no impact: it would put energy in.
        let rates = self.touching.rates(&before);
        let together = self.touching.only(|c| rates[c] <= self.touching.rest[c]);
        let rates = together.rates(&before);
        let mut in_motion = vec![false; rates.len()];
        for group in groups(&together.contacts, self.masses) {
            let is_hit = |c: &usize| rates[*c] < -together.rest[*c];
            if group.iter().any(is_hit) {
                group.iter().for_each(|c| in_motion[*c] = true);
            }
        }
        let struck = together.only(|c| in_motion[c]);
        if struck.is_empty() {
            return Stepped::default();
        }
        let rates = struck.rates(&before);
        let is_hit = |c: usize| rates[c] < -struck.rest[c];
        let b: Vec<f64> = (0..rates.len())
            .map(|c| match is_hit(c) {
                true => (1.0 + struck.restitutions[c]) * rates[c],
                false => rates[c].max(0.0),
            })
            .collect();
        let impulses = self.solved(&struck.contacts, &b);
        let mut after = before.clone();
        push_all(&struck.contacts, &impulses, self.masses, &mut after);
        push_all(&struck.contacts, &impulses, self.masses, velocities);
        struck.tell(walls, &impulses, is_hit);
        let kinetic = |v: &[DVec3]| -> f64 {
            let each = v.iter().enumerate();
            each.map(|(i, v)| 0.5 * self.masses.moving(i) * v.length_squared())
                .sum()
        };
        let stays = |c: usize| is_hit(c) && -struck.restitutions[c] * rates[c] <= struck.rest[c];
        let gaps: Vec<f64> = (0..rates.len())
            .map(|c| match stays(c) {
                true => struck.contacts[c].gap,
                false => 0.0,
            })
            .collect();
        if gaps.iter().any(|gap| *gap < 0.0) {
            let shifts = self.solved(&struck.contacts, &gaps);
            let mut moved = vec![DVec3::ZERO; positions.len()];
            push_all(&struck.contacts, &shifts, self.masses, &mut moved);
            for (x, moved) in positions.iter_mut().zip(&moved) {
                *x += *moved;
            }
            for contact in &mut self.touching.contacts {
                contact.gap += contact.rate(&moved);
            }
        }
        Stepped {
            heat: kinetic(&after) - kinetic(&before),
            impacts: (0..rates.len()).filter(|c| is_hit(*c)).count() as u64,
        }
    }

    fn solved(&self, contacts: &[Contact], b: &[f64]) -> Vec<f64> {
        let problem = Problem {
            contacts,
            masses: self.masses,
            sigma: 0.0,
            b,
        };
        problem.solve(self.law.solver).impulses
    }
}
