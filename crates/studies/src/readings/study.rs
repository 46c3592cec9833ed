//! What a reading is given.

use crate::sweep::{Sweep, SweptPoint};

/// The points of a study, planned and run.
#[derive(Clone, Copy)]
pub struct StudyPoints<'a> {
    /// The study.
    pub sweep: &'a Sweep,
    /// What came of each point.
    pub swept: &'a [SweptPoint],
    /// Names of figures that other readings have drawn.
    pub drawn: &'a [&'a str],
}
