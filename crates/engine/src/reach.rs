//! How far particles may move in a run, for formats that hold small coordinates alone.

use std::f64::consts::PI;

use lennard_core::{DVec3, PeriodicBox, SpeciesTable};
use lennard_scene::{Output, Scene};

/// What is to be known of frames whose coordinates are too large for the precision asked for.
pub(crate) fn less_precision(output: &Output, kept: f64) -> Option<String> {
    let limits = output.format.spec().limits?;
    (kept < output.precision).then(|| {
        format!(
            "frames of {} with coordinates above {:.1} σ have the precision {kept} in place of {}",
            output.format.spec().file,
            limits.multiples / output.precision,
            output.precision
        )
    })
}

/// Standard deviations of a displacement that the farthest of all particles does not pass, nearly always.
const DEVIATIONS: f64 = 5.0;

/// How far the lightest particles may move along an axis in a run at temperature T, σ.
///
/// The estimate is five standard deviations: √(T/m)·t in free flight, and √(2Dt) with D = 3/(8ρσ²)·√(T/(πm)) of hard spheres
/// of diameter σ, whichever is less. A denser fluid diffuses more slowly.
/// Source: Chapman and Cowling, The mathematical theory of non-uniform gases, first approximation.
fn displacement(time: f64, temperature: f64, mass: f64, density: f64) -> f64 {
    let diffusion = 3.0 / (8.0 * density) * (temperature / (PI * mass)).sqrt();
    let flight = (temperature / mass).sqrt() * time;
    DEVIATIONS * flight.min((2.0 * diffusion * time).sqrt())
}

/// A remark where unwrapped positions may grow too large for the precision of the trajectory.
pub(crate) fn remark_on_reach(
    scene: &Scene,
    temperature: f64,
    cell: &PeriodicBox,
    species: &SpeciesTable,
    positions: &[DVec3],
) -> Option<String> {
    let output = &scene.output;
    let limits = output.format.spec().limits?;
    if output.trajectory_every.is_none() || !output.unwrapped {
        return None;
    }
    let start = positions.iter().map(|r| r.abs().max_element());
    let masses = species.all().iter().map(|one| one.mass);
    let time: f64 =
        (scene.stages.iter()).map(|stage| stage.steps as f64 * scene.stage_dt(stage)).sum();
    let moved = displacement(
        time,
        temperature,
        masses.fold(f64::INFINITY, f64::min),
        positions.len() as f64 / cell.volume(),
    );
    let reach = start.fold(0.0, f64::max) + moved;
    let kept = limits.precision_for(output.precision, reach);
    let remark = less_precision(output, kept)?;
    Some(format!("unwrapped positions may reach {reach:.0} σ: {remark}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gas_flies_and_a_liquid_diffuses() {
        let flight = displacement(0.1, 2.0, 4.0, 0.001);
        assert!((flight - 0.5 * 0.5_f64.sqrt()).abs() < 1e-12);
        // D of argon near its triple point is 0.03 σ²/τ, a fifth of the estimate.
        let liquid = displacement(1e4, 0.7, 1.0, 0.85);
        assert!(liquid > 5.0 * (2.0 * 0.03 * 1e4_f64).sqrt() && liquid < 500.0);
    }
}
