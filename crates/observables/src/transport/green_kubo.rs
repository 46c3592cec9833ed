//! What all Green–Kubo coefficients share: correlation, plateau, cross-check.

use crate::{Doubt, Findings, Table, statistics};
use lennard_core::persist;

use super::helfand::Helfand;
use crate::averages::{of_blocks, tell_discarded};
use crate::blocks::BlockedSums;
use crate::correlator::{Correlation, Correlator};

/// Successive lags at which the correlation must be lost in its error before it counts as decayed: one or two
/// can be so by chance.
const LAGS_IN_NOISE: usize = 3;

/// The integral may still change by so many of its standard errors over the plateau.
const STILL_FLAT: f64 = 3.0;

/// A run of fewer windows than this is short: its correlation is lost in noise before it has decayed.
pub(super) const LONG_ENOUGH: f64 = 20.0;

/// Names and units of what comes out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Words {
    /// Name of the average (`shear_viscosity`), and of the table.
    pub name: &'static str,
    /// In a sentence (`shear viscosity`).
    pub plain: &'static str,
    /// Unit of the coefficient.
    pub unit: &'static str,
    /// Unit of the correlation function.
    pub correlation_unit: &'static str,
}

/// A transport coefficient κ = A ∫₀^∞ ⟨j(0) j(t)⟩ dt of a flux with several equivalent components.
///
/// **Plateau.** The correlation counts as decayed at t_d, the first of three successive lags at which it is
/// below two of its standard errors. The coefficient is the mean of the running integral from t_d to 2 t_d. Its
/// error comes from the same mean over blocks of the run. Where the integral still changes over that stretch by more
/// than three of its errors, the number is incomplete. Where t_d is not reached within half the window, there is no
/// number.
///
/// **Cross-check** of mutual diffusion. Half the slope of ⟨(G(t) − G(0))²⟩, G = ∫ j dt, over the same stretch of lags is the same
/// number by the road of Einstein and Helfand.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GreenKubo {
    correlator: Correlator,
    helfand: Option<Helfand>,
    window: f64,
    temperature: BlockedSums,
}

/// Where the running integral is flat.
struct Plateau {
    from: usize,
    to: usize,
}

impl GreenKubo {
    pub(crate) fn new(channels: usize, interval: f64, window: f64) -> Self {
        Self {
            correlator: Correlator::new(channels, interval, window),
            helfand: None,
            window,
            temperature: BlockedSums::new(1),
        }
    }

    /// The same with the cross-check.
    pub(crate) fn with_helfand(channels: usize, interval: f64, window: f64) -> Self {
        let helfand = Some(Helfand::new(channels, interval, window));
        Self { helfand, ..Self::new(channels, interval, window) }
    }

    pub(crate) fn push(&mut self, flux: &[f64], temperature: f64) {
        self.correlator.push(flux);
        if let Some(helfand) = &mut self.helfand {
            helfand.push(flux);
        }
        self.temperature.add_sample([temperature]);
    }

    /// The mean temperature of the samples after the first `discarded` part.
    pub(crate) fn mean_temperature(&self, discarded: f64) -> f64 {
        let kept = self.temperature.after(discarded);
        kept.mean(0).unwrap_or(f64::NAN)
    }

    /// Everything found after the first `discarded` part of the samples, with `prefactor` A.
    pub(crate) fn findings(&self, discarded: f64, prefactor: f64, words: Words) -> Findings {
        let correlator = self.correlator.after(discarded);
        let correlation = correlator.correlation();
        let mut findings = Findings::default();
        let Some(plateau) = plateau(&correlation, self.window) else {
            findings.remark(format!(
                "no {}: its correlation function does not decay into its noise within half the window of {} τ; \
                 a longer run or a longer `window` may help",
                words.plain, self.window
            ));
            findings.tables.extend(self.table(&correlation, prefactor, words));
            return findings;
        };
        let (from, to) = (correlation.times[plateau.from], correlation.times[plateau.to]);
        let stretch = plateau.from..=plateau.to;
        let mean = |integral: &[f64]| integral.iter().sum::<f64>() / integral.len() as f64;
        let value = prefactor * mean(&correlation.integral[stretch]);
        let rows = correlator.integral_blocks(plateau.to);
        let blocks: Vec<f64> =
            rows.iter().map(|row| prefactor * mean(&row[plateau.from..])).collect();
        let length = self.length(&correlation, discarded);
        let doubt = self.doubt(&correlation, &plateau, &rows, length);
        let mut add = |name: &str, value: f64, blocks: &[f64]| {
            let overlap = to * blocks.len() as f64 / length;
            let average = of_blocks(name, words.unit, value, blocks, overlap);
            findings.averages.push(average.doubted(doubt.clone()));
        };
        add(words.name, value, &blocks);
        let helfand = self.helfand.as_ref().map(|helfand| helfand.after(discarded));
        if let Some((slope, blocks)) = helfand.and_then(|helfand| helfand.half_slope(from, to)) {
            let blocks: Vec<f64> = blocks.iter().map(|b| prefactor * b).collect();
            let name = format!("{}_einstein_helfand", words.name);
            add(&name, prefactor * slope, &blocks);
        }
        let kept = self.temperature.after(discarded).samples();
        tell_discarded(&mut findings, self.temperature.samples() - kept);
        findings.remark(format!(
            "{}: plateau of the Green–Kubo integral from {from:.2} to {to:.2} τ{}",
            words.plain,
            if self.helfand.is_some() {
                "; the Einstein–Helfand value is the slope over the same lags"
            } else {
                ""
            }
        ));
        findings.tables.extend(self.table(&correlation, prefactor, words));
        findings
    }

