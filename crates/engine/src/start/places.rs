//! Places of particles that the program finds: on lattices, at random, and both side by side.

use std::ops::Range;

use lennard_core::random::Streams;
use lennard_core::{DVec3, PeriodicBox};
use lennard_scene::{HalfCrystal, Lattice, Placement, Scene, Slab};
use rand::RngExt;
use rand::seq::SliceRandom;

use super::value::streams;
use crate::EngineError;
use crate::close_pairs::Bins;

/// Random sequential addition is dense enough to be slow beyond this many trials a particle.
const TRIALS_PER_PARTICLE: usize = 20_000;

/// The smallest distance of a random start, in units of ρ^{-1/3}: a packing fraction of
/// π/6·0.7³ = 0.18, well below the 0.38 at which random sequential addition jams.
const RANDOM_SPACING: f64 = 0.7;

/// How far vapor keeps from the liquid at the start, σ.
const VAPOR_GAP: f64 = Slab::LEAST_VAPOR / 4.0;
/// How far the liquid keeps from the ends of the crystal at the start, in edges of a cell, both ends together.
const CRYSTAL_GAP: f64 = 0.25;
/// How many cells more or less along an axis are looked at.
const SPARE: usize = 3;

/// Sites of a lattice in the filled part: `basis` (fractions of a cell) repeated along each axis. The sites have some numbers, or all.
///
/// # Panics
/// Where the placement has no cells.
pub(super) fn on_lattice(
    placement: &Placement,
    basis: &[[f64; 3]],
    numbers: Option<Range<usize>>,
) -> Vec<DVec3> {
    let cells = placement.cells.expect("a lattice has cells");
    lattice_sites(placement.corner, placement.filled, cells, basis, numbers)
}

/// The lattice starts at a quarter of a cell so that no site lies on the face of the box.
fn lattice_sites(
    origin: DVec3,
    extent: DVec3,
    cells: [usize; 3],
    basis: &[[f64; 3]],
    numbers: Option<Range<usize>>,
) -> Vec<DVec3> {
    let step = extent / DVec3::from_array(cells.map(|count| count as f64));
    let site = |number: usize| {
        let (cell, b) = (number / basis.len(), DVec3::from_array(basis[number % basis.len()]));
        let place = [cell / cells[2] / cells[1], cell / cells[2] % cells[1], cell % cells[2]];
        let corner = DVec3::from_array(place.map(|count| count as f64));
        origin + (corner + b + 0.25) * step
    };
    let all = 0..cells.iter().product::<usize>() * basis.len();
    numbers.unwrap_or(all).map(site).collect()
}

/// Places at random in a part of the box, which its lower corner and its sides give. The `key` makes them so dense where they do not fit.
pub(super) fn at_random(
    scene: &Scene,
    cell: &PeriodicBox,
    (corner, sides): (DVec3, DVec3),
    n: usize,
    key: &str,
) -> Result<Vec<DVec3>, EngineError> {
    let part = PeriodicBox::new(sides).ok();
    let points =
        part.and_then(|part| random_points(&part, n, streams(scene))).ok_or_else(|| {
            let found = "points that do not fit at random";
            scene.invalid(key, found, "a lower density")
        })?;
    Ok(points.into_iter().map(|r| cell.wrap(r + corner)).collect())
}

