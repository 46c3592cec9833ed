//! The orthorhombic periodic box and its axes.

use glam::{DVec3, IVec3};
use serde::{Deserialize, Serialize};

/// Why a box cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BoxError {
    /// A side is zero, negative or not a finite number.
    #[error("a box side must be a finite positive number, found {0}")]
    BadLength(f64),
}

/// An orthorhombic box, periodic in all three directions, with one corner at the origin.
///
/// `lengths` are the three sides (L_x, L_y, L_z) in σ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PeriodicBox {
    lengths: DVec3,
}

impl PeriodicBox {
    /// A box with the given sides in σ.
    ///
    /// # Errors
    /// [`BoxError::BadLength`] where a side is not finite and positive.
    pub fn new(lengths: DVec3) -> Result<Self, BoxError> {
        for side in lengths.to_array() {
            if !(side.is_finite() && side > 0.0) {
                return Err(BoxError::BadLength(side));
            }
        }
        Ok(Self { lengths })
    }

    /// The cubic box that holds `n` particles at number density `density` (σ⁻³): L = (N/ρ)^{1/3}.
    ///
    /// # Errors
    /// [`BoxError::BadLength`] where that length is not finite and positive.
    pub fn cubic_for_density(n: usize, density: f64) -> Result<Self, BoxError> {
        Self::new(DVec3::splat((n as f64 / density).cbrt()))
    }

    /// A box so large that its faces are never reached: for systems without a box, such as one oscillator.
    ///
    /// Minimum images are the pair vectors themselves, nothing wraps, and the volume is infinite.
    #[must_use]
    pub const fn boundless() -> Self {
        Self { lengths: DVec3::splat(1e150) }
    }

    /// The same box with each side multiplied by a factor.
    ///
    /// # Errors
    /// [`BoxError::BadLength`] where a side is then not finite and positive.
    pub fn scaled(&self, factors: DVec3) -> Result<Self, BoxError> {
        Self::new(self.lengths * factors)
    }

    /// The three sides in σ.
    #[must_use]
    pub fn lengths(&self) -> DVec3 {
        self.lengths
    }

    /// The volume V = L_x·L_y·L_z in σ³.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.lengths.element_product()
    }

    /// The shortest side in σ.
    #[must_use]
    pub fn shortest(&self) -> f64 {
        self.lengths.min_element()
    }

    /// The largest legal cutoff, half the shortest side: beyond it a particle would see two images
    /// of another one. Equality is legal.
    #[must_use]
    pub fn largest_cutoff(&self) -> f64 {
        0.5 * self.shortest()
    }

    /// The shortest of the periodic images of a pair vector: each component `d` becomes
    /// `d − L·round(d/L)`. Round-half-away keeps it antisymmetric, f(−d) = −f(d), to the bit.
    #[inline]
    #[must_use]
    pub fn minimum_image(&self, d: DVec3) -> DVec3 {
        d - self.lengths * (d / self.lengths).round()
    }

    /// The image flags of a position: how many boxes it lies away from the home box [0, L).
    #[must_use]
    pub fn image(&self, r: DVec3) -> IVec3 {
        self.split(r).1
    }

    /// A position folded into the home box [0, L).
    #[must_use]
    pub fn wrap(&self, r: DVec3) -> DVec3 {
        self.split(r).0
    }

    /// Wrapped position and image flags, with `r = wrapped + image·L` up to rounding of the last bit
    /// and `0 ≤ wrapped < L` always.
    #[must_use]
    pub fn split(&self, r: DVec3) -> (DVec3, IVec3) {
        let mut image = (r / self.lengths).floor();
        let mut wrapped = r - image * self.lengths;
        for axis in 0..3 {
            // Rounding can land exactly on either face: −1e-20 wraps to L, which belongs to the next image.
            if wrapped[axis] >= self.lengths[axis] {
                wrapped[axis] = 0.0;
                image[axis] += 1.0;
            } else if wrapped[axis] < 0.0 {
                wrapped[axis] = 0.0;
            }
        }
        (wrapped, image.as_ivec3())
    }
}

// The axes of the box.

crate::choices! {
    /// An axis of the box.
    pub enum Axis {
        /// The first.
        X = "x",
        /// The second.
        Y = "y",
        /// The third.
        #[default]
        Z = "z",
    }
}

impl Axis {
    /// All axes, in the order of the components of a vector.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// The component of a vector along the axis: 0, 1 or 2.
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell() -> PeriodicBox {
        PeriodicBox::new(DVec3::new(4.0, 5.0, 6.0)).unwrap()
    }

    #[test]
    fn minimum_image_is_antisymmetric_and_shortest() {
        let d = DVec3::new(2.0, -2.6, 17.1);
        let m = cell().minimum_image(d);
        assert_eq!(m, -cell().minimum_image(-d));
        assert!(m.x.abs() <= 2.0 && m.y.abs() <= 2.5 && m.z.abs() <= 3.0);
        assert!((m - DVec3::new(m.x, 2.4, -0.9)).length() < 1e-12);
    }

    #[test]
    fn wrapping_stays_inside_even_for_a_tiny_negative_coordinate() {
        let (wrapped, image) = cell().split(DVec3::new(-1e-20, 5.0, -12.5));
        assert_eq!(wrapped, DVec3::new(0.0, 0.0, 5.5));
        assert_eq!(image, IVec3::new(0, 1, -3));
    }

    #[test]
    fn a_boundless_box_leaves_everything_where_it_is() {
        let cell = PeriodicBox::boundless();
        let d = DVec3::new(-3.5, 1e20, 0.0);
        assert_eq!((cell.minimum_image(d), cell.wrap(-d).y), (d, 0.0));
        assert!(cell.volume().is_infinite());
    }

    #[test]
    fn impossible_sides_are_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(PeriodicBox::new(DVec3::new(1.0, bad, 1.0)).is_err());
        }
    }
}
