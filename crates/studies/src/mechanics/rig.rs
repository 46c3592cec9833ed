//! Few bodies in a wide box, with bonds held in any way: what the chapters of the study run.

use lennard_core::{
    Backend, Bond, Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceSum,
    ForceTerm, Integrator, Masses, Molecules, Part, PeriodicBox, State, StepError, StepReport,
    System, Want, rigid,
};
use lennard_forcefield::ContactLaw;
use lennard_integrators::{BondHolder, BondOptions, IntegratorOptions, build, spook};

use crate::StudyError;

/// Side of the box, σ: nothing gets across it.
const SIDE: f64 = 1e4;
/// The mass of a bead that is held: it moves by less than rounding.
const HELD: f64 = 1e15;

/// Forces between few bodies, as sums over all pairs without a cutoff.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Few {
    /// Sites of a molecule, whose sites do not interact.
    pub(crate) sites: usize,
    /// Whether sites of different molecules are Lennard-Jones particles.
    pub(crate) pairs: bool,
    /// Acceleration along −z.
    pub(crate) gravity: f64,
    /// Whether the first bead is held.
    pub(crate) is_held: bool,
    /// Spheres of diameter 1 σ that touch.
    pub(crate) contact: Option<ContactLaw>,
}

lennard_core::remembers_nothing!(Few);

impl Few {
    /// Energy and force on the first of two bodies at a distance d apart.
    fn between(&self, d: DVec3) -> (f64, DVec3) {
        let r2 = d.length_squared();
        let mut sum = (0.0, DVec3::ZERO);
        if self.pairs {
            let s6 = r2.powi(-3);
            sum.0 += 4.0 * (s6 * s6 - s6);
            sum.1 += (48.0 * s6 * s6 - 24.0 * s6) / r2 * d;
        }
        if let Some(contact) = self.contact {
            let r = r2.sqrt();
            let point = contact.at(1.0 - r);
            sum.0 += point.energy;
            sum.1 += point.force / r * d;
        }
        sum
    }
}

impl ForceTerm for Few {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        _part: Part,
        _want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        let x = at.positions;
        if let Some(particle) = x.iter().position(|x| !x.is_finite()) {
            return Err(ForceError::NonFinitePosition { particle });
        }
        forces.fill(DVec3::new(0.0, 0.0, -self.gravity));
        let first = usize::from(self.is_held);
        forces[..first].fill(DVec3::ZERO);
        let mut energy: f64 = x[first..].iter().map(|x| self.gravity * x.z).sum();
        if self.pairs || self.contact.is_some() {
            for i in 0..x.len() {
                for j in 0..i {
                    if i / self.sites != j / self.sites {
                        let (u, f) = self.between(x[i] - x[j]);
                        energy += u;
                        forces[i] += f;
                        forces[j] -= f;
                    }
                }
            }
        }
        Ok(Energetics {
            potential_energy: Some(energy),
            conserved_potential: Some(energy),
            ..Energetics::default()
        })
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties::default()
    }
}

impl Backend for Few {}

/// Bodies, where they start and how fast, and their forces.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    pub(crate) bond_length: f64,
    pub(crate) x: Vec<DVec3>,
    pub(crate) v: Vec<DVec3>,
    pub(crate) forces: Few,
}

impl Case {
    /// A chain of unit masses at rest along x in gravity, whose first bead is held at the origin.
    pub(crate) fn hanging(beads: usize, length: f64, gravity: f64) -> Self {
        let along = |k: usize| DVec3::new(length * k as f64, 0.0, 0.0);
        Self {
            bond_length: length,
            x: (0..=beads).map(along).collect(),
            v: vec![DVec3::ZERO; beads + 1],
            forces: Few { sites: beads + 1, gravity, is_held: true, ..Few::default() },
        }
    }

