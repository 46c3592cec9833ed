//! Timing for studies and plans: two clocks, the spread of repeated times, and blocks in shuffled turns.
//!
//! No time decides anything about a run: times change from call to call, and results do not.

use std::time::{Duration, Instant};

use rand::seq::SliceRandom;
use serde::Serialize;

use lennard_core::random::Streams;

/// Repeats whose range is above this share of their median were disturbed: the machine was busy.
pub const BUSY: f64 = 0.2;

/// A clock on the wall, and the time that the calling thread really had a processor.
#[derive(Debug, Clone, Copy)]
pub struct Stopwatch {
    wall: Instant,
    on_processor: Option<f64>,
}

impl Stopwatch {
    /// A stopwatch that starts now.
    #[must_use]
    pub fn start() -> Self {
        Self { on_processor: seconds_on_processor(), wall: Instant::now() }
    }

    /// Seconds on the wall.
    #[must_use]
    pub fn wall(&self) -> f64 {
        self.wall.elapsed().as_secs_f64()
    }

    /// Seconds that this thread was on a processor: on a shared machine a steadier measure.
    /// Seconds on the wall where the system does not tell.
    #[must_use]
    pub fn on_processor(&self) -> f64 {
        match (self.on_processor, seconds_on_processor()) {
            (Some(before), Some(now)) => now - before,
            _ => self.wall(),
        }
    }

    /// Whether [`Stopwatch::on_processor`] is what its name says.
    #[must_use]
    pub fn tells_processor_time() -> bool {
        seconds_on_processor().is_some()
    }
}

#[cfg(target_os = "linux")]
fn seconds_on_processor() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
}

#[cfg(not(target_os = "linux"))]
fn seconds_on_processor() -> Option<f64> {
    None
}

/// Seconds on the wall that a call takes, and what it returns.
pub fn timed<R>(call: impl FnOnce() -> R) -> (f64, R) {
    let watch = Stopwatch::start();
    let result = call();
    (watch.wall(), result)
}

/// Seconds on the wall of one call: repeats until `budget` is spent, at least one and at most `most`.
#[must_use]
pub fn repeated(budget: Duration, most: usize, mut call: impl FnMut()) -> Spread {
    let all = Stopwatch::start();
    let mut seconds = vec![timed(&mut call).0];
    while seconds.len() < most && all.wall() < budget.as_secs_f64() {
        seconds.push(timed(&mut call).0);
    }
    Spread::of_some(seconds)
}

/// Median and range of repeated measurements.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// The middle value; the mean of the two in the middle where their number is even.
    pub median: f64,
    /// The smallest value.
    pub lowest: f64,
    /// The largest value.
    pub highest: f64,
    /// How many values there are.
    #[serde(skip)]
    pub repeats: usize,
}

impl Spread {
    /// The spread of these values; `None` where there is none.
    #[must_use]
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.into_iter().collect();
        (!values.is_empty()).then(|| Self::of_some(values))
    }

    fn of_some(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let n = values.len();
        Self {
            median: 0.5 * (values[(n - 1) / 2] + values[n / 2]),
            lowest: values[0],
            highest: values[n - 1],
            repeats: n,
        }
    }

    /// The same measurement in another unit; `factor` is above 0.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            median: self.median * factor,
            lowest: self.lowest * factor,
            highest: self.highest * factor,
            ..self
        }
    }

    /// The range over the median.
    #[must_use]
    pub fn scatter(self) -> f64 {
        (self.highest - self.lowest) / self.median.abs()
    }

    /// Whether the range is so wide that the machine was busy.
    #[must_use]
    pub fn is_scattered(self) -> bool {
        self.scatter() > BUSY
    }

    /// Half the range.
    #[must_use]
    pub fn half_range(self) -> f64 {
        0.5 * (self.highest - self.lowest)
    }
}

/// One turn of an item in a round of blocks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// The item, from 0.
    pub item: usize,
    /// The round, from 0.
    pub round: usize,
    /// Share of all turns that came before.
    pub done: f64,
}

/// Calls `work` once in each round for each of `items`, in an order that `seed` and the round shuffle.
///
/// A machine that slows down then slows every item down, and no item always comes first.
///
/// # Errors
/// The first error of `work`, which ends the rounds.
pub fn in_turn<E>(
    items: usize,
    rounds: usize,
    seed: u64,
    mut work: impl FnMut(Turn) -> Result<(), E>,
) -> Result<(), E> {
    for round in 0..rounds {
        for (k, item) in shuffled(items, seed, round).into_iter().enumerate() {
            let done = (round * items + k) as f64 / (rounds * items) as f64;
            work(Turn { item, round, done })?;
        }
    }
    Ok(())
}

/// The numbers from 0 to `n` − 1 in an order that seed and round decide.
#[must_use]
pub fn shuffled(n: usize, seed: u64, round: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    let mut random = Streams::new(seed).sequential(&format!("order-{round}"));
    order.shuffle(&mut random);
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_lies_in_the_middle_and_the_range_at_the_ends() {
        let spread = Spread::of([3.0, 1.0, 2.0, 10.0]).unwrap();
        assert_eq!(
            (spread.lowest, spread.median, spread.highest, spread.repeats),
            (1.0, 2.5, 10.0, 4)
        );
        assert_eq!(spread.scaled(2.0).half_range(), 9.0);
        assert!(Spread::of([]).is_none());
        // A fifth of the median is what a quiet machine may differ by.
        assert!(!Spread::of([0.100, 0.105, 0.120]).unwrap().is_scattered());
        assert!(Spread::of([0.100, 0.105, 0.122]).unwrap().is_scattered());
    }

    #[test]
    fn every_item_has_one_turn_in_each_round_and_the_order_is_shuffled() {
        let mut turns = Vec::new();
        let take = |turn| {
            turns.push(turn);
            Ok::<(), ()>(())
        };
        in_turn(50, 2, 1, take).unwrap();
        let order = |round: usize| -> Vec<usize> {
            let of_round = turns.iter().filter(|t: &&Turn| t.round == round);
            of_round.map(|t| t.item).collect()
        };
        assert_ne!(order(0), order(1));
        assert_eq!(order(1), shuffled(50, 1, 1));
        for round in 0..2 {
            let mut sorted = order(round);
            sorted.sort_unstable();
            assert_eq!(sorted, (0..50).collect::<Vec<_>>());
        }
        assert_eq!((turns[0].done, turns[75].done), (0.0, 0.75));
        let mut count = 0;
        let stopped = in_turn(5, 3, 1, |turn| {
            count += 1;
            if turn.done > 0.5 { Err("enough") } else { Ok(()) }
        });
        assert_eq!((stopped, count), (Err("enough"), 9));
    }

    #[test]
    fn a_call_is_repeated_at_least_once_and_at_most_as_often_as_asked() {
        let mut calls = 0;
        let one = repeated(Duration::ZERO, 9, || calls += 1);
        assert_eq!((one.repeats, calls), (1, 1));
        let nine = repeated(Duration::MAX, 9, || calls += 1);
        assert_eq!((nine.repeats, calls), (9, 10));
        assert!(nine.lowest >= 0.0);
    }
}
