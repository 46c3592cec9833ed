//! Predicts the error of settings, part by part, before any run with them. Parts are the end of the potential, the step, the drift
//! that it brings, and precision.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use lennard_core::{Part, Want};
use lennard_forcefield::{Model, Precision, SpeciesPair, TruncationKind, TruncationOptions};
use lennard_observables::Estimate;
use lennard_scene::Scene;
use serde::Serialize;

use super::pairs::{Terms, model_of};
use super::sample::Sample;
use super::survey::Survey;
use crate::StudyError;
use crate::jobs::side_by_side;
use crate::lab::{Failed, Workbench};
use crate::settings::Settings;
use crate::stability::groups::stands_for_itself;

/// What the next order leaves unsure of a law in dt, as a share.
const NEXT_ORDER: f64 = 0.1;
/// Step of the longer run from which an unknown law is fitted, as a share of the rough limit of the method. Laws of second order
/// bear a longer one, and the noise of the fit falls with its square.
const FITTED_AT: f64 = 0.25;
const FITTED_AT_SECOND_ORDER: f64 = 0.4;
/// Both runs of a law of second order are that much longer: its noise bounds the step.
const LONGER: f64 = 2.5;
/// Steps at which stability is tried, as shares of the rough limit.
pub(super) const RUNGS: [f64; 7] = [0.25, 0.28, 0.32, 0.36, 0.40, 0.45, 0.50];
/// Shortest run on a rung, τ: less does not tell a drift of 10⁻⁵.
const SHORTEST_RUNG: f64 = 80.0;
/// Without a wanted drift, a step is stable that drifts less than this: 10⁻³ ε/τ per particle is a per cent of T in ten τ.
const LARGEST_DRIFT: f64 = 1e-3;
/// Standard errors from which on a drift counts as seen.
const SEEN: f64 = 3.0;

/// The error of one quantity by its causes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Prediction {
    /// By the end of the potential.
    pub truncation: Estimate,
    /// By the time step.
    pub step: Estimate,
    /// By the precision of the pair terms.
    pub precision: Estimate,
    /// Together.
    pub total: Estimate,
}

impl Prediction {
    fn sum(truncation: Estimate, step: Estimate, precision: Estimate) -> Self {
        let parts = [truncation, step, precision];
        let variance: f64 = parts.iter().map(|p| p.standard_error.powi(2)).sum();
        Self {
            truncation,
            step,
            precision,
            total: Estimate::new(
                parts.iter().map(|p| p.mean).sum(),
                variance.sqrt(),
                truncation.n_effective.min(step.n_effective),
            ),
        }
    }
}

pub(super) const NOTHING: Estimate = Estimate::new(0.0, 0.0, f64::INFINITY);

/// Models of every error, from one survey.
pub(super) struct Models<'a> {
    sample: &'a Sample,
    survey: &'a Survey,
    stability: &'a Stability,
    /// Coefficients of dt^order in U and P.
    law: [Estimate; 2],
    order: i32,
    /// Errors of U and P in mixed precision.
    mixed: [Estimate; 2],
    /// The potential without any cutoff, where U and P wanted are its own.
    full: Option<Terms>,
    known: BTreeMap<(u8, bool, u64), [Estimate; 2]>,
    /// What measurements have added to the truncation's part: at which cutoff, and to U and P.
    learnt: Option<(f64, [f64; 2])>,
}

