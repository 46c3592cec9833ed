//! What the readers of LAMMPS' files share.

use glam::DVec3;
use lennard_core::PeriodicBox;

use crate::error::{Refusal, excerpt};
use crate::geometry::upright;
use crate::lines::{finite, tokens};

/// Where a box begins, and the box.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds {
    pub(crate) low: DVec3,
    pub(crate) cell: PeriodicBox,
}

impl Bounds {
    /// The box between two corners, with LAMMPS' tilts xy, xz and yz.
    pub(crate) fn new(low: DVec3, high: DVec3, [xy, xz, yz]: [f64; 3]) -> Result<Self, Refusal> {
        let sides = high - low;
        let b = DVec3::new(xy, sides.y, 0.0);
        let c = DVec3::new(xz, yz, sides.z);
        let found = || match [xy, xz, yz] == [0.0; 3] {
            true => format!("a box from {low} to {high}"),
            false => format!("the tilts {xy} {xz} {yz}"),
        };
        let cell = upright([DVec3::X * sides.x, b, c], found)?;
        Ok(Self { low, cell })
    }
}

/// The numbers that a line begins with: where the box begins, where it ends, and a tilt in some files.
pub(crate) fn bound<const N: usize>(line: &[u8]) -> Result<[f64; N], Refusal> {
    let numbers: Option<Vec<f64>> = tokens(line).take(N).map(finite).collect();
    numbers.and_then(|all| all.try_into().ok()).ok_or_else(|| {
        let allowed = match N {
            2 => "two finite numbers, where the box begins and where it ends",
            _ => "three finite numbers",
        };
        (excerpt(line), allowed.into())
    })
}
