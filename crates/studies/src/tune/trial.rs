//! A choice on trial: independent runs with ten seeds, and every cheaper setting of a whole grid.

use lennard_forcefield::{Precision, TruncationKind};
use lennard_integrators::{IntegratorOptions, blanes_moan};
use lennard_observables::statistics;
use lennard_scene::{Accuracy, Scene};
use serde::Serialize;

use super::sample::Sample;
use super::search::tune_and;
use super::{TuneError, TuneOptions, Tuning};
use crate::Progress;
use crate::chart::grid::{CUTOFFS, TRUNCATIONS};
use crate::jobs::side_by_side_quietly;
use crate::lab::{Failed, Measured, Slopes, Value, Workbench, costs};
use crate::settings::Settings;

/// Steps of the grid, τ.
const STEPS: [f64; 6] = [0.002, 0.004, 0.008, 0.012, 0.016, 0.024];
/// Steps at which the settings of the grid are priced, τ.
const PRICED_STEPS: [f64; 2] = [STEPS[1], STEPS[3]];
/// Largest cost of the choice over the cost of the cheapest setting of the grid that meets the target.
pub const ALLOWED_FACTOR: f64 = 1.3;
/// Step of the tight runs as a share of velocity Verlet's stability limit. They use the method of Blanes and Moan,
/// with six evaluations per step. Its error of fourth order is far below the errors on trial.
const TIGHT_STEP: f64 = 0.25;
/// The same of molecules, whose bonds that method does not hold. Velocity Verlet errs there by a hundredth of what it errs at a third
/// of the limit.
const TIGHT_STEP_OF_MOLECULES: f64 = 0.03;
/// Longest cutoff of the tight runs, σ.
const TIGHT_CUTOFF: f64 = 6.0;
/// Lengths of the runs that reject a cheaper setting, as shares of the runs of the choice: a large error shows soon.
const LENGTHS: [f64; 3] = [0.1, 0.4, 1.0];
/// Standard errors within which a target is met, and beyond which it is missed.
const SIGNIFICANT: f64 = 2.0;

/// How to try.
#[derive(Debug, Clone, Copy)]
pub struct TrialOptions {
    /// How to tune.
    pub tune: TuneOptions,
    /// Independent runs, each from a lattice of its own seed.
    pub seeds: u64,
    /// Length of each run of the chosen settings, τ.
    pub time: f64,
    /// Length of each tight run, τ.
    pub tight_time: f64,
}

/// A cheaper setting of the grid.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cheaper {
    /// In a line.
    pub label: String,
    /// Its cost over the cost of the choice.
    pub cost: f64,
    /// By what it misses; `None` where the runs cannot tell that it does.
    pub misses: Option<String>,
    /// By what it misses as the models of the tuning expect it, where they do.
    pub predicted: Option<String>,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trial {
    /// The choice.
    pub tuning: Tuning,
    /// The tight settings, in a line.
    pub tight: String,
    /// Key, target and error of each quantity over the seeds.
    pub errors: Vec<(String, f64, Value)>,
    /// Whether each error keeps its target within two standard errors.
    pub meets: bool,
    /// Settings of the grid that cost less than the choice by more than the factor allowed.
    pub cheaper: Vec<Cheaper>,
}

impl Trial {
    /// Whether every setting that costs so much less misses the target by its runs, or by the models where these cannot
    /// tell.
    #[must_use]
    pub fn is_cheap(&self) -> bool {
        let misses = |c: &Cheaper| c.misses.is_some() || c.predicted.is_some();
        self.cheaper.iter().all(misses)
    }
}

/// U, P and drift of one run.
type Found = [f64; 3];

/// Where a key of the accuracy stands in [`Found`].
fn quantity(key: &str) -> Option<usize> {
    ["potential_energy", "pressure", "drift"].iter().position(|k| *k == key)
}

/// Independent starts, and runs from them.
struct Seeds {
    benches: Vec<Workbench>,
    slopes: Slopes,
}

impl Seeds {
    fn prepare(scene: &Scene, seeds: u64) -> Result<Self, TuneError> {
        let numbers: Vec<u64> = (0..seeds).map(|s| 70_001 + 13 * s).collect();
        let prepared = side_by_side_quietly(&numbers, |seed| -> Result<Workbench, TuneError> {
            let mut other = scene.clone();
            other.system.seed = *seed;
            let sample = Sample::prepare(&other)?;
            Ok(Workbench::with_start(&sample.own, sample.start))
        });
        let benches: Vec<Workbench> = prepared.into_iter().collect::<Result<_, _>>()?;
        let bench = benches.first().ok_or_else(|| TuneError::Nothing("no seeds".into()))?;
        let slopes = bench.slopes(&Settings::of(bench.scene()), 20.0)?;
        Ok(Self { benches, slopes })
    }