    /// One dumbbell of length 1 that turns about its centre with the angular velocity Ω.
    pub(crate) fn rotor(omega: f64) -> Self {
        let half = DVec3::new(0.5, 0.0, 0.0);
        let speed = DVec3::new(0.0, 0.5 * omega, 0.0);
        Self {
            bond_length: 1.0,
            x: vec![-half, half],
            v: vec![-speed, speed],
            forces: Few { sites: 2, ..Few::default() },
        }
    }

    /// Two dumbbells that meet, with the full Lennard-Jones potential between their sites.
    pub(crate) fn two_dumbbells() -> Self {
        const HALF: f64 = 0.335;
        let speed = |v: f64| DVec3::new(v, 0.0, 0.0);
        Self {
            bond_length: 2.0 * HALF,
            x: vec![
                DVec3::new(-1.5, 0.1, -HALF),
                DVec3::new(-1.5, 0.1, HALF),
                DVec3::new(1.5, -0.1 - HALF, 0.0),
                DVec3::new(1.5, -0.1 + HALF, 0.0),
            ],
            v: vec![speed(1.0), speed(1.0), speed(-1.0), speed(-1.0)],
            forces: Few { sites: 2, pairs: true, ..Few::default() },
        }
    }

    /// A straight chain of `bonds` bonds of length 1 in free space, every site moving apart a little.
    pub(crate) fn stretching(bonds: usize, angle: f64) -> Self {
        let mut x = vec![DVec3::ZERO];
        for c in 0..bonds {
            let turned = angle * (c % 2) as f64;
            x.push(x[c] + DVec3::new(turned.cos(), turned.sin(), 0.0));
        }
        Self {
            bond_length: 1.0,
            v: x.clone(),
            x,
            forces: Few { sites: bonds + 1, ..Few::default() },
        }
    }
}

/// Bodies on their way.
pub(crate) struct Rig {
    pub(crate) system: System,
    pub(crate) state: State,
    forces: ForceSum<Few>,
    integrator: Integrator,
    dt: f64,
    want: Want,
}

impl Rig {
    /// A case whose bonds are held in a way, with the step `dt`; velocities lose their part along rigid bonds.
    pub(crate) fn start(case: &Case, bonds: &BondOptions, dt: f64) -> Result<Self, StudyError> {
        let molecules = Molecules::chains(case.forces.sites, case.bond_length, bonds.bonds());
        let mut forces = ForceSum::new(case.forces);
        let method = build(&IntegratorOptions::default());
        let integrator = match bonds.build(&molecules) {
            BondHolder::Drift(solver) => method.with_bonds(solver),
            BondHolder::InDrift(solver, term) => {
                forces.push(term);
                method.with_bonds(solver)
            }
            BondHolder::Spook(bonds, _) => spook::with_bonds(bonds),
            BondHolder::Spring(term) => {
                forces.push(term);
                method
            }
        };
        Self::with(case, molecules, forces, integrator, dt)
    }

    /// A case whose velocities stretch bonds at the first drift: they keep their part along the bonds.
    pub(crate) fn start_stretching(
        case: &Case,
        bonds: &BondOptions,
        dt: f64,
    ) -> Result<Self, StudyError> {
        let mut rig = Self::start(case, bonds, dt)?;
        rig.state.velocities.clone_from(&case.v);
        Ok(rig)
    }

    /// A case of free bodies under velocity Verlet.
    pub(crate) fn of_free_bodies(case: &Case, dt: f64) -> Result<Self, StudyError> {
        let method = build(&IntegratorOptions::default());
        Self::with(case, Molecules::ATOMS, ForceSum::new(case.forces), method, dt)
    }

