//! Few bodies of shipped scenes, with bonds held in any way: what the chapters of the study run.

use lennard_core::{Bond, DVec3, PeriodicBox, Species, SpeciesTable, StepError, Want};
use lennard_engine::bare;
use lennard_integrators::BondOptions;
use lennard_integrators::bonds::{relaxation, spook, spring};
use lennard_scene::Scene;

use crate::StudyError;
use crate::lab::{Rig, Start};

/// Side of the box, σ: bodies that act on each other are far nearer.
const SIDE: f64 = 64.0;
/// Length of the bonds of [`Bodies::two_dumbbells`], σ.
pub(super) const OF_TWO: f64 = 0.67;

/// A shipped scene with overrides.
pub(super) fn shipped(name: &str, overrides: &[(&str, String)]) -> Result<Scene, StudyError> {
    let path = format!("shipped:/{name}.toml");
    let overrides = overrides.iter().map(|(key, value)| ((*key).to_owned(), value.clone()));
    Ok(Scene::load(path.as_ref(), &overrides.collect::<Vec<_>>())?)
}

/// Bodies in a cubic box.
pub(super) fn in_a_box(side: f64, x: &[DVec3], v: &[DVec3]) -> Result<Start, StudyError> {
    Ok(Start {
        cell: PeriodicBox::new(DVec3::splat(side))?,
        positions: x.to_vec(),
        velocities: v.to_vec(),
        species: SpeciesTable::one(Species::unnamed(), x.len()),
    })
}

/// What starts there, under the forces, the bonds and the method of a scene, at constant energy.
pub(super) fn rig(scene: &Scene, start: &Start, dt: f64) -> Result<Rig, StudyError> {
    let simulation = start.simulation(bare(scene))?;
    let method = simulation.stage_run_for(0).integrator;
    let at = (simulation.system, simulation.state);
    Rig::start(method, at, simulation.forces, dt, Want::ENERGY)
}

/// Bodies of a scene, where they start and how fast.
#[derive(Debug, Clone)]
pub(super) struct Bodies {
    pub(super) scene: Scene,
    pub(super) x: Vec<DVec3>,
    pub(super) v: Vec<DVec3>,
}

impl Bodies {
    /// The shipped chain with beads at these places: in gravity, and its first bead is held.
    fn chain(length: f64, x: Vec<DVec3>, v: Vec<DVec3>) -> Result<Self, StudyError> {
        let list = |all: &[DVec3]| {
            let each: Vec<[f64; 3]> = all.iter().map(DVec3::to_array).collect();
            format!("{each:?}")
        };
        let overrides = [
            ("molecule.sites", x.len().to_string()),
            ("molecule.bond_length", format!("{length:?}")),
            ("start.positions", list(&x)),
            ("start.velocities", list(&v)),
        ];
        Ok(Self { scene: shipped("mechanics/chain", &overrides)?, x, v })
    }

    /// The same without gravity, and no bead is held.
    fn in_free_space(mut self) -> Self {
        self.scene.system.held.clear();
        self.scene.acceleration = DVec3::ZERO;
        self
    }

    /// A chain of unit masses at rest along x in gravity, whose first bead is held at the origin.
    pub(super) fn hanging(beads: usize, length: f64) -> Result<Self, StudyError> {
        let along = |k: usize| DVec3::new(length * k as f64, 0.0, 0.0);
        let still = vec![DVec3::ZERO; beads + 1];
        Self::chain(length, (0..=beads).map(along).collect(), still)
    }

    /// One dumbbell of length 1 that turns about its centre with the angular velocity Ω.
    pub(super) fn rotor(omega: f64) -> Result<Self, StudyError> {
        let half = DVec3::new(0.5, 0.0, 0.0);
        let speed = DVec3::new(0.0, 0.5 * omega, 0.0);
        Ok(Self::chain(1.0, vec![-half, half], vec![-speed, speed])?.in_free_space())
    }

    /// Two dumbbells that meet, with the full Lennard-Jones potential between their sites.
    pub(super) fn two_dumbbells() -> Result<Self, StudyError> {
        const HALF: f64 = 0.5 * OF_TWO;
        let every_pair = [("kernel.kernel", "reference".to_owned())];
        let mut scene = shipped("dumbbell/liquid", &every_pair)?;
        // Farther than they ever are from each other.
        scene.truncation.r_cut = 30.0;
        let speed = |v: f64| DVec3::new(v, 0.0, 0.0);
        let x = vec![
            DVec3::new(-1.5, 0.1, -HALF),
            DVec3::new(-1.5, 0.1, HALF),
            DVec3::new(1.5, -0.1 - HALF, 0.0),
            DVec3::new(1.5, -0.1 + HALF, 0.0),
        ];
        Ok(Self { scene, x, v: vec![speed(1.0), speed(1.0), speed(-1.0), speed(-1.0)] })
    }

    /// A chain of `bonds` bonds of length 1 in free space, every second one turned by an angle, every site moving
    /// apart a little.
    pub(super) fn stretching(bonds: usize, angle: f64) -> Result<Self, StudyError> {
        let mut x = vec![DVec3::ZERO];
        for c in 0..bonds {
            let turned = angle * (c % 2) as f64;
            x.push(x[c] + DVec3::new(turned.cos(), turned.sin(), 0.0));
        }
        Ok(Self::chain(1.0, x.clone(), x)?.in_free_space())
    }

