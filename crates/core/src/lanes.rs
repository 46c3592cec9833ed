//! Numbers of several molecules side by side, one in each lane of a register.
//!
//! The library pulp chooses the registers of the machine, four numbers of 64 bits with AVX2. Sums and products are rounded
//! one by one, so that the number of lanes changes no bit. No molecule feels what its neighbors in a register do.

pub use pulp::{Scalar, Simd, WithSimd};

use std::ops::{Add, Div, Mul, Sub};

use crate::DVec3;

/// The most lanes of any register.
pub const MOST_LANES: usize = 8;

/// Runs `work` with the widest registers of this machine.
pub fn in_lanes<W: WithSimd>(work: W) -> W::Output {
    pulp::Arch::new().dispatch(work)
}

/// One number in each lane.
#[derive(Debug, Clone, Copy)]
pub struct Register<S: Simd>(S, S::f64s);

impl<S: Simd> Register<S> {
    /// How many lanes there are.
    pub const LANES: usize = {
        assert!(S::F64_LANES <= MOST_LANES);
        S::F64_LANES
    };

    /// The same number in all lanes.
    #[inline(always)]
    pub fn all(simd: S, number: f64) -> Self {
        Self(simd, simd.splat_f64s(number))
    }

    /// The number `of(lane)` in each lane.
    #[inline(always)]
    pub fn each(simd: S, of: impl Fn(usize) -> f64) -> Self {
        let mut numbers = [0.0; MOST_LANES];
        for (lane, number) in numbers.iter_mut().enumerate().take(Self::LANES) {
            *number = of(lane);
        }
        Self::of_array(simd, &numbers)
    }

    #[inline(always)]
    fn of_array(simd: S, numbers: &[f64; MOST_LANES]) -> Self {
        Self(simd, S::as_simd_f64s(&numbers[..Self::LANES]).0[0])
    }

    /// The numbers of the lanes, and zeros after them.
    #[inline(always)]
    pub fn numbers(self) -> [f64; MOST_LANES] {
        let mut numbers = [0.0; MOST_LANES];
        S::as_mut_simd_f64s(&mut numbers[..Self::LANES]).0[0] = self.1;
        numbers
    }

    /// |a| in each lane.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        Self(self.0, self.0.abs_f64s(self.1))
    }

    /// The larger number of two in each lane; either one where one is no number.
    #[inline(always)]
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self(self.0, self.0.max_f64s(self.1, other.1))
    }

    /// `yes` in lanes where a ≤ `limit`, else `no`; `no` where a is no number.
    #[inline(always)]
    #[must_use]
    pub fn choose_up_to(self, limit: Self, yes: Self, no: Self) -> Self {
        let mask = self.0.less_than_or_equal_f64s(self.1, limit.1);
        Self(self.0, self.0.select_f64s(mask, yes.1, no.1))
    }

    /// The largest number of all lanes, none of which may be no number.
    #[inline(always)]
    pub fn largest(self) -> f64 {
        self.0.reduce_max_f64s(self.1)
    }
}

/// A binary operation, rounded once in each lane.
macro_rules! in_each_lane {
    ($($operator:ident $name:ident $on_registers:ident,)*) => {$(
        impl<S: Simd> $operator for Register<S> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(self.0, self.0.$on_registers(self.1, other.1))
            }
        }
    )*};
}

in_each_lane! {
    Add add add_f64s,
    Sub sub sub_f64s,
    Mul mul mul_f64s,
    Div div div_f64s,
}

/// One vector in each lane, in three registers.
#[derive(Debug, Clone, Copy)]
pub struct RegisterVector<S: Simd>([Register<S>; 3]);

impl<S: Simd> RegisterVector<S> {
    /// The same vector in all lanes.
    #[inline(always)]
    pub fn all(simd: S, vector: DVec3) -> Self {
        let DVec3 { x, y, z } = vector;
        Self([Register::all(simd, x), Register::all(simd, y), Register::all(simd, z)])
    }

    /// a·b in each lane.
    #[inline(always)]
    pub fn dot(self, other: Self) -> Register<S> {
        let ([x, y, z], [a, b, c]) = (self.0, other.0);
        x * a + y * b + z * c
    }

    /// The vector in one lane.
    pub fn in_lane(self, lane: usize) -> DVec3 {
        DVec3::from_array(self.0.map(|component| component.numbers()[lane]))
    }
}

impl<S: Simd> Add for RegisterVector<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([x, y, z], [a, b, c]) = (self.0, other.0);
        Self([x + a, y + b, z + c])
    }
}

impl<S: Simd> Sub for RegisterVector<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([x, y, z], [a, b, c]) = (self.0, other.0);
        Self([x - a, y - b, z - c])
    }
}

impl<S: Simd> Mul<RegisterVector<S>> for Register<S> {
    type Output = RegisterVector<S>;

    #[inline(always)]
    fn mul(self, vector: RegisterVector<S>) -> RegisterVector<S> {
        let [x, y, z] = vector.0;
        RegisterVector([self * x, self * y, self * z])
    }
}