impl<'a> Models<'a> {
    /// The models for a sample; `seconds` are spent on a law in dt where none is known.
    pub fn new(
        sample: &'a Sample,
        survey: &'a Survey,
        stability: &'a Stability,
        full: bool,
        seconds: f64,
    ) -> Result<Self, StudyError> {
        let method = sample.own.integrator.method.spec();
        let langevin = sample.own.measured_stages().any(|s| {
            matches!(s.thermostat, Some(lennard_integrators::ThermostatOptions::Langevin(_)))
        });
        let like_verlet = method.name == "velocity-verlet" || !stands_for_itself(method.name);
        // Bonds have modes that the sums over pairs do not know.
        let like_verlet = like_verlet && !sample.fluid.has_bonds();
        let (law, order) = if like_verlet && !langevin {
            (survey.step_law(method.half_kicks), 2)
        } else {
            let order = method.position_order.min(method.velocity_order) as i32;
            let order = if langevin { 2 } else { order };
            (fitted_law(sample, survey, stability, order, seconds)?, order)
        };
        let full = if full {
            let whole = TruncationOptions {
                r_cut_in: sample.own.truncation.r_cut_in,
                ..TruncationOptions::new(TruncationKind::Cut, f64::MAX)
            };
            Some(survey.terms(&sample.own, whole)?)
        } else {
            None
        };
        Ok(Self {
            sample,
            survey,
            stability,
            law,
            order,
            mixed: mixed_errors(sample, survey)?,
            full,
            known: BTreeMap::new(),
            learnt: None,
        })
    }

    /// The errors of U and P that settings are expected to make.
    pub(crate) fn of(&mut self, settings: &Settings) -> Result<[Prediction; 2], StudyError> {
        let truncation = self.of_truncation(settings.truncation)?;
        let step = self.of_step(settings.dt);
        let precision = match settings.precision {
            Precision::Double => [NOTHING; 2],
            Precision::Mixed => self.mixed,
        };
        Ok([0, 1].map(|i| Prediction::sum(truncation[i], step[i], precision[i])))
    }

    /// Takes what a measurement at a cutoff has added to the predictions of U and P.
    pub(crate) fn learn(&mut self, r_cut: f64, more: [f64; 2]) {
        let before = self.learnt.map_or([0.0; 2], |(at, before)| {
            let share = (at / r_cut).powi(6).min(1.0);
            before.map(|b| share * b)
        });
        self.learnt = Some((r_cut, [before[0] + more[0], before[1] + more[1]]));
    }

    /// The errors of U and P by the step alone.
    pub(crate) fn of_step(&self, dt: f64) -> [Estimate; 2] {
        let power = dt.powi(self.order);
        self.law.map(|a| {
            Estimate::new(
                a.mean * power,
                power * a.standard_error.hypot(NEXT_ORDER * a.mean),
                a.n_effective,
            )
        })
    }

    /// The drift, ε/τ per particle.
    pub(crate) fn drift(&self, settings: &Settings) -> Result<f64, StudyError> {
        let jump = drift_of_jump(&self.sample.own, settings.truncation, self.survey, settings.dt)?;
        Ok(jump + self.stability.of_step(settings.dt))
    }

    fn of_truncation(
        &mut self,
        truncation: TruncationOptions,
    ) -> Result<[Estimate; 2], StudyError> {
        let Some(full) = &self.full else {
            return Ok([NOTHING; 2]);
        };
        let key = (truncation.kind as u8, truncation.tail_correction, truncation.r_cut.to_bits());
        let found = match self.known.get(&key) {
            Some(found) => *found,
            None => {
                let terms = self.survey.terms(&self.sample.own, truncation)?;
                let found = self.survey.difference(&terms, full).map(|change| change.total());
                self.known.insert(key, found);
                found
            }
        };
        let mut values = found;
        if let Some((r_cut, more)) = self.learnt {
            // What was not foreseen fades with the cutoff as the forces left out do.
            let share = (r_cut / truncation.r_cut).powi(6).min(1.0);
            for (value, more) in values.iter_mut().zip(more) {
                value.mean += share * more;
            }
        }
        Ok(values)
    }
}

/// The errors of U and P in mixed precision: one configuration a chain, evaluated in both.
fn mixed_errors(sample: &Sample, survey: &Survey) -> Result<[Estimate; 2], StudyError> {
    let mut differences = Vec::new();
    for end in &survey.ends {
        let at = |precision| {
            let mut scene = sample.canonical.clone();
            scene.kernel.precision = precision;
            let mut forces = end.forces(&scene)?;
            let (e, _) = end.evaluate(&mut forces, Part::All, Want::ENERGY_AND_VIRIAL)?;
            let energy = e.potential_energy.unwrap_or(f64::NAN) / survey.fluid.units();
            let pressure = e.scalar_virial().unwrap_or(f64::NAN) / (3.0 * survey.volume);
            Ok::<_, StudyError>([energy, pressure])
        };
        let (double, mixed) = (at(Precision::Double)?, at(Precision::Mixed)?);
        differences.push([mixed[0] - double[0], mixed[1] - double[1]]);
    }
    let largest = |i: usize| differences.iter().map(|d| d[i].abs()).fold(0.0, f64::max);
    Ok([0, 1].map(|i| Estimate::new(0.0, largest(i), differences.len() as f64)))
}

