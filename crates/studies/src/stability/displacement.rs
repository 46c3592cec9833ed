//! Displacement and energy against time, at the stiffnesses of the manual's study.

use std::f64::consts::PI;

use lennard_integrators::IntegratorEntry;
use rayon::prelude::*;
use serde::Serialize;

use super::amplification::theory;
use super::groups::Group;
use super::map::StepMap;
use super::oscillator::{Spring, excursion, measured_map};
use crate::StudyError;

/// Mass of the study, m.
pub const MASS: f64 = 1.0;
/// Step of the study, τ.
pub const STEP: f64 = 0.0167;
/// Displacement at the start, σ; the velocity is zero.
pub const START: f64 = 1.0;
/// Steps of the long runs. Just outside the limit SPOOK turns by a quarter of a circle less 3·10⁻⁵ per step.
/// After so many steps, each half of the run has a sample close to a crest.
const LONG_RUN: u32 = 100_000;
/// |x| at which a long run counts as diverging, σ.
const DIVERGED: f64 = 1e12;

/// One stiffness.
#[derive(Debug, Clone, Serialize)]
pub struct Case {
    /// File stem.
    pub name: &'static str,
    /// The stiffness in words.
    pub title: &'static str,
    /// k, ε/σ².
    pub stiffness: f64,
    /// ωh.
    pub omega_h: f64,
    /// One run for each group of methods.
    pub runs: Vec<Run>,
    /// The long run of each method.
    pub summaries: Vec<Summary>,
}

/// A short run, for the figures.
#[derive(Debug, Clone, Serialize)]
pub struct Run {
    /// The method that stands for its group.
    pub method: &'static str,
    /// Index of the group.
    pub group: usize,
    /// x in σ, from time 0, one per step; ends early where the method stopped.
    #[serde(skip)]
    pub positions: Vec<f64>,
    /// ½kx² + ½mv² in ε, one per step.
    #[serde(skip)]
    pub energies: Vec<f64>,
    /// Why the method stopped, if it did.
    pub stopped: Option<String>,
}

/// A long run.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// The method.
    pub method: &'static str,
    /// Steps of the long run.
    pub steps: u32,
    /// Growth per step by the one-step map.
    pub theory_radius: f64,
    /// Amplitude by the one-step map, σ; `None` where it grows, shrinks or has real eigenvalues.
    pub theory_amplitude: Option<f64>,
    /// max |x| of the long run, σ; `None` where it diverged.
    pub measured_amplitude: Option<f64>,
    /// max |x| of its second half over the same of its first half: 1 where bounded, 0 where it dies away.
    pub growth_of_halves: Option<f64>,
    /// Period by the one-step map over the true one.
    pub theory_period_ratio: Option<f64>,
    /// The same as measured from three consecutive states.
    pub measured_period_ratio: Option<f64>,
}

/// The finite stiffnesses: file stem, words, k, steps of the figures.
fn stiffnesses() -> [(&'static str, &'static str, f64, u32); 4] {
    let scale = MASS / (STEP * STEP);
    [
        ("k-100", "k = 100 ε/σ²", 100.0, 300),
        ("k-inside", "k = 4m/h² − 1", 4.0 * scale - 1.0, 400),
        ("k-outside", "k = 4m/h² + 1", 4.0 * scale + 1.0, 400),
        ("k-aliasing", "k = 4π²m/h²", 4.0 * PI * PI * scale, 100),
    ]
}

/// Runs all cases.
pub(crate) fn measure(groups: &[Group]) -> Result<Vec<Case>, StudyError> {
    stiffnesses()
        .into_iter()
        .map(|(name, title, stiffness, steps)| {
            let omega_h = (stiffness / MASS).sqrt() * STEP;
            let runs = groups
                .par_iter()
                .enumerate()
                .map(|(g, group)| short_run(g, group.first(), stiffness, steps))
                .collect::<Result<_, _>>()?;
            let entries: Vec<&IntegratorEntry> =
                groups.iter().flat_map(|g| g.members.iter().copied()).collect();
            let summaries = entries
                .par_iter()
                .map(|entry| summarise(entry, stiffness, omega_h, LONG_RUN))
                .collect::<Result<_, _>>()?;
            Ok(Case { name, title, stiffness, omega_h, runs, summaries })
        })
        .collect()
}

fn short_run(
    group: usize,
    entry: &IntegratorEntry,
    stiffness: f64,
    steps: u32,
) -> Result<Run, StudyError> {
    let mut rig = Spring::Stiffness(stiffness).start(entry, (START, 0.0), STEP)?;
    let energy = |x: f64, v: f64| 0.5 * stiffness * x * x + 0.5 * MASS * v * v;
    let mut run = Run {
        method: entry.spec.name,
        group,
        positions: vec![START],
        energies: vec![energy(START, 0.0)],
        stopped: None,
    };
    for _ in 0..steps {
        match rig.try_step() {
            Ok(_) => {
                let z = rig.point();
                run.positions.push(z.x);
                run.energies.push(energy(z.x, z.y));
            }
            Err(reason) => {
                run.stopped = Some(reason.to_string());
                break;
            }
        }
    }
    Ok(run)
}

fn summarise(
    entry: &IntegratorEntry,
    stiffness: f64,
    omega_h: f64,
    steps: u32,
) -> Result<Summary, StudyError> {
    let spring = Spring::Stiffness(stiffness);
    let far = excursion(entry, spring, STEP, steps, DIVERGED)?;
    let measured = measured_map(entry, omega_h / STEP, STEP)?;
    // The declared map in units of the step, so that x and v·h have the same size.
    let map = theory(entry, omega_h);
    let neutral = |m: &StepMap| (m.radius() - 1.0).abs() < 1e-9;
    let finite = |x: f64| x.is_finite().then_some(x);
    Ok(Summary {
        method: entry.spec.name,
        steps,
        theory_radius: map.map_or(f64::NAN, StepMap::radius),
        theory_amplitude: map.filter(neutral).and_then(|m| m.amplitude(START, 0.0)),
        measured_amplitude: finite(far.largest()),
        growth_of_halves: finite(far.growth()),
        theory_period_ratio: map.and_then(StepMap::phase).map(|p| omega_h / p),
        measured_period_ratio: measured.phase().map(|p| omega_h / p),
    })
}