/// The places of some molecules in a slice of their sites, one molecule in each lane.
///
/// Lanes beyond the last molecule hold copies of the last, and write the same numbers to the same places.
#[derive(Debug, Clone, Copy)]
pub struct Block {
    first_sites: [usize; MOST_LANES],
}

impl Block {
    /// How many sites of molecules of `sites` sites fill all lanes.
    #[inline(always)]
    #[must_use]
    pub fn size<S: Simd>(sites: usize) -> usize {
        Register::<S>::LANES * sites
    }

    /// The molecules of a slice of `n_sites` sites, at least one molecule and no more than there are lanes.
    #[inline(always)]
    #[must_use]
    pub fn new(n_sites: usize, sites: usize) -> Self {
        let last = n_sites / sites - 1;
        let mut first_sites = [0; MOST_LANES];
        for (lane, first) in first_sites.iter_mut().enumerate() {
            *first = lane.min(last) * sites;
        }
        Self { first_sites }
    }

    /// The place of site `k` of the molecule in a lane.
    #[inline(always)]
    #[must_use]
    pub fn site(&self, lane: usize, k: usize) -> usize {
        self.first_sites[lane] + k
    }

    /// The vectors of site `k` of each molecule.
    #[inline(always)]
    pub fn gather<S: Simd>(&self, simd: S, from: &[DVec3], k: usize) -> RegisterVector<S> {
        let [mut x, mut y, mut z] = [[0.0; MOST_LANES]; 3];
        for lane in 0..Register::<S>::LANES {
            let vector = from[self.site(lane, k)];
            (x[lane], y[lane], z[lane]) = (vector.x, vector.y, vector.z);
        }
        RegisterVector([
            Register::of_array(simd, &x),
            Register::of_array(simd, &y),
            Register::of_array(simd, &z),
        ])
    }

    /// Writes the vectors of site `k` of each molecule.
    #[inline(always)]
    pub fn scatter<S: Simd>(&self, vectors: RegisterVector<S>, to: &mut [DVec3], k: usize) {
        let [x, y, z] = vectors.0;
        let (x, y, z) = (x.numbers(), y.numbers(), z.numbers());
        for lane in 0..Register::<S>::LANES {
            to[self.site(lane, k)] = DVec3::new(x[lane], y[lane], z[lane]);
        }
    }
}

// Numbers at lines of the cache.

/// Numbers that begin where a line of the cache does: registers of them are written and read without a split.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub struct Aligned<T>(pub T);

#[cfg(test)]
mod tests {
    use super::*;

    fn site(k: f64) -> DVec3 {
        DVec3::new(0.1 + k, 1.0 / (1.0 + k), -0.37 * k - 3.0)
    }

    /// What a sum of all operations gives for the sites of `molecules` molecules of two sites.
    struct Sum(usize);

    impl WithSimd for Sum {
        type Output = Vec<DVec3>;

        fn with_simd<S: Simd>(self, simd: S) -> Vec<DVec3> {
            let mut sites: Vec<DVec3> = (0..2 * self.0).map(|k| site(k as f64)).collect();
            for sites in sites.chunks_mut(Block::size::<S>(2)) {
                let block = Block::new(sites.len(), 2);
                let a: RegisterVector<S> = block.gather(simd, sites, 0);
                let b = block.gather(simd, sites, 1);
                let three = Register::all(simd, 3.0);
                let dot = a.dot(b);
                let root = dot.abs().max(Register::all(simd, 2.0)) / three;
                let chosen = root.choose_up_to(three, root, three);
                block.scatter(chosen * (a - b) + dot * a, sites, 1);
            }
            sites
        }
    }

    /// A register gives the bits of the same operations one by one, for any number of molecules, a last block that is not full
    /// too.
    #[test]
    fn lanes_have_the_bits_of_numbers_one_by_one() {
        for molecules in 1..20 {
            let found = in_lanes(Sum(molecules));
            assert_eq!(found, Sum(molecules).with_simd(Scalar));
            for pair in found.chunks_exact(2) {
                let a = pair[0];
                let b = site((a.x - 0.1).round() + 1.0);
                let dot = a.dot(b);
                let root = (dot.abs().max(2.0) / 3.0).min(3.0);
                let wanted = root * (a - b) + dot * a;
                assert!((pair[1] - wanted).length() < 1e-12 * (1.0 + wanted.length()));
            }
        }
    }

    struct NotNumbers;

    impl WithSimd for NotNumbers {
        type Output = [f64; 2];

        fn with_simd<S: Simd>(self, simd: S) -> [f64; 2] {
            let [none, zero, one] =
                [f64::NAN, 0.0, 1.0].map(|number| Register::<S>::all(simd, number));
            let chosen = [none, zero].map(|number| number.choose_up_to(one, zero, one));
            chosen.map(Register::largest)
        }
    }

    #[test]
    fn what_is_no_number_is_not_up_to_any_limit() {
        assert_eq!(in_lanes(NotNumbers), [1.0, 0.0]);
    }
}
