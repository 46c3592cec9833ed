//! The canonical loop: forces that are a pure function of the positions, to the bit.
//!
//! The neighbors of each particle are added in ascending order, and particles beyond the cutoff leave no trace.
//! Over all pairs the loop is the direct sum. Over a list it has the same bits, whatever the list, its history, the skin
//! and the number of threads.

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::DVec3;
use lennard_core::exact::ExactSums;
use lennard_core::parallel::for_each_piece;
use lennard_core::{Exclusions, PeriodicBox};
use rayon::prelude::*;

use crate::interaction::Pairwise;
use crate::sums::{Detail, PerParticle, Totals};

/// Particles per task.
const PARTICLES_PER_CHUNK: usize = 64;

/// The particles that may be near to each particle.
#[derive(Debug, Clone, Copy)]
pub enum NeighborSource<'a> {
    /// All other particles but the excluded ones.
    AllBut(&'a Exclusions),
    /// The listed particles of each particle, ascending and without repetition.
    Listed(&'a [Vec<u32>]),
}

/// One evaluation.
pub struct CanonicalJob<'a> {
    /// The force.
    pub pairwise: &'a Pairwise,
    /// The box.
    pub cell: &'a PeriodicBox,
    /// Positions folded into the home box, `[N]`, σ.
    pub wrapped: &'a [DVec3],
    /// The source of neighbors.
    pub neighbors: NeighborSource<'a>,
}

/// Folds positions into the home box.
pub fn wrap(cell: &PeriodicBox, positions: &[DVec3], wrapped: &mut Vec<DVec3>) {
    wrapped.resize(positions.len(), DVec3::ZERO);
    for_each_piece(wrapped, |first, chunk| {
        for (w, r) in chunk.iter_mut().zip(&positions[first..]) {
            *w = cell.wrap(*r);
        }
    });
}

/// The nearest image of a difference of two folded coordinates; ties fall as in [`PeriodicBox::minimum_image`].
#[inline(always)]
fn nearest(d: f64, length: f64) -> f64 {
    let half = 0.5 * length;
    if d >= half {
        d - length
    } else if d <= -half {
        d + length
    } else {
        d
    }
}

/// Computes one chunk: its number, its forces, and its entries per particle where wanted. It adds the totals of each of its
/// particles to the sums where there are sums.
type ChunkWork<'a> =
    dyn Fn(usize, &mut [DVec3], Option<&mut [PerParticle]>, Option<&mut ParticleSums>) + Sync + 'a;

/// Exact sums over particles.
type ParticleSums = ExactSums<{ Totals::NUMBERS }>;

/// Runs all chunks and returns their totals, where they are wanted.
fn run_chunks(
    forces: &mut [DVec3],
    each: Option<&mut [PerParticle]>,
    detail: Detail,
    run: &ChunkWork<'_>,
) -> Totals {
    let sums = (detail != Detail::Forces).then(Mutex::default);
    let run = |chunk: usize, forces: &mut [DVec3], each: Option<&mut [PerParticle]>| {
        let Some(sums) = &sums else {
            return run(chunk, forces, each, None);
        };
        let mut mine = ParticleSums::default();
        run(chunk, forces, each, Some(&mut mine));
        let mut sums: MutexGuard<'_, ParticleSums> =
            sums.lock().unwrap_or_else(PoisonError::into_inner);
        sums.merge(mine);
    };
    let serial = rayon::current_num_threads() == 1 || forces.len() <= PARTICLES_PER_CHUNK;
    match each {
        None if serial => {
            let chunks = forces.chunks_mut(PARTICLES_PER_CHUNK).enumerate();
            chunks.for_each(|(c, f)| run(c, f, None));
        }
        None => forces
            .par_chunks_mut(PARTICLES_PER_CHUNK)
            .enumerate()
            .for_each(|(c, f)| run(c, f, None)),
        Some(each) => forces
            .par_chunks_mut(PARTICLES_PER_CHUNK)
            .zip(each.par_chunks_mut(PARTICLES_PER_CHUNK))
            .enumerate()
            .for_each(|(c, (f, e))| run(c, f, Some(e))),
    }
    let Some(sums) = sums else {
        return Totals::NOTHING;
    };
    let sums = sums.into_inner().unwrap_or_else(PoisonError::into_inner);
    Totals::of_both_ends(sums.values())
}

impl CanonicalJob<'_> {
    /// Writes forces (and `each`); returns the totals that `detail` asks for.
    pub fn run(
        &self,
        detail: Detail,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> Totals {
        run_chunks(forces, each, detail, &|chunk, forces, each, sums| {
            self.chunk(chunk, forces, each, sums);
        })
    }

    fn chunk(
        &self,
        chunk: usize,
        forces: &mut [DVec3],
        mut each: Option<&mut [PerParticle]>,
        mut sums: Option<&mut ParticleSums>,
    ) {
        let r_cut = match self.neighbors {
            NeighborSource::AllBut(_) => self.pairwise.model().r_cut,
            NeighborSource::Listed(_) => self.pairwise.r_cut(),
        };
        for (k, force) in forces.iter_mut().enumerate() {
            let i = chunk * PARTICLES_PER_CHUNK + k;
            let mut mine = Totals::NOTHING;
            *force = match self.neighbors {
                NeighborSource::AllBut(exclusions) => {
                    let others = (0..i).chain(i + 1..self.wrapped.len());
                    if exclusions.are_none() {
                        self.particle(r_cut, i, others, &mut mine)
                    } else {
                        let others = others.filter(|j| !exclusions.exclude(i, *j));
                        self.particle(r_cut, i, others, &mut mine)
                    }
                }
                NeighborSource::Listed(lists) => {
                    self.particle(r_cut, i, lists[i].iter().map(|j| *j as usize), &mut mine)
                }
            };
            if let Some(sums) = &mut sums {
                sums.add(mine.numbers());
            }
            if let Some(each) = &mut each {
                each[k] = (0.5 * mine.energy, 0.5 * mine.virial);
            }
        }
    }

    /// The force on particle `i` by its neighbors within a distance, ε/σ, whose other sums are added to `totals`.
    #[inline(always)]
    fn particle(
        &self,
        r_cut: f64,
        i: usize,
        neighbors: impl Iterator<Item = usize>,
        totals: &mut Totals,
    ) -> DVec3 {
        let lengths = self.cell.lengths();
        let (pairwise, r_cut2) = (self.pairwise, r_cut * r_cut);
        let own = self.wrapped[i];
        let mut force = DVec3::ZERO;
        for j in neighbors {
            let d = own - self.wrapped[j];
            let r_ij = DVec3::new(
                nearest(d.x, lengths.x),
                nearest(d.y, lengths.y),
                nearest(d.z, lengths.z),
            );
            let r2 = r_ij.length_squared();
            if r2 <= r_cut2
                && let Some(pair) = pairwise.between(i, j, r2)
            {
                force += pair.force * r_ij;
                totals.add_end(&pair, r_ij);
                totals.at_cutoff += pairwise.energy_at_cutoff(i, j);
            }
        }
        force
    }
}
