//! Running the points of a sweep side by side, and going on where an earlier sweep stopped.

use std::path::Path;

use lennard_io::{CheckpointFolder, Existing};

use super::point_run::{FolderContents, PointEnd, SweepOptions, contents_of, run_all};
use super::{Ending, Failed, Point, Sweep, SweepError, SweepRecord, SweptPoint, record};
use crate::Progress;
use crate::compare::{RunFolder, StateOfMatter, compare};

/// Runs what is not finished yet, and writes table, page and record.
///
/// # Errors
/// [`SweepError`] where a folder holds something else, a file cannot be written, or the points have nothing for the reading
/// that the study names. A point that fails is no error: the record says so.
pub fn run(
    sweep: &Sweep,
    options: &SweepOptions<'_>,
    progress: &mut dyn Progress,
) -> Result<SweepRecord, SweepError> {
    let points = run_points(sweep, options, progress)?;
    let ending = ending_of(&points, options.folder);
    let read = record::read(sweep, points, ending, options.threads)?;
    match ending {
        Ending::NotBegun => Ok(read.record),
        _ => read.write(options.folder, &options.command),
    }
}

/// Writes table, page and record of the points that many processes have finished, and runs nothing.
///
/// # Errors
/// [`SweepError`] where a file cannot be written. A folder that holds another run is a failure of its point.
pub fn collect(sweep: &Sweep, folder: &Path, command: &str) -> Result<SweepRecord, SweepError> {
    let points = sweep.points.iter().map(|point| {
        let place = folder.join(&point.name);
        let end = match contents_of(&place, point) {
            Ok(FolderContents::Finished) => Ok(PointEnd::FinishedBefore),
            Ok(FolderContents::Begun | FolderContents::Nothing) => Ok(PointEnd::Stopped),
            Err(holds) => Err(Failed::of_input(holds)),
        };
        conclude(point, end, &place)
    });
    let points: Vec<_> = points.collect();
    let ending = if points.iter().any(|p| p.failure.is_some()) {
        Ending::Failed
    } else if points.iter().any(|p| p.is_unfinished()) {
        Ending::Incomplete
    } else {
        Ending::Finished
    };
    record::read(sweep, points, ending, 1)?.write(folder, command)
}

/// Runs what is not finished yet, and writes nothing but the folders of the points: one of many processes that share a sweep.
///
/// # Errors
/// [`SweepError`] where a folder holds something else. A point that fails is no error.
pub fn run_points(
    sweep: &Sweep,
    options: &SweepOptions<'_>,
    progress: &mut dyn Progress,
) -> Result<Vec<SweptPoint>, SweepError> {
    let found: Vec<FolderContents> = sweep
        .points
        .iter()
        .map(|point| look(&options.folder.join(&point.name), point, options.replace))
        .collect::<Result<_, _>>()?;
    let outcomes = run_all(&sweep.points, &found, options, progress);
    let points = sweep.points.iter().zip(outcomes);
    Ok(points
        .map(|(point, outcome)| conclude(point, outcome, &options.folder.join(&point.name)))
        .collect())
}

/// How points ended that were run in a folder.
#[must_use]
pub fn ending_of(points: &[SweptPoint], folder: &Path) -> Ending {
    if points.iter().any(SweptPoint::is_unfinished) {
        if points.iter().any(|p| is_kept(p, folder)) { Ending::Stopped } else { Ending::NotBegun }
    } else if points.iter().any(|p| p.failure.is_some()) {
        Ending::Failed
    } else if points.iter().any(|p| p.elsewhere.is_some()) {
        Ending::Elsewhere
    } else {
        Ending::Finished
    }
}

/// Finds out what an earlier sweep has left, before anything is written.
fn look(folder: &Path, point: &Point, replace: bool) -> Result<FolderContents, SweepError> {
    let found = match contents_of(folder, point) {
        Ok(found @ (FolderContents::Finished | FolderContents::Nothing)) => return Ok(found),
        Ok(FolderContents::Begun) => FolderContents::Begun,
        Err(_) if replace => FolderContents::Nothing,
        Err(found) => {
            let folder = folder.to_owned();
            return Err(SweepError::Folder { folder, found });
        }
    };
    // A run that a process goes on with by itself shows before any point is begun.
    drop(lennard_io::create_named_folder(folder, Existing::Keep)?);
    Ok(found)
}

/// Whether a point has a result, or a checkpoint from which it goes on.
fn is_kept(point: &SweptPoint, folder: &Path) -> bool {
    let checkpoints = CheckpointFolder::new(&folder.join(&point.name));
    point.compared.is_some() || checkpoints.list().is_ok_and(|all| !all.is_empty())
}

fn conclude(point: &Point, outcome: Result<PointEnd, Failed>, folder: &Path) -> SweptPoint {
    let model = lennard_scene::model_kind(&point.scene);
    let equation = lennard_literature::equation_of_state_for(model).ok();
    let mut swept = SweptPoint {
        name: point.name.to_string(),
        settings: point.settings.clone(),
        page: folder.join("report.html").exists().then(|| format!("{}/report.html", point.name)),
        planned: StateOfMatter::new(point.density, point.scene.system.temperature, equation),
        kept: matches!(outcome, Ok(PointEnd::FinishedBefore)),
        failure: None,
        elsewhere: None,
        compared: None,
        record: None,
        wall_s: f64::NAN,
        ns_per_atom_step: f64::NAN,
    };
    match outcome {
        Err(failure) => swept.failure = Some(failure),
        Ok(PointEnd::Stopped) => {}
        Ok(PointEnd::Elsewhere(process)) => swept.elsewhere = Some(process),
        Ok(PointEnd::FinishedBefore | PointEnd::Finished) => match RunFolder::open(folder) {
            Err(e) => swept.failure = Some(Failed::otherwise(&e)),
            Ok(run) => {
                swept.wall_s = run.record.wall_s;
                swept.ns_per_atom_step = run.record.performance.ns_per_atom_step;
                swept.compared = Some(compare(&run));
                swept.record = Some(run.record);
            }
        },
    }
    swept
}
