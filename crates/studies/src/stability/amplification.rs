//! Amplification and phase of the one-step map against ωh, and the stability limits.

use glam::DMat2;
use lennard_integrators::IntegratorEntry;
use lennard_literature::try_bisect;
use lennard_observables::{Cell, Table};
use rayon::prelude::*;

use super::groups::{group_of, groups, methods};
use super::map::StepMap;
use super::oscillator::{Spring, excursion, measured_map};
use crate::StudyError;
use crate::claims::Measured;

/// The largest ωh at which a limit is looked for.
const LARGEST_OMEGA_H: f64 = 12.0;
/// Stride of the search for the first unstable ωh: fine enough for the narrow windows of instability that
/// methods of several stages have.
const SEARCH_STRIDE: f64 = 0.002;
/// A run counts as bounded while |x| stays below this, from |x| = 1.
const BOUND: f64 = 1e6;
/// Steps after which a run counts as bounded.
///
/// Near a limit where the eigenvalues meet, ρ − 1 = √(8δ) at ωh = 2(1 + δ): in 50 000 steps a run grows
/// past 10⁶ if δ > 10⁻⁸, and just inside no amplitude is above 1/√(2δ): 10⁶ for δ = 5·10⁻¹³.
const BISECTION_STEPS: u32 = 50_000;
/// Halvings of an interval of 0.002: down to 10⁻¹⁰.
const HALVINGS: usize = 24;
/// An ωh so small that a method unstable there has no stable step at all.
const SMALLEST_OMEGA_H: f64 = 0.01;
/// How far above 1 a spectral radius must be to count as growth: rounding makes √(8·10⁻¹⁶) of a double
/// eigenvalue.
const RADIUS_ROUNDING: f64 = 1e-7;
/// Points of a line less one.
const DENSE: u32 = 499;
/// Steps over which growth is averaged.
const GROWTH_STEPS: u32 = 1_000;

/// The map that a method declares. A method without one is measured without a theory line: its numbers are none.
pub(crate) fn theory(entry: &IntegratorEntry, omega_h: f64) -> StepMap {
    StepMap(entry.spec.oscillator_map.map_or(DMat2::NAN, |map| map(omega_h, 1.0)))
}

/// Measures the map and the limits of every method.
pub(super) fn measure(quick: bool, found: &mut Measured) -> Result<(), StudyError> {
    let methods = methods();
    // Each method is sampled at places of its own, so that equal marks lie side by side.
    let stride = if quick { 0.8 } else { 0.4 };
    let first = |i: usize| 0.05 + stride * (i as f64 / methods.len() as f64);
    let measured = methods.par_iter().enumerate().map(|(i, entry)| {
        let places = std::iter::successors(Some(first(i)), |x| Some(x + stride));
        let points = places
            .take_while(|x| *x <= 4.0)
            .map(|x| Ok((entry.spec.name, x, theory(entry, x), measured_map(entry, x, 1.0)?)));
        let points = points.collect::<Result<Vec<_>, StudyError>>()?;
        let limit = measured_limit(entry)?;
        // A method without a limit is tried far out.
        let at_1000 = limit.is_none().then(|| bounded(entry, 1000.0, BISECTION_STEPS));
        let differs = points.iter().map(|p| (p.3.radius() / p.2.radius() - 1.0).abs());
        let most = differs.fold(0.0, f64::max);
        Ok((points, (entry.spec, theory_limit(entry), limit, at_1000.transpose()?, most)))
    });
    let measured = measured.collect::<Result<Vec<_>, StudyError>>()?;
    let (points, limits): (Vec<_>, Vec<_>) = measured.into_iter().unzip();
    let points = points.concat();
    for (spec, theory, limit, at_1000, _) in &limits {
        let reached = match (spec.stability_limit, at_1000) {
            (None, Some(false)) => 1000.0,
            _ => limit.unwrap_or(f64::INFINITY),
        };
        let declared = spec.stability_limit.map_or("none".to_owned(), |limit| limit.to_string());
        let number = found.numbers.add("stability limit", reached).of("method", spec.name);
        number.of("declared", declared).theory(theory.unwrap_or(f64::NAN));
    }
    let amplification = Table::rows_of("amplification", &points)
        .column("method", |p| p.0)
        .column("omega h", |p| p.1)
        .column("radius by theory", |p| p.2.radius())
        .column("radius measured", |p| p.3.radius())
        .column("phase by theory", |p| p.2.phase())
        .column("phase measured", |p| p.3.phase())
        .column("phase error", |p| p.3.phase().map(|phase| (phase / p.1 - 1.0).abs()))
        .column("group", |p| group_of(p.0).1.name.as_str())
        .column("index", |p| group_of(p.0).0);
    let caption = "The largest stable ωh on the oscillator: as declared, from the declared map up to ωh = 12, and by \
                   bisection over runs of 50 000 steps, which count as bounded while |x| < 10⁶. A dash: there is no \
                   limit, and the method is tried at ωh = 1000. The last column is the largest relative difference \
                   between the measured and the declared spectral radius.";
    let limits = Table::rows_of("limits", &limits)
        .caption(caption)
        .column("method", |m| m.0.name)
        .column("group", |m| group_of(m.0.name).1.name.as_str())
        .column("limit declared", |m| Cell::rounded(m.0.stability_limit, 8))
        .column("limit by theory", |m| Cell::rounded(m.1, 9))
        .column("limit measured", |m| Cell::rounded(m.2, 9))
        .column("bounded at omega h = 1000", |m| m.3)
        .column("map differs by", |m| Cell::rounded(m.4, 1));
    found.tables.extend([amplification.table(), limits.table()]);
    // The declared map of each group along ωh.
    let along = |i: u32| 0.004 + (4.0 - 0.004) * f64::from(i) / f64::from(DENSE);
    let places = (0..groups().len()).flat_map(|g| (0..=DENSE).map(move |i| (g, along(i))));
    let maps: Vec<_> = places.map(|(g, x)| (g, x, theory(groups()[g].members[0], x))).collect();
    let maps = Table::rows_of("maps", &maps)
        .column("group", |p| groups()[p.0].name.as_str())
        .column("index", |p| p.0)
        .column("omega h", |p| p.1)
        .column("radius", |p| p.2.radius())
        .column("phase error", |p| {
            // The exact solution has no phase error to show on a logarithmic axis.
            let phase = p.2.phase().filter(|_| groups()[p.0].members[0].spec.position_order > 0);
            phase.map(|phase| (phase / p.1 - 1.0).abs())
        });
    found.curves.push(maps.table());
    found.word("methods", methods.len().to_string());
    let shared = groups().iter().filter(|g| g.members.len() > 1);
    let of_one_map = shared.map(|group| {
        let names = group.members.iter().map(|m| format!("`{}`", m.spec.name));
        format!("One map, one line: {}.", names.collect::<Vec<_>>().join(", "))
    });
    found.given.lists.push(("groups", of_one_map.collect()));
    Ok(())
}