    /// U, P and drift of each seed; or why a run failed.
    fn run(&self, settings: &Settings, time: f64) -> Result<Result<Vec<Found>, Failed>, TuneError> {
        let one = |bench: &Workbench| bench.measure(settings, time, &self.slopes);
        let numbers = |m: Measured| {
            [m.potential_energy_at_reference.mean, m.pressure_at_reference.mean, m.drift.slope]
        };
        let mut found = Vec::new();
        for run in side_by_side_quietly(&self.benches, one) {
            match run {
                Ok(run) => found.push(numbers(run)),
                Err(error) => return Ok(Err(Failed::from_error(error)?)),
            }
        }
        Ok(Ok(found))
    }
}

/// Mean and standard error over seeds of a quantity, less its value in the tight runs of the same seeds.
fn over_seeds(runs: &[Found], tight: &[Found], which: usize) -> Value {
    let reference = |i: usize| if which == 2 { 0.0 } else { tight[i][which] };
    let all: Vec<f64> = runs.iter().enumerate().map(|(i, run)| run[which] - reference(i)).collect();
    let n = all.len() as f64;
    Value {
        mean: statistics::mean(&all),
        standard_error: (statistics::variance(&all) / (n - 1.0)).sqrt(),
        n_effective: n,
    }
}

fn errors(accuracy: &Accuracy, runs: &[Found], tight: &[Found]) -> Vec<(String, f64, Value)> {
    let asked = accuracy.asked().into_iter();
    asked
        .filter_map(|(key, target, _)| {
            let error = over_seeds(runs, tight, quantity(key)?);
            Some((key.to_owned(), target, error))
        })
        .collect()
}

/// Tunes a scene and tries the choice.
///
/// # Errors
/// [`TuneError`] where tuning fails or the tight runs do.
pub fn run(
    scene: &Scene,
    options: &TrialOptions,
    progress: &mut dyn Progress,
) -> Result<Trial, TuneError> {
    progress.update("independent starts", 0.0);
    let seeds = Seeds::prepare(scene, options.seeds)?;
    let bench = &seeds.benches[0];
    let grid = models_of_grid(bench);
    let (tuning, predicted) = tune_and(scene, &options.tune, progress, |models| {
        let all = grid.iter().flat_map(|model| STEPS.map(|dt| model.at(dt)));
        all.map(|settings| Ok(models.of(&settings)?.map(|p| p.total)))
            .collect::<Result<Vec<_>, TuneError>>()
    })?;
    let accuracy = scene.accuracy.unwrap_or_default();
    let tight = tight(bench);
    progress.update("tight runs", 0.1);
    let failed = |f: Failed| TuneError::Nothing(f.reason);
    let of_tight = seeds.run(&tight, options.tight_time)?.map_err(failed)?;
    progress.update("runs of the choice", 0.6);
    let runs = seeds.run(&tuning.settings, options.time)?.map_err(failed)?;
    let errors_found = errors(&accuracy, &runs, &of_tight);
    progress.update("cheaper settings", 0.8);
    let mut cheaper = Vec::new();
    for (settings, which, cost) in cheaper_than(&tuning, bench, &grid)? {
        let all = accuracy.asked().into_iter();
        cheaper.push(Cheaper {
            label: settings.label(),
            cost,
            misses: misses(&seeds, &settings, &accuracy, &of_tight, options.time)?,
            predicted: all
                .filter_map(|(key, target, _)| {
                    let error = predicted[which][quantity(key).filter(|q| *q < 2)?];
                    (error.mean.abs() > target).then(|| off(key, &error))
                })
                .next(),
        });
    }
    cheaper.sort_by(|a, b| b.cost.total_cmp(&a.cost));
    let within = |(_, target, error): &(String, f64, Value)| {
        error.mean.abs() <= target + SIGNIFICANT * error.standard_error
    };
    Ok(Trial {
        tight: tight.label(),
        meets: errors_found.iter().all(within),
        errors: errors_found,
        cheaper,
        tuning,
    })
}

