//! Bodies: at what distance two of them touch, and which pairs may: all of few bodies, and a list of many.

use lennard_core::{DVec3, Exclusions, Masses, PeriodicBox, SpeciesTable};
use lennard_neighbor::{Images, NeighborList, PairList, Positions, ScalarScanner};

/// The contact distance of each pair of bodies, and the pairs that never touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Bodies {
    species: Option<SpeciesTable>,
    /// Contact distance of each pair of species, σ; one number where the particles are alike.
    distances: Vec<f64>,
    exclusions: Exclusions,
}

impl Bodies {
    /// Equal spheres of a diameter, σ.
    #[must_use]
    pub fn alike(diameter: f64, exclusions: Exclusions) -> Self {
        Self { species: None, distances: vec![diameter], exclusions }
    }

    /// Bodies of several species, where `distance(a, b)` is the contact distance of two of them, σ.
    #[must_use]
    pub fn of_species(
        species: SpeciesTable,
        distance: impl Fn(usize, usize) -> f64,
        exclusions: Exclusions,
    ) -> Self {
        let n = species.n_species();
        Self {
            distances: (0..n * n).map(|k| distance(k / n, k % n)).collect(),
            species: Some(species),
            exclusions,
        }
    }

    /// The contact distance of two particles, σ.
    #[inline]
    #[must_use]
    pub fn distance(&self, i: usize, j: usize) -> f64 {
        match &self.species {
            None => self.distances[0],
            Some(species) => self.distances[species.of(i) * species.n_species() + species.of(j)],
        }
    }

    /// The largest contact distance, σ.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.distances.iter().copied().fold(0.0, f64::max)
    }

    /// The pairs that never touch: the ends of bonds.
    #[must_use]
    pub fn exclusions(&self) -> &Exclusions {
        &self.exclusions
    }
}

/// The reduced mass of two bodies; `None` where both are held, which nothing moves.
pub(crate) fn reduced_mass(masses: &Masses, i: usize, j: usize) -> Option<f64> {
    (!(masses.is_held(i) && masses.is_held(j))).then(|| masses.reduced(i, j))
}

/// Up to so many bodies, all pairs cost less than a list.
const FEW: usize = 48;
/// The skin of a list, as a share of the largest contact distance.
const SKIN: f64 = 0.3;

/// Pairs (i, j) with i < j, ascending, among which are all that are nearer than a radius.
///
/// What is computed must not depend on pairs that do not touch: the time of a build is no part of the state.
#[derive(Debug, Clone)]
pub struct NearPairs {
    pairs: Vec<[usize; 2]>,
    list: NeighborList,
    /// Box and positions of the last build; `None` before it.
    built: Option<(PeriodicBox, Vec<DVec3>)>,
    /// What the list holds beyond the largest contact distance, σ.
    skin: f64,
}

impl NearPairs {
    /// No pairs yet.
    #[must_use]
    pub fn of(bodies: &Bodies) -> Self {
        Self {
            pairs: Vec::new(),
            list: NeighborList::new(Images::Folded, 1).excluding(*bodies.exclusions()),
            built: None,
            skin: 0.0,
        }
    }

    /// The pairs that may touch at these positions, or while each body moves by at most `travel` σ from there.
    pub fn at(
        &mut self,
        bodies: &Bodies,
        cell: &PeriodicBox,
        positions: &[DVec3],
        travel: f64,
    ) -> &[[usize; 2]] {
        if !self.still_holds(cell, positions, travel) {
            self.build(bodies, cell, positions, travel);
        }
        &self.pairs
    }

    fn still_holds(&self, cell: &PeriodicBox, positions: &[DVec3], travel: f64) -> bool {
        let Some((built_in, built_at)) = &self.built else {
            return false;
        };
        if positions.len() <= FEW {
            return true;
        }
        let moved = positions.iter().zip(built_at);
        let farthest = moved.map(|(now, then)| (*now - *then).length_squared());
        let farthest = farthest.fold(0.0, f64::max).sqrt();
        built_in == cell && 2.0 * (farthest + travel) < self.skin
    }

    fn build(&mut self, bodies: &Bodies, cell: &PeriodicBox, positions: &[DVec3], travel: f64) {
        self.pairs.clear();
        let n = positions.len();
        self.skin = SKIN.max(3.0 * travel / bodies.largest()) * bodies.largest();
        let radius = bodies.largest() + self.skin;
        let all = |pairs: &mut Vec<[usize; 2]>| {
            let ordered = (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j]));
            pairs.extend(ordered.filter(|[i, j]| !bodies.exclusions().exclude(*i, *j)));
        };
        if n <= FEW || radius > cell.largest_cutoff() {
            all(&mut self.pairs);
        } else {
            let ordered = Positions::ById(positions);
            match self.list.build(cell, radius, ordered, &ScalarScanner) {
                Ok(()) => {
                    for (i, neighbors) in (0..).zip(self.list.neighbors()) {
                        let later = neighbors.into_iter().map(|j| j as usize).filter(|j| *j > i);
                        self.pairs.extend(later.map(|j| [i, j]));
                    }
                }
                // Positions that are no numbers have no neighbors; the forces refuse them.
                Err(_) => all(&mut self.pairs),
            }
        }
        self.built = Some((*cell, positions.to_vec()));
    }
}
