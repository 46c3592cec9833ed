//! Units of a substance: quantities with units of the laboratory, in reduced units and back.
//!
//! `units.csv` has the symbols. A unit is written as `K`, `g/cm3`, `W/(m K)` or `ε/σ³`. One reader takes both kinds of symbols, so that the unit which a key or
//! a quantity declares is its dimension too.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

/// A substance with the parameters of its Lennard-Jones model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Substance {
    /// Its name in scenes and options.
    #[serde(rename = "substance")]
    pub name: &'static str,
    /// σ, Å.
    #[serde(rename = "sigma_angstrom")]
    pub sigma: f64,
    /// ε/k_B, K.
    #[serde(rename = "epsilon_kelvin")]
    pub epsilon: f64,
    /// Mass of a particle, u.
    #[serde(rename = "mass_u")]
    pub mass: f64,
    /// Where σ and ε are from.
    pub source: &'static str,
}

/// The substances whose parameters were read in a source, the usual one first.
pub static SUBSTANCES: [Substance; 2] = [
    Substance {
        name: "argon",
        sigma: 3.405,
        epsilon: 119.8,
        mass: 39.948,
        source: "parameters of Michels et al., as in Verlet's paper of 1967 (read on SklogWiki, page Argon)",
    },
    Substance {
        name: "argon-rahman",
        sigma: 3.4,
        epsilon: 120.0,
        mass: 39.948,
        source: "parameters of Rahman's paper of 1964 (read on SklogWiki, page Argon)",
    },
];

impl std::fmt::Display for Substance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { name, sigma, epsilon, mass, .. } = self;
        write!(f, "{name}: σ = {sigma} Å, ε/k_B = {epsilon} K, m = {mass} u")
    }
}

/// Powers of length, mass, time and temperature.
pub type Dimension = [i32; 4];

/// A unit in SI units, with its dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Unit {
    factor: f64,
    dimension: Dimension,
}

impl Unit {
    const ONE: Self = Self::new(1.0, [0; 4]);

    const fn new(factor: f64, dimension: Dimension) -> Self {
        Self { factor, dimension }
    }

    fn times(self, other: Self, power: i32) -> Self {
        let dimension = std::array::from_fn(|i| self.dimension[i] + power * other.dimension[i]);
        Self::new(self.factor * other.factor.powi(power), dimension)
    }
}

/// A symbol of `units.csv`, with the powers of its dimension.
#[derive(Deserialize)]
struct Symbol {
    symbol: String,
    factor: f64,
    length: i32,
    mass: i32,
    time: i32,
    temperature: i32,
    takes_prefix: bool,
}

impl Symbol {
    fn unit(&self, prefix: f64) -> Unit {
        Unit::new(prefix * self.factor, [self.length, self.mass, self.time, self.temperature])
    }
}

static SYMBOLS: LazyLock<Vec<Symbol>> = LazyLock::new(|| {
    let data = include_bytes!("units.csv").as_slice();
    let rows = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(data).into_deserialize();
    rows.collect::<Result<_, _>>().expect("a table of units")
});

/// Prefixes with their powers of ten.
const PREFIXES: [(&str, i32); 7] =
    [("f", -15), ("p", -12), ("n", -9), ("m", -3), ("c", -2), ("k", 3), ("M", 6)];

/// Units that are offered. The first with the dimension of a quantity is the unit that it is shown in.
const OFFERED: &str = "K, fs, ps, Å, nm, g/cm3, mol/L, 1/Å3, MPa, bar, atm, kJ/mol, kcal/mol, meV, u, g/mol, nm2/ns, cm2/s, mPa s, \
    W/(m K), J/(mol K), m/s, Å/ps, mN/m, 1/Å, 1/Å2, nm3, 1/ps, 1/MPa, K/MPa, 1/K, MPa/K, kJ/mol/ps, m/N, kg/s, m/s2";

fn symbol(name: &str) -> Option<Unit> {
    let of = |name: &str| SYMBOLS.iter().find(|symbol| symbol.symbol == name);
    let prefixed = |(prefix, power): &(&str, i32)| {
        let symbol = of(name.strip_prefix(prefix)?).filter(|symbol| symbol.takes_prefix)?;
        Some(symbol.unit(10.0_f64.powi(*power)))
    };
    let plain = of(name).map(|symbol| symbol.unit(1.0));
    plain.or_else(|| PREFIXES.iter().find_map(prefixed))
}

