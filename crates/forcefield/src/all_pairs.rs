//! The force on one particle by all pairs: what the forces of a run are checked by, without a list and without a kernel.

use glam::DVec3;
use lennard_core::{Exclusions, Own, PeriodicBox, SpeciesTable};
use lennard_neighbor::FIXED_UNITS;

use crate::error::ForceFieldError;
use crate::options::{ForceFieldOptions, Precision, SplitOptions};
use crate::pair::{Laws, Mixture, Model, Pair};
use crate::plan::interaction;

/// Rounding of sums and of pair formulas in double precision, as a share of Σ|F_ij|.
const DOUBLE: f64 = 1e-12;
/// Last places of the coordinates by which distances in double precision may differ.
const PLACES: f64 = 4.0;
/// Rounding of a pair's force in single precision, as a share of it: 6e-8 times a factor of 13 of r⁻¹³.
const SINGLE: f64 = 2e-6;
/// How far off a particle may lie from the point that single-precision coordinates are seen from, besides r_cut, σ.
const FROM_AFAR: f64 = 3.0;
/// By how much pairs are sought beyond what counts, as a share of r_cut: far more than any rounding.
const SOUGHT_BEYOND: f64 = 1e-6;

/// The force on a particle, and by how much the force of a kernel may differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckedForce {
    /// F_i = Σ_j F_ij over every j with r_ij ≤ r_cut, ε/σ.
    pub force: DVec3,
    /// The largest |F − F_i| that rounding explains, ε/σ.
    pub tolerance: f64,
}

/// Sums the force on a particle over all others by the reference potential, in double precision, with minimum images.
///
/// The tolerance is a bound on rounding. The rounding of pair forces and their sum is a share of Σ_j |F_ij|. The
/// rounding of distances is δ·Σ_j (|U″| + |U′|/r), where δ is a few units in the last place of the coordinates. In
/// double precision it is near 1e-12·Σ|F_ij|, in mixed precision some 1e-5·Σ|F_ij|. A pair nearer to r_cut than δ may
/// count or not, so its |F_ij| adds to the tolerance.
///
/// One missed pair thus shows where its force is larger than the tolerance. At a plain or shifted cutoff at 2.5 σ this
/// holds for every pair, since its force is at least 0.039 ε/σ. In mixed precision a pair at a cutoff above some 3.5 σ may
/// hide. Where the force vanishes at the cutoff, a pair very near to the cutoff hides. The distance is some 1e-8 σ
/// (force-shift) or 1e-5 σ (switch) in double precision, and some 0.03 σ in mixed precision.
#[derive(Debug, Clone)]
pub struct AllPairs {
    model: Model,
    laws: Option<Laws>,
    precision: Precision,
    split: Option<SplitOptions>,
    exclusions: Exclusions,
    /// How far the force of a pair by rows may be off, as a share of it or of ε/σ.
    rows: f64,
}

/// A particle as others see it.
struct Body {
    number: usize,
    species: usize,
    position: DVec3,
}

impl Body {
    fn words(&self) -> [u64; 5] {
        let [x, y, z] = self.position.to_array().map(f64::to_bits);
        [self.number as u64, self.species as u64, x, y, z]
    }

    fn of([number, species, x, y, z]: [u64; 5]) -> Self {
        let position = DVec3::from_array([x, y, z].map(f64::from_bits));
        Self { number: number as usize, species: species as usize, position }
    }
}

impl AllPairs {
    /// For the forces that the options describe, and the species of the particles where there are several.
    ///
    /// # Errors
    /// [`ForceFieldError`] where potential and truncation do not go together or are out of range.
    pub fn new(o: &ForceFieldOptions, mixture: Option<&Mixture>) -> Result<Self, ForceFieldError> {
        let (model, laws) = interaction(o, mixture)?;
        let tolerance = model.form.formula.tolerance();
        Ok(Self {
            rows: match model.form.compiled(laws.is_none()) {
                Some(_) => 0.0,
                None => tolerance.force,
            },
            model,
            laws,
            precision: o.kernel.precision,
            split: o.split,
            exclusions: o.exclusions,
        })
    }

    /// The force on `particle` at unwrapped `positions`, σ, in a box; O(N).
    ///
    /// # Panics
    /// Where there is no such particle: that is a bug of the caller.
    #[must_use]
    pub fn force_on(
        &self,
        particle: usize,
        cell: &PeriodicBox,
        positions: &[DVec3],
    ) -> CheckedForce {
        let of_particles = self.laws.as_ref().map(|laws| laws.mixture.of_particle());
        let one = |(number, position)| Body {
            number,
            species: of_particles.map_or(0, |of| usize::from(of[number])),
            position,
        };
        let body = one((particle, positions[particle]));
        let near = within(self.reach(cell), body.position, cell, positions);
        self.force_of(&body, near.map(one), cell)
    }

