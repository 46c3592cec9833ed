//! The transport coefficient of a fluid through which an exchange of velocities drives heat or momentum.

use crate::{BuildContext, Findings, Observable, ObservableSpec, Table};
use lennard_core::{Axis, View, persist};

use crate::averages::{of_blocks, tell_discarded};
use crate::blocks::BlockedSums;
use crate::statistics::Line;

const SPEC: ObservableSpec = ObservableSpec {
    name: "exchange-profile",
    summary: "temperature or velocity across the slabs of an exchange, and the transport coefficient from their slope",
    equation: "lambda or eta = carried/(2 A t |slope|)",
    source: "F. Müller-Plathe, J. Chem. Phys. 106, 6082 (1997), and Phys. Rev. E 59, 4894 (1999)",
    suits: crate::Suits::OneSpecies,
    alone: Some("goes with exchanges between particles far apart"),
    ..ObservableSpec::PLAIN
};

/// Slabs on each side of an exchanging one whose values are left out of the fit: velocities have not mixed there.
const LEFT_OUT: usize = 1;

/// What an exchange drives through the fluid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Driven {
    /// Heat, from the middle slab to the first one: λ = E/(2At·dT/dz).
    Heat,
    /// Momentum along an axis, from the first slab to the middle one: η = p/(2At·|dv/dz|).
    Momentum(Axis),
}

/// The profile across the slabs, and what the exchange carried.
///
/// What is carried from slab to slab flows back through the fluid on both sides, so that its flux is j = carried/(2At). The
/// profile is folded about the two slabs. A line is fitted to it, without these slabs and their neighbors, and λ or η is j
/// over its slope. The error is of a jackknife over blocks of the run, in which flux and slope move together.
///
/// T of a slab is ⟨m v²⟩/3, since nothing flows on average where heat is driven.
#[derive(Debug, Clone, PartialEq)]
pub struct ExchangeProfile {
    driven: Driven,
    axis: Axis,
    slabs: usize,
    /// Side along the axis, σ, and area across it, σ².
    side: f64,
    area: f64,
    /// Time between two samples, τ.
    interval: f64,
    /// Value of each slab, and what was carried before each sample.
    sums: BlockedSums,
    /// Whether there was a sample.
    begun: bool,
    /// Carried since the last sample.
    carried: f64,
}

impl ExchangeProfile {
    /// Nothing seen yet. `slabs` is even.
    #[must_use]
    pub fn new(driven: Driven, axis: Axis, slabs: usize, context: &BuildContext) -> Self {
        let side = context.cell.lengths()[axis.index()];
        Self {
            driven,
            axis,
            slabs,
            side,
            area: context.cell.volume() / side,
            interval: context.sample_interval(),
            sums: BlockedSums::new(slabs + 1),
            begun: false,
            carried: 0.0,
        }
    }

    /// Counts what an exchange carried, ε or mσ/τ.
    pub fn add_carried(&mut self, amount: f64) {
        if self.begun {
            self.carried += amount;
        }
    }

    /// Distances from the first slab of the slabs that are fitted, in slabs.
    fn fitted(&self) -> std::ops::RangeInclusive<usize> {
        1 + LEFT_OUT..=self.slabs / 2 - 1 - LEFT_OUT
    }

    /// The folded profile at the slabs of a range: distance from the middle of the first slab, σ, and value.
    fn folded(&self, means: &[f64], range: std::ops::RangeInclusive<usize>) -> Vec<(f64, f64)> {
        let width = self.side / self.slabs as f64;
        range.map(|k| (k as f64 * width, 0.5 * (means[k] + means[self.slabs - k]))).collect()
    }

    /// The flux through the fluid, ε/(σ²τ) or ε/σ³.
    fn flux(&self, means: &[f64]) -> f64 {
        means[self.slabs] / (2.0 * self.area * self.interval)
    }

    /// The slope against the flux, with the sign that makes coefficients positive.
    fn slope(&self, means: &[f64], range: std::ops::RangeInclusive<usize>) -> f64 {
        let slope = Line::through(&self.folded(means, range)).slope();
        match self.driven {
            Driven::Heat => slope,
            Driven::Momentum(_) => -slope,
        }
    }

    fn add_remarks(&self, means: &[f64], findings: &mut Findings) {
        let (first, last) = (*self.fitted().start(), *self.fitted().end());
        let line = self.folded(means, self.fitted());
        let (near, far) = (line[0].1, line[line.len() - 1].1);
        let (what, unit) = match self.driven {
            Driven::Heat => ("T", "ε/k_B"),
            Driven::Momentum(_) => ("the velocity", "σ/τ"),
        };
        findings.remark(format!(
            "{what} goes from {near:.4} to {far:.4} {unit} over the slabs that are fitted: the coefficient is a mean over these states"
        ));
        let middle = (first + last) / 2;
        if middle > first && last > middle {
            let halves = [first..=middle, middle..=last].map(|half| self.slope(means, half));
            findings.remark(format!(
                "slope of the half near the first slab {:.4}, of the half near the middle slab {:.4} {unit} per σ",
                halves[0], halves[1]
            ));
        }
    }
}

