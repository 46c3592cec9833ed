//! Balls in a column over a plane.

use lennard_core::DVec3;
use lennard_forcefield::WallOptions;
use lennard_integrators::IntegratorOptions;
use lennard_scene::Scene;

use super::bodies::{in_a_box, rig, shipped};
use crate::StudyError;
use crate::lab::Rig;

/// Coordinate of the lower plane, σ.
pub(super) const PLANE: f64 = 2.0;
/// Side of the box, σ.
pub(super) const SIDE: f64 = 20.0;

/// The shipped column of balls over a plane at z = 2 σ, with other walls and another gravity, σ/τ².
pub(super) fn column(
    wall: &WallOptions,
    g: f64,
    overrides: &[(&str, String)],
) -> Result<Scene, StudyError> {
    let mut scene = shipped("mechanics/stack-spook", overrides)?;
    scene.walls[0].options = wall.clone();
    scene.walls[0].thickness = 2.0 * PLANE;
    scene.acceleration.z = -g;
    Ok(scene)
}

/// The same for a ball that touches the plane alone, under velocity Verlet.
pub(super) fn over(wall: &WallOptions, g: f64) -> Result<Scene, StudyError> {
    let mut scene = column(wall, g, &[])?;
    scene.contact = None;
    scene.integrator.method = IntegratorOptions::default();
    Ok(scene)
}

/// Balls at heights over the plane, σ, with one velocity, σ/τ.
pub(super) fn balls(
    scene: &Scene,
    (heights, speed): (&[f64], f64),
    h: f64,
) -> Result<Rig, StudyError> {
    let x: Vec<DVec3> = heights.iter().map(|z| DVec3::new(5.0, 5.0, PLANE + z)).collect();
    let v = vec![DVec3::new(0.0, 0.0, speed); x.len()];
    rig(scene, &in_a_box(SIDE, &x, &v)?, h)
}

/// What is read of balls in a column over a plane.
impl Rig {
    /// The height of the lowest ball over the plane, σ.
    pub(super) fn height(&self) -> f64 {
        self.height_of(0)
    }

    pub(super) fn height_of(&self, ball: usize) -> f64 {
        self.state.positions[ball].z - PLANE
    }

    /// The speed of the lowest ball away from the plane, σ/τ.
    pub(super) fn speed(&self) -> f64 {
        self.state.velocities[0].z
    }

    pub(super) fn hits(&self) -> u64 {
        self.forces.walls()[0].hits
    }

    /// The momentum that the plane has taken, m·σ/τ.
    pub(super) fn impulse(&self) -> f64 {
        self.forces.walls()[0].impulse
    }
}
