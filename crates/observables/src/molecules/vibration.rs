//! The motion of a molecule that changes the lengths of its bonds.

use lennard_core::{DVec3, Masses, Topology};

/// A pivot below this share of its diagonal belongs to a bond that follows from the others.
const LEAST_PIVOT: f64 = 1e-9;

/// The kinetic energy of a molecule in motion that changes bond lengths, ½·uᵀA⁻¹u with u = G·v and A = G·M⁻¹·Gᵀ, and the rank of A.
///
/// The rows of G are the unit vectors of bonds. A is eliminated as L·D·Lᵀ, so that the energy is ½·Σ y²/D with L·y = u.
pub(super) fn vibration(
    topology: &Topology,
    masses: &Masses,
    first: usize,
    x: &[DVec3],
    v: &[DVec3],
) -> [f64; 2] {
    let (bonds, n) = (topology.bonds(), topology.bonds().len());
    let inverse = |site: usize| 1.0 / masses.of(first + site);
    let units: Vec<DVec3> = bonds.iter().map(|b| b.vector(x).normalize()).collect();
    let kappa = |c: usize| -> f64 { bonds[c].sites.into_iter().map(inverse).sum() };
    let mut a = vec![0.0; n * n];
    for c in 0..n {
        a[c * n + c] = kappa(c);
    }
    for coupling in topology.couplings() {
        let [c, d] = coupling.bonds;
        let element = coupling.sign * units[c].dot(units[d]) * inverse(coupling.site);
        a[c.max(d) * n + c.min(d)] = element;
    }
    let rates = bonds.iter().zip(&units);
    let mut y: Vec<f64> = rates.map(|(b, unit)| unit.dot(b.vector(v))).collect();
    let [mut energy, mut rank] = [0.0; 2];
    for c in 0..n {
        let pivot = a[c * n + c];
        if pivot > LEAST_PIVOT * kappa(c) {
            energy += 0.5 * y[c] * y[c] / pivot;
            rank += 1.0;
            for r in c + 1..n {
                let share = a[r * n + c] / pivot;
                if share != 0.0 {
                    y[r] -= share * y[c];
                    for s in c + 1..=r {
                        a[r * n + s] -= share * a[s * n + c];
                    }
                }
            }
        }
    }
    [energy, rank]
}

#[cfg(test)]
mod tests {
    use super::*;
    use lennard_core::{Bond, Bonds, Molecules, System, rigid};
    use std::sync::Arc;

    fn wave(i: usize, shift: f64) -> DVec3 {
        let t = shift + 1.7 * i as f64;
        DVec3::new(t.sin(), (2.3 * t).cos(), (0.9 * t - 1.0).sin())
    }

    /// Sites anywhere, velocities anywhere, and unlike masses.
    fn sites(n: usize) -> (Vec<DVec3>, Vec<DVec3>, Masses) {
        let at = |shift| (0..n).map(|i| wave(i, shift)).collect();
        let masses = (0..n).map(|i| 1.0 + 0.4 * i as f64).collect();
        (at(0.3), at(5.1), Masses::Each(masses))
    }

    fn joined(x: &[DVec3], pairs: &[[usize; 2]]) -> Topology {
        let bonds = pairs
            .iter()
            .map(|sites| Bond { sites: *sites, length: (x[sites[1]] - x[sites[0]]).length() });
        Topology::new(x.len(), bonds.collect()).unwrap()
    }

    /// What rigid bonds would take off is the vibration.
    #[test]
    fn vibration_is_the_kinetic_energy_that_rigid_bonds_take_off() {
        let chain: Vec<[usize; 2]> = (1..9).map(|k| [k - 1, k]).collect();
        let ring = [[0, 1], [1, 2], [3, 2], [0, 3], [4, 3]];
        for (n, pairs) in [(2, &chain[..1]), (9, &chain[..]), (5, &ring[..])] {
            let (x, v, masses) = sites(n);
            let topology = joined(&x, pairs);
            let [energy, rank] = vibration(&topology, &masses, 0, &x, &v);
            let molecules = Molecules::new(Arc::new(topology), Bonds::Rigid);
            let mut system = System::of_molecules(n, molecules);
            system.masses = masses;
            let before = system.kinetic_energy(&v);
            let mut v = v;
            rigid::project_velocities(&system, &x, &mut v);
            let taken = before - system.kinetic_energy(&v);
            assert!((energy / taken - 1.0).abs() < 1e-12, "{energy} {taken}");
            assert_eq!(rank, pairs.len() as f64);
            assert!(taken > 0.05 * before, "{taken} of {before}");
        }
    }

    /// All pairs of five sites are ten bonds with nine independent lengths; of four sites in a plane, six bonds with five.
    #[test]
    fn bonds_that_follow_from_others_add_no_vibration() {
        let all = |n: usize| -> Vec<[usize; 2]> {
            (0..n).flat_map(|i| (0..i).map(move |j| [j, i])).collect()
        };
        let (x, v, masses) = sites(5);
        let [energy, rank] = vibration(&joined(&x, &all(5)), &masses, 0, &x, &v);
        assert_eq!(rank, 9.0);
        let fewer = joined(&x, &all(5)[..9]);
        let [of_fewer, _] = vibration(&fewer, &masses, 0, &x, &v);
        assert!((energy / of_fewer - 1.0).abs() < 1e-9, "{energy} {of_fewer}");
        let flat: Vec<DVec3> = x[..4].iter().map(|x| DVec3::new(x.x, x.y, 0.0)).collect();
        let [_, rank] = vibration(&joined(&flat, &all(4)), &masses, 0, &flat, &v[..4]);
        assert_eq!(rank, 5.0);
    }
}
