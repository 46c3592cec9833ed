//! Messages between ranks by MPI.

use lennard_core::{Parcel, Wire};
use mpi::Count;
use mpi::collective::SystemOperation;
use mpi::datatype::{Partition, PartitionMut};
use mpi::request::WaitGuard;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Destination, Source};

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

    fn trade(&self, words: Vec<Vec<u64>>) -> Vec<Vec<u64>> {
        let world = SimpleCommunicator::world();
        let given: Vec<Count> = words.iter().map(|list| count(list.len())).collect();
        let mut got: Vec<Count> = vec![0; self.ranks];
        world.all_to_all_into(&given[..], &mut got[..]);
        let sent = words.concat();
        count(sent.len());
        let mut received = vec![0_u64; total(&got)];
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
