//! Trial particles: their energies, their places, and the search for what is near them.

use std::sync::Arc;

use lennard_core::random::{NoiseStream, Streams};
use lennard_core::{DVec3, PeriodicBox};
use rand_distr::{Distribution, StandardUniform};

use crate::cells::Cells;

/// What a trial particle needs to know of the fluid.
#[derive(Debug, Clone)]
pub struct Insertion {
    /// The temperature that the bath of the measured stages holds, ε/k_B.
    pub temperature: f64,
    /// The random streams of the scene's seed.
    pub streams: Streams,
    /// The energies between a trial particle and the fluid.
    pub energies: Arc<dyn TrialEnergies>,
}

impl PartialEq for Insertion {
    fn eq(&self, other: &Self) -> bool {
        self.temperature == other.temperature
            && self.streams == other.streams
            && Arc::ptr_eq(&self.energies, &other.energies)
    }
}

/// The energies between a trial particle and the particles of a fluid.
pub trait TrialEnergies: std::fmt::Debug + Send + Sync {
    /// The cutoff between a trial particle of species `a` and a particle of species `b`, σ.
    fn cutoff(&self, a: usize, b: usize) -> f64;

    /// Σ u_ab(r) in ε over squared distances r² in σ², all of them at most the squared cutoff.
    fn sum(&self, a: usize, b: usize, squared_distances: &[f64]) -> f64;

    /// The tail of a trial particle of species `a` times the volume, V·∂U_tail/∂N_a, ε·σ³; 0 without tail.
    fn tail(&self, a: usize) -> f64;
}

/// A core is where the energy of a pair exceeds this multiple of T and of the deepest well.
///
/// Even with twelve neighbors in their wells, the weight of an overlap is then below e⁻³⁰ of any weight that counts.
const CORE: f64 = 50.0;
/// Distances at which a pair is looked at for its core.
const CORE_STEPS: usize = 2000;

/// The places and energies of the trial particles of one species.
#[derive(Debug, Clone)]
pub(super) struct Trials {
    species: usize,
    insertion: Insertion,
    noise: NoiseStream,
    /// Squared cutoff and squared core with each species, σ².
    reach: Vec<[f64; 2]>,
}

impl Trials {
    /// Trial particles of a species in a fluid of `n_species` species.
    pub(super) fn new(species: usize, n_species: usize, insertion: &Insertion) -> Self {
        let energies = insertion.energies.as_ref();
        let core = |b| core(energies, species, b, insertion.temperature);
        Self {
            species,
            noise: insertion.streams.noise(&format!("insertion {species}")),
            reach: (0..n_species)
                .map(|b| [energies.cutoff(species, b).powi(2), core(b).powi(2)])
                .collect(),
            insertion: insertion.clone(),
        }
    }

    pub(super) fn species(&self) -> usize {
        self.species
    }

    /// The tail energy of a trial particle in a volume, ε.
    pub(super) fn tail(&self, volume: f64) -> f64 {
        self.insertion.energies.tail(self.species) / volume
    }

    /// Places in the box at a step: a lattice without preferred axes, moved as a whole by a random vector. Each place is thus
    /// uniform in the box.
    pub(super) fn places(&self, cell: &PeriodicBox, step: u64) -> impl Fn(usize) -> DVec3 + use<> {
        // The real root g of g⁴ = g + 1; successive powers of 1/g fill a cube evenly (M. Roberts, "The unreasonable
        // effectiveness of quasirandom sequences", 2018).
        const G: f64 = 1.220_744_084_605_759_6;
        let powers = DVec3::new(1.0 / G, 1.0 / (G * G), 1.0 / (G * G * G));
        let mut rng = self.noise.at(step, 0);
        let moved = DVec3::from_array(std::array::from_fn(|_| StandardUniform.sample(&mut rng)));
        let cell = *cell;
        move |k| cell.wrap((moved + powers * k as f64).fract() * cell.lengths())
    }

    /// −ΔU/T of a trial particle at a place in the box; −∞ where it overlaps another. `fluid` has the particles of each
    /// species, and `near` is scratch.
    pub(super) fn log_weight(&self, fluid: &[Cells], place: DVec3, near: &mut Vec<f64>) -> f64 {
        let mut energy = 0.0;
        for (b, (cells, [cutoff2, core2])) in fluid.iter().zip(&self.reach).enumerate() {
            near.clear();
            let mut nearest = f64::INFINITY;
            for points in cells.around(cells.home(place)) {
                points.squared_distances(place, cells.sides(), 0, |_, squared| {
                    nearest = squared.iter().copied().fold(nearest, f64::min);
                    near.extend(squared.iter().filter(|r2| *r2 <= cutoff2));
                });
                if nearest < *core2 {
                    return f64::NEG_INFINITY;
                }
            }
            energy += self.insertion.energies.sum(self.species, b, near);
        }
        -energy / self.insertion.temperature
    }
}

/// The distance within which a pair is sure to overlap, σ; 0 where it may lie at any distance.
fn core(energies: &dyn TrialEnergies, a: usize, b: usize, temperature: f64) -> f64 {
    let step = energies.cutoff(a, b) / CORE_STEPS as f64;
    let at = |k: usize| k as f64 * step;
    let values: Vec<f64> = (1..=CORE_STEPS).map(|k| energies.sum(a, b, &[at(k) * at(k)])).collect();
    let well = values.iter().fold(0.0, |well: f64, u| well.max(-u));
    let overlaps = values.iter().take_while(|u| u.is_nan() || **u > CORE * (temperature + well));
    at(overlaps.count())
}
