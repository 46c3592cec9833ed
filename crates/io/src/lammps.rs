//! What the readers of LAMMPS' files share.

use glam::DVec3;
use lennard_core::PeriodicBox;

use crate::error::{Refusal, excerpt};
use crate::lines::{finite, tokens};

/// Where a box begins, and the box.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds {
    pub(crate) low: DVec3,
    pub(crate) cell: PeriodicBox,
}

impl Bounds {
    /// The box between two corners.
    pub(crate) fn new(low: DVec3, high: DVec3) -> Result<Self, Refusal> {
        let cell = PeriodicBox::new(high - low).map_err(|_| {
            (
                format!("a box from {low} to {high}"),
                "box sides that are positive".to_string(),
            )
        })?;
        Ok(Self { low, cell })
    }
}

/// The two numbers that a line begins with.
pub(crate) fn bound(line: &[u8]) -> Result<[f64; 2], Refusal> {
    let numbers: Vec<Option<f64>> = tokens(line).take(2).map(finite).collect();
    match numbers.as_slice() {
        [Some(low), Some(high)] => Ok([*low, *high]),
        _ => Err((
            excerpt(line),
            "two finite numbers, where the box begins and where it ends".into(),
        )),
    }
}

/// What is said of a box that is not orthorhombic.
pub(crate) fn triclinic(line: &[u8]) -> Refusal {
    (
        format!("{}, a triclinic box", excerpt(line)),
        "an orthorhombic box; triclinic boxes are not there yet".into(),
    )
}
