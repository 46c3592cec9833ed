//! What barostats do to a box and to what is in it.

use lennard_core::{DVec3, ForceError, State, System};

/// Multiplies the sides of the box.
///
/// # Errors
/// [`ForceError`] for a box without volume, or beyond all numbers: positions there are none.
pub(super) fn scale_box(state: &mut State, factors: DVec3) -> Result<(), ForceError> {
    let scaled = state.cell.scaled(factors);
    state.cell = scaled.map_err(|_| ForceError::NonFinitePosition { particle: 0 })?;
    Ok(())
}

/// Moves the sites of each molecule together, by what `change` gives for its number and its centre of mass.
/// `of_sites` are the positions or the velocities.
pub(super) fn move_centers(
    system: &System,
    of_sites: &mut [DVec3],
    change: impl Fn(usize, DVec3) -> DVec3 + Sync,
) {
    let molecules = &system.molecules;
    molecules.for_each(molecules.sites(), of_sites, |m, own| {
        let center = molecules.center(&system.masses, molecules.sites_of(m).start, own);
        let change = change(m, center);
        own.iter_mut().for_each(|site| *site += change);
    });
}
