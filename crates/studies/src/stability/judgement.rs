//! The claims about integrators, beside the measurements.

use super::OscillatorStudy;
use super::amplification::LARGEST_OMEGA_H;
use super::manual_judgement::{self, or_infinity};
use super::orders::OrderLine;
use crate::StudyError;
use crate::claims::Demand::{Above, Below, Near};
use crate::claims::Source::{self, Article, Manual, Ours};
use crate::claims::{Claim, NEXT_TERM, ROUNDING, judged, near};
use crate::fluid_stability::FluidStudy;

/// Tolerance of a measured order.
const ORDER_TOLERANCE: f64 = 0.05;
/// A position of a few σ is rounded by 10⁻¹⁵; a velocity made from positions divides that by dt ≥ 10⁻³, and
/// some thousand steps add up at random.
const MOMENTUM_TOLERANCE: f64 = 1e-11;
/// Two runs of one τ see different parts of the phase space once they have parted.
const FLUID_ORDER_TOLERANCE: f64 = 0.2;

/// All claims about the oscillator.
pub(crate) fn claims(study: &OscillatorStudy) -> Result<Vec<Claim>, StudyError> {
    let mut claims = family(study);
    claims.extend(global_orders(study)?);
    claims.push(near(
        Manual,
        "B1: SPOOK takes no variable step",
        "share of changes of the step that are refused",
        (1.0, 0.0, "a count has no error"),
        study.refused_changes,
    ));
    claims.extend(manual_judgement::finite(study)?);
    claims.extend(manual_judgement::defective(study));
    claims.extend(limits(study));
    Ok(claims)
}

/// A claim that an error falls with a known order.
fn order(source: Source, statement: &str, name: &str, theory: f64, measured: Option<f64>) -> Claim {
    let theory = (theory, ORDER_TOLERANCE, NEXT_TERM);
    let quantity = format!("order of {name}");
    near(source, statement, quantity, theory, measured.unwrap_or(f64::NAN))
}

fn family(study: &OscillatorStudy) -> Vec<Claim> {
    let o = &study.orders;
    let [plain, corrected, exact, ..] = study.step_rules.as_slice() else {
        return Vec::new();
    };
    let line = |source, statement, line: &OrderLine| {
        order(source, statement, &line.name, line.theory, line.measured)
    };
    let growth = &study.growth[study.growth.len() / 2];
    let part = |source: Source, statement, what: &str, one_over: f64, measured| {
        let reason = "next term, of the order (wh)²";
        let theory = (1.0 / one_over, 0.01 / one_over.abs(), reason);
        let quantity = format!("{what} at wh = {}", growth.wh);
        near(source, statement, quantity, theory, measured)
    };
    let mut all = vec![
        line(Article, "A2: the Taylor start keeps Störmer–Verlet of order 2", &o.starts[0]),
        line(Article, "A2: a start without the acceleration drops it to 1", &o.starts[1]),
        part(
            Article,
            "A3: on ẍ = w²x, started with x₁ = q₊, xₙ = exp(wt)·(1 − (wh)²/24·wt + …)",
            "coefficient of (wh)²·wt",
            24.0,
            growth.exact_start_coefficient,
        ),
        part(
            Ours,
            "A3: with the Taylor start the error grows with the same slope",
            "coefficient of (wh)²·wt",
            24.0,
            growth.taylor_start_coefficient,
        ),
        part(
            Ours,
            "A3: the Taylor start adds an offset near −(wh)²/16",
            "offset over (wh)²",
            -16.0,
            growth.taylor_start_offset,
        ),
        order(
            Article,
            "A4: with the plain rule a changing step breaks the method",
            "the plain rule",
            0.0,
            plain.order,
        ),
        order(
            Article,
            "A4: the time-corrected rule converges",
            "the time-corrected form",
            1.0,
            corrected.order,
        ),
        order(
            Article,
            "A4: the more exact rule is more exact",
            "the more exact form",
            2.0,
            exact.order,
        ),
        line(Article, "A5: the central velocity is of order 2", &o.velocity_estimates[0]),
        line(Article, "A5: the half-step velocity is of order 2", &o.velocity_estimates[1]),
        line(Article, "A5: the early velocity is of order 1", &o.velocity_estimates[2]),
        near(
            Article,
            "A6: velocity Verlet equals Störmer–Verlet with central velocities",
            "largest difference of x and v over 128 steps",
            (0.0, 1e-12, ROUNDING),
            o.velocity_verlet_against_stormer,
        ),
        line(Article, "A7: local error O(h⁴) in the position of the recurrence", &o.local[0]),
        line(Article, "A7: local error O(h²) in the central velocity", &o.local[1]),
        line(Ours, "A7: one velocity-Verlet step errs by O(h³) in x", &o.local[2]),
        line(Ours, "A7: one velocity-Verlet step errs by O(h³) in v", &o.local[3]),
    ];
    all.extend(o.accumulation.iter().map(|(n, errors)| {
        let sum = f64::from(n * (n + 1) / 2);
        near(
            Article,
            "A7: after n steps the local errors of a position have added up to n(n + 1)/2 of them",
            format!("error of x after {n} steps over the error of one"),
            (sum, 0.01 * sum, "next term, of the order (n·ωh)²"),
            *errors,
        )
    }));
    all.extend([
        line(Article, "A7: the energy oscillates within a bound that falls as h²", &o.energy),
        judged(
            Article,
            "A7: the energy of velocity Verlet does not drift",
            "drift over the run as a share of the oscillation",
            Below(1e-3),
            o.energy_drift_share,
        ),
    ]);
    all
}

