//! Exact sums against wide integers, in any order and by any cut.

use glam::DVec3;
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

use super::*;

fn random() -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(7)
}

fn add_block(sum: &mut ExactSum, items: &[f64]) {
    let term = |x: &f64| *x;
    sum.add_terms(items, term);
}

fn sum_of(terms: &[f64]) -> ExactSum {
    let mut sum = ExactSum::default();
    terms.chunks(BLOCK).for_each(|block| add_block(&mut sum, block));
    sum
}

fn of(terms: &[f64]) -> f64 {
    sum_of(terms).value()
}

fn one_by_one(terms: &[f64]) -> f64 {
    let mut sum = ExactSum::default();
    terms.iter().for_each(|x| add_block(&mut sum, &[*x]));
    sum.value()
}

/// The exact sum of multiples of 2⁻⁴⁰ below 2²², as an integer of 128 bits gives it.
fn wide_sum(terms: &[f64]) -> f64 {
    let unit = 2.0_f64.powi(-40);
    let all = terms.iter().map(|x| (x / unit) as i128);
    all.sum::<i128>() as f64 * unit
}

#[test]
fn a_sum_is_the_wide_sum_rounded_once() {
    let mut random = random();
    for n in [0, 1, 2, 7, 8, 255, 256, 257, 1000, 20_000] {
        for spread in [0, 20, 44] {
            let terms: Vec<f64> = (0..n)
                .map(|_| {
                    let bits = 61 - random.random_range(0..=spread);
                    let all = random.random::<i64>() >> (63 - bits);
                    // A double takes 53 bits of it.
                    all as f64 * 2.0_f64.powi(-40)
                })
                .collect();
            let expected = wide_sum(&terms);
            assert_eq!(of(&terms).to_bits(), expected.to_bits(), "{n}");
            assert_eq!(one_by_one(&terms).to_bits(), expected.to_bits());
            let by_tasks = exact_sum(n, |i| terms[i]);
            assert_eq!(by_tasks.to_bits(), expected.to_bits());
        }
    }
}

#[test]
fn no_order_and_no_cut_changes_a_bit_of_a_sum_over_all_exponents() {
    let mut random = random();
    let any = |random: &mut Xoshiro256PlusPlus| loop {
        let x = f64::from_bits(random.random());
        if x.is_finite() {
            return x;
        }
    };
    for round in 0..60 {
        let mut terms: Vec<f64> = (0..2000).map(|_| any(&mut random) * 1e-4).collect();
        if round % 2 == 0 {
            // What is left of a cancellation is exact, however large the terms were.
            let opposite: Vec<f64> = terms.iter().map(|x| -x).collect();
            terms.extend(opposite);
            terms.extend([1.0, 1e-20, -3e-300]);
            terms.shuffle(&mut random);
            assert_eq!(of(&terms), 1.0);
        }
        let first = of(&terms).to_bits();
        terms.shuffle(&mut random);
        let mut all = ExactSum::default();
        let mut rest = &terms[..];
        while !rest.is_empty() {
            let (part, left) = rest.split_at(random.random_range(1..=rest.len()));
            all.merge(&sum_of(part));
            rest = left;
        }
        assert_eq!(all.value().to_bits(), first);
    }
    // The same terms in two orders differ where sums are rounded on the way.
    let terms = [1.0, 1e17, -1e17];
    assert_eq!(of(&terms), 1.0);
    assert_ne!(terms.iter().sum::<f64>(), 1.0);
}