impl Observable for ExchangeProfile {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn sample(&mut self, view: &View<'_>) {
        // What was carried before the first sample belongs to no interval between two.
        let carried = std::mem::take(&mut self.carried);
        if !std::mem::replace(&mut self.begun, true) {
            return;
        }
        let (cell, masses) = (view.cell(), &view.system.masses);
        let (slabs, axis) = (self.slabs, self.axis.index());
        let per_length = slabs as f64 / cell.lengths()[axis];
        self.sums.begin_sample();
        let (sums, counts) = self.sums.current();
        let particles = view.state.positions.iter().zip(&view.state.velocities);
        for (i, (r, v)) in particles.enumerate() {
            let slab = ((cell.wrap(*r)[axis] * per_length) as usize).min(slabs - 1);
            sums[slab] += match self.driven {
                Driven::Heat => masses.of(i) * v.length_squared() / 3.0,
                Driven::Momentum(along) => v[along.index()],
            };
            counts[slab] += 1;
        }
        sums[slabs] += carried;
        counts[slabs] += 1;
    }

    fn finish(&self, discarded: f64) -> Findings {
        let sums = self.sums.after(discarded);
        let (name, unit, flux_name, flux_unit, column, value_unit) = match self.driven {
            Driven::Heat => (
                "thermal_conductivity_by_exchange",
                "k_B/(σ τ)",
                "heat_flux",
                "ε/(σ² τ)",
                "temperature",
                "ε/k_B",
            ),
            Driven::Momentum(_) => {
                ("viscosity_by_exchange", "ε τ/σ³", "momentum_flux", "ε/σ³", "velocity", "σ/τ")
            }
        };
        let coefficient = |means: &[f64]| Some(self.flux(means) / self.slope(means, self.fitted()));
        let flux = |means: &[f64]| Some(self.flux(means));
        let mut findings = Findings::default();
        if let Some((value, blocks)) = sums.jackknife(coefficient) {
            let average = of_blocks(name, unit, value, &blocks, 0.0);
            findings.averages.push(average);
        }
        if let Some((value, blocks)) = sums.jackknife(flux) {
            let average = of_blocks(flux_name, flux_unit, value, &blocks, 0.0);
            findings.averages.push(average);
        }
        if sums.samples() > 0 {
            let [means, _] = sums.curve(0..self.slabs + 1, 1.0);
            self.add_remarks(&means, &mut findings);
        }
        let width = self.side / self.slabs as f64;
        let slab_volume = width * self.area * sums.samples() as f64;
        let of_slabs = |of: &dyn Fn(usize) -> f64| (0..self.slabs).map(of).collect::<Vec<f64>>();
        let [values, errors] = sums.curve(0..self.slabs, 1.0);
        findings.tables.push(
            Table::new(
                "exchange_profile",
                "profile across the slabs of the exchange, with standard errors from blocks of the run",
            )
            .with(self.axis.name(), "σ", of_slabs(&|k| (k as f64 + 0.5) * width))
            .with("density", "σ⁻³", of_slabs(&|k| sums.total(k).1 as f64 / slab_volume))
            .with(column, value_unit, values)
            .with("standard_error", value_unit, errors),
        );
        tell_discarded(&mut findings, self.sums.samples() - sums.samples());
        findings
    }
}

persist!(ExchangeProfile { sums, begun, carried, fixed driven, axis, slabs, side, area, interval });

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{context, normal};
    use lennard_core::{DVec3, State, System};

    /// Samples of particles at rest in their slabs, whose mean value is linear between the first and the middle slab.
    fn shown(driven: Driven, profile: &mut ExchangeProfile, steps: std::ops::Range<u64>) {
        let context = context(10.0, 400);
        let system = System::atoms(400);
        for step in steps {
            let place = |i: usize| DVec3::new(1.0, 1.0, 10.0 * (i as f64 + 0.5) / 400.0);
            let positions: Vec<DVec3> = (0..400).map(place).collect();
            let velocities = (0..400).map(|i| {
                // Slab by slab, as the profile sees it: from 0 in the first slab to 5 in the middle one.
                let slab = i / 40;
                let distance = slab.min(10 - slab) as f64;
                let noise = normal(7, step, i);
                match driven {
                    Driven::Heat => noise * (1.0 + 0.1 * distance).sqrt(),
                    Driven::Momentum(_) => noise - DVec3::X * (0.2 * distance),
                }
            });
            let mut state = State::new(context.cell, positions.clone(), velocities.collect());
            state.step = step;
            profile.add_carried(0.5);
            profile.sample(&View::of(&state, &system));
        }
    }

    #[test]
    fn a_linear_profile_gives_flux_over_slope() {
        for (driven, slope) in [(Driven::Heat, 0.1), (Driven::Momentum(Axis::X), 0.2)] {
            let context = context(10.0, 400);
            let mut profile = ExchangeProfile::new(driven, Axis::Z, 10, &context);
            shown(driven, &mut profile, 0..400);
            let findings = profile.finish(0.0);
            // 0.5 for each interval of 0.01 through two areas of 100.
            let flux = 0.5 / (2.0 * 100.0 * context.sample_interval());
            assert!((findings.averages[1].estimate.mean - flux).abs() < 1e-12);
            let found = findings.averages[0].estimate;
            let exact = flux / slope;
            assert!((found.mean - exact).abs() < 4.0 * found.standard_error, "{found:?} {exact}");
            assert!(found.standard_error < 0.15 * exact, "{found:?}");
            let columns = &findings.tables[0].columns;
            assert!((columns[1].numbers()[3] - 0.4).abs() < 1e-12);
        }
    }
}
