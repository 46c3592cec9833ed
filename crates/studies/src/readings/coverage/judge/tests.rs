//! Made-up runs with known errors.

use lennard_core::random::Streams;
use lennard_observables::Verdict;
use rand::Rng;

use super::*;

/// A number from a normal distribution: the sum of twelve uniform ones.
fn normal(random: &mut impl Rng) -> f64 {
    let uniform = |_| (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    (0..12).map(uniform).sum::<f64>() - 6.0
}

fn average(mean: f64, error: Option<f64>) -> AverageRecord {
    let standing = if error.is_some() { Standing::Sound } else { Standing::TooShort };
    let average = crate::testing::average(mean, error.unwrap_or(f64::NAN));
    AverageRecord { standing, ..average }
}

type Run = BTreeMap<String, AverageRecord>;

/// Thirty runs whose mean scatters by `scatter` about a line in the energy, with this printed error.
fn runs(slope: f64, scatter: f64, error: Option<f64>, random: &mut impl Rng) -> Vec<Run> {
    let mut run = |_| {
        let energy = normal(random);
        let pressure = average(3.0 + slope * energy + scatter * normal(random), error);
        let conserved = average(energy, Some(0.0));
        [("pressure".to_owned(), pressure), (CONSERVED.to_owned(), conserved)].into()
    };
    (0..30).map(&mut run).collect()
}

fn sample(cell: Cell, runs: &[Run]) -> Sample<'_> {
    Sample { cell, runs: runs.iter().collect() }
}

fn cell(is_at_constant_energy: bool, steps: u64) -> Cell {
    Cell { state: "liquid".into(), steps, is_at_constant_energy, is_long_enough: false }
}

/// Cells of one state at two lengths: the short runs scatter four times as much.
fn two_lengths(at_energy: bool, slope: f64, error: f64, seed: u64) -> Vec<Covered> {
    let mut random = Streams::new(seed).sequential("runs");
    let short = runs(slope, 0.4, Some(4.0 * error), &mut random);
    let long = runs(slope, 0.1, Some(error), &mut random);
    all(&[sample(cell(at_energy, 2500), &short), sample(cell(at_energy, 200_000), &long)])
}

#[test]
fn right_errors_pass_and_errors_too_small_or_too_large_by_two_are_caught() {
    // Of 300 cells with right errors, chance lists one; a cell shows large errors less surely than small ones.
    for (factor, listed, groups_fail) in
        [(1.0, 0..=5, false), (0.5, 295..=300, true), (2.0, 200..=300, true)]
    {
        let mut judged = Vec::new();
        for seed in 0..50 {
            for at_energy in [true, false, false] {
                let slope = if at_energy { 5.0 } else { 0.0 };
                let stream = 3 * seed + judged.len() as u64 % 6 / 2;
                judged.extend(two_lengths(at_energy, slope, 0.1 * factor, stream));
            }
        }
        assert_eq!(judged.len(), 300, "the conserved energy is not judged");
        let faulty = judged.iter().filter(|one| !one.faults.is_empty()).count();
        assert!(listed.contains(&faulty), "{faulty} cells listed at {factor}");
        let rows = by_quantity(&judged, &[2500, 200_000]);
        for sums in rows.iter().flat_map(|row| &row.sums) {
            let fails = sums.verdict() != Verdict::Agrees;
            assert_eq!(fails, groups_fail, "{factor} {sums:?}");
            assert!((sums.scatter().unwrap() * factor - 1.0).abs() < 0.1);
        }
    }
}

#[test]
fn shares_of_many_cells_are_those_of_a_normal_distribution() {
    for at_energy in [true, false] {
        let slope = if at_energy { 5.0 } else { 0.0 };
        let mut sums = [[0; 2]; 2];
        for seed in 0..200 {
            for (sum, one) in sums.iter_mut().zip(two_lengths(at_energy, slope, 0.1, seed)) {
                for (s, within) in sum.iter_mut().zip(one.within) {
                    *s += within;
                }
            }
        }
        for (within, expected) in sums.iter().flat_map(|sum| sum.iter().zip(NORMAL)) {
            let share = *within as f64 / 6000.0;
            assert!((share - expected).abs() < 0.02, "{at_energy} {share} {expected}");
        }
    }
}

#[test]
fn energies_of_the_seeds_count_only_at_constant_energy() {
    let bath = two_lengths(false, 5.0, 0.1, 1);
    assert!(bath.iter().all(|one| !one.faults.is_empty()));
}

#[test]
fn a_short_mean_that_is_off_is_seen_where_its_scatter_is_right() {
    let mut random = Streams::new(1).sequential("runs");
    let mut short = runs(0.0, 0.1, Some(0.1), &mut random);
    for run in &mut short {
        run.get_mut("pressure").unwrap().estimate.mean += 0.2;
    }
    let long = runs(0.0, 0.03, Some(0.03), &mut random);
    let judged = all(&[sample(cell(false, 2500), &short), sample(cell(false, 20_000), &long)]);
    assert!((judged[0].distance - 2.0).abs() < 0.6);
    assert!((judged[0].scatter().unwrap() - 1.0).abs() < 0.4);
    assert!(!judged[0].faults.is_empty() && judged[1].faults.is_empty());
}

#[test]
fn too_short_is_an_answer_but_not_at_the_longest_length_of_a_liquid() {
    let mut random = Streams::new(1).sequential("runs");
    for is_long_enough in [false, true] {
        let cell = Cell { is_long_enough, ..cell(false, 200_000) };
        let runs = runs(0.0, 0.1, None, &mut random);
        let judged = all(&[sample(cell, &runs)]);
        assert_eq!(judged[0].given, 0);
        assert_eq!(judged[0].without["too short"], 30);
        assert_eq!(!judged[0].faults.is_empty(), is_long_enough);
    }
}
