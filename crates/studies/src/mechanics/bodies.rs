//! Few bodies in a wide box, with bonds held in any way: what the chapters of the study run.

use lennard_core::{
    Backend, Bond, Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceSum,
    ForceTerm, Integrator, Masses, Molecules, Part, PeriodicBox, State, StepError, System, Want,
    rigid,
};
use lennard_forcefield::ContactLaw;
use lennard_integrators::{BondHolder, BondOptions, IntegratorOptions, build, spook};

use crate::StudyError;
use crate::lab::Rig;

/// Side of the box, σ: nothing gets across it.
const SIDE: f64 = 1e4;
/// The mass of a bead that is held: it moves by less than rounding.
const HELD: f64 = 1e15;

/// Forces between few bodies, as sums over all pairs without a cutoff.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct BodyForces {
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

lennard_core::remembers_nothing!(BodyForces);

impl BodyForces {
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

impl ForceTerm for BodyForces {
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

impl Backend for BodyForces {}

/// Bodies, where they start and how fast, and their forces.
#[derive(Debug, Clone)]
pub(crate) struct Bodies {
    pub(crate) bond_length: f64,
    pub(crate) x: Vec<DVec3>,
    pub(crate) v: Vec<DVec3>,
    pub(crate) forces: BodyForces,
}

impl Bodies {
    /// A chain of unit masses at rest along x in gravity, whose first bead is held at the origin.
    pub(crate) fn hanging(beads: usize, length: f64, gravity: f64) -> Self {
        let along = |k: usize| DVec3::new(length * k as f64, 0.0, 0.0);
        Self {
            bond_length: length,
            x: (0..=beads).map(along).collect(),
            v: vec![DVec3::ZERO; beads + 1],
            forces: BodyForces {
                sites: beads + 1,
                gravity,
                is_held: true,
                ..BodyForces::default()
            },
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
            forces: BodyForces { sites: 2, ..BodyForces::default() },
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
            forces: BodyForces { sites: 2, pairs: true, ..BodyForces::default() },
        }
    }

    /// A chain of `bonds` bonds of length 1 in free space, every second one turned by an angle, every site moving
    /// apart a little.
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
            forces: BodyForces { sites: bonds + 1, ..BodyForces::default() },
        }
    }

    /// Starts the bodies with bonds that are held in a way; velocities lose their part along rigid bonds.
    pub(crate) fn start(&self, bonds: &BondOptions, dt: f64) -> Result<Rig, StudyError> {
        let sites = self.forces.sites;
        let molecules = Molecules::chains(sites, self.bond_length, bonds.bonds());
        let mut forces = ForceSum::new(self.forces);
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
        self.start_with(molecules, forces, integrator, dt)
    }

    /// Starts free bodies under velocity Verlet.
    pub(crate) fn start_free(&self, dt: f64) -> Result<Rig, StudyError> {
        let method = build(&IntegratorOptions::default());
        self.start_with(Molecules::ATOMS, ForceSum::new(self.forces), method, dt)
    }

    fn start_with(
        &self,
        molecules: Molecules,
        forces: ForceSum<BodyForces>,
        integrator: Integrator,
        dt: f64,
    ) -> Result<Rig, StudyError> {
        let mut masses = vec![1.0; self.x.len()];
        if self.forces.is_held {
            masses[0] = HELD;
        }
        let system =
            System::of_molecules(self.x.len(), molecules).with_masses(Masses::Each(masses));
        let cell = PeriodicBox::new(DVec3::splat(SIDE))?;
        let mut state = State::new(cell, self.x.clone(), self.v.clone());
        rigid::project_velocities(&system, &state.positions, &mut state.velocities);
        Rig::start(integrator, (system, state), Box::new(forces), dt, Want::ENERGY)
    }

    /// Runs the bodies for a time in so many steps; `Err` in the inner result where the method gives up.
    pub(crate) fn run(
        &self,
        bonds: &BondOptions,
        time: f64,
        steps: u32,
    ) -> Result<Result<RunSummary, StepError>, StudyError> {
        let mut rig = self.start(bonds, time / f64::from(steps))?;
        let first = rig.energy();
        let mut summary = RunSummary::default();
        let (mut squares, mut ends) = (0.0, [0.0; 2]);
        let tenth = steps.div_ceil(10);
        for n in 0..steps {
            let report = match rig.try_step() {
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
            summary.iterations += f64::from(report.iterations);
            summary.strain = summary.strain.max(strain(&rig));
        }
        let n = f64::from(steps);
        Ok(Ok(RunSummary {
            change: rig.energy() - first,
            rms: (squares / n).sqrt(),
            loss: (ends[0] - ends[1]) / f64::from(tenth),
            iterations: summary.iterations / n,
            positions: rig.state.positions,
            velocities: rig.state.velocities,
            ..summary
        }))
    }
}

/// The largest | |d|/r − 1 | over all bonds.
pub(crate) fn strain(rig: &Rig) -> f64 {
    let molecules = &rig.system.molecules;
    let strain = rig.state.positions.chunks(molecules.sites()).flat_map(|m| {
        let strain = |bond: &Bond| (bond.vector(m).length() / bond.length - 1.0).abs();
        molecules.bonds().iter().map(strain).collect::<Vec<f64>>()
    });
    strain.fold(0.0, f64::max)
}

/// The end of a run, and its means.
#[derive(Debug, Clone, Default)]
pub(crate) struct RunSummary {
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

/// The largest distance between positions and those that are known, σ.
pub(crate) fn distance(found: &[DVec3], known: &[DVec3]) -> f64 {
    let off = found.iter().zip(known).map(|(x, y)| x.distance(*y));
    off.fold(0.0, f64::max)
}
