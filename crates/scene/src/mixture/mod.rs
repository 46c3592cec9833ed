//! The tables `[[species]]`, `[mixing]` and `[[pair]]`: what a mixture is made of.

mod amounts;
mod check;
mod keys;
mod read;

pub(crate) use keys::{PairKeys, SpeciesKeys};

use lennard_core::{Species, SpeciesTable};
use lennard_forcefield::{CombiningOptions, CutoffUnit, Deviation, Mixture, Size, SpeciesPair};

use crate::{Name, Scene, SceneError};

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
    /// σ_ab, in σ of the scene, where it is written.
    pub sigma: Option<f64>,
    /// ε_ab, in ε of the scene, where it is written.
    pub epsilon: Option<f64>,
    /// Deviation of ε_ab from the combining rule.
    pub k: Option<f64>,
    /// Deviation of σ_ab from the combining rule.
    pub l: Option<f64>,
    /// Its cutoff, in the unit of `truncation.r_cut`.
    pub r_cut: Option<f64>,
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
    fn size(&self, a: usize, b: usize) -> Option<Size> {
        let own =
            |a: usize| Size { sigma: self.species[a].sigma, epsilon: self.species[a].epsilon };
        if a == b {
            return Some(own(a));
        }
        let pair = self.pair(a, b);
        let deviation = pair.map_or(Deviation::default(), |p| Deviation { k: p.k, l: p.l });
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
    fn pair(&self, a: usize, b: usize) -> Option<&PairEntry> {
        let same = |p: &&PairEntry| p.species == [a, b] || p.species == [b, a];
        self.pairs.iter().find(same)
    }

    /// The species as a system has them.
    fn as_species(&self) -> Vec<Species> {
        let species = self.species.iter().map(|s| Species {
            name: s.name.to_string(),
            mass: s.mass,
            element: s.element.clone(),
        });
        species.collect()
    }
}

impl Scene {
    /// The species of a system, where `of_particle` has the species of each of `n` particles. A scene without species has one.
    #[must_use]
    pub fn species_table(&self, n: usize, of_particle: &[u8]) -> SpeciesTable {
        match &self.mixture {
            Some(mixture) if mixture.species.len() > 1 => {
                SpeciesTable::new(mixture.as_species(), of_particle)
            }
            Some(mixture) => SpeciesTable::one(mixture.as_species().swap_remove(0), n),
            None => self.one_species(n),
        }
    }

    /// The species of a system with these numbers of particles, one species after the other.
    #[must_use]
    pub fn species_in_order(&self, counts: &[usize]) -> SpeciesTable {
        let n = counts.iter().sum();
        let runs = counts.iter().enumerate();
        let of_particle: Vec<u8> = match counts.len() {
            1 => Vec::new(),
            _ => runs.flat_map(|(a, count)| std::iter::repeat_n(a as u8, *count)).collect(),
        };
        self.species_table(n, &of_particle)
    }

    /// `n` particles of the one species of a scene that names none.
    #[must_use]
    pub fn one_species(&self, n: usize) -> SpeciesTable {
        let species = Species { element: self.output.element.clone(), ..Species::unnamed() };
        SpeciesTable::one(species, n)
    }

    /// The scene with the shares that each species has in a system, in place of numbers of particles: it fits any size.
    #[must_use]
    pub fn with_shares_of(&self, species: &SpeciesTable) -> Self {
        let mut scene = self.clone();
        for (a, entry) in scene.mixture.iter_mut().flat_map(|m| m.species.iter_mut().enumerate()) {
            entry.amount = Amount::Fraction(species.fraction(a));
        }
        scene
    }

    /// The number of particles of each species among `n` on a lattice.
    ///
    /// # Errors
    /// [`SceneError`] where counts do not add up to `n`, or a species would have no particle.
    pub fn counts(&self, n: usize) -> Result<Vec<usize>, SceneError> {
        match &self.mixture {
            Some(mixture) => amounts::counts(self, mixture, n),
            None => Ok(vec![n]),
        }
    }

