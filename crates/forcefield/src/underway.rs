//! Steps that follow each other between two builds of a list, particles by place.

use glam::DVec3;
use lennard_core::Stride;

use crate::copies::{Copies, Fitness, are_few};
use crate::simd::{OnTheWay, Pace, PairList, advance, bring_back, take};
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
        let vectors = self.positions.capacity() + self.velocities.capacity() + self.next.capacity();
        24 * vectors + 4 * self.in_order.capacity()
    }

    /// Takes up to so many steps of a stride, while the list is fit. Gives how many were taken, and what ended them. Where a
    /// number is not finite, none was taken.
    pub fn go<P: PairList, F: PairForm>(
        &mut self,
        terms: &Terms,
        (list, copies): (&P, &mut Copies<P::Row>),
        form: F,
        stride: &mut Stride<'_>,
        (most, pace): (u64, Pace),
    ) -> (u64, Fitness) {
        let n = stride.positions.len();
        take(list.particles(), stride.positions, &mut self.positions);
        take(list.particles(), stride.velocities, &mut self.velocities);
        if self.in_order.len() != n {
            self.in_order = (0..n as u32).collect();
        }
        let few = are_few(n);
        self.next.resize(if few { n } else { 0 }, DVec3::ZERO);
        let job = list.job(form, terms.r_cut, terms.cell.lengths());
        let mut taken = 0;
        let mut fitness = Fitness::Fit;
        while taken < most {
            let particles = OnTheWay {
                positions: &mut self.positions,
                next: few.then_some(&mut self.next[..]),
                velocities: &mut self.velocities,
                in_order: &self.in_order,
            };
            fitness = advance::<P, F>(terms, (list, copies), &job, particles, pace);
            if fitness != Fitness::Fit {
                break;
            }
            if few {
                std::mem::swap(&mut self.positions, &mut self.next);
            }
            taken += 1;
        }
        if fitness == Fitness::Broken {
            return (0, fitness);
        }
        if taken > 0 {
            bring_back(list, &self.positions, stride.positions);
            bring_back(list, &self.velocities, stride.velocities);
        }
        (taken, fitness)
    }
}