/// The symbols of reduced units, with a σ, ε and m in SI units.
fn reduced_symbol([sigma, epsilon, mass]: [f64; 3], name: &str) -> Option<Unit> {
    Some(match name {
        "σ" => Unit::new(sigma, [1, 0, 0, 0]),
        "ε" => Unit::new(epsilon, [2, 1, -2, 0]),
        "m" => Unit::new(mass, [0, 1, 0, 0]),
        "τ" => Unit::new(sigma * (mass / epsilon).sqrt(), [0, 0, 1, 0]),
        "k_B" => symbol("k_B")?,
        _ => return None,
    })
}

/// The unit that a text writes as a product of powers of symbols: a stroke divides by everything after it.
///
/// # Errors
/// The piece that is no symbol.
fn parse(text: &str, symbol: impl Fn(&str) -> Option<Unit>) -> Result<Unit, String> {
    const RAISED: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹";
    let plain = |c: char| match c {
        '−' | '⁻' => '-',
        c => {
            RAISED.chars().zip('0'..).find(|(raised, _)| *raised == c).map_or(c, |(_, digit)| digit)
        }
    };
    let text: String = text.chars().map(plain).collect();
    let is_symbol = |c: char| c.is_alphabetic() || c == '_';
    let (mut rest, mut sign, mut unit) = (&*text, 1, Unit::ONE);
    loop {
        rest = rest.trim_start_matches([' ', '·', '*', '(', ')']);
        if let Some(after) = rest.strip_prefix('/') {
            (rest, sign) = (after, -1);
        } else if let Some(after) = rest.strip_prefix("1/") {
            (rest, sign) = (after, -1);
        } else if rest.is_empty() {
            return Ok(unit);
        } else {
            // Greek letters stand alone: `ετ`.
            let end = match rest.chars().next() {
                Some(greek @ ('σ' | 'ε' | 'τ')) => greek.len_utf8(),
                _ => rest.find(|c| !is_symbol(c)).unwrap_or(rest.len()),
            };
            let (name, after) = rest.split_at(end);
            let end = after.find(|c| !"^-0123456789".contains(c)).unwrap_or(after.len());
            let (power, after) = after.split_at(end);
            let raised = match power.strip_prefix('^').unwrap_or(power) {
                "" if power.is_empty() => Some(1),
                power => power.parse().ok().filter(|power: &i32| power.abs() <= 9),
            };
            let found = symbol(name).zip(raised);
            let (found, raised) = found.ok_or_else(|| match name {
                "" => rest.to_owned(),
                name => format!("{name}{power}"),
            })?;
            unit = unit.times(found, sign * raised);
            rest = after;
        }
    }
}

/// The dimension of a reduced unit such as `ε/σ³`, or `ε per particle`; `None` for a plain number, and for words.
#[must_use]
pub fn dimension_of(reduced: &str) -> Option<Dimension> {
    let text = reduced.split(" per ").next().unwrap_or_default();
    let unit = parse(text, |name| reduced_symbol([1.0; 3], name)).ok()?;
    (unit.dimension != [0; 4]).then_some(unit.dimension)
}

/// The units that are offered for a reduced unit, the one that is shown first.
#[must_use]
pub fn offered_for(reduced: &str) -> Vec<&'static str> {
    let dimension = |unit: &str| parse(unit, symbol).ok().map(|unit| as_density(unit.dimension));
    let wanted = dimension_of(reduced);
    offered().filter(|unit| dimension(unit) == wanted).collect()
}

/// Every unit that is offered.
pub fn offered() -> impl Iterator<Item = &'static str> {
    OFFERED.split(", ")
}

/// A mass density stands for a number density.
fn as_density(dimension: Dimension) -> Dimension {
    if dimension == [-3, 1, 0, 0] { [-3, 0, 0, 0] } else { dimension }
}

