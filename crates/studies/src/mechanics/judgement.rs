//! The claims of the two documents about constraints, springs, collisions and SPOOK, beside the measurements.

use super::comparison::WayFound;
use super::found::MechanicsFound;
use super::ways::MIDPOINT;
use crate::claims::{Claim, Demand};

pub(super) const ARTICLE: &str = "article on Verlet integration";
const MANUAL: &str = "manual of the SPOOK integrator";
pub(super) const OURS: &str = "derived here";

pub(super) const ROUNDING: &str = "rounding over the steps";
pub(super) const NEXT_TERM: &str = "next term of the error expansion at the smallest step";

/// The claims about bonds and SPOOK.
pub(crate) fn claims(found: &MechanicsFound) -> Vec<Claim> {
    let mut all = relaxation(found);
    all.extend(ways(found));
    all.extend(known_solutions(found));
    all.extend(spook(found));
    all
}

pub(super) fn below(
    source: &'static str,
    statement: &str,
    quantity: &str,
    bound: f64,
    measured: f64,
) -> Claim {
    Claim::judge(source, statement, quantity, Demand::Below(bound), measured)
}

pub(super) fn above(
    source: &'static str,
    statement: &str,
    quantity: &str,
    bound: f64,
    measured: f64,
) -> Claim {
    Claim::judge(source, statement, quantity, Demand::Above(bound), measured)
}

pub(super) fn near(
    source: &'static str,
    statement: &str,
    quantity: &str,
    theory: (f64, f64, &'static str),
    measured: f64,
) -> Claim {
    Claim::of_theory(source, statement, quantity, theory, measured)
}

fn relaxation(found: &MechanicsFound) -> Vec<Claim> {
    let r = &found.relaxing;
    let mut all: Vec<Claim> = r
        .rates
        .iter()
        .map(|rate| {
            let degrees = rate.angle.to_degrees();
            let (statement, quantity) = match (rate.over_relaxation == 1.0, degrees > 0.0) {
                (true, false) => (
                    "A8: sweeps converge as cos²(π/(n + 1)) on a straight chain",
                    format!("residual per sweep, n = {}", rate.bonds),
                ),
                (true, true) => (
                    "A8: two bonds at an angle θ converge as (cos θ/2)²",
                    format!("residual per sweep, θ = {degrees:.0}°"),
                ),
                (false, _) => (
                    "A8: over-relaxation ω converges as the theory of SOR has it",
                    format!("n = {}, ω = {:.3}", rate.bonds, rate.over_relaxation),
                ),
            };
            let tolerance = match rate.over_relaxation == 1.0 {
                true => 0.02 * rate.theory,
                false => 0.1 * rate.theory,
            };
            let reason = "faster parts that have not died away after the first sweeps";
            near(
                OURS,
                statement,
                &quantity,
                (rate.theory, tolerance, reason),
                rate.measured,
            )
        })
        .collect();
    let what = "largest distance on a falling chain of ten, σ";
    all.extend([
        below(
            ARTICLE,
            "A9: relaxation and direct solve agree, where both correct along the old bond",
            what,
            1e-8,
            r.against_direct,
        ),
        below(
            ARTICLE,
            "A9: the article's own relaxation, along the new bond, agrees with the direct solve",
            what,
            1e-8,
            r.new_against_direct,
        ),
        below(
            OURS,
            "A8: along the old bond a rotor turns by arcsin(Ωh) per step",
            "angle less arcsin(Ωh), rad",
            1e-11,
            r.rotor_off.abs(),
        ),
        below(
            OURS,
            "A8: along the old bond a rotor keeps its energy",
            "relative change after 100 steps",
            1e-11,
            r.rotor_energy.abs(),
        ),
        below(
            OURS,
            "A9: a run with the direct solve leads back when velocities are reversed",
            "distance from the start, σ",
            1e-8,
            r.there_and_back[0],
        ),
        above(
            OURS,
            "A8: a run with corrections along the new bond does not lead back",
            "distance from the start, σ",
            1e-3,
            r.there_and_back[1],
        ),
        below(
            OURS,
            "A9: the direct solve of a chain of ten needs a few iterations, and relaxation hundreds of sweeps",
            "iterations per step over sweeps per step at 10⁻¹²",
            0.05,
            r.chain_iterations[3] / r.chain_iterations[2],
        ),
    ]);
    all.extend(r.slowing.iter().map(|s| {
        let reason = "terms of higher order in α₀ = 0.1";
        near(
            OURS,
            "A8: along the new bond a rotor slows as α₀/√(1 + 2α₀²n)",
            &format!("angle per step at n = {}, rad", s.step),
            (s.theory, 0.02 * s.theory, reason),
            s.measured,
        )
    }));
    let loose = |dt_is_small: bool| {
        let steps = r.tolerances.iter().filter(|t| t.tolerance == 1e-3);
        let pick = steps.min_by(|a, b| {
            let order = a.dt.total_cmp(&b.dt);
            if dt_is_small { order } else { order.reverse() }
        });
        pick.map_or(f64::NAN, |t| t.energy_rms)
    };
    all.push(above(
        OURS,
        "A8: with a loose tolerance a shorter step does not help",
        "RMS of the energy at a quarter of the step, over the RMS, tolerance 10⁻³; order 2 gives 1/16",
        0.5,
        loose(true) / loose(false),
    ));
    all
}

fn way<'a>(found: &'a MechanicsFound, name: &str) -> Option<&'a WayFound> {
    found.ways.iter().find(|w| w.name == name)
}

