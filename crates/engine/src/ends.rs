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
    let is_shifted = scene.truncation.kind == TruncationKind::Shift;
    let jumps = scene.potential.own_end().is_none()
        && (is_shifted || scene.truncation.kind == TruncationKind::Cut);
    let if_true = |condition: bool, value: f64| if condition { value } else { 0.0 };
    let end = |k: usize| {
        let pair = scene.species_pair(k / n, k % n);
        let mut own = scene.truncation.at_cutoff(pair.r_cut / pair.sigma);
        if is_shifted {
            own.kind = TruncationKind::Cut;
        }
        let model = Model::new(&scene.potential, &own).map_err(|e| misfit(&scene.source, &e))?;
        let last = model.eval(model.r_cut * model.r_cut);
        Ok(PairEnd {
            r_cut: model.r_cut * pair.sigma,
            slope: if_true(jumps, -last.force * model.r_cut * pair.epsilon / pair.sigma),
            shift: if_true(jumps && is_shifted, last.energy * pair.epsilon),
        })
    };
    (0..n * n).map(end).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(scene: &str, settings: &[(&str, &str)]) -> Vec<PairEnd> {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let settings: Vec<(String, String)> = settings
            .iter()
            .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
            .collect();
        let scene = Scene::load(&root.join("inputs").join(scene), &settings).unwrap();
        let species = match &scene.mixture {
            None => scene.one_species(4),
            Some(_) => scene.species_in_order(&[3, 1]),
        };
        of_pairs(&scene, &species).unwrap()
    }

    fn close(end: PairEnd, expected: [f64; 3]) {
        for (found, expected) in [end.r_cut, end.slope, end.shift].iter().zip(expected) {
            assert!(
                (found - expected).abs() <= 1e-8 * expected.abs(),
                "{end:?} {expected}"
            );
        }
    }

    #[test]
    fn each_pair_of_species_ends_with_the_slope_and_the_shift_of_its_own_potential() {
        // At 2.5 σ_ab.
        let (slope, shift) = (0.038_999_477_453, -0.016_316_891_136);
        let ends = of("mixture/kob-andersen.toml", &[]);
        for (end, [sigma, epsilon]) in
            ends.iter()
                .zip([[1.0, 1.0], [0.8, 1.5], [0.8, 1.5], [0.88, 0.5]])
        {
            close(
                *end,
                [2.5 * sigma, slope * epsilon / sigma, shift * epsilon],
            );
        }
        let cut = of(
            "fluid/gas.toml",
            &[("truncation", "{ kind = \"cut\", r_cut = 2.5 }")],
        );
        close(cut[0], [2.5, slope, 0.0]);
        for (potential, truncation) in [
            ("lennard-jones", "{ kind = \"force-shift\", r_cut = 2.5 }"),
            (
                "lennard-jones",
                "{ kind = \"switch\", r_cut = 2.5, switch_from = 2.0 }",
            ),
            ("wca", "{}"),
        ] {
            let potential = format!("{{ kind = \"{potential}\" }}");
            let found = of(
                "fluid/gas.toml",
                &[("potential", &potential), ("truncation", truncation)],
            );
            assert!(found[0].slope == 0.0 && found[0].shift == 0.0, "{found:?}");
        }
    }
}
