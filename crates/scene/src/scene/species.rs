//! The species of a scene and what acts between them.

use lennard_core::{Species, SpeciesTable};
use lennard_forcefield::{CutoffUnit, ForceFieldError, Mixture, SpeciesPair};

use crate::{Amount, MixtureTables, Scene, SceneError, SpeciesEntry};

/// The particles of each species among `n`.
///
/// Fractions give N·x_a, rounded so that the numbers add up to N: species with the largest remainders get the particles
/// that are left.
fn counts(scene: &Scene, mixture: &MixtureTables, n: usize) -> Result<Vec<usize>, SceneError> {
    let exact: Vec<f64> = mixture
        .species
        .iter()
        .map(|s| match s.amount {
            Amount::Fraction(x) => x * n as f64,
            Amount::Count(count) => count as f64,
            Amount::OfFile => f64::NAN,
        })
        .collect();
    let mut counts: Vec<usize> = exact.iter().map(|x| x.floor() as usize).collect();
    let is_counted = mixture.species.iter().all(|s| matches!(s.amount, Amount::Count(_)));
    if is_counted {
        return add_up(scene, counts, n);
    }
    let mut by_remainder: Vec<usize> = (0..counts.len()).collect();
    // A stable sort: of equal remainders the first species has the particle.
    by_remainder.sort_by(|a, b| {
        let remainder = |a: usize| exact[a] - exact[a].floor();
        remainder(*b).total_cmp(&remainder(*a))
    });
    let left = n.saturating_sub(counts.iter().sum());
    for a in by_remainder.into_iter().cycle().take(left) {
        counts[a] += 1;
    }
    match counts.iter().position(|count| *count == 0) {
        None => Ok(counts),
        Some(a) => Err(scene
            .refuse(&format!("species.{a}.fraction"), "leaves no particle")
            .found(format!("{} of {n} particles", exact[a] / n as f64))
            .allowed("a share of at least one particle, or more particles")),
    }
}

fn add_up(scene: &Scene, counts: Vec<usize>, n: usize) -> Result<Vec<usize>, SceneError> {
    let sum: usize = counts.iter().sum();
    if sum == n {
        return Ok(counts);
    }
    let each: Vec<String> = counts.iter().map(ToString::to_string).collect();
    Err(scene
        .refuse("system.n_atoms", "disagrees with the counts of the species")
        .found(format!("{n}, where {} = {sum}", each.join(" + ")))
        .allowed(format!("{sum}, or counts that add up to {n}")))
}

impl Scene {
    /// A force field that does not fit, on the line that it is about. A cutoff that a table `[[pair]]` gives is on the line of that table.
    #[must_use]
    pub fn misfit(&self, error: &ForceFieldError) -> SceneError {
        let ForceFieldError::CutoffOverHalfBox { r_cut, .. } = error else {
            return self.misfit_of(&error.key(), error);
        };
        let mut pairs = self.mixture.iter().flat_map(|m| &m.pairs);
        let own = pairs.position(|pair| {
            let [a, b] = pair.species;
            pair.keys.r_cut.is_some() && self.species_pair(a, b).r_cut == *r_cut
        });
        let key = own.map_or_else(|| error.key(), |pair| format!("pair.{pair}.r_cut"));
        self.misfit_of(&key, error)
    }

    fn misfit_of(&self, key: &str, error: &ForceFieldError) -> SceneError {
        let refused = self.refuse(key, error.problem());
        refused.found(error.found()).allowed(error.allowed())
    }

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
            Some(mixture) => counts(self, mixture, n),
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