/// A number and its unit, as written: `94 K`, `1.374g/cm3`. `None` where the text does not begin with a number.
#[must_use]
pub fn split(written: &str) -> Option<(f64, &str)> {
    let written = written.trim();
    let begins = written.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    let ends = (1..=written.len()).rev().filter(|end| begins && written.is_char_boundary(*end));
    let number = |end: usize| Some((written[..end].parse().ok()?, written[end..].trim()));
    ends.map(number).find_map(|found| found)
}

/// Why a quantity with a unit cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum UnitError {
    /// Nothing has this symbol.
    #[error("has an unknown unit, `{0}`")]
    Unknown(String),
    /// The unit measures something else.
    #[error("has a unit of another dimension")]
    Dimension,
    /// Without a substance no unit has a meaning.
    #[error("has a unit, and no substance is named")]
    NoSubstance,
    /// Particles of several masses, or molecules, have no mass density that says how many there are.
    #[error("is a mass density of particles that are not alike")]
    MassDensity,
}

/// The units of a fluid: σ, ε and m of a substance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Units {
    /// The substance.
    #[serde(flatten)]
    pub substance: &'static Substance,
    /// Whether all particles are atoms of the substance, so that a mass density says how many there are.
    #[serde(skip)]
    pub alike: bool,
}

impl Units {
    /// The units of a substance by its name.
    #[must_use]
    pub fn of(name: &str) -> Option<Self> {
        let substance = SUBSTANCES.iter().find(|substance| substance.name == name)?;
        Some(Self { substance, alike: true })
    }

    /// σ (m), ε (J) and m (kg).
    fn si(&self) -> [f64; 3] {
        let Substance { sigma, epsilon, mass, .. } = self.substance;
        let of = |name| symbol(name).map_or(f64::NAN, |unit| unit.factor);
        [sigma * of("Å"), epsilon * of("k_B"), mass * of("u")]
    }

    /// One σ in m, one τ in s, and m in kg.
    #[must_use]
    pub fn length_time_mass(&self) -> [f64; 3] {
        let [sigma, epsilon, mass] = self.si();
        [sigma, sigma * (mass / epsilon).sqrt(), mass]
    }

    /// How much a unit is of a reduced unit of its dimension.
    fn in_reduced(&self, unit: &str, reduced: &str) -> Result<f64, UnitError> {
        let unit = parse(unit, symbol).map_err(UnitError::Unknown)?;
        let text = reduced.split(" per ").next().unwrap_or_default();
        let own = parse(text, |name| reduced_symbol(self.si(), name));
        let own = own.map_err(|_| UnitError::Dimension)?;
        let of_mass =
            unit.dimension != own.dimension && as_density(unit.dimension) == own.dimension;
        match unit.dimension == own.dimension {
            true => Ok(unit.factor / own.factor),
            false if of_mass && self.alike => Ok(unit.factor / own.factor / self.si()[2]),
            false if of_mass => Err(UnitError::MassDensity),
            false => Err(UnitError::Dimension),
        }
    }

    /// A quantity as written, such as `94 K`, in the reduced unit of its dimension.
    ///
    /// # Errors
    /// [`UnitError`] where the unit is unknown or does not fit, or there are no units.
    pub fn reduce(
        units: Option<&Self>,
        number: f64,
        unit: &str,
        reduced: &str,
    ) -> Result<f64, UnitError> {
        // Any substance tells a wrong unit from a missing substance.
        let some = Self { substance: &SUBSTANCES[0], alike: true };
        let factor = units.unwrap_or(&some).in_reduced(unit, reduced)?;
        if units.is_some() { Ok(number * factor) } else { Err(UnitError::NoSubstance) }
    }

