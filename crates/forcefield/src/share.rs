//! The share of one rank: the chunks that it computes, the particles that it needs of other ranks, and what all ranks
//! decide together.
//!
//! ```text
//!   slots of all ranks   | rank 0 | rank 1 (this one)   | rank 2 |     cut at chunks, in the order of the list
//!   its lists may name       xxx  |                     | xxxxx        the halo: positions come with messages
//!   its chunks                    | outer  inner  outer |              inner ones name no particle of the halo
//! ```
//!
//! Positions in messages are true coordinates, never shifted by a box: each rank then takes nearest images by the same
//! numbers. The lists of a rank are the lists that one process makes, so that forces have its bits.

pub mod foreseen;
mod moves;

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::DVec3;
use lennard_core::{Parcel, Team, TooManyRanks};
use lennard_neighbor::{ATOMS_PER_CHUNK, Around, NowAndThen, PairList, Partners, Ranks};

use crate::simd::{MotionSummary, SomeRows};

/// What one rank computes of a list.
pub struct Share {
    /// The team, and the slots of each rank.
    ranks: Ranks,
    /// The slots of each rank in the order before the present one.
    before: Vec<Range<usize>>,
    /// The chunks of this rank.
    chunks: Range<usize>,
    /// 0, 1, …: the number of each slot.
    numbers: Vec<u32>,
    /// For each rank, the slots of that rank that the lists of this rank may name.
    wanted: Vec<Vec<u32>>,
    /// For each rank, the slots of this rank that the lists of that rank may name.
    given: Vec<Vec<u32>>,
    /// For each rank, the slots before the last build whose particles went there from this rank.
    leaving: Vec<Vec<u32>>,
    /// For each rank, the slots of this rank whose particles came from there at the last build.
    arriving: Vec<Vec<u32>>,
    /// Whether each chunk of this rank may name a slot of another one.
    is_outer: Vec<bool>,
    /// The chunks that name no slot of another rank, and the others.
    inner_and_outer: [Vec<u32>; 2],
    /// The rows of this rank, and the rows of its halo.
    rows: [RowRuns; 2],
    /// The slots of this rank, as partners of far movers.
    partners: Partners,
    /// Whether a force of this rank is not finite since all ranks asked last.
    broken: AtomicBool,
    buffers: Mutex<Buffers>,
}

/// Runs of slots and of ghosts, whose rows are packed together.
#[derive(Default)]
struct RowRuns {
    slots: Vec<Range<usize>>,
    ghosts: Vec<Range<usize>>,
}

/// Memory that is used again.
#[derive(Default)]
pub struct Buffers {
    outgoing: Vec<Parcel>,
    incoming: Vec<Parcel>,
    /// Forces by slot.
    pub forces: Vec<DVec3>,
}

impl Share {
    /// The share of this rank of a list of `n` particles: nothing, before the list has an order.
    pub fn new(team: &Team, n: usize) -> Result<Self, TooManyRanks> {
        let chunks = most_ranks(n);
        if team.ranks() > chunks {
            return Err(TooManyRanks {
                ranks: team.ranks(),
                particles: n,
                least: ATOMS_PER_CHUNK,
                most: chunks,
            });
        }
        let slots = vec![0..0; team.ranks()];
        Ok(Self {
            chunks: 0..0,
            before: slots.clone(),
            ranks: Ranks { slots, team: team.clone() },
            numbers: (0..n as u32).collect(),
            wanted: Vec::new(),
            given: Vec::new(),
            leaving: Vec::new(),
            arriving: Vec::new(),
            is_outer: Vec::new(),
            inner_and_outer: Default::default(),
            rows: Default::default(),
            partners: Partners::default(),
            broken: AtomicBool::new(false),
            buffers: Mutex::default(),
        })
    }

    /// Gives each rank its chunks of a list that was just put in order.
    pub fn cut<P: PairList>(&mut self, list: &mut P) {
        let cuts = list.chunk_slots();
        let shares = self.team().shares(cuts.count());
        self.chunks = shares[self.team().rank()].clone();
        let slots = shares.into_iter().map(|chunks| cuts.of(chunks)).collect();
        self.before = std::mem::replace(&mut self.ranks.slots, slots);
        list.keep(self.chunks());
    }

