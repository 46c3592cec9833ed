//! Tasks that have a home: each thread first takes the tasks of its own share, the same at every call, and then helps
//! others.
//!
//! At the next step, what a thread wrote is still in its own processor's cache. A step of a thousand particles is short:
//! fetching data from another cache costs as much as a second thread saves.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// How often a thread without work checks whether the others are done: for some tens of microseconds. After that the
/// pool waits, and soon sends the thread to sleep.
const LOOKS: u32 = 1000;

/// Whether one thread does so many tasks as well as several: there is no other, or nothing for it.
fn is_for_one_thread(n: usize) -> bool {
    n <= 1 || rayon::current_num_threads() == 1
}

/// Runs `task(scratch, 0)`, …, `task(scratch, n − 1)` on the current pool, in any order, each thread with a scratch of
/// its own.
pub fn for_each_task<S: Default>(n: usize, task: impl Fn(&mut S, usize) + Sync) {
    if is_for_one_thread(n) {
        let mut scratch = S::default();
        (0..n).for_each(|index| task(&mut scratch, index));
        return;
    }
    let threads = rayon::current_num_threads().min(n);
    Team {
        shares: Share::all(n, threads),
        at_work: AtomicUsize::new(0),
        caller: rayon::current_thread_index(),
        task,
    }
    .spread(threads);
}

/// What `task(scratch, index)` gives for 0 to n − 1, in that order, each thread with a scratch of its own.
pub fn map_tasks<S: Default, R: Send>(
    n: usize,
    task: impl Fn(&mut S, usize) -> R + Sync,
) -> Vec<R> {
    map_items(0..n, |scratch, _, index| task(scratch, index))
}

/// What `work(scratch, index, item)` gives for each item, in their order, each thread with a scratch of its own.
pub fn map_items<S: Default, T: Send, R: Send>(
    items: impl ExactSizeIterator<Item = T>,
    work: impl Fn(&mut S, usize, T) -> R + Sync,
) -> Vec<R> {
    if is_for_one_thread(items.len()) {
        let mut scratch = S::default();
        let items = items.enumerate();
        return items.map(|(i, item)| work(&mut scratch, i, item)).collect();
    }
    let mut found: Vec<Option<R>> = (0..items.len()).map(|_| None).collect();
    for_each_item(items.zip(&mut found), |scratch, i, (item, slot)| {
        *slot = Some(work(scratch, i, item));
    });
    found.into_iter().flatten().collect()
}

/// Runs `work(scratch, index, item)` over items, in any order, each thread with a scratch of its own.
pub fn for_each_item<S: Default, T: Send>(
    items: impl ExactSizeIterator<Item = T>,
    work: impl Fn(&mut S, usize, T) + Sync,
) {
    if is_for_one_thread(items.len()) {
        let mut scratch = S::default();
        items.enumerate().for_each(|(index, item)| work(&mut scratch, index, item));
        return;
    }
    // No thread ever waits at a lock: each item is taken once.
    let items: Vec<Mutex<Option<T>>> = items.map(|item| Mutex::new(Some(item))).collect();
    for_each_task(items.len(), |scratch, index| {
        let mut item = items[index].lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(item) = item.take() {
            work(scratch, index, item);
        }
    });
}

/// The threads that share tasks.
struct Team<F> {
    shares: Vec<Share>,
    /// Threads that look for tasks, or run one.
    at_work: AtomicUsize,
    /// The thread that waits for all tasks.
    caller: Option<usize>,
    task: F,
}

impl<F> Team<F> {
    /// Sends so many threads to work. Those that come late find nothing left to do.
    fn spread<S: Default>(&self, threads: usize)
    where
        F: Fn(&mut S, usize) + Sync,
    {
        if threads == 1 {
            self.work();
        } else {
            let left = threads / 2;
            rayon::join(|| self.spread(left), || self.spread(threads - left));
        }
    }

