//! The claims about constraints, springs and SPOOK, beside the measurements.

use super::comparison::WayFound;
use super::found::MechanicsFound;
use super::precise::G;
use super::ways::MIDPOINT;
use crate::claims::Demand::{Above, Below};
use crate::claims::Source::{Article, Manual, Ours};
use crate::claims::{Claim, NEXT_TERM, ROUNDING, judged, near};

/// The claims about bonds and SPOOK.
pub(crate) fn claims(found: &MechanicsFound) -> Vec<Claim> {
    let mut all = relaxation(found);
    all.extend(ways(found));
    all.extend(known_solutions(found));
    all.extend(spook(found));
    all
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
            near(Ours, statement, quantity, (rate.theory, tolerance, reason), rate.measured)
        })
        .collect();
    let straight = r.rates.iter().filter(|rate| rate.angle == 0.0 && rate.over_relaxation == 1.0);
    let gauss_seidel = straight.map(|rate| (rate.measured / rate.theory - 1.0).abs());
    let what = "largest distance on a falling chain of ten, σ";
    all.extend([
        judged(
            Article,
            "A9: the relaxation of linearised constraints is Gauss–Seidel",
            "largest relative difference of the residual per sweep from Gauss–Seidel's, straight chains",
            Below(0.02),
            gauss_seidel.fold(0.0, f64::max),
        ),
        judged(
            Article,
            "A9: for small matrices a direct solve is faster",
            "iterations of the direct solve over sweeps of relaxation per step, chain of ten at 10⁻¹²",
            Below(0.05),
            r.chain_iterations[3] / r.chain_iterations[2],
        ),
        judged(
            Ours,
            "A9: relaxation and direct solve agree, where both correct along the old bond",
            what,
            Below(1e-8),
            r.against_direct,
        ),
        judged(
            Ours,
            "A9: the article's relaxation, along the new bond, is not the direct solve",
            what,
            Above(1e-8),
            r.new_against_direct,
        ),
        judged(
            Ours,
            "A8: along the old bond a rotor turns by arcsin(Ωh) per step",
            "angle less arcsin(Ωh), rad",
            Below(1e-11),
            r.rotor_off.abs(),
        ),
        judged(
            Ours,
            "A8: along the old bond a rotor keeps its energy",
            "relative change after 100 steps",
            Below(1e-11),
            r.rotor_energy.abs(),
        ),
        judged(
            Ours,
            "A9: a run with the direct solve leads back when velocities are reversed",
            "distance from the start, σ",
            Below(1e-8),
            r.there_and_back[0],
        ),
        judged(
            Ours,
            "A8: a run with corrections along the new bond does not lead back",
            "distance from the start, σ",
            Above(1e-3),
            r.there_and_back[1],
        ),
    ]);
    all.extend(r.slowing.iter().map(|s| {
        let reason = "terms of higher order in α₀ = 0.1";
        near(
            Ours,
            "A8: along the new bond a rotor slows as α₀/√(1 + 2α₀²n)",
            format!("angle per step at n = {}, rad", s.step),
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
    all.push(judged(
        Ours,
        "A8: with a loose tolerance a shorter step does not help",
        "RMS of the energy at a quarter of the step, over the RMS, tolerance 10⁻³; order 2 gives 1/16",
        Above(0.5),
        loose(true) / loose(false),
    ));
    all
}

fn way<'a>(found: &'a MechanicsFound, name: &str) -> Option<&'a WayFound> {
    found.ways.iter().find(|w| w.name == name)
}

fn ways(found: &MechanicsFound) -> Vec<Claim> {
    let order = |name: &str| {
        let order = way(found, name).and_then(|w| w.convergence.order());
        order.unwrap_or(f64::NAN)
    };
    let limit = |name: &str| {
        let found = way(found, name);
        found.map_or(f64::NAN, |w| w.largest_step.unwrap_or(f64::INFINITY))
    };
    let mut all = vec![
        near(
            Ours,
            "A9: the direct solve is of order 2",
            "order of the position error",
            (2.0, 0.05, NEXT_TERM),
            order("direct"),
        ),
        near(
            Ours,
            "A8: relaxation along the old bond is of order 2",
            "order of the position error",
            (2.0, 0.05, NEXT_TERM),
            order("relaxation"),
        ),
        near(
            Ours,
            "A8: relaxation along the new bond is of order 1",
            "order of the position error",
            (1.0, 0.1, NEXT_TERM),
            order("relaxation, new direction"),
        ),
        near(
            Ours,
            "A9: a rigid rotor can turn up to Ωh = 1",
            "largest stable Ωh",
            (1.0, 0.02, "the vibration at the start changes Ω a little"),
            2.0 * limit("direct"),
        ),
    ];
    for (name, k) in [("spring, k = 1000", 1e3_f64), ("spring, k = 64000", 6.4e4)] {
        let reason = "the rotation, and growth near the limit that is slower than the run is long";
        all.push(near(
            Ours,
            "A10: an explicit spring is stable below ωh = 2",
            format!("largest stable ωh, k = {k}"),
            (2.0, 0.1, reason),
            limit(name) * (2.0 * k).sqrt(),
        ));
    }
    for (name, k) in MIDPOINT {
        all.push(near(
            Ours,
            "A10: a spring by the midpoint rule that turns with Ω is stable below Ω·ω·h² = 4",
            format!("largest stable Ω·ω·h², k = {k}"),
            (4.0, 0.25, "terms of higher order in 1/(ωh)"),
            2.0 * (2.0 * k).sqrt() * limit(name).powi(2),
        ));
    }
    if let [.., a, b] = found.model_errors.as_slice() {
        all.push(near(
            Ours,
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
            Ours,
            format!("{}: {} is of order {}", s.problem, s.way, s.theory),
            "order of the position error",
            (s.theory, tolerance, NEXT_TERM),
            s.order,
        )
    };
    found.solved.iter().map(of).collect()
}

fn spook(found: &MechanicsFound) -> Vec<Claim> {
    let m = &found.maps;
    let largest = m.points.iter().filter(|p| p.damping > 0.0 || p.phase.is_finite());
    let largest = largest.map(|p| (p.measured / p.theory - 1.0).abs());
    let radius = |damping: f64| {
        let at = |p: &&super::maps::MapAt| p.damping == damping && p.phase.is_infinite();
        m.points.iter().find(at).map_or(f64::NAN, |p| p.measured)
    };
    let defective = "a double eigenvalue: rounding of 10⁻¹⁶ shows as its square root";
    vec![
        judged(
            Manual,
            "B2: the general solver is the closed form of the damped oscillator",
            "largest difference over 1000 steps",
            Below(1e-11),
            m.closed_form,
        ),
        judged(
            Ours,
            "B1: the one-step map is [[1 − q, p], [−q, p]]",
            "largest relative difference of the spectral radius",
            Below(1e-6),
            largest.fold(0.0, f64::max),
        ),
        near(
            Ours,
            "B1: at ε = 0, τ = 2h is critical: both eigenvalues are 1/3",
            "spectral radius",
            (1.0 / 3.0, 1e-6, defective),
            radius(2.0),
        ),
        judged(
            Ours,
            "B1: no other damping of the list is smaller at ε = 0",
            "radius at τ = 2h over the smallest of the others",
            Below(1.0),
            radius(2.0)
                / super::maps::DAMPING
                    .iter()
                    .filter(|d| **d != 2.0)
                    .map(|d| radius(*d))
                    .fold(f64::INFINITY, f64::min),
        ),
        judged(
            Ours,
            "B1: without damping a spring turns by 2·arctan(ωh/2)",
            "largest relative difference",
            Below(1e-9),
            m.angle_off,
        ),
        near(
            Ours,
            "B1: a rotor under SPOOK keeps a stretched length",
            "|d|/r at τ = 2h",
            (m.rotor_theory, 1e-9, ROUNDING),
            m.rotor_length,
        ),
        near(
            Ours,
            "B1: its strain falls as h² at τ = 2h",
            "order in h",
            (2.0, 0.1, NEXT_TERM),
            m.strain_orders[0],
        ),
        near(
            Ours,
            "B1: its strain falls as h at a fixed τ",
            "order in h",
            (1.0, 0.1, NEXT_TERM),
            m.strain_orders[1],
        ),
        judged(
            Ours,
            "B1: on a pendulum SPOOK takes energy out, the more the larger τ",
            "loss at τ = 4h over the loss at τ = h/2, in 1000 τ",
            Above(2.0),
            m.pendulum[2] / m.pendulum[0],
        ),
        judged(
            Ours,
            "A9: a pendulum of rigid bonds does not drift",
            "mean energy of the first tenth of 1000 τ less the last, ε",
            Below(1e-3),
            m.pendulum[3].abs(),
        ),
        judged(
            Ours,
            "B1: at ε = 0 without damping a pendulum gains energy beyond its scale m·g·l",
            "RMS of E − E(0) over m·g·l",
            Above(1.0),
            m.undamped_pendulum / G,
        ),
    ]
}
