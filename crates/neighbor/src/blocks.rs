//! Neighbors in blocks of constant size, as a loop over shared lists reads them.

use crate::shared_scan::{FOR_ALL, FOR_FIRST_TWO, FOR_LAST_TWO, Found, SHARERS};

/// Entries of a block.
pub const BLOCK: usize = 16;
/// What entries count in: eight times an entry is then the distance in bytes to a row of sixteen of them, which an
/// address reaches without a shift.
pub const ENTRY: u16 = 2;
/// How far places of a block may lie apart.
pub(crate) const REACH: u32 = (u16::MAX / ENTRY) as u32;

/// A point amid the four who share a list, the second and the third of whom are given in fixed point.
#[inline(always)]
#[must_use]
pub fn amid<const N: usize>(second: [i32; N], third: [i32; N]) -> [i32; N] {
    let mut amid = second;
    for axis in 0..N {
        amid[axis] = second[axis].wrapping_add(third[axis].wrapping_sub(second[axis]) >> 1);
    }
    amid
}

/// Some neighbors of those who share a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Block {
    /// What is added to each entry to give a place.
    pub base: u32,
    /// Which of the entries count, a bit each; the others name some place.
    pub valid: u16,
    /// [`ENTRY`] times the places less the base.
    pub entries: [u16; BLOCK],
}

impl Block {
    /// A block of [`BLOCK`] places.
    fn full(base: u32, places: &[u32; BLOCK]) -> Self {
        Self {
            base,
            valid: u16::MAX,
            entries: places.map(|place| (place - base) as u16 * ENTRY),
        }
    }

    /// A block of the first so many of some places, from a base that is known to reach them, or else from one of its own, if
    /// there is one.
    fn of_first(places: &[u32; BLOCK], count: usize, base: Option<u32>) -> Option<Self> {
        let base = base.or_else(|| base_of(&places[..count]))?;
        let mut entries = [0; BLOCK];
        for ((entry, place), k) in entries.iter_mut().zip(places).zip(0..) {
            // No branch for any: those that do not count name the base.
            let counts = if k < count as u16 { u16::MAX } else { 0 };
            *entry = (place.wrapping_sub(base) as u16).wrapping_mul(ENTRY) & counts;
        }
        Some(Self {
            base,
            valid: u16::MAX >> (BLOCK - count),
            entries,
        })
    }

    /// A block of fewer places, at least one.
    fn of(base: u32, places: &[u32]) -> Self {
        let mut all = [base; BLOCK];
        all[..places.len()].copy_from_slice(places);
        Self {
            valid: u16::MAX >> (BLOCK - places.len()),
            ..Self::full(base, &all)
        }
    }

    /// Whether a place counts.
    fn names(&self, place: u32) -> bool {
        self.places().any(|named| named == place)
    }

    /// Names a place where another one does not count, if there is such an entry and it reaches there.
    fn take_in(&mut self, place: u32) -> bool {
        let free = self.valid.trailing_ones() as usize;
        let reaches = (self.base..=self.base + REACH).contains(&place);
        if free < BLOCK && reaches {
            self.valid |= 1 << free;
            self.entries[free] = (place - self.base) as u16 * ENTRY;
        }
        free < BLOCK && reaches
    }

    /// The places that count.
    pub fn places(&self) -> impl Iterator<Item = u32> {
        let Self {
            base,
            valid,
            entries,
        } = *self;
        (0..BLOCK)
            .filter(move |k| valid >> k & 1 == 1)
            .map(move |k| base + u32::from(entries[k] / ENTRY))
    }
}

/// Where the blocks of a list end among those of its chunk; each kind begins where the one before it ends, and the first
/// where the list before ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// Those for the first two sharers alone; not all of their entries count.
    pub first_two: u32,
    /// Those for the last two alone, likewise.
    pub last_two: u32,
    /// Those for all four with entries that do not count for all of them. The first of these begins with the sharers
    /// themselves.
    pub masked: u32,
    /// Those for all four.
    pub end: u32,
    /// Whether the sharers are so close together, and the box is so wide, that a loop may take all coordinates as seen
    /// from the point [`amid`] them: nobody near lies more than half a box from it.
    pub together: bool,
}

