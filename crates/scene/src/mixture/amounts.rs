//! How many particles of each species a start has.

use super::{Amount, MixtureTables};
use crate::{Scene, SceneError};

/// The particles of each species among `n`.
///
/// Fractions give N·x_a, rounded so that the numbers add up to N: species with the largest remainders get the particles
/// that are left.
pub(super) fn counts(
    scene: &Scene,
    mixture: &MixtureTables,
    n: usize,
) -> Result<Vec<usize>, SceneError> {
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
            .source
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
        .source
        .refuse("system.n_atoms", "disagrees with the counts of the species")
        .found(format!("{n}, where {} = {sum}", each.join(" + ")))
        .allowed(format!("{sum}, or counts that add up to {n}")))
}
