//! An integrator of one's own, beside velocity Verlet at the same number of force evaluations.
#![allow(clippy::print_stdout)] // printing is what this program is for

use lennard::parts::{IntegratorSpec, Method, Step, StepError, remembers_nothing};
use lennard::prelude::*;

/// The part of the step at which the outer kicks end.
const LAMBDA: f64 = 0.193_183_327_503_783_6;

static SPEC: IntegratorSpec = IntegratorSpec {
    name: "optimised-verlet",
    summary: "Verlet with two force evaluations, whose errors of third order are as small as can be.",
    equations: "kick by λh, drift by h/2, kick by (1 − 2λ)h, drift by h/2, kick by λh",
    position_order: 2,
    velocity_order: 2,
    symplectic: true,
    reversible: true,
    fixed_step_only: false,
    velocity_dependent_forces: false,
    conserves_momentum: true,
    half_kicks: false,
    is_kick_drift_kick: false,
    holds_rigid_bonds: false,
    on_ranks: true,
    force_evaluations: 2,
    stability_limit: None,
    oscillator_map: None,
    source: "Omelyan, Mryglod and Folk, \"Optimized Verlet-like algorithms for molecular dynamics simulations\", Phys. Rev. E 65, 056706 (2002)",
};

/// The method.
#[derive(Clone)]
pub(crate) struct OptimisedVerlet;

remembers_nothing!(OptimisedVerlet);

impl Method for OptimisedVerlet {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        s.kick(LAMBDA);
        s.drift(0.5);
        s.inner_forces()?;
        s.kick(1.0 - 2.0 * LAMBDA);
        s.drift(0.5);
        s.forces()?;
        s.kick(LAMBDA);
        Ok(())
    }
}

/// How much the energy of a liquid fluctuates at constant energy, ε for each particle, over 6 τ.
fn energy_noise(dt: f64, parts: OwnParts) -> lennard::Result<f64> {
    let scene = SceneBuilder::open("fluid/switch")
        .set("system.n_atoms", 256)
        .set("truncation.r_cut", 2.5)
        .set("integrator.dt", dt)
        .stages([
            toml! { name = "melt" steps = 400 temperature = 1.0 thermostat = "bussi" },
            toml! { name = "production" steps = 1 },
        ])
        .set("stage.production.steps", (6.0 / dt) as i64)
        .build()?;
    let mut liquid = Simulation::with_parts(scene, parts)?;
    liquid.run()?;
    Ok(liquid.results().record.conservation.energy_rms_per_atom)
}

pub(crate) fn main() -> lennard::Result<()> {
    let verlet = energy_noise(0.005, OwnParts::none())?;
    let own = energy_noise(0.01, OwnParts::none().method(OptimisedVerlet))?;
    println!("velocity Verlet, dt = 0.005:  {verlet:.1e} ε");
    println!("optimised Verlet, dt = 0.010: {own:.1e} ε");
    assert!(own < 0.7 * verlet, "{own} is not below {verlet}");
    Ok(())
}
