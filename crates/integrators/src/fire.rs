//! FIRE: relaxation of a configuration by damped dynamics, for starts that lie too close together.

use lennard_core::exact::exact_sum;
use lennard_core::parallel::for_each_piece;
use lennard_core::{
    Backend, Configuration, DVec3, ForceError, Moving, Own, Part, PeriodicBox, Want,
};

use crate::implicit_euler::dot;

/// When to stop, and how far a step may go.
#[derive(Debug, Clone, PartialEq)]
pub struct FireOptions {
    /// Stops when no particle feels a force above this, in ε/σ.
    pub largest_force: f64,
    /// Gives up after so many steps.
    pub max_steps: u64,
    /// No particle moves farther than this in a step, in σ: what keeps huge first forces harmless.
    pub max_displacement: f64,
}

impl Default for FireOptions {
    /// Forces below 10 ε/σ are harmless to dynamics: a liquid near its triple point has larger
    /// forces. With a twentieth of a diameter per step, overlaps open without jumps over neighbors.
    fn default() -> Self {
        Self { largest_force: 10.0, max_steps: 20_000, max_displacement: 0.05 }
    }
}

/// Why a relaxation failed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FireError {
    /// The forces failed: two particles lie on top of each other, for example.
    #[error(transparent)]
    Force(#[from] ForceError),
    /// The forces depend on velocities, so there is nothing to minimise.
    #[error("forces that depend on velocities cannot be relaxed")]
    VelocityDependentForce,
    /// The steps ran out.
    #[error(
        "relaxation stopped after {steps} steps with a largest force of {largest_force:.3e} (wanted {wanted:.3e})"
    )]
    NotRelaxed {
        /// Steps made.
        steps: u64,
        /// Largest force left, ε/σ.
        largest_force: f64,
        /// Largest force wanted, ε/σ.
        wanted: f64,
    },
}

// The parameters of FIRE 2.0 (Guénolé et al. 2020, table 2) except for the time steps, which are in τ.
const FIRST_DT: f64 = 0.002;
const LARGEST_DT: f64 = 10.0 * FIRST_DT;
const SMALLEST_DT: f64 = 0.02 * FIRST_DT;
const DELAY: u64 = 20;
const GROWTH: f64 = 1.1;
const SHRINKAGE: f64 = 0.5;
const FIRST_MIXING: f64 = 0.25;
const MIXING_DECAY: f64 = 0.99;

/// Moves `positions` (`[N]`, σ) downhill until no force exceeds `options.largest_force`; returns the number of steps.
///
/// Damped dynamics with unit masses: `v ← v + dt·F; v ← (1 − α)·v + α·|v|·F/|F|; x ← x + dt·v`. dt
/// grows while the power F·v is positive. When it is not, everything starts again half a step back.
/// Each particle's step is cut to `max_displacement`, which bounds what a huge force can do.
///
/// Sources: Bitzek, Koskinen, Gähler, Moseler and Gumbsch, "Structural relaxation made simple",
/// Phys. Rev. Lett. 97, 170201 (2006); Guénolé et al., "Assessment and optimization of the fast
/// inertial relaxation engine (FIRE) for energy minimization in atomistic simulations", Comput. Mater.
/// Sci. 175, 109584 (2020), FIRE 2.0 with semi-implicit Euler.
///
/// # Errors
/// [`FireError`] where the forces fail, depend on velocities, or stay too large.
pub fn relax(
    cell: &PeriodicBox,
    positions: &mut [DVec3],
    forces: &mut dyn Backend,
    options: &FireOptions,
) -> Result<u64, FireError> {
    if forces.properties().velocity_dependent {
        return Err(FireError::VelocityDependentForce);
    }
    let n = positions.len();
    let mut velocities = vec![DVec3::ZERO; n];
    let mut force = vec![DVec3::ZERO; n];
    evaluate(cell, positions, forces, &mut force)?;

    let (mut dt, mut mixing, mut uphill_free, mut steps) = (FIRST_DT, FIRST_MIXING, 0_u64, 0_u64);
    while largest(&force) > options.largest_force {
        if steps == options.max_steps {
            return Err(FireError::NotRelaxed {
                steps,
                largest_force: largest(&force),
                wanted: options.largest_force,
            });
        }
        if dot(&force, &velocities) > 0.0 {
            uphill_free += 1;
            if uphill_free > DELAY {
                dt = (dt * GROWTH).min(LARGEST_DT);
                mixing *= MIXING_DECAY;
            }
        } else {
            uphill_free = 0;
            mixing = FIRST_MIXING;
            if steps > DELAY {
                dt = (dt * SHRINKAGE).max(SMALLEST_DT);
            }
            let moving = Moving { positions, velocities: &mut velocities, forces: &force };
            moving.drift(-0.5 * dt);
            velocities.fill(DVec3::ZERO);
        }
        step(positions, &mut velocities, &force, dt, mixing, options.max_displacement);
        evaluate(cell, positions, forces, &mut force)?;
        steps += 1;
    }
    Ok(steps)
}

fn evaluate(
    cell: &PeriodicBox,
    positions: &[DVec3],
    forces: &mut dyn Backend,
    force: &mut [DVec3],
) -> Result<(), ForceError> {
    let at = Configuration::at_rest(cell, positions);
    forces.evaluate(at, Part::All, Want::NOTHING, force)?;
    lennard_core::check_finite(&Own::all_of(force.len()), force)
}

/// Kick, mixing and drift with the cap on each particle's displacement.
fn step(
    positions: &mut [DVec3],
    velocities: &mut [DVec3],
    force: &[DVec3],
    dt: f64,
    mixing: f64,
    max_displacement: f64,
) {
    let cap = max_displacement / dt;
    for_each_piece(velocities, |first, vs| {
        for (v, f) in vs.iter_mut().zip(&force[first..]) {
            *v = (*v + dt * *f).clamp_length_max(cap);
        }
    });
    let force_norm = norm(force);
    // Without any force there is no direction to mix in.
    let towards = if force_norm > 0.0 { mixing * norm(velocities) / force_norm } else { 0.0 };
    for_each_piece(velocities, |first, vs| {
        for (v, f) in vs.iter_mut().zip(&force[first..]) {
            *v = ((1.0 - mixing) * *v + towards * *f).clamp_length_max(cap);
        }
    });
    Moving { positions, velocities, forces: force }.drift(dt);
}

/// √Σ|aᵢ|² without overflow: first forces may be near 1e200.
fn norm(a: &[DVec3]) -> f64 {
    let scale = largest(a);
    if scale == 0.0 {
        return 0.0;
    }
    let squares: f64 = exact_sum(a.len(), |i| (a[i] / scale).length_squared());
    scale * squares.sqrt()
}

/// The largest component sum |a| of a particle, by way of the largest component against overflow.
fn largest(a: &[DVec3]) -> f64 {
    a.iter()
        .map(|f| {
            let scale = f.abs().max_element();
            if scale == 0.0 { 0.0 } else { scale * (*f / scale).length() }
        })
        .fold(0.0, f64::max)
}