#[test]
fn ties_go_to_even_and_the_ends_of_the_range_hold() {
    let tie = 1.0 + f64::EPSILON;
    let half = 0.5 * f64::EPSILON;
    let least = f64::from_bits(1);
    let cases = [
        (vec![1.0, half], 1.0),
        (vec![tie, half], 1.0 + 2.0 * f64::EPSILON),
        (vec![1.0, half, least], tie),
        (vec![tie, half, -least], tie),
        (vec![-1.0, -half, -least], -tie),
        (vec![least, least], 2.0 * least),
        (vec![f64::MIN_POSITIVE, -least], f64::MIN_POSITIVE - least),
        (vec![f64::MAX, f64::MAX, -f64::MAX], f64::MAX),
        (vec![f64::MAX, f64::MAX], f64::INFINITY),
        (vec![-f64::MAX, -f64::MAX], f64::NEG_INFINITY),
        (vec![], 0.0),
        (vec![-0.0], 0.0),
        (vec![f64::INFINITY, 1.0], f64::INFINITY),
        (vec![f64::NEG_INFINITY, 1.0], f64::NEG_INFINITY),
    ];
    for (terms, expected) in cases {
        assert_eq!(of(&terms).to_bits(), expected.to_bits(), "{terms:?}");
        assert_eq!(one_by_one(&terms).to_bits(), expected.to_bits(), "{terms:?}");
    }
    for terms in [[f64::NAN, 1.0], [f64::INFINITY, f64::NEG_INFINITY]] {
        assert!(of(&terms).is_nan());
        let mut both = sum_of(&terms[..1]);
        both.merge(&sum_of(&terms[1..]));
        assert!(both.value().is_nan());
    }
}

#[test]
fn digits_are_carried_before_they_overflow() {
    let mut sum = sum_of(&[-1.5]);
    // Doubling an accumulator soon passes the number of terms that digits have room for.
    for doublings in 1..200 {
        let same = sum.clone();
        sum.merge(&same);
        assert_eq!(sum.value(), -1.5 * 2.0_f64.powi(doublings));
    }
    add_block(&mut sum, &[1.5 * 2.0_f64.powi(199)]);
    assert_eq!(sum.value(), 0.0);
}

#[test]
fn a_sum_far_beyond_the_largest_double_is_infinite() {
    for sign in [1.0, -1.0] {
        let mut sum = sum_of(&[sign * f64::MAX]);
        // There is room for 2⁶³ terms.
        for _ in 0..62 {
            let same = sum.clone();
            sum.merge(&same);
            assert_eq!(sum.value(), sign * f64::INFINITY);
        }
    }
}

#[test]
fn threads_change_no_bit() {
    let terms: Vec<f64> = (0..50_000).map(|i| (f64::from(i) * 0.7).sin() * 1e3).collect();
    let vectors = |i: usize| DVec3::new(terms[i], terms[i] * terms[i], 1.0 / terms[i]);
    let sums = || (exact_sum(terms.len(), vectors), exact_sum(terms.len(), |i| terms[i]));
    let one = sums();
    assert_eq!(one.0.x.to_bits(), one.1.to_bits());
    assert_eq!(one.1.to_bits(), of(&terms).to_bits());
    for threads in [1, 2, 3, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(sums), one);
    }
}

#[test]
fn parts_have_the_sum_of_all_terms_wherever_the_window_lies() {
    let mut sum = SumOfParts::default();
    let mut spilled = Vec::new();
    for (round, scale) in [1.0, 1.0, 1e3, 1e-3, 1e-30, f64::MAX / 1e6].into_iter().enumerate() {
        // More terms of one sign than one sum of slices holds.
        let n = 60_000 - 17 * round;
        let term = |k: usize| scale * (1.5 + ((k + 31 * round) as f64 * 12.9898).sin());
        let mut terms: Vec<f64> = (0..n).map(term).collect();
        // A term far below the others has a rest below the slices.
        terms[round] *= scale * 1e-12;
        let parts: Vec<PartSum> = terms.chunks(BLOCK).map(|part| sum.part(part)).collect();
        spilled.push(parts.iter().filter(|part| part.0 == [0.0; 2]).count());
        let value = sum.value(&parts, None);
        assert_eq!(value.to_bits(), total(&terms).to_bits(), "{round}");
    }
    // All parts of the first round find no window, and one part of the second does not fit.
    assert_eq!(spilled[..2], [938, 1], "{spilled:?}");
    let parts = [sum.part(&[1.0, f64::NAN]), sum.part(&[1.0])];
    assert!(sum.value(&parts, None).is_nan());
    let _ = sum.part(&[f64::INFINITY]);
    sum.begin();
    let parts = [sum.part(&[1.0, 2.0])];
    assert_eq!(sum.value(&parts, None), 3.0);
}
