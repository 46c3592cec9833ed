//! The keys of `[[species]]` and `[[pair]]`.

use lennard_forcefield::{LONGEST_CUTOFF, SHORTEST_CUTOFF};

use super::{Amount, MixtureTables, PairEntry, SpeciesEntry};
use crate::reference::MOST_ATOMS;

lennard_core::options! {
    /// The keys of `[[species]]`.
    pub(crate) struct SpeciesKeys {
        /// Its name in `[[pair]]`, results and overrides (`--set species.NAME.sigma=…`).
        name: Option<String> = None, else "needed", Words("at most 200 letters, digits, `-` and `_`, beginning with a letter, and unlike any other species'");
        /// Share of all particles; the fractions of all species add up to 1.
        fraction: Option<f64> = None, else "this or `count`", Between(1e-9, 1.0);
        /// Number of particles. With `configuration`, the file has them, and neither key is written.
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
        /// Cutoff of this pair.
        r_cut: Option<f64> = None, else "`truncation.r_cut`", Between(SHORTEST_CUTOFF, LONGEST_CUTOFF), in "as `truncation.r_cut_in` says";
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

impl MixtureTables {
    /// The tables `[[pair]]` as a scene writes them.
    pub(crate) fn pair_keys(&self) -> Vec<PairKeys> {
        let keys = |pair: &PairEntry| {
            let [a, b] = pair.species.map(|a| Some(self.species[a].name.to_string()));
            PairKeys {
                a,
                b,
                sigma: pair.sigma,
                epsilon: pair.epsilon,
                k: pair.k,
                l: pair.l,
                r_cut: pair.r_cut,
            }
        };
        self.pairs.iter().map(keys).collect()
    }
}
