use super::*;
use crate::testing::{column, context, estimate, fcc, random_positions, shuffled, view_of};
use lennard_core::PeriodicBox;

fn sampled(rdf: &mut RadialDistribution, cell: &PeriodicBox, positions: Vec<lennard_core::DVec3>) {
    view_of(cell, positions, |view| rdf.sample(view));
}

#[test]
fn the_distribution_of_an_ideal_gas_is_one() {
    let context = context(8.0, 200);
    let options = RdfOptions { r_max: None, bins: 40 };
    let mut rdf = RadialDistribution::new(&options, &context).unwrap();
    for seed in 0..400 {
        sampled(&mut rdf, &context.cell, random_positions(200, 8.0, seed));
    }
    let (g, error) = rdf.distribution();
    // χ² of 40 bins about exactly 1 has mean 40 and standard deviation √80 = 9; errors from 50
    // blocks widen it by a few per cent. The first bins hold few pairs and are left out.
    let chi2: f64 = (4..40).map(|k| ((g[k] - 1.0) / error[k]).powi(2)).sum();
    assert!((10.0..75.0).contains(&chi2), "{chi2}");
    // All pairs together: the mean over the volume is exact except for pairs beyond r_max.
    assert!((10..40).all(|k| (g[k] - 1.0).abs() < 0.05));
}

#[test]
fn the_shells_of_a_face_centred_lattice_hold_12_6_24_12_24_8_and_48_neighbors() {
    // Shells at d, √2 d, √3 d, 2d, √5 d, √6 d, √7 d, d the distance of nearest neighbors.
    let d = 1.1;
    let (cell, positions) = fcc(4, d);
    let n = positions.len();
    let context = BuildContext { cell, n_atoms: n, ..context(1.0, 1) };
    let options = RdfOptions { r_max: Some(2.8 * d), bins: 280 };
    let mut rdf = RadialDistribution::new(&options, &context).unwrap();
    sampled(&mut rdf, &cell, positions);
    let findings = rdf.finish(0.0);
    let coordination = findings.tables[0].columns[3].numbers();
    let up_to = |r: f64| coordination[(r * d / rdf.width()).round() as usize - 1];
    let mut inner = 0.0;
    for (shell, neighbors) in [
        (1.0_f64, 12.0),
        (2.0, 6.0),
        (3.0, 24.0),
        (4.0, 12.0),
        (5.0, 24.0),
        (6.0, 8.0),
        (7.0, 48.0),
    ] {
        let r = shell.sqrt();
        assert!((up_to(r - 0.02) - inner).abs() < 1e-9, "before √{shell}");
        inner += neighbors;
        assert!((up_to(r + 0.02) - inner).abs() < 1e-9, "after √{shell}");
    }
    assert!((estimate(&findings, "coordination_number").mean - 12.0).abs() < 1e-9);
    // A place is known to one bin.
    let peaks = &findings.tables[1];
    assert!((peaks.columns[1].numbers()[0] - d).abs() < rdf.width());
}

/// A distribution with a peak at 1.1 σ and a minimum of `lowest` at 1.6 σ, in 40 equal samples.
fn with_minimum(lowest: f64) -> Findings {
    let context = context(8.0, 200);
    let options = RdfOptions { r_max: Some(4.0), bins: 200 };
    let mut rdf = RadialDistribution::new(&options, &context).unwrap();
    let bump = |r: f64, at: f64, width: f64| (-((r - at) / width).powi(2)).exp();
    for _ in 0..40 {
        rdf.counts.whole.begin_sample();
        for (k, r) in rdf.radii().into_iter().enumerate() {
            let g = if r < 0.9 {
                0.0
            } else {
                1.0 + 1.5 * bump(r, 1.1, 0.15) - (1.0 - lowest) * bump(r, 1.6, 0.2)
            };
            let pairs = g / rdf.reading().normalisation[k];
            rdf.counts.whole.add(k, pairs, 1);
        }
    }
    rdf.finish(0.0)
}

#[test]
fn only_a_shell_of_neighbors_is_counted() {
    estimate(&with_minimum(0.6), "coordination_number");
    // A gas: nearly even behind its first peak.
    let gas = with_minimum(0.95);
    assert!(gas.averages.iter().all(|a| a.name != "coordination_number"));
    assert!(gas.remarks_in_words().contains("no shell"));
}

