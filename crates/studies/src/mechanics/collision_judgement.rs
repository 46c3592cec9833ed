//! The claims about collisions, contacts and fluids of dumbbells, beside the measurements.

use super::fluid::FluidDrift;
use super::found::MechanicsFound;
use super::unilateral;
use crate::claims::Demand::{Above, Below};
use crate::claims::Source::{Article, Ours};
use crate::claims::{Claim, ROUNDING, judged, near};

const SAMPLING: &str = "scatter of a short run";

/// The claims about collisions, contacts and fluids.
pub(super) fn claims(found: &MechanicsFound) -> Vec<Claim> {
    let mut all = collisions(found);
    all.extend(contacts(found));
    all.extend(fluids(found));
    all
}

fn collisions(found: &MechanicsFound) -> Vec<Claim> {
    let c = &found.collisions;
    let gain = |phase: f64| {
        let hit = c.stiff.iter().find(|hit| hit.phase == phase);
        hit.map_or(f64::NAN, |hit| hit.gain)
    };
    let mut all = vec![
        near(
            Article,
            "A11: a penalty force that is too weak lets things pass",
            "smallest speed that passes, over ω·D",
            (1.0, 0.01, "the step of the run"),
            c.passes[1],
        ),
        judged(
            Ours,
            "A11: a penalty force keeps the energy while ωh ≤ 0.2",
            "mean relative gain per hit at ωh = 0.2",
            Below(1e-4),
            gain(0.2),
        ),
        judged(
            Article,
            "A11: a penalty force that is too strong is unstable",
            "mean relative gain per hit at ωh = 1.2",
            Above(0.03),
            gain(1.2),
        ),
        judged(
            Ours,
            "A11: the gain is not monotonic",
            "gain at ωh = 1.4 over gain at 1.2",
            Below(1.0),
            gain(1.4) / gain(1.2),
        ),
        near(
            Ours,
            "A11: a Hertz contact lasts 2.9432·δ/v",
            "time over theory",
            (1.0, 0.005, "the step of the run"),
            c.hertz[0],
        ),
        near(
            Ours,
            "A11: a Hertz contact is (5mv²/(4k))^{2/5} deep",
            "depth over theory",
            (1.0, 0.001, "the step of the run"),
            c.hertz[1],
        ),
        judged(
            Article,
            "A11: after a projection Verlet's velocity does the rest",
            "normal speed that is left after two steps",
            Below(1e-12),
            c.projected,
        ),
        judged(
            Ours,
            "A11: the billiard rule keeps the energy of a ball in gravity within v·g·h",
            "largest |E/E₀ − 1| at h = 0.01",
            Below(2.0_f64.sqrt() * 0.01),
            c.billiard[0],
        ),
        judged(
            Ours,
            "A11: and without a trend",
            "mean of the second half less mean of the first",
            Below(1e-3),
            c.billiard[1].abs(),
        ),
    ];
    all.extend(c.damped.iter().map(|hit| {
        let reason = "the phase at which a step begins the contact, ωh = 0.1";
        near(
            Ours,
            format!("A11: a {} penalty force keeps the restitution that is set", hit.law),
            format!("mean restitution over phases, e = {}", hit.set),
            (hit.set, 0.005, reason),
            hit.mean,
        )
    }));
    for bouncing in &c.bouncing {
        let off = bouncing.energies.iter().map(|e| (e - 1.0).abs());
        let off = off.fold(0.0, f64::max);
        match bouncing.rule {
            "event" => all.push(judged(
                Article,
                "A11: the velocity after contact may be set, with a coefficient of restitution",
                format!(
                    "largest |E/(e²ⁿE₀) − 1| of n bounces, event rule, e = {}",
                    bouncing.restitution
                ),
                Below(1e-9),
                off,
            )),
            "mirror" => all.push(judged(
                Ours,
                "A11: a mirrored position and velocity gain energy in gravity at each bounce",
                "E/E₀ − 1 after the bounces of 12 τ at h = 0.01",
                Above(0.0),
                bouncing.energies.last().map_or(f64::NAN, |e| e - 1.0),
            )),
            _ => {}
        }
    }
    all
}

