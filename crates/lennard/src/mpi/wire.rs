//! Messages between ranks by MPI.

use std::cell::Cell;

use lennard_core::{Parcel, Wire};
use mpi::Count;
use mpi::collective::SystemOperation;
use mpi::datatype::Equivalence;
use mpi::request::WaitGuard;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Destination, Source};

/// The most words of one message: MPI counts them in 32 bits.
const PIECE: usize = Count::MAX as usize;

thread_local! {
    /// Whether this thread has messages under way. MPI takes calls of one thread at a time: no other one may drive them.
    static IS_WAITING: Cell<bool> = const { Cell::new(false) };
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

/// Sends words to other ranks, does some work, and fills the room for the words that come.
fn pass<'a, T: Equivalence + 'a>(
    outgoing: impl Iterator<Item = (usize, &'a [T])>,
    incoming: impl Iterator<Item = (usize, &'a mut [T])>,
    meanwhile: &mut dyn FnMut(),
) {
    let world = SimpleCommunicator::world();
    mpi::request::scope(|scope| {
        let mut receiving = Vec::new();
        for (rank, room) in incoming {
            let from = world.process_at_rank(rank as i32);
            let pieces = room.chunks_mut(PIECE);
            receiving
                .extend(pieces.map(|p| WaitGuard::from(from.immediate_receive_into(scope, p))));
        }
        let mut sending = Vec::new();
        for (rank, words) in outgoing {
            let to = world.process_at_rank(rank as i32);
            let pieces = words.chunks(PIECE);
            sending.extend(pieces.map(|p| WaitGuard::from(to.immediate_send(scope, p))));
        }
        IS_WAITING.set(true);
        meanwhile();
        IS_WAITING.set(false);
        // Each guard waits where it is dropped.
        drop(receiving);
        drop(sending);
    });
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

    fn trade(&self, mut words: Vec<Vec<u64>>) -> Vec<Vec<u64>> {
        let lengths: Vec<u64> = words.iter().map(|list| list.len() as u64).collect();
        let mut coming = vec![0_u64; self.ranks];
        SimpleCommunicator::world().all_to_all_into(&lengths[..], &mut coming[..]);
        let own = std::mem::take(&mut words[self.rank]);
        coming[self.rank] = 0;
        let mut got: Vec<Vec<u64>> = coming.iter().map(|n| vec![0; *n as usize]).collect();
        let outgoing = words.iter().map(Vec::as_slice).enumerate();
        let incoming = got.iter_mut().map(Vec::as_mut_slice).enumerate();
        pass(outgoing, incoming, &mut || {});
        got[self.rank] = own;
        got
    }

    fn exchange(&self, outgoing: &[Parcel], incoming: &mut [Parcel], meanwhile: &mut dyn FnMut()) {
        let sent = outgoing.iter().map(|parcel| (parcel.rank, &parcel.words[..]));
        let room = incoming.iter_mut();
        let room = room.map(|parcel| (parcel.rank, &mut parcel.words[..]));
        pass(sent, room, meanwhile);
    }

    fn progress(&self) {
        if IS_WAITING.get() {
            // Any call moves all messages on. Above some kB, most libraries move nothing between calls.
            let _ = SimpleCommunicator::world().any_process().immediate_probe();
        }
    }

    fn abort(&self, code: u8) -> ! {
        SimpleCommunicator::world().abort(code.into())
    }
}
