//! From a scene to settings: survey, models, search, verification.

use lennard_observables::Estimate;
use std::time::{Duration, Instant};

use lennard_forcefield::{Precision, TruncationKind};
use lennard_scene::{Accuracy, Judged, Scene};

use super::advice;
use super::choose::{Candidate, Search, place_of};
use super::finish::{FINAL_TIMING, fitting, list_and_threads};
use super::predict::{Models, Stability};
use super::prices::Prices;
use super::sample::Sample;
use super::speed::Speed;
use super::survey::Survey;
use super::verify::{self, Runs};
use super::{Row, SCHEMA, TuneOptions, Tuning, no_accuracy};
use crate::lab::{Cost, costs};
use crate::settings::Settings;
use crate::{Progress, StudyError};

/// Shares of the time for survey, stability, prices, and the runs that verify; the rest is for the start and the end.
const SURVEY: f64 = 0.34;
const STABILITY: f64 = 0.08;
const PRICES: f64 = 0.10;
const VERIFICATION: f64 = 0.32;
/// Share of the verification that the safest settings take: they cost more, and both runs should err alike.
const SAFEST_SHARE: f64 = 0.6;
/// Settings that are verified at most, where the first miss.
const MOST_TRIALS: usize = 3;
/// Share of the first verification's time that each further one takes.
const LATER_SHARE: f64 = 0.3;
/// Factor on the largest step after a run that drifted or failed.
const SHORTER: f64 = 0.8;

/// Finds the settings for the accuracy that a scene asks for.
///
/// # Errors
/// [`StudyError`] where the scene asks for none, where the accuracy cannot be met (saying what can, and what it would
/// cost), and where runs fail.
pub fn tune(
    scene: &Scene,
    options: &TuneOptions,
    progress: &mut dyn Progress,
) -> Result<Tuning, StudyError> {
    let clock = Instant::now();
    let asked = scene.accuracy;
    let accuracy = asked.ok_or_else(|| no_accuracy(scene.source.file()))?;
    let seconds = |share: f64| share * options.seconds;
    let full = scene.wants_full_potential();

    progress.update("equilibrating", 0.0);
    let sample = Sample::prepare(scene)?;
    progress.update("surveying the fluid", 0.05);
    let survey = Survey::run(&sample, Duration::from_secs_f64(seconds(SURVEY)))?;
    progress.update("looking for the longest stable step", 0.05 + SURVEY);
    let each = seconds(STABILITY) * options.threads as f64 / super::predict::RUNGS.len() as f64;
    let stability = Stability::measure(&sample, &survey, accuracy.drift, each)?;
    let models = Models::new(&sample, &survey, &stability, full, seconds(STABILITY))?;
    progress.update("timing cutoffs", 0.05 + SURVEY + STABILITY);
    let prices = Prices::measure(&sample, seconds(PRICES))?;
    let base =
        Settings { list: scene.neighbor.mode, skin: scene.neighbor.skin, ..sample.careful() };
    let mut search = Search {
        scene,
        sample: &sample,
        survey: &survey,
        stability: &stability,
        prices: &prices,
        base: &base,
        accuracy,
        models,
    };
    let safest = safest(&sample, full);
    let mut notes = advice::notes(scene, &sample);
    progress.update("verifying", 0.05 + SURVEY + STABILITY + PRICES);
    let Verified { candidate, runs, measured } =
        search.verified(&safest, seconds(VERIFICATION), &mut notes)?;

    progress.update("timing lists and threads", 0.93);
    let (settings, threads) =
        list_and_threads(scene, &prices.bench, &candidate.settings, options.threads)?;
    let usual = if full {
        let usual = base.usual(sample.largest_cutoff);
        usual.filter(|usual| prices.bench.check(usual).is_ok())
    } else {
        None
    };
    let mut timed = vec![settings.clone(), fitting(&safest, &prices.bench)];
    timed.extend(usual.clone());
    let mut found: Vec<Cost> = Vec::new();
    let (repeats, each) = FINAL_TIMING;
    for cost in costs(&prices.bench, &timed, threads, repeats, each, 1)? {
        found.push(cost.map_err(|failed| StudyError::Nothing(failed.reason))?);
    }
    let usual_errors = match &usual {
        Some(usual) => Some(search.models.of(usual)?.map(|p| p.total)),
        None => None,
    };
    let planned = advice::planned_errors(scene, &sample, &runs, settings.dt);
    let each = sample.fluid.unit();
    let rows = rows(&accuracy, &candidate, &measured, &runs, planned, each);
    let relaxed = advice::relaxed(&accuracy, planned);
    let relaxed = search.choose(&relaxed, None, f64::INFINITY)?.cheapest;
    notes.extend(advice::spending(&rows, relaxed.as_ref(), candidate.price));
    notes.extend(advice::cancelling(&candidate, &accuracy));
    notes.push(advice::beside_equation(scene, &runs));
    let missed = usual_errors.map(|errors| {
        let keys = missed(&accuracy, &errors, None).into_iter();
        keys.map(|key| format!("`{key}`")).collect::<Vec<_>>()
    });
    let usual_cost = found.get(2).copied();
    let beside = usual_cost.as_ref().zip(missed.as_deref());
    let speed = Speed::of(&found[0], &found[1], beside);
    progress.update("done", 1.0);
    Ok(Tuning {
        schema: SCHEMA,
        scene: scene.name.to_string(),
        density: survey.density(),
        temperature: sample.temperature,
        atoms_judged: sample.start.len(),
        about: advice::about(full, &settings),
        label: settings.label(),
        safest: safest.label(),
        settings,
        threads,
        rows,
        cost: found[0],
        safest_cost: found[1],
        usual_cost,
        speed,
        usual_errors,
        runs,
        notes,
        seconds: clock.elapsed().as_secs_f64(),
    })
}

