//! Particles that moved far beside the face of a part, and the pairs that they make across it.
//!
//! ```text
//!   rank A   far mover a  ->  ranks with a in their halo        each looks for own partners of a
//!   rank B   partner b    ->  rank A                            both insert the pair, in the order of the whole
//! ```

use std::sync::atomic::Ordering;

use glam::DVec3;
use lennard_core::PeriodicBox;
use lennard_neighbor::PairList;

use super::Part;
use super::settle::{push, vector};

/// Far movers in the halo of a rank, by ascending slot.
pub struct FarMovers(Vec<FarMover>);

struct FarMover {
    slot: u32,
    rank: usize,
    at: DVec3,
}

/// Words of a far mover: its column, its number and its position.
const MOVER_WORDS: usize = 5;

impl FarMovers {
    /// Their slots.
    pub fn slots(&self) -> impl Iterator<Item = u32> {
        self.0.iter().map(|mover| mover.slot)
    }

    /// The present position of one of them, σ.
    pub fn position(&self, slot: u32) -> DVec3 {
        self.of(slot).map_or(DVec3::NAN, |mover| mover.at)
    }

    fn of(&self, slot: u32) -> Option<&FarMover> {
        let at = self.0.binary_search_by_key(&slot, |mover| mover.slot);
        at.ok().map(|k| &self.0[k])
    }
}

/// A list, the box of its build, and the positions of its build by slot, σ.
pub struct Settled<'a, P> {
    pub list: &'a P,
    pub cell: &'a PeriodicBox,
    pub built: &'a [DVec3],
}

impl<P: PairList> Settled<'_, P> {
    /// The column of the particle at a slot.
    fn column(&self, slot: u32) -> [u32; 2] {
        self.list.column_at(self.cell, self.built[slot as usize])
    }

    /// What other ranks know a particle by: its column, and its number.
    fn name(&self, slot: u32, [x, y]: [u32; 2]) -> [u64; 2] {
        [u64::from(x) << 32 | u64::from(y), self.list.particles()[slot as usize].into()]
    }

    /// The slot of a particle of this part, or of its halo.
    fn slot(&self, [column, number]: [u64; 2]) -> u32 {
        let mut slots = self.list.cells().column([(column >> 32) as u32, column as u32]);
        let particles = self.list.particles();
        let slot = slots.find(|slot| u64::from(particles[*slot as usize]) == number);
        slot.expect("halos reach as far as particles may move")
    }
}

/// The place of a slot in the order of the whole; its lower half is the number of the particle.
fn place<P: PairList>(list: &P, slot: u32) -> u64 {
    let [cell, number] = list.key(slot);
    u64::from(cell) << 32 | u64::from(number)
}

/// Whether one of two slots is an own one, and the other is in the halo.
fn crosses([a, b]: [u32; 2], own: u32) -> bool {
    (a < own) != (b < own)
}

impl Part {
    /// Begins another search for unlisted pairs, on all ranks.
    pub fn begin_search(&self) {
        self.searches.fetch_add(1, Ordering::Relaxed);
    }

    /// Tells other ranks the far movers of this one that are in their halos, and takes theirs. All ranks do it together.
    pub fn far_movers<P: PairList>(
        &self,
        settled: &Settled<'_, P>,
        far: &[u32],
        position: impl Fn(u32) -> DVec3,
    ) -> FarMovers {
        self.begin_search();
        let mut sent = vec![Vec::new(); self.team.ranks()];
        let mut near = Vec::new();
        for slot in far {
            let column = settled.column(*slot);
            self.beyond.ranks_near(column, settled.built[*slot as usize], &mut near);
            for (rank, _) in near.iter().filter(|(_, d2)| *d2 <= self.far * self.far) {
                let words: &mut Vec<u64> = &mut sent[*rank as usize];
                words.extend(settled.name(*slot, column));
                push(words, position(*slot));
            }
        }
        let mut movers = Vec::new();
        for (rank, words) in self.team.trade(sent).into_iter().enumerate() {
            for words in words.as_chunks::<MOVER_WORDS>().0 {
                let slot = settled.slot([words[0], words[1]]);
                movers.push(FarMover { slot, rank, at: vector(&words[2..]) });
            }
        }
        movers.sort_unstable_by_key(|mover| mover.slot);
        FarMovers(movers)
    }

    /// The pairs of slots that lists of this rank lack, or that cross its face for the first time. They have the order of the whole.
    /// Some were `found` here, with far movers of the halo among them. Other ranks tell those that they found with far movers of
    /// this one. All ranks do it together.
    ///
    /// Lists name particles for whole clusters. So one end may list what the other one lacks.
    pub fn missing<P: PairList>(
        &self,
        settled: &Settled<'_, P>,
        movers: &FarMovers,
        found: Vec<[u32; 2]>,
    ) -> Vec<[u32; 2]> {
        let mut sent = vec![Vec::new(); self.team.ranks()];
        for [a, b] in &found {
            for (mover, partner) in [(a, b), (b, a)] {
                if let Some(mover) = movers.of(*mover) {
                    let name = |slot| settled.name(slot, settled.column(slot));
                    sent[mover.rank].extend([name(mover.slot), name(*partner)].concat());
                }
            }
        }
        let mut pairs = found;
        for words in self.team.trade(sent) {
            let names = words.as_chunks::<2>().0.as_chunks::<2>().0;
            pairs.extend(names.iter().map(|names| names.map(|name| settled.slot(name))));
        }
        for pair in &mut pairs {
            pair.sort_unstable_by_key(|slot| place(settled.list, *slot));
        }
        pairs.sort_unstable_by_key(|pair| pair.map(|slot| place(settled.list, slot)));
        pairs.dedup();
        let own = settled.list.own() as u32;
        let is_new = |pair: &[u32; 2]| crosses(*pair, own) && !self.crossing.contains(pair);
        pairs.retain(|pair| is_new(pair) || !settled.list.contains(*pair));
        pairs
    }

    /// Notes which pairs of slots are about to be inserted, and lets the positions come that lists name then. A checkpoint has saved
    /// them all, or a list of this rank may lack them.
    pub fn include<P: PairList>(&mut self, list: &P, pairs: &[[u32; 2]], are_saved: bool) {
        let own = list.own() as u32;
        let search = *self.searches.get_mut();
        for pair in pairs.iter().filter(|pair| are_saved || !list.contains(**pair)) {
            let [a, b] = pair.map(|slot| place(list, slot));
            self.inserted.push([search, a, b]);
        }
        let [inner, outer] = &mut self.inner_and_outer;
        for pair in pairs.iter().filter(|pair| crosses(**pair, own)) {
            let [here, there] = if pair[0] < own { *pair } else { [pair[1], pair[0]] };
            let rank = self.halo_ranks[(there - own) as usize] as usize;
            self.near.add(rank, there, here);
            self.crossing.insert(*pair);
            let chunk = list.chunk_slots().chunk_of(here) as u32;
            if let Ok(at) = inner.binary_search(&chunk) {
                inner.remove(at);
                outer.insert(outer.partition_point(|other| *other < chunk), chunk);
            }
        }
    }

    /// The pairs of particles that were inserted since the build, on all ranks, in their order.
    pub fn inserted(&self) -> Vec<[u32; 2]> {
        let mut pairs = self.team.concat(self.inserted.as_flattened()).as_chunks::<3>().0.to_vec();
        pairs.sort_unstable();
        pairs.dedup();
        pairs.iter().map(|[_, a, b]| [*a as u32, *b as u32]).collect()
    }
}
