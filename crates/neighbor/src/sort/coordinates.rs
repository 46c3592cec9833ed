//! Coordinates that searches read: rows in single precision, integers in fixed point, and positions folded into the box.

use glam::{DVec3, IVec3};

/// Number of elements that can be read or written beyond the last one: searches move whole registers.
pub const PADDING: usize = 16;

/// Coordinates of all rows in single precision, for the search alone.
///
/// The search radius has a margin for their rounding errors.
#[derive(Debug, Default, Clone)]
pub struct RowCoordinates {
    /// x of each row, σ, `[rows]` and padding.
    pub x: Vec<f32>,
    /// y of each row, σ, `[rows]` and padding.
    pub y: Vec<f32>,
    /// z of each row, σ, `[rows]` and padding.
    pub z: Vec<f32>,
}

impl RowCoordinates {
    /// Makes room for `rows` rows and the padding.
    pub fn resize(&mut self, rows: usize) {
        for axis in [&mut self.x, &mut self.y, &mut self.z] {
            axis.resize(rows + PADDING, 0.0);
        }
    }

    /// Coordinates of one row, σ.
    #[must_use]
    pub fn at(&self, row: usize) -> [f32; 3] {
        [self.x[row], self.y[row], self.z[row]]
    }

    /// Number of rows, without the padding.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.x.len().saturating_sub(PADDING)
    }
}

// Coordinates in fixed point: integers in units of L/2³² along each axis.

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

// Folding of positions into the home box.

/// The largest image number that is counted; a coordinate of so many boxes has lost its digits inside the box.
pub(super) const FARTHEST_IMAGE: f64 = 1_073_741_824.0;

/// Whether a position is finite, and so near that its digits tell where in the box it lies.
#[must_use]
pub fn is_usable(r: DVec3, lengths: DVec3) -> bool {
    // The comparisons are false for NaN.
    r.abs().cmple(lengths * FARTHEST_IMAGE).all()
}

/// Folded position and image, as [`lennard_core::PeriodicBox::split`] gives them.
///
/// It calls no `floor`: without an instruction for it, that call costs more than the rest of the sort.
#[inline(always)]
pub(super) fn fold(r: DVec3, lengths: DVec3) -> (DVec3, IVec3) {
    let mut wrapped = r;
    let mut image = IVec3::ZERO;
    for axis in 0..3 {
        let scaled = r[axis] / lengths[axis];
        let truncated = scaled as i32;
        let mut down = truncated.wrapping_sub(i32::from(f64::from(truncated) > scaled));
        let mut w = r[axis] - f64::from(down) * lengths[axis];
        // Rounding can land exactly on either face: −1e-20 folds to L, which belongs to the next image.
        if w >= lengths[axis] {
            w = 0.0;
            down = down.wrapping_add(1);
        } else if w < 0.0 {
            w = 0.0;
        }
        wrapped[axis] = w;
        image[axis] = down;
    }
    (wrapped, image)
}

#[cfg(test)]
mod tests {
    use lennard_core::PeriodicBox;

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

    #[test]
    fn folding_gives_the_bits_of_the_box() {
        let cell = PeriodicBox::new(DVec3::new(3.0, 7.1, 10.08)).unwrap();
        for k in -4000..4000 {
            let r = DVec3::new(0.75, 1.234_5, 2.52) * f64::from(k) - 1e-20;
            assert_eq!(fold(r, cell.lengths()), cell.split(r));
        }
    }
}
