//! A list in use: the loop over all chunks of a list at some positions.

use std::slice;

use glam::{DMat3, DVec3};
use lennard_core::PeriodicBox;
use lennard_neighbor::PackedDisplacement;

use super::by_slot::to_particles;
use super::fused::NextRows;
use super::level::Level;
use super::motion::{Motion, MotionSummary, SlotSpecies, SomeRows};
use super::output::Output;
use super::packed::{
    Evaluation, Fetch, ListStatus, Outcome, PackedCopies, Request, RunChunk, Which,
};
use super::packed_list::PackedList;
use super::row::DoubleRow;
use super::totals::{ChunkTotals, PerParticle};
use crate::interaction::Pairwise;
use crate::share::Share;

/// Positions and the index in them of each slot.
#[derive(Clone, Copy)]
pub struct Ordered<'a> {
    /// Unwrapped positions, σ.
    pub positions: &'a [DVec3],
    /// The index in `positions` of each slot; none where positions are by slot.
    pub order: Option<&'a [u32]>,
}

impl<'a> Ordered<'a> {
    /// Positions with the index in them of each slot.
    pub fn of(positions: &'a [DVec3], order: &'a [u32]) -> Self {
        let order = Some(order);
        Self { positions, order }
    }

    /// Positions by slot.
    pub fn by_slot(positions: &'a [DVec3]) -> Self {
        let order = None;
        Self { positions, order }
    }

    /// The index in the positions of a slot.
    #[inline(always)]
    pub fn index(&self, slot: usize) -> usize {
        self.order.map_or(slot, |order| order[slot] as usize)
    }
}

/// Judges the list at some positions, by the motion and maybe by packed displacements.
pub type JudgeAt<'a> =
    dyn Fn(&MotionSummary, Option<&[PackedDisplacement]>, Ordered<'_>) -> ListStatus + Sync + 'a;

/// A list with all that its use in a box depends on.
pub struct ListInUse<'a, P> {
    /// The list.
    pub list: &'a P,
    /// The instruction set of the loops.
    pub level: Level,
    /// The box.
    pub cell: &'a PeriodicBox,
    /// The cutoff, σ.
    pub r_cut: f64,
    /// Positions of the build by slot, σ.
    pub built: &'a [DVec3],
    /// The species at each slot, where there are several.
    pub species: Option<&'a [u8]>,
    /// The sides of the box over its sides at the build.
    pub stretch: DVec3,
    /// The |d|² beyond which a particle moved far, σ².
    pub far2: f64,
    /// Judges the list.
    pub judge: &'a JudgeAt<'a>,
    /// The share of this rank, where there are several.
    pub share: Option<&'a Share>,
}

/// Runs a chunk over rows and writes its output.
type RunInto<'a, Row> = dyn Fn(&Output<'_>, &[Row], usize) -> ChunkTotals + Sync + 'a;