fn contacts(found: &MechanicsFound) -> Vec<Claim> {
    let c = &found.collisions;
    let mut all: Vec<Claim> = c
        .cradles
        .iter()
        .map(|cradle| {
            let pairs = cradle.velocities.iter().zip(&cradle.known);
            let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let bound = if cradle.rule.contains("e = 1") { 1e-12 } else { 2e-4 };
            judged(
                Ours,
                format!("A11: a row of balls, {}", cradle.rule),
                "largest difference from the known velocities",
                Below(bound),
                off,
            )
        })
        .collect();
    let gamma = 1.0 / 9.0;
    all.extend([
        judged(
            Ours,
            "A11: a stack of five at rest has contact forces of exactly 5, 4, 3, 2, 1 times m·g",
            "largest relative deviation",
            Below(1e-12),
            c.stack,
        ),
        near(
            Ours,
            "B1: a contact of SPOOK alone bounces by the phase of the step, up to 3γ",
            "largest rebound at τ = 2h",
            (3.0 * gamma, 1e-9, ROUNDING),
            c.spook_alone[1],
        ),
        near(
            Ours,
            "B1: and up to three times the speed at τ = 0",
            "largest rebound at τ = 0",
            (3.0, 1e-9, ROUNDING),
            c.spook_alone[0],
        ),
        judged(
            Ours,
            "B1: with an impact stage before it the restitution is what was set",
            format!("largest difference from e = {} over phases", unilateral::SHARE),
            Below(1e-12),
            c.unilateral.restitution.abs(),
        ),
        judged(
            Ours,
            "B1: under unilateral contacts of SPOOK a stack at rest sinks in by compliance × force",
            "largest relative deviation of five depths, ε = 10⁻³ σ²/ε",
            Below(1e-8),
            c.unilateral.sunk,
        ),
        judged(
            Ours,
            "B1: and the floor carries its weight",
            "relative deviation over 2000 steps",
            Below(1e-10),
            c.unilateral.weight.abs(),
        ),
        judged(Ours, "B1: with e = 1 a ball in gravity keeps its energy",format!(
                "largest |E/E₀ − 1| over {} steps, with velocities that belong to the positions",
                unilateral::steps_of_ball(found.is_quick)
            ),Below(1e-9),c.unilateral.energy),
        near(
            Ours,
            "B1: a sweep of projected Gauss–Seidel over a stack of n lowers the error by cos²(π/(2n))",
            "factor at n = 10",
            (c.unilateral.sweep[1], 1e-8 * c.unilateral.sweep[1], ROUNDING),
            c.unilateral.sweep[0],
        ),
    ]);
    all
}

fn fluids(found: &MechanicsFound) -> Vec<Claim> {
    let of = |name: &str, dt: f64| -> Vec<&FluidDrift> {
        let all = found.drifts.iter();
        all.filter(|d| d.way == name && d.dt == dt).collect()
    };
    let new = of("relaxation, new direction", 0.002);
    let mut all = Vec::new();
    if let (Some(gas), Some(liquid)) = (new.first(), new.last()) {
        let reason = "terms of higher order in h, and a temperature that drifts meanwhile";
        all.push(near(
            Ours,
            "A8: in a gas the drift along the new bond is −h·⟨T_b·r·Ω²⟩",
            "drift at ρ = 0.05, ε/τ per molecule",
            (gas.law, 0.35 * gas.law.abs() + 3.0 * gas.error, reason),
            gas.drift,
        ));
        all.push(judged(
            Ours,
            "A8: and it changes its sign in a dense liquid",
            "drift at ρ = 0.52, ε/τ per molecule",
            Above(0.0),
            liquid.drift,
        ));
    }
    let mut direct = of("direct", 0.002);
    direct.extend(of("direct", 0.004));
    for run in of("direct", 0.002) {
        all.push(judged(
            Ours,
            "C: a fluid with bonds of the direct solve does not drift",
            format!("|drift| less 3 standard errors, ε/τ per molecule, ρ = {}", run.density),
            Below(1e-4),
            run.drift.abs() - 3.0 * run.error,
        ));
    }
    let at = |dt: f64| {
        let run = of("direct", dt).into_iter().next_back();
        run.map_or(f64::NAN, |r| r.rms)
    };
    all.push(near(
        Ours,
        "C: its energy oscillates within a bound that falls as h²",
        "order of the RMS between h = 0.002 and 0.004",
        (2.0, 0.3, SAMPLING),
        (at(0.004) / at(0.002)).log2(),
    ));
    let spook = |dt: f64| {
        let run = of("spook, τ = 2h", dt).into_iter().next_back();
        run.map_or(f64::NAN, |r| r.drift)
    };
    all.push(near(
        Ours,
        "C: the drift of SPOOK in a fluid falls as h³ at τ = 2h",
        "order of the drift between h = 0.002 and 0.004",
        (3.0, 0.4, SAMPLING),
        (spook(0.004) / spook(0.002)).log2(),
    ));
    all.push(judged(
        Ours,
        "A11: the pressure on hard walls is the virial's, step by step, with the boundary term",
        "relative difference",
        Below(1e-11),
        found.pressure.identity,
    ));
    for state in &found.states {
        let off = |found: (f64, f64), by: [f64; 2]| {
            let nearer = by.map(|e| (found.0 - e).abs()).into_iter().fold(f64::INFINITY, f64::min);
            let error = if found.1.is_finite() { found.1 } else { 0.0 };
            nearer - 3.0 * error
        };
        let slack = if found.is_quick { 0.1 } else { 0.0 };
        all.push(judged(
            Ours,
            "C: a fluid of rigid dumbbells has the energy of the equation of state",
            format!("|u − u_EOS| less 3 errors, ρ = {}", state.density),
            Below(0.02 + slack),
            off(state.energy, [state.lisal.0, state.mecke.0]),
        ));
        all.push(judged(
            Ours,
            "C: and its pressure",
            format!("|p − p_EOS| less 3 errors, ρ = {}", state.density),
            Below(0.03 + slack),
            off(state.pressure, [state.lisal.1, state.mecke.1]),
        ));
    }
    all
}
