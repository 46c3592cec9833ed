//! Coordinates in fixed point: integers in units of L/2³² along each axis.

use glam::{DVec3, IVec3};

/// 2³², the number of fixed-point units along each side of the box.
pub const FIXED_UNITS: f64 = 4_294_967_296.0;

/// 1.5·2⁵²: added to a number below 2⁵¹, it leaves the nearest integer in the lowest bits.
pub const FIXED_ROUNDING: f64 = 6_755_399_441_055_744.0;

/// A coordinate row in fixed point: x, y, z in units of L/2³² along each axis, and a word for whoever packs rows.
///
/// Rows are arrays without a name of their own, so that a list can take their room for a build.
pub type FixedRow = [i32; 4];

/// A coordinate vector in fixed point, in units of L/2³² along each axis; `units` is 2³² over the box lengths.
///
/// `image` is roughly the number of boxes between `r` and the home box. Subtracting it leaves a number small enough
/// for the rounding.
///
/// The difference of two such integers is exact, and it wraps around as the periodic box does.
/// Integers mean fractions of the box. A box that is scaled together with its particles keeps them.
#[inline(always)]
#[must_use]
pub fn to_fixed(r: DVec3, image: IVec3, lengths: DVec3, units: DVec3) -> [i32; 3] {
    let home = if image == IVec3::ZERO { r } else { r - image.as_dvec3() * lengths };
    let scaled = home * units + FIXED_ROUNDING;
    [scaled.x, scaled.y, scaled.z].map(|s| s.to_bits() as u32 as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_coordinates_wrap_as_the_box_does() {
        let lengths = DVec3::new(3.0, 7.1, 10.08);
        let units = FIXED_UNITS / lengths;
        for k in -50..50 {
            let r = DVec3::new(0.75, 1.234_5, 2.52) + lengths * f64::from(k);
            let home = to_fixed(r - lengths * f64::from(k), IVec3::ZERO, lengths, units);
            let found = to_fixed(r, IVec3::splat(k), lengths, units);
            let near = to_fixed(r, IVec3::ZERO, lengths, units);
            for axis in 0..3 {
                // A coordinate of 350 σ has a rounding error of 6e-14 σ, far below one unit (about 1e-9 σ).
                assert!(found[axis].wrapping_sub(home[axis]).abs() <= 1);
                assert!(near[axis].wrapping_sub(home[axis]).abs() <= 1);
            }
        }
    }
}
