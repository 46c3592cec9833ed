//! The pairs of one cluster, one member after another: for processors whose registers do not hold the sums of four members.
//!
//! ```text
//!   1   all blocks                gathered and converted once              -> near, in the first-level cache
//!   2   member a     half | masked | plain       registers of `near`       -> force of a
//!       member b     half | masked | plain       the same ones             -> force of b
//!       ...
//!
//!   in registers, of sixteen (12-6 of one species)         in memory
//!     x, y, z of the member                          3       neighbors: an operand of each subtraction
//!     its sums                                       3       sums of the cluster before, which are reduced meanwhile
//!     a pair: dx, dy, dz, r², r⁻², r⁻⁴, mask    6 to 7
//!     r_cut², the unit of r⁻², −1/2                  3
//! ```
//!
//! A register of eight pairs takes 16 operations, none of which stores. Sums have the order, and so the bits, of the loop with
//! four members.

use std::mem::MaybeUninit;

use lennard_neighbor::{BLOCK, CLUSTER, ExcludedEntries};

use super::{BlockCounts, ClusterKernel, FrameUnits, Member, MemberSums, not_looked_at};
use crate::interaction::Interaction;
use crate::simd::accumulate::CommonSums;
use crate::simd::block_stream::{BlockStream, Neighbors};
use crate::simd::lanes::FixedLanes;
use crate::simd::row::FixedRow;

/// Blocks that are converted together: the lists of most clusters.
const ROOM: usize = 32;
/// Registers of neighbors in this room, at eight neighbors each.
const REGISTERS: usize = ROOM * BLOCK / 8;

/// Converted neighbors by registers, and their species.
///
/// The two are apart: where no species is looked at, the compiler leaves them out.
struct Near<L: FixedLanes> {
    at: *const [L; 3],
    species: *const L::Species,
}

impl<L: FixedLanes> Near<L> {
    /// A register of neighbors.
    ///
    /// # Safety
    /// The register is written.
    #[inline(always)]
    unsafe fn get(&self, register: usize) -> Neighbors<L> {
        // SAFETY: the contract is passed on.
        unsafe { (*self.at.add(register), *self.species.add(register)) }
    }
}

/// Blocks that are converted.
struct Blocks<'a, L: FixedLanes> {
    counts: BlockCounts,
    /// The entries of masked blocks that members do not look at.
    excluded: &'a [ExcludedEntries],
    /// Number of masked blocks of the cluster before these ones.
    masked_before: usize,
    near: &'a Near<L>,
    /// Stands at the first of the blocks.
    stream: &'a BlockStream<L>,
}

impl<L: FixedLanes, I: Interaction, const COMPACT: bool, const CUBIC: bool>
    ClusterKernel<L, I, COMPACT, CUBIC>
{
    /// As [`ClusterKernel::run`], with the same bits in the forces.
    ///
    /// # Safety
    /// As [`ClusterKernel::run`].
    #[inline(always)]
    pub(super) unsafe fn by_member<const EACH: usize, const COMMON: usize>(
        &self,
        (of_frame, rows): (&FrameUnits<I>, [&FixedRow; CLUSTER]),
        mut counts: BlockCounts,
        excluded: &[ExcludedEntries],
        stream: &mut BlockStream<L>,
        common: &mut [CommonSums<L>; COMMON],
    ) -> [MemberSums<L, EACH>; CLUSTER] {
        const { assert!(ROOM * BLOCK / L::WIDTH <= REGISTERS) };
        let mut at = [const { MaybeUninit::<[L; 3]>::uninit() }; REGISTERS];
        let mut species = [const { MaybeUninit::<L::Species>::uninit() }; REGISTERS];
        let near = Near { at: at.as_mut_ptr().cast(), species: species.as_mut_ptr().cast() };
        let at_members = self.frame.members;
        // A loop over members keeps the sums of the others in memory. Unrolled, it would keep the sums of the first ones in registers.
        let mut sums = [self.nothing::<EACH>(); CLUSTER];
        let registers = BLOCK / L::WIDTH;
        let mut masked_before = 0;
        loop {
            let part = counts.take(ROOM);
            // SAFETY: the contract is passed on. These blocks belong to the cluster, there is room for them, and a register
            // is written before it is read.
            unsafe {
                for block in 0..part.all() {
                    for k in 0..registers {
                        let register = block * registers + k;
                        let (to, to_species) = self.neighbors(stream.rows(block, k));
                        at.get_unchecked_mut(register).write(to);
                        species.get_unchecked_mut(register).write(to_species);
                    }
                }
                let blocks = Blocks { counts: part, excluded, masked_before, near: &near, stream };
                for member in 0..CLUSTER {
                    let numbers = I::own::<L>(self.isa, &of_frame.numbers, rows[member]);
                    let own = Member { at: at_members[member], numbers: &numbers };
                    sums[member] =
                        self.pass::<EACH, COMMON>((own, member), &blocks, sums[member], common);
                }
                stream.skip(part.all());
            }
            masked_before += part.masked as usize;
            if counts.all() == 0 {
                return sums;
            }
        }
    }

    /// Adds the pairs of a member with converted blocks.
    ///
    /// # Safety
    /// The registers of the blocks are written.
    #[inline(always)]
    unsafe fn pass<const EACH: usize, const COMMON: usize>(
        &self,
        (own, member): (Member<'_, L, I>, usize),
        blocks: &Blocks<'_, L>,
        mut sum: MemberSums<L, EACH>,
        common: &mut [CommonSums<L>; COMMON],
    ) -> MemberSums<L, EACH> {
        let Blocks { counts, excluded, masked_before, near, stream } = *blocks;
        let first_half = counts.first_half as usize;
        let masked = first_half + counts.second_half as usize;
        let plain = masked + counts.masked as usize;
        let half = if 2 * member < CLUSTER { 0..first_half } else { first_half..masked };
        let registers = BLOCK / L::WIDTH;
        // SAFETY: the contract is passed on.
        unsafe {
            for block in half {
                let valid = stream.valid_of(block);
                sum = self.masked::<EACH, COMMON>(own, near, (block, valid), sum, common);
            }
            for block in masked..plain {
                let not = not_looked_at(excluded, masked_before + block - masked)[member];
                let valid = stream.valid_of(block) & !not;
                sum = self.masked::<EACH, COMMON>(own, near, (block, valid), sum, common);
            }
            for register in plain * registers..counts.all() * registers {
                sum = self.interact::<EACH, COMMON, false>(own, near.get(register), 0, sum, common);
            }
        }
        sum
    }

    /// Adds the pairs of a member with the `valid` entries of a converted block.
    ///
    /// # Safety
    /// The registers of the block are written.
    #[inline(always)]
    unsafe fn masked<const EACH: usize, const COMMON: usize>(
        &self,
        own: Member<'_, L, I>,
        near: &Near<L>,
        (block, valid): (usize, u16),
        mut sum: MemberSums<L, EACH>,
        common: &mut [CommonSums<L>; COMMON],
    ) -> MemberSums<L, EACH> {
        for k in 0..BLOCK / L::WIDTH {
            // SAFETY: the contract is passed on.
            let near = unsafe { near.get(block * (BLOCK / L::WIDTH) + k) };
            let bits = u32::from(valid) >> (k * L::WIDTH);
            sum = self.interact::<EACH, COMMON, true>(own, near, bits, sum, common);
        }
        sum
    }
}
