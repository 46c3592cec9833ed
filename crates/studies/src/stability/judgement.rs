//! The claims of the article and of our own list about these methods, beside the measurements.

use super::OscillatorStudy;
use super::manual_judgement::{self, ROUNDING_REASON, or_infinity};
use super::orders::OrderLine;
use super::variable_step::StepRuleRun;
use crate::StudyError;
use crate::claims::{Claim, Demand};
use crate::fluid_stability::FluidStudy;

const ARTICLE: &str = "article on Verlet integration";
const OURS: &str = "list of integrators";

const ORDER_REASON: &str = "next term of the error expansion at the smallest step";
const NEXT_TERM_REASON: &str = "next term, of the order (wh)²";

/// Tolerance of a measured order.
const ORDER_TOLERANCE: f64 = 0.05;
/// A position of a few σ is rounded by 10⁻¹⁵; a velocity made from positions divides that by dt ≥ 10⁻³, and
/// some thousand steps add up at random.
const MOMENTUM_TOLERANCE: f64 = 1e-11;
/// Two runs of one τ see different parts of the phase space once they have parted.
const FLUID_ORDER_TOLERANCE: f64 = 0.2;

/// All claims about the oscillator.
pub(crate) fn claims(study: &OscillatorStudy) -> Result<Vec<Claim>, StudyError> {
    let mut claims = article(study);
    claims.extend(manual_judgement::manual(study)?);
    claims.extend(manual_judgement::rigid(study));
    claims.extend(limits(study));
    Ok(claims)
}

/// A claim that an error falls with a known order.
fn order(statement: &str, line: &OrderLine) -> Claim {
    let quantity = format!("order of {}", line.name);
    let measured = line.measured.unwrap_or(f64::NAN);
    let theory = (line.theory, ORDER_TOLERANCE, ORDER_REASON);
    Claim::of_theory(ARTICLE, statement, quantity, theory, measured)
}

/// A claim about the rule for a changing step with this order.
fn rule(statement: &str, order: f64, run: &StepRuleRun) -> Claim {
    let quantity = format!("order of the {} form", run.rule);
    let measured = run.order.unwrap_or(f64::NAN);
    let theory = (order, ORDER_TOLERANCE, ORDER_REASON);
    Claim::of_theory(ARTICLE, statement, quantity, theory, measured)
}

fn article(study: &OscillatorStudy) -> Vec<Claim> {
    let o = &study.orders;
    let [plain, corrected, exact, ..] = study.step_rules.as_slice() else {
        return Vec::new();
    };
    let growth = &study.growth[study.growth.len() / 2];
    let part = |statement: &str, quantity: String, one_over: f64, measured: f64| {
        let theory = (1.0 / one_over, 0.01 / one_over.abs(), NEXT_TERM_REASON);
        Claim::of_theory(ARTICLE, statement, quantity, theory, measured)
    };
    let coefficient = |what: &str, measured: f64| {
        let statement = format!("on ẍ = w²x, xₙ = exp(wt)·(1 − (wh)²/24·wt + …), {what}");
        let quantity = format!("coefficient at wh = {}", growth.wh);
        part(&statement, quantity, 24.0, measured)
    };
    let equality = "A6: velocity Verlet equals Störmer–Verlet with central velocities";
    let difference = "largest difference of x and v over 128 steps";
    let offset = "A3: the Taylor start adds an offset near −(wh)²/16";
    let steady = "A7: the energy of velocity Verlet does not drift";
    let drift = "drift over the run as a share of the oscillation";
    vec![
        order(
            "A2: the Taylor start keeps Störmer–Verlet of order 2",
            &o.starts[0],
        ),
        order(
            "A2: a start without the acceleration drops it to 1",
            &o.starts[1],
        ),
        coefficient("A3: started with x₁ = q₊", growth.exact_start_coefficient),
        coefficient(
            "A3: slope with the Taylor start",
            growth.taylor_start_coefficient,
        ),
        part(
            offset,
            "offset over (wh)²".into(),
            -16.0,
            growth.taylor_start_offset,
        ),
        rule(
            "A4: with the plain rule a changing step breaks the method",
            0.0,
            plain,
        ),
        rule("A4: the time-corrected rule converges", 1.0, corrected),
        rule("A4: the more exact rule keeps order 2", 2.0, exact),
        order(
            "A5: the central velocity is of order 2",
            &o.velocity_estimates[0],
        ),
        order(
            "A5: the half-step velocity is of order 2",
            &o.velocity_estimates[1],
        ),
        order(
            "A5: the early velocity is of order 1",
            &o.velocity_estimates[2],
        ),
        Claim::judge(
            ARTICLE,
            equality,
            difference,
            Demand::Below(1e-12),
            o.velocity_verlet_against_stormer,
        )
        .with_theory(0.0, 1e-12, ROUNDING_REASON),
        order(
            "A7: local error O(h⁴) in the position of the recurrence",
            &o.local[0],
        ),
        order("A7: local error O(h²) in the central velocity", &o.local[1]),
        order(
            "A7: one velocity-Verlet step errs by O(h³) in x",
            &o.local[2],
        ),
        order(
            "A7: one velocity-Verlet step errs by O(h³) in v",
            &o.local[3],
        ),
        order(
            "A7: the energy oscillates within a bound that falls as h²",
            &o.energy,
        ),
        Claim::judge(
            ARTICLE,
            steady,
            drift,
            Demand::Below(1e-3),
            o.energy_drift_share,
        ),
    ]
}

