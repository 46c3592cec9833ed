//! Which particles the dynamic correlations follow.

use lennard_core::{DVec3, Own, SpeciesTable, System};

/// The largest number of particles that are followed unless the scene says otherwise. The histories of
/// more of them would take more memory than the run itself; the error of D falls only as 1/√(particles).
pub(crate) const DEFAULT_TRACKED: usize = 16_384;

/// An evenly spread subset of the particles: `count` of `n`, all where `count ≥ n`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tracked {
    /// Those that this process keeps, as indices of the arrays of the state.
    indices: Vec<u32>,
    /// Which places among the particles that are followed they have.
    pub(crate) own: Own,
    n: usize,
}

/// The particles of one species.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Members {
    /// Number of the species.
    pub number: usize,
    /// What the names of results end with.
    pub suffix: String,
    /// Places among the particles that are followed here.
    pub members: Vec<usize>,
    /// How many are followed on all ranks.
    pub count: usize,
}

impl Members {
    /// The name of a column of the species.
    pub(crate) fn named(&self, of: &str) -> String {
        format!("{of}{}", self.suffix)
    }
}

impl Tracked {
    pub(crate) fn new(own: &Own, count: usize) -> Self {
        let n = own.all();
        let count = count.min(n);
        // Particle ⌊k·n/count⌋ has the place k.
        let place = |number: usize| (number * count).div_ceil(n.max(1)).min(count);
        let places = place(own.first())..place(own.numbers().end);
        let index = |k: usize| (k * n / count.max(1) - own.first()) as u32;
        Self { indices: places.clone().map(index).collect(), own: own.some(places, count), n }
    }

    /// Number of particles that are followed, on all ranks.
    pub(crate) fn len(&self) -> usize {
        self.own.all()
    }

    /// The particles of each species of a mixture. A species of which no particle is followed is left out; one species alone gives
    /// nothing.
    pub(crate) fn by_species(&self, species: &SpeciesTable) -> Vec<Members> {
        let mut members = vec![Vec::new(); species.n_species()];
        if species.is_mixture() {
            for (place, i) in self.indices.iter().enumerate() {
                members[species.of(*i as usize)].push(place);
            }
        }
        let all = members.into_iter().enumerate().map(|(number, members)| {
            let suffix = format!("_{}", species.name(number));
            Members { number, suffix, count: self.own.count(members.len()), members }
        });
        all.filter(|members| members.count > 0).collect()
    }

    /// A remark where not every particle is followed.
    pub(crate) fn remark(&self) -> Option<String> {
        (self.len() < self.n).then(|| {
            format!(
                "averaged over {} of {} particles, evenly chosen, to bound the memory",
                self.len(),
                self.n
            )
        })
    }

    /// `values[i] − mean` for the particles followed. The mean is over all particles, weighted by
    /// mass, since the motion of the whole system is no diffusion.
    pub(crate) fn relative_to_centre_of_mass(
        &self,
        system: &System,
        values: &[DVec3],
    ) -> Vec<DVec3> {
        let masses = &system.masses;
        let weighted: DVec3 = system.sum(|i| masses.moving(i) * values[i]);
        let total: f64 = system.sum(|i| masses.moving(i));
        let mean = weighted / total;
        self.indices.iter().map(|&i| values[i as usize] - mean).collect()
    }
}

/// Σ over particles of `pair(a_i, b_i)`, an exact total over all ranks.
pub(crate) fn sum_over_pairs(
    own: &Own,
    a: &[DVec3],
    b: &[DVec3],
    pair: impl Fn(DVec3, DVec3) -> f64 + Sync,
) -> f64 {
    own.sum(a.len(), |i| pair(a[i], b[i]))
}

/// The mean of `pair(a_i, b_i)` over the places i of a species, by an exact total over all ranks.
pub(crate) fn mean_over_members(
    own: &Own,
    Members { members, count, .. }: &Members,
    a: &[DVec3],
    b: &[DVec3],
    pair: impl Fn(DVec3, DVec3) -> f64 + Sync,
) -> f64 {
    let sum: f64 = own.sum(members.len(), |k| pair(a[members[k]], b[members[k]]));
    sum / *count as f64
}
