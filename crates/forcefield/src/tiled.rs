//! A half list of tiles at work: positions packed into clusters, forces collected from all chunks.

use glam::DVec3;
use lennard_core::PeriodicBox;
use lennard_neighbor::{ClusterRow, FIXED_UNITS, GridError, TileChunk, TileList};
use rayon::prelude::*;

use crate::simd::{self, ChunkTotals, ForceRow, Level, Moved, PerParticle, TileJob, Wanted};
use crate::sums::Totals;
use crate::truncation::PairForm;

/// The list, the private copy of the positions that the loop reads, and the forces that it writes.
pub struct Tiled {
    list: TileList,
    lengths: DVec3,
    level: Level,
    rows: Vec<ClusterRow>,
    /// For each chunk, forces on the clusters that it meets.
    forces: Vec<Vec<ForceRow>>,
}

impl Tiled {
    /// A list of radius `radius` σ.
    pub fn new(cell: PeriodicBox, radius: f64, level: Level) -> Self {
        Self {
            list: TileList::new(cell, radius),
            lengths: cell.lengths(),
            level,
            rows: Vec::new(),
            forces: Vec::new(),
        }
    }

    /// The list.
    pub fn list(&self) -> &TileList {
        &self.list
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let forces: usize = self.forces.iter().map(Vec::capacity).sum();
        self.list.bytes()
            + self.rows.capacity() * size_of::<ClusterRow>()
            + forces * size_of::<ForceRow>()
    }

    /// Builds the list.
    pub fn build(&mut self, positions: &[DVec3]) -> Result<(), GridError> {
        self.list.build(positions, self.level.tile_scanner())?;
        self.rows.resize(self.list.rows(), ClusterRow::default());
        self.forces.resize(self.list.chunks().len(), Vec::new());
        for (forces, chunk) in self.forces.iter_mut().zip(self.list.chunks()) {
            forces.resize(chunk.reach as usize, ForceRow::default());
        }
        Ok(())
    }

    /// Copies positions to the rows; gives the largest displacement since those of `built`, by place.
    pub fn pack(&mut self, positions: &[DVec3], built: &[DVec3]) -> Moved {
        simd::pack_clusters(&self.list, positions, built, self.lengths, &mut self.rows)
    }

    /// Writes the forces (and `each`) of the packed positions; gives the totals, which are those of
    /// `wanted`, and whether a force is not finite.
    pub fn evaluate<F: PairForm>(
        &mut self,
        form: F,
        r_cut: f64,
        wanted: Wanted,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> (Totals, bool) {
        let scale = self.lengths / FIXED_UNITS;
        let job = TileJob::new(form, r_cut, scale.to_array(), &self.rows, &self.list);
        let (level, chunks) = (self.level, self.list.chunks());
        let totals = run_chunks(&mut self.forces, chunks, &|forces, chunk| {
            simd::run_tiles(level, &job, chunk, wanted, forces)
        });
        let broken = simd::collect_tiles(level, &self.list, &self.forces, scale.x, forces);
        if let Some(each) = each {
            each.fill((0.0, glam::DMat3::ZERO));
            simd::add_each(&job, each);
        }
        (Totals::of_chunks(&totals), broken)
    }
}

/// Runs all chunks on forces that begin at zero, and gives their totals in order. One instance for all
/// potentials: the loop over chunks is not worth another.
fn run_chunks(
    forces: &mut [Vec<ForceRow>],
    chunks: &[TileChunk],
    run: &(dyn Fn(&mut [ForceRow], &TileChunk) -> ChunkTotals + Sync),
) -> Vec<ChunkTotals> {
    let run = |(forces, chunk): (&mut Vec<ForceRow>, &TileChunk)| {
        forces.fill(ForceRow::default());
        run(forces, chunk)
    };
    if rayon::current_num_threads() == 1 || chunks.len() == 1 {
        forces.iter_mut().zip(chunks).map(run).collect()
    } else {
        forces.par_iter_mut().zip(chunks).map(run).collect()
    }
}
