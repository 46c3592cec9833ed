//! Which particles the dynamic correlations follow.

use lennard_core::exact::exact_sum;
use lennard_core::{DVec3, SpeciesTable, System};

/// The largest number of particles that are followed unless the scene says otherwise. The histories of
/// more of them would take more memory than the run itself; the error of D falls only as 1/√(particles).
pub(crate) const DEFAULT_TRACKED: usize = 16_384;

/// An evenly spread subset of the particles: `count` of `n`, all where `count ≥ n`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tracked {
    indices: Vec<u32>,
    n: usize,
}

/// The particles of one species.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Members {
    /// Number of the species.
    pub number: usize,
    /// What the names of results end with.
    pub suffix: String,
    /// Places among the particles that are followed.
    pub members: Vec<usize>,
}

impl Members {
    /// The name of a column of the species.
    pub(crate) fn named(&self, of: &str) -> String {
        format!("{of}{}", self.suffix)
    }
}

impl Tracked {
    pub(crate) fn new(n: usize, count: usize) -> Self {
        let count = count.min(n);
        let indices = (0..count).map(|k| (k * n / count.max(1)) as u32).collect();
        Self { indices, n }
    }

    pub(crate) fn len(&self) -> usize {
        self.indices.len()
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
        let all = members.into_iter().enumerate().filter(|(_, members)| !members.is_empty());
        all.map(|(number, members)| {
            let suffix = format!("_{}", species.name(number));
            Members { number, suffix, members }
        })
        .collect()
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
        let weighted: DVec3 = exact_sum(values.len(), |i| masses.moving(i) * values[i]);
        let total: f64 = exact_sum(values.len(), |i| masses.moving(i));
        let mean = weighted / total;
        self.indices.iter().map(|&i| values[i as usize] - mean).collect()
    }
}

/// Σ over particles of `pair(a_i, b_i)`, an exact total.
pub(crate) fn sum_over_pairs(
    a: &[DVec3],
    b: &[DVec3],
    pair: impl Fn(DVec3, DVec3) -> f64 + Sync,
) -> f64 {
    exact_sum(a.len(), |i| pair(a[i], b[i]))
}

/// The mean of `pair(a_i, b_i)` over some places i, by an exact total.
pub(crate) fn mean_over_members(
    members: &[usize],
    a: &[DVec3],
    b: &[DVec3],
    pair: impl Fn(DVec3, DVec3) -> f64 + Sync,
) -> f64 {
    let sum: f64 = exact_sum(members.len(), |k| pair(a[members[k]], b[members[k]]));
    sum / members.len() as f64
}