/// The lists of up to [`crate::ATOMS_PER_CHUNK`] consecutive places.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SharedChunk {
    /// The first place.
    pub first_place: u32,
    /// The ends of each list.
    pub spans: Vec<Span>,
    /// The blocks of one list after another, and one that belongs to none.
    pub blocks: Vec<Block>,
}

/// The blocks of one list, by those whom they are for.
#[derive(Debug, Clone, Copy)]
pub struct SharedBlocks<'a> {
    /// For the first two sharers alone, but not all of their entries count.
    pub first_two: &'a [Block],
    /// For the last two alone, likewise.
    pub last_two: &'a [Block],
    /// For all, but with entries that do not count for each of them.
    pub masked: &'a [Block],
    /// For all.
    pub plain: &'a [Block],
}

impl SharedBlocks<'_> {
    /// The blocks for one of the sharers.
    pub fn of(&self, sharer: usize) -> impl Iterator<Item = &Block> {
        let for_two = if 2 * sharer < SHARERS {
            self.first_two
        } else {
            self.last_two
        };
        for_two.iter().chain(self.masked).chain(self.plain)
    }

    /// Number of lanes that a loop computes.
    #[must_use]
    pub fn lanes(&self) -> usize {
        let for_two = self.first_two.len() + self.last_two.len();
        let for_all = self.masked.len() + self.plain.len();
        BLOCK * (SHARERS / 2 * for_two + SHARERS * for_all)
    }
}

impl SharedChunk {
    /// The list of the `k`th four.
    #[must_use]
    fn list(&self, k: usize) -> SharedBlocks<'_> {
        let span = &self.spans[k];
        let begin = if k == 0 { 0 } else { self.spans[k - 1].end };
        let between = |from: u32, to: u32| &self.blocks[from as usize..to as usize];
        SharedBlocks {
            first_two: between(begin, span.first_two),
            last_two: between(span.first_two, span.last_two),
            masked: between(span.last_two, span.masked),
            plain: between(span.masked, span.end),
        }
    }

    /// The first places and the lists of all fours.
    pub fn lists(&self) -> impl Iterator<Item = (usize, SharedBlocks<'_>)> {
        let first = self.first_place as usize;
        (0..self.spans.len()).map(move |k| (first + k * SHARERS, self.list(k)))
    }

    /// Whether the list of the `k`th four names a place for one of them.
    pub(crate) fn names(&self, k: usize, sharer: usize, place: u32) -> bool {
        self.list(k).of(sharer).any(|block| block.names(place))
    }

    /// Names a place in the list of the `k`th four, for one of whom it is not named yet: for all of them, once.
    pub(crate) fn name(&mut self, k: usize, place: u32) {
        let begin = if k == 0 {
            0
        } else {
            self.spans[k - 1].end as usize
        };
        let span = &mut self.spans[k];
        let last_two = span.last_two as usize;
        let masked = last_two..span.masked as usize;
        if let Some(block) = (begin..last_two).find(|block| self.blocks[*block].names(place)) {
            // From now on all look at what this block names, behind the one that begins with the sharers.
            self.blocks[block..masked.end].rotate_left(1);
            span.first_two -= u32::from(block < span.first_two as usize);
            span.last_two -= 1;
            return;
        }
        let blocks = &mut self.blocks[masked.clone()];
        if blocks.iter_mut().any(|block| block.take_in(place)) {
            return;
        }
        self.blocks.insert(masked.end, Block::of(place, &[place]));
        span.masked += 1;
        span.end += 1;
        for span in &mut self.spans[k + 1..] {
            span.first_two += 1;
            span.last_two += 1;
            span.masked += 1;
            span.end += 1;
        }
    }

    pub(crate) fn clear(&mut self) {
        self.spans.clear();
        self.blocks.clear();
    }

    /// Adds a list of what was found for four sharers; `base` is one that is known to reach all of it, if there is one.
    pub(crate) fn push(&mut self, found: &mut Found, together: bool, base: Option<u32>) {
        let [wanted_by_first, wanted_by_last] = worth_while(found.len);
        self.push_for_two(found, FOR_FIRST_TWO, wanted_by_first, base);
        let first_two = self.blocks.len();
        self.push_for_two(found, FOR_LAST_TWO, wanted_by_last, base);
        let last_two = self.blocks.len();
        let (near, base) = match base {
            Some(base) => (found.of(FOR_ALL).len(), base),
            None => found.near_first(),
        };
        let (near, far) = found.of(FOR_ALL).split_at(near);
        let masked = pack(near, base, &mut self.blocks);
        let masked = pack_far(far, masked, &mut self.blocks);
        self.spans.push(Span {
            first_two: first_two as u32,
            last_two: last_two as u32,
            masked: masked as u32,
            end: self.blocks.len() as u32,
            together,
        });
    }

    /// Writes so many blocks of what is near to two of the sharers alone, and leaves the rest to what is for all.
    fn push_for_two(&mut self, found: &mut Found, pair: usize, blocks: usize, base: Option<u32>) {
        let mut used = 0;
        for _ in 0..blocks {
            let (places, count) = found.chunk(pair, used);
            let Some(block) = Block::of_first(places, count, base) else {
                break;
            };
            self.blocks.push(block);
            used += count;
        }
        found.give_to_all(pair, used);
    }

    /// Ends the lists with a block that belongs to none, for loops that read ahead.
    pub(crate) fn finish(&mut self) {
        self.blocks
            .push(Block::of(self.first_place, &[self.first_place]));
        give_back(&mut self.blocks);
    }

    /// Bytes held beyond the structure itself.
    pub(crate) fn bytes(&self) -> usize {
        self.spans.capacity() * size_of::<Span>() + self.blocks.capacity() * size_of::<Block>()
    }
}

