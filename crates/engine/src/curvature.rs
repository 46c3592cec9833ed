//! Second derivatives of the pair potential that no pair loop sums: Σ r²u″ from energy and virial, and what the end of the potential
//! adds.

use lennard_core::SpeciesTable;
use lennard_forcefield::{Model, Pair, TruncationKind};
use lennard_observables::{Curvature, PairEnd};
use lennard_scene::Scene;

use crate::EngineError;
use crate::error::misfit;

/// Distances in σ at which the line is found and checked; all lie inside any cutoff, or the model has none.
const DISTANCES: [f64; 6] = [0.85, 0.95, 1.0, 1.2, 1.5, 2.0];
/// Rounding of a sum of two powers.
const ROUNDING: f64 = 1e-9;

/// The line r²u″ = a·(−r u′) − b·u of the scene's potential, which holds for Mie potentials and powers; `None` for other
/// potentials, and for truncations that bend the potential.
pub(crate) fn curvature(scene: &Scene) -> Result<Option<Curvature>, EngineError> {
    // What acts across the surfaces is no sum over pairs.
    if scene.planar_tail {
        return Ok(None);
    }
    let truncation = &scene.truncation;
    if !matches!(truncation.kind, TruncationKind::Cut | TruncationKind::Shift) {
        return Ok(None);
    }
    let mut plain = *truncation;
    plain.kind = TruncationKind::Cut;
    let plain = Model::new(&scene.potential, &plain).map_err(|e| misfit(&scene.source, &e))?;
    let inside = DISTANCES.iter().filter(|r| **r <= plain.r_cut);
    let values: Vec<[f64; 3]> = inside.map(|r| in_three(plain.eval(r * r), *r)).collect();
    Ok(line(&values).map(|[of_virial, of_energy]| Curvature {
        of_virial,
        of_energy,
        of_truncated: !truncation.tail_correction,
    }))
}

/// −r u′, u and r²u″.
fn in_three(pair: Pair<f64>, r: f64) -> [f64; 3] {
    [pair.force * r * r, pair.energy, pair.curvature * r * r]
}

/// a and b of x = a·w − b·u through all values; `None` where no such line goes through them.
fn line(values: &[[f64; 3]]) -> Option<[f64; 2]> {
    let [first, .., last] = values else {
        return None;
    };
    let determinant = first[1] * last[0] - first[0] * last[1];
    let size = (first[1] * last[0]).abs() + (first[0] * last[1]).abs();
    let [a, b] = if determinant.abs() > ROUNDING * size {
        [
            (first[1] * last[2] - first[2] * last[1]) / determinant,
            (first[0] * last[2] - first[2] * last[0]) / determinant,
        ]
    } else {
        // One power: u is itself a part of w.
        [first[2] / first[0], 0.0]
    };
    let fits = |[w, u, x]: &[f64; 3]| {
        (x - a * w + b * u).abs() <= ROUNDING * (x.abs() + (a * w).abs() + (b * u).abs())
    };
    values.iter().all(fits).then_some([a, b])
}

/// The ends of all pairs of species, row by row, `[species]²`. The force of plain and shifted cutoffs drops to zero with a jump; a
/// shift takes U(r_cut) off the energy of each pair.
pub(crate) fn pair_ends(
    scene: &Scene,
    species: &SpeciesTable,
) -> Result<Vec<PairEnd>, EngineError> {
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

    fn of(settings: &[(&str, &str)]) -> Option<Curvature> {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let settings: Vec<(String, String)> =
            settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        let scene = Scene::load(&root.join("inputs/fluid/gas.toml"), &settings).unwrap();
        curvature(&scene).unwrap()
    }

    #[test]
    fn powers_have_a_line_and_other_potentials_have_none() {
        let is = |found: Option<Curvature>, a: f64, b: f64| {
            let found = found.unwrap();
            assert!((found.of_virial - a).abs() < 1e-6, "{found:?}");
            assert!((found.of_energy - b).abs() < 1e-6, "{found:?}");
            found
        };
        let full = is(of(&[]), 19.0, 72.0);
        assert!(!full.of_truncated);
        is(of(&[("potential", "{ kind = \"mie\", repulsive = 14, attractive = 7 }")]), 22.0, 98.0);
        is(of(&[("potential", "{ kind = \"soft-sphere\", exponent = 12 }")]), 13.0, 0.0);
        let shifted = is(of(&[("truncation", "{ kind = \"shift\", r_cut = 2.5 }")]), 19.0, 72.0);
        assert!(shifted.of_truncated);
        assert_eq!(of(&[("truncation", "{ kind = \"force-shift\", r_cut = 2.5 }")]), None);
        assert_eq!(of(&[("potential", "{ kind = \"wca\" }"), ("truncation", "{}")]), None);
    }

    fn ends_of(scene: &str, settings: &[(&str, &str)]) -> Vec<PairEnd> {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let settings: Vec<(String, String)> =
            settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        let scene = Scene::load(&root.join("inputs").join(scene), &settings).unwrap();
        let species = match &scene.mixture {
            None => scene.one_species(4),
            Some(_) => scene.species_in_order(&[3, 1]),
        };
        pair_ends(&scene, &species).unwrap()
    }

    fn close(end: PairEnd, expected: [f64; 3]) {
        for (found, expected) in [end.r_cut, end.slope, end.shift].iter().zip(expected) {
            assert!((found - expected).abs() <= 1e-8 * expected.abs(), "{end:?} {expected}");
        }
    }

    #[test]
    fn each_pair_of_species_ends_with_the_slope_and_the_shift_of_its_own_potential() {
        // At 2.5 σ_ab.
        let (slope, shift) = (0.038_999_477_453, -0.016_316_891_136);
        let ends = ends_of("mixture/kob-andersen.toml", &[]);
        for (end, [sigma, epsilon]) in
            ends.iter().zip([[1.0, 1.0], [0.8, 1.5], [0.8, 1.5], [0.88, 0.5]])
        {
            close(*end, [2.5 * sigma, slope * epsilon / sigma, shift * epsilon]);
        }
        let cut = ends_of("fluid/gas.toml", &[("truncation", "{ kind = \"cut\", r_cut = 2.5 }")]);
        close(cut[0], [2.5, slope, 0.0]);
        for (potential, truncation) in [
            ("lennard-jones", "{ kind = \"force-shift\", r_cut = 2.5 }"),
            ("lennard-jones", "{ kind = \"switch\", r_cut = 2.5, switch_from = 2.0 }"),
            ("wca", "{}"),
        ] {
            let potential = format!("{{ kind = \"{potential}\" }}");
            let found =
                ends_of("fluid/gas.toml", &[("potential", &potential), ("truncation", truncation)]);
            assert!(found[0].slope == 0.0 && found[0].shift == 0.0, "{found:?}");
        }
    }
}
