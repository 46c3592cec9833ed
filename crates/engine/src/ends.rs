//! Where the potential of each pair of species ends, and what no pair loop sees of it.

use lennard_core::SpeciesTable;
use lennard_forcefield::{Model, TruncationKind};
use lennard_observables::PairEnd;
use lennard_scene::Scene;

use crate::EngineError;
use crate::error::misfit;

/// The ends of all pairs of species, row by row, `[species]²`. The force of plain and shifted cutoffs drops to zero with a jump; a
/// shift takes U(r_cut) off the energy of each pair.
pub(crate) fn of_pairs(scene: &Scene, species: &SpeciesTable) -> Result<Vec<PairEnd>, EngineError> {
    let n = species.n_species();
    let end = |k: usize| {
        let pair = scene.species_pair(k / n, k % n);
        let mut own = scene.truncation.at_cutoff(pair.r_cut / pair.sigma);
        let is_shifted = own.kind == TruncationKind::Shift;
        if is_shifted {
            own.kind = TruncationKind::Cut;
        }
        let model = Model::new(&scene.potential, &own).map_err(|e| misfit(&scene.source, &e))?;
        let last = model.eval(model.r_cut * model.r_cut);
        Ok(PairEnd {
            r_cut: model.r_cut * pair.sigma,
            slope: -last.force * model.r_cut * pair.epsilon / pair.sigma,
            shift: if is_shifted {
                last.energy * pair.epsilon
            } else {
                0.0
            },
        })
    };
    (0..n * n).map(end).collect()
}
