//! The claims about a stiff oscillator, mostly of SPOOK's manual, beside the measurements.

use super::OscillatorStudy;
use super::amplification::mean_growth;
use super::displacement::{Case, STEP};
use super::groups::entry;
use crate::StudyError;
use crate::claims::Demand::{self, Above, Below, Near};
use crate::claims::Source::{self, Manual, Ours};
use crate::claims::{Claim, ROUNDING, judged};

const HALVES: &str = "max |x|, second half of the long run over the first";
const SAMPLING: &str = "the largest of many samples of a cosine misses its crest by less";

/// Largest growth between the halves of a long run that still counts as none.
const NO_GROWTH: f64 = 1.001;

/// The number of a method at a stiffness that decides.
#[derive(Clone, Copy)]
enum Number {
    Growth,
    Period,
    Halves,
    Amplitude,
}

/// Who claims it, by which number it is judged, what it says, and the stiffnesses and methods that it is about.
type Row = (Source, Number, Demand, &'static str, &'static [(&'static str, &'static str)]);

const SPOOK: &str = "spook";
const EULER: &str = "symplectic-euler";

/// A number that a diverged run does not have.
pub(crate) fn or_infinity(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::INFINITY)
}

/// The number, and what theory gives for it. A growth factor or a phase is averaged over many steps, so that 10⁻¹⁰ is its
/// rounding. In a long run the phases that are sampled fill the circle to 10⁻³, and a crest is missed by half its square.
fn judge(row: &Row, case: &Case, method: &'static str) -> Result<Claim, StudyError> {
    let (source, number, demand, words, _) = *row;
    let summary = case.summaries.iter().find(|s| s.method == method);
    let s = summary.ok_or(StudyError::NoSuchMethod(method))?;
    let (quantity, measured, theory) = match number {
        Number::Growth => (
            "growth per step over 1000 steps",
            mean_growth(entry(method)?, case.omega_h)?,
            Some((s.theory_radius, 1e-10, ROUNDING)),
        ),
        Number::Period => (
            "period over the true period",
            s.measured_period_ratio.unwrap_or(f64::NAN),
            s.theory_period_ratio.map(|p| (p, 1e-10, ROUNDING)),
        ),
        Number::Halves => {
            (HALVES, or_infinity(s.growth_of_halves), Some((1.0, NO_GROWTH - 1.0, SAMPLING)))
        }
        Number::Amplitude => (
            "max |x| / σ over the long run",
            or_infinity(s.measured_amplitude),
            s.theory_amplitude.map(|a| (a, 1e-6 * a, SAMPLING)),
        ),
    };
    let statement = format!("{}: `{method}` {words}", case.title);
    let claim = judged(source, statement, quantity, demand, measured);
    Ok(match theory {
        Some(theory) => claim.with_theory(theory),
        None => claim,
    })
}

/// Claims about each finite stiffness.
pub(crate) fn finite(study: &OscillatorStudy) -> Result<Vec<Claim>, StudyError> {
    use Number::{Amplitude, Growth, Halves, Period};
    let close = |value: f64, within: f64| Near { value, within };
    let swing = (2.0 + 0.25 * STEP * STEP).sqrt();
    let soft = &[("k-100", SPOOK), ("k-100", EULER)];
    let bounded = &[
        ("k-100", SPOOK),
        ("k-100", EULER),
        ("k-inside", EULER),
        ("k-outside", SPOOK),
        ("k-aliasing", SPOOK),
    ];
    let outside = &[("k-outside", SPOOK)];
    let swings = "has the amplitude √(1 + ω²h²/4)";
    let rows: [Row; 9] = [
        (Manual, Growth, Above(1.0), "diverges", &[("k-100", "explicit-euler")]),
        (Manual, Growth, Below(1.0), "decays", &[("k-100", "implicit-euler")]),
        (Manual, Period, close(1.0, 0.01), "follows the analytic solution", soft),
        (Manual, Halves, Below(NO_GROWTH), "stays within a bound", bounded),
        (Manual, Amplitude, Above(100.0), "has an amplitude above 100", &[("k-inside", EULER)]),
        (Manual, Amplitude, Above(1e9), "diverges", &[("k-outside", EULER)]),
        (Ours, Amplitude, close(swing, 1e-6 * swing), swings, outside),
        (Manual, Period, Above(1.01), "has the wrong period", outside),
        (Manual, Amplitude, Above(1.5), "has a larger amplitude", &[("k-aliasing", SPOOK)]),
    ];
    let mut all = Vec::new();
    for case in &study.cases {
        for row in &rows {
            let here = row.4.iter().filter(|(name, _)| *name == case.name);
            for (_, method) in here {
                all.push(judge(row, case, method)?);
            }
        }
    }
    Ok(all)
}

/// Claims where a one-step map has one eigenvector: at the limit of symplectic Euler, and of SPOOK at k = ∞.
pub(crate) fn defective(study: &OscillatorStudy) -> Vec<Claim> {
    let found = &study.infinite;
    let n = f64::from(found.steps);
    let reason = "rounding splits the double eigenvalue";
    let linear = ((2.0 * n + 1.0) / (n + 1.0), 1e-3, reason);
    let bounded = |statement: &str, growth: f64| {
        let claim = judged(Manual, statement, HALVES, Below(NO_GROWTH), growth);
        claim.with_theory(linear)
    };
    let limit = "k ≤ 4m/h²: semi-implicit Euler is stable, the limit itself included";
    let rigid = found.rigid.iter().map(|run| {
        if run.damping_steps == 0.0 {
            let statement = "k = ∞, τ = 0: SPOOK does not diverge";
            return bounded(statement, run.growth_of_halves);
        }
        let statement = format!("k = ∞, τ = {} h: SPOOK does not diverge", run.damping_steps);
        let what = "spectral radius of the measured one-step map";
        let reason = "rounding of a double eigenvalue at γ = 1/9";
        judged(Manual, statement, what, Below(1.0), run.measured_radius).with_theory((
            run.theory_radius,
            2e-8,
            reason,
        ))
    });
    std::iter::once(bounded(limit, found.at_limit.growth_of_halves)).chain(rigid).collect()
}