/// The coefficients of a law dt^order of which nothing is known. Two runs in the scene's own ensemble give them,
/// one with a short step and one with a long step.
fn fitted_law(
    sample: &Sample,
    survey: &Survey,
    stability: &Stability,
    order: i32,
    seconds: f64,
) -> Result<[Estimate; 2], StudyError> {
    let careful = sample.careful();
    let (share, seconds) = match order {
        2 => (FITTED_AT_SECOND_ORDER, LONGER * seconds),
        _ => (FITTED_AT, seconds),
    };
    let long = Settings {
        dt: (share * sample.limit() * sample.stable_dt)
            .min(stability.ceiling)
            .max(2.0 * careful.dt),
        ..careful.clone()
    };
    let bench = Workbench::with_start(&sample.own, survey.ends[0].clone());
    let slopes = survey.slopes();
    let run = |settings: &&Settings| {
        let time = super::affordable(&bench, settings, seconds)?;
        bench.measure(settings, time, &slopes)
    };
    let runs = side_by_side(&[&careful, &long], run, |_| {});
    let mut runs = runs.into_iter();
    let (Some(careful_run), Some(long_run)) = (runs.next(), runs.next()) else {
        return Ok([NOTHING; 2]);
    };
    let (a, b) = (careful_run?, long_run?);
    let span = long.dt.powi(order) - careful.dt.powi(order);
    let of = |x: &Estimate, y: &Estimate| {
        let d = y.minus(x);
        Estimate { mean: d.mean / span, standard_error: d.standard_error / span, ..d }
    };
    Ok([
        of(&a.potential_energy_at_reference, &b.potential_energy_at_reference),
        of(&a.pressure_at_reference, &b.pressure_at_reference),
    ])
}

/// One try at a long step, with a truncation that ends smoothly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rung {
    /// The step, τ.
    pub dt: f64,
    /// Its drift with standard error, ε/τ per particle; `None` where the run failed.
    pub drift: Option<Estimate>,
}

/// The largest step that may be taken, and the drift that a step brings.
#[derive(Debug, Clone)]
pub(super) struct Stability {
    /// ln|drift| = a − b/dt, where two rungs were seen to drift.
    law: Option<(f64, f64)>,
    /// The largest step that may be taken, τ.
    pub ceiling: f64,
}

impl Stability {
    /// Climbs the rungs at constant energy, `seconds` each.
    pub fn measure(
        sample: &Sample,
        survey: &Survey,
        wanted: Option<f64>,
        seconds: f64,
    ) -> Result<Self, StudyError> {
        let mut scene = sample.own.clone();
        scene.stages = sample.canonical.stages.clone();
        for stage in &mut scene.stages {
            stage.thermostat = None;
            stage.barostat = None;
        }
        let bench = Workbench::with_start(&scene, survey.ends[0].clone());
        let r_cut = sample.careful().truncation.r_cut.min(2.5);
        let smooth = sample.careful().with_truncation(TruncationKind::Switch, r_cut, false);
        let slopes = survey.slopes();
        let climb = |share: &f64| -> Result<Rung, StudyError> {
            let dt = share * sample.limit() * sample.stable_dt;
            let settings = Settings { dt, ..smooth.clone() };
            let found = super::affordable(&bench, &settings, seconds)
                .and_then(|time| bench.measure(&settings, time.max(SHORTEST_RUNG), &slopes));
            Ok(Rung { dt, drift: Failed::or(found)?.ok().map(|m| m.drift) })
        };
        let rungs: Vec<Rung> =
            side_by_side(&RUNGS, climb, |_| {}).into_iter().collect::<Result<_, _>>()?;
        Ok(Self::of(&rungs, wanted))
    }