impl<P: PackedList> ListInUse<'_, P> {
    /// The motion from the build to some positions.
    pub fn motion<'a>(&'a self, at: Ordered<'a>) -> Motion<'a> {
        Motion {
            positions: at.positions,
            order: at.order,
            built: self.built,
            stretch: self.stretch,
            far2: self.far2,
            lengths: self.cell.lengths(),
            species: self
                .species
                .map(|at| SlotSpecies { at, paddings: DoubleRow::paddings(self.level) }),
        }
    }

    /// Packs rows, judges the list, and writes forces (and `each`) where it is complete.
    pub fn evaluate(
        &self,
        copies: &mut PackedCopies<P::Row>,
        pairwise: &Pairwise,
        positions: &[DVec3],
        request: Request,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> Outcome {
        let order = self.list.particles();
        let over_list = pairwise.over(self.list, self.r_cut, self.cell);
        let run = |output: &Output<'_>, rows: &[P::Row], chunk: usize| {
            // SAFETY: `PackedCopies::run` runs each chunk once.
            unsafe { over_list.run(self.level, rows, chunk, request.detail, output) }
        };
        let at = || Ordered::of(positions, order);
        if let Some(share) = self.share {
            return self.evaluate_together(share, copies, &at, request, (forces, each), &run);
        }
        let output = Output::new(forces, each, order, 0);
        let run = |rows: &[P::Row], _: Option<&NextRows<'_, P::Row>>, chunk: usize| {
            run(&output, rows, chunk)
        };
        self.run_chunks(copies, &at, request, None, &run)
    }

    /// As [`ListInUse::evaluate`], with the chunks of this rank alone. Each rank then gets the forces of all.
    fn evaluate_together<'p>(
        &self,
        share: &Share,
        copies: &mut PackedCopies<P::Row>,
        at: &(dyn Fn() -> Ordered<'p> + Sync),
        request: Request,
        (forces, each): (&mut [DVec3], Option<&mut [PerParticle]>),
        run: &RunInto<'_, P::Row>,
    ) -> Outcome {
        let n = forces.len();
        let mut by_slot = std::mem::take(&mut share.buffers().forces);
        by_slot.resize(n, DVec3::ZERO);
        let mut each_by_slot = vec![(0.0, DMat3::ZERO); each.as_ref().map_or(0, |each| each.len())];
        let entries = each.is_some().then_some(&mut each_by_slot[..]);
        let output = Output::new(&mut by_slot, entries, share.numbers(), 0);
        let run = |rows: &[P::Row], _: Option<&NextRows<'_, P::Row>>, chunk: usize| {
            run(&output, rows, chunk)
        };
        let mut outcome = self.run_chunks(copies, at, request, None, &run);
        if outcome.status == ListStatus::Complete {
            let team = share.team();
            team.gather(&mut by_slot, share.slots());
            to_particles(self.list, &by_slot, forces);
            if let Some(each) = each {
                gather_entries(share, &mut each_by_slot);
                to_particles(self.list, &each_by_slot, each);
            }
            outcome.broken = team.any(outcome.broken);
        }
        share.buffers().forces = by_slot;
        outcome
    }

    /// Packs rows, judges the list, and runs each chunk once where it is complete.
    ///
    /// `at` gives the positions. It is called while rows are packed and while the list is judged. With several ranks,
    /// `fetch` fetches the positions of the halo, unless they are known.
    pub fn run_chunks<'p>(
        &self,
        copies: &mut PackedCopies<P::Row>,
        at: &(dyn Fn() -> Ordered<'p> + Sync),
        request: Request,
        fetch: Option<&Fetch<'_>>,
        run: &RunChunk<'_, P::Row>,
    ) -> Outcome {
        let all = 0..self.list.particles().len();
        let all_ghosts = 0..self.list.slots_of_ghosts().len();
        let which = |which: Which| match (which, self.share) {
            (Which::Own, Some(share)) => share.rows(0),
            (Which::Halo, Some(share)) => share.rows(1),
            _ => SomeRows { slots: slice::from_ref(&all), ghosts: slice::from_ref(&all_ghosts) },
        };
        copies.run(&Evaluation {
            n: self.list.particles().len(),
            rows: self.list.rows(),
            chunks: self.list.chunk_count(),
            request,
            inserts: P::INSERTS,
            pack: &|by, rows_of, rows, packed| {
                let (motion, which) = (self.motion(at()), which(rows_of));
                self.list.pack(self.level, by, motion, which, rows, packed)
            },
            judge: &|summary, packed| (self.judge)(summary, packed, at()),
            run,
            share: self.share,
            fetch,
        })
    }
}

/// Makes the entries of all slots whole: an energy and nine components in four vectors.
fn gather_entries(share: &Share, entries: &mut [PerParticle]) {
    let mut vectors = vec![DVec3::ZERO; 4 * entries.len()];
    let own = share.own();
    let (to, _) = vectors.as_chunks_mut::<4>();
    for (to, (energy, virial)) in to[own.clone()].iter_mut().zip(&entries[own]) {
        *to = [DVec3::X * *energy, virial.x_axis, virial.y_axis, virial.z_axis];
    }
    let of_four = |slots: &std::ops::Range<usize>| 4 * slots.start..4 * slots.end;
    let ranges: Vec<_> = share.slots().iter().map(of_four).collect();
    share.team().gather(&mut vectors, &ranges);
    let (from, _) = vectors.as_chunks::<4>();
    for (entry, [energy, x, y, z]) in entries.iter_mut().zip(from) {
        *entry = (energy.x, DMat3::from_cols(*x, *y, *z));
    }
}
