//! The names and masses of particles, gathered line by line.

use crate::error::{Refusal, excerpt, refused};

/// The most names of a file.
const MOST_NAMES: usize = 255;

/// The species of the particles, as a file names them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FoundSpecies {
    /// The names, in the order in which they appear; none where the file names none.
    pub names: Vec<String>,
    /// The type of LAMMPS beside each name, where a file has both; an element may have several types.
    pub types: Vec<String>,
    /// The number of the name of each particle, `[N]`; empty where there is one name at most.
    pub of_particle: Vec<u8>,
    /// The mass of the particles with each name; one mass where there is no name, and none where the file has no masses.
    pub masses: Vec<f64>,
}

impl FoundSpecies {
    /// Whether no two types have one name.
    #[must_use]
    pub fn elements_tell_apart(&self) -> bool {
        (1..self.types.len()).all(|k| !self.names[..k].contains(&self.names[k]))
    }

    /// The number of the name of particle `i`.
    #[must_use]
    pub fn of(&self, i: usize) -> usize {
        self.of_particle.get(i).map_or(0, |a| usize::from(*a))
    }
}

/// Gathers the species of a frame.
pub(crate) struct SpeciesReader {
    /// What was found so far.
    pub(crate) found: FoundSpecies,
    n: usize,
    particles: usize,
}

impl SpeciesReader {
    /// For a frame of `n` particles.
    pub(crate) fn new(n: usize) -> Self {
        Self { found: FoundSpecies::default(), n, particles: 0 }
    }

    /// Takes name, type and mass of the next particle. A type is its name where it has no other.
    pub(crate) fn take(
        &mut self,
        name: Option<&str>,
        kind: Option<&str>,
        mass: Option<f64>,
    ) -> Result<(), Refusal> {
        let found = &mut self.found;
        let (name, kind) = match name {
            None => (kind, None),
            name => (name, kind),
        };
        let is_kind = |k: usize| kind.is_none_or(|kind| found.types[k] == kind);
        let of = match name {
            None => 0,
            Some(name) => {
                match (0..found.names.len()).find(|k| found.names[*k] == name && is_kind(*k)) {
                    Some(known) => known,
                    None if found.names.len() == MOST_NAMES => {
                        return refused(
                            excerpt(name.as_bytes()),
                            format!("at most {MOST_NAMES} names of species"),
                        );
                    }
                    None => {
                        found.names.push(name.to_owned());
                        found.types.extend(kind.map(str::to_owned));
                        found.names.len() - 1
                    }
                }
            }
        };
        if found.of_particle.is_empty() && of > 0 {
            found.of_particle.reserve(self.n);
            found.of_particle.resize(self.particles, 0);
        }
        if found.names.len() > 1 {
            found.of_particle.push(of as u8);
        }
        self.particles += 1;
        let Some(mass) = mass else {
            return Ok(());
        };
        if found.masses.len() == of {
            found.masses.push(mass);
        }
        let first = found.masses[of];
        if first == mass {
            return Ok(());
        }
        let like = match name {
            Some(name) => format!("{first}, like the {} before", excerpt(name.as_bytes())),
            None => format!("{first}, like the particles before: the file names no species"),
        };
        refused(format!("mass {mass}"), like)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_numbered_as_they_appear_and_one_name_stores_nothing() {
        let mut reader = SpeciesReader::new(4);
        for name in ["Ar", "Ar", "Kr", "Ar"] {
            let mass = if name == "Ar" { 1.0 } else { 2.0 };
            reader.take(Some(name), None, Some(mass)).unwrap();
        }
        let found = reader.found;
        assert_eq!(found.names, ["Ar", "Kr"]);
        assert_eq!(found.of_particle, [0, 0, 1, 0]);
        assert_eq!(found.masses, [1.0, 2.0]);
        assert_eq!((found.of(1), found.of(2)), (0, 1));
        let mut one = SpeciesReader::new(2);
        one.take(Some("Ar"), None, None).unwrap();
        one.take(Some("Ar"), None, None).unwrap();
        assert_eq!(one.found.of_particle, Vec::<u8>::new());
    }

    #[test]
    fn a_species_has_one_mass() {
        let mut reader = SpeciesReader::new(3);
        reader.take(Some("Ar"), None, Some(1.0)).unwrap();
        let (found, allowed) = reader.take(Some("Ar"), None, Some(1.5)).unwrap_err();
        assert_eq!((found.as_str(), allowed.as_str()), ("mass 1.5", "1, like the `Ar` before"));
        let mut nameless = SpeciesReader::new(2);
        nameless.take(None, None, Some(1.0)).unwrap();
        assert!(nameless.take(None, None, Some(2.0)).is_err());
    }
}
