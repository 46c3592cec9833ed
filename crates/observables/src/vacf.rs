//! The velocity autocorrelation function.

use lennard_core::{
    DVec3, Findings, Observable, ObservableSpec, Persist, RestoreError, StateReader, StateWriter,
    Table, View, Want,
};

use crate::averages::{of_blocks, tell_discarded};
use crate::blocks::BlockedSums;
use crate::error::within;
use crate::time_origins::TimeOrigins;
use crate::tracked::{DEFAULT_TRACKED, OfSpecies, Tracked, sum_over_pairs};
use crate::{BuildContext, ObservableError, Recipe};

const SPEC: ObservableSpec = ObservableSpec {
    name: "vacf",
    summary: "velocity autocorrelation function and its Green–Kubo integral, the diffusion coefficient",
    equation: "C(t) = ⟨v(t₀)·v(t₀+t)⟩; D = ⅓ ∫₀^∞ C dt",
    source: "A. Rahman, Correlations in the motion of atoms in liquid argon, Phys. Rev. 136, A405 (1964); \
             J.-P. Hansen and I. R. McDonald, Theory of Simple Liquids, 4th ed. (2013), equation 7.2.10",
    dynamic: true,
    suits: lennard_core::Suits::All,
};

/// Blocks of the run from which the errors come.
const BLOCKS: usize = 64;

/// Below this value at the first lag the sampling is too coarse for the trapezoidal rule. For a function
/// that starts as 1 − (Ωt)²/2, the rule errs by about a tenth of the loss in the first interval.
const FINE_ENOUGH: f64 = 0.5;

lennard_core::options! {
    /// Options of [`VelocityAutocorrelation`].
    pub struct VacfOptions {
        /// Longest lag.
        window: f64 = 4.0, Between(1e-9, 1e9), in "τ";
        /// Number of time origins followed at once.
        origins: usize = 16, Whole(1, 10_000);
        /// Number of particles followed, evenly chosen.
        particles: usize = DEFAULT_TRACKED, Whole(1, 10_000_000);
    }
}

impl Recipe for VacfOptions {
    const SPEC: &'static ObservableSpec = &SPEC;

    fn default_every(&self) -> u64 {
        5
    }

    fn follows_changing_box(&self) -> bool {
        true
    }

    fn build(&self, context: &BuildContext) -> Result<Box<dyn Observable>, ObservableError> {
        Ok(Box::new(VelocityAutocorrelation::new(self, context)?))
    }
}

/// The velocity autocorrelation function C(t) = ⟨v(0)·v(t)⟩ in σ²/τ², relative to the centre of mass, over
/// many time origins. D = ⅓∫C dt follows by the trapezoidal rule up to the end of the window.
///
/// For unit masses C(0) = 3T·(N − 1)/N. D from here and from the mean-square displacement are the same
/// number by two roads; neither is corrected for finite size here.
///
/// In a mixture each species has its own function and its own D. C(0) of a species is 3T/m_a, but for the centre of mass.
/// A box that changes leaves the function as it is: velocities are those relative to the box.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityAutocorrelation {
    tracked: Tracked,
    /// Time origins with velocities.
    origins: TimeOrigins,
    products: BlockedSums,
    /// The species of a mixture; empty where there is one.
    of_species: Vec<OfSpecies>,
}

/// What was found of all particles, or of one species.
struct Curve {
    c: Vec<f64>,
    errors: Vec<f64>,
    integral: Vec<f64>,
}

impl VelocityAutocorrelation {
    /// Nothing seen yet.
    ///
    /// # Errors
    /// [`ObservableError`] where the window holds no two samples or more than 10,000, or there is no origin.
    pub fn new(options: &VacfOptions, context: &BuildContext) -> Result<Self, ObservableError> {
        let tracked = Tracked::new(context.n_atoms, options.particles);
        let window = (options.window, options.origins);
        let origins = TimeOrigins::new(window, context.sample_interval(), tracked.len())?;
        within("particles", options.particles, 1..=usize::MAX)?;
        let sums = || BlockedSums::new(origins.lags, BLOCKS);
        Ok(Self {
            of_species: tracked.sums_by_species(&context.species, sums),
            tracked,
            products: sums(),
            origins,
        })
    }