fn ways(found: &MechanicsFound) -> Vec<Claim> {
    let order = |name: &str| way(found, name).map_or(f64::NAN, |w| w.order);
    let limit = |name: &str| {
        let found = way(found, name);
        found.map_or(f64::NAN, |w| w.largest_step.unwrap_or(f64::INFINITY))
    };
    let mut all = vec![
        near(
            ARTICLE,
            "A9: the direct solve is of order 2",
            "order of the position error",
            (2.0, 0.05, NEXT_TERM),
            order("direct"),
        ),
        near(
            ARTICLE,
            "A8: relaxation along the old bond is of order 2",
            "order of the position error",
            (2.0, 0.05, NEXT_TERM),
            order("relaxation"),
        ),
        near(
            ARTICLE,
            "A8: relaxation along the new bond is of order 1",
            "order of the position error",
            (1.0, 0.1, NEXT_TERM),
            order("relaxation, new direction"),
        ),
        near(
            OURS,
            "A9: a rigid rotor can turn up to Ωh = 1",
            "largest stable Ωh",
            (1.0, 0.02, "the vibration at the start changes Ω a little"),
            2.0 * limit("direct"),
        ),
    ];
    for (name, k) in [("spring, k = 1000", 1e3_f64), ("spring, k = 64000", 6.4e4)] {
        let reason = "the rotation, and growth near the limit that is slower than the run is long";
        all.push(near(
            ARTICLE,
            "A10: an explicit spring is stable below ωh = 2",
            &format!("largest stable ωh, k = {k}"),
            (2.0, 0.1, reason),
            limit(name) * (2.0 * k).sqrt(),
        ));
    }
    for (name, k) in MIDPOINT {
        all.push(near(
            OURS,
            "A10: a spring by the midpoint rule that turns with Ω is stable below Ω·ω·h² = 4",
            &format!("largest stable Ω·ω·h², k = {k}"),
            (4.0, 0.25, "terms of higher order in 1/(ωh)"),
            2.0 * (2.0 * k).sqrt() * limit(name).powi(2),
        ));
    }
    if let [.., a, b] = found.model_errors.as_slice() {
        all.push(near(
            OURS,
            "A10: the error of the model of a spring falls as 1/k",
            "order in 1/k of the distance from rigid dumbbells",
            (1.0, 0.1, "the phase of the vibration at the end"),
            (a.1 / b.1).ln() / (b.0 / a.0).ln(),
        ));
    }
    all
}

fn known_solutions(found: &MechanicsFound) -> Vec<Claim> {
    let of = |s: &super::precise::Solved| {
        let tolerance = if s.theory > 1.5 { 0.1 } else { 0.2 };
        near(
            OURS,
            &format!("{}: {} is of order {}", s.problem, s.way, s.theory),
            "order of the position error",
            (s.theory, tolerance, NEXT_TERM),
            s.order,
        )
    };
    found.solved.iter().map(of).collect()
}

fn spook(found: &MechanicsFound) -> Vec<Claim> {
    let m = &found.maps;
    let largest = m
        .points
        .iter()
        .filter(|p| p.damping > 0.0 || p.phase.is_finite());
    let largest = largest.map(|p| (p.measured / p.theory - 1.0).abs());
    let radius = |damping: f64| {
        let at = |p: &&super::maps::MapAt| p.damping == damping && p.phase.is_infinite();
        m.points.iter().find(at).map_or(f64::NAN, |p| p.measured)
    };
    let defective = "a double eigenvalue: rounding of 10⁻¹⁶ shows as its square root";
    vec![
        below(
            MANUAL,
            "B2: the general solver is the closed form of the damped oscillator",
            "largest difference over 1000 steps",
            1e-11,
            m.closed_form,
        ),
        below(
            OURS,
            "B1: the one-step map is [[1 − q, p], [−q, p]]",
            "largest relative difference of the spectral radius",
            1e-6,
            largest.fold(0.0, f64::max),
        ),
        near(
            OURS,
            "B1: at ε = 0, τ = 2h is critical: both eigenvalues are 1/3",
            "spectral radius",
            (1.0 / 3.0, 1e-6, defective),
            radius(2.0),
        ),
        below(
            OURS,
            "B1: no other damping of the list is smaller at ε = 0",
            "radius at τ = 2h over the smallest of the others",
            1.0,
            radius(2.0)
                / super::maps::DAMPING
                    .iter()
                    .filter(|d| **d != 2.0)
                    .map(|d| radius(*d))
                    .fold(f64::INFINITY, f64::min),
        ),
        below(
            OURS,
            "B1: without damping a spring turns by 2·arctan(ωh/2)",
            "largest relative difference",
            1e-9,
            m.angle_off,
        ),
        near(
            OURS,
            "B1: a rotor under SPOOK keeps a stretched length",
            "|d|/r at τ = 2h",
            (m.rotor_theory, 1e-9, ROUNDING),
            m.rotor_length,
        ),
        near(
            OURS,
            "B1: its strain falls as h² at τ = 2h",
            "order in h",
            (2.0, 0.1, NEXT_TERM),
            m.strain_orders[0],
        ),
        near(
            OURS,
            "B1: its strain falls as h at a fixed τ",
            "order in h",
            (1.0, 0.1, NEXT_TERM),
            m.strain_orders[1],
        ),
        above(
            OURS,
            "B1: on a pendulum SPOOK takes energy out, the more the larger τ",
            "loss at τ = 4h over the loss at τ = h/2, in 1000 s",
            2.0,
            m.pendulum[2] / m.pendulum[0],
        ),
        below(
            OURS,
            "A9: a pendulum of rigid bonds does not drift",
            "mean energy of the first tenth of 1000 s less the last, J",
            1e-3,
            m.pendulum[3].abs(),
        ),
        below(
            MANUAL,
            "k = ∞: SPOOK does not diverge, here a pendulum without damping",
            "RMS of E − E(0), J, of a scale of 9.81 J",
            9.81,
            m.undamped_pendulum,
        ),
    ]
}
