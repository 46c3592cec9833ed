//! Displacements since the build of a list, and their summary.

use std::ops::Range;

use glam::DVec3;

use lennard_core::MOST_SPECIES;
use lennard_neighbor::ATOMS_PER_CHUNK;

/// Slots that are packed together, at most.
pub const BATCH: usize = 64;

const _: () = assert!(ATOMS_PER_CHUNK <= BATCH);

/// 0, 1, …
static NUMBERS: [u32; BATCH] = {
    let mut numbers = [0; BATCH];
    let mut k = 0;
    while k < BATCH {
        numbers[k] = k as u32;
        k += 1;
    }
    numbers
};

/// The numbers 0, 1, … of as many slots as are packed together, or fewer.
#[inline(always)]
pub fn numbers(count: usize) -> &'static [u32] {
    &NUMBERS[..count]
}

/// Positions of the particles at some slots, now and at the build of the list.
///
/// The displacement of a particle is d = x − (L/L⁰)·x⁰: the part of its motion that a change of the box does not explain.
#[derive(Debug, Clone, Copy)]
pub struct Motion<'a> {
    /// Unwrapped positions, σ.
    pub positions: &'a [DVec3],
    /// The index in `positions` of each slot; none where positions are by slot.
    pub order: Option<&'a [u32]>,
    /// Positions of the build by slot, σ.
    pub built: &'a [DVec3],
    /// L/L⁰ along each axis: the sides of the box over its sides at the build.
    pub stretch: DVec3,
    /// The |d|² beyond which a particle moved far, σ².
    pub far2: f64,
    /// The sides of the box, σ.
    pub lengths: DVec3,
    /// The species at each slot, where there are several.
    pub species: Option<SlotSpecies<'a>>,
}

/// Runs of slots and of ghosts (by their place in the table), whose rows are packed together.
#[derive(Debug, Clone, Copy)]
pub struct SomeRows<'a> {
    /// Runs of slots.
    pub slots: &'a [Range<usize>],
    /// Runs of ghosts.
    pub ghosts: &'a [Range<usize>],
}

/// The species of the particles at some slots.
#[derive(Debug, Clone, Copy)]
pub struct SlotSpecies<'a> {
    /// The species at each slot.
    pub at: &'a [u8],
    /// The padding of each species in rows of doubles.
    pub paddings: &'static [f64; MOST_SPECIES],
}

impl SlotSpecies<'_> {
    /// The species at some of the slots.
    #[inline(always)]
    pub fn part(self, slots: Range<usize>) -> Self {
        Self { at: &self.at[slots], ..self }
    }
}

impl<'a> Motion<'a> {
    /// The motion at some of the slots.
    #[inline(always)]
    pub fn part(self, slots: Range<usize>) -> Self {
        let (positions, order) = match self.order {
            Some(order) => (self.positions, Some(&order[slots.clone()])),
            None => (&self.positions[slots.clone()], None),
        };
        Self {
            positions,
            order,
            built: &self.built[slots.clone()],
            species: self.species.map(|species| species.part(slots)),
            ..self
        }
    }

    /// The number of slots.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.built.len()
    }

    /// The index in the positions of each slot, for as many slots as are packed together.
    #[inline(always)]
    pub fn indices(&self) -> &'a [u32] {
        self.order.unwrap_or_else(|| numbers(self.positions.len()))
    }

    /// The padding of the row of doubles for the `k`th slot.
    #[inline(always)]
    pub fn padding(&self, k: usize) -> f64 {
        match self.species {
            None => 0.0,
            Some(species) => species.paddings[usize::from(species.at[k]) % MOST_SPECIES],
        }
    }

    /// The padding of the row in fixed point for the `k`th slot.
    #[inline(always)]
    pub fn fixed_padding(&self, k: usize) -> i32 {
        match self.species {
            None => 0,
            Some(species) => species.at[k].into(),
        }
    }

    /// The position of the particle at the `k`th slot, σ.
    #[inline(always)]
    pub fn at(&self, k: usize) -> DVec3 {
        self.positions[self.order.map_or(k, |order| order[k] as usize)]
    }

    /// The displacement of the particle at the `k`th slot, σ.
    #[inline(always)]
    pub fn displacement(&self, k: usize) -> DVec3 {
        // In the box of the build the product changes no bit.
        self.at(k) - self.stretch * self.built[k]
    }
}

/// How far some particles have moved since the build of the list.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionSummary {
    /// The largest |d|², σ².
    pub largest2: f64,
    /// Whether every |d|² is a finite number.
    pub finite: bool,
    /// The slots of the particles that moved far.
    pub far: Vec<u32>,
}

impl MotionSummary {
    /// The summary of no particle.
    pub const NOTHING: Self = Self { largest2: 0.0, finite: true, far: Vec::new() };

    /// The union of two sets of particles.
    pub fn and(mut self, other: Self) -> Self {
        self.far.extend(other.far);
        Self {
            largest2: self.largest2.max(other.largest2),
            finite: self.finite & other.finite,
            far: self.far,
        }
    }

    /// Includes the slots from `first` on, by their |d|² in `squares`; a particle above `far2` moved far.
    #[inline(always)]
    pub fn include(&mut self, first: usize, squares: &[f64], far2: f64) {
        // There is no branch per particle, since far movers are hard to predict.
        let mut largest2 = [self.largest2; 4];
        let mut all_near = true;
        let (fours, rest) = squares.as_chunks::<4>();
        for four in fours {
            for (largest2, d2) in largest2.iter_mut().zip(four) {
                *largest2 = if *d2 > *largest2 { *d2 } else { *largest2 };
                // The comparison is false for NaN.
                all_near &= *d2 <= far2;
            }
        }
        for d2 in rest {
            largest2[0] = if *d2 > largest2[0] { *d2 } else { largest2[0] };
            all_near &= *d2 <= far2;
        }
        self.largest2 = largest2.into_iter().fold(0.0, f64::max);
        if all_near {
            return;
        }
        let mut len = self.far.len();
        self.far.resize(len + squares.len(), 0);
        for (slot, d2) in (first..).zip(squares) {
            self.far[len] = slot as u32;
            len += usize::from(*d2 > far2);
            self.finite &= *d2 < f64::INFINITY;
        }
        self.far.truncate(len);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_far_movers_are_found() {
        let squares: Vec<f64> = (0..203).map(|i| f64::from(i % 7)).collect();
        let mut moved = MotionSummary::NOTHING;
        moved.include(1000, &squares[..101], 4.5);
        moved.include(1101, &squares[101..], 4.5);
        let far = (1000..).zip(&squares).filter(|(_, d2)| **d2 > 4.5);
        assert_eq!(moved.far, far.map(|(slot, _)| slot).collect::<Vec<u32>>());
        assert_eq!((moved.largest2, moved.finite), (6.0, true));
        moved.include(2000, &[1.0, 2.0], 4.5);
        assert_eq!((moved.largest2, moved.finite), (6.0, true));
        moved.include(3000, &[0.0, f64::NAN, 1.0, 2.0, f64::INFINITY], 4.5);
        assert!(!moved.finite && moved.far.last() == Some(&3004));
    }
}
