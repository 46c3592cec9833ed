//! One ball over a plane.

use lennard_core::random::Streams;
use lennard_core::{
    Axis, DVec3, ForceSum, ForceTerm, Integrator, Masses, NoForces, PeriodicBox, State, StepError,
    System, Want,
};
use lennard_forcefield::{ConstantField, SlitPlanes, WallContext, WallOptions, WallPair, Walls};
use lennard_integrators::{IntegratorOptions, build};

use crate::StudyError;

/// Coordinate of the lower plane, σ.
pub(crate) const PLANE: f64 = 2.0;
/// Side of the box, σ.
pub(crate) const SIDE: f64 = 20.0;

/// A ball over a plane at z = 2 σ.
pub(crate) struct Ball {
    system: System,
    state: State,
    forces: ForceSum<NoForces>,
    integrator: Integrator,
    h: f64,
}

impl Ball {
    pub(crate) fn start(
        wall: &WallOptions,
        (height, speed): (f64, f64),
        gravity: f64,
        h: f64,
    ) -> Result<Self, StudyError> {
        let cell = PeriodicBox::new(DVec3::splat(SIDE))?;
        let planes = SlitPlanes::new(&cell, Axis::Z.index(), 2.0 * PLANE, 0.0);
        let context = WallContext { temperature: 1.0 };
        let walls = Walls::new(
            vec![WallPair::new(wall, planes, &context)],
            Streams::new(1).noise("walls"),
        );
        let field = ConstantField::new(DVec3::new(0.0, 0.0, -gravity), Masses::Uniform(1.0));
        let forces = ForceSum::new(NoForces).with(walls).with(field);
        let mut ball = Self {
            system: System::atoms(1).pushed_along(forces.properties().breaks_momentum),
            state: State::new(
                cell,
                vec![DVec3::new(5.0, 5.0, PLANE + height)],
                vec![DVec3::new(0.0, 0.0, speed)],
            ),
            forces,
            integrator: build(&IntegratorOptions::default()),
            h,
        };
        let Self {
            system,
            state,
            forces,
            integrator,
            ..
        } = &mut ball;
        let method = integrator.spec().name;
        integrator
            .start(system, state, forces, h, Want::ENERGY)
            .map_err(|source| StudyError::Step {
                method,
                dt: h,
                source,
            })?;
        Ok(ball)
    }

    pub(crate) fn step(&mut self) -> Result<(), StepError> {
        let Self {
            system,
            state,
            forces,
            integrator,
            h,
        } = self;
        integrator.step(system, state, forces, *h, Want::ENERGY)?;
        Ok(())
    }

    pub(crate) fn height(&self) -> f64 {
        self.state.positions[0].z - PLANE
    }

    pub(crate) fn speed(&self) -> f64 {
        self.state.velocities[0].z
    }

    pub(crate) fn hits(&self) -> u64 {
        self.forces.walls()[0].hits
    }
}
