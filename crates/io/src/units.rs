//! Units that files state, and how they are taken out.

use glam::DVec3;

use crate::error::{Refusal, excerpt, refused};

/// What a scene says of the units of a file.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FileUnits {
    /// One σ in the file's unit of length; `None` where the scene does not say.
    pub length: Option<f64>,
    /// One τ in the file's unit of time, for velocities.
    pub time: Option<f64>,
    /// One σ in m, one τ in s and m in kg, where the scene names a substance: for files that state their units.
    pub substance: Option<[f64; 3]>,
    /// One σ in the unit of XTC, which names no unit, where the scene says how it writes XTC.
    pub xtc: Option<f64>,
    /// The units that the file stated.
    stated: Option<Style>,
}

/// One σ, one τ and m in the units of a file; the last two are not known of every file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scales {
    pub(crate) length: f64,
    pub(crate) time: Option<f64>,
    pub(crate) mass: Option<f64>,
}

impl Scales {
    /// A time in τ; `None` where the file's unit of time is not known.
    pub(crate) fn time(&self, found: f64) -> Option<f64> {
        self.time.map(|unit| found / unit)
    }

    /// A velocity with the units of the file taken out.
    pub(crate) fn velocity(&self, found: DVec3) -> Result<DVec3, Refusal> {
        let Some(time) = self.time else {
            return refused(
                "velocities in units of the file",
                "`start.time_scale` in the scene, one τ in the file's unit of time",
            );
        };
        Ok(found / self.length * time)
    }

    /// A momentum with the units of the file taken out. Where the unit of mass is not known, the `mass` beside it has the same.
    pub(crate) fn momentum(&self, found: DVec3, mass: Option<f64>) -> Result<DVec3, Refusal> {
        if self.mass.or(mass).is_none() {
            return refused(
                "momenta without masses, in units that are not reduced",
                "a column with the masses beside them",
            );
        }
        Ok(self.velocity(found)? / self.mass.unwrap_or(1.0))
    }

    /// A mass with the units of the file taken out.
    pub(crate) fn mass(&self, found: f64) -> f64 {
        found / self.mass.unwrap_or(1.0)
    }
}

/// Words for reduced units.
const REDUCED: [&str; 3] = ["lj", "reduced", "dimensionless"];

/// Units that a file may state: length in m, time of velocities in s, and mass in kg.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Style {
    name: &'static str,
    length: f64,
    time: Option<f64>,
    mass: Option<f64>,
}

const ANGSTROM: f64 = 1e-10;
const NANOMETER: f64 = 1e-9;
const BOHR: f64 = 5.291_772_105e-11;
const ATOMIC_MASS: f64 = 1.660_539_069e-27;

impl Style {
    const fn new(name: &'static str, length: f64, time: f64, mass: f64) -> Self {
        Self { name, length, time: Some(time), mass: Some(mass) }
    }

    const fn of_length(name: &'static str, length: f64) -> Self {
        Self { name, length, time: None, mass: None }
    }
}

/// The styles of LAMMPS, which stand beside the word 'units'. Source: LAMMPS documentation, "units command".
const STYLES: [Style; 7] = [
    Style::new("real", ANGSTROM, 1e-15, ATOMIC_MASS),
    Style::new("metal", ANGSTROM, 1e-12, ATOMIC_MASS),
    Style::new("si", 1.0, 1.0, 1.0),
    Style::new("cgs", 1e-2, 1.0, 1e-3),
    Style::new("electron", BOHR, 1.03275e-15, ATOMIC_MASS),
    Style::new("micro", 1e-6, 1e-6, 1e-15),
    Style::new("nano", NANOMETER, 1e-9, 1e-21),
];
/// Words that stand there too, and say nothing that can be read.
const VAGUE: [&str; 2] = ["atomic", "physical"];
/// The units of GRO.
pub(crate) const OF_GRO: &str = "nm and ps";
const GRO: Style = Style { mass: None, ..Style::new(OF_GRO, NANOMETER, 1e-12, 1.0) };
/// Units of length that a word names wherever it stands.
const LENGTHS: [Style; 5] = [
    Style::of_length("angstrom", ANGSTROM),
    Style::of_length("å", ANGSTROM),
    Style::of_length("nm", NANOMETER),
    Style::of_length("nanometer", NANOMETER),
    Style::of_length("bohr", BOHR),
];

fn named<'a>(styles: &'a [Style], name: &str) -> Option<&'a Style> {
    styles.iter().find(|style| style.name == name)
}

/// The unit of length of a word, in its other spellings too: `Ångströms`, `nanometres`.
fn length(word: &str) -> Option<&'static Style> {
    let plain = word.replace("ångström", "angstrom").replace("metre", "meter");
    named(&LENGTHS, plain.strip_suffix('s').unwrap_or(&plain))
}

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
    let known = |word: &&&str| {
        named(&STYLES, word).is_some() || VAGUE.contains(*word) || REDUCED.contains(*word)
    };
    let of_word = |(i, word): (usize, &&str)| -> Option<String> {
        let found = match (*word, &words[i + 1..]) {
            ("unit" | "units", ["=", unit, ..]) => Some(*unit),
            ("unit" | "units", after) => {
                let before = i.checked_sub(1).map(|i| &words[i]);
                after.first().filter(known).or(before.filter(known)).copied()
            }
            (word, _) => length(word).map(|_| word),
        };
        found.map(str::to_owned)
    };
    let mut all: Vec<String> = words.iter().enumerate().filter_map(of_word).collect();
    all.sort_by_key(|unit| is_reduced(unit));
    all.into_iter().next()
}