#[test]
fn the_distribution_of_an_ideal_gas_is_one_in_a_box_that_changes() {
    // The box breathes by 10 % of its sides: without weights by volume, g would be too low by 3·0.1²·3 ≈ 3 %.
    let context = context(8.0, 200);
    let options = RdfOptions { r_max: Some(3.5), bins: 35 };
    let mut rdf = RadialDistribution::new(&options, &context).unwrap();
    let side = |seed: u64| 8.0 * (1.0 + 0.1 * (0.7 * seed as f64).sin());
    for seed in 0..1000 {
        let cell = PeriodicBox::new(lennard_core::DVec3::splat(side(seed))).unwrap();
        sampled(&mut rdf, &cell, random_positions(200, side(seed), seed));
    }
    let (g, error) = rdf.distribution();
    let far = 10..35;
    let mean = far.clone().map(|k| g[k]).sum::<f64>() / far.len() as f64;
    let noise = far.clone().map(|k| error[k].powi(2)).sum::<f64>().sqrt() / far.len() as f64;
    assert!((mean - 1.0).abs() < 4.0 * noise && noise < 0.002, "{mean} {noise}");
    // Half of the smallest box is 3.6 σ: every bin counts all its pairs.
    let findings = rdf.finish(0.0);
    assert!(!findings.remarks_in_words().contains("pairs are missing"));
    let short = PeriodicBox::new(lennard_core::DVec3::splat(6.0)).unwrap();
    sampled(&mut rdf, &short, random_positions(200, 6.0, 0));
    let findings = rdf.finish(0.0);
    assert!(findings.remarks_in_words().contains("3.000 σ at its smallest"));
}

#[test]
fn coordination_counts_neighbors_whatever_the_box() {
    // A face-centred lattice blown up by 2 %: each particle has its twelve neighbors still.
    let (cell, positions) = fcc(4, 1.1);
    let context = BuildContext { cell, n_atoms: positions.len(), ..context(1.0, 1) };
    let options = RdfOptions { r_max: Some(2.0), bins: 200 };
    let mut rdf = RadialDistribution::new(&options, &context).unwrap();
    let wider = PeriodicBox::new(1.02 * cell.lengths()).unwrap();
    sampled(&mut rdf, &wider, positions.iter().map(|r| 1.02 * *r).collect());
    let coordination = rdf.finish(0.0).tables[0].columns[3].numbers();
    assert!((coordination[130] - 12.0).abs() < 1e-9, "{}", coordination[130]);
}

#[test]
fn a_mixture_of_names_has_the_distribution_of_the_pure_fluid_for_each_pair() {
    let (cell, lattice) = fcc(4, 1.1);
    let n = lattice.len();
    let options = RdfOptions { r_max: Some(3.0), bins: 60 };
    let pure = BuildContext { cell, n_atoms: n, ..context(1.0, 1) };
    let mixed = BuildContext {
        species: crate::testing::mixture(n, |i| usize::from(i % 5 == 0)),
        ..pure.clone()
    };
    let make = |context| RadialDistribution::new(&options, context).unwrap();
    let (mut pure, mut mixed) = (make(&pure), make(&mixed));
    for seed in 0..64 {
        let moved = lattice.iter().enumerate();
        let moved = moved.map(|(i, r)| *r + 0.09 * crate::testing::normal(5, seed, i));
        let positions = shuffled(&moved.collect::<Vec<_>>(), seed);
        sampled(&mut pure, &cell, positions.clone());
        sampled(&mut mixed, &cell, positions);
    }
    let (pure, mixed) = (pure.finish(0.0), mixed.finish(0.0));
    // What stands for all pairs has the same bits, and stands first.
    assert_eq!(mixed.tables[0].columns[..4], pure.tables[0].columns[..]);
    assert_eq!(mixed.averages[..2], pure.averages[..2]);
    let column = |name: &str| column(&mixed, name);
    let g = column("g");
    let filled: Vec<usize> = (0..60).filter(|k| g[*k] > 0.3).collect();
    for pair in ["A_A", "A_B", "B_B"] {
        let (partial, error) =
            (column(&format!("g_{pair}")), column(&format!("standard_error_{pair}")));
        let chi2: f64 = filled.iter().map(|&k| ((partial[k] - g[k]) / error[k]).powi(2)).sum();
        // Mean below the number of bins, since g shares the noise of its parts; deviation √(2m) and correlated bins.
        let m = filled.len() as f64;
        assert!(chi2 < m + 6.0 * (2.0 * m).sqrt(), "{pair}: {chi2} of {m}");
        assert!(chi2 > 0.0);
        let peak = estimate(&mixed, &format!("rdf_first_peak_{pair}"));
        let whole = estimate(&mixed, "rdf_first_peak");
        assert!((peak.mean - whole.mean).abs() < 4.0 * peak.standard_error.hypot(0.01));
        let number = estimate(&mixed, &format!("coordination_number_{pair}"));
        let share = if pair.ends_with('A') { 0.8 } else { 0.2 };
        assert!((number.mean - 12.0 * share).abs() < 0.3, "{number:?}");
    }
}

