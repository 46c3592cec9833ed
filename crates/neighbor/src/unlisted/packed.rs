//! Displacements since the build in four bytes per particle.

use glam::DVec3;

use crate::sort::FIXED_ROUNDING;

/// The displacement of a particle since the build, in four bytes.
///
/// It rules out most pairs without a look at the positions. Nothing but speed depends on it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(C, align(4))]
pub struct PackedDisplacement {
    /// x − x⁰ along each axis, in 32nds of half the skin.
    pub along: [i8; 3],
    /// |x − x⁰|² in 16ths of the square of half the skin, rounded up by at least one half; 255 where a byte overflows.
    pub square: u8,
}

/// The scales of packed displacements.
#[derive(Debug, Clone, Copy)]
pub struct DisplacementScale {
    /// One over the unit of [`PackedDisplacement::along`], σ⁻¹.
    pub along: f64,
    /// One over the unit of [`PackedDisplacement::square`], σ⁻².
    pub squares: f64,
}

impl DisplacementScale {
    /// Units per half skin. A displacement below two skins does not overflow.
    const ALONG: f64 = 32.0;
    /// Units per square of half the skin.
    const SQUARES: f64 = 16.0;
    /// The smallest relative displacement, in units, of two particles that came closer by the skin.
    const CLOSER: i32 = 62;

    /// The scales for a square of half the skin, σ².
    #[inline(always)]
    #[must_use]
    pub fn new(far2: f64) -> Self {
        Self { along: Self::ALONG / far2.sqrt(), squares: Self::SQUARES / far2 }
    }

    /// Packs the displacement x − x⁰, σ, whose square is `moved2`, σ². NaN counts as a far displacement.
    #[inline(always)]
    #[must_use]
    pub fn pack(&self, moved: DVec3, moved2: f64) -> PackedDisplacement {
        let squares = moved2 * self.squares;
        let squares = if squares < 254.0 { squares } else { 254.0 };
        // The nearest integers are found without a call.
        let along = |x: f64| (x * self.along + FIXED_ROUNDING).to_bits() as i8;
        PackedDisplacement {
            along: [along(moved.x), along(moved.y), along(moved.z)],
            square: (squares + FIXED_ROUNDING).to_bits() as u8 + 1,
        }
    }

    /// The largest packed square of a displacement below `distance`, σ.
    pub(crate) fn below(&self, distance: f64) -> u8 {
        (distance * distance * self.squares * (1.0 - 1e-9)) as u8
    }
}

impl PackedDisplacement {
    /// Whether two particles with these displacements may have come closer by the skin.
    #[inline(always)]
    pub(crate) fn may_be_closer(self, other: Self) -> bool {
        let apart = |axis: usize| i32::from(self.along[axis]) - i32::from(other.along[axis]);
        let [x, y, z] = [apart(0), apart(1), apart(2)];
        x * x + y * y + z * z >= DisplacementScale::CLOSER * DisplacementScale::CLOSER
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lennard_core::random::Streams;
    use rand::RngExt;

    #[test]
    fn packed_displacements_never_rule_out_a_pair_that_came_closer_by_the_skin() {
        let scale = DisplacementScale::new(0.04);
        let pack = |moved: DVec3| scale.pack(moved, moved.length_squared());
        let mut random = Streams::new(1967).sequential("ways");
        for k in 0..3000 {
            let length = 0.2 + 1e-4 * f64::from(k);
            let along = DVec3::from([0; 3].map(|_| random.random_range(-1.0..1.0_f64))).normalize();
            let moved = along * length;
            // The rest of the skin of 0.4.
            let left = 0.4 - length;
            let other = pack(-along * left);
            assert!(other.square > scale.below(left.max(0.0)), "{length}");
            assert!(pack(moved).may_be_closer(other), "{length}");
            assert!(other.square <= scale.below(left.abs()) + 2, "{length}");
            // Half as much is not enough, and neither is as much in another direction.
            assert!(!pack(moved * 0.5).may_be_closer(other), "{length}");
            let aside = along.any_orthonormal_vector() * left;
            assert!(length > 0.38 || !pack(moved).may_be_closer(pack(aside)), "{length}");
        }
        assert_eq!(pack(DVec3::NAN).square, 255);
        assert_eq!(pack(DVec3::X * 1e300).square, 255);
    }
}
