//! Particles settle in the parts that own their places, at a build.
//!
//! ```text
//!   particles of a rank, anywhere   ->  to the ranks that own their columns  ->  halos  ->  slots
//! ```

use std::sync::Mutex;
use std::sync::atomic::AtomicU64;

use glam::DVec3;
use lennard_core::{ForceError, Own, PeriodicBox};
use lennard_neighbor::{
    Belongs, GridError, PairList, Partners, Positions, Reach, farthest_apart, is_usable,
    with_rounding,
};

use super::halo::Halo;
use super::{Part, Particles, RowRuns, runs_of};
use crate::simd::by_slot;

/// Builds between two cuts, at least: to move many particles costs more than a little balance.
const BUILDS_A_CUT: usize = 100;
/// The largest part over the mean from which on new cuts are made.
const MOST_OVER_MEAN: f64 = 1.05;

impl Part {
    /// Brings particles to the ranks that own their places, orders the list over them and their halo, and places all.
    ///
    /// `particles` have velocities or not, and come in any order. Afterwards positions are by slot, halo included, and
    /// velocities are at own slots.
    pub fn settle<P: PairList>(
        &mut self,
        list: &mut P,
        cell: &PeriodicBox,
        reach: Reach,
        particles: &mut Particles,
    ) -> Result<(), ForceError> {
        let lengths = cell.lengths();
        let bad = particles.positions.iter().position(|r| !is_usable(*r, lengths));
        let bad = bad.map(|k| particles.numbers[k] as usize);
        if let Some(particle) = self.lowest(bad) {
            return Err(ForceError::NonFinitePosition { particle });
        }
        let columns = list.begin_part(cell, reach, self.whole);
        let mut at: Vec<[u32; 2]> =
            particles.positions.iter().map(|r| list.column_at(cell, *r)).collect();
        let is_new = !columns.has_bundles_of(&self.columns);
        self.columns = columns;
        self.cut(is_new, &at);
        self.migrate(list, cell, particles, &mut at);
        let counted = Own::whole_of(Some(&self.team), particles.numbers.len());
        assert_eq!(counted, self.whole, "no particle is lost on its way");
        let own = particles.numbers.len();
        let near = with_rounding(lengths, reach.r_list);
        self.far = with_rounding(lengths, farthest_apart(reach, self.whole));
        self.beyond = self.columns.beyond(&self.owners, self.team.rank(), self.far);
        let ranks = self.surround(near, particles, &at);
        at.extend(particles.positions[own..].iter().map(|r| list.column_at(cell, *r)));
        self.order(list, cell, reach, particles, &at)?;
        // Elements become slots.
        let mut slots = vec![0; list.source().len()];
        for (slot, element) in (0..).zip(list.source()) {
            slots[*element as usize] = slot;
        }
        let lists = self.near.wanted.iter_mut().chain(&mut self.near.given);
        lists.flatten().for_each(|element| *element = slots[*element as usize]);
        let halo = &list.source()[own..];
        self.halo_ranks = halo.iter().map(|element| ranks[*element as usize - own]).collect();
        by_slot_in_place(list.source(), &mut particles.positions);
        if particles.move_on {
            by_slot_in_place(&list.source()[..own], &mut particles.velocities);
        }
        list.place(cell, &particles.positions);
        particles.numbers.clear();
        self.split(list, near);
        self.team.note_halo(self.near.len());
        self.route = Mutex::new(None);
        self.searches = AtomicU64::new(0);
        self.inserted.clear();
        self.crossing.clear();
        self.builds += 1;
        Ok(())
    }

    /// Cuts the bundles anew, where they are new, or where the largest part is too large and it was long ago.
    fn cut(&mut self, is_new: bool, at: &[[u32; 2]]) {
        let ranks = self.team.ranks();
        let is_due = self.builds >= BUILDS_A_CUT && {
            let mut largest = [at.len() as u64];
            self.team.max(&mut largest);
            largest[0] as f64 * ranks as f64 > MOST_OVER_MEAN * self.whole as f64
        };
        if !is_new && !is_due {
            return;
        }
        let mut weights = vec![0; self.columns.bundles()];
        at.iter().for_each(|column| weights[self.columns.bundle(*column)] += 1);
        self.team.sum(&mut weights);
        let weights: Vec<u64> = weights.into_iter().map(|weight| weight as u64).collect();
        self.owners = self.columns.cut(&weights, ranks);
        self.builds = 0;
    }

    fn owner(&self, column: [u32; 2]) -> usize {
        self.owners[self.columns.bundle(column)] as usize
    }

    /// Sends particles to the ranks that own their columns `at`, and takes those that come.
    fn migrate<P: PairList>(
        &self,
        list: &P,
        cell: &PeriodicBox,
        particles: &mut Particles,
        at: &mut Vec<[u32; 2]>,
    ) {
        let Particles { move_on, numbers, positions, velocities } = particles;
        let moves = *move_on;
        let mut sent = vec![Vec::new(); self.team.ranks()];
        let mut kept = 0;
        for k in 0..numbers.len() {
            let owner = self.owner(at[k]);
            if owner == self.team.rank() {
                (numbers[kept], positions[kept], at[kept]) = (numbers[k], positions[k], at[k]);
                if moves {
                    velocities[kept] = velocities[k];
                }
                kept += 1;
            } else {
                sent[owner].push(numbers[k].into());
                push(&mut sent[owner], positions[k]);
                if moves {
                    push(&mut sent[owner], velocities[k]);
                }
            }
        }
        numbers.truncate(kept);
        positions.truncate(kept);
        velocities.truncate(kept);
        at.truncate(kept);
        for words in self.team.trade(sent) {
            for words in words.chunks_exact(if moves { 7 } else { 4 }) {
                let r = vector(&words[1..4]);
                numbers.push(words[0] as u32);
                positions.push(r);
                at.push(list.column_at(cell, r));
                if moves {
                    velocities.push(vector(&words[4..7]));
                }
            }
        }
    }