    /// σ, ε and cutoff of a pair of species. A scene without species has σ = ε = 1.
    ///
    /// # Panics
    /// Where the scene does not say them. Scenes from files were checked.
    #[must_use]
    pub fn species_pair(&self, a: usize, b: usize) -> SpeciesPair {
        let Some(mixture) = &self.mixture else {
            return SpeciesPair::unit(self.truncation.r_cut);
        };
        let size = mixture.size(a, b).expect("checked when the scene was read");
        let own = mixture.pair(a, b).and_then(|p| p.r_cut);
        let r_cut = own.unwrap_or(self.truncation.r_cut);
        SpeciesPair {
            sigma: size.sigma,
            epsilon: size.epsilon,
            r_cut: match self.truncation.r_cut_in {
                Some(CutoffUnit::Pair) => r_cut * size.sigma,
                Some(CutoffUnit::Sigma) | None => r_cut,
            },
        }
    }

    /// The pairs of species a ≤ b, by number.
    pub fn species_pairs(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let n = self.mixture.as_ref().map_or(1, |m| m.species.len());
        (0..n).flat_map(move |a| (a..n).map(move |b| [a, b]))
    }

    /// What the forces need of the species; `None` for a scene that names none.
    ///
    /// # Panics
    /// Where a parameter is out of range. Scenes from files were checked.
    #[must_use]
    pub fn mixture_of(&self, species: &SpeciesTable) -> Option<Mixture> {
        self.mixture.as_ref()?;
        let pair = |a, b| self.species_pair(a, b);
        let of_particle: Vec<u8> =
            (0..species.n_particles()).map(|i| species.of(i) as u8).collect();
        let mixture = Mixture::new(species.n_species(), pair, of_particle);
        Some(mixture.expect("checked when the scene was read"))
    }

    /// The cutoff of the fluid of one species that the scene describes, σ; `None` where species differ in more than their names.
    #[must_use]
    pub fn cutoff_of_one_fluid(&self) -> Option<f64> {
        let first = self.species_pair(0, 0);
        let alike = self
            .species_pairs()
            .all(|[a, b]| self.species_pair(a, b) == SpeciesPair::unit(first.r_cut));
        let species = self.mixture.iter().flat_map(|m| &m.species);
        let unit_masses = species.into_iter().all(|s| s.mass == 1.0);
        (alike && unit_masses).then_some(first.r_cut)
    }

    /// The mole fraction of each species; `None` where a configuration file has them.
    #[must_use]
    pub fn fractions(&self) -> Option<Vec<f64>> {
        let Some(mixture) = &self.mixture else {
            return Some(vec![1.0]);
        };
        let total = mixture.total_count().map_or(1.0, |n| n as f64);
        let fraction = |s: &SpeciesEntry| match s.amount {
            Amount::Fraction(x) => Some(x),
            Amount::Count(n) => Some(n as f64 / total),
            Amount::OfFile => None,
        };
        mixture.species.iter().map(fraction).collect()
    }

    /// The longest distance over which two particles interact, σ.
    #[must_use]
    pub fn longest_cutoff(&self) -> f64 {
        let own_end = self.potential.own_end();
        self.species_pairs()
            .map(|[a, b]| {
                let pair = self.species_pair(a, b);
                own_end.map_or(pair.r_cut, |end| end.r * pair.sigma)
            })
            .fold(0.0, f64::max)
    }

    /// The longest distance that a cutoff of 1 stands for where it is written, σ: the largest σ_ab where cutoffs are in σ_ab.
    #[must_use]
    pub fn cutoff_unit(&self) -> f64 {
        match (&self.mixture, self.truncation.r_cut_in) {
            (Some(_), Some(CutoffUnit::Pair)) => self.largest_sigma(),
            _ => 1.0,
        }
    }

    /// The largest σ_ab of all pairs of species, in σ.
    #[must_use]
    pub fn largest_sigma(&self) -> f64 {
        let sigmas = self.species_pairs();
        sigmas.map(|[a, b]| self.species_pair(a, b).sigma).fold(0.0, f64::max)
    }

    /// The species in words, at the end of a model's name: `species A and B, Lorentz–Berthelot`.
    pub(crate) fn species_in_words(&self) -> Option<String> {
        let mixture = self.mixture.as_ref()?;
        let names: Vec<&str> = mixture.species.iter().map(|s| s.name.as_str()).collect();
        let Some(rule) = mixture.rule.as_ref().filter(|_| names.len() > 1) else {
            return Some(format!("species {}", names.join(", ")));
        };
        let own = match mixture.pairs.len() {
            0 => String::new(),
            1 => ", 1 pair of its own".to_owned(),
            n => format!(", {n} pairs of their own"),
        };
        let title = rule.spec().title;
        Some(format!("species {} with {title} pairs{own}", names.join(", ")))
    }
}
