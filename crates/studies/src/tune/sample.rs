//! The fluid in which settings are judged. It is the scene's own, or one of the same density and temperature with
//! the size at which a minute teaches most.

use lennard_engine::watchdog::{FastestPair, fastest_pair};
use lennard_forcefield::{Kernel, NeighborOptions, Precision, TruncationKind, TruncationOptions};
use lennard_integrators::velocity_verlet;
use lennard_scene::{Arrangement, Geometry, Lattice, MoleculeKind, Scene, Stage};

use super::pairs::Fluid;
use crate::StudyError;
use crate::lab::{self, Start, under_bussi};
use crate::settings::Settings;

/// Fluids of this many particles are judged as they are. In a smaller fluid, half the box is too short to see what a
/// cutoff leaves out. A larger fluid is sampled no better in a minute, since errors of means depend on the number of
/// particles times the time.
const AS_THEY_ARE: std::ops::RangeInclusive<usize> = 500..=2048;
/// Particles of the fluid that stands for a scene of another size, 4·m³: the first whose box holds the cutoff.
const STAND_INS: [usize; 3] = [864, 1372, 2048];
/// Molecules of the same: the first with so many sites as the least of [`AS_THEY_ARE`].
const MOLECULES: [usize; 7] = [32, 108, 256, 500, 864, 1372, 2048];
/// Correlations are followed up to this distance, σ; beyond it g(r) = 1 is good to 10⁻³ in any fluid.
const LONGEST_SIGHT: f64 = 6.0;
/// Cutoff of the survey, σ: in the middle of those that are chosen among.
const SURVEY_CUTOFF: f64 = 3.0;
/// Most steps taken of each stage before the measurement.
const MOST_STEPS: u64 = 10_000;
/// Time step of survey and reference as a share of the stability limit (0.003 τ at the triple point).
const CAREFUL_STEP: f64 = 0.075;
/// Relaxation time of the survey's heat bath, τ: about that in which a liquid forgets its energy by itself.
const RELAXATION_TIME: f64 = 0.15;
/// Time in which the start settles at its temperature, τ.
const SETTLING_TIME: f64 = 8.0;
/// Steps of a stage that ends when its follower says so.
const LONGEST: u64 = 1 << 50;
/// Stability limit ω·dt of velocity Verlet.
pub(super) const VERLET_LIMIT: f64 = 2.0;

/// The fluid and where its runs start.
pub(super) struct Sample {
    /// The scene to be tuned, free settings at careful values, in its own ensemble.
    pub own: Scene,
    /// The same, in the canonical ensemble by velocity Verlet.
    pub canonical: Scene,
    /// An equilibrated start.
    pub start: Start,
    /// Temperature of the measured stage, ε/k_B.
    pub temperature: f64,
    /// How far correlations are seen, σ.
    pub sight: f64,
    /// The largest cutoff that the scene's own box allows, up to the sight, as the scene writes cutoffs: in σ or in σ_ab.
    pub largest_cutoff: f64,
    /// What it is made of.
    pub fluid: Fluid,
    /// The pair of species that bounds the step; absent where nothing repels.
    pub fastest: Option<FastestPair>,
    /// Whether a lattice can stand for the start at another size.
    pub has_a_lattice: bool,
    /// Particles of the scene itself.
    pub scene_atoms: usize,
    /// A rough stability limit of velocity Verlet, τ: of pairs that collide, and of springs.
    pub stable_dt: f64,
}

