//! Whether Σ r²u″ of a scene follows from energy and virial, so that no sum over pairs is needed for it.

use lennard_forcefield::{Model, Pair, TruncationKind};
use lennard_observables::Curvature;
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

#[cfg(test)]
mod tests {
    use super::*;

    fn of(settings: &[(&str, &str)]) -> Option<Curvature> {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let settings: Vec<(String, String)> = settings
            .iter()
            .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
            .collect();
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
        is(
            of(&[(
                "potential",
                "{ kind = \"mie\", repulsive = 14, attractive = 7 }",
            )]),
            22.0,
            98.0,
        );
        is(
            of(&[("potential", "{ kind = \"soft-sphere\", exponent = 12 }")]),
            13.0,
            0.0,
        );
        let shifted = is(
            of(&[("truncation", "{ kind = \"shift\", r_cut = 2.5 }")]),
            19.0,
            72.0,
        );
        assert!(shifted.of_truncated);
        assert_eq!(
            of(&[("truncation", "{ kind = \"force-shift\", r_cut = 2.5 }")]),
            None
        );
        assert_eq!(
            of(&[("potential", "{ kind = \"wca\" }"), ("truncation", "{}")]),
            None
        );
    }
}
