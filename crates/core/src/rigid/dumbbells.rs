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
    use crate::lanes::{Scalar, in_lanes};
    use crate::rigid::kick;

    /// In registers or one by one, in a last block that is not full too, and by the formula above.
    #[test]
    fn dumbbells_have_the_same_bits_in_registers_and_one_by_one() {
        for n in [1, 7, 8, 13] {
            let sites_of = |shift: f64| -> Vec<DVec3> {
                let at = |i: usize| shift + 1.7 * i as f64;
                let site = |i| DVec3::new(at(i).sin(), (0.7 * at(i)).cos(), (1.9 * at(i)).sin());
                (0..2 * n).map(site).collect()
            };
            let (x, v, f) = (sites_of(0.0), sites_of(0.4), sites_of(0.8));
            let each = (0..2 * n).map(|i| 1.0 + 0.1 * i as f64).collect();
            for masses in [Masses::Uniform(1.3), Masses::Each(each)] {
                let after = |one_by_one: bool| {
                    let mut v = v.clone();
                    let stage = ProjectDumbbells {
                        before: &|first, v: &mut [DVec3]| kick(&masses, first, v, &f[first..], 0.1),
                        masses: &masses,
                        first: 0,
                        x: &x,
                        v: &mut v,
                    };
                    match one_by_one {
                        true => stage.with_simd(Scalar),
                        false => in_lanes(stage),
                    }
                    v
                };
                let found = after(false);
                assert_eq!(found, after(true), "{n} dumbbells");
                for m in 0..n {
                    let (i, j) = (2 * m, 2 * m + 1);
                    let d = x[j] - x[i];
                    let along = d.dot(found[j] - found[i]).abs();
                    assert!(along < 1e-14, "{along:e}");
                    let momentum = |v: &[DVec3]| masses.of(i) * v[i] + masses.of(j) * v[j];
                    let kicked = momentum(&v) + 0.1 * (f[i] + f[j]);
                    assert!((momentum(&found) - kicked).length() < 1e-14);
                }
            }
        }
    }
}
