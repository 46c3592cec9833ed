//! The pairs that a list lacks: searched ahead of the particles that moved far since the build.
//!
//! ```text
//!       far mover i                      cone: cos θ ≥ ½·skin/|d_i|
//!          \        ________...........
//!   x⁰_i  o----> d_i        |          shell between r_list and r_cut + |d_i| + max|d|,
//!          /      ¯¯¯¯¯¯¯¯¯¯¯¯...      around x⁰_i: a particle j that can now be inside the cutoff
//!                            ¯         and is not listed was in this part of it at the build
//! ```

mod packed;

pub use packed::{DisplacementScale, PackedDisplacement};

use std::hint::black_box;
use std::ops::Range;

use glam::DVec3;
use lennard_core::PeriodicBox;
use lennard_core::parallel::map_ranges;

use crate::sort::{CellRange, Cells, FIXED_ROUNDING};

/// How particles moved since a list was built, in the box of the build.
#[derive(Debug)]
pub struct Displacements<'a, A> {
    /// The cells of the sort.
    pub cells: Cells<'a>,
    /// The positions of the particle at a slot, now and at the build, unwrapped, σ.
    pub at: A,
    /// The displacements in few bytes, by slot, `[N]`; they save time where many particles moved far.
    pub packed: Option<&'a [PackedDisplacement]>,
    /// The largest |x − x⁰|², σ².
    pub largest2: f64,
    /// The slots that a far mover may meet; none where it may meet all. The positions of others are not asked for.
    pub partners: Option<&'a Partners>,
}

/// The position of a particle now and at a build, σ.
pub type NowAndThen = [DVec3; 2];

/// The slots of one rank, as partners of far movers.
#[derive(Debug, Clone, Default)]
pub struct Partners {
    slots: Range<u32>,
    /// The columns with some of these slots, along x and y: a column without is not in both.
    columns: [Vec<bool>; 2],
}

impl Partners {
    /// Some slots of a sort.
    #[must_use]
    pub fn new(cells: Cells<'_>, slots: Range<u32>) -> Self {
        let [nx, ny, nz] = cells.count();
        let columns = [vec![false; nx as usize], vec![false; ny as usize]];
        let mut partners = Self { slots, columns };
        for (x, y) in (0..nx).flat_map(|x| (0..ny).map(move |y| (x, y))) {
            if !partners.among(cells.slots(x, y, [0, nz - 1])).is_empty() {
                partners.columns[0][x as usize] = true;
                partners.columns[1][y as usize] = true;
            }
        }
        partners
    }

    /// Those that are among some slots.
    fn among(&self, slots: Range<u32>) -> Range<u32> {
        let start = slots.start.max(self.slots.start);
        start..slots.end.min(self.slots.end).max(start)
    }
}

impl<A: Fn(u32) -> NowAndThen> Displacements<'_, A> {
    /// The position of the particle at a slot, and its displacement.
    #[inline(always)]
    fn of(&self, slot: u32) -> (DVec3, DVec3) {
        let [at, built] = (self.at)(slot);
        (at, at - built)
    }
}

/// How far beyond the edge of its cell a particle may seem to lie, in cells: the sort rounded differently.
const BEYOND_THE_EDGE: f64 = 1e-3;

/// Far movers that are processed together, stage by stage, so that memory latencies overlap.
const BATCH: usize = 16;

