//! Balls in a column over a plane.

use lennard_core::random::Streams;
use lennard_core::{
    Axis, DVec3, ForceSum, ForceTerm, Masses, NoForces, PeriodicBox, State, StepError, System, Want,
};
use lennard_forcefield::{ConstantField, SlitPlanes, WallContext, WallOptions, WallPair, Walls};
use lennard_integrators::{IntegratorOptions, Obstacles, build};

use crate::StudyError;
use crate::lab::Rig;

/// Coordinate of the lower plane, σ.
pub(crate) const PLANE: f64 = 2.0;
/// Side of the box, σ.
pub(crate) const SIDE: f64 = 20.0;

/// Walls at z = 2 σ and at the same distance from the other end.
pub(crate) fn floor(wall: &WallOptions) -> Result<Walls, StudyError> {
    let cell = PeriodicBox::new(DVec3::splat(SIDE))?;
    let planes = SlitPlanes::new(&cell, Axis::Z.index(), 2.0 * PLANE, 0.0);
    let pair = WallPair::new(wall, planes, &WallContext { temperature: 1.0 });
    Ok(Walls::new(vec![pair], Streams::new(1).noise("walls")))
}

/// A field that pulls balls of mass 1 to the lower plane, σ/τ².
pub(crate) fn gravity(g: f64) -> ConstantField {
    ConstantField::new(DVec3::new(0.0, 0.0, -g), Masses::Uniform(1.0))
}

/// Balls in a column over a plane at z = 2 σ.
pub(crate) struct Balls(Rig);

impl Balls {
    /// Balls at heights over the plane, σ, with one velocity, σ/τ.
    pub(crate) fn start(
        forces: ForceSum<NoForces>,
        method: &IntegratorOptions,
        (heights, speed): (&[f64], f64),
        h: f64,
    ) -> Result<Self, StudyError> {
        let n = heights.len();
        let place = |z: &f64| DVec3::new(5.0, 5.0, PLANE + z);
        let system = System::atoms(n).pushed_along(forces.properties().breaks_momentum);
        let state = State::new(
            PeriodicBox::new(DVec3::splat(SIDE))?,
            heights.iter().map(place).collect(),
            vec![DVec3::new(0.0, 0.0, speed); n],
        );
        Rig::start(build(method), (system, state), Box::new(forces), h, Want::ENERGY).map(Self)
    }

    /// One ball over a wall under velocity Verlet.
    pub(crate) fn one_over(
        wall: &WallOptions,
        (height, speed): (f64, f64),
        g: f64,
        h: f64,
    ) -> Result<Self, StudyError> {
        let forces =
            ForceSum::new(NoForces).with(Obstacles::new(floor(wall)?, None)).with(gravity(g));
        let method = IntegratorOptions::default();
        Self::start(forces, &method, (&[height], speed), h)
    }

    /// A step, which may fail at a wall that is too weak.
    pub(crate) fn step(&mut self) -> Result<(), StepError> {
        self.0.try_step().map(|_| ())
    }

    /// Steps that must not fail.
    pub(crate) fn steps(&mut self, n: u64) -> Result<(), StudyError> {
        self.0.steps(n)
    }

    /// The height of the lowest ball over the plane, σ.
    pub(crate) fn height(&self) -> f64 {
        self.height_of(0)
    }

    pub(crate) fn height_of(&self, ball: usize) -> f64 {
        self.0.state.positions[ball].z - PLANE
    }

    /// The speed of the lowest ball away from the plane, σ/τ.
    pub(crate) fn speed(&self) -> f64 {
        self.0.state.velocities[0].z
    }

    pub(crate) fn hits(&self) -> u64 {
        self.0.forces.walls()[0].hits
    }

    /// The momentum that the plane has taken, m·σ/τ.
    pub(crate) fn impulse(&self) -> f64 {
        self.0.forces.walls()[0].impulse
    }
}
