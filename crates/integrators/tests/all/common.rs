//! Small systems for the tests: written apart from the library, so that each can judge the other.

use lennard_core::random::Streams;
use lennard_core::{
    Backend, Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceSum, ForceTerm,
    FusedBath, FusedSteps, Integrator, Masses, Molecules, Moving, Own, Part, PeriodicBox, State,
    StepError, StepReport, System, Want, rigid,
};
use lennard_integrators::bonds::{direct, relaxation};
use lennard_integrators::{BondHolder, BondOptions, IntegratorOptions, build, spook};
use rand::RngExt;

/// Particles in motion: their forces, the method that moves them, and what its steps told.
pub struct Rig<F> {
    pub system: System,
    pub state: State,
    pub forces: ForceSum<F>,
    pub method: Integrator,
    pub dt: f64,
    /// What each step tells of its forces.
    pub want: Want,
    /// Σ heat so far, ε.
    pub heat: f64,
    /// The largest iterations and residual of all steps so far.
    pub worst: StepReport,
}

impl<F: Backend> Rig<F> {
    pub fn new(
        method: Integrator,
        system: System,
        state: State,
        forces: ForceSum<F>,
        dt: f64,
    ) -> Self {
        let mut rig = Self::unstarted(method, (system, state), forces, dt);
        rig.start();
        rig
    }

    /// Particles under one term.
    pub fn of(method: Integrator, (system, state): (System, State), term: F, dt: f64) -> Self {
        Self::new(method, system, state, ForceSum::new(term), dt)
    }

    /// Particles before the start, which may fail.
    pub fn unstarted(
        method: Integrator,
        (system, state): (System, State),
        forces: ForceSum<F>,
        dt: f64,
    ) -> Self {
        let (want, worst) = (Want::TOTALS, StepReport::default());
        Self { system, state, forces, method, dt, want, heat: 0.0, worst }
    }

    /// Molecules whose bonds are held by a way of the list, under the forces of its term too.
    pub fn held(
        bonds: &BondOptions,
        (system, state): (System, State),
        mut forces: ForceSum<F>,
        dt: f64,
    ) -> Self {
        let method = build(&IntegratorOptions::default());
        let (method, term) = match bonds.build(&system.molecules) {
            BondHolder::Drift(solver) => (method.with_bonds(solver), None),
            BondHolder::InDrift(solver, term) => (method.with_bonds(solver), Some(term)),
            BondHolder::Spring(term) => (method, Some(term)),
            BondHolder::Spook(bonds, term) => (spook::with_bonds(bonds), term),
        };
        term.into_iter().for_each(|term| forces.push(term));
        Self::new(method, system, state, forces, dt)
    }

    /// Starts with the state as it is now.
    pub fn start(&mut self) {
        self.tried_start().unwrap();
    }

    pub fn tried_start(&mut self) -> Result<(), StepError> {
        let Self { system, state, forces, method, dt, want, .. } = self;
        method.start(system, state, forces, *dt, *want)
    }

    pub fn tried(&mut self) -> Result<StepReport, StepError> {
        let Self { system, state, forces, method, dt, want, heat, worst } = self;
        let report = method.step(system, state, forces, *dt, *want)?;
        *heat += report.heat;
        worst.iterations = worst.iterations.max(report.iterations);
        worst.residual = worst.residual.max(report.residual);
        Ok(report)
    }

    pub fn step(&mut self) -> StepReport {
        self.tried().unwrap_or_else(|e| panic!("{e}"))
    }

    /// Takes up to `most` steps at once, and tells how many.
    pub fn stride(&mut self, most: u64) -> (u64, StepReport) {
        let Self { system, state, forces, method, dt, want, heat, .. } = self;
        let taken = method.stride(system, state, forces, *dt, most, *want).unwrap();
        taken.1.add_heat_to(heat);
        taken
    }

    /// Takes some steps, and gives the rig back.
    pub fn steps(mut self, n: u32) -> Self {
        (0..n).for_each(|_| drop(self.step()));
        self
    }

    pub fn kinetic_energy(&self) -> f64 {
        self.system.kinetic_energy(&self.state.velocities)
    }

    /// K + U without the heat that baths, bonds, walls and contacts put in.
    pub fn conserved(&self) -> f64 {
        self.kinetic_energy() + self.state.energetics.potential_energy.unwrap() - self.heat
    }

    pub fn momentum(&self) -> DVec3 {
        self.system.momentum(&self.state.velocities)
    }

