//! Independent jobs side by side, with progress told from the calling thread.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use lennard_core::parallel;

/// Time between two looks at how far the jobs are.
const LOOK_EVERY: Duration = Duration::from_millis(200);
/// Time between two looks at whether a start is still wanted.
const STOP_EVERY: Duration = Duration::from_millis(50);

/// Runs `work` on every item, on all threads of the present pool, and returns the results in the order of the
/// items. After each item `done` is called on this thread with the share that is finished.
///
/// Each job sees a pool of a single thread: a small system is slower on two, and jobs must not wait for
/// each other. Which thread does which item changes nothing in the results.
pub(crate) fn side_by_side<I: Sync, R: Send>(
    items: &[I],
    work: impl Fn(&I) -> R + Sync,
    done: impl FnMut(f64),
) -> Vec<R> {
    side_by_side_on(rayon::current_num_threads(), items, work, done)
}

/// [`side_by_side`] on at most `threads` threads.
pub(crate) fn side_by_side_on<I: Sync, R: Send>(
    threads: usize,
    items: &[I],
    work: impl Fn(&I) -> R + Sync,
    mut done: impl FnMut(f64),
) -> Vec<R> {
    let on_one_thread = |_: usize, item: &I| match parallel::pool(1) {
        Ok(pool) => pool.install(|| work(item)),
        // Without a pool of its own the job runs as well, only on more threads.
        Err(_) => work(item),
    };
    let share = |finished: usize| done(finished as f64 / items.len() as f64);
    side_by_side_with(threads, items, on_one_thread, share)
}

/// Runs `work` on every item with at most so many workers, and returns the results in the order of the items. `work` is
/// given the number of its worker. `look` is called on this thread with the number of finished items, after each and
/// several times a second.
pub(crate) fn side_by_side_with<I: Sync, R: Send>(
    workers: usize,
    items: &[I],
    work: impl Fn(usize, &I) -> R + Sync,
    mut look: impl FnMut(usize),
) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<R>>> = items.iter().map(|_| Mutex::new(None)).collect();
    let (finish, finished) = mpsc::channel();
    std::thread::scope(|scope| {
        for worker in 0..workers.clamp(1, items.len().max(1)) {
            let finish = finish.clone();
            let (next, results, work) = (&next, &results, &work);
            scope.spawn(move || {
                while let Some((i, item)) = {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    items.get(i).map(|item| (i, item))
                } {
                    let result = work(worker, item);
                    if let Ok(mut slot) = results[i].lock() {
                        *slot = Some(result);
                    }
                    // The receiver lives until every sender is gone.
                    let _ = finish.send(());
                }
            });
        }
        drop(finish);
        let mut count = 0;
        loop {
            match finished.recv_timeout(LOOK_EVERY) {
                Ok(()) => count += 1,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            look(count);
        }
    });
    results.into_iter().filter_map(|slot| slot.into_inner().ok().flatten()).collect()
}

/// Does what may take long and writes nothing; `None` where `stop` is set meanwhile. The thread at work is then left alone,
/// since its start is not wanted any more.
pub(crate) fn unless_stopped<T: Send + 'static>(
    stop: &AtomicBool,
    start: impl FnOnce() -> T + Send + 'static,
) -> Option<T> {
    let (give, given) = mpsc::channel();
    std::thread::spawn(move || give.send(start()));
    loop {
        let value = given.recv_timeout(STOP_EVERY);
        if stop.load(Ordering::SeqCst) {
            return None;
        }
        match value {
            Ok(value) => return Some(value),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return None,
        }
    }
}

/// Takes how far a study is; the command line shows it as a bar.
pub trait Progress {
    /// `done`, from 0 to 1, of the whole study; `label` says what is at work.
    fn update(&mut self, label: &str, done: f64);
}

/// Shows no progress.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn update(&mut self, _label: &str, _done: f64) {}
}

/// A part of a study, from one share of the whole to another.
pub(crate) struct Part<'a> {
    whole: &'a mut dyn Progress,
    from: f64,
    to: f64,
}

impl<'a> Part<'a> {
    pub(crate) fn of(whole: &'a mut dyn Progress, from: f64, to: f64) -> Self {
        Self { whole, from, to }
    }
}

impl Progress for Part<'_> {
    fn update(&mut self, label: &str, done: f64) {
        self.whole.update(label, self.from + (self.to - self.from) * done);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_keep_the_order_and_progress_reaches_the_end() {
        let items: Vec<u64> = (0..50).collect();
        let mut last = 0.0;
        let squares = side_by_side(&items, |i| i * i, |share| last = share);
        assert_eq!(squares, items.iter().map(|i| i * i).collect::<Vec<_>>());
        assert_eq!(last, 1.0);
        assert!(side_by_side(&[] as &[u64], |i| *i, |_| {}).is_empty());
    }
}
