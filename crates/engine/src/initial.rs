//! Start configurations: lattices, random points without overlaps, and Maxwell–Boltzmann velocities.

use lennard_core::random::Streams;
use lennard_core::{DVec3, Momentum, PeriodicBox, System, Topology, rigid};
use lennard_scene::Scene;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use crate::EngineError;
use crate::close_pairs::Bins;

/// Random sequential addition is dense enough to be slow beyond this many trials a particle.
const TRIALS_PER_PARTICLE: usize = 20_000;

/// The smallest distance of a random start, in units of ρ^{-1/3}: a packing fraction of
/// π/6·0.7³ = 0.18, well below the 0.38 at which random sequential addition jams.
const RANDOM_SPACING: f64 = 0.7;

/// Sites of a lattice inside a box: `basis` (fractions of a cell) repeated `cells` times along each axis.
///
/// The lattice starts at a quarter of a cell so that no site lies on the face of the box.
#[must_use]
pub fn lattice_sites(
    origin: DVec3,
    extent: DVec3,
    cells: [usize; 3],
    basis: &[[f64; 3]],
) -> Vec<DVec3> {
    let step = extent / DVec3::new(cells[0] as f64, cells[1] as f64, cells[2] as f64);
    let mut sites = Vec::with_capacity(cells.iter().product::<usize>() * basis.len());
    for ix in 0..cells[0] {
        for iy in 0..cells[1] {
            for iz in 0..cells[2] {
                let corner = DVec3::new(ix as f64, iy as f64, iz as f64);
                for b in basis {
                    sites.push(origin + (corner + DVec3::from_array(*b) + 0.25) * step);
                }
            }
        }
    }
    sites
}

/// Bonds shorter than this, σ, leave no room for a fold: the rows of a folded chain lie a bond apart.
const SHORTEST_TO_FOLD: f64 = 0.8;

/// Sites of molecules about their centres, σ.
///
/// Dumbbells, and chains of short bonds, are straight. Their axes lie along the four body diagonals in turn: the molecules
/// of an fcc cell point into four directions, as in solid nitrogen. Other chains are folded to and fro into a cube.
#[must_use]
pub fn chains_about(centers: &[DVec3], sites: usize, bond_length: f64) -> Vec<DVec3> {
    let straight = sites == 2 || bond_length < SHORTEST_TO_FOLD;
    let shapes: Vec<Vec<DVec3>> = match straight {
        true => DIAGONALS
            .iter()
            .map(|axis| (0..sites).map(|k| k as f64 * axis.normalize()).collect())
            .collect(),
        false => vec![folded(sites)],
    };
    copies_about(centers, &shapes, bond_length)
}

/// Sites of molecules of a shape (σ) about their centres: the shape as it is and turned by half a turn about x, y and z, in turn.
#[must_use]
pub fn molecules_about(centers: &[DVec3], shape: &[DVec3]) -> Vec<DVec3> {
    let turned = DIAGONALS.map(|signs| shape.iter().map(|r| *r * signs).collect());
    copies_about(centers, &turned, 1.0)
}

/// The body diagonals of a cube; as signs of the axes, the unit and half a turn about x, y and z.
const DIAGONALS: [DVec3; 4] = [
    DVec3::new(1.0, 1.0, 1.0),
    DVec3::new(1.0, -1.0, -1.0),
    DVec3::new(-1.0, 1.0, -1.0),
    DVec3::new(-1.0, -1.0, 1.0),
];

/// Shapes in turn, times `scale`, with their middles at the centres.
fn copies_about(centers: &[DVec3], shapes: &[Vec<DVec3>], scale: f64) -> Vec<DVec3> {
    let molecules = centers.iter().zip(shapes.iter().cycle());
    molecules
        .flat_map(|(center, shape)| {
            let middle = shape.iter().sum::<DVec3>() / shape.len() as f64;
            shape.iter().map(move |r| *center + scale * (*r - middle))
        })
        .collect()
}

/// A walk of unit steps over the points of a cube, row by row and layer by layer, to and fro.
fn folded(sites: usize) -> Vec<DVec3> {
    let side = (1..).find(|k| k * k * k >= sites).unwrap_or(1);
    let to_and_fro = |k: usize, turn: usize| {
        if turn.is_multiple_of(2) { k } else { side - 1 - k }
    };
    (0..sites)
        .map(|k| {
            let (row, layer) = (k / side, k / (side * side));
            let x = to_and_fro(k % side, row);
            let y = to_and_fro(row % side, layer);
            DVec3::new(x as f64, y as f64, layer as f64)
        })
        .collect()
}