    /// The team.
    pub fn team(&self) -> &Team {
        &self.ranks.team
    }

    /// The team, and the slots of each rank.
    pub fn ranks(&self) -> &Ranks {
        &self.ranks
    }

    /// The slots of each rank.
    pub fn slots(&self) -> &[Range<usize>] {
        &self.ranks.slots
    }

    /// The slots of this rank.
    pub fn own(&self) -> Range<usize> {
        self.ranks.own()
    }

    /// The slots of this rank in the order before the present one.
    fn own_before(&self) -> Range<usize> {
        self.before[self.team().rank()].clone()
    }

    /// The chunks of this rank.
    pub fn chunks(&self) -> Range<usize> {
        self.chunks.clone()
    }

    /// The chunks that name no slot of another rank, and the others.
    pub fn inner_and_outer(&self) -> [&[u32]; 2] {
        let [inner, outer] = &self.inner_and_outer;
        [inner, outer]
    }

    /// The number of each slot.
    pub fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// The rows of this rank (0), or the rows of its halo (1).
    pub fn rows(&self, of: usize) -> SomeRows<'_> {
        let RowRuns { slots, ghosts } = &self.rows[of];
        SomeRows { slots, ghosts }
    }

    /// The slots of this rank, as partners of far movers.
    pub fn partners(&self) -> &Partners {
        &self.partners
    }

    /// Memory that is used again.
    pub fn buffers(&self) -> MutexGuard<'_, Buffers> {
        self.buffers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        let buffers = self.buffers();
        let of_halo = self.wanted.iter().chain(&self.given);
        let of_moves = self.leaving.iter().chain(&self.arriving);
        let words: usize = of_halo.chain(of_moves).map(Vec::capacity).sum();
        let parcels = buffers.outgoing.iter().chain(&buffers.incoming);
        let vectors: usize = parcels.map(|parcel| parcel.vectors.capacity()).sum();
        4 * (words + self.numbers.capacity()) + 24 * (vectors + buffers.forces.capacity())
    }

    /// Agrees with the other ranks who needs which positions for a list that was just built, with what lies around this rank.
    /// `built` has the positions of the build by slot, σ, of this rank and of all that lies around it.
    pub fn agree<P: PairList>(&mut self, list: &P, around: &Around, built: &[DVec3]) {
        let (own, first) = (self.own(), self.chunks.start);
        self.is_outer = vec![false; self.chunks.len()];
        for run in around.outer() {
            let [begin, last] =
                [run.start, run.end - 1].map(|slot| list.chunk_slots().chunk_of(slot as u32));
            self.is_outer[begin - first..=last - first].fill(true);
        }
        self.partners = Partners::new(list.cells(), own.start as u32..own.end as u32);
        let halo = around.halo(list.cells(), |slot| built[slot]);
        let mut is_in_halo = vec![false; self.numbers.len()];
        let mut rows = [RowRuns::default(), RowRuns::default()];
        rows[0].slots.push(own.clone());
        for slot in &halo {
            is_in_halo[*slot as usize] = true;
            push_to_runs(*slot as usize, &mut rows[1].slots);
        }
        for (ghost, slot) in list.slots_of_ghosts().enumerate() {
            let slot = slot as usize;
            if own.contains(&slot) {
                push_to_runs(ghost, &mut rows[0].ghosts);
            } else if is_in_halo[slot] {
                push_to_runs(ghost, &mut rows[1].ghosts);
            }
        }
        self.rows = rows;
        debug_assert!(self.has_all(list, &is_in_halo), "lists name the halo alone");
        self.team().note_halo(halo.len());
        self.want(halo);
        self.sort_chunks();
    }

    /// Whether all lists name slots of this rank and of its halo alone, and the inner ones name no slot of the halo.
    fn has_all<P: PairList>(&self, list: &P, is_in_halo: &[bool]) -> bool {
        let own = self.own();
        let mut has_all = true;
        for (chunk, is_outer) in self.chunks.clone().zip(&self.is_outer) {
            list.for_each_slot(chunk, &mut |slot| {
                let slot = slot as usize;
                has_all &= own.contains(&slot) || (*is_outer && is_in_halo[slot]);
            });
        }
        has_all
    }

    /// Asks the other ranks for the positions at some of their slots.
    fn want(&mut self, slots: impl IntoIterator<Item = u32>) {
        self.wanted = vec![Vec::new(); self.slots().len()];
        for slot in slots {
            self.wanted[rank_of(&self.ranks.slots, slot)].push(slot);
        }
        let words = |list: &Vec<u32>| list.iter().map(|slot| u64::from(*slot)).collect();
        let given = self.team().trade(self.wanted.iter().map(words).collect());
        let slots = |words: Vec<u64>| words.into_iter().map(|word| word as u32).collect();
        self.given = given.into_iter().map(slots).collect();
    }

    /// Includes in the halo what pairs need that all ranks insert.
    pub fn include<P: PairList>(&mut self, list: &P, pairs: &[[u32; 2]]) {
        assert!(list.slots_of_ghosts().next().is_none(), "lists with ghosts take no pairs");
        let me = self.team().rank();
        for [a, b] in pairs {
            for (own, other) in [(*a, *b), (*b, *a)] {
                let [rank, rank_of_other] = [own, other].map(|slot| rank_of(self.slots(), slot));
                if rank == rank_of_other {
                    continue;
                }
                if rank == me {
                    if !self.wanted[rank_of_other].contains(&other) {
                        self.wanted[rank_of_other].push(other);
                        push_to_runs(other as usize, &mut self.rows[1].slots);
                    }
                    self.is_outer[list.chunk_slots().chunk_of(own) - self.chunks.start] = true;
                }
                if rank_of_other == me && !self.given[rank].contains(&other) {
                    self.given[rank].push(other);
                }
            }
        }
        self.sort_chunks();
    }

    fn sort_chunks(&mut self) {
        let chunks = || (self.chunks.start as u32..).zip(&self.is_outer);
        let of = |outer: bool| chunks().filter(move |(_, is_outer)| **is_outer == outer);
        self.inner_and_outer = [false, true].map(|outer| of(outer).map(|(c, _)| c).collect());
    }

    /// Fetches the positions of the halo while `meanwhile` works. `position` gives the position at a slot of this rank,
    /// and `put` takes the position at a slot of the halo.
    pub fn fetch(
        &self,
        position: impl Fn(u32) -> DVec3,
        meanwhile: &mut dyn FnMut(),
        put: impl FnMut(u32, DVec3),
    ) {
        self.swap([&self.given, &self.wanted], position, meanwhile, put);
    }

    /// Gives the other ranks the vectors of some numbers, and takes vectors for other numbers from them.
    fn swap(
        &self,
        [given, wanted]: [&[Vec<u32>]; 2],
        vector: impl Fn(u32) -> DVec3,
        meanwhile: &mut dyn FnMut(),
        mut put: impl FnMut(u32, DVec3),
    ) {
        let mut buffers = self.buffers();
        let Buffers { outgoing, incoming, .. } = &mut *buffers;
        address(outgoing, given);
        address(incoming, wanted);
        for parcel in &mut *outgoing {
            for (to, number) in parcel.vectors.iter_mut().zip(&given[parcel.rank]) {
                *to = vector(*number).to_array();
            }
        }
        self.team().exchange(outgoing, incoming, meanwhile);
        for parcel in &*incoming {
            for (number, vector) in wanted[parcel.rank].iter().zip(&parcel.vectors) {
                put(*number, DVec3::from_array(*vector));
            }
        }
    }

    /// Notes whether a force of this rank is not finite.
    pub fn note_broken(&self, broken: bool) {
        self.broken.fetch_or(broken, Ordering::Relaxed);
    }

    /// Whether a force of any rank is not finite since all ranks asked last.
    pub fn is_broken(&self) -> bool {
        self.team().any(self.broken.swap(false, Ordering::Relaxed))
    }

    /// The largest |d|² of all ranks, σ²; `None` where a position or a force of any rank is not finite.
    pub fn largest2(&self, own: &MotionSummary) -> Option<f64> {
        let broken = self.broken.swap(false, Ordering::Relaxed);
        // Numbers that are not negative have the order of their bits.
        let largest2 = own.largest2.max(0.0);
        let mut words = [largest2.to_bits(), u64::from(!own.finite || broken)];
        self.team().max(&mut words);
        (words[1] == 0).then(|| f64::from_bits(words[0]))
    }

    /// The far movers of all ranks with their positions now and at the build, σ, by ascending slot.
    pub fn far_movers(
        &self,
        own: &[u32],
        at: impl Fn(u32) -> NowAndThen,
    ) -> Vec<(u32, NowAndThen)> {
        let words: Vec<u64> = own
            .iter()
            .flat_map(|slot| {
                let [now, then] = at(*slot).map(|r| r.to_array().map(f64::to_bits));
                let [a, b, c] = now;
                let [d, e, f] = then;
                [u64::from(*slot), a, b, c, d, e, f]
            })
            .collect();
        let all = self.team().concat(&words);
        let (all, _) = all.as_chunks::<7>();
        let mover = |[slot, a, b, c, d, e, f]: &[u64; 7]| {
            let at = [[a, b, c], [d, e, f]];
            let at = at.map(|r| DVec3::from_array(r.map(|x| f64::from_bits(*x))));
            (*slot as u32, at)
        };
        let mut movers: Vec<(u32, NowAndThen)> = all.iter().map(mover).collect();
        movers.sort_unstable_by_key(|(slot, _)| *slot);
        movers
    }

    /// Of the pairs that any rank found, those that a list lacks, in ascending order.
    pub fn missing(
        &self,
        found: &[[u32; 2]],
        is_listed: impl Fn([u32; 2]) -> bool,
    ) -> Vec<[u32; 2]> {
        let words: Vec<u64> =
            found.iter().map(|[a, b]| u64::from(*a) << 32 | u64::from(*b)).collect();
        let mut all = self.team().concat(&words);
        all.sort_unstable();
        all.dedup();
        let pairs: Vec<[u32; 2]> =
            all.iter().map(|word| [(word >> 32) as u32, *word as u32]).collect();
        if pairs.is_empty() {
            return pairs;
        }
        let mut lacks: Vec<u64> = pairs.iter().map(|p| u64::from(!is_listed(*p))).collect();
        self.team().max(&mut lacks);
        let lacked = pairs.into_iter().zip(lacks).filter(|(_, lacks)| *lacks > 0);
        lacked.map(|(pair, _)| pair).collect()
    }
}

/// The largest number of ranks that can share lists of `n` particles.
#[must_use]
pub fn most_ranks(n: usize) -> usize {
    n.div_ceil(ATOMS_PER_CHUNK)
}

/// The rank of a slot, where each rank has a range of them.
fn rank_of(slots: &[Range<usize>], slot: u32) -> usize {
    slots.partition_point(|range| range.end <= slot as usize)
}

/// Adds a number behind the last run, or to it.
fn push_to_runs(number: usize, runs: &mut Vec<Range<usize>>) {
    match runs.last_mut() {
        Some(run) if run.end == number => run.end += 1,
        _ => runs.push(number..number + 1),
    }
}

/// Makes a parcel for each rank with slots, of their number of vectors.
fn address(parcels: &mut Vec<Parcel>, slots: &[Vec<u32>]) {
    let ranks = (0..).zip(slots).filter(|(_, slots)| !slots.is_empty());
    let mut used = 0;
    for (rank, slots) in ranks {
        if used == parcels.len() {
            parcels.push(Parcel::default());
        }
        parcels[used].rank = rank;
        parcels[used].vectors.resize(slots.len(), [0.0; 3]);
        used += 1;
    }
    parcels.truncate(used);
}
