//! Levels that remember ever rarer samples, and the sums of what pairs of them give: long lags in bounded memory.

use std::collections::VecDeque;

use lennard_core::{Persist, RestoreError, StateReader, StateWriter};

use crate::blocks::BlockedSums;

/// Samples that each level remembers.
const POINTS: usize = 16;

/// Level 0 serves lags of 0 to 15 samples, level ℓ serves lags of 8·2^ℓ to 15·2^ℓ.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ladder {
    channels: usize,
    interval: f64,
    /// Of each level, the latest sample first, each `channels` values.
    levels: Vec<VecDeque<Vec<f64>>>,
    pub(crate) sums: BlockedSums,
}

impl Ladder {
    /// Nothing seen yet: `channels` values a sample, samples `interval` τ apart, lags up to at least
    /// `longest_lag` τ.
    pub(crate) fn new(channels: usize, interval: f64, longest_lag: f64) -> Self {
        let reach = (POINTS - 1) as f64 * interval;
        let levels = (longest_lag / reach).log2().ceil().clamp(0.0, 40.0) as usize + 1;
        Self {
            channels,
            interval,
            levels: vec![VecDeque::new(); levels],
            sums: BlockedSums::new(levels * POINTS),
        }
    }

    /// The same without the pairs that end in the first `discarded` part of the samples, from 0 to 1.
    pub(crate) fn after(&self, discarded: f64) -> Self {
        Self { sums: self.sums.after(discarded), ..self.clone() }
    }

    pub(crate) fn levels(&self) -> usize {
        self.levels.len()
    }

    /// Shows one level a sample: `pair` of it and of each remembered one joins the sums, averaged over channels.
    pub(crate) fn push(&mut self, level: usize, sample: &[f64], pair: impl Fn(f64, f64) -> f64) {
        let history = &mut self.levels[level];
        history.truncate(POINTS - 1);
        history.push_front(sample.to_vec());
        for (lag, then) in history.iter().enumerate().skip(first_lag(level)) {
            let sum: f64 = sample.iter().zip(then).map(|(a, b)| pair(*a, *b)).sum();
            self.sums.add(level * POINTS + lag, sum / self.channels as f64, 1);
        }
    }

    /// The lags that were reached, in τ and rising, and where their sums are.
    pub(crate) fn reached(&self) -> (Vec<f64>, Vec<usize>) {
        let time = |k: usize, l: usize| (k << l) as f64 * self.interval;
        (0..self.levels.len())
            .flat_map(|l| (first_lag(l)..POINTS).map(move |k| (time(k, l), l * POINTS + k)))
            .filter(|(_, q)| self.sums.total(*q).1 > 0)
            .unzip()
    }
}

/// The lower half of the lags of every level but the first belongs to the level before.
fn first_lag(level: usize) -> usize {
    if level == 0 { 0 } else { POINTS / 2 }
}

/// The levels alone: the owner saves the sums under a name of its own.
impl Persist for Ladder {
    fn save(&self, to: &mut StateWriter<'_>) {
        for (l, history) in self.levels.iter().enumerate() {
            let flat: Vec<f64> = history.iter().flatten().copied().collect();
            to.put_f64(&format!("level_{l}"), &flat);
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        for (l, history) in self.levels.iter_mut().enumerate() {
            let name = format!("level_{l}");
            let flat = from.f64(&name)?;
            if flat.len() % self.channels != 0 || flat.len() > POINTS * self.channels {
                return Err(from.misfit(&name, format!("{} values", flat.len())));
            }
            *history = flat.chunks(self.channels).map(<[f64]>::to_vec).collect();
        }
        Ok(())
    }
}