impl Sample {
    /// Equilibrates the fluid that `scene` measures.
    pub fn prepare(scene: &Scene) -> Result<Self, StudyError> {
        let beginning = lennard_engine::start(scene)?;
        let scene_atoms = beginning.positions.len();
        let sites = scene.molecules().sites();
        let density = (scene_atoms / sites) as f64 / beginning.cell.volume();
        let temperature = temperature(scene);
        let pair_at = |t: f64| fastest_pair(scene, &beginning.species, t, VERLET_LIMIT);
        let stable_at = |t: f64| lab::rough_stable_dt(scene, &beginning.species, t, VERLET_LIMIT);
        let stable_dt = stable_at(temperature);
        let hottest = scene.stages.iter().map(|s| s.temperature).fold(temperature, f64::max);

        let mut own = scene.without_accuracy();
        let full = scene.wants_full_potential();
        let unit = scene.cutoff_unit();
        let needed = match (full, &scene.mixture) {
            (true, _) => 0.0,
            (false, None) => own.truncation.r_cut,
            (false, Some(_)) => own.longest_cutoff(),
        };
        let own_half = beginning.cell.largest_cutoff();
        let mut half = own_half;
        let has_a_lattice = has_a_lattice(scene);
        if !AS_THEY_ARE.contains(&scene_atoms) && has_a_lattice {
            let side = |n: usize| (n as f64 / density).cbrt();
            let sizes: &[usize] = match sites {
                1 => &STAND_INS,
                _ => &MOLECULES,
            };
            let fitting = sizes
                .iter()
                .find(|n| 0.5 * side(**n) > needed && **n * sites >= *AS_THEY_ARE.start());
            let n_atoms = *fitting.ok_or_else(|| {
                let most = sizes[sizes.len() - 1];
                let largest = 0.5 * side(most);
                let allowed = format!(
                    "below {largest:.2} σ: the fluid is judged in a box of at most {most} particles"
                );
                scene.source.invalid("truncation.r_cut", format!("{needed} σ"), allowed)
            })?;
            half = 0.5 * side(n_atoms);
            own = own.with_shares_of(&beginning.species);
            own.system.start = lattice_of(n_atoms, density);
        }
        let sight = LONGEST_SIGHT.max(needed).min(half * (1.0 - 1e-6));
        if full {
            own.truncation = TruncationOptions {
                r_cut_in: scene.truncation.r_cut_in,
                ..TruncationOptions::new(TruncationKind::Cut, SURVEY_CUTOFF.min(sight / unit))
            };
        }
        own.kernel.precision = Precision::Double;
        own.neighbor = NeighborOptions::default();
        own.observables.clear();
        own.output.trajectory_every = None;
        own.integrator.dt = CAREFUL_STEP * stable_at(hottest);
        for stage in &mut own.stages {
            stage.dt = None;
            stage.steps = stage.steps.min(MOST_STEPS);
        }
        let mut before = own.clone();
        let mut canonical = own.clone();
        canonical.stages = vec![canonical_stage(temperature, LONGEST, true)];
        canonical.integrator.method = lennard_integrators::IntegratorOptions::VelocityVerlet(
            velocity_verlet::Options::default(),
        );
        canonical.integrator.split = None;
        canonical.kernel.kernel = Kernel::Auto;
        let careful = CAREFUL_STEP * stable_dt;
        canonical.integrator.dt = careful;
        own.integrator.dt = careful;
        before.stages.retain(|s| !s.measure);
        let settling = (SETTLING_TIME / careful).ceil() as u64;
        before.stages.push(canonical_stage(temperature, settling, false));
        let start = Start::equilibrate(&before)?;
        Ok(Self {
            fluid: Fluid::of(&own, start.system()),
            fastest: pair_at(temperature),
            has_a_lattice,
            start,
            largest_cutoff: sight.min(own_half) / unit,
            own,
            canonical,
            temperature,
            sight,
            scene_atoms,
            stable_dt,
        })
    }

    /// The longest cutoff that leaves the list its skin in this box, as the scene writes cutoffs.
    pub(crate) fn comfortable_cutoff(&self) -> f64 {
        let longest = comfortable_cutoff(self.start.cell.largest_cutoff()).min(self.sight);
        longest / self.own.cutoff_unit()
    }

    /// The stability limit of the scene's own method over the limit of velocity Verlet.
    pub(crate) fn limit(&self) -> f64 {
        self.own.integrator.method.spec().stability_limit.unwrap_or(VERLET_LIMIT) / VERLET_LIMIT
    }

    /// Settings of survey and reference except for their cutoff.
    pub(crate) fn careful(&self) -> Settings {
        Settings::of(&self.own)
    }
}

/// The longest cutoff that leaves a list its skin, for half a box side in σ. Without a skin every step builds the
/// list anew, which costs several times more than the forces.
fn comfortable_cutoff(half: f64) -> f64 {
    /// Skin that the cost model chooses for liquids, σ.
    const SKIN: f64 = 0.3;
    ((half - SKIN) * 100.0).floor() / 100.0
}

/// An fcc lattice of so many particles, or centres of molecules, that stands for the start of a scene.
pub(super) fn lattice_of(n_atoms: usize, density: f64) -> Arrangement {
    let geometry = Geometry::Density(density);
    Arrangement::Lattice { lattice: Some(Lattice::Fcc), n_atoms, geometry, vacuum: 0.0 }
}

/// Whether a lattice of any size can be filled with what a scene is made of: molecules of listed bonds need a shape.
fn has_a_lattice(scene: &Scene) -> bool {
    let molecule = scene.molecule.as_ref();
    molecule.is_none_or(|m| m.options.kind != MoleculeKind::Sites || m.shape().is_some())
}

/// The temperature at which the scene measures: the temperature of the last heat bath up to there, or of the system.
fn temperature(scene: &Scene) -> f64 {
    let measured = scene.stages.iter().rposition(|s| s.measure);
    let until = &scene.stages[..=measured.unwrap_or(scene.stages.len() - 1)];
    let bath = until.iter().rev().find(|s| s.thermostat.is_some());
    bath.map_or(scene.system.temperature, |s| s.temperature)
}

fn canonical_stage(temperature: f64, steps: u64, measure: bool) -> Stage {
    Stage { steps, measure, ..under_bussi("canonical", temperature, RELAXATION_TIME) }
}