fn bounded(entry: &IntegratorEntry, omega_h: f64, steps: u32) -> Result<bool, StudyError> {
    let spring = Spring::Stiffness(omega_h * omega_h);
    Ok(excursion(entry, spring, 1.0, steps, BOUND)?.largest < BOUND)
}

/// The first ωh at which runs do not stay bounded. The measured one-step map brackets it, and
/// bisection over runs finds it. It is 0 where even the smallest ωh is unstable.
fn measured_limit(entry: &IntegratorEntry) -> Result<Option<f64>, StudyError> {
    let steady = |x| Ok(measured_map(entry, x, 1.0)?.radius() < 1.0 + RADIUS_ROUNDING);
    first_failure(steady, |x| bounded(entry, x, BISECTION_STEPS))
}

/// The first ωh at which the spectral radius of the declared map is above 1.
fn theory_limit(entry: &IntegratorEntry) -> Option<f64> {
    let radius = |x| theory(entry, x).radius();
    let steady = |x| Ok(radius(x).is_nan() || radius(x) < 1.0 + RADIUS_ROUNDING);
    first_failure(steady, steady).ok().flatten()
}

/// The middle of what bisection leaves of the first interval of the search whose upper end is unsteady; 0 where the
/// smallest ωh is.
fn first_failure(
    steady: impl Fn(f64) -> Result<bool, StudyError>,
    holds: impl Fn(f64) -> Result<bool, StudyError>,
) -> Result<Option<f64>, StudyError> {
    if !steady(SMALLEST_OMEGA_H)? {
        return Ok(Some(0.0));
    }
    let first = (SMALLEST_OMEGA_H / SEARCH_STRIDE).round() as u32 + 1;
    for i in first..=(LARGEST_OMEGA_H / SEARCH_STRIDE) as u32 {
        let x = f64::from(i) * SEARCH_STRIDE;
        if !steady(x)? {
            let [good, bad] = try_bisect(x - SEARCH_STRIDE, x, HALVINGS, holds)?;
            return Ok(Some(0.5 * (good + bad)));
        }
    }
    Ok(None)
}

/// The growth per step, (|z_n|/|z_0|)^{1/n} with |z|² = x² + (v/ω)², over [`GROWTH_STEPS`] steps at ωh.
///
/// Exact for methods whose map is a rotation times a factor, such as both plain Euler methods.
pub(crate) fn mean_growth(entry: &IntegratorEntry, omega_h: f64) -> Result<f64, StudyError> {
    let spring = Spring::Stiffness(omega_h * omega_h);
    let last = spring.path(entry, (1.0, 0.0), 1.0, GROWTH_STEPS)?[GROWTH_STEPS as usize];
    Ok(last.x.hypot(last.y / omega_h).powf(1.0 / f64::from(GROWTH_STEPS)))
}