    fn of(rungs: &[Rung], wanted: Option<f64>) -> Self {
        let limit = wanted.unwrap_or(LARGEST_DRIFT);
        // A drift that is not known to be small is not small.
        let good = |rung: &&Rung| {
            rung.drift.is_some_and(|drift| drift.mean.abs() + drift.standard_error <= limit)
        };
        let ceiling = rungs.iter().take_while(good).last().map(|r| r.dt);
        let seen: Vec<(f64, f64)> = rungs
            .iter()
            .filter_map(|r| Some((r.dt, r.drift?)))
            .filter(|(_, drift)| drift.mean.abs() > SEEN * drift.standard_error)
            .map(|(dt, drift)| (1.0 / dt, drift.mean.abs().ln()))
            .collect();
        let law = match seen.as_slice() {
            [.., (x1, y1), (x2, y2)] if y2 > y1 => {
                let b = (y2 - y1) / (x1 - x2);
                Some((y2 + b * x2, b))
            }
            _ => None,
        };
        // Where even the shortest rung drifts too much, half of it is what is left to be verified.
        let shortest = rungs.first().map_or(0.0, |r| 0.5 * r.dt);
        Self { law, ceiling: ceiling.unwrap_or(shortest) }
    }

    /// The drift that the step brings, ε/τ per particle: exponentially small below the limit.
    pub(crate) fn of_step(&self, dt: f64) -> f64 {
        self.law.map_or(0.0, |(a, b)| (a - b / dt).exp())
    }
}

/// The drift that a jump of the force at the cutoff brings, ε/τ per particle.
///
/// A pair that crosses r_cut at a share α of a step gains the energy F·v·h·(α − ½), with the jump F and the radial
/// speed v. The mean of this is zero, and its variance F²v²h²/12. The map is reversible and keeps volume in phase
/// space, so energy diffuses towards more states. The drift is half the growth of the variance over T. Pairs cross at
/// the rate ½Nρ·4πr²g(r)⟨|v|⟩, and ⟨|v|³⟩ = 2√(2/π)·(T/μ)^{3/2} for relative velocities with the reduced mass μ. Species
/// add up pair by pair.
fn drift_of_jump(
    scene: &Scene,
    truncation: TruncationOptions,
    survey: &Survey,
    dt: f64,
) -> Result<f64, StudyError> {
    let mut scene = scene.clone();
    scene.truncation = truncation;
    let (t, fluid) = (survey.temperature, &survey.fluid);
    // Bonds held rigid take degrees of freedom from the sites.
    let share = fluid.n_dof() / (3.0 * survey.n_atoms - 3.0);
    let mut growth = 0.0;
    for (i, kind) in fluid.kinds.iter().enumerate() {
        let [a, b] = kind.species;
        let pair = scene.species_pair(a, b);
        let model = model_of(&scene, &pair)?;
        let pairs = kind.pairs / (fluid.units() * survey.volume);
        let g = survey.g(i, model.r_cut * pair.sigma);
        let squared_speed = share * t * kind.inverse_mass();
        growth += variance_growth(&model, &pair, pairs * g, squared_speed, dt);
    }
    Ok(0.5 * growth / t)
}

/// How fast the variance of the energy grows by pairs of one kind that cross their cutoff, ε²/τ a particle or molecule.
///
/// `crossing` is their number for each volume and each particle or molecule, σ⁻³, times g at the cutoff. `squared_speed` is the mean
/// square of their relative velocity along one axis, (σ/τ)²: T over the reduced mass.
fn variance_growth(
    model: &Model,
    pair: &SpeciesPair,
    crossing: f64,
    squared_speed: f64,
    dt: f64,
) -> f64 {
    let x = model.r_cut;
    let r = x * pair.sigma;
    let jump = model.eval(x * x).force * x * pair.epsilon / pair.sigma;
    let cubed_speed = 2.0 * (2.0 / PI).sqrt() * squared_speed.powf(1.5);
    crossing * 4.0 * PI * r * r * cubed_speed * (jump * dt).powi(2) / 12.0
}

#[cfg(test)]
mod tests;