/// Gives back what growth took too much of, but for room for the next list.
pub(crate) fn give_back<T>(list: &mut Vec<T>) {
    let len = list.len();
    if list.capacity() > len + len / 4 {
        list.shrink_to(len + len / 16);
    }
}

/// How many blocks for the first two sharers alone, and how many for the last two, are worth while, where so many are near to
/// all, and to those alone: what fills a part of such a block may take less time in one for all. None of them would be empty.
fn worth_while([for_all, of_first, of_last]: [usize; 3]) -> [usize; 2] {
    // Operations of a loop: 28 to read a block and to convert it, and 20 for each who looks at it.
    const FOR_TWO: usize = 28 + 20 * SHARERS / 2;
    const FOR_ALL: usize = 28 + 20 * SHARERS;
    let (mut best, mut least) = ([0; 2], usize::MAX);
    // Full ones always are.
    for first in of_first / BLOCK..=of_first.div_ceil(BLOCK) {
        for last in of_last / BLOCK..=of_last.div_ceil(BLOCK) {
            let beyond =
                of_first.saturating_sub(first * BLOCK) + of_last.saturating_sub(last * BLOCK);
            let operations =
                (first + last) * FOR_TWO + (for_all + beyond).div_ceil(BLOCK) * FOR_ALL;
            if operations < least {
                (best, least) = ([first, last], operations);
            }
        }
    }
    best
}

/// The base of a block of some places, the lowest of them; `None` where its entries do not reach them all.
fn base_of(places: &[u32]) -> Option<u32> {
    let low = places.iter().copied().min().unwrap_or_default();
    let high = places.iter().copied().max().unwrap_or_default();
    (high - low <= REACH).then_some(low)
}

/// Writes the places of a list, all within reach of a base, into blocks, those with entries that do not count for all
/// sharers before the others, and returns where these end.
fn pack(list: &[u32], base: u32, blocks: &mut Vec<Block>) -> usize {
    // The first block takes what does not fill whole ones, unless that is less than the sharers.
    let rest = list.len() % BLOCK;
    let lead = match rest {
        0 => BLOCK,
        1..SHARERS => (BLOCK + rest).min(list.len()),
        _ => rest,
    };
    let (lead, full) = list.split_at(lead);
    if lead.len() < BLOCK
        && let Some(places) = list.first_chunk()
    {
        // What does not count may name any place.
        let mut block = Block::full(base, places);
        block.valid = u16::MAX >> (BLOCK - lead.len());
        blocks.push(block);
    } else {
        blocks.extend(lead.chunks(BLOCK).map(|places| Block::of(base, places)));
    }
    let masked = blocks.len();
    let (full, none) = full.as_chunks();
    debug_assert!(none.is_empty(), "what is left fills whole blocks");
    blocks.extend(full.iter().map(|places| Block::full(base, places)));
    masked
}

