//! Amplification and phase of the one-step map against ωh, and the stability limits.

use lennard_integrators::IntegratorEntry;
use rayon::prelude::*;
use serde::Serialize;

use super::groups::Group;
use super::map::StepMap;
use super::oscillator::{Spring, excursion, measured_map};
use crate::StudyError;

/// The largest ωh at which a limit is looked for.
pub const LARGEST_OMEGA_H: f64 = 12.0;
/// Stride of the search for the first unstable ωh: fine enough for the narrow windows of instability that
/// methods of several stages have.
const SEARCH_STRIDE: f64 = 0.002;
/// A run counts as bounded while |x| stays below this, from |x| = 1.
pub const BOUND: f64 = 1e6;
/// Steps after which a run counts as bounded.
///
/// Near a limit where the eigenvalues meet, ρ − 1 = √(8δ) at ωh = 2(1 + δ): in 50 000 steps a run grows
/// past 10⁶ if δ > 10⁻⁸, and just inside no amplitude is above 1/√(2δ): 10⁶ for δ = 5·10⁻¹³.
pub const BISECTION_STEPS: u32 = 50_000;
/// Halvings of an interval of 0.002: down to 10⁻¹⁰.
const HALVINGS: u32 = 24;
/// An ωh so small that a method unstable there has no stable step at all.
const SMALLEST_OMEGA_H: f64 = 0.01;
/// How far above 1 a spectral radius must be to count as growth: rounding makes √(8·10⁻¹⁶) of a double
/// eigenvalue.
const RADIUS_ROUNDING: f64 = 1e-7;
/// Steps over which growth is averaged.
const GROWTH_STEPS: u32 = 1_000;

/// The one-step map of a method at one ωh.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MapPoint {
    /// ωh.
    pub omega_h: f64,
    /// Spectral radius of the declared map.
    pub theory_radius: f64,
    /// Spectral radius of the map that three consecutive states of a run show.
    pub measured_radius: f64,
    /// Angle of its eigenvalues, where they are complex.
    pub theory_phase: Option<f64>,
    /// The angle as measured.
    pub measured_phase: Option<f64>,
}

/// The map and the limits of one method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodMap {
    /// The method.
    pub method: &'static str,
    /// Index of the group of methods that share its map.
    pub group: usize,
    /// Theory and measurement against ωh.
    pub points: Vec<MapPoint>,
    /// Largest |measured/theory − 1| of the spectral radius.
    pub largest_radius_difference: f64,
    /// The limit of ωh that the method declares.
    pub declared_limit: Option<f64>,
    /// The limit of its declared map, to rounding; `None` where there is none up to [`LARGEST_OMEGA_H`].
    pub theory_limit: Option<f64>,
    /// The limit that runs show.
    pub measured_limit: Option<f64>,
    /// Whether a run of 20 000 steps at ωh = 1000 stayed bounded, for a method without a limit.
    pub bounded_at_1000: Option<bool>,
}

/// The map that a method declares. A method without one is measured without a theory line.
pub(crate) fn theory(entry: &IntegratorEntry, omega_h: f64) -> Option<StepMap> {
    entry.spec.oscillator_map.map(|map| StepMap(map(omega_h, 1.0)))
}

/// Measures every method of the groups.
pub(crate) fn measure(groups: &[Group], quick: bool) -> Result<Vec<MethodMap>, StudyError> {
    let methods: Vec<(usize, &IntegratorEntry)> = groups
        .iter()
        .enumerate()
        .flat_map(|(g, group)| group.members.iter().map(move |e| (g, *e)))
        .collect();
    let shift = |i: usize| i as f64 / methods.len() as f64;
    methods
        .par_iter()
        .enumerate()
        .map(|(i, (group, entry))| method_map(*group, shift(i), entry, quick))
        .collect()
}

