//! What the article and our own list claim of these methods, beside what was measured.

use super::manual_judgement::{self, or_infinity};
use super::{OscillatorStudy, orders::OrderLine};
use crate::StudyError;
use crate::claims::{Claim, Demand};
use crate::fluid_stability::FluidStudy;

const ARTICLE: &str = "article on Verlet integration";
const OURS: &str = "list of integrators";

const ORDER_REASON: &str = "next term of the error expansion at the smallest step";
pub(crate) const ROUNDING_REASON: &str = "rounding";

/// Tolerance of a measured order.
const ORDER_TOLERANCE: f64 = 0.05;
/// A position of a few σ is rounded by 10⁻¹⁵; a velocity made from positions divides that by dt ≥ 10⁻³, and
/// some thousand steps add up at random.
const MOMENTUM_TOLERANCE: f64 = 1e-11;
/// Two runs of one τ see different parts of the phase space once they have parted.
const FLUID_ORDER_TOLERANCE: f64 = 0.2;

fn order(source: &'static str, statement: impl Into<String>, line: &OrderLine) -> Claim {
    let near = Demand::Near {
        value: line.theory,
        within: ORDER_TOLERANCE,
    };
    Claim::judge(
        source,
        statement,
        format!("order of {}", line.name),
        near,
        line.measured.unwrap_or(f64::NAN),
    )
    .with_theory(line.theory, ORDER_TOLERANCE, ORDER_REASON)
}

/// All claims about the oscillator.
pub(crate) fn claims(study: &OscillatorStudy) -> Result<Vec<Claim>, StudyError> {
    let mut claims = article(study)?;
    claims.extend(manual_judgement::manual(study)?);
    claims.extend(manual_judgement::rigid(study));
    claims.extend(limits(study));
    Ok(claims)
}

fn article(study: &OscillatorStudy) -> Result<Vec<Claim>, StudyError> {
    let orders = &study.orders;
    let growth = &study.growth[study.growth.len() / 2];
    let coefficient = |what: &str, measured: f64| {
        let near = Demand::Near {
            value: 1.0 / 24.0,
            within: 0.01 / 24.0,
        };
        Claim::judge(
            ARTICLE,
            format!("on ẍ = w²x, xₙ = exp(wt)·(1 − (wh)²/24·wt + …), {what}"),
            format!("coefficient at wh = {}", growth.wh),
            near,
            measured,
        )
        .with_theory(1.0 / 24.0, 0.01 / 24.0, "next term, of the order (wh)²")
    };
    let rule = |i: usize, order: f64, statement: &str| {
        let run = &study.step_rules[i];
        let near = Demand::Near {
            value: order,
            within: ORDER_TOLERANCE,
        };
        let measured = run.order.unwrap_or(f64::NAN);
        Claim::judge(
            ARTICLE,
            statement,
            format!("order of the {} form", run.rule),
            near,
            measured,
        )
        .with_theory(order, ORDER_TOLERANCE, ORDER_REASON)
    };
    Ok(vec![
        order(
            ARTICLE,
            "A2: the Taylor start keeps Störmer–Verlet of order 2",
            &orders.starts[0],
        ),
        order(
            ARTICLE,
            "A2: a start without the acceleration drops it to 1",
            &orders.starts[1],
        ),
        coefficient("A3: started with x₁ = q₊", growth.exact_start_coefficient),
        coefficient(
            "A3: slope with the Taylor start",
            growth.taylor_start_coefficient,
        ),
        Claim::judge(
            ARTICLE,
            "A3: the Taylor start adds an offset near −(wh)²/16",
            "offset over (wh)²",
            Demand::Near {
                value: -1.0 / 16.0,
                within: 0.01 / 16.0,
            },
            growth.taylor_start_offset,
        )
        .with_theory(-1.0 / 16.0, 0.01 / 16.0, "next term, of the order (wh)²"),
        rule(
            0,
            0.0,
            "A4: with the plain rule a changing step breaks the method",
        ),
        rule(1, 1.0, "A4: the time-corrected rule converges"),
        rule(2, 2.0, "A4: the more exact rule keeps order 2"),
        order(
            ARTICLE,
            "A5: the central velocity is of order 2",
            &orders.velocity_estimates[0],
        ),
        order(
            ARTICLE,
            "A5: the half-step velocity is of order 2",
            &orders.velocity_estimates[1],
        ),
        order(
            ARTICLE,
            "A5: the early velocity is of order 1",
            &orders.velocity_estimates[2],
        ),
        Claim::judge(
            ARTICLE,
            "A6: velocity Verlet equals Störmer–Verlet with central velocities",
            "largest difference of x and v over 128 steps",
            Demand::Below(1e-12),
            orders.velocity_verlet_against_stormer,
        )
        .with_theory(0.0, 1e-12, ROUNDING_REASON),
        order(
            ARTICLE,
            "A7: local error O(h⁴) in the position of the recurrence",
            &orders.local[0],
        ),
        order(
            ARTICLE,
            "A7: local error O(h²) in the central velocity",
            &orders.local[1],
        ),
        order(
            ARTICLE,
            "A7: one velocity-Verlet step errs by O(h³) in x",
            &orders.local[2],
        ),
        order(
            ARTICLE,
            "A7: one velocity-Verlet step errs by O(h³) in v",
            &orders.local[3],
        ),
        order(
            ARTICLE,
            "A7: the energy oscillates within a bound that falls as h²",
            &orders.energy,
        ),
        Claim::judge(
            ARTICLE,
            "A7: the energy of velocity Verlet does not drift",
            "drift over the run as a share of the oscillation",
            Demand::Below(1e-3),
            orders.energy_drift_share,
        ),
    ])
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
                "largest |Σ m·v| an atom over all runs of the fluid",
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
        let measured = (b / a).ln() / (fine.dt / coarse.dt).ln();
        let near = Demand::Near {
            value: 2.0,
            within: FLUID_ORDER_TOLERANCE,
        };
        claims.push(
            Claim::judge(
                ARTICLE,
                "A7: on the fluid, too, the bound of the energy's oscillation falls as h²",
                format!(
                    "order of the energy RMS of `velocity-verlet` between dt = {} and {}",
                    coarse.dt, fine.dt
                ),
                near,
                measured,
            )
            .with_theory(
                2.0,
                FLUID_ORDER_TOLERANCE,
                "two short runs that part company after a while",
            ),
        );
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
