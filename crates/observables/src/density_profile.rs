//! The density along one axis.

use crate::{BuildContext, Findings, Observable, ObservableSpec, Table, recipe};
use lennard_core::{Axis, View, persist};

use crate::averages::tell_discarded;
use crate::blocks::BlockedSums;
use crate::seen_box::SeenBox;

const SPEC: ObservableSpec = ObservableSpec {
    name: "density-profile",
    summary: "number density in layers across one axis: of a slit, a slab or any other fluid",
    equation: "rho(z) = <N(z, z + dz)>/(A dz)",
    source: "the definition of a density: particles of a layer over its volume",
    every: 20,
    alone: None,
    ..ObservableSpec::PLAIN
};

lennard_core::options! {
    /// Options of [`DensityProfile`].
    pub struct DensityProfileOptions {
        /// Axis of the profile.
        axis: Axis = Axis::Z, Names(Axis::names);
        /// Number of layers of equal width over the whole box.
        bins: usize = 200, Whole(1, 100_000);
    }
}

recipe!(DensityProfileOptions, |options, context| DensityProfile::new(options, context));

/// The number density in layers across one axis, ρ(z) in σ⁻³, with its standard error from blocks of the run.
///
/// Layers divide the whole box. Between walls, those behind the planes are empty. In a box that changes, layers keep
/// their part of the side, and the density is taken in the mean box.
#[derive(Debug, Clone, PartialEq)]
pub struct DensityProfile {
    axis: Axis,
    seen: SeenBox,
    counts: BlockedSums,
}

impl DensityProfile {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(options: &DensityProfileOptions, context: &BuildContext) -> Self {
        Self {
            axis: options.axis,
            seen: SeenBox::new(&context.cell),
            counts: BlockedSums::new(options.bins),
        }
    }
}

impl Observable for DensityProfile {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn sample(&mut self, view: &View<'_>) {
        let cell = view.cell();
        self.seen.see(cell);
        let bins = self.counts.width();
        let layers = bins as f64 / cell.lengths()[self.axis.index()];
        let mut counts = vec![0; bins];
        for r in &view.state.positions {
            let layer = (cell.wrap(*r)[self.axis.index()] * layers) as usize;
            counts[layer.min(bins - 1)] += 1;
        }
        view.system.own().add_up(&mut counts);
        self.counts.add_sample(counts.into_iter().map(|count| count as f64));
    }

    fn finish(&self, discarded: f64) -> Findings {
        let counts = self.counts.after(discarded);
        let (bins, sides) = (counts.width(), self.seen.sides());
        let width = sides[self.axis.index()] / bins as f64;
        let [densities, errors] = counts.curve(0..bins, bins as f64 / self.seen.volume());
        let name = self.axis.name();
        let table = Table::new(
            "density_profile",
            format!("number density in layers across {name}, with standard errors from blocks of the run"),
        )
        .with(name, "σ", (0..bins).map(|k| (k as f64 + 0.5) * width).collect())
        .with("density", "σ⁻³", densities)
        .with("standard_error", "σ⁻³", errors);
        let mut findings = Findings { tables: vec![table], ..Findings::default() };
        tell_discarded(&mut findings, self.counts.samples() - counts.samples());
        findings
    }
}

persist!(DensityProfile { counts, seen as "box", fixed axis });