fn tight(bench: &Workbench) -> Settings {
    let longest = super::sample::comfortable_cutoff(bench.start().cell.largest_cutoff());
    let own = Settings::of(bench.scene());
    let (share, base) = if bench.scene().molecule.is_some() {
        (TIGHT_STEP_OF_MOLECULES, own)
    } else {
        let options = IntegratorOptions::BlanesMoan(blanes_moan::Options::default());
        (TIGHT_STEP, own.with_integrator(options))
    };
    Settings {
        dt: bench.scene().integrator.dt * share / super::sample::CAREFUL_STEP,
        ..base.with_truncation(TruncationKind::Cut, TIGHT_CUTOFF.min(longest), true)
    }
}

/// A model of the grid in both precisions.
struct Model {
    double: Settings,
    mixed: Settings,
}

impl Model {
    /// In mixed precision with a step: the errors of both precisions are the same at these targets.
    fn at(&self, dt: f64) -> Settings {
        Settings { dt, ..self.mixed.clone() }
    }
}

/// The truncations and cutoffs of the grid that fit the box.
fn models_of_grid(bench: &Workbench) -> Vec<Model> {
    let base = Settings::of(bench.scene());
    let mut models = Vec::new();
    for (kind, tail) in TRUNCATIONS {
        for r_cut in CUTOFFS {
            let [double, mixed] = [Precision::Double, Precision::Mixed]
                .map(|precision| Settings { precision, ..base.with_truncation(kind, r_cut, tail) });
            if bench.check(&double).is_ok() {
                models.push(Model { double, mixed });
            }
        }
    }
    models
}

/// Every setting of the grid that would cost less than the choice by more than the allowed factor. Its number in the
/// grid and the ratio of the two costs come with it.
fn cheaper_than(
    tuning: &Tuning,
    bench: &Workbench,
    grid: &[Model],
) -> Result<Vec<(Settings, usize, f64)>, TuneError> {
    let mut priced = vec![tuning.settings.clone()];
    for model in grid {
        for settings in [&model.double, &model.mixed] {
            priced.extend(PRICED_STEPS.map(|dt| Settings { dt, ..settings.clone() }));
        }
    }
    let mut prices = Vec::new();
    for (settings, cost) in priced.iter().zip(costs(bench, &priced, 1, 3, 0.05, 1)?) {
        let cost = cost.map_err(|f| TuneError::Nothing(f.reason))?;
        prices.push(cost.wall.lowest * settings.dt);
    }
    let chosen = prices[0] / tuning.settings.dt;
    // A longer step wants a new list sooner: the price of a step is a line in dt.
    let price = |pair: &[f64], dt: f64| {
        let [first, last] = PRICED_STEPS;
        pair[0] + (pair[1] - pair[0]) * (dt - first) / (last - first)
    };
    let mut found = Vec::new();
    for (m, (model, prices)) in grid.iter().zip(prices[1..].chunks(4)).enumerate() {
        for (k, dt) in STEPS.into_iter().enumerate() {
            // Of two precisions the cheaper stands for both.
            let [double, mixed] = [price(&prices[..2], dt), price(&prices[2..], dt)];
            let settings = match mixed < double {
                true => model.at(dt),
                false => Settings { dt, ..model.double.clone() },
            };
            let cost = mixed.min(double) / dt / chosen;
            if cost * ALLOWED_FACTOR < 1.0 {
                found.push((settings, m * STEPS.len() + k, cost));
            }
        }
    }
    Ok(found)
}

/// Whether an error misses its target by more than its uncertainty, in words.
fn miss(key: &str, target: f64, error: &Value) -> Option<String> {
    (error.mean.abs() > target + SIGNIFICANT * error.standard_error).then(|| off(key, error))
}

fn off(key: &str, error: &Value) -> String {
    format!("{key} off by {}", crate::report::plus_minus(error.mean, error.standard_error))
}

/// By what settings miss, where runs of growing length can tell.
fn misses(
    seeds: &Seeds,
    settings: &Settings,
    accuracy: &Accuracy,
    tight: &[Found],
    time: f64,
) -> Result<Option<String>, TuneError> {
    for length in LENGTHS {
        let runs = match seeds.run(settings, length * time)? {
            Ok(runs) => runs,
            Err(failed) => return Ok(Some(failed.reason)),
        };
        for (key, target, error) in errors(accuracy, &runs, tight) {
            if let Some(miss) = miss(&key, target, &error) {
                return Ok(Some(miss));
            }
        }
    }
    Ok(None)
}