impl FileUnits {
    /// What the keys of a scene say: one σ and one τ in units of the file, or of its substance in SI units.
    #[must_use]
    pub fn new(length: Option<f64>, time: Option<f64>, substance: Option<[f64; 3]>) -> Self {
        Self { length, time, substance, xtc: None, stated: None }
    }

    /// The scales of a file that states these units. They hold for the rest of the file.
    pub(crate) fn scales(&mut self, stated: Option<&str>) -> Result<Scales, Refusal> {
        let stated = stated.map(|unit| (unit, is_reduced(unit)));
        match (self.length, stated) {
            (Some(_), Some((unit, true))) => {
                return refused(
                    format!(
                        "units {} beside `start.length_scale` in the scene",
                        excerpt(unit.as_bytes())
                    ),
                    "one of them",
                );
            }
            (Some(length), _) => return Ok(Scales { length, time: self.time, mass: None }),
            (None, Some((unit, false))) => self.state(unit)?,
            (None, _) => {}
        }
        let known = self.stated.zip(self.substance);
        Ok(match known {
            None => Scales { length: 1.0, time: Some(1.0), mass: Some(1.0) },
            Some((style, [length, time, mass])) => Scales {
                length: length / style.length,
                time: self.time.or(style.time.map(|unit| time / unit)),
                mass: style.mass.map(|unit| mass / unit),
            },
        })
    }

    /// Takes units that the file states for the units of a substance.
    fn state(&mut self, unit: &str) -> Result<(), Refusal> {
        let found = format!("units {}", excerpt(unit.as_bytes()));
        let by_hand = "`start.length_scale` and `start.time_scale` in the scene: one σ and one τ in units of the file";
        if self.substance.is_none() {
            let allowed = format!(
                "units lj (reduced units), or {by_hand}; or `units.substance`, for units that are known"
            );
            return refused(found, allowed);
        }
        let name = unit.to_lowercase();
        let style = named(&STYLES, &name).or(named(&[GRO], &name)).copied();
        let Some(style) = style.or(length(&name).copied()) else {
            let known: Vec<&str> = STYLES.iter().map(|style| style.name).collect();
            let allowed = format!(
                "units lj, {}, or a unit of length such as angstrom or nm; or {by_hand}",
                known.join(", ")
            );
            return refused(found, allowed);
        };
        match self.stated.filter(|before| *before != style) {
            Some(before) => {
                refused(format!("{found} after units `{}`", before.name), "one of them")
            }
            None => {
                self.stated = Some(style);
                Ok(())
            }
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

    /// Proves that each style means what LAMMPS says: argon at 1 σ, 1 σ/τ and 1 m, in numbers of the file.
    #[test]
    fn a_substance_takes_out_the_units_that_a_file_states() {
        let argon = Some([3.405e-10, 2.156_349e-12, 6.633_521e-26]);
        for (style, length, velocity, mass) in [
            ("real", 3.405, 1.579_058e-3, 39.948),
            ("METAL", 3.405, 1.579_058, 39.948),
            ("si", 3.405e-10, 157.905_8, 6.633_521e-26),
            ("cgs", 3.405e-8, 15_790.58, 6.633_521e-23),
            ("electron", 6.434_517, 3.081_69e-3, 39.948),
            ("nano", 0.3405, 157.905_8, 6.633_521e-5),
        ] {
            let scales = FileUnits::new(None, None, argon).scales(Some(style)).unwrap();
            let one = scales.velocity(DVec3::X * velocity).unwrap().x;
            let momentum = scales.momentum(DVec3::X * velocity * mass, None).unwrap().x;
            for x in [length / scales.length, one, scales.mass(mass), momentum] {
                assert!((x - 1.0).abs() < 1e-5, "{style}: {x}");
            }
        }
        let mut units = FileUnits::new(None, None, argon);
        assert_eq!(units.scales(None).unwrap().length, 1.0);
        let scales = units.scales(Some("angstrom")).unwrap();
        assert!(scales.velocity(DVec3::X).is_err() && scales.momentum(DVec3::X, None).is_err());
        // What a file has stated holds for the rest of it.
        assert_eq!(units.scales(None).unwrap(), scales);
        let refused = |units: &mut FileUnits, stated| units.scales(Some(stated)).unwrap_err();
        assert!(refused(&mut units, "real").0.contains("after units `angstrom`"));
        assert!(
            refused(&mut FileUnits::new(None, None, argon), "furlong").1.contains("real, metal")
        );
        assert!(refused(&mut FileUnits::default(), "real").1.contains("`units.substance`"));
    }
}