    /// Σ m·(x − lag·v) × v.
    pub fn angular_momentum(&self, lag: f64) -> DVec3 {
        let State { positions, velocities, .. } = &self.state;
        let of = |i: usize| (positions[i] - lag * velocities[i]).cross(velocities[i]);
        (0..positions.len()).map(|i| self.system.masses.moving(i) * of(i)).sum()
    }
}

/// The direct solution of bonds, to a tolerance.
pub fn direct(tolerance: f64) -> BondOptions {
    BondOptions::Direct(direct::Options { tolerance, ..Default::default() })
}

/// Relaxation along the old bonds, to a tolerance.
pub fn shake(tolerance: f64) -> BondOptions {
    let tolerance = Some(tolerance);
    BondOptions::Relaxation(relaxation::Options { tolerance, ..Default::default() })
}

/// Molecules in a box so wide that nothing folds, with velocities that have no part along rigid bonds.
pub fn at(molecules: &Molecules, x: Vec<DVec3>, v: Vec<DVec3>) -> (System, State) {
    let system = System::of_molecules(x.len(), molecules.clone());
    let mut state = State::new(PeriodicBox::new(DVec3::splat(1e3)).unwrap(), x, v);
    rigid::project_velocities(&system, &state.positions, &mut state.velocities);
    (system, state)
}

/// Particles without a box.
pub fn free(positions: Vec<DVec3>, velocities: Vec<DVec3>) -> State {
    State::new(PeriodicBox::boundless(), positions, velocities)
}

/// One particle without a box.
pub fn one(position: DVec3, velocity: DVec3) -> State {
    free(vec![position], vec![velocity])
}

/// The largest distance between two places of a particle.
pub fn farthest(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max)
}

/// 1 − e^{−y}·Σ_{i<shape} yⁱ/i!: the chance that a number of a Gamma distribution of whole shape is at most y.
pub fn gamma_cdf(y: f64, shape: u32) -> f64 {
    let (mut term, mut sum) = (1.0, 0.0);
    for i in 0..shape {
        sum += term;
        term *= y / f64::from(i + 1);
    }
    1.0 - (-y).exp() * sum
}

/// The Kolmogorov–Smirnov distance of samples from the Gamma distribution of a shape, times √n.
pub fn distance_from_gamma(samples: impl IntoIterator<Item = f64>, shape: u32) -> f64 {
    let mut sorted: Vec<f64> = samples.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let off = |(i, y): (usize, &f64)| {
        let f = gamma_cdf(*y, shape);
        (f - i as f64 / n).abs().max(((i + 1) as f64 / n - f).abs())
    };
    sorted.iter().enumerate().map(off).fold(0.0, f64::max) * n.sqrt()
}

/// √n·D exceeds this with probability 2·e^{−2·x²} = 0.001 for samples of the right distribution;
/// the seeds are fixed, so the verdict is always the same.
pub const KS_LIMIT: f64 = 1.95;

/// Adds forces of Lennard-Jones pairs without any cutoff or box, with shares of r⁻¹² and of r⁻⁶, and returns their energy.
/// Sites of one molecule of `sites` do not see each other.
pub fn add_pairs(
    x: &[DVec3],
    (repulsive, attractive): (f64, f64),
    sites: usize,
    forces: &mut [DVec3],
) -> f64 {
    let mut energy = 0.0;
    for i in 0..x.len() {
        for j in (0..i).filter(|j| sites == 1 || i / sites != j / sites) {
            let r_ij = x[i] - x[j];
            let inv_r2 = r_ij.length_squared().recip();
            let inv_r6 = inv_r2 * inv_r2 * inv_r2;
            let (r12, r6) = (repulsive * inv_r6 * inv_r6, attractive * inv_r6);
            energy += 4.0 * (r12 - r6);
            let f = (24.0 * (2.0 * r12 - r6) * inv_r2) * r_ij;
            forces[i] += f;
            forces[j] -= f;
        }
    }
    energy
}

/// Lennard-Jones particles without any cutoff or box, a double loop, U = Σ 4·(r⁻¹² − r⁻⁶).
///
/// Split for RESPA by the potential's own two terms: near r⁻¹², far −r⁻⁶. Takes up to two steps in one go.
pub struct Cluster;

lennard_core::remembers_nothing!(Cluster);

