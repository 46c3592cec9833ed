//! Mixtures: sums over pairs of species by the formula, tails, and what is refused.

use crate::common::*;
use lennard_core::{DVec3, PeriodicBox, Want};
use lennard_forcefield::*;

/// Forces, energy, conserved energy, and the derivative −dU/d(ln V)·3, by the model of each pair in its own units.
fn by_the_formula(
    o: &ForceFieldOptions,
    mixture: &Mixture,
    cell: PeriodicBox,
    positions: &[DVec3],
) -> (Vec<DVec3>, [f64; 4]) {
    let mut forces = vec![DVec3::ZERO; positions.len()];
    let [mut energy, mut conserved, mut virial, mut laplacian] = [0.0; 4];
    let of = mixture.of_particle();
    let models = models_of(mixture, o);
    for i in 0..positions.len() {
        for j in 0..positions.len() {
            let [a, b] = [i, j].map(|i| usize::from(of[i]));
            let (pair, model) = (mixture.pair(a, b), &models[a][b]);
            let r_ij = cell.minimum_image(positions[i] - positions[j]) / pair.sigma;
            let r2 = r_ij.length_squared();
            if i == j || r2 > model.r_cut * model.r_cut {
                continue;
            }
            let at = model.eval(r2);
            let f_ij = pair.epsilon / pair.sigma * at.force * r_ij;
            forces[i] += f_ij;
            energy += 0.5 * pair.epsilon * at.energy;
            conserved += 0.5 * pair.epsilon * (at.energy - model.energy_at_cutoff);
            virial += 0.5 * pair.sigma * r_ij.dot(f_ij);
            laplacian += pair.epsilon / pair.sigma.powi(2) * (at.curvature - 2.0 * at.force);
        }
    }
    (forces, [energy, conserved, virial, laplacian])
}

#[test]
fn the_reference_loop_sums_the_formula_of_each_pair_of_species() {
    let (cell, positions) = liquid([7, 6, 6], 0.8442, 0.1);
    for base in forms() {
        for species in [2, 3] {
            let mixture = mixture(species, base.truncation.r_cut, positions.len());
            let (wanted, sums) = by_the_formula(&base, &mixture, cell, &positions);
            let (found, totals) = reference_of(&base, Some(&mixture), cell, &positions);
            let size: f64 = wanted.iter().map(|f| f.length()).sum();
            for (found, wanted) in found.iter().zip(&wanted) {
                assert!((*found - *wanted).length() < 1e-12 * size, "{base:?}");
            }
            let found = [
                totals.potential_energy,
                totals.conserved_potential,
                totals.scalar_virial(),
                totals.laplacian,
            ];
            let scale = size.max(sums[3].abs());
            for (found, wanted) in found.into_iter().zip(sums) {
                let found = found.unwrap();
                assert!((found - wanted).abs() < 1e-13 * scale, "{found} {wanted}");
            }
        }
    }
}

#[test]
fn forces_are_derivatives_of_the_energy() {
    let (cell, positions) = liquid([6, 6, 6], 0.7, 0.1);
    for base in forms() {
        let mixture = mixture(3, base.truncation.r_cut, positions.len());
        let options = ForceFieldOptions {
            kernel: KernelOptions { kernel: Kernel::Reference, ..base.kernel },
            ..base
        };
        let mut forces = built(&options, Some(&mixture), cell, positions.len());
        let (f, _) = all(&mut forces, cell, &positions, Want::NOTHING);
        let h = 1e-5;
        for particle in [0, 71, 142] {
            let energy = |by: f64, forces: &mut PairForces| {
                let mut moved = positions.clone();
                moved[particle].y += by;
                // The energy without the jumps of pairs that cross their cutoff.
                all(forces, cell, &moved, Want::ENERGY).1.conserved_potential
            };
            let [up, down] = [h, -h].map(|h| energy(h, &mut forces).unwrap());
            let slope = (up - down) / (2.0 * h);
            let off = (slope + f[particle].y).abs();
            assert!(off < 1e-5 * (1.0 + f[particle].length()), "{options:?}: {off}");
        }
    }
}

#[test]
fn species_that_are_all_alike_have_the_bits_of_one_fluid() {
    let (cell, positions) = liquid([8, 8, 8], 0.8442, 0.15);
    let n = positions.len();
    for base in forms() {
        let alike =
            Mixture::new(2, |_, _| SpeciesPair::unit(base.truncation.r_cut), species_of(2, n))
                .unwrap();
        for kernel in kernels() {
            let options = ForceFieldOptions { kernel, ..base };
            let run = |mixture: Option<&Mixture>| {
                let mut forces = built(&options, mixture, cell, n);
                all(&mut forces, cell, &positions, Want::TOTALS)
            };
            assert!(run(Some(&alike)) == run(None), "{options:?}");
        }
        let tails = [
            tail_of_mixture(&base, &alike, cell.volume()),
            tail_correction(&base, n, cell.volume()),
        ];
        assert_eq!(tails[0], tails[1]);
    }
}

