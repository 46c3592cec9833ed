//! The points of a chart at work: measured side by side, then timed one after the other. Each is stored as soon as it is known.

use std::sync::atomic::Ordering;
use std::sync::{Mutex, MutexGuard, PoisonError};

use lennard_core::stopwatch::{in_turn, shuffled};
use lennard_scene::Scene;

use super::point::Charted;
use super::store::Store;
use super::{ChartError, ChartOptions, Plan};
use crate::jobs::{pool, side_by_side_on};
use crate::{Progress, StudyError};

/// All points of a chart, with what decides how they are worked on.
pub(super) struct Workshop<'a, P> {
    points: Vec<Mutex<P>>,
    store: &'a Store,
    options: &'a ChartOptions<'a>,
    plan: &'a Plan,
    seed: u64,
    /// Share of all work that is done when every point is measured, for the progress.
    measured_share: f64,
}

impl<'a, P: Charted> Workshop<'a, P> {
    /// These points, with what is stored of each.
    pub(super) fn new(
        fresh: impl Iterator<Item = P>,
        scene: &Scene,
        store: &'a Store,
        options: &'a ChartOptions<'a>,
        plan: &'a Plan,
        measured_share: f64,
    ) -> Self {
        Self {
            points: fresh.map(|fresh| Mutex::new(store.load(&fresh).unwrap_or(fresh))).collect(),
            store,
            options,
            plan,
            seed: scene.system.seed,
            measured_share,
        }
    }

    /// Measures what is not measured yet, side by side, in a shuffled order. `doing` names it for the progress.
    pub(super) fn measure(
        &self,
        doing: &str,
        progress: &mut dyn Progress,
        work: impl Fn(&mut P) -> Result<(), StudyError> + Sync,
    ) -> Result<(), ChartError> {
        let order = shuffled(self.points.len(), self.seed, usize::MAX).into_iter();
        let waiting: Vec<usize> = order.filter(|i| !self.slot(*i).is_measured()).collect();
        let measured: Vec<Result<(), ChartError>> = side_by_side_on(
            self.options.workers,
            &waiting,
            |i| {
                if self.is_stopped() {
                    return Ok(());
                }
                let mut point = self.slot(*i);
                work(&mut point)?;
                self.store.save(&*point)
            },
            |share| progress.update(doing, self.measured_share * share),
        );
        measured.into_iter().collect()
    }

    /// Times what is not timed often enough, one after the other, each round in another order.
    pub(super) fn time(
        &self,
        progress: &mut dyn Progress,
        work: impl Fn(&mut P) -> Result<(), StudyError> + Sync,
    ) -> Result<(), ChartError> {
        let pool = pool(self.plan.threads)?;
        in_turn(self.points.len(), self.plan.repeats, self.seed, |turn| {
            let mut point = self.slot(turn.item);
            if self.is_stopped() || point.is_timed(turn.round + 1) {
                return Ok(());
            }
            let timed = &mut *point;
            pool.install(|| work(timed))?;
            self.store.save(&*point)?;
            let left = 1.0 - self.measured_share;
            progress.update("timing", self.measured_share + left * turn.done);
            Ok(())
        })
    }

    /// The points, and whether all of them are finished.
    pub(super) fn close(self) -> (Vec<P>, bool) {
        let points: Vec<P> = (self.points.into_iter())
            .map(|p| p.into_inner().unwrap_or_else(PoisonError::into_inner))
            .collect();
        let repeats = self.plan.repeats;
        let finished = points.iter().all(|p| p.is_measured() && p.is_timed(repeats));
        (points, finished)
    }

    fn slot(&self, i: usize) -> MutexGuard<'_, P> {
        self.points[i].lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_stopped(&self) -> bool {
        self.options.stop.load(Ordering::Relaxed)
    }
}
