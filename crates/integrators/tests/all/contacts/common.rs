//! Few bodies and many, under contacts alone.

use lennard_core::random::Streams;
use lennard_core::{
    Boundary, DVec3, Exclusions, Flight, ForceSum, Masses, NoForces, PeriodicBox, State, System,
};
use lennard_forcefield::{SlitPlanes, WallContext, WallOptions, WallPair, Walls};
use lennard_integrators::{Bodies, ContactOptions, Contacts, Obstacles, Response};
use lennard_integrators::{IntegratorOptions, build};
use rand::RngExt;

pub(crate) type Rig = crate::common::Rig<NoForces>;

/// Bodies under a method of the list.
pub(crate) fn rig(
    method: &IntegratorOptions,
    system: System,
    (cell, x, v): (PeriodicBox, Vec<DVec3>, Vec<DVec3>),
    forces: ForceSum<NoForces>,
    dt: f64,
) -> Rig {
    Rig::new(build(method), system, State::new(cell, x, v), forces, dt)
}

/// Bodies under velocity Verlet.
pub(crate) fn verlet(
    system: System,
    start: (PeriodicBox, Vec<DVec3>, Vec<DVec3>),
    forces: ForceSum<NoForces>,
    dt: f64,
) -> Rig {
    rig(&IntegratorOptions::default(), system, start, forces, dt)
}

pub(crate) fn cube(side: f64) -> PeriodicBox {
    PeriodicBox::new(DVec3::splat(side)).unwrap()
}

/// Walls across some axes of a cube, half a thickness from its faces, as a scene writes them.
pub(crate) fn walls(text: &str, side: f64, axes: &[usize], thickness: f64) -> Walls {
    let options: WallOptions = toml::from_str(text).unwrap();
    let context = WallContext { temperature: 1.3 };
    let planes = |axis: &usize| SlitPlanes::new(&cube(side), *axis, thickness, 0.0);
    let pairs = axes.iter().map(|axis| WallPair::new(&options, planes(axis), &context));
    Walls::new(pairs.collect(), Streams::new(7).noise("walls"))
}

/// A flight over `h` in a cube; returns the energy that it put in.
pub(crate) fn fly(
    obstacles: &mut dyn Boundary,
    side: f64,
    (positions, velocities): (&mut [DVec3], &mut [DVec3]),
    (forces, masses): (&[DVec3], &Masses),
    (h, step): (f64, u64),
) -> f64 {
    let cell = &cube(side);
    let is_later = false;
    let flight = Flight { cell, positions, velocities, forces, masses, h, step, is_later };
    obstacles.fly(flight).unwrap().heat
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
