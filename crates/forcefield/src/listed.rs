//! A Verlet list at work: positions packed into rows, validity checked before each use, pairs summed.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use glam::DVec3;
use lennard_core::parallel::for_each_chunk;
use lennard_core::tasks::{for_each_task, map_tasks};
use lennard_core::{ForceError, PeriodicBox, RestoreError, StateReader, StateWriter};
use lennard_neighbor::{
    Criterion, FIXED_UNITS, Far, GridError, Images, NeighborList, SharedList, Verdict,
    misses_a_pair,
};

use crate::pure::{self, Nearby, PureJob};
use crate::simd::{
    self, Built, ChunkTotals, DoubleRow, FixedRow, Level, Moved, PairJob, PerParticle, SharedJob,
    Wanted,
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

/// A list with the private copy of the positions that its loop reads.
enum Pairs {
    /// The neighbors of each particle.
    Rows(Box<NeighborList>, Rows),
    /// The neighbors of every four particles.
    Shared(Box<SharedList>, Vec<FixedRow>),
}

/// The private copy of the positions, by the list of each particle's neighbors.
enum Rows {
    Double(Vec<DoubleRow>),
    /// Canonical loop: folded positions and sorted lists by particle.
    Pure {
        wrapped: Vec<DVec3>,
        lists: Vec<Vec<u32>>,
    },
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
            Loop::Canonical => {
                let (wrapped, lists) = (Vec::new(), Vec::new());
                Pairs::Rows(list(Images::Folded), Rows::Pure { wrapped, lists })
            }
            Loop::Rows => Pairs::Rows(list(Images::Ghosts), Rows::Double(Vec::new())),
            Loop::Shared => Pairs::Shared(Box::new(SharedList::new(cell, radius)), Vec::new()),
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
            Pairs::Rows(list, _) => list.lanes_listed(),
            Pairs::Shared(list, _) => list.lanes(),
        }
    }

    /// Pairs listed, each counted once.
    pub fn listed_pairs(&self) -> u64 {
        match &self.pairs {
            Pairs::Rows(list, _) => list.pairs(),
            Pairs::Shared(list, _) => list.pairs(),
        }
    }

    /// The particle at each place of the list's order.
    fn particles(&self) -> &[u32] {
        match &self.pairs {
            Pairs::Rows(list, _) => &list.table().particle,
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
            Pairs::Rows(list, rows) => list.bytes() + rows.bytes(),
            Pairs::Shared(list, rows) => list.bytes() + rows.capacity() * size_of::<FixedRow>(),
        };
        (pairs + 24 * self.built.capacity()) as u64
    }

    /// Makes the list valid for `positions` and the rows hold them.
    fn prepare(&mut self, positions: &[DVec3], clock: &mut Clock) -> Result<(), ForceError> {
        let start = Instant::now();
        let mut moved = if self.built.len() == positions.len() {
            self.pack(positions)
        } else {
            Moved {
                largest2: f64::INFINITY,
                ..Moved::NOTHING
            }
        };
        if !moved.finite {
            return Err(not_finite(positions));
        }
        let mut valid = self.is_valid(&moved, positions);
        if !valid {
            let build_start = Instant::now();
            self.build(positions)?;
            clock.neighbor += build_start.elapsed().as_secs_f64();
            clock.force -= build_start.elapsed().as_secs_f64();
            moved = self.pack(positions);
            valid = self.is_valid(&moved, positions);
        }
        self.criterion.used(valid);
        clock.force += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Whether the list names every pair that counts at `positions`.
    fn is_valid(&self, moved: &Moved, positions: &[DVec3]) -> bool {
        match self.criterion.check(moved.largest2) {
            Verdict::Valid => true,
            Verdict::Build => false,
            Verdict::Doubtful => {
                let particles = self.particles();
                let far = |place: &u32| {
                    let at = positions[particles[*place as usize] as usize];
                    let moved = at - self.built[*place as usize];
                    Far { at, moved }
                };
                let far: Vec<Far> = moved.far.iter().map(far).collect();
                // A last place more: no pair that counts may look as if it did not.
                let inner = (self.radius - self.criterion.skin()) * (1.0 + 1e-12);
                !misses_a_pair(&self.cell, self.radius, inner, &far)
            }
        }
    }

    /// Builds the list for `positions`.
    pub fn build(&mut self, positions: &[DVec3]) -> Result<(), ForceError> {
        // Half-built tables must not look valid.
        self.built.clear();
        let built = match &mut self.pairs {
            Pairs::Rows(list, rows) => list
                .build(positions, self.level.scanner())
                .map(|()| rows.fit(list)),
            Pairs::Shared(list, rows) => list
                .build(positions, self.level.shared_scanner())
                .map(|()| rows.resize(positions.len(), FixedRow::default())),
        };
        built.map_err(
            |GridError::BadPosition { particle }| ForceError::NonFinitePosition { particle },
        )?;
        let mut built = std::mem::take(&mut self.built);
        let particles = self.particles();
        built.resize(particles.len(), DVec3::ZERO);
        for_each_chunk(&mut built, |first, chunk| {
            for (built, particle) in chunk.iter_mut().zip(&particles[first..]) {
                *built = positions[*particle as usize];
            }
        });
        self.built = built;
        self.criterion.built();
        Ok(())
    }

    /// Copies positions to the rows; gives the displacements since the build.
    fn pack(&mut self, positions: &[DVec3]) -> Moved {
        let built = Built {
            at: &self.built,
            far2: self.criterion.far2(),
        };
        match &mut self.pairs {
            Pairs::Rows(list, rows) => rows.pack(list, &self.cell, positions, built),
            Pairs::Shared(list, rows) => {
                let (table, lengths) = (list.table(), self.cell.lengths());
                simd::pack_columns(table, positions, built, lengths, rows)
            }
        }
    }

    /// Writes forces (and `each`) at `positions` and returns the totals, which are those of `wanted`.
    pub fn evaluate<F: PairForm>(
        &mut self,
        form: F,
        positions: &[DVec3],
        wanted: Wanted,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
        clock: &mut Clock,
    ) -> Result<Totals, ForceError> {
        self.prepare(positions, clock)?;
        let start = Instant::now();
        let (totals, broken) = match &mut self.pairs {
            Pairs::Rows(list, rows) => {
                let run = RowsRun {
                    cell: &self.cell,
                    r_cut: self.r_cut,
                    level: self.level,
                    list,
                };
                run.evaluate(rows, form, wanted, forces, each)
            }
            Pairs::Shared(list, rows) => {
                let (level, chunks) = (self.level, list.chunks().len());
                let scale = (self.cell.lengths() / FIXED_UNITS).to_array();
                let job = SharedJob::new(form, self.r_cut, scale, rows, list, forces, each);
                sum_chunks(chunks, wanted, &|c| {
                    simd::run_shared(level, &job, c, wanted)
                })
            }
        };
        clock.force += start.elapsed().as_secs_f64();
        if broken {
            return Err(not_finite_force(forces));
        }
        Ok(totals)
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

impl Rows {
    fn bytes(&self) -> usize {
        match self {
            Self::Double(rows) => rows.capacity() * size_of::<DoubleRow>(),
            Self::Pure { wrapped, lists } => {
                24 * wrapped.capacity() + lists.iter().map(|l| 24 + 4 * l.capacity()).sum::<usize>()
            }
        }
    }

    /// Makes room for what a list that was just built names.
    fn fit(&mut self, list: &NeighborList) {
        match self {
            Self::Double(rows) => rows.resize(list.table().rows(), DoubleRow::default()),
            Self::Pure { lists, .. } => {
                *lists = list.neighbors();
                for list in lists {
                    list.dedup();
                }
            }
        }
    }

    fn pack(
        &mut self,
        list: &NeighborList,
        cell: &PeriodicBox,
        positions: &[DVec3],
        built: Built<'_>,
    ) -> Moved {
        let (table, lengths) = (list.table(), cell.lengths());
        match self {
            Self::Double(rows) => simd::pack_double(table, positions, built, lengths, rows),
            Self::Pure { wrapped, .. } => {
                pure::wrap(cell, positions, wrapped);
                let mut moved = Moved::NOTHING;
                for (place, (particle, at)) in table.particle.iter().zip(built.at).enumerate() {
                    let displacement = positions[*particle as usize] - *at;
                    moved.include(place, displacement, built.far2);
                }
                moved
            }
        }
    }
}

/// What a loop over rows needs besides the rows.
struct RowsRun<'a> {
    cell: &'a PeriodicBox,
    r_cut: f64,
    level: Level,
    list: &'a NeighborList,
}

impl RowsRun<'_> {
    /// Forces, totals and whether a force is not finite.
    fn evaluate<F: PairForm>(
        &self,
        rows: &Rows,
        form: F,
        wanted: Wanted,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> (Totals, bool) {
        let (list, level) = (self.list, self.level);
        let chunks = list.chunks().len();
        match rows {
            Rows::Double(rows) => {
                let job = PairJob::new(form, self.r_cut, rows, list, forces, each);
                sum_chunks(chunks, wanted, &|c| {
                    simd::run_double(level, &job, c, wanted)
                })
            }
            Rows::Pure { wrapped, lists } => {
                let job = PureJob {
                    form,
                    r_cut: self.r_cut,
                    cell: self.cell,
                    wrapped,
                    nearby: Nearby::Listed(lists),
                };
                let chunks = job.run(forces, each);
                (Totals::of_chunks(&chunks), chunks.iter().any(|c| c.broken))
            }
        }
    }
}

/// Runs all chunks and adds their totals in order; whether a force was not finite comes second. One
/// instance for all potentials: the loop over chunks is not worth another.
fn sum_chunks(
    chunks: usize,
    wanted: Wanted,
    run: &(dyn Fn(usize) -> ChunkTotals + Sync),
) -> (Totals, bool) {
    if wanted == Wanted::Forces {
        let broken = AtomicBool::new(false);
        for_each_task(chunks, |c| {
            if run(c).broken {
                broken.store(true, Ordering::Relaxed);
            }
        });
        return (Totals::NOTHING, broken.into_inner());
    }
    let totals = map_tasks(chunks, run);
    (Totals::of_chunks(&totals), totals.iter().any(|c| c.broken))
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