/// Claims about the global order of a method.
fn global_orders(study: &OscillatorStudy) -> Result<Vec<Claim>, StudyError> {
    let o = &study.orders;
    let verlet = "A7: Verlet's global error is O(h²) in position and velocity";
    let euler = "A7: the Euler methods are of order 1";
    let spook = "B1: SPOOK is of order 1";
    [
        (Article, verlet, "x", &o.positions, "stormer-verlet", 2.0),
        (Article, verlet, "v", &o.velocities, "stormer-verlet", 2.0),
        (Article, verlet, "x", &o.positions, "velocity-verlet", 2.0),
        (Article, verlet, "v", &o.velocities, "velocity-verlet", 2.0),
        (Article, euler, "x", &o.positions, "explicit-euler", 1.0),
        (Article, euler, "x", &o.positions, "implicit-euler", 1.0),
        (Article, euler, "x", &o.positions, "symplectic-euler", 1.0),
        (Manual, spook, "x", &o.positions, "spook", 1.0),
        (Manual, spook, "v", &o.velocities, "spook", 1.0),
    ]
    .into_iter()
    .map(|(source, statement, of, lines, method, theory)| {
        let line = lines.iter().find(|l| l.name == method);
        let line = line.ok_or(StudyError::NoSuchMethod(method))?;
        let name = format!("{of} under `{method}`");
        Ok(order(source, statement, &name, theory, line.measured))
    })
    .collect()
}

/// Claims about a conservative system of many particles, judged on the fluid.
pub(crate) fn on_the_fluid(study: &FluidStudy) -> Vec<Claim> {
    let mut claims = Vec::new();
    for name in ["velocity-verlet", "stormer-verlet", "leapfrog"] {
        let runs = study.runs.iter().filter(|r| r.method == name);
        let momentum = runs.filter(|r| r.completed()).filter_map(|r| r.momentum);
        let reason = "rounding of positions, over dt";
        claims.push(near(
            Article,
            format!("A7: `{name}` conserves linear momentum"),
            "largest |Σ m·v| per atom over all runs of the fluid",
            (0.0, MOMENTUM_TOLERANCE, reason),
            momentum.fold(f64::NAN, f64::max),
        ));
    }
    let last = study.double.len().saturating_sub(2);
    if let [coarse, fine] = &study.double[last..]
        && let (Some(a), Some(b)) = (coarse.fluctuation, fine.fluctuation)
    {
        let reason = "two short runs that part company after a while";
        claims.push(near(
            Article,
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

/// What each method declares about its limit.
fn limits(study: &OscillatorStudy) -> Vec<Claim> {
    let what = "largest ωh with bounded runs";
    let of = |m: &super::amplification::MethodMap| {
        let Some(declared) = m.declared_limit else {
            let measured = match m.bounded_at_1000 {
                Some(false) => 1000.0,
                _ => or_infinity(m.measured_limit),
            };
            let statement = format!("`{}` is stable at every ωh", m.method);
            return judged(Ours, statement, what, Above(LARGEST_OMEGA_H), measured);
        };
        // A window of instability that only just opens grows too slowly at its edge.
        let (relative, reason) = match m.method {
            "blanes-moan" => (1e-5, "growth inside a narrow window of instability is slow"),
            _ => (1e-6, "growth just past the limit is seen after 50 000 steps"),
        };
        let near = Near { value: declared, within: relative * declared };
        let theory = m.theory_limit.unwrap_or(f64::NAN);
        let statement = format!("`{}` is stable below ωh = {declared}", m.method);
        judged(Ours, statement, what, near, or_infinity(m.measured_limit)).with_theory((
            theory,
            relative * theory,
            reason,
        ))
    };
    study.methods.iter().map(of).collect()
}