/// The pairs of slots within `inner` σ of each other now, by an image that was farther than `radius` σ away at the build.
///
/// A list of that radius need not contain them. In each pair the lower slot comes first, and pairs ascend.
/// `far` holds the slots of all particles that moved by more than half the skin, where skin = `radius` − `inner`.
/// The partners of all ranks together give all pairs, since one of the two moved far.
///
/// Let n be the unit vector from one particle to the other at the build. Then r ≥ r⁰ − (d_i − d_j)·n.
/// Two particles that came closer by more than the skin moved by more than it along n.
/// One of them moved by more than half the skin toward the place of the other at the build.
/// The search therefore looks ahead of each far mover, in the part of a shell that a cone cuts out: cos θ ≥ ½·skin/|d|.
/// A partner must itself make up for the rest of the skin, and few particles moved so far.
#[must_use]
pub fn unlisted_pairs<A: Fn(u32) -> NowAndThen + Sync>(
    cell: &PeriodicBox,
    radius: f64,
    inner: f64,
    displacements: Displacements<'_, A>,
    far: &[u32],
) -> Vec<[u32; 2]> {
    let lengths = cell.lengths();
    // The factors here and below are margins for rounding.
    let half = 0.5 * (radius - inner) * (1.0 - 1e-9);
    let search = Search {
        count: displacements.cells.count(),
        farthest: displacements.largest2.sqrt() * (1.0 + 1e-9),
        displacements,
        lengths,
        inverse_lengths: 1.0 / lengths,
        scale: DisplacementScale::new(half * half),
        half,
        radius,
        inner,
    };
    let mut unlisted: Vec<[u32; 2]> = map_ranges(far.len(), |range| {
        let mut scratch = Scratch::default();
        for batch in far[range].chunks(BATCH) {
            search.look_ahead(batch, &mut scratch);
        }
        scratch.unlisted
    })
    .concat();
    unlisted.sort_unstable();
    unlisted.dedup();
    unlisted
}

/// A particle that moved far.
#[derive(Clone, Copy)]
struct FarMover {
    slot: u32,
    /// Position now, σ.
    at: DVec3,
    /// x − x⁰, σ.
    moved: DVec3,
}

/// Possible partners ahead of a far mover.
#[derive(Clone)]
struct Ahead<T> {
    /// The index of the far mover in its batch.
    mover: u8,
    /// A partner whose packed square is not larger did not move enough.
    below: u8,
    /// Where the partners are.
    partners: T,
}

/// Cells of a column: x, y, and the first and last cell along z, both included.
type ColumnPart = (u32, u32, [u32; 2]);

/// Buffers of a search.
#[derive(Default)]
struct Scratch {
    movers: Vec<FarMover>,
    parts: Vec<Ahead<ColumnPart>>,
    slots: Vec<Ahead<Range<u32>>>,
    /// The index of a far mover, and the slot of a partner that may have come closer by the skin.
    pairs: Vec<(u8, u32)>,
    unlisted: Vec<[u32; 2]>,
}

struct Search<'a, A> {
    displacements: Displacements<'a, A>,
    /// Number of cells along each axis.
    count: [u32; 3],
    lengths: DVec3,
    inverse_lengths: DVec3,
    scale: DisplacementScale,
    /// Half the skin, σ.
    half: f64,
    radius: f64,
    inner: f64,
    /// The largest displacement, σ.
    farthest: f64,
}

