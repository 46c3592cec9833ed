//! SPOOK on one damped spring: the one-step map by theory and by measurement, and rotors and pendulums that are stretched.

use std::f64::consts::TAU;

use glam::{DMat2, DVec2};
use lennard_core::DVec3;
use lennard_integrators::{BondOptions, spook};
use serde::Serialize;

use super::bodies::{Bodies, distance};
use super::precise::G;
use super::ways::{damped, springs};
use crate::StudyError;
use crate::stability::groups::entry;
use crate::stability::map::StepMap;
use crate::stability::oscillator::Spring;

/// Damping times of the maps, in steps.
pub(crate) const DAMPING: [f64; 6] = [0.0, 0.5, 1.0, 2.0, 4.0, 10.0];
/// Phases s = ωh of the maps; infinity is ε = 0.
pub(crate) const PHASES: [f64; 8] = [0.25, 0.5, 1.0, 2.0, 4.0, TAU, 20.0, f64::INFINITY];

/// The map at one phase and damping.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct MapAt {
    /// ωh; infinite for ε = 0.
    pub phase: f64,
    /// τ/h.
    pub damping: f64,
    /// Spectral radius by theory.
    pub theory: f64,
    /// Spectral radius from three states of a run.
    pub measured: f64,
}

/// All of it.
#[derive(Debug, Clone, Serialize)]
pub struct Maps {
    /// Spectral radii.
    pub points: Vec<MapAt>,
    /// Largest difference between a state of the general solver and its closed form over 1000 steps, relative.
    pub closed_form: f64,
    /// |d|/r of a free rotor with α = 0.05 and τ = 2h after 1000 steps.
    pub rotor_length: f64,
    /// The same by theory.
    pub rotor_theory: f64,
    /// Loss of energy of a pendulum from 90° in 1000 τ at h = 0.005 τ, ε: τ = h/2, 2h, 4h, and rigid bonds.
    pub pendulum: [f64; 4],
    /// RMS of E − E(0) of the pendulum without damping, which a scene refuses, ε; infinite where it failed.
    pub undamped_pendulum: f64,
    /// Order of the strain of a rotor in h at τ = 2h, and at a fixed τ.
    pub strain_orders: [f64; 2],
    /// Angle per step of a spring by SPOOK with τ = 0, over 2·arctan(ωh/2), largest relative difference.
    pub angle_off: f64,
}

/// The map by theory on (x, h·v): [[1 − q, p], [−q, p]] with p = γ(s² + 4)/(s² + 4γ), q = 4γs²/(s² + 4γ).
pub(crate) fn theory(phase: f64, damping: f64) -> StepMap {
    let gamma = 1.0 / (1.0 + 4.0 * damping);
    let (p, q) = if phase.is_infinite() {
        (gamma, 4.0 * gamma)
    } else {
        let s2 = phase * phase;
        let below = s2 + 4.0 * gamma;
        (gamma * (s2 + 4.0) / below, 4.0 * gamma * s2 / below)
    };
    StepMap(DMat2::from_cols_array_2d(&[[1.0 - q, -q], [p, p]]))
}

/// States (x, v) of SPOOK on a spring of unit mass with h = 1.
fn states(phase: f64, damping: f64, start: DVec2, steps: usize) -> Result<Vec<DVec2>, StudyError> {
    let compliance = 1.0 / (phase * phase);
    let spring = Spring::Constraint { compliance, damping_time: damping };
    let mut rig = spring.start(entry("spook")?, start.into(), 1.0)?;
    (0..steps).map(|_| rig.next_point()).collect()
}

fn points() -> Result<Vec<MapAt>, StudyError> {
    let mut all = Vec::new();
    for damping in DAMPING {
        for phase in PHASES {
            let found = states(phase, damping, DVec2::new(1.0, 0.3), 3)?;
            let map = StepMap::from_states([found[0], found[1], found[2]]);
            all.push(MapAt {
                phase,
                damping,
                theory: theory(phase, damping).radius(),
                measured: map.radius(),
            });
        }
    }
    Ok(all)
}

/// The largest difference between the general solver and its closed form over many steps, over the start.
fn closed_form() -> Result<f64, StudyError> {
    let mut largest = 0.0_f64;
    for (phase, damping) in [(0.5, 0.0), (2.0, 0.5), (TAU, 2.0), (20.0, 4.0)] {
        let map = spook::damped_oscillator_map(1.0 / (phase * phase), damping, 1.0, 1.0);
        let mut z = DVec2::new(1.0, 0.3);
        for found in states(phase, damping, z, 1000)? {
            z = map * z;
            largest = largest.max((found - z).length());
        }
    }
    Ok(largest)
}

