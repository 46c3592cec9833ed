//! The velocity autocorrelation function.

use std::collections::VecDeque;

use lennard_core::{
    DVec3, Doubt, Findings, Observable, ObservableSpec, Persist, RestoreError, StateReader,
    StateWriter, Table, View, Want,
};

use crate::averages::{of_blocks, tell_discarded};
use crate::blocks::BlockedSums;
use crate::error::{positive, within};
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

/// Most lags of the function.
const MOST_LAGS: usize = 10_000;

/// The function counts as decayed where its end is below this part of its beginning.
const DECAYED: f64 = 0.01;

/// Below this value at the first lag the sampling is too coarse for the trapezoidal rule. For a function
/// that starts as 1 − (Ωt)²/2, the rule errs by about a tenth of the loss in the first interval.
const FINE_ENOUGH: f64 = 0.5;

lennard_core::options! {
    /// Options of [`VelocityAutocorrelation`].
    pub struct VacfOptions {
        /// Longest lag.
        window: f64 = 4.0, Positive, in "τ";
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
    interval: f64,
    lags: usize,
    spacing: u64,
    tracked: Tracked,
    samples: u64,
    /// Time origins, oldest first: number of the sample and velocities there.
    origins: VecDeque<(u64, Vec<DVec3>)>,
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
        let interval = context.sample_interval();
        positive("window", Some(options.window))?;
        let steps = (options.window / interval).round();
        if !(2.0..=MOST_LAGS as f64).contains(&steps) {
            return Err(ObservableError::new(
                "window",
                options.window,
                format!(
                    "from 2 to {MOST_LAGS} sampling intervals of {interval} τ (change `window` or `every`)"
                ),
            ));
        }
        within("origins", options.origins, 1..=MOST_LAGS)?;
        within("particles", options.particles, 1..=usize::MAX)?;
        let lags = steps as usize + 1;
        let tracked = Tracked::new(context.n_atoms, options.particles);
        let sums = || BlockedSums::new(lags, BLOCKS);
        Ok(Self {
            interval,
            lags,
            spacing: lags.div_ceil(options.origins) as u64,
            of_species: tracked.sums_by_species(&context.species, sums),
            tracked,
            samples: 0,
            origins: VecDeque::new(),
            products: sums(),
        })
    }

    fn times(&self) -> Vec<f64> {
        (0..self.lags).map(|k| k as f64 * self.interval).collect()
    }

    /// ⅓∫₀^t C by the trapezoidal rule, at each lag.
    fn running_integral(&self, c: &[f64]) -> Vec<f64> {
        let mut sum = 0.0;
        c.iter()
            .enumerate()
            .map(|(k, value)| {
                if k > 0 {
                    sum += 0.5 * (c[k - 1] + value) * self.interval / 3.0;
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
        let means = (0..self.lags).map(|k| products.mean(k));
        let c = means.collect::<Option<Vec<f64>>>()?;
        let errors: Vec<f64> = (0..self.lags).map(|k| products.standard_error(k)).collect();
        let integral = self.running_integral(&c);
        let every_lag: Vec<usize> = (0..self.lags).collect();
        let blocks: Vec<f64> = products
            .complete_rows(&every_lag)
            .iter()
            .map(|c| self.running_integral(c)[self.lags - 1])
            .collect();
        let last = self.lags - 1;
        let undecayed = (c[last].abs() > (DECAYED * c[0]).max(3.0 * errors[last])).then(|| {
            Doubt::Incomplete(format!(
                "the velocity autocorrelation has not decayed at the end of its window, {:.3} τ",
                last as f64 * self.interval
            ))
        });
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
        Some(Curve {
            c,
            errors,
            integral,
        })
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
        let now = self
            .tracked
            .relative_to_centre_of_mass(view.system, &view.state.velocities);
        let weight = 1.0 / now.len().max(1) as f64;
        let expired = |&(born, _): &(u64, _)| self.samples - born >= self.lags as u64;
        while self.origins.front().is_some_and(expired) {
            self.origins.pop_front();
        }
        if self.samples.is_multiple_of(self.spacing) {
            self.origins.push_back((self.samples, now.clone()));
        }
        self.products.begin_sample();
        for species in &mut self.of_species {
            species.sums.begin_sample();
        }
        for (born, then) in &self.origins {
            let lag = (self.samples - born) as usize;
            let sum = sum_over_pairs(&now, then, DVec3::dot);
            self.products.add(lag, sum * weight, 1);
            for species in &mut self.of_species {
                species.add_mean(lag, &now, then, DVec3::dot);
            }
        }
        self.samples += 1;
    }

    fn finish(&self, discarded: f64) -> Findings {
        let mut findings = Findings::default();
        findings.remarks.extend(self.tracked.remark());
        let products = self.products.after(discarded);
        let Some(Curve {
            c,
            errors,
            integral,
        }) = self.report(&products, "", &mut findings)
        else {
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
        .with("time", "τ", self.times())
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
        tell_discarded(&mut findings, self.samples - products.samples());
        findings.tables.push(table);
        findings
    }
}

impl Persist for VelocityAutocorrelation {
    fn save(&self, to: &mut StateWriter<'_>) {
        to.put_u64("samples", &[self.samples]);
        self.products.save(&mut to.section("products"));
        for species in &self.of_species {
            let section = species.section("products");
            species.sums.save(&mut to.section(&section));
        }
        let born: Vec<u64> = self.origins.iter().map(|(born, _)| *born).collect();
        to.put_u64("origins", &born);
        let all: Vec<DVec3> = self.origins.iter().flat_map(|(_, v)| v).copied().collect();
        to.put_vec3("velocities", &all);
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        [self.samples] = from.u64s("samples")?;
        self.products.restore(&from.section("products"))?;
        for species in &mut self.of_species {
            let section = species.section("products");
            species.sums.restore(&from.section(&section))?;
        }
        let born = from.u64("origins")?;
        let all = from.vec3("velocities")?;
        let n = self.tracked.len();
        if all.len() != born.len() * n || born.iter().any(|b| *b >= self.samples) {
            return Err(from.misfit(
                "velocities",
                format!("{} vectors for {} origins of {n}", all.len(), born.len()),
            ));
        }
        self.origins = born
            .iter()
            .copied()
            .zip(all.chunks(n.max(1)).map(<[DVec3]>::to_vec))
            .collect();
        Ok(())
    }
}

#[cfg(test)]
mod tests;
