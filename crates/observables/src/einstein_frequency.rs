//! The Einstein frequency.

use crate::{Average, Estimate, Findings, Observable, ObservableSpec, Suits, Surroundings, recipe};
use lennard_core::{View, Want, persist};

use crate::series::{Series, columns};

const SPEC: ObservableSpec = ObservableSpec {
    name: "einstein-frequency",
    summary: "the frequency at which a particle would vibrate in the cage of its neighbors at rest",
    equation: "Ω_E² = ⟨Σ ∇²U⟩/(3 N m); the velocity autocorrelation begins as 1 − Ω_E²·t²/2",
    source: "J.-P. Hansen and I. R. McDonald, Theory of Simple Liquids, section on the velocity autocorrelation function",
    suits: Suits::OneSpecies,
    surroundings: Surroundings::Periodic,
    alone: None,
    ..ObservableSpec::PLAIN
};

/// Rows kept before neighbors are averaged in pairs.
const MOST_ROWS: usize = 1 << 14;

lennard_core::options! {
    /// Options of [`EinsteinFrequency`]: there are none.
    pub struct EinsteinFrequencyOptions {}
}

recipe!(EinsteinFrequencyOptions, |_, _| EinsteinFrequency {
    series: Series::new(Rows::default(), MOST_ROWS)
});

columns! {
    struct Rows { time, squared }
}

/// The Einstein frequency Ω_E in τ⁻¹, from Ω_E² = ⟨Σ ∇²U⟩/(3 N m).
///
/// It is the root of a mean, and its error follows to first order.
#[derive(Debug, Clone, PartialEq)]
struct EinsteinFrequency {
    series: Series<Rows>,
}

impl Observable for EinsteinFrequency {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn want(&self) -> Want {
        Want { laplacian: true, ..Want::NOTHING }
    }

    /// # Panics
    /// Where the state lacks what [`Observable::want`] asks for: that is a bug of the caller.
    fn sample(&mut self, view: &View<'_>) {
        let state = view.state;
        let laplacian = state.energetics.laplacian.expect("the step was asked for it");
        let mass = view.system.masses.of(0);
        self.series.push(&[state.time, laplacian / (3.0 * view.len() as f64 * mass)]);
    }

    fn finish(&self, discarded: f64) -> Findings {
        let rows = self.series.rows();
        let cut = (discarded * rows.squared.len() as f64).ceil() as usize;
        let squared = self.series.average("einstein_frequency", "τ⁻¹", &rows.squared, cut);
        let root = squared.estimate.mean.sqrt();
        let error = 0.5 * squared.estimate.standard_error / root;
        let estimate = Estimate { mean: root, standard_error: error, ..squared.estimate };
        let what = "square of the Einstein frequency";
        let table =
            self.series.table("einstein_frequency", what, [("squared", "τ⁻²", &rows.squared)]);
        Findings {
            averages: vec![Average { estimate, ..squared }],
            tables: vec![table],
            remarks: Vec::new(),
        }
    }
}

persist!(EinsteinFrequency { series });
