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
/// The most vectors of one message: MPI counts its numbers in 32 bits.
const PIECE: usize = Count::MAX as usize / 3;

/// A number of words as MPI counts it.
///
/// # Panics
/// Where one message cannot have so many, which ends all ranks.
fn count(words: usize) -> Count {
    Count::try_from(words).unwrap_or_else(|_| {
        panic!("{words} words between ranks: MPI counts at most {}", Count::MAX)
    })
}

/// All ranks that MPI has started.
pub struct World {
    rank: usize,
    ranks: usize,
}

impl World {
    /// The ranks of this program.
    pub fn new() -> Self {
        let world = SimpleCommunicator::world();
        Self { rank: world.rank() as usize, ranks: world.size() as usize }
    }
}

/// The lists that ranks give, one after another, where each may have another length.
fn all_of<T: Equivalence + Clone + Default>(world: &SimpleCommunicator, mine: &[T]) -> Vec<T> {
    let mut counts: Vec<Count> = vec![0; world.size() as usize];
    world.all_gather_into(&count(mine.len()), &mut counts[..]);
    let mut all = vec![T::default(); total(&counts)];
    let starts = starts_of(&counts);
    let mut parts = PartitionMut::new(&mut all[..], counts, starts);
    world.all_gather_varcount_into(mine, &mut parts);
    all
}

/// The number of words of all parts together, which MPI can count.
fn total(counts: &[Count]) -> usize {
    let words = counts.iter().map(|count| *count as usize).sum();
    count(words) as usize
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
        let given: Vec<Count> = words.iter().map(|list| count(list.len())).collect();
        let mut got: Vec<Count> = vec![0; self.ranks];
        world.all_to_all_into(&given[..], &mut got[..]);
        let sent = words.concat();
        count(sent.len());
        let mut received = vec![0_u32; total(&got)];
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
        if self.ranks > FEW_RANKS && array.len() <= PIECE {
            let mine = array[ranges[self.rank].clone()].to_vec();
            let counts: Vec<Count> = ranges.iter().map(|r| count(3 * r.len())).collect();
            let starts: Vec<Count> = ranges.iter().map(|r| count(3 * r.start)).collect();
            let mut parts = PartitionMut::new(array.as_flattened_mut(), counts, starts);
            world.all_gather_varcount_into(mine.as_flattened(), &mut parts);
            return;
        }
        let (before, rest) = array.split_at_mut(ranges[self.rank].start);
        let (own, behind) = rest.split_at_mut(ranges[self.rank].len());
        let own = &*own;
        let others = || (0..).zip(ranges).filter(|(rank, _)| *rank != self.rank);
        let mut rest = [before, behind];
        mpi::request::scope(|scope| {
            let mut running = Vec::with_capacity(2 * self.ranks);
            for (rank, range) in others() {
                let side = &mut rest[usize::from(rank > self.rank)];
                let part = side.split_off_mut(..range.len()).unwrap_or_default();
                let from = world.process_at_rank(rank as i32);
                for piece in part.chunks_mut(PIECE) {
                    let piece = piece.as_flattened_mut();
                    running.push(WaitGuard::from(from.immediate_receive_into(scope, piece)));
                }
            }
            let mut sending = Vec::with_capacity(self.ranks);
            for (rank, _) in others() {
                let to = world.process_at_rank(rank as i32);
                for piece in own.chunks(PIECE) {
                    let piece = piece.as_flattened();
                    sending.push(WaitGuard::from(to.immediate_send(scope, piece)));
                }
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
                for piece in parcel.vectors.chunks_mut(PIECE) {
                    let piece = piece.as_flattened_mut();
                    running.push(WaitGuard::from(from.immediate_receive_into(scope, piece)));
                }
            }
            let mut sending = Vec::with_capacity(outgoing.len());
            for parcel in outgoing {
                let to = world.process_at_rank(parcel.rank as i32);
                for piece in parcel.vectors.chunks(PIECE) {
                    let piece = piece.as_flattened();
                    sending.push(WaitGuard::from(to.immediate_send(scope, piece)));
                }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thousand_million_particles_are_counted_or_refused_and_never_wrapped() {
        // 3·PIECE numbers are the most that one message counts.
        assert_eq!(count(3 * PIECE), 2_147_483_646);
        assert_eq!(1_000_000_000_usize.div_ceil(PIECE), 2);
        assert_eq!(total(&[1 << 30, (1 << 30) - 1]), Count::MAX as usize);
        for refused in [|| count(3 * (PIECE + 1)) as usize, || total(&[1 << 30; 2])] {
            let panic = std::panic::catch_unwind(refused).unwrap_err();
            let words = panic.downcast_ref::<String>().unwrap();
            assert!(
                words.ends_with("words between ranks: MPI counts at most 2147483647"),
                "{words}"
            );
        }
    }
}
