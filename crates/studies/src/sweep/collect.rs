//! The table of a sweep from what many processes have left in its folder.

use std::path::Path;

use super::ran::{Failed, Found, Ran};
use super::run::{Ending, SweepRecord, conclude, found_in, record, write};
use super::{Sweep, SweepError};

/// Writes table, page and record of the points that are finished, and runs nothing.
///
/// # Errors
/// [`SweepError`] where a file cannot be written. A folder that holds another run is a failure of its point.
pub fn collect(sweep: &Sweep, folder: &Path, command: &str) -> Result<SweepRecord, SweepError> {
    let points = sweep.points.iter().map(|point| {
        let place = folder.join(&point.name);
        let outcome = match found_in(&place, point) {
            Ok(Found::Finished) => Ok(Ran::Kept),
            Ok(Found::Begun | Found::Nothing) => Ok(Ran::Stopped),
            Err(holds) => Err(Failed::of_input(holds)),
        };
        conclude(point, outcome, &place)
    });
    let points: Vec<_> = points.collect();
    let ending = if points.iter().any(|p| p.failure.is_some()) {
        Ending::Failed
    } else if points.iter().any(|p| p.is_unfinished()) {
        Ending::Incomplete
    } else {
        Ending::Finished
    };
    let record = record(sweep, points, ending, 1);
    write(sweep, &record, folder, command)?;
    Ok(record)
}
