//! How the threads of a sweep are shared out among its points.

/// From this number of particles on, a point takes threads that are left over. In smaller systems, threads wait
/// for each other longer than they compute.
const LARGE: usize = 4000;

/// Points at work at once.
#[must_use]
pub fn workers(points: usize, threads: usize) -> usize {
    threads.clamp(1, points.max(1))
}

/// Threads for a point of `atoms` particles that worker number `worker` of `workers` runs: one, or for a large point
/// its share of all threads. Threads that are left over go to the first workers. The number of threads changes no bit
/// of the results.
pub(super) fn threads_of(worker: usize, workers: usize, threads: usize, atoms: usize) -> usize {
    if atoms < LARGE {
        return 1;
    }
    threads.max(1) / workers + usize::from(worker < threads % workers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_left_over_go_to_large_points_and_every_thread_has_work() {
        for (points, threads) in [(3, 8), (8, 8), (38, 2), (1, 4), (5, 1)] {
            let n = workers(points, threads);
            assert!(n <= points && n <= threads);
            let large: usize = (0..n).map(|w| threads_of(w, n, threads, 32_000)).sum();
            assert_eq!(large, threads);
            assert!((0..n).all(|w| threads_of(w, n, threads, 864) == 1));
        }
        assert_eq!((0..3).map(|w| threads_of(w, 3, 8, 32_000)).collect::<Vec<_>>(), [3, 3, 2]);
        // A sweep with nothing to run still has one worker.
        assert_eq!(workers(0, 4), 1);
    }
}