    fn work<S: Default>(&self)
    where
        F: Fn(&mut S, usize) + Sync,
    {
        self.at_work.fetch_add(1, Ordering::Relaxed);
        let me = rayon::current_thread_index();
        let home = me.unwrap_or(0) % self.shares.len();
        let mut scratch = S::default();
        while let Some(index) = self.shares[home].take_first() {
            (self.task)(&mut scratch, index);
        }
        // Others begin at their first.
        let (before, after) = self.shares.split_at(home);
        for share in after.iter().chain(before).skip(1) {
            while let Some(index) = share.take_last() {
                (self.task)(&mut scratch, index);
            }
        }
        self.at_work.fetch_sub(1, Ordering::Release);
        if me == self.caller {
            for _ in 0..LOOKS {
                if self.at_work.load(Ordering::Acquire) == 0 {
                    break;
                }
                std::hint::spin_loop();
            }
        }
    }
}

/// The tasks that belong to one thread, first and end in the two halves; on a cache line (and its neighbor) of its own.
#[repr(align(128))]
struct Share(AtomicU64);

impl Share {
    /// Tasks `0..n` in so many shares of equal size, more or less.
    fn all(n: usize, shares: usize) -> Vec<Self> {
        let begin = |share: usize| (n * share / shares) as u64;
        (0..shares).map(|s| Self(AtomicU64::new(begin(s) << 32 | begin(s + 1)))).collect()
    }

    fn take_first(&self) -> Option<usize> {
        self.take(|first, end| ((first + 1, end), first))
    }

    fn take_last(&self) -> Option<usize> {
        self.take(|first, end| ((first, end - 1), end - 1))
    }

    /// Takes a task, given what is left without it.
    fn take(&self, choose: impl Fn(u64, u64) -> ((u64, u64), u64)) -> Option<usize> {
        let mut all = self.0.load(Ordering::Relaxed);
        loop {
            let (first, end) = (all >> 32, all & u64::from(u32::MAX));
            if first >= end {
                return None;
            }
            let ((first, end), taken) = choose(first, end);
            match self.0.compare_exchange_weak(
                all,
                first << 32 | end,
                Ordering::Relaxed,
                Ordering::Relaxed,
            ) {
                Ok(_) => return Some(taken as usize),
                Err(found) => all = found,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pools() -> impl Iterator<Item = rayon::ThreadPool> {
        [1, 2, 3, 8]
            .into_iter()
            .map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap())
    }

    #[test]
    fn every_task_runs_once_on_any_number_of_threads() {
        for pool in pools() {
            for n in [0, 1, 2, 3, 7, 100, 1001] {
                let runs: Vec<AtomicUsize> = (0..n).map(|_| AtomicUsize::new(0)).collect();
                pool.install(|| {
                    for_each_task(n, |(), index| {
                        runs[index].fetch_add(1, Ordering::Relaxed);
                    });
                });
                assert!(runs.iter().all(|r| r.load(Ordering::Relaxed) == 1));
                let found = pool.install(|| map_tasks(n, |(), index| 3 * index));
                assert_eq!(found, (0..n).map(|i| 3 * i).collect::<Vec<_>>());
                let mut items = vec![0; n];
                pool.install(|| for_each_item(items.iter_mut(), |(), i, item| *item += i + 1));
                assert_eq!(items, (1..=n).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn a_scratch_belongs_to_one_thread() {
        for pool in pools() {
            let most = AtomicUsize::new(0);
            pool.install(|| {
                for_each_task(100, |seen: &mut Vec<usize>, index| {
                    seen.push(index);
                    most.fetch_max(seen.len(), Ordering::Relaxed);
                });
            });
            assert!(most.into_inner() >= 100_usize.div_ceil(pool.current_num_threads()));
        }
    }

    #[test]
    fn a_share_is_taken_from_both_ends_until_nothing_is_left() {
        let shares = Share::all(10, 3);
        let all: Vec<usize> = shares
            .iter()
            .flat_map(|s| [s.take_first(), s.take_last(), s.take_first()])
            .flatten()
            .collect();
        assert_eq!(all, [0, 2, 1, 3, 5, 4, 6, 9, 7]);
        assert_eq!(shares[2].take_last(), Some(8));
        assert!(shares.iter().all(|s| s.take_first().is_none()));
    }

    #[test]
    fn a_task_that_panics_is_not_lost() {
        for pool in pools() {
            let tasks = || for_each_task(20, |(), index| assert_ne!(index, 13));
            let caught = pool.install(|| std::panic::catch_unwind(tasks));
            assert!(caught.is_err());
        }
    }
}