impl ForceTerm for Cluster {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        let shares = match part {
            Part::All => (1.0, 1.0),
            Part::Near => (1.0, 0.0),
            Part::Far => (0.0, 1.0),
        };
        forces.fill(DVec3::ZERO);
        let energy = add_pairs(at.positions, shares, 1, forces);
        if let Some(particle) = forces.iter().position(|f| !f.is_finite()) {
            return Err(ForceError::NonFiniteForce { particle });
        }
        let energy = want.energy.then_some(energy);
        Ok(Energetics {
            potential_energy: energy,
            conserved_potential: energy,
            ..Energetics::default()
        })
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties { splits: true, ..ForceProperties::default() }
    }
}

impl Backend for Cluster {
    fn advance(&mut self, stride: &mut FusedSteps<'_>) -> u64 {
        let steps = stride.steps.min(2);
        let mut forces = vec![DVec3::ZERO; stride.positions.len()];
        for _ in 0..steps {
            let at = Configuration::at_rest(stride.cell, stride.positions);
            self.evaluate(at, Part::All, Want::NOTHING, &mut forces).unwrap();
            let (velocities, h) = (&mut *stride.velocities, stride.dt);
            kick(velocities, &forces, stride.masses, 0.5 * h);
            let scales = stride.bath.as_mut().filter(|bath| bath.scales());
            if let Some(bath) = scales {
                let own = Own::all_of(velocities.len());
                let factor = bath.factor(
                    System::atoms(own.len())
                        .with_masses(stride.masses.clone())
                        .kinetic_energy(velocities),
                );
                velocities.iter_mut().for_each(|v| *v *= factor);
                kick(velocities, &forces, stride.masses, 0.5 * h);
                drift(stride.positions, velocities, h);
                continue;
            }
            kick(velocities, &forces, stride.masses, 0.5 * h);
            let noise = stride.bath.as_ref().and_then(FusedBath::next_noise);
            drift(stride.positions, velocities, if noise.is_some() { 0.5 * h } else { h });
            let mut gained = 0.0;
            if let Some(noise) = &noise {
                let positions = &mut *stride.positions;
                let moving = Moving { positions, velocities, forces: &forces };
                gained = moving.noise(noise, stride.masses, &Own::all_of(forces.len()));
                drift(stride.positions, stride.velocities, 0.5 * h);
            }
            if let Some(bath) = &mut stride.bath {
                bath.pass(|| gained);
            }
        }
        steps
    }
}

/// The kick v ← v + (h/m)·F by the textbook.
pub fn kick(velocities: &mut [DVec3], forces: &[DVec3], masses: &Masses, h: f64) {
    for (i, (v, f)) in velocities.iter_mut().zip(forces).enumerate() {
        *v += (h / masses.of(i)) * *f;
    }
}

/// The drift x ← x + h·v by the textbook.
pub fn drift(positions: &mut [DVec3], velocities: &[DVec3], h: f64) {
    for (x, v) in positions.iter_mut().zip(velocities) {
        *x += h * *v;
    }
}

/// `n` points in a cube of the given side, no two closer than `closest`.
pub fn scattered(n: usize, side: f64, closest: f64, seed: u64) -> Vec<DVec3> {
    let mut rng = Streams::new(seed).sequential("scattered");
    let mut points: Vec<DVec3> = Vec::new();
    while points.len() < n {
        let p = side * DVec3::new(rng.random(), rng.random(), rng.random());
        if points.iter().all(|q| (p - *q).length() > closest) {
            points.push(p);
        }
    }
    points
}

/// A compact cluster on a cubic lattice near the pair minimum, with random velocities whose sum is
/// zero; `edge`³ particles.
pub fn cluster(edge: usize, speed: f64, seed: u64) -> (Vec<DVec3>, Vec<DVec3>) {
    let mut rng = Streams::new(seed).sequential("cluster");
    let mut positions = Vec::new();
    for i in 0..edge.pow(3) {
        let cell =
            DVec3::new((i % edge) as f64, (i / edge % edge) as f64, (i / edge / edge) as f64);
        positions.push(1.12 * cell);
    }
    let mut velocities: Vec<DVec3> = positions
        .iter()
        .map(|_| {
            let v = DVec3::new(rng.random(), rng.random(), rng.random());
            speed * (2.0 * v - DVec3::ONE)
        })
        .collect();
    let mean = velocities.iter().sum::<DVec3>() / velocities.len() as f64;
    for v in &mut velocities {
        *v -= mean;
    }
    (positions, velocities)
}
