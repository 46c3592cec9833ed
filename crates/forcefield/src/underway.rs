//! Steps that follow each other, particles by place.

use glam::DVec3;
use lennard_core::{ForceError, FusedSteps as Stride};
use lennard_neighbor::Given;

use crate::clock::Clock;
use crate::copies::{Copies, Fitness, Known, Use, are_few};
use crate::simd::{OnTheWay, Pace, PairList, Wanted, advance, bring_back, take};
use crate::terms::Terms;
use crate::truncation::PairForm;

/// Particles in the order of a list.
#[derive(Debug, Default)]
pub struct Underway {
    positions: Vec<DVec3>,
    velocities: Vec<DVec3>,
    /// Where positions of the next step are written while others still read those of this one; empty where nobody does.
    next: Vec<DVec3>,
    /// 0, 1, …
    in_order: Vec<u32>,
}

impl Underway {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let vectors = [&self.positions, &self.velocities, &self.next];
        let vectors: usize = vectors.iter().map(|v| v.capacity()).sum();
        24 * vectors + 4 * self.in_order.capacity()
    }

    /// Takes the steps of a stride, and builds the list wherever it is not fit. Gives how many were
    /// taken: where a number is not finite, none.
    pub fn go<P: PairList, F: PairForm>(
        &mut self,
        terms: &mut Terms,
        (list, copies): (&mut P, &mut Copies<P::Row>),
        form: F,
        stride: &mut Stride<'_>,
        pace: Pace,
        clock: &mut Clock,
    ) -> u64 {
        let given = Given::ByParticle(stride.positions);
        if terms.built.len() != stride.positions.len()
            && clock.building(|| terms.build(list, given)).is_err()
        {
            return 0;
        }
        self.lay_out(list, stride);
        let (mut taken, mut is_new, mut known) = (0, false, Known::Nothing);
        loop {
            let most = stride.steps - taken;
            let (done, fitness) = self.advance(terms, (list, copies), form, most, (pace, known));
            taken += done;
            known = Known::Nothing;
            match fitness {
                Fitness::Fit => break,
                Fitness::Broken => return 0,
                Fitness::Lacks(pairs) if terms.name(list, &pairs) => known = Known::Judged,
                Fitness::Stale | Fitness::Lacks(_) => {
                    assert!(done > 0 || !is_new, "a list is fit where it was built");
                    let built = clock.building(|| {
                        terms.build(list, Given::ByPlace(&self.positions))?;
                        self.regroup(list, &terms.built);
                        Ok::<_, ForceError>(())
                    });
                    if built.is_err() {
                        break;
                    }
                    is_new = true;
                }
            }
        }
        if taken > 0 {
            bring_back(list, &self.positions, stride.positions);
            bring_back(list, &self.velocities, stride.velocities);
        }
        taken
    }

    fn lay_out<P: PairList>(&mut self, list: &P, stride: &Stride<'_>) {
        let n = stride.positions.len();
        take(list.particles(), stride.positions, &mut self.positions);
        take(list.particles(), stride.velocities, &mut self.velocities);
        if self.in_order.len() != n {
            self.in_order = (0..n as u32).collect();
        }
        self.next
            .resize(if are_few(n) { n } else { 0 }, DVec3::ZERO);
    }

    /// Puts particles in the order of a list that was built anew, at these positions by place.
    fn regroup<P: PairList>(&mut self, list: &P, built: &[DVec3]) {
        // Where positions were there is room for velocities.
        take(list.from(), &self.velocities, &mut self.positions);
        std::mem::swap(&mut self.positions, &mut self.velocities);
        self.positions.copy_from_slice(built);
    }

    /// Takes up to so many steps, while the list is fit, with what is known of the rows of the first. Gives how many were
    /// taken, and what ended them.
    fn advance<P: PairList, F: PairForm>(
        &mut self,
        terms: &Terms,
        (list, copies): (&P, &mut Copies<P::Row>),
        form: F,
        most: u64,
        (pace, mut known): (Pace, Known),
    ) -> (u64, Fitness) {
        let few = are_few(self.in_order.len());
        let job = list.job(form, terms.r_cut, terms.cell.lengths());
        let mut taken = 0;
        while taken < most {
            let used = Use {
                wanted: Wanted::Forces,
                known,
                // Nobody reads those that the last step would pack.
                packs_next: P::PACK_AHEAD.is_some() && !few && taken + 1 < most,
            };
            let particles = OnTheWay {
                positions: &mut self.positions,
                next: few.then_some(&mut self.next[..]),
                velocities: &mut self.velocities,
                in_order: &self.in_order,
            };
            let fitness = advance::<P, F>(terms, (list, copies), &job, particles, pace, used);
            if fitness != Fitness::Fit {
                return (taken, fitness);
            }
            if few {
                std::mem::swap(&mut self.positions, &mut self.next);
            }
            taken += 1;
            known = if used.packs_next {
                Known::Packed
            } else {
                Known::Nothing
            };
        }
        (taken, Fitness::Fit)
    }
}
