//! Steps that follow each other between two builds of a list, particles by place.

use glam::DVec3;
use lennard_core::Stride;

use crate::copies::Fitness;
use crate::simd::{By, Pace, PairList, advance, bring_back, take};
use crate::terms::Terms;
use crate::truncation::PairForm;

/// Particles in the order of a list.
#[derive(Debug, Default)]
pub struct Underway {
    positions: Vec<DVec3>,
    velocities: Vec<DVec3>,
    /// 0, 1, …
    in_order: Vec<u32>,
}

impl Underway {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let vectors = self.positions.capacity() + self.velocities.capacity();
        24 * vectors + 4 * self.in_order.capacity()
    }

    /// Lays the particles out where forces are due, with the `rows` of these positions, σ, and judges the list there.
    pub fn begin<P: PairList>(
        &mut self,
        terms: &Terms,
        list: &P,
        rows: &mut [P::Row],
        positions: &[DVec3],
    ) -> Fitness {
        take(list.particles(), positions, &mut self.positions);
        self.in_order.clear();
        self.in_order.extend(0..positions.len() as u32);
        self.pack(terms, list, rows)
    }

    /// Takes up to so many steps of a stride that has begun, while the list is fit. Gives how many were taken, and whether
    /// the list is fit for the next one. Where a number is not finite, none was taken.
    pub fn go<P: PairList, F: PairForm>(
        &mut self,
        terms: &Terms,
        (list, rows): (&P, &mut [P::Row]),
        form: F,
        stride: &mut Stride<'_>,
        (most, pace): (u64, Pace),
    ) -> (u64, Fitness) {
        take(list.particles(), stride.velocities, &mut self.velocities);
        let job = list.job(form, terms.r_cut, terms.cell.lengths());
        let (mut taken, mut fitness) = (0, Fitness::Fit);
        while taken < most && fitness == Fitness::Fit {
            let particles = (&mut self.positions[..], &mut self.velocities[..]);
            advance::<P, F>(terms.level, &job, rows, particles, &self.in_order, pace);
            taken += 1;
            fitness = self.pack(terms, list, rows);
        }
        if fitness == Fitness::Broken {
            return (0, fitness);
        }
        bring_back(list, &self.positions, stride.positions);
        bring_back(list, &self.velocities, stride.velocities);
        (taken, fitness)
    }

    /// Packs rows, and judges the list by how far particles moved.
    fn pack<P: PairList>(&self, terms: &Terms, list: &P, rows: &mut [P::Row]) -> Fitness {
        let motion = terms.motion(&self.positions, &self.in_order);
        let moved = list.pack(terms.level, By::All, motion, rows);
        terms.fitness(list.cells(), &moved, |place| self.positions[place as usize])
    }
}