/// Claims about a conservative system of many particles, judged on the fluid.
pub(crate) fn on_the_fluid(study: &FluidStudy) -> Vec<Claim> {
    let completed = |name: &'static str| {
        study
            .runs
            .iter()
            .filter(move |r| r.method == name && r.completed())
    };
    let mut claims = Vec::new();
    for name in ["velocity-verlet", "stormer-verlet", "leapfrog"] {
        let momentum = completed(name)
            .filter_map(|r| r.momentum)
            .fold(f64::NAN, f64::max);
        claims.push(
            Claim::judge(
                ARTICLE,
                format!("A7: `{name}` conserves linear momentum"),
                "largest |Σ m·v| per atom over all runs of the fluid",
                Demand::Below(MOMENTUM_TOLERANCE),
                momentum,
            )
            .with_theory(0.0, MOMENTUM_TOLERANCE, "rounding of positions, over dt"),
        );
    }
    let last = study.double.len().saturating_sub(2);
    if let [coarse, fine] = &study.double[last..]
        && let (Some(a), Some(b)) = (coarse.fluctuation, fine.fluctuation)
    {
        let reason = "two short runs that part company after a while";
        claims.push(Claim::of_theory(
            ARTICLE,
            "A7: on the fluid, too, the bound of the energy's oscillation falls as h²",
            format!(
                "order of the energy RMS of `velocity-verlet` between dt = {} and {}",
                coarse.dt, fine.dt
            ),
            (2.0, FLUID_ORDER_TOLERANCE, reason),
            (b / a).ln() / (fine.dt / coarse.dt).ln(),
        ));
    }
    claims
}

fn limits(study: &OscillatorStudy) -> Vec<Claim> {
    study
        .methods
        .iter()
        .map(|m| {
            let what = "largest ωh with bounded runs";
            match (m.declared_limit, m.measured_limit) {
                (Some(declared), measured) => {
                    let theory = m.theory_limit.unwrap_or(f64::NAN);
                    // A window of instability that only just opens grows too slowly at its edge.
                    let narrow = m.method == "blanes-moan";
                    let (relative, reason) = if narrow {
                        (1e-5, "growth inside a narrow window of instability is slow")
                    } else {
                        (
                            1e-6,
                            "growth just past the limit is seen after 50 000 steps",
                        )
                    };
                    let near = Demand::Near {
                        value: declared,
                        within: relative * declared,
                    };
                    let statement = format!("`{}` is stable below ωh = {declared}", m.method);
                    Claim::judge(OURS, statement, what, near, or_infinity(measured)).with_theory(
                        theory,
                        relative * theory,
                        reason,
                    )
                }
                (None, measured) => Claim::judge(
                    OURS,
                    format!("`{}` is stable at every ωh", m.method),
                    what,
                    Demand::Above(super::amplification::LARGEST_OMEGA_H),
                    if m.bounded_at_1000 == Some(false) {
                        1000.0
                    } else {
                        or_infinity(measured)
                    },
                ),
            }
        })
        .collect()
}
