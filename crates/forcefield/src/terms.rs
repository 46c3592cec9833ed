//! What holds for a list of any kind: the box, what it reaches to, and when it may be used.

use glam::DVec3;
use lennard_core::{ForceError, PeriodicBox};
use lennard_neighbor::{Criterion, Given, GridError, Moves, Verdict, Way, missed_pairs};

use crate::copies::{Copies, Fitness, Run, Use, Work};
use crate::simd::{Level, Motion, Moved, PairList, take};
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
    /// The places of pairs that were named since then, in this order.
    pub named: Vec<[u32; 2]>,
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
        self.named.clear();
        self.criterion.built();
        Ok(())
    }

    /// Names pairs that a list lacks; gives whether it can.
    pub fn name<P: PairList>(&mut self, list: &mut P, pairs: &[[u32; 2]]) -> bool {
        if P::TAKES_IN {
            pairs.iter().for_each(|pair| list.name(*pair));
            self.named.extend(pairs);
        }
        P::TAKES_IN
    }

    /// Packs rows of the positions that are `now`, σ, of which `order` says which belongs to each place, judges the list
    /// there, as far as that was not done, and runs its chunks where it is fit. Gives the totals, and whether a force was
    /// not finite.
    pub fn use_list<'p, P: PairList>(
        &self,
        (list, copies): (&P, &mut Copies<P::Row>),
        now: impl Fn() -> &'p [DVec3] + Sync,
        order: &[u32],
        used: Use,
        run: &Run<'_, P::Row>,
    ) -> (Fitness, Totals, bool) {
        let at = |place: u32| now()[order[place as usize] as usize];
        copies.run(&Work {
            n: order.len(),
            rows: list.rows(),
            chunks: list.chunks(),
            used,
            lasts: P::TAKES_IN,
            pack: &|by, rows, ways| {
                list.pack(self.level, by, self.motion(now(), order), rows, ways)
            },
            judge: &|moved, ways| self.fitness(list, moved, ways, at),
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

    /// Whether a list names every pair that counts where particles moved so, and these are their ways if they are known, and
    /// the one of each place is `at` it.
    pub fn fitness<P: PairList>(
        &self,
        list: &P,
        moved: &Moved,
        ways: Option<&[Way]>,
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
                    cells: list.cells(),
                    at,
                    built: &self.built,
                    ways,
                    largest2,
                };
                let mut missed = missed_pairs(&self.cell, self.radius, inner, moves, &moved.far);
                missed.retain(|pair| !list.names(*pair));
                if missed.is_empty() {
                    Fitness::Fit
                } else {
                    Fitness::Lacks(missed)
                }
            }
        }
    }
}