    /// Starts the bodies with bonds that are held in a way; velocities lose their part along rigid bonds.
    pub(super) fn start(&self, bonds: &BondOptions, dt: f64) -> Result<Rig, StudyError> {
        let mut scene = self.scene.clone();
        if let Some(molecule) = &mut scene.molecule {
            molecule.bonds = bonds.clone();
        }
        rig(&scene, &in_a_box(SIDE, &self.x, &self.v)?, dt)
    }

    /// Runs the bodies for a time in so many steps; `Err` in the inner result where the method gives up.
    pub(super) fn run(
        &self,
        bonds: &BondOptions,
        time: f64,
        steps: u32,
    ) -> Result<Result<RunSummary, StepError>, StudyError> {
        let mut rig = self.start(bonds, time / f64::from(steps))?;
        let first = rig.energy();
        let mut summary = RunSummary::default();
        let mut squares = 0.0;
        for _ in 0..steps {
            let report = match rig.try_step() {
                Ok(report) => report,
                Err(e) => return Ok(Err(e)),
            };
            squares += (rig.energy() - first).powi(2);
            summary.iterations += f64::from(report.iterations);
            summary.strain = summary.strain.max(strain(&rig));
        }
        let n = f64::from(steps);
        Ok(Ok(RunSummary {
            change: rig.energy() - first,
            rms: (squares / n).sqrt(),
            iterations: summary.iterations / n,
            positions: rig.state.positions,
            velocities: rig.state.velocities,
            ..summary
        }))
    }
}

/// The largest | |d|/r − 1 | over all bonds.
pub(super) fn strain(rig: &Rig) -> f64 {
    let molecules = &rig.system.molecules;
    let strain = rig.state.positions.chunks(molecules.sites()).flat_map(|m| {
        let strain = move |bond: &Bond| (bond.vector(m).length() / bond.length - 1.0).abs();
        molecules.bonds().iter().map(strain)
    });
    strain.fold(0.0, f64::max)
}

/// The end of a run, and its means.
#[derive(Debug, Clone, Default)]
pub(super) struct RunSummary {
    pub(super) positions: Vec<DVec3>,
    pub(super) velocities: Vec<DVec3>,
    /// Energy at the end less energy at the start, ε.
    pub(super) change: f64,
    /// Root mean square of E − E(0), ε.
    pub(super) rms: f64,
    /// Largest | |d|/r − 1 |.
    pub(super) strain: f64,
    /// Iterations or sweeps per step.
    pub(super) iterations: f64,
}

/// The largest distance between positions and those that are known, σ.
pub(super) fn distance(found: &[DVec3], known: &[DVec3]) -> f64 {
    let off = found.iter().zip(known).map(|(x, y)| x.distance(*y));
    off.fold(0.0, f64::max)
}

/// A way to hold bonds.
#[derive(Debug, Clone)]
pub(crate) struct Way {
    /// Name in legends.
    pub(crate) name: String,
    pub(crate) bonds: BondOptions,
}

/// Springs by the implicit midpoint rule: name and stiffness, ε/σ².
pub(crate) const MIDPOINT: [(&str, f64); 3] =
    [("midpoint, k = 1000", 1e3), ("midpoint, k = 16000", 1.6e4), ("midpoint, k = 64000", 6.4e4)];

/// Relaxation until a tolerance, along the old bond.
pub(crate) fn relaxed(tolerance: f64) -> BondOptions {
    BondOptions::Relaxation(relaxation::Options {
        tolerance: Some(tolerance),
        ..Default::default()
    })
}

/// Projection along the new bond, which dissipates.
pub(crate) fn projected() -> BondOptions {
    BondOptions::Relaxation(relaxation::Options {
        tolerance: Some(1e-13),
        direction: relaxation::Direction::New,
        ..Default::default()
    })
}

/// SPOOK with a damping time of so many steps and no compliance.
pub(crate) fn damped(steps: f64) -> BondOptions {
    BondOptions::Spook(spook::Options { damping_steps: steps, ..Default::default() })
}

/// Springs of a stiffness, ε/σ².
pub(crate) fn springs(stiffness: f64) -> BondOptions {
    springs_by(spring::Scheme::Explicit, stiffness)
}

/// Springs of a stiffness in ε/σ² by a scheme.
fn springs_by(scheme: spring::Scheme, stiffness: f64) -> BondOptions {
    BondOptions::Spring(spring::Options { stiffness, scheme, ..Default::default() })
}

/// Every way: the methods of the list with their default options, and variants.
pub(crate) fn ways() -> Vec<Way> {
    let of_the_list =
        BondOptions::all().into_iter().map(|bonds| Way { name: bonds.name().to_owned(), bonds });
    let variant = |name: &str, bonds| Way { name: name.to_owned(), bonds };
    of_the_list
        .chain([
            variant("relaxation, 10⁻³", relaxed(1e-3)),
            variant("relaxation, 10⁻⁵", relaxed(1e-5)),
            variant("relaxation, new direction", projected()),
            variant("spook, τ = h/2", damped(0.5)),
            variant("spook, τ = 4h", damped(4.0)),
            variant("spring, k = 1000", springs(1e3)),
            variant("spring, k = 64000", springs(6.4e4)),
        ])
        .chain(MIDPOINT.map(|(name, k)| variant(name, springs_by(spring::Scheme::Midpoint, k))))
        .collect()
}
