//! Contacts between bodies: each particle is a sphere, and two of them touch where their centres are nearer than a distance.
//!
//! Soft contacts are springs, which are forces, with dashpots, which act in flights. Hard contacts are impacts in flights.
//! Contacts of SPOOK are unilateral constraints, for which the step of SPOOK solves before it drifts.
//! [`Contacts`] is their force term. [`crate::Obstacles`] holds it beside walls, and is the boundary of flights.

pub(crate) mod bodies;
mod kinds;

use lennard_core::{
    Configuration, DMat3, DVec3, Energetics, ForceError, ForceProperties, ForceTerm, Part, System,
    Want, remembers_nothing,
};
use lennard_forcefield::ContactLaw;

pub use bodies::Bodies;
use bodies::NearPairs;
pub use kinds::{ContactOptions, ContactSpec, Response, contacts};

use crate::spook::{HeldBonds, SpookBonds};

/// The deepest overlap of bodies that give way, as a share of the contact distance: beyond, bodies would come out on the other side.
const DEEPEST: f64 = 0.5;

/// The contacts of all bodies.
///
/// Springs add F = F(δ)·n to each of two bodies that overlap by δ, and their energy and virial to the sums over pairs. A dashpot
/// acts half before a flight and half after it. Impacts happen in flights. Neither dashpots nor impacts are in the virial.
#[derive(Debug, Clone)]
pub struct Contacts {
    pub(crate) response: Response,
    pub(crate) bodies: Bodies,
    pub(crate) near: NearPairs,
    pub(crate) held: Option<HeldBonds>,
}

/// What one pair adds.
struct Touch {
    pair: [usize; 2],
    energy: f64,
    /// r_ij = r_i − r_j, σ.
    apart: DVec3,
    /// −U′/r, ε/σ².
    force: f64,
    /// ∇_i²U, ε/σ².
    laplacian: f64,
}

impl Touch {
    /// What two bodies feel where they overlap; `None` where they do not.
    fn of(
        law: &ContactLaw,
        bodies: &Bodies,
        pair: [usize; 2],
        at: &Configuration<'_>,
    ) -> Option<Self> {
        let [i, j] = pair;
        let apart = at.cell.minimum_image(at.positions[i] - at.positions[j]);
        let distance = bodies.distance(i, j);
        let r2 = apart.length_squared();
        if r2.is_nan() || r2 >= distance * distance {
            return None;
        }
        let r = r2.sqrt();
        let point = law.at(distance - r);
        let force = point.force / r;
        Some(Self {
            pair,
            energy: point.energy,
            apart,
            force,
            laplacian: point.curvature - 2.0 * force,
        })
    }
}

impl Contacts {
    /// Contacts of bodies.
    #[must_use]
    pub fn new(response: Response, bodies: Bodies) -> Self {
        Self { near: NearPairs::of(&bodies), response, bodies, held: None }
    }

    /// The same contacts, solved for together with the bonds of the molecules of a system. The method is then told of no bonds.
    #[must_use]
    pub fn with_bonds(self, bonds: SpookBonds, system: System) -> Self {
        Self { held: Some(HeldBonds { bonds, system }), ..self }
    }

    fn touches(&mut self, at: &Configuration<'_>) -> Vec<Touch> {
        let Response::Spring(law) = &self.response else {
            return Vec::new();
        };
        let pairs = self.near.at(&self.bodies, at.cell, at.positions, 0.0);
        pairs.iter().filter_map(|pair| Touch::of(law, &self.bodies, *pair, at)).collect()
    }

    /// Refuses bodies of unilateral contacts that overlap too deeply: the first pair of them.
    fn none_too_deep(&mut self, at: &Configuration<'_>) -> Result<(), ForceError> {
        let pairs = self.near.at(&self.bodies, at.cell, at.positions, 0.0);
        pairs.iter().try_for_each(|[i, j]| {
            let apart = at.cell.minimum_image(at.positions[*i] - at.positions[*j]);
            too_deep(&self.bodies, [*i, *j], apart, at)
        })
    }
}

/// Refuses an overlap beyond half the contact distance, for the vector from the second body to the first.
fn too_deep(
    bodies: &Bodies,
    [first, second]: [usize; 2],
    apart: DVec3,
    at: &Configuration<'_>,
) -> Result<(), ForceError> {
    let distance = bodies.distance(first, second);
    let (depth, deepest) = (distance - apart.length(), DEEPEST * distance);
    if depth <= deepest || depth.is_nan() {
        return Ok(());
    }
    let middle = at.positions[first] - 0.5 * apart;
    Err(ForceError::ContactTooDeep { first, second, depth, deepest, at: at.cell.wrap(middle) })
}

fn virial_of(touch: &Touch) -> DMat3 {
    let (r, f) = (touch.apart, touch.force * touch.apart);
    DMat3::from_cols(r * f.x, r * f.y, r * f.z)
}

impl ForceTerm for Contacts {
    lennard_core::evaluate_by_adding!();

    /// Contacts change quickly in space: their force belongs to the near part.
    fn add(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        _scratch: &mut Vec<DVec3>,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        if part != Part::Far && matches!(self.response, Response::Unilateral(_)) {
            self.none_too_deep(&at)?;
        }
        let touches = match part {
            Part::Far => Vec::new(),
            Part::All | Part::Near => self.touches(&at),
        };
        let mut each = want.per_particle.then(|| vec![(0.0, DMat3::ZERO); forces.len()]);
        let (mut energy, mut virial, mut laplacian) = (0.0, DMat3::ZERO, 0.0);
        for touch in &touches {
            too_deep(&self.bodies, touch.pair, touch.apart, &at)?;
            let ([i, j], force) = (touch.pair, touch.force * touch.apart);
            forces[i] += force;
            forces[j] -= force;
            energy += touch.energy;
            laplacian += 2.0 * touch.laplacian;
            if want.virial || want.per_particle {
                let own = virial_of(touch);
                virial += own;
                for slot in each.iter_mut() {
                    for body in [i, j] {
                        slot[body].0 += 0.5 * touch.energy;
                        slot[body].1 += 0.5 * own;
                    }
                }
            }
        }
        Ok(Energetics { per_particle: each, ..Energetics::of(want, energy, virial, laplacian) })
    }

    /// The sum over all other bodies: no list can hide one.
    fn force_on(&self, particle: usize, at: Configuration<'_>) -> DVec3 {
        let excluded = |j: usize| self.bodies.exclusions().exclude(particle, j);
        // In the order of the pairs, so that the sum has the same bits.
        let others = (0..at.positions.len()).filter(|j| *j != particle && !excluded(*j));
        others
            .filter_map(|j| {
                let Response::Spring(law) = &self.response else {
                    return None;
                };
                let pair = [particle.min(j), particle.max(j)];
                let touch = Touch::of(law, &self.bodies, pair, &at)?;
                let force = touch.force * touch.apart;
                Some(if particle == pair[0] { force } else { -force })
            })
            .sum()
    }

    fn properties(&self) -> ForceProperties {
        let needs_solved_contacts = matches!(self.response, Response::Unilateral(_));
        ForceProperties {
            splits: true,
            bounds_flight: self.response.acts_in_flight() && !needs_solved_contacts,
            needs_solved_contacts,
            holds_bonds: needs_solved_contacts && self.held.is_some(),
            ..ForceProperties::default()
        }
    }
}

remembers_nothing!(Contacts { response, bodies, near, held });
