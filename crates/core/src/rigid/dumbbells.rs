//! The velocity stage of dumbbells, several molecules at a time.
//!
//! With d = x_j − x_i and w = v_j − v_i it is v_i ← v_i + (λ/m_i)·d, v_j ← v_j − (λ/m_j)·d with λ = d·w/((1/m_i + 1/m_j)·|d|²).

use super::chains::InverseMasses;
use crate::lanes::{MOST_LANES, Register, RegisterVector, Simd, WithSimd};
use crate::{DVec3, Masses};

/// The sites of fewer dumbbells than there are lanes, with copies of the last one behind them.
#[must_use]
pub fn filled(sites: &[DVec3]) -> [DVec3; 2 * MOST_LANES] {
    let last = sites.len() - 2;
    std::array::from_fn(|k| *sites.get(k).unwrap_or(&sites[last + k % 2]))
}

/// Registers side by side: a division of one has the other to go on with.
const SIDE_BY_SIDE: usize = 2;

/// Changes the velocities of dumbbells by `before(first particle, velocities)`, and then takes the part along the bonds off.
pub(super) struct ProjectDumbbells<'a, B> {
    /// What comes first.
    pub before: &'a B,
    /// The masses of all particles.
    pub masses: &'a Masses,
    /// The particle that is the first site here.
    pub first: usize,
    /// Positions of the sites, σ.
    pub x: &'a [DVec3],
    /// Velocities of the sites, σ/τ.
    pub v: &'a mut [DVec3],
}

impl<B: Fn(usize, &mut [DVec3])> WithSimd for ProjectDumbbells<'_, B> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let inverse_masses = InverseMasses::new(simd, self.masses);
        let mut first = self.first;
        let size = 2 * Register::<S, SIDE_BY_SIDE>::LANES;
        for (x, v) in self.x.chunks(size).zip(self.v.chunks_mut(size)) {
            (self.before)(first, v);
            let particle = |lane: usize| first + 2 * lane;
            if x.len() == size {
                project(simd, &inverse_masses, particle, x, v);
            } else {
                let last = x.len() / 2 - 1;
                let particle = |lane: usize| particle(lane.min(last));
                let mut all = filled(v);
                project(simd, &inverse_masses, particle, &filled(x), &mut all);
                v.copy_from_slice(&all[..v.len()]);
            }
            first += x.len();
        }
    }
}

/// Takes the part along the bond off the velocities of a dumbbell in each lane; `particle(lane)` is its first site.
#[inline(always)]
fn project<S: Simd>(
    simd: S,
    inverse_masses: &InverseMasses<'_, S, SIDE_BY_SIDE>,
    particle: impl Fn(usize) -> usize,
    x: &[DVec3],
    v: &mut [DVec3],
) {
    let i = inverse_masses.at(&particle);
    let j = inverse_masses.at(|lane| particle(lane) + 1);
    let v_i = RegisterVector::of_site::<2>(simd, v, 0);
    let v_j = RegisterVector::of_site::<2>(simd, v, 1);
    let d = RegisterVector::of_site::<2>(simd, x, 1) - RegisterVector::of_site::<2>(simd, x, 0);
    let along = d.dot(v_j - v_i) / ((i + j) * d.dot(d));
    (v_i + (along * i) * d).to_site::<2>(v, 0);
    (v_j - (along * j) * d).to_site::<2>(v, 1);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigid::testing::{Kicked, in_registers_and_one_by_one};

    /// In registers or one by one, in a last block that is not full too, and by the formula above.
    #[test]
    fn dumbbells_have_the_same_bits_in_registers_and_one_by_one() {
        for n in [1, 7, 8, 13] {
            for sites in Kicked::with_either_masses(2 * n) {
                let Kicked { masses, x, v, .. } = &sites;
                let found = in_registers_and_one_by_one(v, |v, way| {
                    way.run(ProjectDumbbells { before: &sites.kick(), masses, first: 0, x, v });
                });
                for m in 0..n {
                    let (i, j) = (2 * m, 2 * m + 1);
                    let d = x[j] - x[i];
                    let along = d.dot(found[j] - found[i]).abs();
                    assert!(along < 1e-14, "{along:e}");
                    let momentum = |v: &[DVec3]| masses.of(i) * v[i] + masses.of(j) * v[j];
                    let kicked = momentum(v) + Kicked::TIME * (sites.f[i] + sites.f[j]);
                    assert!((momentum(&found) - kicked).length() < 1e-14);
                }
            }
        }
    }
}
