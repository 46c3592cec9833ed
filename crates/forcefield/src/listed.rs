//! A Verlet list at work: positions packed into rows, validity checked before each use, pairs summed.

use std::time::Instant;

use glam::DVec3;
use lennard_core::parallel::for_each_piece;
use lennard_core::{ForceError, PeriodicBox, RestoreError, StateReader, StateWriter};
use lennard_neighbor::{
    Cells, Criterion, FIXED_UNITS, GridError, Images, Moves, NeighborList, SharedList, Verdict,
    misses_a_pair,
};

use crate::copies::{Copies, Fitness, Work};
use crate::pure::{self, Nearby, PureJob};
use crate::simd::{
    self, DoubleRow, FixedRow, Level, Motion, Moved, PairJob, PerParticle, SharedJob, Wanted,
};
use crate::sums::Totals;
use crate::truncation::PairForm;

/// Seconds spent, for the run record.
#[derive(Debug, Clone, Copy, Default)]
pub struct Clock {
    /// In pair loops.
    pub force: f64,
    /// In building lists.
    pub neighbor: f64,
}

/// A list with the private copies of the positions that its loop reads.
enum Pairs {
    /// The neighbors of each particle, for forces that are a pure function of the positions.
    Canonical(Box<NeighborList>, Folded),
    /// The neighbors of each particle.
    Rows(Box<NeighborList>, Copies<DoubleRow>),
    /// The neighbors of every four particles.
    Shared(Box<SharedList>, Copies<FixedRow>),
}

/// Folded positions, and sorted lists by particle.
#[derive(Default)]
struct Folded {
    wrapped: Vec<DVec3>,
    lists: Vec<Vec<u32>>,
}

/// A list with everything that belongs to it.
pub struct Listed {
    cell: PeriodicBox,
    r_cut: f64,
    /// What lists reach to, σ: r_cut, the skin, and what fixed point may be off by.
    radius: f64,
    level: Level,
    pairs: Pairs,
    criterion: Criterion,
    /// Positions of the build, by place; empty before the first.
    built: Vec<DVec3>,
}

/// Which loop a list feeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loop {
    /// Forces that are a pure function of the positions.
    Canonical,
    /// The neighbors of each particle, in double precision.
    Rows,
    /// The neighbors of every four particles, in mixed precision.
    Shared,
}

impl Listed {
    /// A list for `r_cut` and `skin` in σ.
    pub fn new(cell: PeriodicBox, r_cut: f64, skin: f64, level: Level, kind: Loop) -> Self {
        // Distances in fixed point are off by about the unit of the longest side.
        let rounding = match kind {
            Loop::Shared => {
                4.0 * cell.lengths().max_element() * f64::from(f32::EPSILON) / 256.0
                    + 4.0 * r_cut * f64::from(f32::EPSILON)
            }
            Loop::Rows | Loop::Canonical => 0.0,
        };
        let radius = r_cut + skin + rounding;
        let list = |images| Box::new(NeighborList::new(cell, radius, images, level.lanes()));
        let pairs = match kind {
            Loop::Canonical => Pairs::Canonical(list(Images::Folded), Folded::default()),
            Loop::Rows => Pairs::Rows(list(Images::Ghosts), Copies::default()),
            Loop::Shared => Pairs::Shared(
                Box::new(SharedList::new(cell, r_cut, radius)),
                Copies::default(),
            ),
        };
        Self {
            cell,
            r_cut,
            radius,
            level,
            pairs,
            criterion: Criterion::new(skin),
            built: Vec::new(),
        }
    }

    /// Lanes computed in one evaluation, which meets every pair from both of its ends.
    pub fn lanes(&self) -> u64 {
        match &self.pairs {
            Pairs::Canonical(list, _) | Pairs::Rows(list, _) => list.lanes_listed(),
            Pairs::Shared(list, _) => list.lanes(),
        }
    }

    /// Pairs listed, each counted once.
    pub fn listed_pairs(&self) -> u64 {
        match &self.pairs {
            Pairs::Canonical(list, _) | Pairs::Rows(list, _) => list.pairs(),
            Pairs::Shared(list, _) => list.pairs(),
        }
    }

    /// The particle at each place of the list's order.
    fn particles(&self) -> &[u32] {
        match &self.pairs {
            Pairs::Canonical(list, _) | Pairs::Rows(list, _) => &list.table().particle,
            Pairs::Shared(list, _) => &list.table().particle,
        }
    }

