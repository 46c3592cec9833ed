//! The velocity autocorrelation function.

use crate::{
    BuildContext, Findings, Frames, Observable, ObservableError, ObservableSpec, Remark, Table,
    recipe,
};
use lennard_core::{DVec3, View, persist};

use crate::averages::tell_discarded;
use crate::blocks::BlockedSums;
use crate::error::within;
use crate::over_lags::OverLags;
use crate::time_origins::{Origins, TimeOrigins};
use crate::tracked::{DEFAULT_TRACKED, Tracked};

const SPEC: ObservableSpec = ObservableSpec {
    name: "vacf",
    summary: "velocity autocorrelation function and its Green–Kubo integral, the diffusion coefficient",
    equation: "C(t) = ⟨v(t₀)·v(t₀+t)⟩; D = ⅓ ∫₀^∞ C dt",
    source: "A. Rahman, Correlations in the motion of atoms in liquid argon, Phys. Rev. 136, A405 (1964); \
             J.-P. Hansen and I. R. McDonald, Theory of Simple Liquids, 4th ed. (2013), equation 7.2.10",
    dynamic: true,
    every: 5,
    frames: Frames::Flows,
    alone: None,
    ..ObservableSpec::PLAIN
};

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

recipe!(VacfOptions, |options, context| VelocityAutocorrelation::new(options, context)?);

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
    products: OverLags<TimeOrigins>,
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
        let tracked = Tracked::new(&context.own, options.particles);
        let window = (options.window, options.origins);
        let vectors = ("velocities", &tracked.own);
        let origins = TimeOrigins::new(window, context.sample_interval(), vectors)?;
        within("particles", options.particles, 1..=usize::MAX)?;
        let of_species = tracked.by_species(&context.species);
        Ok(Self {
            products: OverLags::new("products", 1, origins, &tracked.own, of_species),
            tracked,
        })
    }

    /// ⅓∫₀^t C by the trapezoidal rule, at each lag.
    fn running_integral(&self, c: &[f64]) -> Vec<f64> {
        let mut sum = 0.0;
        c.iter()
            .enumerate()
            .map(|(k, value)| {
                if k > 0 {
                    sum += 0.5 * (c[k - 1] + value) * self.products.origins.interval / 3.0;
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
        let name = format!("diffusion_coefficient_green_kubo{suffix}");
        let last = |c: &[f64]| *self.running_integral(c).last().expect("a window has lags");
        let function = (0, "the velocity autocorrelation");
        let (average, [c, errors]) =
            self.products.integrated(products, function, (&name, "σ²/τ"), last)?;
        findings.averages.push(average);
        let integral = self.running_integral(&c);
        Some(Curve { c, errors, integral })
    }
}

impl Observable for VelocityAutocorrelation {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn sample(&mut self, view: &View<'_>) {
        let now = self.tracked.relative_to_centre_of_mass(view.system, &view.state.velocities);
        self.products.sample(&now, [DVec3::dot]);
    }

    fn finish(&self, discarded: f64) -> Findings {
        let mut findings = Findings::default();
        findings.remarks.extend(self.tracked.remark().map(Remark::from));
        let products = self.products.after(discarded);
        let Some(Curve { c, errors, integral }) = self.report(&products, "", &mut findings) else {
            findings.remark("no velocity autocorrelation: the run is shorter than its window");
            return findings;
        };
        findings.remark("diffusion_coefficient_green_kubo is not corrected for finite size");
        if c[1] < FINE_ENOUGH * c[0] {
            findings.remark(
                "the velocity autocorrelation falls by half in one sampling interval: sample more often for a good integral",
            );
        }
        let normalised = c.iter().map(|value| value / c[0]).collect();
        let mut table = Table::new(
            "vacf",
            "velocity autocorrelation function against lag, and a third of its running integral",
        )
        .with("time", "τ", self.products.origins.times())
        .with("vacf", "σ²/τ²", c)
        .with("standard_error", "σ²/τ²", errors)
        .with("normalised", "", normalised)
        .with("diffusion", "σ²/τ", integral);
        for (species, products) in self.products.of_species(discarded) {
            let found = self.report(&products, &species.suffix, &mut findings);
            if let Some(curve) = found {
                let name = |of: &str| species.named(of);
                table = table
                    .with(name("vacf"), "σ²/τ²", curve.c)
                    .with(name("standard_error"), "σ²/τ²", curve.errors)
                    .with(name("diffusion"), "σ²/τ", curve.integral);
            }
        }
        tell_discarded(&mut findings, self.products.origins.samples() - products.samples());
        findings.tables.push(table);
        findings
    }
}

persist!(VelocityAutocorrelation { ..products, fixed tracked });

#[cfg(test)]
mod tests;
