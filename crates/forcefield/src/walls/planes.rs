//! Where the planes of a pair of walls stand in a periodic box.

use lennard_core::PeriodicBox;

/// Room in σ that the walls take beyond the cutoff: soft walls let particles pass the plane by up to half of it.
pub const SHALLOWEST_ROOM: f64 = 0.1;

/// The planes of a pair of walls along one axis.
///
/// The box stays periodic. Along the axis it is longer than the slit by the thickness of the walls, half at each end:
///
/// ```text
/// 0      lower                       upper      L
/// |######|            slit           |######|
///  ^ thickness/2                       ^ thickness/2
/// ```
///
/// A thickness above the cutoff keeps every particle out of reach of the periodic images across the walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlitPlanes {
    /// The axis of the normal: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Coordinate of the lower plane, σ.
    pub lower: f64,
    /// Coordinate of the upper plane, σ.
    pub upper: f64,
    /// How far behind a plane a particle may be before it is in reach of its images, σ.
    pub room: f64,
}

impl SlitPlanes {
    /// The planes of walls of a thickness in a box, for forces that end at `r_cut`; all in σ.
    #[must_use]
    pub fn new(cell: &PeriodicBox, axis: usize, thickness: f64, r_cut: f64) -> Self {
        Self {
            axis,
            lower: 0.5 * thickness,
            upper: cell.lengths()[axis] - 0.5 * thickness,
            room: 0.5 * (thickness - r_cut).max(0.0),
        }
    }

    /// The distance between the planes, σ.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.upper - self.lower
    }
}