    fn with(
        case: &Case,
        molecules: Molecules,
        forces: ForceSum<Few>,
        integrator: Integrator,
        dt: f64,
    ) -> Result<Self, StudyError> {
        let mut masses = vec![1.0; case.x.len()];
        if case.forces.is_held {
            masses[0] = HELD;
        }
        let system =
            System::of_molecules(case.x.len(), molecules).with_masses(Masses::Each(masses));
        let cell = PeriodicBox::new(DVec3::splat(SIDE))?;
        let mut state = State::new(cell, case.x.clone(), case.v.clone());
        rigid::project_velocities(&system, &state.positions, &mut state.velocities);
        let mut rig = Self { system, state, forces, integrator, dt, want: Want::ENERGY };
        let Self { system, state, forces, integrator, .. } = &mut rig;
        let method = integrator.spec().name;
        integrator
            .start(system, state, forces, dt, Want::ENERGY)
            .map_err(|source| StudyError::Step { method, dt, source })?;
        Ok(rig)
    }

    /// The same without energies, for timing.
    pub(crate) fn for_timing(self) -> Self {
        Self { want: Want::NOTHING, ..self }
    }

    /// One step of a method that may fail.
    pub(crate) fn step(&mut self) -> Result<StepReport, StepError> {
        let Self { system, state, forces, integrator, dt, want } = self;
        integrator.step(system, state, forces, *dt, *want)
    }

    /// Kinetic and potential energy, ε.
    pub(crate) fn energy(&self) -> f64 {
        let potential = self.state.energetics.potential_energy;
        self.system.kinetic_energy(&self.state.velocities) + potential.unwrap_or(f64::NAN)
    }

    /// The largest | |d|/r − 1 | over all bonds.
    pub(crate) fn strain(&self) -> f64 {
        let molecules = &self.system.molecules;
        let strain = self.state.positions.chunks(molecules.sites()).flat_map(|m| {
            let strain = |bond: &Bond| (bond.vector(m).length() / bond.length - 1.0).abs();
            molecules.bonds().iter().map(strain).collect::<Vec<f64>>()
        });
        strain.fold(0.0, f64::max)
    }
}

/// What a run showed.
#[derive(Debug, Clone, Default)]
pub(crate) struct Ran {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) velocities: Vec<DVec3>,
    /// Energy at the end less energy at the start, ε.
    pub(crate) change: f64,
    /// Root mean square of E − E(0), ε.
    pub(crate) rms: f64,
    /// Mean energy of the first tenth of the steps less mean of the last tenth, ε.
    pub(crate) loss: f64,
    /// Largest | |d|/r − 1 |.
    pub(crate) strain: f64,
    /// Iterations or sweeps per step.
    pub(crate) iterations: f64,
}

/// Runs a case for a time in so many steps; `Err` in the inner result where the method gives up.
pub(crate) fn run(
    case: &Case,
    bonds: &BondOptions,
    time: f64,
    steps: u32,
) -> Result<Result<Ran, StepError>, StudyError> {
    let mut rig = Rig::start(case, bonds, time / f64::from(steps))?;
    let first = rig.energy();
    let mut ran = Ran::default();
    let (mut squares, mut ends) = (0.0, [0.0; 2]);
    let tenth = steps.div_ceil(10);
    for n in 0..steps {
        let report = match rig.step() {
            Ok(report) => report,
            Err(e) => return Ok(Err(e)),
        };
        let off = rig.energy() - first;
        squares += off.powi(2);
        if n < tenth {
            ends[0] += off;
        }
        if n >= steps - tenth {
            ends[1] += off;
        }
        ran.iterations += f64::from(report.iterations);
        ran.strain = ran.strain.max(rig.strain());
    }
    let n = f64::from(steps);
    Ok(Ok(Ran {
        positions: rig.state.positions.clone(),
        velocities: rig.state.velocities.clone(),
        change: rig.energy() - first,
        rms: (squares / n).sqrt(),
        loss: (ends[0] - ends[1]) / f64::from(tenth),
        iterations: ran.iterations / n,
        ..ran
    }))
}

/// The largest distance between positions and those that are known, σ.
pub(crate) fn distance(found: &[DVec3], known: &[DVec3]) -> f64 {
    let off = found.iter().zip(known).map(|(x, y)| x.distance(*y));
    off.fold(0.0, f64::max)
}
