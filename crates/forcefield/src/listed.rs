//! A Verlet list at work: positions packed into rows, validity checked before each use, pairs summed.

use std::time::Instant;

use glam::DVec3;
use lennard_core::parallel::for_each_chunk;
use lennard_core::{ForceError, PeriodicBox, RestoreError, StateReader, StateWriter};
use lennard_neighbor::{Criterion, GridError, Images, NeighborList, Verdict};
use rayon::prelude::*;

use crate::options::Precision;
use crate::pure::{self, Nearby, PureJob};
use crate::simd::{
    self, ChunkTotals, DoubleRow, FIXED_UNITS, FixedRow, Level, Moved, PairJob, PerParticle, Wanted,
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

/// The private copy of the positions that the loop reads.
enum Rows {
    Double(Vec<DoubleRow>),
    Fixed(Vec<FixedRow>),
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
    level: Level,
    list: NeighborList,
    criterion: Criterion,
    rows: Rows,
    /// Positions of the build, by place; empty before the first.
    built: Vec<DVec3>,
}

impl Listed {
    /// A list for `r_cut` and `skin` in σ; `pure` asks for the canonical loop.
    pub fn new(
        cell: PeriodicBox,
        n_atoms: usize,
        r_cut: f64,
        skin: f64,
        level: Level,
        precision: Precision,
        pure: bool,
    ) -> Self {
        let (rows, images) = match precision {
            _ if pure => (
                Rows::Pure {
                    wrapped: Vec::new(),
                    lists: Vec::new(),
                },
                Images::Folded,
            ),
            Precision::Double => (Rows::Double(Vec::new()), Images::Ghosts),
            // Wrap-around finds images, so ghosts would only cost; but where particles are more than 16 bits
            // can number, ghosts keep the neighbors of a chunk close together.
            Precision::Mixed if n_atoms <= usize::from(u16::MAX) + 1 => {
                (Rows::Fixed(Vec::new()), Images::Folded)
            }
            Precision::Mixed => (Rows::Fixed(Vec::new()), Images::Ghosts),
        };
        // Distances in fixed point are off by about the unit of the longest side.
        let rounding = match precision {
            Precision::Mixed => {
                4.0 * cell.lengths().max_element() * f64::from(f32::EPSILON) / 256.0
                    + 4.0 * r_cut * f64::from(f32::EPSILON)
            }
            Precision::Double => 0.0,
        };
        let radius = r_cut + skin + rounding;
        Self {
            cell,
            r_cut,
            level,
            list: NeighborList::new(cell, radius, images, level.lanes(precision)),
            criterion: Criterion::new(skin),
            rows,
            built: Vec::new(),
        }
    }

    /// The list.
    pub fn list(&self) -> &NeighborList {
        &self.list
    }

    /// The criterion with its counters.
    pub fn criterion(&self) -> &Criterion {
        &self.criterion
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        let rows = match &self.rows {
            Rows::Double(rows) => rows.capacity() * size_of::<DoubleRow>(),
            Rows::Fixed(rows) => rows.capacity() * size_of::<FixedRow>(),
            Rows::Pure { wrapped, lists } => {
                24 * wrapped.capacity() + lists.iter().map(|l| 24 + 4 * l.capacity()).sum::<usize>()
            }
        };
        (rows + self.list.bytes() + 24 * self.built.capacity()) as u64
    }

    /// Makes the list valid for `positions` and the rows hold them.
    fn prepare(&mut self, positions: &[DVec3], clock: &mut Clock) -> Result<(), ForceError> {
        let start = Instant::now();
        let mut moved = if self.built.len() == positions.len() {
            self.pack(positions)
        } else {
            Moved {
                largest2: f64::INFINITY,
                finite: true,
            }
        };
        if !moved.finite {
            return Err(not_finite(positions));
        }
        if self.criterion.check(moved.largest2) == Verdict::Build {
            let build_start = Instant::now();
            self.build(positions)?;
            clock.neighbor += build_start.elapsed().as_secs_f64();
            clock.force -= build_start.elapsed().as_secs_f64();
            moved = self.pack(positions);
        }
        self.criterion.used(moved.largest2);
        clock.force += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Builds the list for `positions`.
    pub fn build(&mut self, positions: &[DVec3]) -> Result<(), ForceError> {
        // Half-built tables must not look valid.
        self.built.clear();
        self.list.build(positions, self.level.scanner()).map_err(
            |GridError::BadPosition { particle }| ForceError::NonFinitePosition { particle },
        )?;
        let table = self.list.table();
        self.built.resize(table.particle.len(), DVec3::ZERO);
        for_each_chunk(&mut self.built, |first, chunk| {
            for (built, particle) in chunk.iter_mut().zip(&table.particle[first..]) {
                *built = positions[*particle as usize];
            }
        });
        match &mut self.rows {
            Rows::Double(rows) => rows.resize(table.rows(), DoubleRow::default()),
            Rows::Fixed(rows) => rows.resize(self.list.targets(), FixedRow::default()),
            Rows::Pure { lists, .. } => {
                *lists = self.list.neighbors();
                for list in lists {
                    list.dedup();
                }
            }
        }
        self.criterion.built();
        Ok(())
    }

    /// Copies positions to the rows; gives the largest displacement since the build.
    fn pack(&mut self, positions: &[DVec3]) -> Moved {
        let table = self.list.table();
        let lengths = self.cell.lengths();
        match &mut self.rows {
            Rows::Double(rows) => simd::pack_double(table, positions, &self.built, lengths, rows),
            Rows::Fixed(rows) => simd::pack_fixed(
                table,
                self.list.images(),
                positions,
                &self.built,
                lengths,
                rows,
            ),
            Rows::Pure { wrapped, .. } => {
                pure::wrap(&self.cell, positions, wrapped);
                let mut moved = Moved::NOTHING;
                for (particle, built) in table.particle.iter().zip(&self.built) {
                    moved.include(positions[*particle as usize] - *built);
                }
                moved
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
        let chunks = self.list.chunks().len();
        let scale = (self.cell.lengths() / FIXED_UNITS).to_array();
        let (totals, broken) = match &self.rows {
            Rows::Double(rows) => {
                let job = PairJob::new(form, self.r_cut, [1.0; 3], rows, &self.list, forces, each);
                sum_chunks(chunks, wanted, |c| {
                    simd::run_double(self.level, &job, c, wanted)
                })
            }
            Rows::Fixed(rows) => {
                let job = PairJob::new(form, self.r_cut, scale, rows, &self.list, forces, each);
                sum_chunks(chunks, wanted, |c| {
                    simd::run_mixed(self.level, &job, c, wanted)
                })
            }
            Rows::Pure { wrapped, lists } => {
                let job = PureJob {
                    form,
                    r_cut: self.r_cut,
                    cell: &self.cell,
                    wrapped,
                    nearby: Nearby::Listed(lists),
                };
                let chunks = job.run(forces, each);
                (Totals::of_chunks(&chunks), chunks.iter().any(|c| c.broken))
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
        for (particle, r) in self.list.table().particle.iter().zip(&self.built) {
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

/// Runs all chunks and adds their totals in order; whether a force was not finite comes second.
fn sum_chunks(
    chunks: usize,
    wanted: Wanted,
    run: impl Fn(usize) -> ChunkTotals + Sync,
) -> (Totals, bool) {
    let serial = rayon::current_num_threads() == 1 || chunks <= 1;
    if wanted == Wanted::Forces {
        let broken = if serial {
            (0..chunks).fold(false, |broken, c| broken | run(c).broken)
        } else {
            (0..chunks)
                .into_par_iter()
                .map(|c| run(c).broken)
                .reduce(|| false, |a, b| a | b)
        };
        return (Totals::NOTHING, broken);
    }
    let totals: Vec<ChunkTotals> = if serial {
        (0..chunks).map(run).collect()
    } else {
        (0..chunks).into_par_iter().map(&run).collect()
    };
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
