//! The Einstein–Helfand road to a transport coefficient: the mean-square growth of an integrated flux.

use std::collections::VecDeque;

use lennard_core::{Persist, RestoreError, StateReader, StateWriter};

use crate::blocks::BlockedSums;

/// Moments that each level remembers.
const POINTS: usize = 16;

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
    levels: Vec<VecDeque<Vec<f64>>>,
    squares: BlockedSums,
}

impl Helfand {
    /// Nothing seen yet: `channels` values a sample, `interval` τ apart, lags up to at least `longest_lag` τ.
    pub(crate) fn new(channels: usize, interval: f64, longest_lag: f64) -> Self {
        let reach = (POINTS - 1) as f64 * interval;
        let levels = (longest_lag / reach).log2().ceil().clamp(0.0, 40.0) as usize + 1;
        Self {
            channels,
            interval,
            samples: 0,
            integral: vec![0.0; channels],
            last: Vec::new(),
            levels: vec![VecDeque::new(); levels],
            squares: BlockedSums::new(levels * POINTS),
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
        self.squares.begin_sample();
        for (l, history) in self.levels.iter_mut().enumerate() {
            if !self.samples.is_multiple_of(1 << l) {
                break;
            }
            history.truncate(POINTS - 1);
            history.push_front(self.integral.clone());
            for (lag, then) in history.iter().enumerate().skip(first_lag(l)) {
                let sum: f64 = self.integral.iter().zip(then).map(|(a, b)| (a - b).powi(2)).sum();
                self.squares.add(l * POINTS + lag, sum / self.channels as f64, 1);
            }
        }
        self.samples += 1;
    }

    /// Lags in τ with the place of their sums, rising.
    fn lags(&self) -> Vec<(f64, usize)> {
        (0..self.levels.len())
            .flat_map(|l| {
                (first_lag(l)..POINTS)
                    .map(move |k| ((k << l) as f64 * self.interval, l * POINTS + k))
            })
            .filter(|(_, q)| self.squares.total(*q).1 > 0)
            .collect()
    }

    /// Half the slope of the mean square change from lag `from` to lag `to` (τ), and the same for each block;
    /// `None` where no two lags lie there.
    pub(crate) fn half_slope(&self, from: f64, to: f64) -> Option<(f64, Vec<f64>)> {
        let inside: Vec<(f64, usize)> =
            self.lags().into_iter().filter(|(t, _)| (from..=to).contains(t)).collect();
        let (&(early, a), &(late, b)) = (inside.first()?, inside.last()?);
        if early >= late {
            return None;
        }
        let half = |early_square: f64, late_square: f64| {
            0.5 * (late_square - early_square) / (late - early)
        };
        let value = half(self.squares.mean(a)?, self.squares.mean(b)?);
        let blocks =
            self.squares.complete_rows(&[a, b]).iter().map(|row| half(row[0], row[1])).collect();
        Some((value, blocks))
    }
}

/// The lower half of the lags of every level but the first belongs to the level before.
fn first_lag(level: usize) -> usize {
    if level == 0 { 0 } else { POINTS / 2 }
}

impl Persist for Helfand {
    fn save(&self, to: &mut StateWriter<'_>) {
        to.put_u64("samples", &[self.samples]);
        to.put_f64("integral", &self.integral);
        to.put_f64("last", &self.last);
        self.squares.save(&mut to.section("squares"));
        for (l, history) in self.levels.iter().enumerate() {
            let flat: Vec<f64> = history.iter().flatten().copied().collect();
            to.put_f64(&format!("level_{l}"), &flat);
        }
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
        self.squares.restore(&from.section("squares"))?;
        for (l, history) in self.levels.iter_mut().enumerate() {
            let name = format!("level_{l}");
            let flat = from.f64(&name)?;
            if flat.len() % self.channels != 0 || flat.len() > POINTS * self.channels {
                return Err(from.misfit(&name, format!("{} values", flat.len())));
            }
            *history = flat.chunks(self.channels).map(<[f64]>::to_vec).collect();
        }
        self.integral = integral.to_vec();
        self.last = last.to_vec();
        [self.samples] = from.u64s("samples")?;
        Ok(())
    }
}
