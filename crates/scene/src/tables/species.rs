//! The tables `[[species]]`, `[mixing]` and `[[pair]]`: what a mixture is made of.

use lennard_core::Species;
use lennard_forcefield::{CombiningOptions, Deviation, LONGEST_CUTOFF, SHORTEST_CUTOFF, Size};

use crate::Name;
use crate::limits::MOST_ATOMS;

lennard_core::options! {
    /// The keys of `[[species]]`.
    pub(crate) struct SpeciesKeys {
        /// Its name in `[[pair]]`, results and overrides (`--set species.NAME.sigma=…`).
        name: Option<String> = None, else "needed", Words("at most 200 letters, digits, `-` and `_`, beginning with a letter, and unlike any other species'");
        /// Share of all particles; the fractions of all species add up to 1.
        fraction: Option<f64> = None, else "this or `count`", Between(1e-9, 1.0);
        /// Number of particles. A start from a file has them, and neither key is written.
        count: Option<usize> = None, else "this or `fraction`", Whole(1, MOST_ATOMS);
        /// σ of two particles of this species.
        sigma: f64 = 1.0, Between(0.01, 100.0), in "σ";
        /// ε of two particles of this species; 0 for none.
        epsilon: f64 = 1.0, ZeroOrBetween(1e-6, 1e6), in "ε";
        /// Mass of each particle.
        mass: f64 = 1.0, Between(1e-6, 1e6), in "m";
        /// Symbol of its particles in files.
        element: Option<String> = None, else "`name`, where it is a symbol; else Ar, Kr, Xe, … in turn", Words("an element symbol, or \"X\", unlike any other species'");
    }
}

lennard_core::options! {
    /// The keys of `[[pair]]`.
    pub(crate) struct PairKeys {
        /// One species.
        a: Option<String> = None, else "needed", Words("the name of a species");
        /// The other; the same for a pair of like particles, which has `r_cut` alone.
        b: Option<String> = None, else "needed", Words("the name of a species");
        /// σ of the pair.
        sigma: Option<f64> = None, else "by the rule", Between(0.01, 100.0), in "σ";
        /// ε of the pair; 0 for none.
        epsilon: Option<f64> = None, else "by the rule", ZeroOrBetween(1e-6, 1e6), in "ε";
        /// Deviation of ε of this pair, with rule "lorentz-berthelot" alone.
        k: Option<f64> = None, else "`mixing.k`", Between(-1.0, 1.0);
        /// Deviation of σ of this pair, with rule "lorentz-berthelot" alone.
        l: Option<f64> = None, else "`mixing.l`", Between(-0.5, 0.5);
        /// Cutoff of this pair, measured as `truncation.r_cut_in` says.
        r_cut: Option<f64> = None, else "`truncation.r_cut`", Between(SHORTEST_CUTOFF, LONGEST_CUTOFF), in "σ";
    }
}

impl From<&SpeciesEntry> for SpeciesKeys {
    fn from(entry: &SpeciesEntry) -> Self {
        let (fraction, count) = match entry.amount {
            Amount::Fraction(fraction) => (Some(fraction), None),
            Amount::Count(count) => (None, Some(count)),
            Amount::OfFile => (None, None),
        };
        Self {
            name: Some(entry.name.to_string()),
            fraction,
            count,
            sigma: entry.sigma,
            epsilon: entry.epsilon,
            mass: entry.mass,
            element: Some(entry.element.clone()),
        }
    }
}

/// A table `[[species]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeciesEntry {
    /// Its name, unlike any other's.
    pub name: Name,
    /// How many particles are of it.
    pub amount: Amount,
    /// σ_aa, in σ of the scene.
    pub sigma: f64,
    /// ε_aa, in ε of the scene.
    pub epsilon: f64,
    /// Mass, in m of the scene.
    pub mass: f64,
    /// Symbol of its particles in files, unlike any other's.
    pub element: String,
}

/// How many particles are of a species.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Amount {
    /// This share of all particles.
    Fraction(f64),
    /// So many.
    Count(usize),
    /// As many as a configuration file has.
    OfFile,
}

/// A table `[[pair]]`: what one pair of species has of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct PairEntry {
    /// The two species, by number.
    pub species: [usize; 2],
    /// The table as it is written.
    pub(crate) keys: PairKeys,
}

impl PairEntry {
    /// Whether it is of these species, in either order.
    pub(crate) fn is_of(&self, [a, b]: [usize; 2]) -> bool {
        self.species == [a, b] || self.species == [b, a]
    }
}

/// The species of a scene and what acts between them.
#[derive(Debug, Clone, PartialEq)]
pub struct MixtureTables {
    /// All species; at least one.
    pub species: Vec<SpeciesEntry>,
    /// How unlike species combine; `None` for one species alone.
    pub rule: Option<CombiningOptions>,
    /// Pairs with parameters of their own.
    pub pairs: Vec<PairEntry>,
}

impl MixtureTables {
    /// σ and ε of a pair of species; `None` where neither rule nor table says them.
    pub(crate) fn size(&self, a: usize, b: usize) -> Option<Size> {
        let own =
            |a: usize| Size { sigma: self.species[a].sigma, epsilon: self.species[a].epsilon };
        if a == b {
            return Some(own(a));
        }
        let pair = self.pair(a, b);
        let deviation =
            pair.map_or(Deviation::default(), |keys| Deviation { k: keys.k, l: keys.l });
        let rule = self.rule.as_ref();
        let by_rule = rule.and_then(|rule| rule.combine(own(a), own(b), deviation));
        Some(Size {
            sigma: pair.and_then(|p| p.sigma).or(by_rule.map(|s| s.sigma))?,
            epsilon: pair.and_then(|p| p.epsilon).or(by_rule.map(|s| s.epsilon))?,
        })
    }

    /// The particles of all species together, where all are counted.
    pub(crate) fn total_count(&self) -> Option<usize> {
        let counts = self.species.iter().map(|s| match s.amount {
            Amount::Count(count) => Some(count),
            Amount::Fraction(_) | Amount::OfFile => None,
        });
        counts.sum()
    }

    /// The table of a pair of species, in either order.
    pub(crate) fn pair(&self, a: usize, b: usize) -> Option<&PairKeys> {
        self.pairs.iter().find(|pair| pair.is_of([a, b])).map(|pair| &pair.keys)
    }

    /// The species as a system has them.
    pub(crate) fn as_species(&self) -> Vec<Species> {
        let species = self.species.iter().map(|s| Species {
            name: s.name.to_string(),
            mass: s.mass,
            element: s.element.clone(),
        });
        species.collect()
    }
}