    /// The criterion with its counters.
    pub fn criterion(&self) -> &Criterion {
        &self.criterion
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        let pairs = match &self.pairs {
            Pairs::Canonical(list, folded) => list.bytes() + folded.bytes(),
            Pairs::Rows(list, copies) => list.bytes() + copies.bytes(),
            Pairs::Shared(list, copies) => list.bytes() + copies.bytes(),
        };
        (pairs + 24 * self.built.capacity()) as u64
    }

    /// Builds the list for `positions`.
    pub fn build(&mut self, positions: &[DVec3]) -> Result<(), ForceError> {
        // Half-built tables must not look valid.
        self.built.clear();
        let built = match &mut self.pairs {
            Pairs::Canonical(list, folded) => list
                .build(positions, self.level.scanner())
                .map(|()| folded.list(list)),
            Pairs::Rows(list, _) => list.build(positions, self.level.scanner()),
            Pairs::Shared(list, _) => list.build(positions, self.level.shared_scanner()),
        };
        built.map_err(
            |GridError::BadPosition { particle }| ForceError::NonFinitePosition { particle },
        )?;
        let mut built = std::mem::take(&mut self.built);
        let particles = self.particles();
        built.resize(particles.len(), DVec3::ZERO);
        for_each_piece(&mut built, |first, chunk| {
            for (built, particle) in chunk.iter_mut().zip(&particles[first..]) {
                *built = positions[*particle as usize];
            }
        });
        self.built = built;
        self.criterion.built();
        Ok(())
    }

    /// Writes forces (and `each`) at `positions` and returns the totals, which are those of `wanted`.
    pub fn evaluate<F: PairForm>(
        &mut self,
        form: F,
        positions: &[DVec3],
        wanted: Wanted,
        forces: &mut [DVec3],
        mut each: Option<&mut [PerParticle]>,
        clock: &mut Clock,
    ) -> Result<Totals, ForceError> {
        let start = Instant::now();
        let mut building = 0.0;
        let (mut fitness, mut totals, mut broken) = (Fitness::Stale, Totals::NOTHING, false);
        if self.built.len() == positions.len() {
            (fitness, totals, broken) =
                self.attempt(form, positions, wanted, forces, each.as_deref_mut());
        }
        if fitness == Fitness::Stale {
            let start = Instant::now();
            self.build(positions)?;
            building = start.elapsed().as_secs_f64();
            (fitness, totals, broken) = self.attempt(form, positions, wanted, forces, each);
        }
        clock.neighbor += building;
        clock.force += start.elapsed().as_secs_f64() - building;
        self.criterion.used(fitness == Fitness::Fit);
        if fitness == Fitness::Broken {
            return Err(not_finite(positions));
        }
        assert_eq!(fitness, Fitness::Fit, "a list is fit where it was built");
        if broken {
            return Err(not_finite_force(forces));
        }
        Ok(totals)
    }

