//! Made-up runs with known errors.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::super::groups::{Standing, by_quantity};
use super::super::plan::{ENSEMBLES, STATES};
use super::super::records::Average;
use super::*;

/// A number from a normal distribution: the sum of twelve uniform ones.
fn normal(random: &mut Xoshiro256PlusPlus) -> f64 {
    (0..12).map(|_| random.random_range(0.0..1.0)).sum::<f64>() - 6.0
}

/// Thirty runs whose mean scatters by `scatter` about a line in the energy, with this printed error.
fn sample(
    cell: Cell,
    slope: f64,
    scatter: f64,
    error: Option<f64>,
    random: &mut Xoshiro256PlusPlus,
) -> Sample {
    let run = |_| {
        let energy = normal(random);
        let average = Average {
            mean: Some(3.0 + slope * energy + scatter * normal(random)),
            error,
            standing: if error.is_some() { "sound" } else { "too-short" }.to_owned(),
        };
        let conserved =
            Average { mean: Some(energy), error: Some(0.0), standing: "sound".to_owned() };
        Printed {
            energy,
            averages: [("pressure".to_owned(), average), (CONSERVED.to_owned(), conserved)].into(),
        }
    };
    Sample { cell, runs: (0..30).map(run).collect() }
}

/// Cells of one state and ensemble at two lengths: the short runs scatter four times as much.
fn two_lengths(ensemble: Ensemble, slope: f64, error: f64, seed: u64) -> Vec<Judged> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let cell = |length| Cell { state: &STATES[7], ensemble, length };
    all(&[
        sample(cell(2500), slope, 0.4, Some(4.0 * error), &mut random),
        sample(cell(200_000), slope, 0.1, Some(error), &mut random),
    ])
}

#[test]
fn right_errors_pass_and_errors_too_small_or_too_large_by_two_are_caught() {
    // Of 300 cells with right errors, chance lists one; a cell shows large errors less surely than small ones.
    for (factor, listed, groups_fail) in
        [(1.0, 0..=5, false), (0.5, 299..=300, true), (2.0, 200..=300, true)]
    {
        let mut judged = Vec::new();
        for seed in 0..50 {
            for ensemble in ENSEMBLES {
                let slope = if ensemble == Ensemble::Energy { 5.0 } else { 0.0 };
                judged.extend(two_lengths(ensemble, slope, 0.1 * factor, seed));
            }
        }
        assert_eq!(judged.len(), 300, "the conserved energy is not judged");
        let faulty = judged.iter().filter(|one| !one.faults.is_empty()).count();
        assert!(listed.contains(&faulty), "{faulty} cells listed at {factor}");
        let rows = by_quantity(&judged, &[2500, 200_000]);
        for sums in rows.iter().flat_map(|row| &row.sums) {
            let fails = sums.standing() != Standing::Inside;
            assert_eq!(fails, groups_fail, "{factor} {sums:?}");
            assert!((sums.scatter().unwrap() * factor - 1.0).abs() < 0.1);
        }
    }
}

#[test]
fn shares_of_many_cells_are_those_of_a_normal_distribution() {
    for ensemble in ENSEMBLES {
        let slope = if ensemble == Ensemble::Energy { 5.0 } else { 0.0 };
        let mut sums = [[0; 2]; 2];
        for seed in 0..200 {
            for (sum, one) in sums.iter_mut().zip(two_lengths(ensemble, slope, 0.1, seed)) {
                for (s, within) in sum.iter_mut().zip(one.within) {
                    *s += within;
                }
            }
        }
        for (within, expected) in sums.iter().flat_map(|sum| sum.iter().zip(NORMAL)) {
            let share = *within as f64 / 6000.0;
            assert!((share - expected).abs() < 0.02, "{ensemble:?} {share} {expected}");
        }
    }
}

#[test]
fn energies_of_the_seeds_count_only_at_constant_energy() {
    let bath = two_lengths(Ensemble::Bussi, 5.0, 0.1, 1);
    assert!(bath.iter().all(|one| !one.faults.is_empty()));
}

#[test]
fn a_short_mean_that_is_off_is_seen_where_its_scatter_is_right() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let cell = |length| Cell { state: &STATES[0], ensemble: Ensemble::Bussi, length };
    let mut short = sample(cell(2500), 0.0, 0.1, Some(0.1), &mut random);
    for run in &mut short.runs {
        let average = run.averages.get_mut("pressure").unwrap();
        average.mean = average.mean.map(|mean| mean + 0.2);
    }
    let long = sample(cell(20_000), 0.0, 0.03, Some(0.03), &mut random);
    let judged = all(&[short, long]);
    assert!((judged[0].offset - 2.0).abs() < 0.6);
    assert!((judged[0].scatter().unwrap() - 1.0).abs() < 0.4);
    assert!(!judged[0].faults.is_empty() && judged[1].faults.is_empty());
}

#[test]
fn too_short_is_an_answer_but_not_at_the_longest_length_of_a_liquid() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    for (state, length, fails) in [(7, 2500, false), (7, 200_000, true), (0, 200_000, false)] {
        let cell = Cell { state: &STATES[state], ensemble: Ensemble::Bussi, length };
        let judged = all(&[sample(cell, 0.0, 0.1, None, &mut random)]);
        assert_eq!(judged[0].given, 0);
        assert_eq!(judged[0].without["too-short"], 30);
        assert_eq!(!judged[0].faults.is_empty(), fails, "{state} {length}");
    }
}
