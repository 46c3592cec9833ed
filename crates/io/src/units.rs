//! Units that files state, and how they are taken out.

use glam::DVec3;

use crate::error::{Refusal, excerpt};

/// One σ and one τ in the units of a file, as a scene says.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FileUnits {
    /// One σ in the file's unit of length; `None` where the file holds reduced units.
    pub length: Option<f64>,
    /// One τ in the file's unit of time, for velocities.
    pub time: Option<f64>,
}

/// One σ and one τ in the units of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scales {
    pub(crate) length: f64,
    pub(crate) time: Option<f64>,
}

impl Scales {
    /// A time in τ; `None` where the file's unit of time is not known.
    pub(crate) fn time(&self, found: f64) -> Option<f64> {
        self.time.map(|unit| found / unit)
    }

    /// A velocity (or a momentum, in units of mass) with the units of the file taken out.
    pub(crate) fn velocity(&self, found: DVec3) -> Result<DVec3, Refusal> {
        let Some(time) = self.time else {
            return Err((
                "velocities in units of the file".into(),
                "`start.time_scale` in the scene, one τ in the file's unit of time".into(),
            ));
        };
        Ok(found / self.length * time)
    }
}

/// Words for reduced units.
const REDUCED: [&str; 3] = ["lj", "reduced", "dimensionless"];
/// Words that name units beside the word 'units': the styles of LAMMPS, and others.
const STYLES: [&str; 9] =
    ["real", "metal", "si", "cgs", "electron", "micro", "nano", "atomic", "physical"];
/// Words that name a unit of length wherever they stand.
const LENGTHS: [&str; 11] = [
    "angstrom",
    "angstroms",
    "ångström",
    "ångströms",
    "å",
    "nm",
    "nanometer",
    "nanometers",
    "nanometre",
    "nanometres",
    "bohr",
];

fn is_reduced(unit: &str) -> bool {
    REDUCED.contains(&unit.to_lowercase().as_str())
}

/// The units that free text states (`units = real`, `in real units`, `coordinates in Angstrom`), others than reduced ones first.
pub(crate) fn stated(text: &str) -> Option<String> {
    let spaced = text.replace(['=', ':'], " = ").to_lowercase();
    let words: Vec<&str> = spaced
        .split(|c: char| !c.is_alphanumeric() && c != '=')
        .filter(|word| !word.is_empty())
        .collect();
    let known = |word: &&&str| STYLES.contains(*word) || REDUCED.contains(*word);
    let of_word = |(i, word): (usize, &&str)| -> Option<String> {
        let found = match (*word, &words[i + 1..]) {
            ("unit" | "units", ["=", unit, ..]) => Some(*unit),
            ("unit" | "units", after) => {
                let before = i.checked_sub(1).map(|i| &words[i]);
                after.first().filter(known).or(before.filter(known)).copied()
            }
            (word, _) => LENGTHS.contains(&word).then_some(word),
        };
        found.map(str::to_owned)
    };
    let mut all: Vec<String> = words.iter().enumerate().filter_map(of_word).collect();
    all.sort_by_key(|unit| is_reduced(unit));
    all.into_iter().next()
}

impl FileUnits {
    /// The scales of a file that states these units.
    pub(crate) fn scales(self, stated: Option<&str>) -> Result<Scales, Refusal> {
        match (self.length, stated) {
            (None, Some(unit)) if !is_reduced(unit) => Err((
                format!("units {}", excerpt(unit.as_bytes())),
                "units lj (reduced units), or `start.length_scale` and `start.time_scale` in the scene: one σ and one τ in \
                 units of the file"
                    .into(),
            )),
            (None, _) => Ok(Scales { length: 1.0, time: Some(1.0) }),
            (Some(_), Some(unit)) if is_reduced(unit) => Err((
                format!("units {} beside `start.length_scale` in the scene", excerpt(unit.as_bytes())),
                "one of them".into(),
            )),
            (Some(length), _) => Ok(Scales { length, time: self.time }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_text_states_units_or_does_not() {
        for (text, wanted) in [
            (
                "LAMMPS data file via write_data, version 2 Aug 2023, timestep = 1000, units = real",
                Some("real"),
            ),
            ("LAMMPS data file, units metal", Some("metal")),
            ("argon in SI units", Some("si")),
            ("Units: furlong", Some("furlong")),
            ("units = lj", Some("lj")),
            ("units=lj, later in Angstrom", Some("angstrom")),
            ("# CELL(abcABC): 5.2 positions{angstrom} cell{angstrom}", Some("angstrom")),
            ("a liquid, in units lj", Some("lj")),
            ("lengths in units of sigma", None),
            ("Atoms. Timestep: 1000", None),
            (" i =        5, time =        2.500, E =       -31.0000000000", None),
            ("a real melt of a metal", None),
            ("units", None),
            ("", None),
        ] {
            assert_eq!(stated(text).as_deref(), wanted, "{text}");
        }
    }
}
