//! How particles moved since a list was built, in few bytes.

use glam::DVec3;

use crate::columns::FIXED_ROUNDING;

/// How a particle moved since the build, in four bytes: enough to rule most pairs out without a look at where they are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(C, align(4))]
pub struct Way {
    /// x − x⁰ along each axis, in 32nds of half the skin.
    pub along: [i8; 3],
    /// |x − x⁰|² in 16ths of that of half the skin, rounded up by half of one at least; what a byte has no
    /// room for is 255.
    pub square: u8,
}

/// What ways are counted in.
#[derive(Debug, Clone, Copy)]
pub struct Ways {
    /// One over the unit of [`Way::along`], σ⁻¹.
    pub along: f64,
    /// One over the unit of [`Way::square`], σ⁻².
    pub squares: f64,
}

impl Ways {
    /// Parts of half the skin. Whoever moved by less than twice the skin has room.
    const ALONG: f64 = 32.0;
    /// Parts of the square of half the skin.
    const SQUARES: f64 = 16.0;
    /// What two who came closer by the skin moved relative to each other at least, in parts, whatever the rounding.
    const CLOSER: i32 = 62;

    /// Those for a square of half the skin, σ².
    #[inline(always)]
    #[must_use]
    pub fn new(far2: f64) -> Self {
        Self {
            along: Self::ALONG / far2.sqrt(),
            squares: Self::SQUARES / far2,
        }
    }

    /// The way of a particle that moved by x − x⁰, which is `moved2` squared, σ and σ². NaN is far away.
    #[inline(always)]
    #[must_use]
    pub fn way(&self, moved: DVec3, moved2: f64) -> Way {
        let squares = moved2 * self.squares;
        let squares = if squares < 254.0 { squares } else { 254.0 };
        // The nearest whole numbers, without a call.
        let along = |x: f64| (x * self.along + FIXED_ROUNDING).to_bits() as i8;
        Way {
            along: [along(moved.x), along(moved.y), along(moved.z)],
            square: (squares + FIXED_ROUNDING).to_bits() as u8 + 1,
        }
    }

    /// The largest square of those who moved less than that, σ.
    pub(crate) fn below(&self, way: f64) -> u8 {
        (way * way * self.squares * (1.0 - 1e-9)) as u8
    }
}

impl Way {
    /// Whether two may have come closer by the skin.
    #[inline(always)]
    pub(crate) fn may_be_closer(self, other: Self) -> bool {
        let apart = |axis: usize| i32::from(self.along[axis]) - i32::from(other.along[axis]);
        let [x, y, z] = [apart(0), apart(1), apart(2)];
        x * x + y * y + z * z >= Ways::CLOSER * Ways::CLOSER
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lennard_core::random::Streams;
    use rand::RngExt;

    #[test]
    fn ways_never_rule_out_what_came_closer_by_the_skin() {
        let ways = Ways::new(0.04);
        let way = |moved: DVec3| ways.way(moved, moved.length_squared());
        let mut random = Streams::new(1967).sequential("ways");
        for k in 0..3000 {
            let length = 0.2 + 1e-4 * f64::from(k);
            let along = DVec3::from([0; 3].map(|_| random.random_range(-1.0..1.0_f64))).normalize();
            let moved = along * length;
            // What is left of the skin of 0.4.
            let left = 0.4 - length;
            let other = way(-along * left);
            assert!(other.square > ways.below(left.max(0.0)), "{length}");
            assert!(way(moved).may_be_closer(other), "{length}");
            assert!(other.square <= ways.below(left.abs()) + 2, "{length}");
            // Half as much is not enough, nor is as much aside.
            assert!(!way(moved * 0.5).may_be_closer(other), "{length}");
            let aside = along.any_orthonormal_vector() * left;
            assert!(
                length > 0.38 || !way(moved).may_be_closer(way(aside)),
                "{length}"
            );
        }
        assert_eq!(way(DVec3::NAN).square, 255);
        assert_eq!(way(DVec3::X * 1e300).square, 255);
    }
}
