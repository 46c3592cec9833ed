//! What the readers of LAMMPS' files share.

use glam::DVec3;
use lennard_core::PeriodicBox;

use crate::error::excerpt;
use crate::lines::{finite, tokens};
use crate::xyz_header::Refusal;

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

/// A token as a number of any kind.
pub(crate) fn whole<T: std::str::FromStr>(token: &[u8]) -> Option<T> {
    std::str::from_utf8(token).ok()?.parse().ok()
}

/// A finite number, or what is said of anything else.
pub(crate) fn number(token: &[u8]) -> Result<f64, Refusal> {
    finite(token).ok_or_else(|| (excerpt(token), "a finite number".to_string()))
}

/// Brings what belongs to particles into the order of their numbers.
pub(crate) struct Order(Option<Vec<usize>>);

impl Order {
    /// The order of these numbers, no two of which may be equal.
    pub(crate) fn of(ids: &[u64]) -> Result<Self, Refusal> {
        if ids.windows(2).all(|pair| pair[0] < pair[1]) {
            return Ok(Self(None));
        }
        let mut order: Vec<usize> = (0..ids.len()).collect();
        order.sort_by_key(|i| ids[*i]);
        match order.windows(2).find(|pair| ids[pair[0]] == ids[pair[1]]) {
            Some(pair) => Err((
                format!("two particles with the number {}", ids[pair[0]]),
                "a number of its own for each particle".into(),
            )),
            None => Ok(Self(Some(order))),
        }
    }

    /// Brings an array into this order; an empty one stays so.
    pub(crate) fn sort<T: Copy>(&self, all: &mut Vec<T>) {
        if let Some(order) = &self.0
            && !all.is_empty()
        {
            *all = order.iter().map(|i| all[*i]).collect();
        }
    }
}