    /// Sends particles to the ranks whose parts they are near to, and adds the halo of this rank behind the own particles. Returns
    /// the rank of each particle of the halo.
    ///
    /// The near halo is of elements until slots are known.
    fn surround(&mut self, near: f64, particles: &mut Particles, at: &[[u32; 2]]) -> Vec<u32> {
        let ranks = self.team.ranks();
        self.near = Halo::among(ranks);
        let mut far = vec![Vec::new(); ranks];
        let mut found = Vec::new();
        for (k, (column, r)) in (0..).zip(at.iter().zip(&particles.positions)) {
            self.beyond.ranks_near(*column, *r, &mut found);
            for (rank, d2) in &found {
                if *d2 <= near * near {
                    self.near.given[*rank as usize].push(k);
                } else if *d2 <= self.far * self.far {
                    far[*rank as usize].push(k);
                }
            }
        }
        let words = |(near, far): (&Vec<u32>, &Vec<u32>)| {
            let mut words = vec![near.len() as u64];
            for k in near.iter().chain(far).map(|k| *k as usize) {
                words.push(particles.numbers[k].into());
                push(&mut words, particles.positions[k]);
            }
            words
        };
        let sent = self.near.given.iter().zip(&far).map(words).collect();
        let mut of_halo = Vec::new();
        for (rank, words) in self.team.trade(sent).into_iter().enumerate() {
            let Some((near, words)) = words.split_first() else { continue };
            for (k, words) in (0..).zip(words.as_chunks::<4>().0) {
                if k < *near {
                    self.near.wanted[rank].push(particles.numbers.len() as u32);
                }
                of_halo.push(rank as u32);
                particles.numbers.push(words[0] as u32);
                particles.positions.push(vector(&words[1..]));
            }
        }
        of_halo
    }

    /// Gives the particles, whose columns are `at`, their slots.
    fn order<P: PairList>(
        &self,
        list: &mut P,
        cell: &PeriodicBox,
        reach: Reach,
        particles: &Particles,
        at: &[[u32; 2]],
    ) -> Result<(), ForceError> {
        let [nx, ny] = self.columns.count;
        let index = |[x, y]: [u32; 2]| (x * ny + y) as usize;
        let mut belongs = vec![Belongs::Nowhere; (nx * ny) as usize];
        at.iter().for_each(|column| belongs[index(*column)] = Belongs::Halo);
        for column in (0..nx).flat_map(|x| (0..ny).map(move |y| [x, y])) {
            if self.owner(column) == self.team.rank() {
                belongs[index(column)] = Belongs::Own;
            }
        }
        list.take_part(&|column| belongs[index(column)], &particles.numbers);
        let ordered = list.order(cell, reach, Positions::BySlot(&particles.positions));
        ordered.map_err(|GridError::BadPosition { particle }| ForceError::NonFinitePosition {
            particle,
        })
    }

    /// Splits chunks into inner ones, which name no halo, and outer ones, and rows into own ones and rows of the halo.
    fn split<P: PairList>(&mut self, list: &P, near: f64) {
        let own = list.own();
        let chunks = list.chunk_slots();
        let mut is_outer = vec![false; chunks.count()];
        let [nx, ny] = self.columns.count;
        for column in (0..nx).flat_map(|x| (0..ny).map(move |y| [x, y])) {
            if self.owner(column) != self.team.rank() || !self.beyond.is_outer(column, near) {
                continue;
            }
            let slots = list.cells().column(column);
            if !slots.is_empty() {
                is_outer[chunks.chunk_of(slots.start)..=chunks.chunk_of(slots.end - 1)].fill(true);
            }
        }
        let of = |outer: bool| {
            let all = (0..).zip(&is_outer).filter(move |(_, is_outer)| **is_outer == outer);
            all.map(|(chunk, _)| chunk).collect()
        };
        self.inner_and_outer = [of(false), of(true)];
        let ghosts = |is_own: bool| {
            let all = list.slots_of_ghosts().enumerate();
            runs_of(all.filter(|(_, slot)| ((*slot as usize) < own) == is_own).map(|(k, _)| k))
        };
        self.rows = [
            RowRuns { slots: runs_of(0..own), ghosts: ghosts(true) },
            RowRuns { slots: Vec::new(), ghosts: ghosts(false) },
        ];
        self.partners = Partners::new(list.cells(), 0..own as u32);
    }
}

/// Puts elements in an order that has the index of each.
fn by_slot_in_place(order: &[u32], elements: &mut Vec<DVec3>) {
    let mut sorted = vec![DVec3::ZERO; order.len()];
    by_slot(order, 0..order.len(), elements, &mut sorted);
    *elements = sorted;
}

/// Adds a vector.
pub(super) fn push(words: &mut Vec<u64>, vector: DVec3) {
    words.extend(vector.to_array().map(f64::to_bits));
}

/// The vector in three words.
pub(super) fn vector(words: &[u64]) -> DVec3 {
    DVec3::new(f64::from_bits(words[0]), f64::from_bits(words[1]), f64::from_bits(words[2]))
}