    /// Judges the list at `positions` and evaluates where it is fit; gives totals and whether a force was not finite.
    fn attempt<F: PairForm>(
        &mut self,
        form: F,
        positions: &[DVec3],
        wanted: Wanted,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> (Fitness, Totals, bool) {
        let (cell, r_cut, level) = (&self.cell, self.r_cut, self.level);
        let motion = Motion {
            positions,
            built: &self.built,
            far2: self.criterion.far2(),
            lengths: cell.lengths(),
        };
        let judge = Judge {
            cell,
            radius: self.radius,
            criterion: &self.criterion,
            motion,
        };
        match &mut self.pairs {
            Pairs::Canonical(list, folded) => {
                let moved = folded.pack(cell, &list.table().particle, motion);
                let fitness = judge.fitness(list.table(), &moved);
                if fitness != Fitness::Fit {
                    return (fitness, Totals::NOTHING, false);
                }
                let job = PureJob {
                    form,
                    r_cut,
                    cell,
                    wrapped: &folded.wrapped,
                    nearby: Nearby::Listed(&folded.lists),
                };
                let chunks = job.run(forces, each);
                let broken = chunks.iter().any(|c| c.broken);
                (fitness, Totals::of_chunks(&chunks), broken)
            }
            Pairs::Rows(list, copies) => {
                let table = list.table();
                let job = PairJob::new(form, r_cut, list, forces, each);
                copies.run(&Work {
                    n: positions.len(),
                    rows: table.rows(),
                    chunks: list.chunks().len(),
                    wanted,
                    pack: &|by, rows| simd::pack_double(level, by, table, motion, rows),
                    judge: &|moved| judge.fitness(table, moved),
                    run: &|rows, c| simd::run_double(level, &job, rows, c, wanted),
                })
            }
            Pairs::Shared(list, copies) => {
                let table = list.table();
                let scale = (motion.lengths / FIXED_UNITS).to_array();
                let job = SharedJob::new(form, r_cut, scale, list, forces, each);
                copies.run(&Work {
                    n: positions.len(),
                    rows: positions.len(),
                    chunks: list.chunks().len(),
                    wanted,
                    pack: &|by, rows| simd::pack_columns(level, by, table, motion, rows),
                    judge: &|moved| judge.fitness(table, moved),
                    run: &|rows, c| simd::run_shared(level, &job, rows, c, wanted),
                })
            }
        }
    }

    /// Writes what a restart needs: the positions of the build.
    pub fn save(&self, to: &mut StateWriter<'_>) {
        let mut by_particle = vec![DVec3::ZERO; self.built.len()];
        for (particle, r) in self.particles().iter().zip(&self.built) {
            by_particle[*particle as usize] = *r;
        }
        to.put_vec3("built_at", &by_particle);
        let c = &self.criterion;
        to.put_u64("counters", &[c.builds(), c.late_builds()]);
    }

    /// Builds the list of the saved run again, from the positions that it was built at.
    pub fn restore(&mut self, from: &StateReader<'_>, n: usize) -> Result<(), RestoreError> {
        let built = from.vec3("built_at")?;
        if !built.is_empty() {
            if built.len() != n {
                return Err(
                    from.misfit("built_at", format!("{} particles, wanted {n}", built.len()))
                );
            }
            self.build(built)
                .map_err(|e| from.misfit("built_at", e.to_string()))?;
        } else {
            self.built.clear();
        }
        let [builds, late] = from.u64s("counters")?;
        self.criterion.set_counters(builds, late);
        Ok(())
    }
}

impl Folded {
    fn bytes(&self) -> usize {
        let lists = self.lists.iter().map(|l| 24 + 4 * l.capacity());
        24 * self.wrapped.capacity() + lists.sum::<usize>()
    }

    /// Takes over a list that was just built.
    fn list(&mut self, list: &NeighborList) {
        self.lists = list.neighbors();
        for list in &mut self.lists {
            list.dedup();
        }
    }

    /// Folds positions; gives the displacements since the build.
    fn pack(&mut self, cell: &PeriodicBox, particles: &[u32], motion: Motion<'_>) -> Moved {
        pure::wrap(cell, motion.positions, &mut self.wrapped);
        let moved = particles.iter().zip(motion.built);
        let squares: Vec<f64> = moved
            .map(|(particle, at)| (motion.positions[*particle as usize] - *at).length_squared())
            .collect();
        let mut moved = Moved::NOTHING;
        moved.include(0, &squares, motion.far2);
        moved
    }
}

/// Whether a list may be used.
struct Judge<'a> {
    cell: &'a PeriodicBox,
    /// What the list reaches to, σ.
    radius: f64,
    criterion: &'a Criterion,
    motion: Motion<'a>,
}

impl Judge<'_> {
    /// Whether the list, which was sorted into `cells`, names every pair that counts.
    fn fitness<C: Cells>(&self, cells: &C, moved: &Moved) -> Fitness {
        if !moved.finite {
            return Fitness::Broken;
        }
        let Motion {
            positions, built, ..
        } = self.motion;
        match self
            .criterion
            .check(moved.largest2, moved.far.len(), positions.len())
        {
            Verdict::Valid => Fitness::Fit,
            Verdict::Build => Fitness::Stale,
            Verdict::Doubtful => {
                // A last place more: no pair that counts may look as if it did not.
                let inner = (self.radius - self.criterion.skin()) * (1.0 + 1e-12);
                let moves = Moves {
                    cells,
                    positions,
                    built,
                };
                if misses_a_pair(self.cell, self.radius, inner, moves, &moved.far) {
                    Fitness::Stale
                } else {
                    Fitness::Fit
                }
            }
        }
    }
}

/// The error that names the first particle whose position is not finite.
pub fn not_finite(positions: &[DVec3]) -> ForceError {
    ForceError::NonFinitePosition {
        particle: positions
            .iter()
            .position(|r| !r.is_finite())
            .unwrap_or_default(),
    }
}

/// The error that names the first particle whose force is not finite.
pub fn not_finite_force(forces: &[DVec3]) -> ForceError {
    ForceError::NonFiniteForce {
        particle: forces
            .iter()
            .position(|f| !f.is_finite())
            .unwrap_or_default(),
    }
}
