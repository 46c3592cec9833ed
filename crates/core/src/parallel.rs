//! Work over particles, with results that never depend on the number of threads.
//!
//! Element-wise work gives the same bits however it is cut, so each thread has its share. Sums are exact
//! ([`crate::exact`]).

use std::ops::Range;

use std::sync::atomic::{AtomicBool, AtomicU8, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use crate::tasks::{for_each_item, for_each_task, map_tasks};

/// Particles of a piece of work, at most.
pub const CHUNK: usize = 2048;

/// Fewest particles that are worth a task of element-wise work.
const FEWEST: usize = 128;

/// Particles a task of element-wise work over `n`: two tasks a thread of a small system.
fn piece(n: usize) -> usize {
    n.div_ceil(2 * rayon::current_num_threads()).clamp(FEWEST, CHUNK)
}

/// The `k`th of the ranges of `size` that make up `0..n`; the last one may be shorter.
#[must_use]
pub fn part(k: usize, size: usize, n: usize) -> Range<usize> {
    k * size..((k + 1) * size).min(n)
}

/// So many ranges that make up `0..n`, one after another, as equal as can be.
#[must_use]
pub fn equal_parts(n: usize, parts: usize) -> Vec<Range<usize>> {
    let begin = |part: usize| n * part / parts;
    (0..parts).map(|k| begin(k)..begin(k + 1)).collect()
}

/// Processors that this process may use; 1 where the system does not say.
#[must_use]
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// The most threads of a pool for each processor: more would only take turns.
const MOST_PER_PROCESSOR: usize = 4;
/// Threads that a pool may have on any machine, so that the same command runs on small ones.
const ON_ANY_MACHINE: usize = 16;

/// The most threads that [`pool`] starts: four for each processor, and sixteen where those are fewer.
#[must_use]
pub fn most_threads() -> usize {
    (MOST_PER_PROCESSOR * processors()).max(ON_ANY_MACHINE)
}

/// Why there is no pool of so many threads.
#[derive(Debug, thiserror::Error)]
pub enum PoolError {
    /// No thread, or more than could ever help.
    #[error(
        "{0} threads\n  allowed: 1 to {most} on {processors} processors",
        most = most_threads(),
        processors = processors()
    )]
    Number(usize),
    /// The system gives none.
    #[error(transparent)]
    System(#[from] rayon::ThreadPoolBuildError),
}

/// Refuses a number of threads that [`pool`] does not start.
///
/// # Errors
/// [`PoolError::Number`] for no thread and for more than [`most_threads`].
pub fn can_have(threads: usize) -> Result<(), PoolError> {
    if (1..=most_threads()).contains(&threads) { Ok(()) } else { Err(PoolError::Number(threads)) }
}

/// A pool of so many threads.
///
/// # Errors
/// [`PoolError`] for no thread and for more than [`most_threads`], and where the system gives no threads.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool, PoolError> {
    can_have(threads)?;
    Ok(rayon::ThreadPoolBuilder::new().num_threads(threads).build()?)
}

/// Looks for work that a waiting thread makes before it offers its processor to others.
const LOOKS: u32 = 200;

/// How long the work waits for the other threads of its pool. A thread that is busy elsewhere stays there.
const GATHERING: Duration = Duration::from_millis(20);

/// What the threads of a pool that is kept awake are told.
const GATHER: u8 = 0;
const BEGUN: u8 = 1;
const DONE: u8 = 2;

/// Runs `work` on the current pool while its other threads stay awake.
///
/// A step of a thousand particles takes some tens of microseconds, and waking a thread that sleeps takes
/// as long. A pool that falls asleep between parallel sections never gets to help. The price is that
/// waiting threads look for work all the time. Results do not depend on it.
///
/// Work begins when the other threads wait. A thread that comes later does not wait: it could stand inside a part of
/// the work, and the work would never end.
pub fn awake<T>(work: impl FnOnce() -> T) -> T {
    /// Sends the other threads home also where `work` panics.
    struct Done<'a>(&'a AtomicU8);
    impl Drop for Done<'_> {
        fn drop(&mut self) {
            self.0.store(DONE, Ordering::Release);
        }
    }
    let threads = rayon::current_num_threads();
    let Some(me) = rayon::current_thread_index() else {
        return work();
    };
    if threads == 1 {
        return work();
    }
    let (stage, waiting) = (AtomicU8::new(GATHER), AtomicUsize::new(0));
    rayon::in_place_scope(|scope| {
        scope.spawn_broadcast(|_, thread| {
            if thread.index() != me && stage.load(Ordering::Acquire) == GATHER {
                waiting.fetch_add(1, Ordering::Release);
                look_for_work(|| stage.load(Ordering::Acquire) == DONE);
            }
        });
        let _done = Done(&stage);
        let since = Instant::now();
        while waiting.load(Ordering::Acquire) < threads - 1 && since.elapsed() < GATHERING {
            std::thread::yield_now();
        }
        stage.store(BEGUN, Ordering::Release);
        work()
    })
}

/// Helps with whatever work the pool has until `done`.
fn look_for_work(done: impl Fn() -> bool) {
    let mut looks = 0;
    while !done() {
        if rayon::yield_now() == Some(rayon::Yield::Executed) {
            looks = 0;
        } else if looks < LOOKS {
            looks += 1;
            std::hint::spin_loop();
        } else {
            looks = 0;
            std::thread::yield_now();
        }
    }
}

