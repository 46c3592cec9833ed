//! What the ranks of one run do together.
//!
//! A *rank* is a process, or a thread that plays one. It keeps the particles of some consecutive numbers, and computes the
//! forces in a part of space. Whatever all ranks decide, they decide by the same numbers at the same place of the program.
//!
//! A [`Wire`] carries messages, and knows nothing of physics. A [`Team`] is a wire with what this program asks of it.
//!
//! ```text
//!   Wire    sum, max, trade, exchange, abort    MPI, or channels between threads
//!   Team    the same, timed; shares of work; flags; halos
//! ```

mod testing;

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crate::parallel::equal_parts;

pub use testing::team_of_threads;

/// Words for a rank, or from one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Parcel {
    /// The other rank.
    pub rank: usize,
    /// What goes there, or came from there.
    pub words: Vec<u32>,
}

/// Messages between ranks. Every rank calls the same functions in the same order, from one thread at a time.
///
/// A message that cannot arrive ends the process, or panics: no rank can go on alone.
pub trait Wire: Send + Sync {
    /// The number of this rank, from 0.
    fn rank(&self) -> usize;

    /// The number of ranks.
    fn ranks(&self) -> usize;

    /// Makes each word the sum of this word over all ranks.
    fn sum(&self, words: &mut [i64]);

    /// Makes each word the largest of this word over all ranks.
    fn max(&self, words: &mut [u64]);

    /// Gives the `k`th list of words to rank `k`; returns the lists that the ranks gave to this one.
    fn trade(&self, words: Vec<Vec<u64>>) -> Vec<Vec<u64>>;

    /// Sends words to other ranks, does some work, and fills `incoming`, whose parcels have their final lengths.
    fn exchange(&self, outgoing: &[Parcel], incoming: &mut [Parcel], meanwhile: &mut dyn FnMut());

    /// Moves messages of an exchange on. Work beside the exchange calls it often, from any thread; it acts on the thread that
    /// called the exchange alone. The default does nothing.
    fn progress(&self) {}

    /// Ends all ranks with an exit code. The default panics, and other ranks then meet a closed wire.
    fn abort(&self, code: u8) -> ! {
        panic!("rank {} ends all ranks with code {code}", self.rank())
    }
}

/// What a team did so far.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TeamStatistics {
    /// Seconds in which this rank waited for messages or moved them.
    pub seconds: f64,
    /// Particles of other ranks that the lists of this rank might name, as a mean over its builds.
    pub halo: f64,
}

/// More ranks than parts that can be shared out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "{ranks} ranks for {particles} particles\n  allowed: at most {most} in this box, since each rank owns a bundle of columns with {least} particles or more"
)]
pub struct TooManyRanks {
    /// The number of ranks.
    pub ranks: usize,
    /// The number of particles.
    pub particles: usize,
    /// The particles of the smallest part.
    pub least: usize,
    /// The largest number of ranks.
    pub most: usize,
}

/// The ranks of one run, as one of them sees the others. A clone is the same team.
#[derive(Clone)]
pub struct Team(Arc<Shared>);

struct Shared {
    wire: Box<dyn Wire>,
    nanoseconds: AtomicU64,
    /// Sum of halos, and their number.
    halos: [AtomicU64; 2],
}

impl Team {
    /// A team whose ranks are connected by a wire.
    #[must_use]
    pub fn new(wire: Box<dyn Wire>) -> Self {
        Self(Arc::new(Shared { wire, nanoseconds: AtomicU64::new(0), halos: Default::default() }))
    }