impl<A: Fn(u32) -> NowAndThen> Search<'_, A> {
    /// Adds the unlisted pairs ahead of a batch of at most [`BATCH`] far movers.
    fn look_ahead(&self, far: &[u32], scratch: &mut Scratch) {
        let Scratch { movers, parts, slots, pairs, unlisted } = scratch;
        movers.clear();
        movers.extend(far.iter().map(|slot| {
            let (at, moved) = self.displacements.of(*slot);
            FarMover { slot: *slot, at, moved }
        }));
        parts.clear();
        for (number, mover) in (0..).zip(&*movers) {
            self.find_ahead(number, mover, parts);
        }
        slots.clear();
        slots.extend(parts.iter().map(|ahead| Ahead {
            mover: ahead.mover,
            below: ahead.below,
            partners: {
                let (x, y, z) = ahead.partners;
                let slots = self.displacements.cells.slots(x, y, z);
                match self.displacements.partners {
                    None => slots,
                    Some(partners) => partners.among(slots),
                }
            },
        }));
        let mut look_at = |mover: u8, other: u32| {
            let mover = &movers[usize::from(mover)];
            if self.is_unlisted(mover, other) {
                unlisted.push([mover.slot.min(other), mover.slot.max(other)]);
            }
        };
        match self.displacements.packed {
            Some(packed) => {
                find_closer(movers, slots, packed, pairs);
                for (mover, other) in pairs.drain(..) {
                    look_at(mover, other);
                }
            }
            None => {
                for ahead in slots {
                    for other in ahead.partners.clone() {
                        look_at(ahead.mover, other);
                    }
                }
            }
        }
    }

    /// Adds the cells ahead of a far mover.
    #[inline(always)]
    fn find_ahead(&self, number: u8, mover: &FarMover, to: &mut Vec<Ahead<ColumnPart>>) {
        let FarMover { at, moved, .. } = *mover;
        let distance = moved.length();
        if distance <= self.half {
            return;
        }
        let before = at - moved;
        let shell = [self.radius, self.inner + distance + self.farthest];
        let cosine = self.half / distance;
        let below = self.scale.below((2.0 * self.half - distance).max(0.0));
        let axis = |axis: usize| {
            self.cells_ahead(axis, before[axis], moved[axis] / distance, cosine, shell)
        };
        let [x, y, z] = [axis(0), axis(1), axis(2)];
        let [nx, ny, nz] = self.count;
        let has = |axis: usize, column: u32| {
            let partners = self.displacements.partners;
            partners.is_none_or(|partners| partners.columns[axis][column as usize])
        };
        for x in x.wrapped(nx).filter(|x| has(0, *x)) {
            for y in y.wrapped(ny).filter(|y| has(1, *y)) {
                for z in z.runs(nz) {
                    to.push(Ahead { mover: number, below, partners: (x, y, z) });
                }
            }
        }
    }

    /// Whether the particle at the slot `other` is near now and was beyond the list radius at the build.
    #[inline(always)]
    fn is_unlisted(&self, mover: &FarMover, other: u32) -> bool {
        let FarMover { slot, at, moved } = *mover;
        let (at_other, moved_other) = self.displacements.of(other);
        let now = self.nearest(at - at_other);
        // The same image at the build.
        let then = now - (moved - moved_other);
        now.length_squared() <= self.inner * self.inner
            && then.length_squared() > self.radius * self.radius
            && other != slot
    }

    /// The cells along an axis that a part of a shell covers.
    ///
    /// The shell has radii `low` and `high` σ around the coordinate `from` σ. The part consists of the directions whose
    /// cosine with a unit vector of component `along` is at least `cosine`.
    #[inline(always)]
    fn cells_ahead(
        &self,
        axis: usize,
        from: f64,
        along: f64,
        cosine: f64,
        [low, high]: [f64; 2],
    ) -> CellRange {
        let across = ((1.0 - along * along).max(0.0) * (1.0 - cosine * cosine).max(0.0)).sqrt();
        let most = if along >= cosine { 1.0 } else { along * cosine + across };
        let least = if -along >= cosine { -1.0 } else { along * cosine - across };
        let end = most * if most > 0.0 { high } else { low };
        let begin = least * if least < 0.0 { high } else { low };
        let count = f64::from(self.count[axis]);
        let share = from * self.inverse_lengths[axis];
        let share = share - ((share + FIXED_ROUNDING) - FIXED_ROUNDING);
        let number = |way: f64| (share + way * self.inverse_lengths[axis]) * count;
        // No range reaches farther than two boxes, and a cast of a positive number rounds down.
        let down = |number: f64| (number + 4.0 * count) as i64 - 4 * i64::from(self.count[axis]);
        CellRange {
            first: down(number(begin) - BEYOND_THE_EDGE),
            last: down(number(end) + BEYOND_THE_EDGE),
        }
    }

    /// The nearest image of a difference, σ: [`PeriodicBox::minimum_image`] without a call per axis.
    #[inline(always)]
    fn nearest(&self, d: DVec3) -> DVec3 {
        d - self.lengths * ((d * self.inverse_lengths + FIXED_ROUNDING) - FIXED_ROUNDING)
    }
}

/// Adds the partners that may have come closer to their far movers by the skin.
fn find_closer(
    movers: &[FarMover],
    slots: &[Ahead<Range<u32>>],
    packed: &[PackedDisplacement],
    to: &mut Vec<(u8, u32)>,
) {
    // Independent reads of the first partners: the processor fetches all of these lines at the same time.
    let first = |ahead: &Ahead<Range<u32>>| packed.get(ahead.partners.start as usize);
    let squares = slots.iter().filter_map(first).map(|packed| packed.square);
    black_box(squares.fold(0, |all, square| all ^ square));
    for Ahead { mover, below, partners } in slots {
        let of_mover = packed[movers[usize::from(*mover)].slot as usize];
        let of_partners = &packed[partners.start as usize..partners.end as usize];
        for (slot, other) in partners.clone().zip(of_partners) {
            if other.square > *below && of_mover.may_be_closer(*other) {
                to.push((*mover, slot));
            }
        }
    }
}

#[cfg(test)]
mod tests;
