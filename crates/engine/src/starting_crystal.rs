//! A start with a crystal and its liquid side by side across z.

use lennard_core::random::Streams;
use lennard_core::{DVec3, PeriodicBox};
use lennard_scene::{HalfCrystal, Lattice, Placement, Scene};

use crate::{EngineError, initial};

/// How far the liquid keeps from the ends of the crystal at the start, in edges of a cell, both ends together.
const GAP: f64 = 0.25;

/// Sites of the crystal, and random places of the liquid beside it. The particles of the liquid must be relaxed.
pub(crate) fn positions(
    scene: &Scene,
    start: &HalfCrystal,
    placement: &Placement,
) -> Result<Vec<DVec3>, EngineError> {
    let cells = placement.cells.expect("a lattice has cells");
    let basis = Lattice::Fcc.basis();
    let mut positions = initial::lattice_sites(placement.corner, placement.filled, cells, basis);
    let n_liquid = start.n_atoms - positions.len();
    let edge = placement.filled.z / cells[2] as f64;
    let gap = GAP * edge;
    let sides = placement.cell.lengths();
    let room = DVec3::new(sides.x, sides.y, sides.z - placement.filled.z - gap);
    let streams = Streams::new(scene.system.seed);
    let points = PeriodicBox::new(room)
        .ok()
        .and_then(|part| initial::random_points(&part, n_liquid, streams))
        .ok_or_else(|| initial::too_dense(scene, "start.liquid_density"))?;
    // The lattice begins a quarter of a plane distance above zero: the gap lies half on each side.
    let first = DVec3::new(0.0, 0.0, placement.filled.z + 0.5 * gap);
    let wrapped = points.into_iter().map(|r| placement.cell.wrap(r + first));
    positions.extend(wrapped);
    Ok(positions)
}