/// Random points with no two closer than 0.7·ρ^{-1/3} (at most 0.9 σ), by random sequential addition.
///
/// Returns `None` where the points cannot be placed, which does not happen at this spacing.
fn random_points(cell: &PeriodicBox, n: usize, streams: Streams) -> Option<Vec<DVec3>> {
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

/// Places of liquid on an fcc lattice that has a few sites left empty, and of vapor at random beside it.
///
/// The lattice melts, since a crystal is denser. Sites to be left empty are drawn from the seed.
pub(super) fn slab(
    scene: &Scene,
    slab: &Slab,
    placement: &Placement,
) -> Result<Vec<DVec3>, EngineError> {
    let n_vapor = slab.n_vapor();
    let mut positions = liquid(placement, slab.n_atoms - n_vapor, streams(scene));
    let Placement { cell, corner, filled, .. } = placement;
    let room = DVec3::new(filled.x, filled.y, slab.length - slab.thickness - 2.0 * VAPOR_GAP);
    let first = DVec3::new(0.0, 0.0, corner.z + slab.thickness + VAPOR_GAP);
    positions.extend(at_random(scene, cell, (first, room), n_vapor, "start.vapor_density")?);
    Ok(positions)
}

fn liquid(placement: &Placement, n: usize, streams: Streams) -> Vec<DVec3> {
    let basis = Lattice::Fcc.basis();
    let cells = cells_for(n, placement.filled, basis.len());
    let mut sites = lattice_sites(placement.corner, placement.filled, cells, basis, None);
    let empty = sites.len() - n;
    let mut order: Vec<usize> = (0..sites.len()).collect();
    order.shuffle(&mut streams.sequential("slab-empty-sites"));
    order.truncate(empty);
    order.sort_unstable();
    for site in order.into_iter().rev() {
        sites.remove(site);
    }
    sites
}

/// Cells along each axis with room for `n` particles: nearly cubic, and few sites too many.
///
/// Neither an empty site nor a stretched cell matters much. The sum of the squares of both is kept small.
fn cells_for(n: usize, sides: DVec3, per_cell: usize) -> [usize; 3] {
    let edge = (sides.element_product() * per_cell as f64 / n.max(1) as f64).cbrt();
    let ideal = (sides / edge).to_array();
    let around = |ideal: f64| {
        let middle = ideal.round() as usize;
        middle.saturating_sub(SPARE).max(1)..=middle + SPARE
    };
    let mut best = (f64::INFINITY, [0; 3]);
    for across in around(ideal[0]) {
        for along in around(ideal[2]) {
            let sites = per_cell * across * across * along;
            if sites < n {
                continue;
            }
            let empty = 1.0 - n as f64 / sites as f64;
            let edges = [sides.x / across as f64, sides.z / along as f64];
            let stretch = (edges[0] / edges[1]).ln();
            let cost = empty * empty + stretch * stretch;
            if cost < best.0 {
                best = (cost, [across, across, along]);
            }
        }
    }
    best.1
}

/// Sites of the crystal, and random places of the liquid beside it. The particles of the liquid must be relaxed.
pub(super) fn half_crystal(
    scene: &Scene,
    start: &HalfCrystal,
    placement: &Placement,
) -> Result<Vec<DVec3>, EngineError> {
    let mut positions = on_lattice(placement, Lattice::Fcc.basis(), None);
    let n_liquid = start.n_atoms - positions.len();
    let Placement { cell, filled, .. } = placement;
    let gap = CRYSTAL_GAP * filled.z / start.layers as f64;
    let room = DVec3::new(filled.x, filled.y, cell.lengths().z - filled.z - gap);
    // The lattice begins a quarter of a plane distance above zero: the gap lies half on each side.
    let first = DVec3::new(0.0, 0.0, filled.z + 0.5 * gap);
    positions.extend(at_random(scene, cell, (first, room), n_liquid, "start.liquid_density")?);
    Ok(positions)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::close_pairs::closest;

    #[test]
    fn random_points_keep_their_distance_even_in_the_dense_liquid() {
        let cell = PeriodicBox::cubic_for_density(400, 0.8442).unwrap();
        let points = random_points(&cell, 400, Streams::new(5)).unwrap();
        let spacing = RANDOM_SPACING / 0.8442_f64.cbrt();
        let closest = closest(&cell, &points, |_, _| Some(1.0), 1.0, 1.5).unwrap();
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

    #[test]
    fn any_number_of_particles_finds_a_nearly_cubic_lattice_with_few_empty_sites() {
        for n in [200, 431, 860, 1000, 1372, 1999, 4001] {
            for density in [0.5, 0.65, 0.82] {
                let side = (n as f64 / (1.5 * density)).cbrt();
                let sides = DVec3::new(side, side, 1.5 * side);
                let [a, b, c] = cells_for(n, sides, 4);
                let sites = 4 * a * b * c;
                assert!(a == b && sites >= n, "{n}: {sites}");
                // A few per cent, more where a layer is a large part of a small slab.
                let most = if n < 500 { 0.16 } else { 0.14 };
                assert!(1.0 - n as f64 / sites as f64 <= most, "{n}: {sites}");
                let stretch = (sides.x / a as f64) / (sides.z / c as f64);
                // Two cells beside three are as near as so few particles allow.
                let range = if n < 300 { 0.74..1.35 } else { 0.8..1.25 };
                assert!(range.contains(&stretch), "{n}: {stretch}");
            }
        }
    }
}
