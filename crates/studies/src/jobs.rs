//! Independent jobs side by side, one thread each, with progress told from the calling thread.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

use lennard_core::parallel;

use crate::StudyError;

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

/// [`side_by_side`] without progress.
pub(crate) fn side_by_side_quietly<I: Sync, R: Send>(
    items: &[I],
    work: impl Fn(&I) -> R + Sync,
) -> Vec<R> {
    side_by_side(items, work, |_| {})
}

/// [`side_by_side`] on at most `threads` threads.
pub(crate) fn side_by_side_on<I: Sync, R: Send>(
    threads: usize,
    items: &[I],
    work: impl Fn(&I) -> R + Sync,
    mut done: impl FnMut(f64),
) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<R>>> = items.iter().map(|_| Mutex::new(None)).collect();
    let threads = threads.clamp(1, items.len().max(1));
    let (tell, told) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..threads {
            let tell = tell.clone();
            let (next, results, work) = (&next, &results, &work);
            scope.spawn(move || {
                let run = || {
                    while let Some((i, item)) = {
                        let i = next.fetch_add(1, Ordering::Relaxed);
                        items.get(i).map(|item| (i, item))
                    } {
                        let result = work(item);
                        if let Ok(mut slot) = results[i].lock() {
                            *slot = Some(result);
                        }
                        // The receiver lives until every sender is gone.
                        let _ = tell.send(());
                    }
                };
                match pool(1) {
                    Ok(pool) => pool.install(run),
                    // Without a pool of its own the job runs as well, only on more threads.
                    Err(_) => run(),
                }
            });
        }
        drop(tell);
        for finished in 1..=items.len() {
            if told.recv().is_err() {
                break;
            }
            done(finished as f64 / items.len() as f64);
        }
    });
    results.into_iter().filter_map(|slot| slot.into_inner().ok().flatten()).collect()
}

/// A pool of `threads` threads.
pub(crate) fn pool(threads: usize) -> Result<rayon::ThreadPool, StudyError> {
    Ok(parallel::pool(threads)?)
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
