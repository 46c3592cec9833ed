//! The Einstein–Helfand road to a transport coefficient: the mean-square growth of an integrated flux.

use lennard_core::{Persist, RestoreError, StateReader, StateWriter};

use crate::ladder::Ladder;

/// The mean square change ⟨(G(t₀ + t) − G(t₀))²⟩ of G = ∫ flux dt, averaged over equivalent channels.
///
/// G is summed by the trapezoidal rule. Level ℓ looks at every 2^ℓ-th value of G and serves lags of 8·2^ℓ to
/// 15·2^ℓ samples; level 0 serves all up to 15. Memory is therefore bounded however long the lags.
///
/// Source: E. Helfand, "Transport coefficients from dissipation in a canonical ensemble", Phys. Rev. 119, 1
/// (1960), equation 1.6.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Helfand {
    channels: usize,
    interval: f64,
    samples: u64,
    integral: Vec<f64>,
    last: Vec<f64>,
    squares: Ladder,
}

impl Helfand {
    /// Nothing seen yet: `channels` values a sample, `interval` τ apart, lags up to at least `longest_lag` τ.
    pub(crate) fn new(channels: usize, interval: f64, longest_lag: f64) -> Self {
        Self {
            channels,
            interval,
            samples: 0,
            integral: vec![0.0; channels],
            last: Vec::new(),
            squares: Ladder::new(channels, interval, longest_lag),
        }
    }

    /// The same without the changes that end in the first `discarded` part of the samples, from 0 to 1.
    pub(crate) fn after(&self, discarded: f64) -> Self {
        Self { squares: self.squares.after(discarded), ..self.clone() }
    }

    /// Takes the flux of one sample.
    pub(crate) fn push(&mut self, flux: &[f64]) {
        for ((sum, before), now) in self.integral.iter_mut().zip(&self.last).zip(flux) {
            *sum += 0.5 * self.interval * (before + now);
        }
        self.last = flux.to_vec();
        self.squares.sums.begin_sample();
        for l in 0..self.squares.levels() {
            if !self.samples.is_multiple_of(1 << l) {
                break;
            }
            self.squares.push(l, &self.integral, |now, then| (now - then).powi(2));
        }
        self.samples += 1;
    }

    /// Half the slope of the mean square change from lag `from` to lag `to` (τ), and the same for each block;
    /// `None` where no two lags lie there.
    pub(crate) fn half_slope(&self, from: f64, to: f64) -> Option<(f64, Vec<f64>)> {
        let (lags, quantities) = self.squares.reached();
        let inside: Vec<(f64, usize)> =
            lags.into_iter().zip(quantities).filter(|(t, _)| (from..=to).contains(t)).collect();
        let (&(early, a), &(late, b)) = (inside.first()?, inside.last()?);
        if early >= late {
            return None;
        }
        let half = |early_square: f64, late_square: f64| {
            0.5 * (late_square - early_square) / (late - early)
        };
        let sums = &self.squares.sums;
        let value = half(sums.mean(a)?, sums.mean(b)?);
        let blocks = sums.complete_rows(&[a, b]).iter().map(|row| half(row[0], row[1])).collect();
        Some((value, blocks))
    }
}

impl Persist for Helfand {
    fn save(&self, to: &mut StateWriter<'_>) {
        to.put_u64("samples", &[self.samples]);
        to.put_f64("integral", &self.integral);
        to.put_f64("last", &self.last);
        self.squares.sums.save(&mut to.section("squares"));
        self.squares.save(to);
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        let width = |name: &str, length: usize, wanted: &[usize]| {
            if wanted.contains(&length) {
                Ok(())
            } else {
                Err(from.misfit(name, format!("{length} values, wanted {}", self.channels)))
            }
        };
        let (integral, last) = (from.f64("integral")?, from.f64("last")?);
        width("integral", integral.len(), &[self.channels])?;
        width("last", last.len(), &[0, self.channels])?;
        self.squares.sums.restore(&from.section("squares"))?;
        self.squares.restore(from)?;
        self.integral = integral.to_vec();
        self.last = last.to_vec();
        [self.samples] = from.u64s("samples")?;
        Ok(())
    }
}