    /// [`AllPairs::force_on`] the particle with a number, where each rank keeps some particles: all ranks call it, and find the
    /// same. The species are of the particles that this rank keeps.
    #[must_use]
    pub fn force_over(
        &self,
        own: &Own,
        species: &SpeciesTable,
        particle: usize,
        cell: &PeriodicBox,
        positions: &[DVec3],
    ) -> CheckedForce {
        let one =
            |(i, position)| Body { number: own.first() + i, species: species.of(i), position };
        let Some(team) = own.team() else {
            let body = one((particle, positions[particle]));
            let near = within(self.reach(cell), body.position, cell, positions);
            return self.force_of(&body, near.map(one), cell);
        };
        let body = own.index(particle).map(|i| one((i, positions[i])).words());
        let body = Body::of(own.told(body).expect("a rank keeps the particle"));
        let near = within(self.reach(cell), body.position, cell, positions);
        let here: Vec<u64> = near.flat_map(|found| one(found).words()).collect();
        let all = team.concat(&here);
        let (all, _) = all.as_chunks();
        self.force_of(&body, all.iter().map(|words| Body::of(*words)), cell)
    }

    /// How far other particles are looked for, σ.
    fn reach(&self, cell: &PeriodicBox) -> f64 {
        (1.0 + SOUGHT_BEYOND) * self.model.r_cut + self.rounding(cell).1
    }

    /// The force on a particle by others, whose numbers ascend.
    fn force_of(
        &self,
        body: &Body,
        others: impl Iterator<Item = Body>,
        cell: &PeriodicBox,
    ) -> CheckedForce {
        let (relative, seen) = self.rounding(cell);
        let mut force = DVec3::ZERO;
        let (mut size, mut shaken, mut off_by_rows) = (0.0, 0.0, 0.0);
        for other in others {
            if other.number == body.number || self.exclusions.exclude(other.number, body.number) {
                continue;
            }
            let r_ij = cell.minimum_image(body.position - other.position);
            let r2 = r_ij.length_squared();
            let r = r2.sqrt();
            let (pair, r_cut, unit) = self.between([body.species, other.species], r2);
            let strength = (pair.force * r).abs();
            let off = seen + places(body.position, other.position, cell);
            if r2 <= r_cut * r_cut {
                force += pair.force * r_ij;
                size += strength;
                off_by_rows += self.rows * strength.max(unit);
                let of_split = self.split.map_or(0.0, |s| 4.0 * strength / s.width);
                shaken += off * (pair.curvature.abs() + pair.force.abs() + of_split);
            }
            if (r - r_cut).abs() <= off {
                shaken += strength;
            }
        }
        // A whole force in two parts is rounded twice.
        let parts = if self.split.is_some() { 2.0 } else { 1.0 };
        CheckedForce {
            force,
            tolerance: (parts * (relative * size + shaken) + off_by_rows).max(f64::MIN_POSITIVE),
        }
    }

    /// The values of two species at r² = `r2` σ², their cutoff, σ, and their ε/σ.
    fn between(&self, [a, b]: [usize; 2], r2: f64) -> (Pair<f64>, f64, f64) {
        match &self.laws {
            None => (self.model.eval(r2), self.model.r_cut, 1.0),
            Some(laws) => {
                let law = &laws.of_pairs[a][b];
                (law.eval(r2), law.r_cut, law.epsilon / law.sigma2.sqrt())
            }
        }
    }

    /// Rounding of pair forces, as a share of them, and of distances by what the kernel's coordinates are, σ.
    fn rounding(&self, cell: &PeriodicBox) -> (f64, f64) {
        match self.precision {
            Precision::Double => (DOUBLE, 0.0),
            Precision::Mixed => {
                let units = 4.0 * cell.lengths().max_element() / FIXED_UNITS;
                let seen = f64::from(f32::EPSILON) * (FROM_AFAR + self.model.r_cut);
                (SINGLE, 2.0 * seen + units)
            }
        }
    }
}

/// Last places of the coordinates of a pair and of the box, σ.
fn places(a: DVec3, b: DVec3, cell: &PeriodicBox) -> f64 {
    let size = a.abs().max_element() + b.abs().max_element();
    PLACES * f64::EPSILON * (size + cell.lengths().max_element())
}

/// The particles within `reach` σ of `own`, and perhaps some a few last places beyond.
fn within(
    reach: f64,
    own: DVec3,
    cell: &PeriodicBox,
    positions: &[DVec3],
) -> impl Iterator<Item = (usize, DVec3)> {
    let lengths = cell.lengths();
    let per_side = lengths.recip();
    positions
        .iter()
        .enumerate()
        .filter(move |(_, other)| {
            let d = own - **other;
            (d - lengths * nearest_integer(d * per_side)).length_squared() <= reach * reach
        })
        .map(|(j, other)| (j, *other))
}

/// The nearest integers of numbers below 2⁵¹, by an addition that leaves no place for a fraction: no call for each.
fn nearest_integer(x: DVec3) -> DVec3 {
    const NO_FRACTION: DVec3 = DVec3::splat(6_755_399_441_055_744.0);
    (x + NO_FRACTION) - NO_FRACTION
}
