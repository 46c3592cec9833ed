//! The velocity stage of chains, several molecules at a time.
//!
//! A·λ = G·v is tridiagonal: with d_c = x_c+1 − x_c and w_c = v_c+1 − v_c,
//!
//! ```text
//! A_cc = (1/m_c + 1/m_c+1)·|d_c|²,   A_c,c−1 = −d_c·d_c−1/m_c,   (G·v)_c = d_c·w_c
//! p_c = 1/(A_cc − A_c,c−1²·p_c−1),   y_c = d_c·w_c − A_c,c−1·p_c−1·y_c−1       forward
//! λ_c = p_c·y_c − A_c+1,c·p_c·λ_c+1                                            backward
//! v_k ← v_k + (λ_k·d_k − λ_k−1·d_k−1)/m_k
//! ```

use crate::lanes::{Block, Register, RegisterVector, Simd, WithSimd};
use crate::{DVec3, Masses};

/// 1/m of sites, in the lanes of their molecules.
#[derive(Debug, Clone, Copy)]
pub struct InverseMasses<'a, S: Simd> {
    simd: S,
    uniform: Register<S>,
    each: Option<&'a [f64]>,
}

impl<'a, S: Simd> InverseMasses<'a, S> {
    /// The masses of all particles.
    #[inline(always)]
    pub fn new(simd: S, masses: &'a Masses) -> Self {
        let (uniform, each) = match masses {
            Masses::Uniform(m) => (1.0 / m, None),
            Masses::Each(m) => (0.0, Some(m.as_slice())),
        };
        Self { simd, uniform: Register::all(simd, uniform), each }
    }

    /// 1/m of site `k` of each molecule of a block whose first site is particle `first`.
    #[inline(always)]
    pub fn of(&self, block: &Block, first: usize, k: usize) -> Register<S> {
        match self.each {
            None => self.uniform,
            Some(m) => Register::each(self.simd, |lane| 1.0 / m[first + block.site(lane, k)]),
        }
    }
}

/// Changes the velocities of chains by `before(first particle, velocities)`, and then takes the part along the bonds off.
pub(super) struct Project<'a, B> {
    /// What comes first.
    pub before: &'a B,
    /// The sites of each chain.
    pub sites: usize,
    /// The masses of all particles.
    pub masses: &'a Masses,
    /// The particle that is the first site here.
    pub first: usize,
    /// Positions of the sites, σ.
    pub x: &'a [DVec3],
    /// Velocities of the sites, σ/τ.
    pub v: &'a mut [DVec3],
}

/// What the way back needs of a bond c: d_c, −A_c,c−1·p_c−1, p_c, y_c, and 1/m of site c + 1.
#[derive(Clone, Copy)]
struct Row<S: Simd> {
    d: RegisterVector<S>,
    factor: Register<S>,
    inverse_pivot: Register<S>,
    right: Register<S>,
    inverse_mass: Register<S>,
}

impl<B: Fn(usize, &mut [DVec3])> WithSimd for Project<'_, B> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let sites = self.sites;
        let zero = Register::all(simd, 0.0);
        let one = Register::all(simd, 1.0);
        let nowhere = RegisterVector::all(simd, DVec3::ZERO);
        let none =
            Row { d: nowhere, factor: zero, inverse_pivot: zero, right: zero, inverse_mass: zero };
        let mut rows = vec![none; sites - 1];
        let inverse_masses = InverseMasses::new(simd, self.masses);
        let mut first = self.first;
        let size = Block::size::<S>(sites);
        let both = self.x.chunks(size).zip(self.v.chunks_mut(size));
        for (x, v) in both {
            let block = Block::new(x.len(), sites);
            (self.before)(first, v);
            let first_mass = inverse_masses.of(&block, first, 0);
            let mut before = Row { inverse_mass: first_mass, ..none };
            let mut x_k = block.gather(simd, x, 0);
            let mut v_k = block.gather(simd, v, 0);
            for (c, row) in rows.iter_mut().enumerate() {
                let x_next = block.gather(simd, x, c + 1);
                let v_next = block.gather(simd, v, c + 1);
                let inverse_mass = inverse_masses.of(&block, first, c + 1);
                let d = x_next - x_k;
                let beside = before.inverse_mass * d.dot(before.d);
                let factor = beside * before.inverse_pivot;
                let diagonal = (before.inverse_mass + inverse_mass) * d.dot(d);
                // In this order the division before is waited for by two operations alone.
                let pivot = diagonal - (beside * beside) * before.inverse_pivot;
                before = Row {
                    d,
                    factor,
                    inverse_pivot: one / pivot,
                    right: d.dot(v_next - v_k) + factor * before.right,
                    inverse_mass,
                };
                *row = before;
                (x_k, v_k) = (x_next, v_next);
            }
            let (mut multiplier, mut factor, mut impulse) = (zero, zero, nowhere);
            for (c, row) in rows.iter().enumerate().rev() {
                multiplier = row.right * row.inverse_pivot + factor * multiplier;
                factor = row.factor;
                let own = multiplier * row.d;
                let after = block.gather(simd, v, c + 1) + row.inverse_mass * (impulse - own);
                block.scatter(after, v, c + 1);
                impulse = own;
            }
            let after = block.gather(simd, v, 0) + first_mass * impulse;
            block.scatter(after, v, 0);
            first += x.len();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Scalar, in_lanes};
    use crate::moves::kick;

    /// The velocity stage has the bits of numbers one by one, as where there is no AVX2. The last register is not full.
    #[test]
    fn chains_have_the_same_bits_in_registers_and_one_by_one() {
        for (sites, n) in [(2, 13), (3, 1), (3, 7), (10, 13)] {
            let of = |shift: f64| -> Vec<DVec3> {
                let at = |i: usize| shift + 1.7 * i as f64;
                let site = |i| DVec3::new(at(i).sin(), (0.7 * at(i)).cos(), (1.9 * at(i)).sin());
                (0..sites * n).map(site).collect()
            };
            let (x, f) = (of(0.0), of(0.8));
            let each = (0..sites * n).map(|i| 1.0 + 0.1 * i as f64).collect();
            for masses in [Masses::Uniform(1.3), Masses::Each(each)] {
                let kicked =
                    |first: usize, v: &mut [DVec3]| kick(&masses, first, v, &f[first..], 0.1);
                let [registers, one_by_one] = [true, false].map(|in_registers| {
                    let mut v = of(0.4);
                    let (x, v_here) = (&x, &mut v);
                    let stage =
                        Project { before: &kicked, sites, masses: &masses, first: 0, x, v: v_here };
                    match in_registers {
                        true => in_lanes(stage),
                        false => stage.with_simd(Scalar),
                    }
                    v
                });
                assert_eq!(registers, one_by_one, "{n} of {sites} sites");
            }
        }
    }
}
