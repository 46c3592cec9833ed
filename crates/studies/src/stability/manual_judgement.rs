//! What the manual of SPOOK claims of a stiff oscillator, beside what was measured.

use super::OscillatorStudy;
use super::amplification::{mean_growth, theory};
use super::displacement::{Case, Summary};
use super::groups::entry;
use super::judgement::ROUNDING_REASON;
use crate::StudyError;
use crate::claims::{Claim, Demand};

const MANUAL: &str = "manual of the SPOOK integrator";

const SAMPLING_REASON: &str = "the largest of many samples of a cosine misses its crest by less";

/// A growth factor a step averaged over 1000 steps.
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

/// Claims about each finite stiffness.
pub(crate) fn manual(study: &OscillatorStudy) -> Result<Vec<Claim>, StudyError> {
    let soft = case(study, "k-100")?;
    let mean = |name: &'static str, case: &Case| -> Result<(f64, f64), StudyError> {
        let method = entry(name)?;
        let radius = theory(method, case.omega_h).map_or(f64::NAN, |m| m.radius());
        Ok((mean_growth(method, case.omega_h)?, radius))
    };
    let grows = |s: &Summary| or_infinity(s.growth_of_halves);
    let amplitude = |s: &Summary, demand: Demand, statement: &str| {
        let theory = s.theory_amplitude.unwrap_or(f64::NAN);
        Claim::judge(
            MANUAL,
            statement,
            "max |x| / m over the long run",
            demand,
            or_infinity(s.measured_amplitude),
        )
        .with_theory(theory, AMPLITUDE_TOLERANCE * theory, SAMPLING_REASON)
    };
    let period = |s: &Summary, demand: Demand, statement: &str| {
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
    };
    let bounded = |s: &Summary, statement: &str| {
        let what = "max |x|, second half of the long run over the first";
        Claim::judge(MANUAL, statement, what, Demand::Below(NO_GROWTH), grows(s)).with_theory(
            1.0,
            NO_GROWTH - 1.0,
            SAMPLING_REASON,
        )
    };
    let (explicit, explicit_theory) = mean("explicit-euler", soft)?;
    let (implicit, implicit_theory) = mean("implicit-euler", soft)?;
    let factor = |statement: &str, demand, measured, theory| {
        Claim::judge(
            MANUAL,
            statement,
            "growth a step over 1000 steps",
            demand,
            measured,
        )
        .with_theory(theory, GROWTH_TOLERANCE, ROUNDING_REASON)
    };
    let (inside, outside, aliasing) = (
        case(study, "k-inside")?,
        case(study, "k-outside")?,
        case(study, "k-aliasing")?,
    );
    let near = Demand::Near {
        value: 1.0,
        within: 0.01,
    };
    let outside_symplectic = summary(outside, "symplectic-euler")?;
    Ok(vec![
        factor(
            "k = 100: explicit Euler diverges, by √(1 + ω²h²) a step",
            Demand::Above(1.0),
            explicit,
            explicit_theory,
        ),
        factor(
            "k = 100: implicit Euler decays, by 1/√(1 + ω²h²) a step",
            Demand::Below(1.0),
            implicit,
            implicit_theory,
        ),
        period(
            summary(soft, "spook")?,
            near,
            "k = 100: SPOOK follows the analytic solution (1 % in the period)",
        ),
        period(
            summary(soft, "symplectic-euler")?,
            near,
            "k = 100: semi-implicit Euler follows it (1 %)",
        ),
        bounded(
            summary(soft, "spook")?,
            "k = 100: SPOOK stays within a bound",
        ),
        bounded(
            summary(soft, "symplectic-euler")?,
            "k = 100: semi-implicit Euler stays within a bound",
        ),
        bounded(
            summary(inside, "symplectic-euler")?,
            "k = 4m/h² − 1: semi-implicit Euler is bounded",
        ),
        amplitude(
            summary(inside, "symplectic-euler")?,
            Demand::Above(100.0),
            "k = 4m/h² − 1: its amplitude is over 100 m",
        ),
        Claim::judge(
            MANUAL,
            "k = 4m/h² + 1: semi-implicit Euler diverges",
            "max |x| / m over the long run",
            Demand::Above(1e9),
            or_infinity(outside_symplectic.measured_amplitude),
        ),
        bounded(
            summary(outside, "spook")?,
            "k = 4m/h² + 1: SPOOK stays bounded",
        ),
        amplitude(
            summary(outside, "spook")?,
            Demand::Below(10.0),
            "k = 4m/h² + 1: with amplitude √(1 + ω²h²/4)",
        ),
        period(
            summary(outside, "spook")?,
            Demand::Above(1.01),
            "k = 4m/h² + 1: SPOOK has the wrong period",
        ),
        amplitude(
            summary(aliasing, "spook")?,
            Demand::Above(1.5),
            "k = 4π²m/h²: SPOOK's amplitude grows",
        ),
        bounded(
            summary(aliasing, "spook")?,
            "k = 4π²m/h²: but stays bounded",
        ),
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
                    "max |x|, second half of the long run over the first",
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