/// Settings that were run, with what that says.
struct Verified {
    candidate: Candidate,
    runs: Runs,
    measured: [Estimate; 2],
}

impl Search<'_> {
    /// Chooses and runs, until prediction and measurement together keep every target.
    fn verified(
        &mut self,
        safest: &Settings,
        seconds: f64,
        notes: &mut Vec<String>,
    ) -> Result<Verified, StudyError> {
        let (accuracy, prices, survey) = (self.accuracy, self.prices, self.survey);
        let time =
            |seconds: f64, settings: &Settings| seconds / (prices.of(settings) * survey.n_atoms);
        let mut largest_step = f64::INFINITY;
        let mut of_safest: Option<Runs> = None;
        for trial in 1..=MOST_TRIALS {
            let choice = self.choose(&accuracy, None, largest_step)?;
            let Some(candidate) = choice.cheapest else {
                return Err(self.refusal(&choice.nearest)?.into());
            };
            let settings = &candidate.settings;
            let share = if trial == 1 { 1.0 - SAFEST_SHARE } else { LATER_SHARE };
            let mut all = vec![(settings, time(share * seconds, settings))];
            if of_safest.is_none() {
                all.push((safest, time(SAFEST_SHARE * seconds, safest)));
            }
            let mut found = verify::runs(self.sample, survey, &all)?;
            if found.len() > 1
                && let Some(run) = found.pop()
            {
                of_safest = Some(run.map_err(|failed| StudyError::Nothing(failed.reason))?);
            }
            let (Some(of_chosen), Some(of_safest)) = (found.pop(), &of_safest) else {
                return Err(StudyError::Nothing("nothing was run to verify".into()));
            };
            let runs = match of_chosen {
                Ok(runs) => runs,
                Err(failed) if trial < MOST_TRIALS => {
                    notes.push(format!("{}: {}", settings.label(), failed.reason));
                    largest_step = SHORTER * settings.dt;
                    continue;
                }
                Err(failed) => return Err(StudyError::Nothing(failed.reason)),
            };
            let measured = verify::errors(&runs, of_safest, &self.models, safest.dt);
            let predicted = [0, 1].map(|i| candidate.predicted[i].total);
            let both = [0, 1].map(|i| verify::weighted(predicted[i], measured[i]));
            let missed = missed(&accuracy, &both, Some(&runs.drift));
            if missed.is_empty() || trial == MOST_TRIALS {
                for key in missed {
                    notes.push(format!(
                    "prediction and measurement together put the error of `{key}` above its target: more --seconds would tell"
                ));
                }
                return Ok(Verified { candidate, runs, measured });
            }
            notes.push(format!(
                "dropped after its run missed {}: {}",
                missed.join(" and "),
                settings.label()
            ));
            if missed.contains(&"drift") {
                largest_step = SHORTER * settings.dt;
            }
            self.models
                .learn(settings.truncation.r_cut, [0, 1].map(|i| both[i].mean - predicted[i].mean));
        }
        Err(StudyError::Nothing("no settings held when they were run".into()))
    }
}

/// The keys whose errors are above their targets: of U and P, and of a measured drift by two standard errors.
fn missed(
    accuracy: &Accuracy,
    errors: &[Estimate; 2],
    drift: Option<&Estimate>,
) -> Vec<&'static str> {
    let asked = accuracy.asked().into_iter();
    asked
        .filter(|(key, target, _)| match place_of(key) {
            Some(i) => errors[i].mean.abs() > *target,
            None => drift.is_some_and(|d| d.mean.abs() - 2.0 * d.standard_error > *target),
        })
        .map(|(key, ..)| key)
        .collect()
}

fn rows(
    accuracy: &Accuracy,
    candidate: &Candidate,
    measured: &[Estimate; 2],
    runs: &Runs,
    planned: [f64; 2],
    each: &str,
) -> Vec<Row> {
    let row = |(key, target, unit): (&str, f64, &str)| {
        let which = place_of(key);
        let predicted = which.map_or((candidate.drift, 0.0), |i| {
            let total = candidate.predicted[i].total;
            (total.mean, total.standard_error)
        });
        let measured = which.map_or(runs.drift, |i| measured[i]);
        Row {
            judged: Judged {
                quantity: key.into(),
                unit: unit.replace("particle", each),
                target,
                predicted: predicted.0,
                predicted_error: predicted.1,
                measured: measured.mean,
                measured_error: measured.standard_error,
            },
            causes: which.map(|i| candidate.predicted[i]),
            planned_error: which.map(|i| planned[i]),
        }
    };
    accuracy.asked().into_iter().map(row).collect()
}

/// The settings against which is measured: the longest cutoff of the sample's box, a careful step, double precision.
fn safest(sample: &Sample, full: bool) -> Settings {
    let careful = sample.careful();
    let longest = sample.comfortable_cutoff();
    let settings = match full {
        true => careful.with_truncation(TruncationKind::Cut, longest, true),
        false => careful,
    };
    Settings { precision: Precision::Double, ..settings }
}
