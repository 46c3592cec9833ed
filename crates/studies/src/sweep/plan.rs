//! A sweep before the scenes of its points are read, so that one point of ten thousand is found at once.

use std::ops::Range;
use std::path::PathBuf;

use lennard_scene::Name;

use super::points::{self, PlannedPoint};
use super::{Sweep, SweepError};

/// A sweep file, read, with the names of its points.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Its name; the file's stem unless the file gives another.
    pub name: Name,
    /// The sweep file.
    pub file: PathBuf,
    /// The file of its base scene.
    pub base: PathBuf,
    /// Scene keys of all points, with their values.
    pub(super) common: Vec<(String, String)>,
    /// Its points, in the order of the file.
    pub points: Vec<PlannedPoint>,
}

impl Plan {
    /// The sweep with all its points.
    ///
    /// # Errors
    /// [`SweepError`] where the scene of a point is wrong.
    pub fn sweep(&self) -> Result<Sweep, SweepError> {
        self.part(0..self.points.len())
    }

    /// The sweep with some of its points, by number from 0; numbers beyond the last point are left out.
    ///
    /// # Errors
    /// [`SweepError`] where the scene of one of these points is wrong.
    pub fn part(&self, numbers: Range<usize>) -> Result<Sweep, SweepError> {
        let end = numbers.end.min(self.points.len());
        let planned = &self.points[numbers.start.min(end)..end];
        let points = planned.iter().map(|p| points::point(&self.base, &self.common, p));
        Ok(Sweep {
            name: self.name.clone(),
            base: self.base.clone(),
            points: points.collect::<Result<_, _>>()?,
        })
    }

    /// The number of a point that is given by its number or its name.
    ///
    /// # Errors
    /// [`SweepError::NoPoint`] with the nearest name.
    pub fn number_of(&self, point: &str) -> Result<usize, SweepError> {
        let by_number = point.parse().ok().filter(|n| *n < self.points.len());
        let by_name = || self.points.iter().position(|p| p.name == point);
        by_number.or_else(by_name).ok_or_else(|| {
            let names = self.points.iter().map(|p| p.name.as_str());
            SweepError::NoPoint {
                file: self.file.clone(),
                found: point.to_owned(),
                last: self.points.len() - 1,
                nearest: lennard_scene::nearest(point, names),
            }
        })
    }
}