    /// Length in τ of the part of the run that is kept.
    fn length(&self, correlation: &Correlation, discarded: f64) -> f64 {
        // The lags lie one interval apart at first.
        self.temperature.after(discarded).samples() as f64 * correlation.times[1]
    }

    /// Why the plateau is none, or not yet one that can be trusted.
    fn doubt(
        &self,
        correlation: &Correlation,
        plateau: &Plateau,
        rows: &[Vec<f64>],
        length: f64,
    ) -> Option<Doubt> {
        if length < LONG_ENOUGH * self.window {
            return Some(Doubt::TooShort {
                why: format!(
                    "only {:.1} times as long as the window of {} τ where {LONG_ENOUGH} are needed, so that noise can end \
                     the search for the plateau",
                    length / self.window,
                    self.window
                ),
                longer: LONG_ENOUGH * self.window / length,
            });
        }
        let rise = correlation.integral[plateau.to] - correlation.integral[plateau.from];
        let noise: Vec<f64> = rows.iter().map(|row| row[plateau.to] - row[plateau.from]).collect();
        let noise = statistics::error_of_mean(&noise).standard_error;
        (rise.abs() > STILL_FLAT * noise).then(|| {
            Doubt::Incomplete(format!(
                "the integral still changes by {:.1} of its standard errors over its plateau",
                rise.abs() / noise
            ))
        })
    }

    fn table(&self, c: &Correlation, prefactor: f64, words: Words) -> Option<Table> {
        let scaled = |column: &[f64]| column.iter().map(|x| prefactor * x).collect();
        let within = c.times.partition_point(|t| *t <= self.window);
        (within > 0).then(|| {
            Table::new(
                words.name,
                format!(
                    "correlation of the flux of the {} against lag, and its running Green–Kubo integral",
                    words.plain
                ),
            )
            .with("time", "τ", c.times[..within].to_vec())
            .with("correlation", words.correlation_unit, scaled(&c.values[..within]))
            .with("standard_error", words.correlation_unit, scaled(&c.errors[..within]))
            .with("integral", words.unit, scaled(&c.integral[..within]))
            .with("integral_standard_error", words.unit, scaled(&c.integral_errors[..within]))
        })
    }
}

/// Where the correlation is lost in its noise, and twice that lag.
fn plateau(c: &Correlation, window: f64) -> Option<Plateau> {
    let lost = |k: usize| c.values[k].abs() < 2.0 * c.errors[k];
    let last = c.times.len();
    let from =
        (1..last.saturating_sub(LAGS_IN_NOISE)).find(|&k| (k..k + LAGS_IN_NOISE).all(lost))?;
    let end = 2.0 * c.times[from];
    let to = c.times.partition_point(|t| *t <= end).checked_sub(1)?;
    (end <= window && to > from && c.times[last - 1] >= end).then_some(Plateau { from, to })
}

persist!(GreenKubo { correlator, helfand, temperature, fixed window });

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::synthetic::{Ar1, cover};
    use crate::testing::estimate;

    const WORDS: Words = Words { name: "x", plain: "x", unit: "", correlation_unit: "" };

    /// Three channels with correlation φ^k and unit variance.
    fn found(phi: f64, interval: f64, n: usize, seed: u64) -> Findings {
        let series: Vec<Vec<f64>> = (0..3).map(|c| Ar1::new(phi, 3 * seed + c).series(n)).collect();
        let mut both = GreenKubo::with_helfand(3, interval, 4.0);
        for ((a, b), c) in series[0].iter().zip(&series[1]).zip(&series[2]) {
            both.push(&[*a, *b, *c], 1.0);
        }
        both.findings(0.0, 2.0, WORDS)
    }

    #[test]
    fn both_roads_lead_to_the_integral_of_an_exponential_correlation_and_the_errors_cover_it() {
        let (phi, interval) = (0.9, 0.02);
        // Trapezoidal sum of φ^k: ½(1 + φ)/(1 − φ) intervals, times the prefactor.
        let exact = 2.0 * interval * 0.5 * (1.0 + phi) / (1.0 - phi);
        let all: Vec<Findings> = (0..24).map(|seed| found(phi, interval, 40_000, seed)).collect();
        for name in ["x", "x_einstein_helfand"] {
            let estimates: Vec<_> = all.iter().map(|found| estimate(found, name)).collect();
            // What is left of the exponential beyond the lag at which it drops below two errors is about 2 %. 24 seeds know their
            // spread to 15 %, and the end of the plateau is chosen anew in each.
            cover(&estimates, exact, 0.04 * exact, 0.6);
        }
    }

    #[test]
    fn a_correlation_that_does_not_decay_gives_no_number() {
        let mut both = GreenKubo::new(1, 0.02, 4.0);
        (0..4000).for_each(|i| both.push(&[2.0 + f64::from(i % 2)], 1.0));
        let findings = both.findings(0.0, 1.0, WORDS);
        assert!(
            findings.averages.is_empty()
                && findings.remarks.len() == 1
                && findings.tables.len() == 1
        );
    }
}
