//! Centres of mass that the conserved momentum takes from a run.

use lennard_core::Molecules;

/// The number of centres of mass less a third of their degrees of freedom: 1 where the total momentum is zero, 0 where it is thermal.
pub(super) fn missing_centers(sites: u64, n_dof: u64, molecules: &Molecules) -> f64 {
    let rigid = match molecules.are_rigid() {
        true => sites / molecules.sites() as u64 * molecules.bonds().len() as u64,
        false => 0,
    };
    sites as f64 - (n_dof + rigid) as f64 / 3.0
}

#[cfg(test)]
mod tests {
    use lennard_core::Bonds;

    use super::*;

    #[test]
    fn one_center_is_missing_without_total_momentum_whatever_the_bonds() {
        assert_eq!(missing_centers(864, 3 * 864 - 3, &Molecules::ATOMS), 1.0);
        assert_eq!(missing_centers(864, 3 * 864, &Molecules::ATOMS), 0.0);
        let chains = |bonds| Molecules::chains(3, 1.0, bonds);
        assert_eq!(missing_centers(300, 900 - 200 - 3, &chains(Bonds::Rigid)), 1.0);
        assert_eq!(missing_centers(300, 900 - 3, &chains(Bonds::Springs)), 1.0);
    }
}
