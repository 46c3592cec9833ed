//! The jump of the force at the cutoff, which no pair loop sees.

use lennard_core::SpeciesTable;
use lennard_forcefield::{Model, TruncationOptions};
use lennard_scene::Scene;

use crate::EngineError;
use crate::error::misfit;

/// U′(r_cut) just inside the cutoff, where the force drops to zero with a jump (plain and shifted cutoffs); zero where the
/// force is continuous.
///
/// In a mixture it is the number that stands for all pairs: Σ_ab x_a·x_b·r_ab²·U′_ab(r_ab) over ordered pairs of species, in
/// units of r², where r_ab is the cutoff of a pair and r the longest one.
pub(crate) fn of_force(scene: &Scene, species: &SpeciesTable) -> Result<f64, EngineError> {
    let slope = |truncation: &TruncationOptions| -> Result<f64, EngineError> {
        let model =
            Model::new(&scene.potential, truncation).map_err(|e| misfit(&scene.source, &e))?;
        let pair = model.eval(model.r_cut * model.r_cut);
        Ok(-pair.force * model.r_cut)
    };
    let own = &scene.truncation;
    if scene.mixture.is_none() {
        return slope(own);
    }
    let longest = scene.longest_cutoff();
    let mut sum = 0.0;
    for [a, b] in scene.species_pairs() {
        let pair = scene.species_pair(a, b);
        let in_own_units = own.at_cutoff(pair.r_cut / pair.sigma);
        let order = if a == b { 1.0 } else { 2.0 };
        let share = order * species.fraction(a) * species.fraction(b);
        let slope = slope(&in_own_units)? * pair.epsilon / pair.sigma;
        sum += share * (pair.r_cut / longest).powi(2) * slope;
    }
    Ok(sum)
}
