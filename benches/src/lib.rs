//! The benchmark cases and a plain time loop around the forces, without the engine.

pub mod arguments;

use lennard_core::random::Streams;
use lennard_core::{
    Backend, Configuration, DVec3, Energetics, ForceError, ForceTerm, FusedSteps, Masses, Momentum,
    Moving, Part, PeriodicBox, SpeedLimit, System, Team, TooManyRanks, Want,
};
use lennard_forcefield::{
    Conditions, ForceFieldError, ForceFieldOptions, KernelOptions, NeighborOptions, PairForces,
    TruncationKind, TruncationOptions, build,
};
use rand_distr::{Distribution, StandardNormal};

/// Density of all cases, σ⁻³.
pub const DENSITY: f64 = 0.8442;
/// Temperature at the start, ε/k_B: the fcc lattice melts and about half of it remains.
pub const START_TEMPERATURE: f64 = 1.44;

/// A benchmark case: `4·cells³` particles from the fcc lattice.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// `A`, `B`, `C`, or another name.
    pub name: &'static str,
    /// fcc cells an axis.
    pub cells: usize,
    /// Time step, τ.
    pub dt: f64,
    /// Seed of the velocities.
    pub seed: u64,
}

/// Seed of the velocities where no other is asked for.
const SEED: u64 = 1967;

/// The cases A (32,000 particles), B (864) and C (953,312).
pub const CASES: [Case; 3] = [
    Case { name: "A", cells: 20, dt: 0.005, seed: SEED },
    Case { name: "B", cells: 6, dt: 0.004, seed: SEED },
    Case { name: "C", cells: 62, dt: 0.005, seed: SEED },
];

/// A system under way.
pub struct Run {
    /// Positions, σ.
    pub positions: Vec<DVec3>,
    /// Velocities, σ/τ.
    pub velocities: Vec<DVec3>,
    /// Forces, ε/σ.
    pub forces: Vec<DVec3>,
    /// What gives them.
    pub provider: PairForces,
    cell: PeriodicBox,
    masses: Masses,
    dt: f64,
    time: f64,
}

impl Case {
    /// Number of particles.
    #[must_use]
    pub fn n_atoms(&self) -> usize {
        4 * self.cells.pow(3)
    }

    /// The box and the fcc lattice in it.
    #[must_use]
    pub fn lattice(&self) -> (PeriodicBox, Vec<DVec3>) {
        let cell = PeriodicBox::cubic_for_density(self.n_atoms(), DENSITY)
            .expect("a positive density gives a box");
        let a = cell.lengths().x / self.cells as f64;
        let basis = [
            DVec3::ZERO,
            DVec3::new(0.5, 0.5, 0.0),
            DVec3::new(0.5, 0.0, 0.5),
            DVec3::new(0.0, 0.5, 0.5),
        ];
        let mut positions = Vec::with_capacity(self.n_atoms());
        for x in 0..self.cells {
            for y in 0..self.cells {
                for z in 0..self.cells {
                    let corner = DVec3::new(x as f64, y as f64, z as f64);
                    positions.extend(basis.map(|b| (corner + b + 0.25) * a));
                }
            }
        }
        (cell, positions)
    }

    /// The case with these kernels, ready for its first step.
    ///
    /// # Errors
    /// [`ForceFieldError`] where this machine cannot run them.
    pub fn start(
        &self,
        kernel: KernelOptions,
        skin: Option<f64>,
        kind: TruncationKind,
    ) -> Result<Run, ForceFieldError> {
        let (cell, positions) = self.lattice();
        let n = positions.len();
        let options = ForceFieldOptions {
            kernel,
            truncation: TruncationOptions::new(kind, 2.5),
            neighbor: NeighborOptions { skin, ..NeighborOptions::default() },
            ..ForceFieldOptions::default()
        };
        let conditions = Conditions {
            cell,
            n_atoms: n,
            // The lattice gives half of its kinetic energy to the potential as it melts.
            temperature: 0.5 * START_TEMPERATURE,
            dt: self.dt,
            mixture: None,
        };
        let provider = build(&options, &conditions)?;
        let mut random = Streams::new(self.seed).sequential("velocities");
        let mut velocities: Vec<DVec3> = (0..n)
            .map(|_| DVec3::from([0; 3].map(|_| StandardNormal.sample(&mut random))))
            .collect();
        let mean = velocities.iter().sum::<DVec3>() / n as f64;
        velocities.iter_mut().for_each(|v| *v -= mean);
        let scale = (START_TEMPERATURE
            / System::atoms(n).temperature(&velocities, Momentum::Conserved))
        .sqrt();
        velocities.iter_mut().for_each(|v| *v *= scale);
        let mut run = Run {
            forces: vec![DVec3::ZERO; n],
            positions,
            velocities,
            provider,
            cell,
            masses: Masses::Uniform(1.0),
            dt: self.dt,
            time: 0.0,
        };
        run.evaluate(Want::NOTHING).expect("a lattice has finite forces");
        Ok(run)
    }
}

impl Run {
    /// Evaluates the forces where the particles are.
    ///
    /// # Errors
    /// [`ForceError`] where one is not finite.
    pub fn evaluate(&mut self, want: Want) -> Result<Energetics, ForceError> {
        let at = Configuration {
            cell: &self.cell,
            positions: &self.positions,
            velocities: None,
            time: self.time,
        };
        self.provider.evaluate(at, Part::All, want, &mut self.forces)
    }

    /// Takes `steps` steps of velocity Verlet, as many as possible in strides, and gives what `want` asks for at the last one.
    ///
    /// # Errors
    /// [`ForceError`] where a force is not finite.
    pub fn steps(&mut self, steps: usize, want: Want) -> Result<Energetics, ForceError> {
        let dt = self.dt;
        let mut energetics = Energetics::default();
        let mut left = steps;
        while left > 0 {
            let Self { positions, velocities, forces, .. } = self;
            let moving = Moving { positions, velocities, forces };
            moving.kick_and_drift(&self.masses, 0.5 * dt, dt);
            let mut stride = FusedSteps {
                cell: &self.cell,
                positions: &mut self.positions,
                velocities: &mut self.velocities,
                forces: &mut self.forces,
                masses: &self.masses,
                dt,
                steps: left as u64 - 1,
                first: 0,
                bath: None,
            };
            let taken = 1 + self.provider.advance(&mut stride) as usize;
            self.time += dt * taken as f64;
            left -= taken;
            energetics = self.evaluate(if left == 0 { want } else { Want::NOTHING })?;
            let Self { positions, velocities, forces, .. } = self;
            Moving { positions, velocities, forces }.kick(&self.masses, 0.5 * dt);
        }
        Ok(energetics)
    }

    /// Takes the particles of this rank from another run of the case, and shares the forces with a team.
    ///
    /// # Errors
    /// [`TooManyRanks`] where there are not enough particles.
    pub fn share(&mut self, team: &Team, whole: &Self) -> Result<(), TooManyRanks> {
        let own = team.numbers(whole.positions.len());
        self.positions = whole.positions[own.clone()].to_vec();
        self.velocities = whole.velocities[own.clone()].to_vec();
        self.forces = whole.forces[own].to_vec();
        let limit = SpeedLimit { every: 1000, largest: f64::INFINITY };
        self.provider.share(team, &self.cell, limit).map(drop)
    }

    /// Kinetic energy, ε.
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        System::atoms(self.positions.len()).kinetic_energy(&self.velocities)
    }

    /// Temperature, ε/k_B.
    #[must_use]
    pub fn temperature(&self) -> f64 {
        System::atoms(self.positions.len()).temperature(&self.velocities, Momentum::Conserved)
    }
}