/// The length of a rotor that turns by α per step, over its length at rest.
fn rotor_length(bonds: &BondOptions, omega: f64, dt: f64, steps: u64) -> Result<f64, StudyError> {
    let mut rig = Bodies::rotor(omega).start(bonds, dt)?;
    rig.steps(steps)?;
    Ok(rig.state.positions[0].distance(rig.state.positions[1]))
}

/// The stretch of a rotor that turns by the angle α per step: 1/(1 − (1 − cos α)·(1 + γ)/(4γ)) at ε = 0.
fn stretched(alpha: f64, damping: f64) -> f64 {
    let gamma = 1.0 / (1.0 + 4.0 * damping);
    1.0 / (1.0 - (1.0 - alpha.cos()) * (1.0 + gamma) / (4.0 * gamma))
}

/// The exact fixed motion: the length and the turn per step after a long time, as (measured, by theory).
fn rotor_against_theory() -> Result<(f64, f64), StudyError> {
    let (dt, steps) = (0.05, 1000);
    let mut rig = Bodies::rotor(1.0).start(&damped(2.0), dt)?;
    let mut before = DVec3::ZERO;
    for _ in 0..steps {
        before = rig.state.positions[1] - rig.state.positions[0];
        rig.step()?;
    }
    let d = rig.state.positions[1] - rig.state.positions[0];
    let alpha = before.cross(d).z.atan2(before.dot(d));
    Ok((d.length(), stretched(alpha, 2.0)))
}

/// Measures everything.
pub(crate) fn measure() -> Result<Maps, StudyError> {
    let (rotor_length_found, rotor_theory) = rotor_against_theory()?;
    let pendulum = Bodies::hanging(1, 1.0, G);
    let loss = |bonds: &BondOptions| -> Result<f64, StudyError> {
        Ok(pendulum.run(bonds, 1000.0, 200_000)?.map_or(f64::NAN, |end| end.loss))
    };
    let undamped = pendulum.run(&damped(0.0), 20.0, 4000)?;
    let fixed = BondOptions::Spook(lennard_integrators::bonds::spook::Options {
        damping_time: Some(0.1),
        ..Default::default()
    });
    let order = |bonds: &BondOptions| -> Result<f64, StudyError> {
        let strain = |dt: f64| -> Result<f64, StudyError> {
            Ok(rotor_length(bonds, 1.0, dt, (20.0 / dt) as u64)? - 1.0)
        };
        Ok((strain(0.01)? / strain(0.005)?).log2())
    };
    Ok(Maps {
        points: points()?,
        closed_form: closed_form()?,
        rotor_length: rotor_length_found,
        rotor_theory,
        pendulum: [
            loss(&damped(0.5))?,
            loss(&damped(2.0))?,
            loss(&damped(4.0))?,
            loss(&BondOptions::default())?,
        ],
        undamped_pendulum: undamped.map_or(f64::INFINITY, |end| end.rms),
        strain_orders: [order(&damped(2.0))?, order(&fixed)?],
        angle_off: angle_off()?,
    })
}

/// How far the angle per step of an undamped spring is from 2·arctan(ωh/2), relative.
fn angle_off() -> Result<f64, StudyError> {
    let mut largest = 0.0_f64;
    for phase in [0.5, 1.0, 2.0, 4.0, 20.0] {
        let z = states(phase, 0.0, DVec2::new(1.0, 0.3), 3)?;
        let map = StepMap::from_states([z[0], z[1], z[2]]);
        let wanted = 2.0 * (0.5 * phase).atan();
        let angle = map.phase().unwrap_or(f64::NAN);
        largest = largest.max((angle / wanted - 1.0).abs());
    }
    Ok(largest)
}

/// The stretch of a spring between two dumbbells against its stiffness: the model error of A10.
pub(crate) fn model_errors(quick: bool) -> Result<Vec<(f64, f64)>, StudyError> {
    let stiffnesses: &[f64] = if quick { &[1e3, 1e4, 1e5] } else { &[1e3, 1e4, 1e5, 1e6] };
    let case = Bodies::two_dumbbells();
    let mut all = Vec::new();
    let rigid = case.run(&BondOptions::default(), 2.5, 20_000)?.ok();
    for k in stiffnesses {
        // Steps so short that the error of the method is below the one of the model.
        let steps = (25.0 * (2.0 * k).sqrt()) as u32 * if quick { 4 } else { 16 };
        if let (Ok(spring), Some(rigid)) = (case.run(&springs(*k), 2.5, steps)?, &rigid) {
            all.push((*k, distance(&spring.positions, &rigid.positions)));
        }
    }
    Ok(all)
}
