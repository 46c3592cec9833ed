//! Chosen settings against the safest, by independent runs.

use lennard_observables::Estimate;
use serde::Serialize;

use super::predict::Models;
use super::sample::Sample;
use super::survey::Survey;
use crate::StudyError;
use crate::jobs::side_by_side;
use crate::lab::{Failed, Measured, Workbench, mean_of};
use crate::settings::Settings;

/// What runs of some settings measured together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Runs {
    /// Simulated time of all runs, τ.
    pub time: f64,
    /// U at the temperature of comparison, ε per particle.
    pub potential_energy: Estimate,
    /// P at the temperature of comparison, ε/σ³.
    pub pressure: Estimate,
    /// Drift of the conserved energy, ε/τ per particle.
    pub drift: Estimate,
    /// The name of the equation of state of this model, and U and P less its values, where there is one.
    pub against_equation: Option<(String, Estimate, Estimate)>,
}

impl Runs {
    fn of(runs: &[Measured]) -> Self {
        let mean =
            |of: &dyn Fn(&Measured) -> Estimate| mean_of(&runs.iter().map(of).collect::<Vec<_>>());
        let equation = runs.first().and_then(|r| r.against_equation.as_ref());
        Self {
            time: runs.iter().map(|r| r.time).sum(),
            potential_energy: mean(&|r| r.potential_energy_at_reference),
            pressure: mean(&|r| r.pressure_at_reference),
            drift: mean(&|r| r.drift),
            against_equation: equation.map(|found| {
                let all: Vec<_> = runs.iter().filter_map(|r| r.against_equation.as_ref()).collect();
                let u: Vec<Estimate> = all.iter().map(|a| a.potential_energy).collect();
                let p: Vec<Estimate> = all.iter().map(|a| a.pressure).collect();
                (found.source.clone(), mean_of(&u), mean_of(&p))
            }),
        }
    }
}

/// Runs each of `all` settings on every thread from the ends of the survey's chains, for its time in τ.
pub(super) fn runs(
    sample: &Sample,
    survey: &Survey,
    all: &[(&Settings, f64)],
) -> Result<Vec<Result<Runs, Failed>>, StudyError> {
    let slopes = survey.slopes();
    let jobs: Vec<(usize, usize)> = (0..all.len())
        .flat_map(|which| (0..survey.ends.len()).map(move |chain| (which, chain)))
        .collect();
    let run = |(which, chain): &(usize, usize)| {
        let (settings, time) = all[*which];
        let mut scene = sample.own.clone();
        scene.system.seed = scene
            .system
            .seed
            .wrapping_add(2000 + jobs.len() as u64 * *which as u64 + *chain as u64);
        let bench = Workbench::with_start(&scene, survey.ends[*chain].clone());
        bench.measure(settings, time, &slopes)
    };
    let mut found = side_by_side(&jobs, run, |_| {}).into_iter();
    let mut results = Vec::new();
    for _ in all {
        let mut measured = Vec::new();
        let mut failed = None;
        for run in found.by_ref().take(survey.ends.len()) {
            match Failed::or(run)? {
                Ok(run) => measured.push(run),
                Err(run) => failed = Some(run),
            }
        }
        results.push(match failed {
            Some(failed) => Err(failed),
            None => Ok(Runs::of(&measured)),
        });
    }
    Ok(results)
}

/// How far U and P of some settings are from the safest settings: the difference of the runs, and the error that
/// the safest step still makes.
pub(super) fn errors(chosen: &Runs, safest: &Runs, models: &Models<'_>, dt: f64) -> [Estimate; 2] {
    let left = models.of_step(dt);
    let pairs =
        [(chosen.potential_energy, safest.potential_energy), (chosen.pressure, safest.pressure)];
    [0, 1].map(|i| {
        let difference = pairs[i].0.minus(&pairs[i].1);
        Estimate { mean: difference.mean + left[i].mean, ..difference }
    })
}

/// Two independent values of the same, each with the weight of its certainty.
pub(super) fn weighted(a: Estimate, b: Estimate) -> Estimate {
    let (wa, wb) = (a.standard_error.powi(-2), b.standard_error.powi(-2));
    if !(wa.is_finite() && wb.is_finite() && wb > 0.0) {
        return a;
    }
    Estimate::new(
        (wa * a.mean + wb * b.mean) / (wa + wb),
        (wa + wb).sqrt().recip(),
        a.n_effective.min(b.n_effective),
    )
}
