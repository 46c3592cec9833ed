//! The pairs of one cluster with its neighbors.
//!
//! ```text
//!   a register of neighbors    n0 n1 n2 ... n15         gathered and converted once
//!
//!   interact with member a     a-n0 a-n1 ... a-n15      -> force of a += sum over lanes
//!   interact with member b     b-n0 b-n1 ... b-n15      -> force of b
//!   interact with member c     ...
//!   interact with member d     ...
//! ```
//!
//! Nothing is written to the neighbors: each pair is computed from both of its ends.

mod by_member;

use lennard_neighbor::{BLOCK, CLUSTER, ExcludedEntries, Span, THEMSELVES};

use super::accumulate::{self, CommonSums, PairSums, Units};
use super::block_stream::{BlockStream, Neighbors};
use super::frames::Frame;
use super::lanes::{FixedLanes, Lanes};
use super::row::FixedRow;
use crate::interaction::Interaction;

/// The units of a frame, and the numbers of the interaction in these units.
pub struct FrameUnits<I: Interaction> {
    units: Units,
    numbers: I::Numbers<f32>,
}

impl<I: Interaction> FrameUnits<I> {
    /// The units of a frame whose length unit is `length` σ.
    pub fn new(interaction: &I, r_cut: f64, length: f64) -> Self {
        Self {
            units: Units { energy: I::UNIT, length },
            numbers: interaction.numbers(r_cut, length),
        }
    }
}

/// Number of blocks of each kind that a cluster has.
#[derive(Clone, Copy)]
pub struct BlockCounts {
    first_half: u32,
    second_half: u32,
    masked: u32,
    plain: u32,
}

impl BlockCounts {
    /// The counts of a span whose blocks begin at `begin`.
    #[inline(always)]
    pub fn of(span: &Span, begin: u32) -> Self {
        Self {
            first_half: span.first_half - begin,
            second_half: span.second_half - span.first_half,
            masked: span.masked - span.second_half,
            plain: span.end - span.masked,
        }
    }

    /// Number of blocks of all kinds.
    #[inline(always)]
    pub fn all(self) -> usize {
        (self.first_half + self.second_half + self.masked + self.plain) as usize
    }

    /// Takes the first blocks, at most `most`.
    #[inline(always)]
    pub fn take(&mut self, most: usize) -> Self {
        let mut left = most as u32;
        let mut of = |count: &mut u32| {
            let taken = left.min(*count);
            left -= taken;
            *count -= taken;
            taken
        };
        Self {
            first_half: of(&mut self.first_half),
            second_half: of(&mut self.second_half),
            masked: of(&mut self.masked),
            plain: of(&mut self.plain),
        }
    }
}

/// The entries of the `k`th masked block that members do not look at.
///
/// The members are the first entries of the first masked block. No member interacts with itself.
#[inline(always)]
pub fn not_looked_at(excluded: &[ExcludedEntries], k: usize) -> ExcludedEntries {
    match excluded.get(k) {
        Some(entries) => *entries,
        None if k == 0 => THEMSELVES,
        None => [0; CLUSTER],
    }
}

/// Sums of one member.
#[derive(Clone, Copy)]
pub struct MemberSums<L: Lanes, const EACH: usize> {
    /// In units of the interaction and of the frame.
    pub force: [L; 3],
    /// The sums in addition to the force.
    pub others: [PairSums<L>; EACH],
}

/// A cluster in a frame, ready to interact with its neighbors.
pub struct ClusterKernel<L: FixedLanes, I: Interaction, const COMPACT: bool, const CUBIC: bool> {
    isa: L::Isa,
    interaction: I,
    /// The numbers of each member.
    numbers: [I::Own<L>; CLUSTER],
    units: Units,
    frame: Frame<L, COMPACT, CUBIC>,
}

/// A member in registers.
struct Member<'a, L: FixedLanes, I: Interaction> {
    at: [L; 3],
    numbers: &'a I::Own<L>,
}

impl<L: FixedLanes, I: Interaction> Clone for Member<'_, L, I> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<L: FixedLanes, I: Interaction> Copy for Member<'_, L, I> {}