/// Moves each site of a molecule to the image nearest to a site that it is bonded to. A file may have folded it into the box.
pub fn unfold_molecules(cell: &PeriodicBox, topology: &Topology, positions: &mut [DVec3]) {
    let walk: Vec<(usize, usize, usize)> = topology.walk().collect();
    for molecule in positions.chunks_mut(topology.sites()) {
        for (from, to, _) in &walk {
            let d = cell.minimum_image(molecule[*to] - molecule[*from]);
            molecule[*to] = molecule[*from] + d;
        }
    }
}

/// Random points with no two closer than 0.7·ρ^{-1/3} (at most 0.9 σ), by random sequential addition.
///
/// Returns `None` where the points cannot be placed, which does not happen at this spacing.
#[must_use]
pub fn random_points(cell: &PeriodicBox, n: usize, streams: Streams) -> Option<Vec<DVec3>> {
    let density = n as f64 / cell.volume();
    let spacing = (RANDOM_SPACING / density.cbrt()).min(0.9);
    let mut rng = streams.sequential("random-positions");
    let mut bins = Bins::new(cell, spacing);
    let mut points = Vec::with_capacity(n);
    for _ in 0..n {
        let point = (0..TRIALS_PER_PARTICLE).find_map(|_| {
            let r = cell.lengths() * DVec3::new(rng.random(), rng.random(), rng.random());
            bins.nearest(&points, r, |_| Some(1.0)).is_none_or(|(_, d)| d >= spacing).then_some(r)
        })?;
        bins.insert(points.len() as u32, point);
        points.push(point);
    }
    Some(points)
}

/// The error that points do not fit at random, by the key that makes them so dense.
pub(crate) fn too_dense(scene: &Scene, key: &str) -> EngineError {
    let found = "points that do not fit at random";
    scene.source.invalid(key, found, "a lower density").into()
}

/// Velocities from the Maxwell–Boltzmann distribution at some positions, without a part along rigid bonds.
///
/// They have zero total momentum (more than one particle) and are scaled to 2K/n_dof = `temperature` exactly.
#[must_use]
pub fn thermal_velocities(
    system: &System,
    positions: &[DVec3],
    temperature: f64,
    streams: Streams,
) -> Vec<DVec3> {
    let mut rng = streams.sequential("velocities");
    let mut velocities: Vec<DVec3> = (0..positions.len())
        .map(|i| {
            let width = (temperature / system.masses.of(i)).sqrt();
            width
                * DVec3::new(
                    StandardNormal.sample(&mut rng),
                    StandardNormal.sample(&mut rng),
                    StandardNormal.sample(&mut rng),
                )
        })
        .collect();
    make_suit(system, positions, &mut velocities);
    scale_to_temperature(system, &mut velocities, temperature);
    velocities
}

/// Takes off velocities what the motion does not have: their part along rigid bonds, and the drift of all particles.
pub fn make_suit(system: &System, positions: &[DVec3], velocities: &mut [DVec3]) {
    rigid::project_velocities(system, positions, velocities);
    remove_drift(system, velocities);
}

/// Takes the velocity of the centre of mass off every particle, along axes where the forces keep the momentum.
/// A single particle keeps its velocity.
pub fn remove_drift(system: &System, velocities: &mut [DVec3]) {
    if velocities.len() > 1 {
        let mass: f64 = (0..velocities.len()).map(|i| system.masses.of(i)).sum();
        let drift = system.kept_part(system.momentum(velocities) / mass);
        for v in velocities {
            *v -= drift;
        }
    }
}

/// A drift of all particles together, which a run takes off the velocities that it starts with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Momentum that the forces keep, over the number of particles, m σ/τ.
    pub momentum_per_particle: DVec3,
    /// Temperature with the drift, ε/k_B.
    pub temperature_with: f64,
    /// Temperature without it, ε/k_B.
    pub temperature_without: f64,
}

