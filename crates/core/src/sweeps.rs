//! The two moves that every splitting method is made of.

use glam::DVec3;

use crate::Masses;
use crate::parallel::for_each_piece;

/// Kick: v ← v + (h/m)·F, with `velocities` `[N]` in σ/τ, `forces` `[N]` in ε/σ, `h` in τ.
pub fn kick(velocities: &mut [DVec3], forces: &[DVec3], masses: &Masses, h: f64) {
    for_each_piece(velocities, |first, chunk| match masses {
        Masses::Uniform(m) => {
            let factor = h / m;
            for (v, f) in chunk.iter_mut().zip(&forces[first..]) {
                *v += factor * *f;
            }
        }
        Masses::Each(m) => {
            for ((v, f), m) in chunk.iter_mut().zip(&forces[first..]).zip(&m[first..]) {
                *v += (h / m) * *f;
            }
        }
    });
}

/// Scaling: v ← factor·v.
pub fn scale(velocities: &mut [DVec3], factor: f64) {
    for_each_piece(velocities, |_, chunk| {
        for v in chunk {
            *v *= factor;
        }
    });
}

/// Drift: x ← x + h·v, with `positions` `[N]` in σ, `velocities` `[N]` in σ/τ, `h` in τ.
pub fn drift(positions: &mut [DVec3], velocities: &[DVec3], h: f64) {
    for_each_piece(positions, |first, chunk| {
        for (x, v) in chunk.iter_mut().zip(&velocities[first..]) {
            *x += h * *v;
        }
    });
}

/// Kick and drift in one pass over memory, with the same bits as [`kick`] by `kick_h` followed by
/// [`drift`] by `drift_h`.
pub fn kick_and_drift(
    positions: &mut [DVec3],
    velocities: &mut [DVec3],
    forces: &[DVec3],
    masses: &Masses,
    kick_h: f64,
    drift_h: f64,
) {
    crate::parallel::for_each_piece_pair(positions, velocities, |first, xs, vs| {
        let forces = &forces[first..];
        match masses {
            Masses::Uniform(m) => {
                let factor = kick_h / m;
                for ((x, v), f) in xs.iter_mut().zip(vs).zip(forces) {
                    *v += factor * *f;
                    *x += drift_h * *v;
                }
            }
            Masses::Each(m) => {
                for (((x, v), f), m) in xs.iter_mut().zip(vs).zip(forces).zip(&m[first..]) {
                    *v += (kick_h / m) * *f;
                    *x += drift_h * *v;
                }
            }
        }
    });
}
