//! The two ends of a bond do not interact, in any loop.

use super::*;
use lennard_core::{Bonds, Configuration, Exclusions, Molecules};

/// Chains about the sites of a perturbed lattice, each along its own axis, with bonds of 0.45 σ.
pub(super) fn chains(cells: [usize; 3], density: f64, sites: usize) -> (PeriodicBox, Vec<DVec3>) {
    let (cell, centers) = liquid(cells, density / sites as f64, 0.1);
    let axes = scatter(centers.len(), DVec3::splat(2.0), 0.3);
    let positions = centers.iter().zip(&axes).flat_map(|(center, axis)| {
        let axis = (*axis - DVec3::ONE).normalize();
        (0..sites).map(move |k| *center + (0.45 * (k as f64 - 0.5 * sites as f64)) * axis)
    });
    (cell, positions.collect())
}

pub(super) fn exclusions(sites: usize) -> Exclusions {
    Molecules::chains(sites, 0.45, Bonds::Rigid).exclusions()
}

fn with_every_loop(base: ForceFieldOptions) -> Vec<ForceFieldOptions> {
    let mut all = Vec::new();
    for kernel in kernels() {
        for canonical in [false, true] {
            all.push(ForceFieldOptions { kernel, canonical, neighbor: verlet(Some(0.4)), ..base });
        }
    }
    all.push(ForceFieldOptions {
        neighbor: NeighborOptions { mode: ListMode::Direct, skin: None },
        ..base
    });
    all
}

/// Energy and forces by a double loop of this test, over all pairs but the ends of bonds.
fn by_hand(cell: PeriodicBox, positions: &[DVec3], sites: usize) -> (f64, u64, Vec<DVec3>) {
    let truncation = TruncationOptions::new(TruncationKind::Cut, 2.5);
    let model = Model::new(&PotentialOptions::default(), &truncation).unwrap();
    let (mut energy, mut pairs) = (0.0, 0);
    let mut forces = vec![DVec3::ZERO; positions.len()];
    for i in 0..positions.len() {
        for j in 0..i {
            let bonded = i == j + 1 && i / sites == j / sites;
            let r = cell.minimum_image(positions[i] - positions[j]);
            if !bonded && r.length() <= 2.5 {
                let pair = model.eval(r.length_squared());
                energy += pair.energy;
                pairs += 1;
                forces[i] += pair.force * r;
                forces[j] -= pair.force * r;
            }
        }
    }
    (energy, pairs, forces)
}

#[test]
fn no_loop_computes_the_ends_of_a_bond() {
    for (sites, cells) in [(2, [7, 8, 7]), (3, [6, 7, 6]), (5, [5, 6, 5])] {
        let (cell, start) = chains(cells, 0.7, sites);
        let base =
            ForceFieldOptions { exclusions: exclusions(sites), ..ForceFieldOptions::default() };
        // A small move keeps the list; a large one inserts pairs or builds again.
        for by in [0.1, 0.33] {
            let positions = moved(&start, by);
            let (energy, pairs, wanted) = by_hand(cell, &positions, sites);
            let (of_reference, totals) = reference(&base, cell, &positions);
            assert_eq!(totals.pairs, Some(pairs));
            assert!((totals.potential_energy.unwrap() - energy).abs() < 1e-9 * energy.abs());
            for (f, w) in of_reference.iter().zip(&wanted) {
                assert!((*f - *w).length() <= 1e-10 * (1.0 + w.length()), "{f} {w}");
            }
            for options in with_every_loop(base) {
                let mut forces = build(&options, &conditions(cell, start.len())).unwrap();
                all(&mut forces, cell, &start, Want::NOTHING);
                let (found, energetics) = all(&mut forces, cell, &positions, want_each());
                assert_eq!(energetics.pairs, Some(pairs), "{options:?}");
                one_by_one(&options, None, cell, &positions, &found)
                    .unwrap_or_else(|e| panic!("{e}"));
                let off = (energetics.potential_energy.unwrap() - energy).abs();
                assert!(off <= 1e-5 * energy.abs().max(1e3), "{options:?}: {off}");
            }
        }
    }
}