    /// One of a reduced unit in the unit that is shown for it, and that unit; `None` where no unit is offered.
    #[must_use]
    pub fn one(&self, reduced: &str) -> Option<(f64, &'static str)> {
        let fits = |unit| Some((self.in_reduced(unit, reduced).ok()?.recip(), unit));
        offered_for(reduced).into_iter().find_map(fits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn argon() -> Units {
        Units::of("argon").unwrap()
    }

    fn reduced(written: &str, unit: &str) -> f64 {
        let (number, found) = split(written).unwrap();
        Units::reduce(Some(&argon()), number, found, unit).unwrap()
    }

    /// Proves that one of each reduced unit is what the table of conversions of the reference data says, computed there apart.
    #[test]
    fn the_units_of_argon_are_those_of_the_reference_data() {
        for (name, rows) in [
            ("argon", [2.156_349, 5.376_691e-4, 41.897_56, 0.090_346, 1.680_323, 119.8]),
            ("argon-rahman", [2.151_388, 5.373_276e-4, 42.152_93, 0.090_687, 1.687_747, 120.0]),
        ] {
            let units = Units::of(name).unwrap();
            let of = |reduced, unit| units.in_reduced(unit, reduced).unwrap().recip();
            let found = [
                of("τ", "ps"),
                of("σ²/τ", "cm2/s"),
                of("ε/σ³", "MPa"),
                of("ετ/σ³", "mPa s"),
                of("σ⁻³", "g/cm3"),
                of("ε/k_B", "K"),
            ];
            for (found, row) in found.into_iter().zip(rows) {
                assert!((found / row - 1.0).abs() < 6e-6, "{name}: {found} {row}");
            }
        }
    }

    #[test]
    fn quantities_are_read_with_their_units() {
        for (written, unit, value) in [
            ("94.4 K", "ε/k_B", 94.4 / 119.8),
            ("94.4K", "ε/k_B", 94.4 / 119.8),
            ("1.374 g/cm3", "σ⁻³", 1.374 / 1.680_323),
            ("1.374 g cm^-3", "σ⁻³", 1.374 / 1.680_323),
            ("1374 kg/m³", "σ⁻³", 1.374 / 1.680_323),
            ("0.02125 Å^-3", "σ⁻³", 0.02125 * 3.405 * 3.405 * 3.405),
            ("34.39471 mol/L", "σ⁻³", 1.374 / 1.680_323),
            ("10 fs", "τ", 0.004_637_468),
            ("1e-2ps", "τ", 0.004_637_468),
            ("40 bar", "ε/σ³", 4.0 / 41.897_56),
            ("4 MPa", "ε/σ³", 4.0 / 41.897_56),
            ("8.5125 Å", "σ", 2.5),
            ("0.85125 nm", "σ", 2.5),
            ("39.948 g/mol", "m", 1.0),
            ("0.996072 kJ/mol", "ε", 1.0),
            ("1e-3 kJ/mol/ps", "ε/τ per particle", 1e-3 * 2.156_349 / 0.996_072),
            ("0.5 1/ps", "τ⁻¹", 0.5 * 2.156_349),
        ] {
            let found = reduced(written, unit);
            assert!((found / value - 1.0).abs() < 1e-5, "{written}: {found} {value}");
        }
    }

    #[test]
    fn what_is_no_unit_or_does_not_fit_is_told_apart() {
        let refused = |unit: &str, reduced: &str, units: Option<&Units>| {
            Units::reduce(units, 1.0, unit, reduced).unwrap_err()
        };
        let argon = argon();
        let unknown = |piece: &str| UnitError::Unknown(piece.to_owned());
        for (unit, error) in [
            ("furlong", unknown("furlong")),
            ("g/cm^", unknown("cm^")),
            ("g/ccm", unknown("ccm")),
            ("°C", unknown("°C")),
            ("σ", unknown("σ")),
            ("K2", UnitError::Dimension),
            ("bar", UnitError::Dimension),
        ] {
            assert_eq!(refused(unit, "ε/k_B", Some(&argon)), error, "{unit}");
            assert_eq!(refused(unit, "ε/k_B", None), error, "{unit}");
        }
        assert_eq!(refused("K", "ε/k_B", None), UnitError::NoSubstance);
        let mixture = Units { alike: false, ..argon };
        assert_eq!(refused("g/cm3", "σ⁻³", Some(&mixture)), UnitError::MassDensity);
        assert_eq!(mixture.one("σ⁻³").unwrap().1, "mol/L");
        for words in ["", "steps", "file units per σ", "per σ", "s", "thermostats"] {
            assert_eq!(dimension_of(words), None, "{words}");
        }
        assert_eq!(split("94"), Some((94.0, "")));
        for text in ["K", "", "-", "fluid 3"] {
            assert_eq!(split(text), None, "{text}");
        }
    }

    #[test]
    fn every_offered_unit_can_be_read() {
        for unit in offered() {
            assert!(parse(unit, symbol).is_ok(), "{unit}");
        }
    }
}