/// Writes places in ascending order into blocks besides those of [`pack`], whose masked ones end at `masked`; returns where
/// these end now.
fn pack_far(mut list: &[u32], mut masked: usize, blocks: &mut Vec<Block>) -> usize {
    while let Some(base) = list.first() {
        let (within_reach, beyond) =
            list.split_at(list.partition_point(|place| place - base <= REACH));
        let (full, rest) = within_reach.as_chunks();
        blocks.extend(full.iter().map(|places| Block::full(*base, places)));
        if !rest.is_empty() {
            blocks.insert(masked, Block::of(*base, rest));
            masked += 1;
        }
        list = beyond;
    }
    masked
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::PADDING;

    /// Places in this order: the sharers and what is near to all, to the first two alone, and to the last two alone.
    fn found(len: [usize; 3]) -> Found {
        let room = len.iter().sum::<usize>() + PADDING;
        let mut first = 0;
        let places = len.map(|len| {
            let mut places: Vec<u32> = (first..first + len as u32).collect();
            first += len as u32;
            // What lies beyond means nothing.
            places.resize(room, u32::MAX);
            places
        });
        let mut found = Found::default();
        (found.places, found.len) = (places, len);
        found
    }

    #[test]
    fn no_other_numbers_of_blocks_for_two_take_fewer_operations() {
        assert_eq!(worth_while([68, 28, 28]), [1, 2]);
        assert_eq!(worth_while([68, 28, 13]), [1, 1]);
        assert_eq!(worth_while([60, 16, 4]), [1, 0], "four find room");
        assert_eq!(
            worth_while([64, 33, 12]),
            [2, 0],
            "thirteen fill one for all"
        );
        for len in [
            [4, 0, 0],
            [4, 1, 0],
            [70, 26, 31],
            [61, 16, 48],
            [90, 5, 47],
        ] {
            let cost = |[first, last]: [usize; 2]| {
                let rest = |len: usize, blocks: usize| len.saturating_sub(blocks * BLOCK);
                let for_all = len[0] + rest(len[1], first) + rest(len[2], last);
                (first + last) * 68 + for_all.div_ceil(BLOCK) * 108
            };
            let chosen = worth_while(len);
            let others = (0..5).flat_map(|first| (0..5).map(move |last| [first, last]));
            assert!(
                others.map(cost).all(|other| cost(chosen) <= other),
                "{len:?}"
            );
            assert!(chosen[0] <= len[1].div_ceil(BLOCK) && chosen[1] <= len[2].div_ceil(BLOCK));
        }
    }

    #[test]
    fn a_list_names_each_place_once_for_all_whom_it_is_near_to() {
        for len in [
            [4, 0, 0],
            [68, 28, 28],
            [64, 33, 12],
            [70, 16, 48],
            [5, 3, 1],
            [90, 5, 47],
        ] {
            // From a base of all, and from one of each block.
            for base in [Some(0), None] {
                let mut chunk = SharedChunk::default();
                chunk.push(&mut found(len), false, base);
                let list = chunk.list(0);
                let [all, first, last] = len.map(|len| len as u32);
                for sharer in 0..SHARERS {
                    let mut named: Vec<u32> = list.of(sharer).flat_map(Block::places).collect();
                    named.sort_unstable();
                    assert!(named.is_sorted_by(|a, b| a < b), "{len:?}: {named:?}");
                    assert!(named.iter().all(|place| *place < all + first + last));
                    let own = if sharer < 2 {
                        all..all + first
                    } else {
                        all + first..all + first + last
                    };
                    for place in (0..all).chain(own) {
                        assert!(named.contains(&place), "{len:?}: {place} for {sharer}");
                    }
                }
                let for_two = [list.first_two.len(), list.last_two.len()];
                assert_eq!(for_two, worth_while(len));
                let entries = chunk.blocks.iter().flat_map(|block| block.entries);
                assert!(
                    entries
                        .into_iter()
                        .all(|entry| u32::from(entry / ENTRY) < all + first + last)
                );
            }
        }
    }
}
