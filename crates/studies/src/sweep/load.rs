//! Reading a study file.

use std::collections::BTreeSet;
use std::path::Path;

use lennard_scene::study::StudyFile;
use lennard_scene::{Name, Scene, SceneError};

use super::{Plan, PlannedPoint, Sweep, SweepError};
use crate::readings::READINGS;
use crate::report::counted;

/// A reading of a command of its own, which runs all points from starts that they share.
struct Own {
    reading: &'static str,
    /// What a file with another reading is not.
    is_not: &'static str,
    command: &'static str,
    /// Keys that its points may vary, tables whose keys they may vary, and both in words.
    varied: &'static [&'static str],
    in_words: &'static str,
}

const CHART: Own = Own {
    reading: "chart",
    is_not: "is no chart",
    command: "lennard chart",
    varied: &[
        "dt",
        "r_cut",
        "integrator.",
        "split.",
        "truncation.",
        "neighbor.",
        "kernel.precision",
    ],
    in_words: "keys of `integrator`, `split`, `truncation` and `neighbor`, and `kernel.precision`",
};

const STABILITY: Own = Own {
    reading: "stability",
    is_not: "is no study of stability",
    command: "lennard study stability",
    varied: &["dt", "temperature", "integrator.", "truncation.kind", "kernel.precision", "stage."],
    in_words: "`temperature`, keys of `integrator`, `truncation.kind`, `kernel.precision` and steps of stages",
};

/// Reads a study file with overrides for every point. Of the scenes it reads as many as it needs to know each key.
///
/// # Errors
/// [`SweepError`] where the file is wrong, or has more points than a cluster shares.
pub fn plan(path: &Path, overrides: &[(String, String)]) -> Result<Plan, SweepError> {
    let plan = Plan::new(path, StudyFile::load(path)?, overrides)?;
    if let Some(own) = [CHART, STABILITY].iter().find(|own| plan.study.readings == [own.reading]) {
        let refused = plan.study.source.refuse("reading", "is not read from a sweep");
        let found = format!("{:?}, which runs all points from one start", own.reading);
        return Err(refused
            .found(found)
            .allowed(format!("`{}` for this file", own.command))
            .into());
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
    from_one_start(path, overrides, &CHART)
}

/// Reads the study file of stability, with the scene that it names.
///
/// # Errors
/// [`SweepError`] where the file is wrong, is read otherwise, or changes what the study does not compare.
pub fn stability(path: &Path) -> Result<(Scene, Sweep), SweepError> {
    from_one_start(path, &[], &STABILITY)
}

fn from_one_start(
    path: &Path,
    overrides: &[(String, String)],
    own: &Own,
) -> Result<(Scene, Sweep), SweepError> {
    let plan = Plan::new(path, StudyFile::load(path)?, overrides)?;
    if plan.study.readings != [own.reading] {
        let refused = plan.study.source.refuse("reading", own.is_not);
        let found = match plan.study.readings.join(", ") {
            none if none.is_empty() => "no reading".to_owned(),
            readings => format!("{readings:?}"),
        };
        let allowed = format!("`reading = {:?}`, or `lennard sweep` for this file", own.reading);
        return Err(refused.found(found).allowed(allowed).into());
    }
    plan.check_keys()?;
    plan.fits_one_process()?;
    let study = plan.fitting()?;
    let keys = study.points.iter().flat_map(|point| &point.settings).map(|s| s.key.as_str());
    let is_varied = |key: &str| key == "name" || own.varied.iter().any(|v| key.starts_with(v));
    if let Some(other) = keys.into_iter().find(|key| !is_varied(key)) {
        let refused = study.source.refuse("reading", "compares settings of one fluid");
        let found = format!("points that differ in `{other}`");
        return Err(refused.found(found).allowed(own.in_words).into());
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