impl<L: FixedLanes, I: Interaction, const COMPACT: bool, const CUBIC: bool>
    ClusterKernel<L, I, COMPACT, CUBIC>
{
    /// The kernel of an interaction for members with these rows, in a frame and its units.
    #[inline(always)]
    pub fn new(
        isa: L::Isa,
        interaction: I,
        units: &FrameUnits<I>,
        [a, b, c, d]: [&FixedRow; CLUSTER],
        frame: Frame<L, COMPACT, CUBIC>,
    ) -> Self {
        let numbers = &units.numbers;
        Self {
            isa,
            interaction,
            numbers: [
                I::own::<L>(isa, numbers, a),
                I::own::<L>(isa, numbers, b),
                I::own::<L>(isa, numbers, c),
                I::own::<L>(isa, numbers, d),
            ],
            units: units.units,
            frame,
        }
    }

    /// The members in registers.
    #[inline(always)]
    fn members(&self) -> [Member<'_, L, I>; CLUSTER] {
        let [a, b, c, d] = self.frame.members;
        let [of_a, of_b, of_c, of_d] = &self.numbers;
        [
            Member { at: a, numbers: of_a },
            Member { at: b, numbers: of_b },
            Member { at: c, numbers: of_c },
            Member { at: d, numbers: of_d },
        ]
    }

    /// The sums of each member over the next list of the stream, and their units; sums in `COMMON` are over all members.
    ///
    /// `given` is what the kernel was made of. `excluded` has the entries of each masked block that members do not look at; none
    /// where these are the members alone.
    ///
    /// # Safety
    /// The stream stands at the first block of this cluster, and `counts` are the block counts of the cluster.
    #[inline(always)]
    pub unsafe fn run<const EACH: usize, const COMMON: usize>(
        &self,
        given: (&FrameUnits<I>, [&FixedRow; CLUSTER]),
        counts: BlockCounts,
        excluded: &[ExcludedEntries],
        stream: &mut BlockStream<L>,
        common: &mut [CommonSums<L>; COMMON],
    ) -> ([MemberSums<L, EACH>; CLUSTER], Units) {
        let all = [u16::MAX; CLUSTER];
        // SAFETY: the contract is passed on.
        unsafe {
            if L::FEW_REGISTERS && COMPACT && EACH + COMMON == 0 {
                return (self.by_member(given, counts, excluded, stream, common), self.units);
            }
            let members = self.members();
            let [a, b] = self.half(members[0], members[1], counts.first_half, stream, common);
            let [c, d] = self.half(members[2], members[3], counts.second_half, stream, common);
            let mut sums = [a, b, c, d];
            for k in 0..counts.masked {
                let but = not_looked_at(excluded, k as usize);
                let valid = stream.valid();
                let valid = [valid & !but[0], valid & !but[1], valid & !but[2], valid & !but[3]];
                sums = self.block::<EACH, COMMON, true>(members, stream, valid, sums, common);
            }
            for _ in 0..counts.plain {
                sums = self.block::<EACH, COMMON, false>(members, stream, all, sums, common);
            }
            (sums, self.units)
        }
    }

    /// The sums over no pair.
    #[inline(always)]
    fn nothing<const EACH: usize>(&self) -> MemberSums<L, EACH> {
        MemberSums {
            force: [L::constant(self.isa, 0.0); 3],
            others: [PairSums::nothing(self.isa); EACH],
        }
    }

    /// The sums of two members over `blocks` blocks of their half.
    ///
    /// # Safety
    /// As [`ClusterKernel::run`].
    #[inline(always)]
    unsafe fn half<const EACH: usize, const COMMON: usize>(
        &self,
        first: Member<'_, L, I>,
        second: Member<'_, L, I>,
        blocks: u32,
        stream: &mut BlockStream<L>,
        common: &mut [CommonSums<L>; COMMON],
    ) -> [MemberSums<L, EACH>; 2] {
        let (mut of_first, mut of_second) = (self.nothing(), self.nothing());
        for _ in 0..blocks {
            // SAFETY: the contract is passed on.
            let valid = u32::from(unsafe { stream.valid() });
            for part in 0..BLOCK / L::WIDTH {
                // SAFETY: as above.
                let neighbors = self.neighbors(unsafe { stream.next(part) });
                let bits = valid >> (part * L::WIDTH);
                of_first =
                    self.interact::<EACH, COMMON, true>(first, neighbors, bits, of_first, common);
                of_second =
                    self.interact::<EACH, COMMON, true>(second, neighbors, bits, of_second, common);
            }
        }
        [of_first, of_second]
    }

    /// Adds the pairs of one block with all members; where it is `MASKED`, only the entries that are `valid` for each.
    ///
    /// # Safety
    /// As [`ClusterKernel::run`].
    #[inline(always)]
    unsafe fn block<const EACH: usize, const COMMON: usize, const MASKED: bool>(
        &self,
        members: [Member<'_, L, I>; CLUSTER],
        stream: &mut BlockStream<L>,
        valid: [u16; CLUSTER],
        sums: [MemberSums<L, EACH>; CLUSTER],
        common: &mut [CommonSums<L>; COMMON],
    ) -> [MemberSums<L, EACH>; CLUSTER] {
        // Sums go by value and by constant index: sums behind a reference would not stay in registers.
        let [mut a, mut b, mut c, mut d] = sums;
        for part in 0..BLOCK / L::WIDTH {
            // SAFETY: the contract is passed on.
            let neighbors = self.neighbors(unsafe { stream.next(part) });
            let bits = |valid: u16| u32::from(valid) >> (part * L::WIDTH);
            a = self.interact::<EACH, COMMON, MASKED>(
                members[0],
                neighbors,
                bits(valid[0]),
                a,
                common,
            );
            b = self.interact::<EACH, COMMON, MASKED>(
                members[1],
                neighbors,
                bits(valid[1]),
                b,
                common,
            );
            c = self.interact::<EACH, COMMON, MASKED>(
                members[2],
                neighbors,
                bits(valid[2]),
                c,
                common,
            );
            d = self.interact::<EACH, COMMON, MASKED>(
                members[3],
                neighbors,
                bits(valid[3]),
                d,
                common,
            );
        }
        [a, b, c, d]
    }

    /// The neighbors of gathered rows in the frame, and their species.
    #[inline(always)]
    fn neighbors(&self, (rows, species): Neighbors<L>) -> Neighbors<L> {
        (self.frame.neighbors(rows), species)
    }

    /// Adds the pairs of one member with one register of neighbors; where they are `MASKED`, only the lanes set in `bits`.
    #[inline(always)]
    fn interact<const EACH: usize, const COMMON: usize, const MASKED: bool>(
        &self,
        member: Member<'_, L, I>,
        (neighbors, species): Neighbors<L>,
        bits: u32,
        mut sums: MemberSums<L, EACH>,
        common: &mut [CommonSums<L>; COMMON],
    ) -> MemberSums<L, EACH> {
        let [dx, dy, dz] = self.frame.apart(member.at, neighbors);
        let r2 = dz.mul_add(dz, dy.mul_add(dy, dx * dx));
        let r_cut2 = I::r_cut2::<L>(member.numbers, species);
        let inside = if MASKED { r2.at_most_among(r_cut2, bits) } else { r2.at_most(r_cut2) };
        let (interaction, own) = (&self.interaction, member.numbers);
        let at = (r2, inside);
        let f = if CUBIC {
            accumulate::force::<L, I, false, COMMON>(interaction, own, species, at, common)
        } else {
            accumulate::force::<L, I, true, COMMON>(interaction, own, species, at, common)
        };
        let [x, y, z] = sums.force;
        sums.force = [dx.mul_add(f, x), dy.mul_add(f, y), dz.mul_add(f, z)];
        if EACH > 0 {
            let pair = if CUBIC {
                interaction.eval::<L, false>(own, species, r2)
            } else {
                interaction.eval::<L, true>(own, species, r2)
            };
            let at_cutoff = I::at_cutoff::<L>(own, species);
            sums.others[0].add([dx, dy, dz], f, &pair, at_cutoff, inside);
        }
        sums
    }
}
