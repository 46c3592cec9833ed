//! Total momentum.

use crate::{
    Average, BuildContext, Findings, Frames, Observable, ObservableSpec, Table, recipe, statistics,
};
use lennard_core::{View, persist};

use crate::series::{Series, columns};

const SPEC: ObservableSpec = ObservableSpec {
    name: "momentum",
    summary: "total momentum per particle against time",
    equation: "p = Σ m v / N",
    source: "H. Goldstein, Classical Mechanics, 2nd ed. (1980), equation 1-20: conserved where internal forces obey Newton's third law",
    every: 100,
    frames: Frames::Velocities,
    alone: None,
    ..ObservableSpec::PLAIN
};

/// Rows kept before neighbors are averaged in pairs.
const MOST_ROWS: usize = 1 << 14;

lennard_core::options! {
    /// Options of [`Momentum`]: there are none.
    pub struct MomentumOptions {}
}

recipe!(MomentumOptions, |_, context| Momentum::new(context));

columns! {
    struct Rows { time, x, y, z }
}

/// The total momentum per particle, Σ m v / N, in σ/τ.
///
/// Internal forces leave it as it is; what grows is rounding, or a pair force that is not antisymmetric.
/// Under Langevin dynamics it fluctuates with variance T/N (unit mass) in each direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Momentum {
    series: Series<Rows>,
    largest: f64,
}

impl Momentum {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(_context: &BuildContext) -> Self {
        Self { series: Series::new(Rows::default(), MOST_ROWS), largest: 0.0 }
    }
}

impl Observable for Momentum {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn sample(&mut self, view: &View<'_>) {
        let state = view.state;
        let p = view.system.momentum(&state.velocities) / view.len() as f64;
        self.largest = self.largest.max(p.length());
        self.series.push(&[state.time, p.x, p.y, p.z]);
    }

    /// Momentum is conserved, or drawn anew by a bath, from the first step on: nothing is discarded.
    fn finish(&self, _discarded: f64) -> Findings {
        let rows = self.series.rows();
        let average = |name: &str, column: &[f64]| {
            Average::new(name, "σ/τ per particle", statistics::estimate_stationary(column))
        };
        Findings {
            averages: vec![
                average("momentum_x", &rows.x),
                average("momentum_y", &rows.y),
                average("momentum_z", &rows.z),
            ],
            tables: vec![
                Table::new("momentum", "total momentum per particle against time")
                    .with("time", "τ", rows.time.clone())
                    .with("x", "σ/τ", rows.x.clone())
                    .with("y", "σ/τ", rows.y.clone())
                    .with("z", "σ/τ", rows.z.clone()),
            ],
            remarks: vec![
                format!("largest total momentum per particle: {:.3e} σ/τ", self.largest).into(),
            ],
        }
    }
}

persist!(Momentum { series, largest });
