//! A list in use: the loop over all chunks of a list at some positions.

use glam::DVec3;
use lennard_core::PeriodicBox;
use lennard_neighbor::PackedDisplacement;

use super::fused::NextRows;
use super::level::Level;
use super::motion::{Motion, MotionSummary, SlotSpecies};
use super::output::Output;
use super::packed::{Evaluation, ListStatus, Outcome, PackedCopies, Request, RunChunk};
use super::pair_list::PairList;
use super::row::DoubleRow;
use super::totals::PerParticle;
use crate::interaction::Interaction;

/// Positions and the index in them of each slot.
#[derive(Clone, Copy)]
pub struct Ordered<'a> {
    /// Unwrapped positions, σ.
    pub positions: &'a [DVec3],
    /// The index in `positions` of each slot.
    pub order: &'a [u32],
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
}

impl<P: PairList> ListInUse<'_, P> {
    /// The motion from the build to some positions.
    pub fn motion<'a>(&'a self, at: Ordered<'a>) -> Motion<'a> {
        Motion {
            positions: at.positions,
            order: at.order,
            built: self.built,
            stretch: self.stretch,
            far2: self.far2,
            lengths: self.cell.lengths(),
            species: self.species.map(|at| SlotSpecies {
                at,
                paddings: DoubleRow::paddings(self.level),
            }),
        }
    }

    /// Packs rows, judges the list, and writes forces (and `each`) where it is complete.
    pub fn evaluate<I: Interaction>(
        &self,
        copies: &mut PackedCopies<P::Row>,
        interaction: I,
        positions: &[DVec3],
        request: Request,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> Outcome {
        let order = self.list.particles();
        let output = Output::new(forces, each, order, 0);
        let job = self.list.job(interaction, self.r_cut, self.cell);
        let run = |rows: &[P::Row], _: Option<&NextRows<'_, P::Row>>, chunk: usize| {
            // SAFETY: `PackedCopies::run` runs each chunk once.
            unsafe { P::run(self.level, &job, rows, chunk, request.detail, &output) }
        };
        self.run_chunks(copies, &|| Ordered { positions, order }, request, &run)
    }

    /// Packs rows, judges the list, and runs each chunk once where it is complete.
    ///
    /// `at` gives the positions. It is called while rows are packed and while the list is judged.
    pub fn run_chunks<'p>(
        &self,
        copies: &mut PackedCopies<P::Row>,
        at: &(dyn Fn() -> Ordered<'p> + Sync),
        request: Request,
        run: &RunChunk<'_, P::Row>,
    ) -> Outcome {
        copies.run(&Evaluation {
            n: self.list.particles().len(),
            rows: self.list.rows(),
            chunks: self.list.chunks(),
            request,
            inserts: P::INSERTS,
            pack: &|by, rows, packed| {
                self.list
                    .pack(self.level, by, self.motion(at()), rows, packed)
            },
            judge: &|summary, packed| (self.judge)(summary, packed, at()),
            run,
        })
    }
}
