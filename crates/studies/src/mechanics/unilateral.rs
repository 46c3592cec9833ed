//! Unilateral contacts of SPOOK in whole steps: restitution, stacks at rest, energy of a ball, sweeps.

use lennard_contacts::{Bodies, Contacts, Response, UnilateralLaw};
use lennard_core::random::Streams;
use lennard_core::{
    Axis, DVec3, Exclusions, ForceSum, ForceTerm, Integrator, Masses, NoForces, PeriodicBox, State,
    System, Want,
};
use lennard_forcefield::{
    ConstantField, Hard, SlitPlanes, WallContext, WallOptions, WallPair, Walls,
};
use lennard_integrators::contacts::{Contact, Problem, Solver};
use lennard_integrators::spook::{self, Damping};
use lennard_integrators::{IntegratorOptions, build};
use serde::Serialize;

use super::ball::{PLANE, SIDE};
use crate::StudyError;

/// Restitution of the measurements over phases.
pub(crate) const SHARE: f64 = 0.4;
/// Compliance of the stack at rest, σ²/ε.
const COMPLIANCE: f64 = 1e-3;
/// Balls of the row whose sweeps are counted.
const SWEPT: usize = 10;

/// What runs with contacts of SPOOK showed.
#[derive(Debug, Clone, Serialize)]
pub struct Unilateral {
    /// The restitution farthest from 0.4 over 100 phases of a step, less 0.4.
    pub restitution: f64,
    /// The depth of a stack of five at rest that is farthest from ε × force, relative.
    pub sunk: f64,
    /// The momentum that the stack hands to the floor, over its weight, less 1.
    pub weight: f64,
    /// The largest | E/E₀ − 1 | of a ball in gravity with e = 1 over its bounces.
    pub energy: f64,
    /// The factor by which a sweep over a stack of ten lowers the error, measured and cos²(π/20).
    pub sweep: [f64; 2],
}

/// Balls over a plane that contacts solve for.
struct Bodied {
    system: System,
    state: State,
    forces: ForceSum<NoForces>,
    method: Integrator,
    h: f64,
}

impl Bodied {
    /// Balls of diameter 1 in a column, at heights over the plane, with one velocity.
    fn start(
        (restitution, compliance): (f64, f64),
        heights: &[f64],
        (speed, gravity): (f64, f64),
        h: f64,
    ) -> Result<Self, StudyError> {
        let cell = PeriodicBox::new(DVec3::splat(SIDE))?;
        let planes = SlitPlanes::new(&cell, Axis::Z.index(), 2.0 * PLANE, 0.0);
        let wall = WallOptions::Hard(Hard {
            response: lennard_forcefield::Response::Contact,
            restitution: Some(restitution),
        });
        let pair = WallPair::new(&wall, planes, &WallContext { temperature: 1.0 });
        let walls = Walls::new(vec![pair], Streams::new(1).noise("walls"));
        let law = UnilateralLaw {
            restitution,
            compliance,
            damping: Damping::Steps(2.0),
            solver: Solver::Exact,
        };
        let bodies = Bodies::alike(1.0, Exclusions::NONE);
        let contacts = Contacts::new(Response::Unilateral(law), bodies, Some(walls));
        let field = ConstantField::new(DVec3::new(0.0, 0.0, -gravity), Masses::Uniform(1.0));
        let forces = ForceSum::new(NoForces).with(contacts).with(field);
        let place = |z: &f64| DVec3::new(5.0, 5.0, PLANE + z);
        let mut started = Self {
            system: System::atoms(heights.len()).pushed_along(forces.properties().breaks_momentum),
            state: State::new(
                cell,
                heights.iter().map(place).collect(),
                vec![DVec3::new(0.0, 0.0, speed); heights.len()],
            ),
            forces,
            method: build(&IntegratorOptions::Spook(spook::Options {})),
            h,
        };
        let Self {
            system,
            state,
            forces,
            method,
            ..
        } = &mut started;
        method
            .start(system, state, forces, h, Want::NOTHING)
            .map_err(|source| failed(h, source))?;
        Ok(started)
    }