/// Whether `check` holds for each range of some that make up `0..n`; all are looked at.
pub fn all_pieces<F>(n: usize, check: F) -> bool
where
    F: Fn(Range<usize>) -> bool + Sync,
{
    let holds = AtomicBool::new(true);
    for_each_range(n, |range| {
        if !check(range) {
            holds.store(false, Ordering::Relaxed);
        }
    });
    holds.into_inner()
}

/// Runs `work` for each range of some that make up `0..n`, in any order: for element-wise work.
pub fn for_each_range(n: usize, work: impl Fn(Range<usize>) + Sync) {
    let size = piece(n);
    for_each_task(n.div_ceil(size), |(): &mut (), t| work(part(t, size, n)));
}

/// What `work` gives for each range of some that make up `0..n`, each of [`CHUNK`] particles at most, in their order.
///
/// The number of ranges depends on the number of threads.
pub fn map_ranges<R: Send>(n: usize, work: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
    let size = piece(n);
    map_tasks(n.div_ceil(size), |(): &mut (), t| work(part(t, size, n)))
}

/// Runs `work(first_index, piece)` over pieces of `items`, which may have any size: for element-wise work.
pub fn for_each_piece<T, F>(items: &mut [T], work: F)
where
    T: Send,
    F: Fn(usize, &mut [T]) + Sync,
{
    let size = piece(items.len());
    for_each_item(items.chunks_mut(size), |(), k, piece| {
        work(k * size, piece);
    });
}

/// Runs `work(first_index, piece_a, piece_b)` over pieces of two arrays of the same length; as [`for_each_piece`].
///
/// # Panics
/// Where the lengths differ: that is a bug of the caller.
pub fn for_each_piece_pair<A, B, F>(a: &mut [A], b: &mut [B], work: F)
where
    A: Send,
    B: Send,
    F: Fn(usize, &mut [A], &mut [B]) + Sync,
{
    assert_eq!(a.len(), b.len(), "both arrays hold one item per particle");
    let size = piece(a.len());
    let pieces = a.chunks_mut(size).zip(b.chunks_mut(size));
    for_each_item(pieces, |(), k, (x, y)| work(k * size, x, y));
}

/// Runs `work(first_index, piece_a, piece_b, piece_c)` over pieces of three arrays of the same length; as
/// [`for_each_piece`].
///
/// # Panics
/// As [`for_each_piece_pair`].
pub fn for_each_piece_of_three<A, B, C, F>(a: &mut [A], b: &mut [B], c: &mut [C], work: F)
where
    A: Send,
    B: Send,
    C: Send,
    F: Fn(usize, &mut [A], &mut [B], &mut [C]) + Sync,
{
    assert!(a.len() == b.len() && b.len() == c.len(), "all arrays hold one item per particle");
    let size = piece(a.len());
    let rest = b.chunks_mut(size).zip(c.chunks_mut(size));
    let pieces = a.chunks_mut(size).zip(rest);
    for_each_item(pieces, |(), k, (x, (y, z))| work(k * size, x, y, z));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::exact_sum;

    #[test]
    fn a_pool_has_no_more_threads_than_a_few_for_each_processor() {
        for threads in [1, 2, most_threads()] {
            assert_eq!(pool(threads).unwrap().current_num_threads(), threads);
        }
        for threads in [0, most_threads() + 1, usize::MAX] {
            assert!(matches!(pool(threads), Err(PoolError::Number(n)) if n == threads));
        }
    }

    #[test]
    fn a_pool_that_is_kept_awake_computes_the_same_and_ends_with_its_work() {
        let values: Vec<f64> = (0..50_000).map(|i| f64::from(i).sqrt()).collect();
        let sum = || exact_sum(values.len(), |i| values[i]);
        let outside = awake(sum);
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let inside = pool.install(|| awake(|| (0..100).map(|_| sum()).next_back().unwrap()));
            assert_eq!(inside.to_bits(), outside.to_bits());
            // A panic inside leaves no thread behind that keeps looking.
            let caught = pool
                .install(|| std::panic::catch_unwind(|| awake(|| panic!("on purpose"))).is_err());
            assert!(caught);
        }
    }

    /// A thread that runs a part of the work may meet its own call to wait there. Work would wait for the part, and the
    /// part for the end of the work.
    #[test]
    fn a_thread_that_is_late_does_not_wait_inside_the_work() {
        let (ended, end) = std::sync::mpsc::channel();
        std::thread::spawn(move || {
            let pool = pool(2).unwrap();
            let (busy, begun, left) =
                (AtomicBool::new(false), AtomicBool::new(false), AtomicBool::new(false));
            let wait_for = |flag: &AtomicBool| {
                while !flag.load(Ordering::Acquire) {
                    std::thread::yield_now();
                }
            };
            pool.in_place_scope(|scope| {
                scope.spawn(|_| {
                    busy.store(true, Ordering::Release);
                    wait_for(&begun);
                    while rayon::yield_now() == Some(rayon::Yield::Executed) {}
                    left.store(true, Ordering::Release);
                });
                wait_for(&busy);
                scope.spawn(|_| {
                    awake(|| {
                        begun.store(true, Ordering::Release);
                        wait_for(&left);
                    });
                });
            });
            ended.send(()).unwrap();
        });
        let hang = Duration::from_secs(60);
        end.recv_timeout(hang).expect("the late thread leaves the work");
    }
}
