use std::sync::Arc;

use lennard_core::random::Streams;
use lennard_core::{DVec3, PeriodicBox, SpeciesTable, State, System};

use super::*;
use crate::testing::{context, mixture, random_positions};

/// Square wells or shoulders: −depth within the width, and no core.
#[derive(Debug)]
struct Square {
    widths: [f64; 2],
    depth: f64,
    tail: f64,
}

impl TrialEnergies for Square {
    fn cutoff(&self, _a: usize, b: usize) -> f64 {
        self.widths[b]
    }

    fn sum(&self, _a: usize, _b: usize, squared_distances: &[f64]) -> f64 {
        -self.depth * squared_distances.len() as f64
    }

    fn tail(&self, _a: usize) -> f64 {
        self.tail
    }
}

fn insertion(square: Square, temperature: f64) -> Option<Insertion> {
    Some(Insertion { temperature, streams: Streams::new(5), energies: Arc::new(square) })
}

fn built(context: &BuildContext, insertions: usize) -> ChemicalPotential {
    let options = ChemicalPotentialOptions { insertions };
    ChemicalPotential::new(&options, context, context.insertion.as_ref().unwrap())
}

/// Samples of an ideal gas in boxes of these sides.
fn seen(context: &BuildContext, insertions: usize, sides: &[f64]) -> ChemicalPotential {
    let mut observable = built(context, insertions);
    let system = System::of_species(context.species.clone());
    for (k, side) in sides.iter().enumerate() {
        let cell = PeriodicBox::new(DVec3::splat(*side)).unwrap();
        let positions = random_positions(context.n_atoms, *side, k as u64);
        let rest = vec![DVec3::ZERO; positions.len()];
        let mut state = State::new(cell, positions, rest);
        state.step = k as u64;
        observable.sample(&View::of(&state, &system));
    }
    observable
}

fn value(findings: &Findings, name: &str) -> (f64, f64) {
    let average = findings.averages.iter().find(|a| a.name == name).unwrap();
    assert_eq!(average.doubt, None, "{name}");
    (average.estimate.mean, average.estimate.standard_error)
}

#[test]
fn trial_particles_in_an_ideal_gas_give_the_exact_mean_weight() {
    // ⟨e^{−ΔU/T}⟩ over N independent places is [1 + (v/V)(e^{depth/T} − 1)]^N, times the tail.
    let (n, side, t) = (60_u32, 8.0_f64, 1.5);
    let square = Square { widths: [1.2; 2], depth: 0.8, tail: -30.0 };
    let well = 4.0 / 3.0 * std::f64::consts::PI * 1.2_f64.powi(3);
    let volume = side.powi(3);
    let one = 1.0 + well / volume * ((0.8_f64 / t).exp() - 1.0);
    let exact = -t * f64::from(n) * one.ln() - 30.0 / volume;
    let context =
        BuildContext { r_cut: 1.2, insertion: insertion(square, t), ..context(side, n as usize) };
    let findings = seen(&context, 500, &[side; 400]).finish(0.0);
    let (found, error) = value(&findings, "residual_chemical_potential");
    assert!((found - exact).abs() < 4.0 * error, "{found} ± {error}, exact {exact}");
    assert!(error < 0.01, "{error}");
    let (ln_z, _) = value(&findings, "ln_activity");
    assert!((ln_z - found / t - (f64::from(n) / volume).ln()).abs() < 1e-12);
}

#[test]
fn a_changing_volume_weighs_the_samples() {
    // Without interaction all weights are 1, whatever the volume: μ_res = 0.
    let square = Square { widths: [1.0; 2], depth: 0.0, tail: 0.0 };
    let context =
        BuildContext { r_cut: 1.0, insertion: insertion(square, 1.0), ..context(8.0, 40) };
    let sides: Vec<f64> = (0..100).map(|k| 8.0 + 0.1 * f64::from(k % 7)).collect();
    let findings = seen(&context, 10, &sides).finish(0.0);
    let (found, _) = value(&findings, "residual_chemical_potential");
    assert!(found.abs() < 1e-12, "{found}");
    let mean = sides.iter().map(|s| s.powi(3)).sum::<f64>() / sides.len() as f64;
    let (ln_z, error) = value(&findings, "ln_activity");
    assert!((ln_z - (40.0 / mean).ln()).abs() < 1e-12);
    assert!(error > 1e-4);
    // A tail that depends on the volume as 1/V gives larger boxes a smaller weight than their volume.
    let square = Square { widths: [1.0; 2], depth: 0.0, tail: -100.0 };
    let context = BuildContext { insertion: insertion(square, 1.0), ..context };
    let findings = seen(&context, 10, &sides).finish(0.0);
    let (found, _) = value(&findings, "residual_chemical_potential");
    let weighted = sides.iter().map(|s| s.powi(3) * (100.0 / s.powi(3)).exp());
    let exact = -(weighted.sum::<f64>() / sides.len() as f64 / mean).ln();
    assert!((found - exact).abs() < 1e-12, "{found} {exact}");
}

#[test]
fn each_species_meets_the_particles_of_each_other() {
    // A shoulder so high that a single overlap counts as none: ⟨w⟩ = Π_b (1 − v_b/V)^{N_b} for each species.
    let (n, side) = (60, 9.0_f64);
    let square = Square { widths: [0.9, 1.5], depth: -1e6, tail: 0.0 };
    let species: SpeciesTable = mixture(n, |i| usize::from(i % 3 == 0));
    let context =
        BuildContext { r_cut: 1.5, insertion: insertion(square, 1.0), species, ..context(side, n) };
    let findings = seen(&context, 500, &[side; 300]).finish(0.0);
    let free = |width: f64, count: i32| {
        let part = 4.0 / 3.0 * std::f64::consts::PI * (width / side).powi(3);
        f64::from(count) * (1.0 - part).ln()
    };
    let exact = -(free(0.9, 40) + free(1.5, 20));
    for name in ["residual_chemical_potential_A", "residual_chemical_potential_B"] {
        let (found, error) = value(&findings, name);
        assert!((found - exact).abs() < 4.0 * error, "{found} ± {error}, exact {exact}");
        assert!(error < 0.01, "{error}");
    }
}

#[test]
fn where_nothing_finds_room_there_is_no_number() {
    let square = Square { widths: [2.0; 2], depth: -1e6, tail: 0.0 };
    let context =
        BuildContext { r_cut: 2.0, insertion: insertion(square, 1.0), ..context(8.0, 150) };
    let findings = seen(&context, 50, &[8.0; 100]).finish(0.0);
    let average = &findings.averages[0];
    let doubt = average.doubt.as_ref().expect("too dense");
    assert!(doubt.takes_the_error());
    assert!(doubt.reason(1000).contains("too dense"), "{doubt:?}");
}

#[test]
fn without_a_bath_it_is_refused() {
    let options = ChemicalPotentialOptions::default();
    let Err(error) = options.build(&context(8.0, 10)) else { panic!("built") };
    assert_eq!(
        error.to_string(),
        "`kind` is \"chemical-potential\" without a bath; allowed: a measured stage whose bath holds one temperature"
    );
}
