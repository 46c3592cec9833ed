//! Few bodies and many, under contacts alone.

use lennard_core::random::Streams;
use lennard_core::{
    DVec3, Exclusions, ForceSum, Integrator, NoForces, PeriodicBox, State, System, Want,
};
use lennard_integrators::{Bodies, ContactOptions, Contacts, Obstacles, Response};
use lennard_integrators::{IntegratorOptions, build};
use rand::RngExt;

/// A ring of time: bodies, their forces and the method that moves them.
pub(crate) struct Rig {
    pub system: System,
    pub state: State,
    pub forces: ForceSum<NoForces>,
    method: Integrator,
    dt: f64,
    /// Σ heat so far, ε.
    pub heat: f64,
}

impl Rig {
    pub(crate) fn new(
        system: System,
        (cell, x, v): (PeriodicBox, Vec<DVec3>, Vec<DVec3>),
        forces: ForceSum<NoForces>,
        dt: f64,
    ) -> Self {
        Self::by(&IntegratorOptions::default(), system, (cell, x, v), forces, dt)
    }

    /// Bodies under a method of the list.
    pub(crate) fn by(
        method: &IntegratorOptions,
        system: System,
        (cell, x, v): (PeriodicBox, Vec<DVec3>, Vec<DVec3>),
        forces: ForceSum<NoForces>,
        dt: f64,
    ) -> Self {
        let mut rig = Self {
            system,
            state: State::new(cell, x, v),
            forces,
            method: build(method),
            dt,
            heat: 0.0,
        };
        let Self { system, state, forces, method, .. } = &mut rig;
        method.start(system, state, forces, dt, Want::ENERGY).unwrap();
        rig
    }

    pub(crate) fn step(&mut self) {
        let Self { system, state, forces, method, dt, heat } = self;
        let report = method.step(system, state, forces, *dt, Want::ENERGY);
        *heat += report.unwrap().heat;
    }

    pub(crate) fn kinetic_energy(&self) -> f64 {
        self.system.kinetic_energy(&self.state.velocities)
    }

    /// K + U without the heat that contacts put in.
    pub(crate) fn conserved(&self) -> f64 {
        self.kinetic_energy() + self.state.energetics.potential_energy.unwrap() - self.heat
    }
}

pub(crate) fn cube(side: f64) -> PeriodicBox {
    PeriodicBox::new(DVec3::splat(side)).unwrap()
}

/// Equal spheres of diameter 1 σ.
pub(crate) fn spheres(response: Response) -> Obstacles {
    Obstacles::new(None, Contacts::new(response, Bodies::alike(1.0, Exclusions::NONE)))
}

pub(crate) fn alone(contacts: Obstacles) -> ForceSum<NoForces> {
    ForceSum::new(NoForces).with(contacts)
}

pub(crate) fn of_kind(name: &str) -> Response {
    let all = ContactOptions::all();
    let found = all.iter().find(|options| options.spec().name == name);
    found.unwrap().response()
}

/// Velocities with components between −1 and 1.
pub(crate) fn random_vectors(n: usize, name: &str) -> Vec<DVec3> {
    let mut random = Streams::new(7).sequential(name);
    let mut number = || 2.0 * random.random::<f64>() - 1.0;
    (0..n).map(|_| DVec3::new(number(), number(), number())).collect()
}

/// A simple cubic lattice of n³ points with a spacing, shaken.
pub(crate) fn lattice(n: usize, spacing: f64, shaken_by: f64) -> Vec<DVec3> {
    let shaken = random_vectors(n * n * n, "lattice");
    let place = |k: usize| DVec3::new((k % n) as f64, (k / n % n) as f64, (k / n / n) as f64);
    (0..n * n * n).map(|k| spacing * (place(k) + 0.5) + shaken_by * shaken[k]).collect()
}
