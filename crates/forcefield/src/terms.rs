//! What holds for a list of any kind: the box, what it reaches to, and when it may be used.

use glam::DVec3;
use lennard_core::{ForceError, PeriodicBox};
use lennard_neighbor::{Cells, Criterion, Given, GridError, Moves, Verdict, misses_a_pair};

use crate::copies::{Copies, Fitness, Work};
use crate::simd::{ChunkTotals, Level, Motion, Moved, PairList, Wanted, take};
use crate::sums::Totals;

/// The terms on which a list is used.
pub struct Terms {
    /// The box.
    pub cell: PeriodicBox,
    /// The cutoff, σ.
    pub r_cut: f64,
    /// What lists reach to, σ: r_cut, the skin, and what fixed point may be off by.
    pub radius: f64,
    /// The loops that run.
    pub level: Level,
    /// When the list may be used.
    pub criterion: Criterion,
    /// Positions of the build, by place, σ; empty before the first.
    pub built: Vec<DVec3>,
}

impl Terms {
    /// Builds a list.
    pub fn build<P: PairList>(&mut self, list: &mut P, given: Given<'_>) -> Result<(), ForceError> {
        // Half-built tables must not look valid.
        let mut built = std::mem::take(&mut self.built);
        let done = list.build(self.level, given);
        done.map_err(
            |GridError::BadPosition { particle }| ForceError::NonFinitePosition { particle },
        )?;
        take(list.from(), given.positions(), &mut built);
        self.built = built;
        self.criterion.built();
        Ok(())
    }

    /// Packs rows of the positions that are `now`, σ, of which `order` says which belongs to each place, judges the list
    /// there, and runs its chunks where it is fit. Gives the totals, and whether a force was not finite.
    pub fn use_list<'p, P: PairList>(
        &self,
        (list, copies): (&P, &mut Copies<P::Row>),
        now: impl Fn() -> &'p [DVec3] + Sync,
        order: &[u32],
        wanted: Wanted,
        run: &(dyn Fn(&[P::Row], usize) -> ChunkTotals + Sync),
    ) -> (Fitness, Totals, bool) {
        let at = |place: u32| now()[order[place as usize] as usize];
        copies.run(&Work {
            n: order.len(),
            rows: list.rows(),
            chunks: list.chunks(),
            wanted,
            pack: &|by, rows| list.pack(self.level, by, self.motion(now(), order), rows),
            judge: &|moved| self.fitness(list.cells(), moved, at),
            run,
        })
    }

    /// How particles moved since the build: where they are, σ, and which of these positions belongs to each place.
    pub fn motion<'a>(&'a self, positions: &'a [DVec3], order: &'a [u32]) -> Motion<'a> {
        Motion {
            positions,
            order,
            built: &self.built,
            far2: self.criterion.far2(),
            lengths: self.cell.lengths(),
        }
    }

    /// Whether the list, which was sorted into `cells`, names every pair that counts where particles moved so and the one of
    /// each place is `at` it.
    pub fn fitness<C: Cells>(
        &self,
        cells: &C,
        moved: &Moved,
        at: impl Fn(u32) -> DVec3 + Sync,
    ) -> Fitness {
        if !moved.finite {
            return Fitness::Broken;
        }
        let (largest2, far) = (moved.largest2, moved.far.len());
        match self.criterion.check(largest2, far, self.built.len()) {
            Verdict::Valid => Fitness::Fit,
            Verdict::Build => Fitness::Stale,
            Verdict::Doubtful => {
                // A last place more: no pair that counts may look as if it did not.
                let inner = (self.radius - self.criterion.skin()) * (1.0 + 1e-12);
                let moves = Moves {
                    cells,
                    at,
                    built: &self.built,
                };
                if misses_a_pair(&self.cell, self.radius, inner, moves, &moved.far) {
                    Fitness::Stale
                } else {
                    Fitness::Fit
                }
            }
        }
    }
}
