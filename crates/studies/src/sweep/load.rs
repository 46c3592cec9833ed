//! Reading a study file.

use std::collections::BTreeSet;
use std::path::Path;

use lennard_scene::study::StudyFile;
use lennard_scene::{Name, Scene, SceneError};

use super::{Plan, PlannedPoint, Sweep, SweepError};
use crate::readings::READINGS;
use crate::report::counted;

/// The reading of a chart.
const CHART: &str = "chart";
/// Keys that a chart varies, and tables whose keys it varies.
const VARIED: [&str; 7] =
    ["dt", "r_cut", "integrator.", "split.", "truncation.", "neighbor.", "kernel.precision"];

/// Reads a study file with overrides for every point. Of the scenes it reads as many as it needs to know each key.
///
/// # Errors
/// [`SweepError`] where the file is wrong, or has more points than a cluster shares.
pub fn plan(path: &Path, overrides: &[(String, String)]) -> Result<Plan, SweepError> {
    let plan = Plan::new(path, StudyFile::load(path)?, overrides)?;
    if plan.study.readings == [CHART] {
        let refused = plan.study.source.refuse("reading", "is not read from a sweep");
        let found = format!("{CHART:?}, which runs all points from one start");
        return Err(refused.found(found).allowed("`lennard chart` for this file").into());
    }
    plan.check_keys()?;
    check_readings(&plan)?;
    Ok(plan)
}

/// Reads the study file of a chart, with the scene that it names.
///
/// # Errors
/// [`SweepError`] where the file is wrong, is read otherwise, or changes more than settings.
pub fn chart(path: &Path, overrides: &[(String, String)]) -> Result<(Scene, Sweep), SweepError> {
    let plan = Plan::new(path, StudyFile::load(path)?, overrides)?;
    if plan.study.readings != [CHART] {
        let refused = plan.study.source.refuse("reading", "is no chart");
        let found = match plan.study.readings.join(", ") {
            none if none.is_empty() => "no reading".to_owned(),
            readings => format!("{readings:?}"),
        };
        let allowed = format!("`reading = {CHART:?}`, or `lennard sweep` for this file");
        return Err(refused.found(found).allowed(allowed).into());
    }
    plan.check_keys()?;
    plan.fits_one_process()?;
    let study = plan.fitting()?;
    let keys = study.points.iter().flat_map(|point| &point.settings).map(|s| s.key.as_str());
    let is_setting = |key: &str| key == "name" || VARIED.iter().any(|v| key.starts_with(v));
    if let Some(other) = keys.into_iter().find(|key| !is_setting(key)) {
        let refused = study.source.refuse("reading", "compares settings of one fluid");
        let found = format!("points that differ in `{other}`");
        let allowed =
            "keys of `integrator`, `split`, `truncation` and `neighbor`, and `kernel.precision`";
        return Err(refused.found(found).allowed(allowed).into());
    }
    Ok((plan.base_scene()?, study))
}

/// Reads a study file with another scene in the place of its own. Points that do not fit this scene are left out, with the reason.
///
/// # Errors
/// [`SweepError`] where the file is wrong, or fits the scene with no point.
pub fn over(
    study: &Path,
    scene: &Path,
    overrides: &[(String, String)],
) -> Result<Sweep, SweepError> {
    let file = StudyFile { base: scene.to_owned(), ..StudyFile::load(study)? };
    let mut plan = Plan::new(study, file, overrides)?;
    plan.name = Name::new(format!("{}-{}", Name::of_file(scene), plan.name)).unwrap_or(plan.name);
    plan.fits_one_process()?;
    plan.fitting()
}

/// Reads a study file with overrides for every point, and checks the scene of each.
///
/// # Errors
/// [`SweepError`] where the file or the scene of a point is wrong, or one process would run more than ten thousand points.
pub fn load(path: &Path, overrides: &[(String, String)]) -> Result<Sweep, SweepError> {
    let plan = plan(path, overrides)?;
    plan.fits_one_process()?;
    plan.sweep()
}

/// Refuses readings that are unknown, or whose axis the study has not got.
fn check_readings(plan: &Plan) -> Result<(), SceneError> {
    let refuse = |message: String| plan.study.source.refuse("reading", message);
    for name in &plan.study.readings {
        let Some(reading) = READINGS.iter().find(|reading| reading.name == name) else {
            let known: Vec<&str> = READINGS.iter().map(|reading| reading.name).collect();
            return Err(refuse("is not known".into())
                .found(format!("{name:?}"))
                .allowed(known.join(", "))
                .suggestion(lennard_scene::nearest(name, known.iter().copied())));
        };
        for (key, fewest) in reading.needs {
            let values = plan.points.iter().flat_map(PlannedPoint::values);
            let of_key: BTreeSet<&str> =
                values.filter(|(k, _)| k == key).map(|(_, words)| words).collect();
            if of_key.len() < *fewest {
                return Err(refuse(format!("lacks its axis: `{name}`"))
                    .found(format!("{} of `{key}`", counted(of_key.len(), "value")))
                    .allowed(format!("{fewest} values of `{key}` or more: {}", reading.about)));
            }
        }
    }
    Ok(())
}