impl Drift {
    /// The drift of velocities; `None` where there is none but rounding.
    #[must_use]
    pub fn of(system: &System, velocities: &[DVec3]) -> Option<Self> {
        /// Of the mean square velocity: files hold nine digits and more.
        const ROUNDING: f64 = 1e-12;
        let n = velocities.len() as f64;
        let momentum = system.kept_part(system.momentum(velocities)) / n;
        let square = velocities.iter().map(|v| v.length_squared()).sum::<f64>() / n;
        if velocities.len() < 2 || momentum.length_squared() <= ROUNDING * square {
            return None;
        }
        let mut without = velocities.to_vec();
        remove_drift(system, &mut without);
        Some(Self {
            momentum_per_particle: momentum,
            temperature_with: system.temperature(velocities, Momentum::Conserved),
            temperature_without: system.temperature(&without, Momentum::Conserved),
        })
    }

    /// What happens to the velocities of a file, as a remark.
    #[must_use]
    pub fn in_words(&self, file: &str) -> String {
        let [x, y, z] = self.momentum_per_particle.to_array();
        format!(
            "the velocities of {file} had a total momentum of ({x:.6}, {y:.6}, {z:.6}) per particle: removed, T changed \
             from {:.6} to {:.6}",
            self.temperature_with, self.temperature_without
        )
    }
}

/// Scales velocities so that 2K/n_dof = `temperature`; velocities that are all zero stay so.
pub fn scale_to_temperature(system: &System, velocities: &mut [DVec3], temperature: f64) {
    let now = system.temperature(velocities, Momentum::Conserved);
    if now > 0.0 {
        let factor = (temperature / now).sqrt();
        for v in velocities {
            *v *= factor;
        }
    }
}

#[cfg(test)]
mod tests {
    use lennard_core::Exclusions;

    use super::*;
    use crate::close_pairs::{Sizes, closest_pair};

    #[test]
    fn an_fcc_crystal_has_twelve_nearest_neighbors_at_the_right_distance() {
        let cell = PeriodicBox::cubic_for_density(256, 0.8442).unwrap();
        let fcc = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
        let sites = lattice_sites(DVec3::ZERO, cell.lengths(), [4; 3], &fcc);
        assert_eq!(sites.len(), 256);
        let nearest = cell.lengths().x / 4.0 / 2.0_f64.sqrt();
        for (i, a) in sites.iter().enumerate() {
            let shell = sites.iter().enumerate().filter(|(j, b)| {
                *j != i && (cell.minimum_image(*a - **b).length() - nearest).abs() < 1e-12
            });
            assert_eq!(shell.count(), 12);
        }
    }

    #[test]
    fn chains_of_any_number_of_sites_have_bonds_of_one_length_and_no_overlap() {
        for sites in 2..=64 {
            for bond_length in [0.5, 1.0] {
                let chain = chains_about(&[DVec3::splat(3.0)], sites, bond_length);
                assert_eq!(chain.len(), sites);
                for pair in chain.windows(2) {
                    assert!(((pair[1] - pair[0]).length() - bond_length).abs() < 1e-12);
                }
                for (i, a) in chain.iter().enumerate() {
                    for b in &chain[..i] {
                        assert!((*a - *b).length() > 0.99 * bond_length, "{sites}");
                    }
                }
            }
        }
    }

    #[test]
    fn velocities_have_the_temperature_and_no_momentum() {
        let system = System::atoms(500);
        let v = thermal_velocities(&system, &[DVec3::ZERO; 500], 0.722, Streams::new(1));
        assert!((system.temperature(&v, Momentum::Conserved) - 0.722).abs() < 1e-14);
        assert!(system.momentum(&v).length() < 1e-12);
    }

    #[test]
    fn random_points_keep_their_distance_even_in_the_dense_liquid() {
        let cell = PeriodicBox::cubic_for_density(400, 0.8442).unwrap();
        let points = random_points(&cell, 400, Streams::new(5)).unwrap();
        let spacing = RANDOM_SPACING / 0.8442_f64.cbrt();
        let closest = closest_pair(&cell, &points, &Exclusions::NONE, &Sizes::ONE, 1.5).unwrap();
        assert!(closest.distance >= spacing, "{closest:?}");
        // The O(N²) answer agrees.
        let mut brute = f64::INFINITY;
        for i in 0..400 {
            for j in 0..i {
                brute = brute.min(cell.minimum_image(points[i] - points[j]).length());
            }
        }
        assert_eq!(brute, closest.distance);
    }
}