#[test]
fn tails_are_the_integrals_of_every_ordered_pair_of_species() {
    let n = 300;
    let volume = 500.0;
    for base in forms() {
        if !base.truncation.tail_correction {
            continue;
        }
        let mixture = mixture(3, base.truncation.r_cut, n);
        let tail = tail_of_mixture(&base, &mixture, volume).unwrap();
        // Shells of one pair of species at a time, and no species is counted with itself twice.
        let [mut energy, mut virial] = [0.0; 2];
        for (a, n_a) in mixture.counts().iter().enumerate() {
            for (b, n_b) in mixture.counts().iter().enumerate() {
                let pair = mixture.pair(a, b);
                let only = |sigma: f64| {
                    let truncation =
                        TruncationOptions::new(TruncationKind::Cut, pair.r_cut / sigma);
                    ForceFieldOptions { truncation, ..base }
                };
                // A fluid of N particles has N² ordered pairs, in units of its own σ and ε.
                let own =
                    tail_correction(&only(pair.sigma), 1, volume / pair.sigma.powi(3)).unwrap();
                let pairs = (n_a * n_b) as f64;
                energy += pairs * pair.epsilon * own.energy;
                virial += pairs * pair.epsilon * own.virial;
            }
        }
        assert!((tail.energy - energy).abs() <= 1e-12 * energy.abs(), "{base:?}");
        assert!((tail.virial - virial).abs() <= 1e-12 * virial.abs(), "{base:?}");
        assert!((tail.energy_per_particle * n as f64 - tail.energy).abs() <= 1e-12 * energy.abs());
        // P_tail = −∂U_tail/∂V by finite differences: U_tail goes as 1/V.
        let energy_at = |v: f64| tail_of_mixture(&base, &mixture, v).unwrap().energy;
        let slope = (energy_at(volume * 1.0001) - energy_at(volume * 0.9999)) / (volume * 2e-4);
        let without_shift = tail.energy / volume;
        assert!((-slope - without_shift).abs() <= 1e-7 * without_shift.abs());
    }
}

#[test]
fn the_force_that_checks_is_that_of_the_reference() {
    let (cell, positions) = liquid([7, 7, 7], 0.8442, 0.1);
    for base in forms() {
        let mixture = mixture(2, base.truncation.r_cut, positions.len());
        let (wanted, _) = reference_of(&base, Some(&mixture), cell, &positions);
        let all_pairs = AllPairs::new(&base, Some(&mixture)).unwrap();
        for (i, wanted) in wanted.iter().enumerate() {
            let found = all_pairs.force_on(i, &cell, &positions);
            let off = (found.force - *wanted).length();
            assert!(off <= found.tolerance, "{base:?}: {off} {found:?}");
        }
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let of = |species| species_of(species, 10);
    let unit = |_, _| SpeciesPair::unit(2.5);
    let message = |r: Result<Mixture, ForceFieldError>| {
        let e = r.unwrap_err();
        assert!(!e.found().is_empty() && !e.allowed().is_empty());
        (e.key(), e.to_string())
    };
    for species in [0, lennard_core::MOST_SPECIES + 1] {
        let (key, text) = message(Mixture::new(species, unit, of(1)));
        assert!(key == "species" && text.contains("a mixture has 1 to 8 species, found"), "{text}");
    }
    assert!(
        message(Mixture::new(2, unit, of(3)))
            .1
            .contains("particle 2 has species 2, and there are 2")
    );
    let bad = [
        ("sigma", f64::NAN, 1.0, 2.5),
        ("sigma", 0.0, 1.0, 2.5),
        ("epsilon", 1.0, -0.1, 2.5),
        ("r_cut", 1.0, 1.0, f64::INFINITY),
    ];
    for (key, sigma, epsilon, r_cut) in bad {
        let pair = |a, b| match (a, b) {
            (0, 1) => SpeciesPair { sigma, epsilon, r_cut },
            _ => SpeciesPair::unit(2.5),
        };
        let found = message(Mixture::new(2, pair, of(2)));
        assert_eq!(found.0, format!("pair.{key}"));
        let words = format!("`{key}` of the pair of species 0 and 1 cannot be");
        assert!(found.1.contains(&words), "{found:?}");
    }
    let cell = PeriodicBox::new(DVec3::splat(8.0)).unwrap();
    let mixture = |sigma: f64, r_cut| {
        let pair =
            |a, b| SpeciesPair { sigma: if a == b { 1.0 } else { sigma }, epsilon: 1.0, r_cut };
        Mixture::new(2, pair, of(2)).unwrap()
    };
    let refused = |o: &ForceFieldOptions, mixture: &Mixture, n_atoms| {
        let at = Conditions { mixture: Some(mixture), ..conditions(cell, n_atoms) };
        check(o, &at).unwrap_err()
    };
    let base = ForceFieldOptions::default();
    let wca = ForceFieldOptions { potential: PotentialOptions::Wca(Wca {}), ..base };
    assert_eq!(refused(&base, &mixture(1.1, 4.5), 10).key(), "truncation.r_cut");
    let other = refused(&base, &mixture(1.1, 2.5), 11);
    assert_eq!(other.key(), "system.n_atoms");
    assert_eq!(other.to_string(), "the mixture has 10 particles, and the system has 11");
    let inside = refused(&wca, &mixture(3.0, 2.5), 10).to_string();
    let words = "the pair of species 0 and 1, in units of its own σ and ε:";
    assert!(inside.contains(words), "{inside}");
}
