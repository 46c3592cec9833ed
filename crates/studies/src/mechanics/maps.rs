//! SPOOK on one damped spring: the one-step map by theory and by measurement, and rotors and pendulums that are stretched.

use std::f64::consts::TAU;

use glam::{DMat2, DVec2};
use lennard_core::{DVec3, Want};
use lennard_integrators::{BondOptions, spook};
use lennard_observables::Table;

use super::bodies::{Bodies, distance};
use super::bodies::{damped, springs};
use super::precise::G;
use crate::StudyError;
use crate::claims::Measured;
use crate::lab::Rig;
use crate::report::Drawn;
use crate::stability::groups::entry;
use crate::stability::map::StepMap;
use crate::stability::oscillator::{Spring, map_of};

/// Damping times of the maps, in steps.
const DAMPING: [f64; 6] = [0.0, 0.5, 1.0, 2.0, 4.0, 10.0];
/// Phases s = ωh of the maps; infinity is ε = 0.
const PHASES: [f64; 8] = [0.25, 0.5, 1.0, 2.0, 4.0, TAU, 20.0, f64::INFINITY];

/// In figures against ωh, s = ∞ stands here.
const AT_INFINITY: f64 = 60.0;

/// The map by theory on (x, h·v): [[1 − q, p], [−q, p]] with p = γ(s² + 4)/(s² + 4γ), q = 4γs²/(s² + 4γ).
fn theory(phase: f64, damping: f64) -> StepMap {
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

/// States (x, v) of SPOOK on a spring of unit mass with h = 1, from the start on.
fn path(phase: f64, damping: f64, steps: u32) -> Result<Vec<DVec2>, StudyError> {
    let compliance = 1.0 / (phase * phase);
    let spring = Spring::Constraint { compliance, damping_time: damping };
    spring.path(entry("spook")?, (1.0, 0.3), 1.0, steps)
}

/// Spectral radii by theory and from three states of a run, with their figure.
fn radii(all: &mut Measured) -> Result<(), StudyError> {
    let mut points = Vec::new();
    for damping in DAMPING {
        for phase in PHASES {
            let map = map_of(&path(phase, damping, 3)?);
            points.push((phase, damping, theory(phase, damping).radius(), map.radius()));
        }
    }
    let finite = points.iter().filter(|(phase, damping, ..)| *damping > 0.0 || phase.is_finite());
    let off = finite.map(|(.., theory, measured)| (measured / theory - 1.0).abs());
    all.numbers.add("difference from the map of SPOOK", off.fold(0.0, f64::max));
    let rigid = || points.iter().filter(|point| point.0.is_infinite());
    let critical = rigid().find(|point| point.1 == 2.0).map_or(f64::NAN, |point| point.3);
    let others = rigid().filter(|point| point.1 != 2.0).map(|point| point.3);
    let least = others.fold(f64::INFINITY, f64::min);
    all.numbers.add("radius at τ = 2h", critical);
    all.numbers.add("radius at τ = 2h over others", critical / least);
    let table = Table::rows_of("spook-map", &points)
        .column("omega h", |point| point.0)
        .column("tau/h", |point| point.1)
        .column("radius by theory", |point| point.2)
        .column("radius measured", |point| point.3)
        .table();
    let dense = |k: u32| 0.1 * 400.0_f64.powf(f64::from(k) / 300.0);
    let curve = |damping: f64| (0..=300).map(move |k| (damping, dense(k)));
    let curves: Vec<(f64, f64)> = DAMPING.into_iter().flat_map(curve).collect();
    let curves = Table::rows_of("spook-map by theory", &curves)
        .column("tau/h", |(damping, _)| *damping)
        .column("omega h", |(_, s)| *s)
        .column("radius", |(damping, s)| theory(*s, *damping).radius());
    let places = points.iter().map(|point| point.0.min(AT_INFINITY));
    all.given.tables.extend([table.clone().and("place", places), curves.table()]);
    all.tables.push(table);
    Ok(())
}

/// The largest difference between the general solver and its closed form over many steps, over the start.
fn closed_form() -> Result<f64, StudyError> {
    let mut largest = 0.0_f64;
    for (phase, damping) in [(0.5, 0.0), (2.0, 0.5), (TAU, 2.0), (20.0, 4.0)] {
        let map = spook::damped_oscillator_map(1.0 / (phase * phase), damping, 1.0, 1.0);
        let path = path(phase, damping, 1000)?;
        let mut z = path[0];
        for found in &path[1..] {
            z = map * z;
            largest = largest.max((*found - z).length());
        }
    }
    Ok(largest)
}

/// The length of a rotor that turns by α per step, over its length at rest.
fn rotor_length(bonds: &BondOptions, omega: f64, dt: f64, steps: u64) -> Result<f64, StudyError> {
    let mut rig = Bodies::rotor(omega)?.start(bonds, dt)?;
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
    let mut rig = Bodies::rotor(1.0)?.start(&damped(2.0), dt)?;
    let mut before = DVec3::ZERO;
    for _ in 0..steps {
        before = rig.state.positions[1] - rig.state.positions[0];
        rig.step()?;
    }
    let d = rig.state.positions[1] - rig.state.positions[0];
    let alpha = before.cross(d).z.atan2(before.dot(d));
    Ok((d.length(), stretched(alpha, 2.0)))
}

/// Loss of energy of a pendulum in 1000 τ, ε: the mean of the first tenth of the steps less the mean of the last.
fn loss(pendulum: &Bodies, bonds: &BondOptions) -> Result<f64, StudyError> {
    const TENTH: u32 = 20_000;
    let mut rig = pendulum.start(bonds, 100.0 / f64::from(TENTH))?;
    let start = rig.energy();
    let sum = |rig: &mut Rig| -> Result<f64, StudyError> {
        let mut sum = 0.0;
        for _ in 0..TENTH {
            rig.step()?;
            sum += rig.energy() - start;
        }
        Ok(sum)
    };
    let first = sum(&mut rig)?;
    rig.want = Want::NOTHING;
    rig.steps(8 * u64::from(TENTH))?;
    rig.want = Want::ENERGY;
    Ok((first - sum(&mut rig)?) / f64::from(TENTH))
}

/// Measures everything.
pub(super) fn measure(_quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    radii(all)?;
    let (length, length_by_theory) = rotor_against_theory()?;
    let pendulum = Bodies::hanging(1, 1.0)?;
    // A scene refuses it: the run may fail.
    let undamped = pendulum.run(&damped(0.0), 20.0, 4000)?;
    let undamped = undamped.map_or(f64::INFINITY, |end| end.rms);
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
    let numbers = &mut all.numbers;
    numbers.add("difference from the closed form", closed_form()?);
    numbers.add("angle of an undamped spring", angle_off()?);
    numbers.add("length of a rotor", length).theory(length_by_theory);
    numbers.add("order of the strain", order(&damped(2.0))?).of("damping", "2h");
    numbers.add("order of the strain", order(&fixed)?).of("damping", "fixed");
    let [little, much] = [damped(0.5), damped(4.0)].map(|bonds| loss(&pendulum, &bonds));
    let (little, much) = (little?, much?);
    let number = numbers.add("loss of a pendulum by damping", much / little);
    number.of("loss at τ = h/2", little).of("loss at τ = 4h", much);
    numbers.add("drift of a rigid pendulum", loss(&pendulum, &BondOptions::default())?.abs());
    numbers.add("energy of an undamped pendulum", undamped / G);
    Ok(())
}

/// How far the angle per step of an undamped spring is from 2·arctan(ωh/2), relative.
fn angle_off() -> Result<f64, StudyError> {
    let mut largest = 0.0_f64;
    for phase in [0.5, 1.0, 2.0, 4.0, 20.0] {
        let map = map_of(&path(phase, 0.0, 3)?);
        let wanted = 2.0 * (0.5 * phase).atan();
        let angle = map.phase().unwrap_or(f64::NAN);
        largest = largest.max((angle / wanted - 1.0).abs());
    }
    Ok(largest)
}

/// Distance of spring dumbbells from rigid ones against the stiffness: the model error of A10.
pub(super) fn model_errors(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    let stiffnesses: &[f64] = if quick { &[1e3, 1e4, 1e5] } else { &[1e3, 1e4, 1e5, 1e6] };
    let case = Bodies::two_dumbbells()?;
    let mut errors = Vec::new();
    let rigid = case.run(&BondOptions::default(), 2.5, 20_000)?.ok();
    for k in stiffnesses {
        // Steps so short that the error of the method is below the one of the model.
        let steps = (25.0 * (2.0 * k).sqrt()) as u32 * if quick { 4 } else { 16 };
        if let (Ok(spring), Some(rigid)) = (case.run(&springs(*k), 2.5, steps)?, &rigid) {
            errors.push((*k, distance(&spring.positions, &rigid.positions)));
        }
    }
    if let [.., a, b] = errors.as_slice() {
        all.numbers.add("order of the model of a spring", (a.1 / b.1).ln() / (b.0 / a.0).ln());
    }
    let table = Table::rows_of("model-errors", &errors)
        .column("stiffness [epsilon/sigma^2]", |m| m.0)
        .column("distance from rigid [sigma]", |m| m.1);
    all.tables.push(table.table());
    Ok(())
}
