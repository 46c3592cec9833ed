//! The species of the particles of a start: mixed at random on a lattice, or as a file says.

use std::path::Path;

use lennard_core::SpeciesTable;
use lennard_io::FoundSpecies;
use lennard_scene::{MixtureTables, Scene};
use rand::seq::SliceRandom;

use super::value::streams;
use crate::EngineError;

/// Masses of a file may differ from the scene's by this share, beside a common factor.
const SAME_MASS: f64 = 1e-3;

/// The species of `n` particles of a start without a file, mixed at random by the seed of the scene.
pub(super) fn mixed(scene: &Scene, n: usize) -> Result<SpeciesTable, EngineError> {
    let ordered = scene.species_in_order(&scene.counts(n)?);
    let Some(of_particles) = ordered.of_particles() else {
        return Ok(ordered);
    };
    let mut mixed = of_particles.to_vec();
    mixed.shuffle(&mut streams(scene).sequential("species"));
    Ok(scene.species_table(n, &mixed))
}

/// The species of the `n` particles of a file, whose names are names or elements of the scene's species.
pub(super) fn of_file(
    scene: &Scene,
    path: &Path,
    found: &FoundSpecies,
    n: usize,
) -> Result<SpeciesTable, EngineError> {
    let refuse = |found: String, allowed: String| -> EngineError {
        scene.invalid("start.file", found, allowed).into()
    };
    let file = path.display();
    let Some(mixture) = &scene.mixture else {
        if found.names.len() > 1 {
            let words = match found.elements_tell_apart() {
                true => format!("species {}", found.names.join(", ")),
                false => format!("types {}", found.types.join(", ")),
            };
            return Err(refuse(
                format!("{words} in {file}"),
                "one species, or a table `[[species]]` for each".to_owned(),
            ));
        }
        return Ok(scene.one_species(n));
    };
    if found.names.is_empty() && mixture.species.len() > 1 {
        return Err(refuse(
            format!("no names of species in {file}"),
            "an extended XYZ file with a column `species:S:1`".to_owned(),
        ));
    }
    let numbers = match mixture.species.len() {
        1 if found.names.len() <= 1 => vec![0],
        _ => numbers(mixture, found).map_err(|name| {
            let known: Vec<String> = mixture
                .species
                .iter()
                .map(|s| format!("{:?} (or {})", s.name, s.element))
                .collect();
            refuse(format!("species {name:?} in {file}"), known.join(", "))
        })?,
    };
    check_masses(mixture, found, &numbers)
        .map_err(|(found, allowed)| refuse(format!("{found} in {file}"), allowed))?;
    let of_particle: Vec<u8> = match mixture.species.len() {
        1 => Vec::new(),
        _ => (0..n).map(|i| numbers[found.of(i)] as u8).collect(),
    };
    Ok(scene.species_table(n, &of_particle))
}

/// The number of the species of each name of a file, or the name that is of none. A type of LAMMPS is a number: the species in
/// the order of the scene. It counts where elements do not tell particles apart that types do.
fn numbers(mixture: &MixtureTables, found: &FoundSpecies) -> Result<Vec<usize>, String> {
    let number = |name: &String| {
        let by_name = mixture.species.iter().position(|s| s.name == name.as_str());
        let by_element = || mixture.species.iter().position(|s| s.element == *name);
        let by_number = || name.parse::<usize>().ok()?.checked_sub(1);
        by_name
            .or_else(by_element)
            .or_else(|| by_number().filter(|a| *a < mixture.species.len()))
            .ok_or_else(|| name.clone())
    };
    let of = |names: &[String]| names.iter().map(number).collect::<Result<Vec<usize>, String>>();
    match found.elements_tell_apart() {
        true => of(&found.names),
        false => of(&found.types).or_else(|_| of(&found.names)),
    }
}

/// Refuses masses of a file that are in other proportions than the scene's.
fn check_masses(
    mixture: &MixtureTables,
    found: &FoundSpecies,
    numbers: &[usize],
) -> Result<(), (String, String)> {
    let own = |k: usize| mixture.species[numbers[k]].mass;
    let Some(first) = found.masses.first().filter(|_| found.masses.len() > 1) else {
        return Ok(());
    };
    for (k, mass) in found.masses.iter().enumerate() {
        let wanted = own(k) / own(0);
        if (mass / first / wanted - 1.0).abs() > SAME_MASS {
            return Err((
                format!("masses {first} of {} and {mass} of {}", found.names[0], found.names[k]),
                format!("masses as {} to {}, as in the scene", own(0), own(k)),
            ));
        }
    }
    Ok(())
}
