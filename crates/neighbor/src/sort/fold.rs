//! Folding of positions into the home box.

use glam::{DVec3, IVec3};

/// The largest image number that is counted; a coordinate of so many boxes has lost its digits inside the box.
pub(super) const FARTHEST_IMAGE: f64 = 1_073_741_824.0;

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
    use super::*;
    use lennard_core::PeriodicBox;

    #[test]
    fn folding_gives_the_bits_of_the_box() {
        let cell = PeriodicBox::new(DVec3::new(3.0, 7.1, 10.08)).unwrap();
        for k in -4000..4000 {
            let r = DVec3::new(0.75, 1.234_5, 2.52) * f64::from(k) - 1e-20;
            assert_eq!(fold(r, cell.lengths()), cell.split(r));
        }
    }
}
