//! Molecules before the first step: on a lattice, or as a file has them, with all that a molecule must be.

use std::path::Path;

use lennard_core::{Bond, DVec3, PeriodicBox, Topology};
use lennard_io::StartConfiguration;
use lennard_scene::{MoleculeKind, Scene};

use crate::EngineError;
use crate::close_pairs::{Sizes, closest_pair};
use crate::initial;

/// The sites of molecules whose centres stand on a lattice; the centres themselves where the scene has atoms.
///
/// # Errors
/// [`EngineError`] where sites of different molecules overlap.
pub fn on_a_lattice(
    scene: &Scene,
    cell: &PeriodicBox,
    centers: Vec<DVec3>,
) -> Result<Vec<DVec3>, EngineError> {
    let Some(molecule) = &scene.molecule else {
        return Ok(centers);
    };
    let topology = &molecule.topology;
    let positions = match (molecule.options.kind, molecule.shape()) {
        (MoleculeKind::Sites, Some(shape)) => initial::molecules_about(&centers, &shape),
        _ => initial::chains_about(&centers, topology.sites(), topology.bonds()[0].length),
    };
    /// U(0.8 σ) is 43 ε: nearer sites of a lattice would heat the fluid beyond use.
    const SMALLEST_ON_A_LATTICE: f64 = 0.8;
    let within = SMALLEST_ON_A_LATTICE;
    let exclusions = molecule.molecules().exclusions();
    match closest_pair(cell, &positions, &exclusions, &Sizes::ONE, within) {
        None => Ok(positions),
        Some(pair) => Err(scene
            .source
            .invalid(
                molecule.key_of_size(),
                format!(
                    "sites {} and {} of the lattice at a distance of {:.4} σ (counted from 1)",
                    pair.i + 1,
                    pair.j + 1,
                    pair.distance
                ),
                format!(
                    "no pair nearer than {within} σ: a lower density, shorter bonds, or lattice = \"sc\" for chains"
                ),
            )
            .into()),
    }
}

/// Moves the sites of each molecule of a file together, and checks its bonds: they have the right length, and none follows from
/// others.
///
/// # Errors
/// [`EngineError`] for the first molecule that is none.
pub fn take(scene: &Scene, path: &Path, read: &mut StartConfiguration) -> Result<(), EngineError> {
    let molecules = scene.molecules();
    let Some(topology) = molecules.topology() else {
        return Ok(());
    };
    let (n, sites) = (read.positions.len(), topology.sites());
    let refuse = |found: String, allowed: String| -> EngineError {
        let key = "system.configuration";
        scene.source.invalid(key, found, allowed).into()
    };
    if !n.is_multiple_of(sites) {
        return Err(refuse(
            format!("{n} particles in {}", path.display()),
            format!("a multiple of molecule.sites = {sites}"),
        ));
    }
    initial::unfold_molecules(&read.cell, topology, &mut read.positions);
    for (m, positions) in read.positions.chunks(sites).enumerate() {
        let fault = match molecules.are_rigid() {
            true => wrong_length(topology, positions),
            false => through_the_box(&read.cell, topology, positions),
        };
        if let Some((bond, allowed)) = fault {
            let length = bond.vector(positions).length();
            let [i, j] = bond.sites.map(|site| m * sites + site + 1);
            let path = path.display();
            let found = format!(
                "a bond of {length:.6} σ between particles {i} and {j} of {path} (counted from 1)"
            );
            return Err(refuse(found, allowed));
        }
        if molecules.are_rigid()
            && let Some(bond) = topology.redundant_bond(positions)
        {
            let found = format!("molecule {} of {}", m + 1, path.display());
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
    let allowed = format!("bonds of at most half the shortest side of the box, {half:.4} σ");
    Some((bond, allowed))
}
