//! A start with a slab of liquid between two parts of vapor.

use lennard_core::random::Streams;
use lennard_core::{DVec3, PeriodicBox};
use lennard_scene::{Lattice, Placement, Scene, Slab};
use rand::seq::SliceRandom;

use crate::{EngineError, initial};

/// How far vapor keeps from the liquid at the start, σ.
const GAP: f64 = Slab::LEAST_VAPOR / 4.0;
/// How many cells more or less along an axis are looked at.
const SPARE: usize = 3;

/// Places of liquid on an fcc lattice that has a few sites left empty, and of vapor at random beside it.
///
/// The lattice melts, since a crystal is denser. Sites to be left empty are drawn from the seed.
pub(crate) fn positions(
    scene: &Scene,
    slab: &Slab,
    placement: &Placement,
) -> Result<Vec<DVec3>, EngineError> {
    let n_vapor = slab.n_vapor();
    let streams = Streams::new(scene.system.seed);
    let mut positions = liquid(placement, slab.n_atoms - n_vapor, streams);
    positions.extend(vapor(scene, slab, placement, n_vapor, streams)?);
    Ok(positions)
}

fn liquid(placement: &Placement, n: usize, streams: Streams) -> Vec<DVec3> {
    let lattice = Lattice::Fcc;
    let cells = cells_for(n, placement.filled, lattice.basis().len());
    let mut sites =
        initial::lattice_sites(placement.corner, placement.filled, cells, lattice.basis());
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

/// Points at random in the part of the box beside the liquid, folded into the box.
fn vapor(
    scene: &Scene,
    slab: &Slab,
    placement: &Placement,
    n: usize,
    streams: Streams,
) -> Result<Vec<DVec3>, EngineError> {
    let sides = placement.cell.lengths();
    let room = DVec3::new(sides.x, sides.y, slab.length - slab.thickness - 2.0 * GAP);
    let points = PeriodicBox::new(room)
        .ok()
        .and_then(|part| initial::random_points(&part, n, streams))
        .ok_or_else(|| initial::too_dense(scene, "start.vapor_density"))?;
    let first = DVec3::new(0.0, 0.0, placement.corner.z + slab.thickness + GAP);
    Ok(points.into_iter().map(|r| placement.cell.wrap(r + first)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

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