    /// The number of this rank, from 0.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.0.wire.rank()
    }

    /// The number of ranks.
    #[must_use]
    pub fn ranks(&self) -> usize {
        self.0.wire.ranks()
    }

    /// Whether this rank writes files and prints.
    #[must_use]
    pub fn leads(&self) -> bool {
        self.rank() == 0
    }

    /// The parts of `0..n` that the ranks take, one after another, as equal as can be.
    #[must_use]
    pub fn shares(&self, n: usize) -> Vec<Range<usize>> {
        equal_parts(n, self.ranks())
    }

    /// Makes each word the sum of this word over all ranks.
    pub fn sum(&self, words: &mut [i64]) {
        self.timed(|wire| wire.sum(words));
    }

    /// Makes each word the largest of this word over all ranks.
    pub fn max(&self, words: &mut [u64]) {
        self.timed(|wire| wire.max(words));
    }

    /// Whether something is true on any rank.
    #[must_use]
    pub fn any(&self, flag: bool) -> bool {
        let mut word = [u64::from(flag)];
        self.max(&mut word);
        word != [0]
    }

    /// The numbers of the particles, of `n`, that this rank keeps.
    #[must_use]
    pub fn numbers(&self, n: usize) -> Range<usize> {
        self.shares(n).swap_remove(self.rank())
    }

    /// The words of all ranks, one rank after another; each may give another number of words.
    #[must_use]
    pub fn concat(&self, words: &[u64]) -> Vec<u64> {
        self.trade(vec![words.to_vec(); self.ranks()]).concat()
    }

    /// The lowest rank whose words differ from the words of rank 0; `None` where all are equal.
    #[must_use]
    pub fn first_that_differs(&self, words: &[u64]) -> Option<usize> {
        let all = self.concat(words);
        if all.len() != self.ranks() * words.len() {
            return Some(self.ranks() - 1);
        }
        let words_of = |rank: usize| &all[rank * words.len()..(rank + 1) * words.len()];
        (0..self.ranks()).find(|rank| words_of(*rank) != words_of(0))
    }

    /// Gives the `k`th list of words to rank `k`; returns the lists that the ranks gave to this one.
    #[must_use]
    pub fn trade(&self, words: Vec<Vec<u64>>) -> Vec<Vec<u64>> {
        self.timed(|wire| wire.trade(words))
    }

    /// Sends words to other ranks, does some work, and fills `incoming`, whose parcels have their final lengths.
    pub fn exchange(
        &self,
        outgoing: &[Parcel],
        incoming: &mut [Parcel],
        meanwhile: &mut dyn FnMut(),
    ) {
        let mut at_work = 0;
        self.timed(|wire| {
            wire.exchange(outgoing, incoming, &mut || {
                let start = Instant::now();
                meanwhile();
                at_work = start.elapsed().as_nanos() as u64;
            });
        });
        self.0.nanoseconds.fetch_sub(at_work, Ordering::Relaxed);
    }

    /// Moves messages of an exchange on; work beside it calls this often, from any thread.
    pub fn progress(&self) {
        self.0.wire.progress();
    }

    /// Ends all ranks with an exit code.
    pub fn abort(&self, code: u8) -> ! {
        self.0.wire.abort(code)
    }

    /// Notes how many particles of other ranks the lists of this rank may name.
    pub fn note_halo(&self, particles: usize) {
        let [sum, count] = &self.0.halos;
        sum.fetch_add(particles as u64, Ordering::Relaxed);
        count.fetch_add(1, Ordering::Relaxed);
    }

    /// What this rank did so far.
    #[must_use]
    pub fn statistics(&self) -> TeamStatistics {
        let [sum, count] = [0, 1].map(|k| self.0.halos[k].load(Ordering::Relaxed) as f64);
        TeamStatistics {
            seconds: self.0.nanoseconds.load(Ordering::Relaxed) as f64 * 1e-9,
            halo: if count > 0.0 { sum / count } else { 0.0 },
        }
    }

    fn timed<R>(&self, work: impl FnOnce(&dyn Wire) -> R) -> R {
        let start = Instant::now();
        let done = work(self.0.wire.as_ref());
        let spent = start.elapsed().as_nanos() as u64;
        self.0.nanoseconds.fetch_add(spent, Ordering::Relaxed);
        done
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::{exact_sum, exact_sum_over};

    #[test]
    fn ranks_sum_and_choose_and_concatenate_alike() {
        for ranks in 1..5 {
            let found = team_of_threads(ranks, |team| {
                let rank = team.rank();
                let mut sums = [rank as i64, -1];
                team.sum(&mut sums);
                let mut largest = [rank as u64, 7 - rank as u64];
                team.max(&mut largest);
                let all = team.concat(&vec![rank as u64; rank]);
                let flags = [team.any(false), team.any(rank + 1 == ranks)];
                let differs = team.first_that_differs(&[3, u64::from(rank > 1)]);
                (sums, largest, all, flags, differs)
            });
            let expected = (
                [(ranks * (ranks - 1) / 2) as i64, -(ranks as i64)],
                [ranks as u64 - 1, 7],
                (0..ranks).flat_map(|r| vec![r as u64; r]).collect::<Vec<_>>(),
                [false, true],
                (ranks > 2).then_some(2),
            );
            assert!(found.iter().all(|f| *f == expected), "{found:?}");
        }
    }

    #[test]
    fn halos_arrive_while_work_is_done() {
        for ranks in 1..5 {
            team_of_threads(ranks, |team| {
                let shares = team.shares(10);
                assert_eq!(team.numbers(10), shares[team.rank()]);
                // Each rank wants the first element of each other rank.
                let others = || (0..ranks).filter(|rank| *rank != team.rank());
                let wants = (0..ranks).map(|r| match r == team.rank() {
                    true => Vec::new(),
                    false => vec![shares[r].start as u64],
                });
                let given = team.trade(wants.collect());
                let parcel = |rank: usize| Parcel {
                    rank,
                    words: given[rank].iter().map(|k| *k as u32).collect(),
                };
                let outgoing: Vec<Parcel> = others().map(parcel).collect();
                let empty = |rank| Parcel { rank, words: vec![u32::MAX] };
                let mut incoming: Vec<Parcel> = others().map(empty).collect();
                let mut worked = 0;
                team.exchange(&outgoing, &mut incoming, &mut || worked += 1);
                assert_eq!(worked, 1);
                for parcel in incoming {
                    assert_eq!(parcel.words, [shares[parcel.rank].start as u32]);
                }
            });
        }
    }

    #[test]
    fn a_sum_over_ranks_is_the_sum_of_one_rank_to_the_bit() {
        let term = |k: usize| ((k * k) as f64).sin() * 10_f64.powi((k % 300) as i32 - 150);
        let n = 1000;
        let alone: [f64; 2] = exact_sum(n, |k| [term(k), -term(k)]);
        for ranks in 1..5 {
            let found: Vec<[f64; 2]> = team_of_threads(ranks, |team| {
                let mine = team.shares(n)[team.rank()].clone();
                exact_sum_over(Some(&team), mine.len(), |k| {
                    let x = term(mine.start + k);
                    [x, -x]
                })
            });
            for sums in found {
                assert_eq!(sums.map(f64::to_bits), alone.map(f64::to_bits));
            }
            let infinite = team_of_threads(ranks, |team| {
                let x = if team.rank() == 0 { f64::INFINITY } else { 1.0 };
                exact_sum_over(Some(&team), 1, |_| x)
            });
            assert!(infinite.iter().all(|x| *x == f64::INFINITY));
        }
    }

    #[test]
    fn the_time_of_work_during_an_exchange_is_no_communication() {
        let spent = team_of_threads(2, |team| {
            let nap = std::time::Duration::from_millis(200);
            team.exchange(&[], &mut [], &mut || std::thread::sleep(nap));
            team.note_halo(3);
            team.note_halo(4);
            team.statistics()
        });
        for statistics in spent {
            assert!(statistics.seconds < 0.1, "{statistics:?}");
            assert_eq!(statistics.halo, 3.5);
        }
    }
}
