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
    /// Keys that its points may vary, tables whose keys they may vary, and both in words; `*` stands for the name of a stage.
    varied: &'static [&'static str],
    in_words: &'static str,
    molecules: Molecules,
}

/// What the fluid of a reading is made of.
enum Molecules {
    /// Atoms, without walls and field.
    None,
    /// Molecules of so many sites.
    Sites(usize),
}

impl Own {
    fn varies(&self, key: &str) -> bool {
        let fits = |allowed: &str| match allowed.split_once('*') {
            Some((table, last)) => key.starts_with(table) && key.ends_with(last),
            None => key.starts_with(allowed),
        };
        self.varied.iter().any(|allowed| fits(allowed))
    }

    /// Refuses a scene whose fluid the reading does not measure.
    fn check_fluid(&self, scene: &Scene) -> Result<(), SceneError> {
        let Molecules::Sites(sites) = self.molecules else {
            return scene.homogeneous_for(self.command);
        };
        scene.unconfined_for(self.command, "a fluid without walls and field")?;
        let found = scene.molecules().sites();
        if found == sites {
            return Ok(());
        }
        let refused = scene.refuse("molecule", "is another one than the study takes");
        let found = format!("{} in a molecule", counted(found, "site"));
        Err(refused.found(found).allowed(format!("{sites}, such as in dumbbell/liquid")))
    }
}

const OWN: [Own; 3] = [
    Own {
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
        molecules: Molecules::None,
    },
    Own {
        reading: "stability",
        is_not: "is no study of stability",
        command: "lennard study stability",
        varied: &[
            "dt",
            "temperature",
            "integrator.",
            "truncation.kind",
            "kernel.precision",
            "stage.*.steps",
        ],
        in_words: "`temperature`, keys of `integrator`, `truncation.kind`, `kernel.precision` and steps of stages",
        molecules: Molecules::None,
    },
    Own {
        reading: "mechanics",
        is_not: "is no study of mechanics",
        command: "lennard study mechanics",
        varied: &[
            "dt",
            "density",
            "temperature",
            "n_molecules",
            "r_cut",
            "bonds.",
            "integrator.",
            "truncation.",
            "stage.",
        ],
        in_words: "`density`, `temperature`, `n_molecules`, and keys of `bonds`, `integrator`, `truncation` and stages",
        molecules: Molecules::Sites(2),
    },
];

/// Reads a study file with overrides for every point. Of the scenes it reads as many as it needs to know each key.
///
/// # Errors
/// [`SweepError`] where the file is wrong, or has more points than a cluster shares.
pub fn plan(path: &Path, overrides: &[(String, String)]) -> Result<Plan, SweepError> {
    let plan = Plan::new(path, StudyFile::load(path)?, overrides)?;
    if let Some(own) = OWN.iter().find(|own| plan.study.readings == [own.reading]) {
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

/// Reads the study file of a command of its own, with the scene that it names.
///
/// # Errors
/// [`SweepError`] where the file is wrong, has another reading, or changes what the reading does not compare.
pub fn of_command(
    reading: &str,
    path: &Path,
    overrides: &[(String, String)],
) -> Result<(Scene, Sweep), SweepError> {
    let plan = Plan::new(path, StudyFile::load(path)?, overrides)?;
    let own = OWN.iter().find(|own| own.reading == reading && plan.study.readings == [reading]);
    let Some(own) = own else {
        let is_not = OWN.iter().find(|own| own.reading == reading).map_or("", |own| own.is_not);
        let refused = plan.study.source.refuse("reading", is_not);
        let found = match plan.study.readings.join(", ") {
            none if none.is_empty() => "no reading".to_owned(),
            readings => format!("{readings:?}"),
        };
        let readings = &plan.study.readings;
        let other = OWN.iter().find(|own| readings.as_slice() == [own.reading]);
        let command = other.map_or("lennard sweep", |own| own.command);
        let allowed = format!("`reading = {reading:?}`, or `{command}` for this file");
        return Err(refused.found(found).allowed(allowed).into());
    };
    plan.check_keys()?;
    plan.fits_one_process()?;
    let (base, study) = (plan.base_scene()?, plan.fitting()?);
    own.check_fluid(&base)?;
    let keys = plan.points.iter().flat_map(PlannedPoint::values).map(|(key, _)| key);
    if let Some(other) = keys.into_iter().find(|key| !own.varies(key)) {
        let refused = study.source.refuse("reading", "compares settings of one fluid");
        let found = format!("points that differ in `{other}`");
        return Err(refused.found(found).allowed(own.in_words).into());
    }
    for point in &study.points {
        own.check_fluid(&point.scene)?;
    }
    Ok((base, study))
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
            if let Some(own) = OWN.iter().find(|own| own.reading == name) {
                return Err(refuse("does not go with others".into())
                    .found(format!(
                        "{name:?} among {}",
                        counted(plan.study.readings.len(), "reading")
                    ))
                    .allowed(format!("`reading = {name:?}` alone, with `{}`", own.command)));
            }
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