/// In a large system the other end of a bond can be beyond the reach of the cluster's base.
#[test]
fn ends_of_bonds_far_apart_in_memory_do_not_interact() {
    let (cell, start) = chains([29, 29, 29], 0.6, 2);
    assert!(start.len() > 40_000);
    for kernel in kernels() {
        let options = ForceFieldOptions {
            kernel,
            exclusions: exclusions(2),
            neighbor: verlet(Some(0.3)),
            ..ForceFieldOptions::default()
        };
        let mut forces = build(&options, &conditions(cell, start.len())).unwrap();
        let (found, _) = all(&mut forces, cell, &start, Want::ENERGY);
        let all_pairs = AllPairs::new(&options, None).unwrap();
        // A bond of 0.45 σ alone would push with 10⁶ ε/σ.
        let largest = found.iter().map(|f| f.length()).fold(0.0, f64::max);
        assert!(largest < 5e5, "{options:?}: {largest}");
        for i in (0..start.len()).step_by(173) {
            let wanted = all_pairs.force_on(i, &cell, &start);
            let off = (found[i] - wanted.force).length();
            assert!(off <= wanted.tolerance, "{options:?}, {i}: {wanted:?}");
        }
    }
}

#[test]
fn excluded_pairs_have_the_same_bits_on_any_number_of_threads() {
    let (cell, start) = chains([9, 9, 9], 0.7, 2);
    let positions = moved(&start, 0.3);
    let base = ForceFieldOptions { exclusions: exclusions(2), ..ForceFieldOptions::default() };
    for options in with_every_loop(base) {
        let run = || {
            let mut forces = build(&options, &conditions(cell, start.len())).unwrap();
            all(&mut forces, cell, &start, Want::NOTHING);
            all(&mut forces, cell, &positions, Want::TOTALS)
        };
        let one = in_threads(1, run);
        for threads in [2, 3] {
            assert_eq!(in_threads(threads, run), one, "{options:?}");
        }
    }
}

#[test]
fn near_and_far_parts_leave_out_the_ends_of_bonds() {
    let (cell, positions) = chains([6, 7, 6], 0.7, 2);
    let base = ForceFieldOptions {
        exclusions: exclusions(2),
        split: Some(SplitOptions { r_split: 1.7, width: 0.4 }),
        ..ForceFieldOptions::default()
    };
    let (_, _, wanted) = by_hand(cell, &positions, 2);
    for options in with_every_loop(base) {
        let mut forces = build(&options, &conditions(cell, positions.len())).unwrap();
        let mut part = |part| {
            let mut f = vec![DVec3::ZERO; positions.len()];
            let at = Configuration::at_rest(&cell, &positions);
            forces.evaluate(at, part, Want::NOTHING, &mut f).unwrap();
            f
        };
        let (near, far) = (part(Part::Near), part(Part::Far));
        for ((near, far), w) in near.iter().zip(&far).zip(&wanted) {
            assert!((*near + *far - *w).length() <= 2e-5 * (1.0 + w.length()));
        }
    }
}

#[test]
fn no_loop_computes_the_ends_of_a_bond_in_a_mixture() {
    let (cell, start) = chains([7, 8, 7], 0.7, 2);
    let base = ForceFieldOptions { exclusions: exclusions(2), ..ForceFieldOptions::default() };
    let mixture = mixture(3, base.truncation.r_cut, start.len());
    let positions = moved(&start, 0.1);
    let (_, totals) = reference_of(&base, Some(&mixture), cell, &positions);
    for options in with_every_loop(base) {
        let mut forces = built(&options, Some(&mixture), cell, start.len());
        all(&mut forces, cell, &start, Want::NOTHING);
        let (found, energetics) = all(&mut forces, cell, &positions, want_each());
        assert_eq!(energetics.pairs, totals.pairs, "{options:?}");
        let checked = one_by_one(&options, Some(&mixture), cell, &positions, &found);
        checked.unwrap_or_else(|e| panic!("{e}"));
    }
}