#[test]
fn partial_distributions_of_three_particles_are_those_by_hand() {
    let context =
        BuildContext { species: crate::testing::mixture(3, |i| i.min(1)), ..context(8.0, 3) };
    let options = RdfOptions { r_max: Some(3.0), bins: 30 };
    let mut rdf = RadialDistribution::new(&options, &context).unwrap();
    // A — B — B on a line through the border: A–B at 1.05 and 2.12, B–B at 1.07.
    let line = [7.52, 8.57, 9.64].map(|x| lennard_core::DVec3::new(x, 1.0, 1.0));
    sampled(&mut rdf, &context.cell, line.to_vec());
    let findings = rdf.finish(0.0);
    let column = |name: &str| findings.tables[0].numbers(name);
    let shell = |k: f64| 4.0 / 3.0 * std::f64::consts::PI * 1e-3 * ((k + 1.0).powi(3) - k.powi(3));
    let g = column("g_A_B").unwrap();
    let close = |found: f64, exact: f64| (found - exact).abs() < 1e-12 * exact;
    assert!(close(g[10], 512.0 / 2.0 / shell(10.0)), "{g:?}");
    assert!(close(g[21], 512.0 / 2.0 / shell(21.0)));
    let like = column("g_B_B").unwrap();
    assert!(close(like[10], 512.0 * 2.0 / 2.0 / shell(10.0)), "{like:?}");
    assert_eq!(like[21], 0.0);
    // Up to 2.5 σ: two B around A; of each B one A and one B.
    let up_to = |name: &str| column(name).unwrap()[24];
    assert_eq!(up_to("coordination_A_B"), 2.0);
    assert_eq!(up_to("coordination_B_A"), 1.0);
    assert_eq!(up_to("coordination_B_B"), 1.0);
    // One A has no other A.
    assert_eq!(column("g_A_A"), None);
    assert!(findings.remarks_in_words().contains("g_A_A(r) needs two"));
}

/// The two-body entropy of these findings, with its error.
fn entropy(findings: &Findings) -> (f64, f64) {
    let estimate = estimate(findings, "two_body_entropy");
    (estimate.mean, estimate.standard_error)
}

#[test]
fn pairs_of_an_ideal_gas_have_no_entropy_and_few_samples_do_not_change_that() {
    let (n, side) = (200, 8.0);
    for kinds in [1, 2] {
        let context =
            BuildContext { species: crate::testing::mixture(n, |i| i % kinds), ..context(side, n) };
        let mut rdf = RadialDistribution::new(&RdfOptions::default(), &context).unwrap();
        let cell = context.cell;
        for seed in 0..64 {
            sampled(&mut rdf, &cell, random_positions(n, side, seed));
        }
        let (found, error) = entropy(&rdf.finish(0.0));
        assert!(found.abs() < 4.0 * error, "{found} ± {error}");
        // Noise of g alone would give more than ten errors.
        let (g, of_g) = rdf.distribution();
        let width = 4.0 / 300.0;
        let noise: f64 =
            (0..g.len()).map(|k| (of_g[k] * (k as f64 + 0.5) * width).powi(2) * width).sum();
        let noise = std::f64::consts::PI * n as f64 / side.powi(3) * noise;
        assert!(noise > 5.0 * error, "{noise} {error}");
    }
}

#[test]
fn an_excluded_volume_costs_the_entropy_of_its_volume() {
    // g = 0 below 1 and 1 beyond: s₂ = −(2π/3)ρ. Fifty draws of one free pair beside particles that never meet.
    let (side, n) = (6.0_f64, 2);
    let context = context(side, n);
    let mut rdf = RadialDistribution::new(&RdfOptions::default(), &context).unwrap();
    let cell = context.cell;
    let pairs = random_positions(40_000, side, 9);
    let apart = pairs.chunks(2).filter(|p| cell.minimum_image(p[0] - p[1]).length() > 1.0);
    apart.for_each(|pair| sampled(&mut rdf, &cell, pair.to_vec()));
    let (found, error) = entropy(&rdf.finish(0.0));
    // The pairs that are left are more than in an ideal gas by the excluded part of the box.
    let (v, volume) = (4.0 / 3.0 * std::f64::consts::PI, side.powi(3));
    let g = 1.0 / (1.0 - v / volume);
    let sphere = 4.0 / 3.0 * std::f64::consts::PI * 27.0;
    let exact = -0.5 * n as f64 / volume * (v + (g * g.ln() - g + 1.0) * (sphere - v));
    assert!((found - exact).abs() < 4.0 * error + 2e-5, "{found} ± {error}, exact {exact}");
    assert!(error < 1e-3 && exact < -0.01, "{error} {exact}");
}
