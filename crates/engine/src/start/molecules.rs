//! Molecules before the first step: on a lattice, or as a file has them, with all that a molecule must be.

use lennard_core::options::upper_bound;
use lennard_core::{Bond, DVec3, PeriodicBox, Topology};
use lennard_scene::{MoleculeKind, Scene};

use super::value::{Origin, Start};
use crate::EngineError;

/// The sites of molecules whose centres stand on a lattice; the centres themselves where the scene has atoms.
pub(super) fn about(scene: &Scene, centers: Vec<DVec3>) -> Vec<DVec3> {
    let Some(molecule) = &scene.molecule else {
        return centers;
    };
    let topology = &molecule.topology;
    match (molecule.options.kind, molecule.shape()) {
        (MoleculeKind::Sites, Some(shape)) => of_shape(&centers, &shape),
        _ => chains(&centers, topology.sites(), topology.bonds()[0].length),
    }
}

/// Bonds shorter than this, σ, leave no room for a fold: the rows of a folded chain lie a bond apart.
const SHORTEST_TO_FOLD: f64 = 0.8;

/// Sites of molecules about their centres, σ.
///
/// Dumbbells, and chains of short bonds, are straight. Their axes lie along the four body diagonals in turn: the molecules
/// of an fcc cell point into four directions, as in solid nitrogen. Other chains are folded to and fro into a cube.
fn chains(centers: &[DVec3], sites: usize, bond_length: f64) -> Vec<DVec3> {
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
fn of_shape(centers: &[DVec3], shape: &[DVec3]) -> Vec<DVec3> {
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
pub(super) fn unfold(cell: &PeriodicBox, topology: &Topology, positions: &mut [DVec3]) {
    let walk: Vec<(usize, usize, usize)> = topology.walk().collect();
    for molecule in positions.chunks_mut(topology.sites()) {
        for (from, to, _) in &walk {
            let d = cell.minimum_image(molecule[*to] - molecule[*from]);
            molecule[*to] = molecule[*from] + d;
        }
    }
}

/// Checks the bonds of each molecule: they have the right length, and none follows from others.
///
/// # Errors
/// [`EngineError`] for the first molecule that is none.
pub(super) fn check(scene: &Scene, origin: &Origin, start: &Start) -> Result<(), EngineError> {
    let molecules = scene.molecules();
    let Some(topology) = molecules.topology() else {
        return Ok(());
    };
    let sites = topology.sites();
    let refuse = |found: String, allowed: String| -> EngineError {
        scene.invalid(origin.key, found, allowed).into()
    };
    for (m, positions) in start.positions.chunks(sites).enumerate() {
        let fault = match molecules.are_rigid() {
            true => wrong_length(topology, positions),
            false => through_the_box(&start.cell, topology, positions),
        };
        if let Some((bond, allowed)) = fault {
            let length = bond.vector(positions).length();
            let [i, j] = bond.sites.map(|site| m * sites + site + 1);
            let found = format!(
                "a bond of {length:.6} σ between particles {i} and {j} of {} (counted from 1)",
                origin.name
            );
            return Err(refuse(found, allowed));
        }
        if molecules.are_rigid()
            && let Some(bond) = topology
                .redundant_bond(positions, |site| scene.system.held.contains(&(m * sites + site)))
        {
            let found = format!("molecule {} of {}", m + 1, origin.name);
            return Err(scene.redundant(bond, &found).into());
        }
    }
    Ok(())
}

/// Bonds of a file may be off by this share: the first step brings them to their length.
const LARGEST_STRAIN: f64 = 1e-3;

/// The first bond of a molecule that is off by more, and what is allowed.
fn wrong_length<'a>(topology: &'a Topology, positions: &[DVec3]) -> Option<(&'a Bond, String)> {
    let is_off = |bond: &&Bond| {
        let length = bond.vector(positions).length();
        (length / bond.length - 1.0).abs() > LARGEST_STRAIN
    };
    let bond = topology.bonds().iter().find(is_off)?;
    let key = match topology.bonds().iter().all(|b| b.length == bond.length) {
        true => "molecule.bond_length = ",
        false => "the length in the scene, ",
    };
    Some((bond, format!("{key}{} σ, within 0.1 %", bond.length)))
}

/// The first bond of a molecule that is longer than half the shortest side of the box, and what is allowed.
fn through_the_box<'a>(
    cell: &PeriodicBox,
    topology: &'a Topology,
    positions: &[DVec3],
) -> Option<(&'a Bond, String)> {
    let half = 0.5 * cell.lengths().min_element();
    let is_long = |bond: &&Bond| bond.vector(positions).length() > half;
    let bond = topology.bonds().iter().find(is_long)?;
    let allowed =
        format!("bonds of at most half the shortest side of the box, {} σ", upper_bound(half));
    Some((bond, allowed))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_of_any_number_of_sites_have_bonds_of_one_length_and_no_overlap() {
        for sites in 2..=64 {
            for bond_length in [0.5, 1.0] {
                let chain = chains(&[DVec3::splat(3.0)], sites, bond_length);
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
}