fn method_map(
    group: usize,
    shift: f64,
    entry: &IntegratorEntry,
    quick: bool,
) -> Result<MethodMap, StudyError> {
    // Each method is sampled at places of its own, so that equal marks lie side by side.
    let stride = if quick { 0.8 } else { 0.4 };
    let first = 0.05 + stride * shift;
    let mut points = Vec::new();
    let mut omega_h = first;
    while omega_h <= 4.0 {
        let measured = measured_map(entry, omega_h, 1.0)?;
        let theory = theory(entry, omega_h);
        points.push(MapPoint {
            omega_h,
            theory_radius: theory.map_or(f64::NAN, StepMap::radius),
            measured_radius: measured.radius(),
            theory_phase: theory.and_then(StepMap::phase),
            measured_phase: measured.phase(),
        });
        omega_h += stride;
    }
    let largest_radius_difference = points
        .iter()
        .map(|p| (p.measured_radius / p.theory_radius - 1.0).abs())
        .fold(0.0, f64::max);
    let measured_limit = measured_limit(entry)?;
    let bounded_at_1000 = match measured_limit {
        Some(_) => None,
        None => Some(bounded(entry, 1000.0, BISECTION_STEPS)?),
    };
    Ok(MethodMap {
        method: entry.spec.name,
        group,
        points,
        largest_radius_difference,
        declared_limit: entry.spec.stability_limit,
        theory_limit: theory_limit(entry),
        measured_limit,
        bounded_at_1000,
    })
}

fn bounded(entry: &IntegratorEntry, omega_h: f64, steps: u32) -> Result<bool, StudyError> {
    let spring = Spring::Stiffness(omega_h * omega_h);
    Ok(excursion(entry, spring, 1.0, steps, BOUND)?.largest() < BOUND)
}

/// The first ωh at which runs do not stay bounded. The measured one-step map brackets it, and
/// bisection over runs finds it. It is 0 where even the smallest ωh is unstable.
fn measured_limit(entry: &IntegratorEntry) -> Result<Option<f64>, StudyError> {
    let steady = |x| Ok(measured_map(entry, x, 1.0)?.radius() < 1.0 + RADIUS_ROUNDING);
    let Some((good, bad)) = first_failure(steady)? else {
        return Ok(None);
    };
    bisect(good, bad, |x| bounded(entry, x, BISECTION_STEPS)).map(Some)
}

/// The first ωh at which the spectral radius of the declared map is above 1.
fn theory_limit(entry: &IntegratorEntry) -> Option<f64> {
    let map = |x| theory(entry, x).map(StepMap::radius);
    let steady = |x| Ok(map(x).is_none_or(|r| r < 1.0 + RADIUS_ROUNDING));
    let (good, bad) = first_failure(steady).ok().flatten()?;
    bisect(good, bad, steady).ok()
}

/// The first interval of the search whose upper end is unsteady; (0, 0) where the smallest ωh is.
fn first_failure(
    steady: impl Fn(f64) -> Result<bool, StudyError>,
) -> Result<Option<(f64, f64)>, StudyError> {
    if !steady(SMALLEST_OMEGA_H)? {
        return Ok(Some((0.0, 0.0)));
    }
    let first = (SMALLEST_OMEGA_H / SEARCH_STRIDE).round() as u32 + 1;
    for i in first..=(LARGEST_OMEGA_H / SEARCH_STRIDE) as u32 {
        let x = f64::from(i) * SEARCH_STRIDE;
        if !steady(x)? {
            return Ok(Some((x - SEARCH_STRIDE, x)));
        }
    }
    Ok(None)
}

fn bisect(
    mut good: f64,
    mut bad: f64,
    stable: impl Fn(f64) -> Result<bool, StudyError>,
) -> Result<f64, StudyError> {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (good + bad);
        if middle == 0.0 {
            break;
        }
        if stable(middle)? {
            good = middle;
        } else {
            bad = middle;
        }
    }
    Ok(0.5 * (good + bad))
}

/// The growth per step, (|z_n|/|z_0|)^{1/n} with |z|² = x² + (v/ω)², over [`GROWTH_STEPS`] steps at ωh.
///
/// Exact for methods whose map is a rotation times a factor, such as both plain Euler methods.
pub(crate) fn mean_growth(entry: &IntegratorEntry, omega_h: f64) -> Result<f64, StudyError> {
    let size = |z: glam::DVec2| z.x.hypot(z.y / omega_h);
    let spring = Spring::Stiffness(omega_h * omega_h);
    let mut rig = spring.start(entry, (1.0, 0.0), 1.0)?;
    for _ in 0..GROWTH_STEPS {
        rig.step()?;
    }
    Ok(size(rig.point()).powf(1.0 / f64::from(GROWTH_STEPS)))
}