    /// ⅓∫₀^t C by the trapezoidal rule, at each lag.
    fn running_integral(&self, c: &[f64]) -> Vec<f64> {
        let mut sum = 0.0;
        c.iter()
            .enumerate()
            .map(|(k, value)| {
                if k > 0 {
                    sum += 0.5 * (c[k - 1] + value) * self.origins.interval / 3.0;
                }
                sum
            })
            .collect()
    }

    /// The function of all particles or of a species, of which the diffusion coefficient is added; `None` where the run is
    /// shorter than the window.
    fn report(
        &self,
        products: &BlockedSums,
        suffix: &str,
        findings: &mut Findings,
    ) -> Option<Curve> {
        let lags = self.origins.lags;
        let means = (0..lags).map(|k| products.mean(k));
        let c = means.collect::<Option<Vec<f64>>>()?;
        let errors: Vec<f64> = (0..lags).map(|k| products.standard_error(k)).collect();
        let integral = self.running_integral(&c);
        let every_lag: Vec<usize> = (0..lags).collect();
        let last = lags - 1;
        let blocks: Vec<f64> = products
            .complete_rows(&every_lag)
            .iter()
            .map(|c| self.running_integral(c)[last])
            .collect();
        let function = "the velocity autocorrelation";
        let undecayed = self.origins.undecayed(function, &c, &errors);
        findings.averages.push(
            of_blocks(
                &format!("diffusion_coefficient_green_kubo{suffix}"),
                "σ²/τ",
                integral[last],
                &blocks,
                last as f64 * blocks.len() as f64 / products.samples() as f64,
            )
            .doubted(undecayed),
        );
        Some(Curve { c, errors, integral })
    }
}

impl Observable for VelocityAutocorrelation {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn want(&self) -> Want {
        Want::NOTHING
    }

    fn sample(&mut self, view: &View<'_>) {
        let now = self.tracked.relative_to_centre_of_mass(view.system, &view.state.velocities);
        let weight = 1.0 / now.len().max(1) as f64;
        self.products.begin_sample();
        for species in &mut self.of_species {
            species.sums.begin_sample();
        }
        self.origins.see(&now, |lag, then| {
            let sum = sum_over_pairs(&now, then, DVec3::dot);
            self.products.add(lag, sum * weight, 1);
            for species in &mut self.of_species {
                species.add_mean(lag, &now, then, DVec3::dot);
            }
        });
    }

    fn finish(&self, discarded: f64) -> Findings {
        let mut findings = Findings::default();
        findings.remarks.extend(self.tracked.remark());
        let products = self.products.after(discarded);
        let Some(Curve { c, errors, integral }) = self.report(&products, "", &mut findings) else {
            findings
                .remarks
                .push("no velocity autocorrelation: the run is shorter than its window".into());
            return findings;
        };
        findings
            .remarks
            .push("diffusion_coefficient_green_kubo is not corrected for finite size".into());
        if c[1] < FINE_ENOUGH * c[0] {
            findings.remarks.push(
                "the velocity autocorrelation falls by half in one sampling interval: sample more often for a good integral".into(),
            );
        }
        let normalised = c.iter().map(|value| value / c[0]).collect();
        let mut table = Table::new(
            "vacf",
            "velocity autocorrelation function against lag, and a third of its running integral",
        )
        .with("time", "τ", self.origins.times())
        .with("vacf", "σ²/τ²", c)
        .with("standard_error", "σ²/τ²", errors)
        .with("normalised", "", normalised)
        .with("diffusion", "σ²/τ", integral);
        for species in &self.of_species {
            let products = species.sums.after(discarded);
            let found = self.report(&products, &species.suffix, &mut findings);
            if let Some(curve) = found {
                let name = |of: &str| species.section(of);
                table = table
                    .with(name("vacf"), "σ²/τ²", curve.c)
                    .with(name("standard_error"), "σ²/τ²", curve.errors)
                    .with(name("diffusion"), "σ²/τ", curve.integral);
            }
        }
        tell_discarded(&mut findings, self.origins.samples - products.samples());
        findings.tables.push(table);
        findings
    }
}

impl Persist for VelocityAutocorrelation {
    fn save(&self, to: &mut StateWriter<'_>) {
        self.origins.save("velocities", to);
        self.products.save(&mut to.section("products"));
        for species in &self.of_species {
            let section = species.section("products");
            species.sums.save(&mut to.section(&section));
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.origins.restore("velocities", from)?;
        self.products.restore(&from.section("products"))?;
        for species in &mut self.of_species {
            let section = species.section("products");
            species.sums.restore(&from.section(&section))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
