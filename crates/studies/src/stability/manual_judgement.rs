//! The claims about a stiff oscillator, mostly of SPOOK's manual, beside the measurements.

use super::OscillatorStudy;
use super::amplification::mean_growth;
use super::displacement::STEP;
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

/// Who claims it, at which stiffness, of which method, judged by which number, and what it says.
type Row = (
    Source,
    &'static str,
    &'static str,
    Number,
    Demand,
    &'static str,
);

/// A number that a diverged run does not have.
pub(crate) fn or_infinity(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::INFINITY)
}

/// A growth factor or a phase is averaged over many steps, so that 10⁻¹⁰ is its rounding. In a long run the phases
/// that are sampled fill the circle to 10⁻³, and a crest is missed by half the square of that.
fn of_row(study: &OscillatorStudy, row: Row) -> Result<Claim, StudyError> {
    let (source, case, method, number, demand, statement) = row;
    let cases = &mut study.cases.iter();
    let case = cases.find(|c| c.name == case);
    let case = case.ok_or(StudyError::NoSuchMethod(method))?;
    let summaries = &mut case.summaries.iter();
    let summary = summaries.find(|s| s.method == method);
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
        Number::Halves => (
            HALVES,
            or_infinity(s.growth_of_halves),
            Some((1.0, NO_GROWTH - 1.0, SAMPLING)),
        ),
        Number::Amplitude => (
            "max |x| / σ over the long run",
            or_infinity(s.measured_amplitude),
            s.theory_amplitude.map(|a| (a, 1e-6 * a, SAMPLING)),
        ),
    };
    let claim = judged(source, statement, quantity, demand, measured);
    Ok(match theory {
        Some(theory) => claim.with_theory(theory),
        None => claim,
    })
}

/// Claims about each finite stiffness.
pub(crate) fn finite(study: &OscillatorStudy) -> Result<Vec<Claim>, StudyError> {
    let (spook, euler) = ("spook", "symplectic-euler");
    let follows = Near {
        value: 1.0,
        within: 0.01,
    };
    let swing = (2.0 + 0.25 * STEP * STEP).sqrt();
    let swings = Near {
        value: swing,
        within: 1e-6 * swing,
    };
    let rows: [Row; 14] = [
        (
            Manual,
            "k-100",
            "explicit-euler",
            Number::Growth,
            Above(1.0),
            "k = 100: explicit Euler diverges",
        ),
        (
            Manual,
            "k-100",
            "implicit-euler",
            Number::Growth,
            Below(1.0),
            "k = 100: implicit Euler decays",
        ),
        (
            Manual,
            "k-100",
            spook,
            Number::Period,
            follows,
            "k = 100: SPOOK follows the analytic solution",
        ),
        (
            Manual,
            "k-100",
            euler,
            Number::Period,
            follows,
            "k = 100: semi-implicit Euler follows it",
        ),
        (
            Manual,
            "k-100",
            spook,
            Number::Halves,
            Below(NO_GROWTH),
            "k = 100: SPOOK stays within a bound",
        ),
        (
            Manual,
            "k-100",
            euler,
            Number::Halves,
            Below(NO_GROWTH),
            "k = 100: semi-implicit Euler stays within a bound",
        ),
        (
            Manual,
            "k-inside",
            euler,
            Number::Halves,
            Below(NO_GROWTH),
            "k = 4m/h² − 1: semi-implicit Euler is bounded",
        ),
        (
            Manual,
            "k-inside",
            euler,
            Number::Amplitude,
            Above(100.0),
            "k = 4m/h² − 1: its amplitude is over 100",
        ),
        (
            Manual,
            "k-outside",
            euler,
            Number::Amplitude,
            Above(1e9),
            "k = 4m/h² + 1: semi-implicit Euler diverges",
        ),
        (
            Manual,
            "k-outside",
            spook,
            Number::Halves,
            Below(NO_GROWTH),
            "k = 4m/h² + 1: SPOOK stays bounded",
        ),
        (
            Ours,
            "k-outside",
            spook,
            Number::Amplitude,
            swings,
            "k = 4m/h² + 1: SPOOK swings with amplitude √(1 + ω²h²/4)",
        ),
        (
            Manual,
            "k-outside",
            spook,
            Number::Period,
            Above(1.01),
            "k = 4m/h² + 1: SPOOK has the wrong period",
        ),
        (
            Manual,
            "k-aliasing",
            spook,
            Number::Amplitude,
            Above(1.5),
            "k = 4π²m/h²: SPOOK's amplitude grows",
        ),
        (
            Manual,
            "k-aliasing",
            spook,
            Number::Halves,
            Below(NO_GROWTH),
            "k = 4π²m/h²: but stays bounded",
        ),
    ];
    rows.into_iter().map(|row| of_row(study, row)).collect()
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
    std::iter::once(bounded(limit, found.at_limit.growth_of_halves))
        .chain(rigid)
        .collect()
}
