//! Every loop against the reference loop, and the invariants that all of them share.

mod agreement;
mod all_pairs;
mod bad_numbers;
mod bits;
mod exclusions;
mod missing_pairs;
mod restarts;
mod shapes;

use crate::common::*;
use lennard_core::{
    Array, DVec3, ForceError, ForceTerm, Part, PeriodicBox, Persist, StateArchive, Want,
};
use lennard_forcefield::*;
use proptest::prelude::*;

/// Every form, tables among them.
fn forms() -> Vec<ForceFieldOptions> {
    let potentials = PotentialOptions::examples().into_iter();
    forms_of(potentials.chain([table()]).collect())
}

fn want_each() -> Want {
    Want { per_particle: true, virial_tensor: true, ..Want::TOTALS }
}

/// Moves every particle a little, each in its own direction.
fn moved(positions: &[DVec3], by: f64) -> Vec<DVec3> {
    let shake = scatter(positions.len(), DVec3::splat(2.0), 0.7);
    positions
        .iter()
        .zip(&shake)
        .map(|(r, s)| *r + (*s - DVec3::ONE).normalize_or_zero() * by)
        .collect()
}

/// Checks every force of a kernel against the sum over all pairs, within its tolerance.
fn one_by_one(
    options: &ForceFieldOptions,
    mixture: Option<&Mixture>,
    cell: PeriodicBox,
    positions: &[DVec3],
    found: &[DVec3],
) -> Result<(), TestCaseError> {
    let all_pairs = AllPairs::new(options, mixture).unwrap();
    for (i, f) in found.iter().enumerate() {
        let wanted = all_pairs.force_on(i, &cell, positions);
        let off = (*f - wanted.force).length();
        prop_assert!(off <= wanted.tolerance, "{options:?}: {f} against {wanted:?}");
    }
    Ok(())
}