    fn steps(&mut self, n: u32) -> Result<(), StudyError> {
        let Self {
            system,
            state,
            forces,
            method,
            h,
        } = self;
        for _ in 0..n {
            method
                .step(system, state, forces, *h, Want::NOTHING)
                .map_err(|source| failed(*h, source))?;
        }
        Ok(())
    }

    fn floor(&self) -> f64 {
        self.forces.walls()[0].impulse
    }

    fn z(&self, i: usize) -> f64 {
        self.state.positions[i].z - PLANE
    }
}

fn failed(dt: f64, source: lennard_core::StepError) -> StudyError {
    StudyError::Step {
        method: spook::SPEC.name,
        dt,
        source,
    }
}

fn restitution() -> Result<f64, StudyError> {
    let (h, mut worst) = (0.01, 0.0_f64);
    for k in 1..=100 {
        let above = (1.0 - f64::from(k) / 100.0) * h;
        let mut ball = Bodied::start((SHARE, 0.0), &[above], (-1.0, 0.0), h)?;
        ball.steps(30)?;
        let off = ball.state.velocities[0].z - SHARE;
        if off.abs() > worst.abs() {
            worst = off;
        }
    }
    Ok(worst)
}

fn stack() -> Result<[f64; 2], StudyError> {
    let h = 0.005;
    let heights: Vec<f64> = (0..5).map(|i| 0.1 + 1.1 * f64::from(i)).collect();
    let mut stack = Bodied::start((0.2, COMPLIANCE), &heights, (0.0, 1.0), h)?;
    stack.steps(16_000)?;
    let before = stack.floor();
    stack.steps(2000)?;
    let weight = (stack.floor() - before) / (2000.0 * h * 5.0) - 1.0;
    let depth = |i: usize| match i {
        0 => -stack.z(0),
        _ => 1.0 - (stack.z(i) - stack.z(i - 1)),
    };
    let off = (0..5).map(|i| (depth(i) / (COMPLIANCE * (5 - i) as f64) - 1.0).abs());
    Ok([off.fold(0.0, f64::max), weight])
}

/// In a constant field positions and v + h·f/(2m) lie on the exact parabola, so that the energy there is exact.
fn energy(quick: bool) -> Result<f64, StudyError> {
    let h = 0.01;
    let mut ball = Bodied::start((1.0, 0.0), &[1.0], (0.0, 1.0), h)?;
    let of = |ball: &Bodied| {
        let v = ball.state.velocities[0].z - 0.5 * h;
        0.5 * v * v + ball.z(0)
    };
    let (start, mut worst) = (of(&ball), 0.0_f64);
    for _ in 0..if quick { 20_000 } else { 200_000 } {
        ball.steps(1)?;
        worst = worst.max((of(&ball) / start - 1.0).abs());
    }
    Ok(worst)
}

fn sweep() -> [f64; 2] {
    let contacts: Vec<Contact> = (0..SWEPT)
        .map(|second| Contact {
            first: second.checked_sub(1),
            second,
            normal: DVec3::Z,
            gap: 0.0,
        })
        .collect();
    // What gravity does in a step: the floor alone sees the fall, and the solution is (n, …, 1).
    let mut b = vec![0.0; SWEPT];
    b[0] = -1.0;
    let error = |sweeps| -> f64 {
        let problem = Problem {
            contacts: &contacts,
            masses: &Masses::Uniform(1.0),
            sigma: 0.0,
            b: &b,
        };
        let found = problem.solve(Solver::Sweeps(sweeps)).impulses;
        let off = (found.iter().enumerate()).map(|(i, x)| (x - (SWEPT - i) as f64).abs());
        off.sum()
    };
    let theory = (std::f64::consts::PI / (2 * SWEPT) as f64).cos().powi(2);
    [error(401) / error(400), theory]
}

/// Measures everything.
pub(crate) fn measure(quick: bool) -> Result<Unilateral, StudyError> {
    let [sunk, weight] = stack()?;
    Ok(Unilateral {
        restitution: restitution()?,
        sunk,
        weight,
        energy: energy(quick)?,
        sweep: sweep(),
    })
}
