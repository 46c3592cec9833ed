//! Molecules before the first step: on a lattice, or as a file has them, with all that a molecule must be.

use std::path::Path;

use lennard_core::number::short;
use lennard_core::options::upper_bound;
use lennard_core::{Bond, DVec3, PeriodicBox, Topology};
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
    if scene.longest_cutoff() == 0.0 {
        return Ok(positions);
    }
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
                    "no pair nearer than {within} σ: a lower density, shorter bonds, or start.lattice = \"sc\" for chains"
                ),
            )
            .into()),
    }
}

/// Moves the sites of each molecule of a file together. A file may have folded them into the box.
///
/// # Errors
/// [`EngineError`] where the file has no whole number of molecules.
pub fn unfold(
    scene: &Scene,
    path: &Path,
    cell: &PeriodicBox,
    positions: &mut [DVec3],
) -> Result<(), EngineError> {
    let molecules = scene.molecules();
    let Some(topology) = molecules.topology() else {
        return Ok(());
    };
    let (n, sites) = (positions.len(), topology.sites());
    if !n.is_multiple_of(sites) {
        let found = format!("{n} particles in {}", path.display());
        let allowed = format!("a multiple of molecule.sites = {sites}");
        return Err(scene.source.invalid("start.file", found, allowed).into());
    }
    initial::unfold_molecules(cell, topology, positions);
    Ok(())
}

/// Checks the bonds of each molecule: they have the right length, and none follows from others.
///
/// # Errors
/// [`EngineError`] for the first molecule that is none.
pub fn check(
    scene: &Scene,
    origin: &Origin<'_>,
    cell: &PeriodicBox,
    positions: &[DVec3],
) -> Result<(), EngineError> {
    let molecules = scene.molecules();
    let Some(topology) = molecules.topology() else {
        return Ok(());
    };
    let sites = topology.sites();
    let refuse = |found: String, allowed: String| -> EngineError {
        scene.source.invalid(origin.key, found, allowed).into()
    };
    for (m, positions) in positions.chunks(sites).enumerate() {
        let fault = match molecules.are_rigid() {
            true => wrong_length(topology, positions),
            false => through_the_box(cell, topology, positions),
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

/// Where positions were written.
pub struct Origin<'a> {
    /// The key of the scene.
    pub key: &'a str,
    /// The file, or what stands for it.
    pub name: String,
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

/// ω·dt of a spring above which a step is said to be long for it.
const LONG_STEP: f64 = 0.5;

/// A remark where a step is long for the springs of bonds, though stable: the vibration is then off by (ω·dt)²/24 or more.
pub(crate) fn remark_on_springs(scene: &Scene) -> Option<String> {
    let omega = scene.molecule.as_ref()?.fastest_vibration();
    let steps = scene.stages.iter().map(|stage| scene.stage_dt(stage));
    let dt = steps.fold(0.0, f64::max);
    (omega * dt > LONG_STEP).then(|| {
        format!(
            "dt = {} τ is long for the springs of the bonds: ω·dt = {:.2}, and their vibration is off by {:.0} %; \
             at {:.2e} τ it is off by 1 %",
            short(dt),
            omega * dt,
            100.0 * (omega * dt).powi(2) / 24.0,
            LONG_STEP / omega
        )
    })
}

/// A remark where bonds lose energy: who reads a conserved energy that stays must know that the energy does not.
pub(crate) fn remark_on_damping(scene: &Scene) -> Option<String> {
    let bonds = &scene.molecule.as_ref()?.bonds;
    let counted = match bonds.spec().integrator.is_some() && scene.solves_contacts() {
        false => "the conserved energy counts it as heat",
        true => "beside contacts no heat is counted, and the conserved energy falls by it",
    };
    bonds.damps_vibrations().then(|| {
        format!(
            "[bonds] method = {:?} takes energy from vibrations: {counted}, and no bath keeps vibrations at its temperature",
            bonds.name()
        )
    })
}
