//! The claims of SPOOK's manual about a stiff oscillator, beside the measurements.

use super::OscillatorStudy;
use super::amplification::{mean_growth, theory};
use super::displacement::{Case, Summary};
use super::groups::entry;
use crate::StudyError;
use crate::claims::{Claim, Demand};

pub(crate) const ROUNDING_REASON: &str = "rounding";

const MANUAL: &str = "manual of the SPOOK integrator";

/// The quantities that several claims are judged by.
const AMPLITUDE: &str = "max |x| / m over the long run";
const HALVES: &str = "max |x|, second half of the long run over the first";

const SAMPLING_REASON: &str = "the largest of many samples of a cosine misses its crest by less";

/// A growth factor per step, averaged over 1000 steps.
const GROWTH_TOLERANCE: f64 = 1e-10;
/// max |x| over a long run: the phases sampled fill the circle to 10⁻³, and the crest is missed by half
/// its square.
const AMPLITUDE_TOLERANCE: f64 = 1e-6;
/// Largest growth between the halves of a long run that still counts as none.
const NO_GROWTH: f64 = 1.001;

fn case<'a>(study: &'a OscillatorStudy, name: &'static str) -> Result<&'a Case, StudyError> {
    study
        .cases
        .iter()
        .find(|c| c.name == name)
        .ok_or(StudyError::NoSuchMethod(name))
}

fn summary<'a>(case: &'a Case, method: &'static str) -> Result<&'a Summary, StudyError> {
    case.summaries
        .iter()
        .find(|s| s.method == method)
        .ok_or(StudyError::NoSuchMethod(method))
}

/// A number that a diverged run does not have.
pub(crate) fn or_infinity(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::INFINITY)
}

/// A demand on the amplitude of a long run.
fn amplitude(statement: &str, demand: Demand, s: &Summary) -> Claim {
    let theory = s.theory_amplitude.unwrap_or(f64::NAN);
    let measured = or_infinity(s.measured_amplitude);
    Claim::judge(MANUAL, statement, AMPLITUDE, demand, measured).with_theory(
        theory,
        AMPLITUDE_TOLERANCE * theory,
        SAMPLING_REASON,
    )
}

/// A demand on the period over the true one.
fn period(statement: &str, demand: Demand, s: &Summary) -> Claim {
    let theory = s.theory_period_ratio.unwrap_or(f64::NAN);
    let measured = s.measured_period_ratio.unwrap_or(f64::NAN);
    Claim::judge(
        MANUAL,
        statement,
        "period over the true period",
        demand,
        measured,
    )
    .with_theory(theory, GROWTH_TOLERANCE, ROUNDING_REASON)
}

/// The demand that a long run does not grow.
fn bounded(statement: &str, s: &Summary) -> Claim {
    let growth = or_infinity(s.growth_of_halves);
    Claim::judge(MANUAL, statement, HALVES, Demand::Below(NO_GROWTH), growth).with_theory(
        1.0,
        NO_GROWTH - 1.0,
        SAMPLING_REASON,
    )
}

/// A demand on the growth per step of a method.
fn factor(
    statement: &str,
    demand: Demand,
    method: &'static str,
    case: &Case,
) -> Result<Claim, StudyError> {
    let method = entry(method)?;
    let radius = theory(method, case.omega_h).map_or(f64::NAN, |m| m.radius());
    let measured = mean_growth(method, case.omega_h)?;
    let claim = Claim::judge(
        MANUAL,
        statement,
        "growth a step over 1000 steps",
        demand,
        measured,
    );
    Ok(claim.with_theory(radius, GROWTH_TOLERANCE, ROUNDING_REASON))
}

/// Claims about each finite stiffness.
pub(crate) fn manual(study: &OscillatorStudy) -> Result<Vec<Claim>, StudyError> {
    let of = |name: &'static str| {
        let case = case(study, name)?;
        Ok::<_, StudyError>((
            case,
            summary(case, "spook")?,
            summary(case, "symplectic-euler")?,
        ))
    };
    let (soft, soft_spook, soft_euler) = of("k-100")?;
    let (_, _, inside_euler) = of("k-inside")?;
    let (_, outside_spook, outside_euler) = of("k-outside")?;
    let (_, aliasing_spook, _) = of("k-aliasing")?;
    let near = Demand::Near {
        value: 1.0,
        within: 0.01,
    };
    let (above, below) = (Demand::Above, Demand::Below);
    let grows = "k = 100: explicit Euler diverges, by √(1 + ω²h²) per step";
    let decays = "k = 100: implicit Euler decays, by 1/√(1 + ω²h²) per step";
    let follows = "k = 100: SPOOK follows the analytic solution (1 % in the period)";
    let diverges = Claim::judge(
        MANUAL,
        "k = 4m/h² + 1: semi-implicit Euler diverges",
        AMPLITUDE,
        above(1e9),
        or_infinity(outside_euler.measured_amplitude),
    );
    Ok(vec![
        factor(grows, above(1.0), "explicit-euler", soft)?,
        factor(decays, below(1.0), "implicit-euler", soft)?,
        period(follows, near, soft_spook),
        period(
            "k = 100: semi-implicit Euler follows it (1 %)",
            near,
            soft_euler,
        ),
        bounded("k = 100: SPOOK stays within a bound", soft_spook),
        bounded(
            "k = 100: semi-implicit Euler stays within a bound",
            soft_euler,
        ),
        bounded(
            "k = 4m/h² − 1: semi-implicit Euler is bounded",
            inside_euler,
        ),
        amplitude(
            "k = 4m/h² − 1: its amplitude is over 100 m",
            above(100.0),
            inside_euler,
        ),
        diverges,
        bounded("k = 4m/h² + 1: SPOOK stays bounded", outside_spook),
        amplitude(
            "k = 4m/h² + 1: with amplitude √(1 + ω²h²/4)",
            below(10.0),
            outside_spook,
        ),
        period(
            "k = 4m/h² + 1: SPOOK has the wrong period",
            above(1.01),
            outside_spook,
        ),
        amplitude(
            "k = 4π²m/h²: SPOOK's amplitude grows",
            above(1.5),
            aliasing_spook,
        ),
        bounded("k = 4π²m/h²: but stays bounded", aliasing_spook),
    ])
}

/// Claims about k = ∞, one for each damping time.
pub(crate) fn rigid(study: &OscillatorStudy) -> Vec<Claim> {
    study
        .infinite
        .rigid
        .iter()
        .map(|run| {
            if run.damping_steps == 0.0 {
                let n = f64::from(study.infinite.steps);
                Claim::judge(
                    MANUAL,
                    "k = ∞, τ = 0: SPOOK does not diverge",
                    HALVES,
                    Demand::Below(NO_GROWTH),
                    run.growth_of_halves,
                )
                .with_theory(
                    (2.0 * n + 1.0) / (n + 1.0),
                    1e-3,
                    "rounding splits the double eigenvalue",
                )
            } else {
                let statement =
                    format!("k = ∞, τ = {} h: SPOOK does not diverge", run.damping_steps);
                let what = "spectral radius of the measured one-step map";
                Claim::judge(
                    MANUAL,
                    statement,
                    what,
                    Demand::Below(1.0),
                    run.measured_radius,
                )
                .with_theory(
                    run.theory_radius,
                    2e-8,
                    "rounding of a double eigenvalue at γ = 1/9",
                )
            }
        })
        .collect()
}
