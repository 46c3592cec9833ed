//! Messages between ranks by MPI.

use std::ops::Range;

use lennard_core::{Parcel, Wire};
use mpi::Count;
use mpi::collective::SystemOperation;
use mpi::datatype::{Partition, PartitionMut};
use mpi::request::WaitGuard;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Destination, Equivalence, Source};

/// Ranks up to which each sends its part of an array to each other one, which copies no vector besides.
const FEW_RANKS: usize = 8;

/// All ranks that MPI has started.
pub struct World {
    rank: usize,
    ranks: usize,
}

impl World {
    /// The ranks of this program.
    pub fn new() -> Self {
        let world = SimpleCommunicator::world();
        Self {
            rank: world.rank() as usize,
            ranks: world.size() as usize,
        }
    }
}

/// The lists that ranks give, one after another, where each may have another length.
fn all_of<T: Equivalence + Clone + Default>(world: &SimpleCommunicator, mine: &[T]) -> Vec<T> {
    let mut counts: Vec<Count> = vec![0; world.size() as usize];
    world.all_gather_into(&(mine.len() as Count), &mut counts[..]);
    let mut all = vec![T::default(); counts.iter().sum::<Count>() as usize];
    let starts = starts_of(&counts);
    let mut parts = PartitionMut::new(&mut all[..], counts, starts);
    world.all_gather_varcount_into(mine, &mut parts);
    all
}

/// Where each part begins, if one follows another.
fn starts_of(counts: &[Count]) -> Vec<Count> {
    let mut end = 0;
    let start = |count: &Count| {
        end += count;
        end - count
    };
    counts.iter().map(start).collect()
}

impl Wire for World {
    fn rank(&self) -> usize {
        self.rank
    }

    fn ranks(&self) -> usize {
        self.ranks
    }

    fn sum(&self, words: &mut [i64]) {
        let mine = words.to_vec();
        SimpleCommunicator::world().all_reduce_into(&mine[..], words, SystemOperation::sum());
    }

    fn max(&self, words: &mut [u64]) {
        let mine = words.to_vec();
        SimpleCommunicator::world().all_reduce_into(&mine[..], words, SystemOperation::max());
    }

    fn concat(&self, words: &[u64]) -> Vec<u64> {
        all_of(&SimpleCommunicator::world(), words)
    }

    fn trade(&self, words: Vec<Vec<u32>>) -> Vec<Vec<u32>> {
        let world = SimpleCommunicator::world();
        let given: Vec<Count> = words.iter().map(|list| list.len() as Count).collect();
        let mut got: Vec<Count> = vec![0; self.ranks];
        world.all_to_all_into(&given[..], &mut got[..]);
        let sent = words.concat();
        let mut received = vec![0_u32; got.iter().sum::<Count>() as usize];
        let starts = starts_of(&given);
        let outgoing = Partition::new(&sent[..], given, starts);
        let starts = starts_of(&got);
        let mut incoming = PartitionMut::new(&mut received[..], &got[..], starts);
        world.all_to_all_varcount_into(&outgoing, &mut incoming);
        let mut rest = &received[..];
        let list = |count: &Count| {
            let (list, others) = rest.split_at(*count as usize);
            rest = others;
            list.to_vec()
        };
        got.iter().map(list).collect()
    }

    fn gather(&self, array: &mut [[f64; 3]], ranges: &[Range<usize>]) {
        let world = SimpleCommunicator::world();
        if self.ranks > FEW_RANKS {
            let mine = array[ranges[self.rank].clone()].to_vec();
            let counts: Vec<Count> = ranges.iter().map(|r| 3 * r.len() as Count).collect();
            let starts: Vec<Count> = ranges.iter().map(|r| 3 * r.start as Count).collect();
            let mut parts = PartitionMut::new(array.as_flattened_mut(), counts, starts);
            world.all_gather_varcount_into(mine.as_flattened(), &mut parts);
            return;
        }
        let (before, rest) = array.split_at_mut(ranges[self.rank].start);
        let (own, behind) = rest.split_at_mut(ranges[self.rank].len());
        let own = own.as_flattened();
        let others = || (0..).zip(ranges).filter(|(rank, _)| *rank != self.rank);
        let mut rest = [before, behind];
        mpi::request::scope(|scope| {
            let mut running = Vec::with_capacity(2 * self.ranks);
            for (rank, range) in others() {
                let side = &mut rest[usize::from(rank > self.rank)];
                let part = side.split_off_mut(..range.len()).unwrap_or_default();
                let from = world.process_at_rank(rank as i32);
                let part = part.as_flattened_mut();
                running.push(WaitGuard::from(from.immediate_receive_into(scope, part)));
            }
            let mut sending = Vec::with_capacity(self.ranks);
            for (rank, _) in others() {
                let to = world.process_at_rank(rank as i32);
                sending.push(WaitGuard::from(to.immediate_send(scope, own)));
            }
            // Each guard waits where it is dropped.
            drop(running);
            drop(sending);
        });
    }

    fn exchange(&self, outgoing: &[Parcel], incoming: &mut [Parcel], meanwhile: &mut dyn FnMut()) {
        let world = SimpleCommunicator::world();
        mpi::request::scope(|scope| {
            let mut running = Vec::with_capacity(outgoing.len() + incoming.len());
            for parcel in incoming {
                let from = world.process_at_rank(parcel.rank as i32);
                let vectors = parcel.vectors.as_flattened_mut();
                running.push(WaitGuard::from(from.immediate_receive_into(scope, vectors)));
            }
            let mut sending = Vec::with_capacity(outgoing.len());
            for parcel in outgoing {
                let to = world.process_at_rank(parcel.rank as i32);
                let vectors = parcel.vectors.as_flattened();
                sending.push(WaitGuard::from(to.immediate_send(scope, vectors)));
            }
            meanwhile();
            // Each guard waits where it is dropped.
            drop(running);
            drop(sending);
        });
    }

    fn abort(&self, code: u8) -> ! {
        SimpleCommunicator::world().abort(code.into())
    }
}
