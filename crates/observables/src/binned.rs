//! Functions over bins: means over samples, of the whole system and of its parts.

use std::ops::Range;

use lennard_core::{Persist, RestoreError, StateReader, StateWriter};

use crate::blocks::BlockedSums;

/// A part of the system that has a function of its own: two species, for example.
pub(crate) trait Part {
    /// The name of its section in a saved state.
    fn section(&self) -> String;
}

/// Sums in bins over the samples, of the whole system and of each part.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Binned<P> {
    /// What the sums of the whole are called in a saved state.
    name: &'static str,
    pub(crate) whole: BlockedSums,
    /// Empty where the whole has no parts.
    pub(crate) parts: Vec<(P, BlockedSums)>,
}

impl<P: Part + Copy> Binned<P> {
    /// Nothing summed yet.
    pub(crate) fn new(name: &'static str, bins: usize, parts: impl Iterator<Item = P>) -> Self {
        let parts = parts.map(|part| (part, BlockedSums::new(bins)));
        Self { name, whole: BlockedSums::new(bins), parts: parts.collect() }
    }

    /// The sums without the blocks of the first `discarded` part of the samples.
    pub(crate) fn after(&self, discarded: f64) -> Self {
        let parts = self.parts.iter().map(|(part, sums)| (*part, sums.after(discarded)));
        Self { name: self.name, whole: self.whole.after(discarded), parts: parts.collect() }
    }
}

impl<P: Part> Persist for Binned<P> {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { name, whole, parts } = self;
        whole.save(&mut to.section(name));
        for (part, sums) in parts {
            sums.save(&mut to.section(&part.section()));
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.whole.restore(&from.section(self.name))?;
        for (part, sums) in &mut self.parts {
            sums.restore(&from.section(&part.section()))?;
        }
        Ok(())
    }
}

impl BlockedSums {
    /// Adds a sample with a value in each bin.
    pub(crate) fn add_sample(&mut self, values: impl IntoIterator<Item = f64>) {
        self.begin_sample();
        let (sums, counts) = self.current();
        for ((sum, count), value) in sums.iter_mut().zip(counts).zip(values) {
            *sum += value;
            *count += 1;
        }
    }

    /// The means of a range of bins times a factor, not a number where nothing was added, and their standard errors.
    pub(crate) fn curve(&self, bins: Range<usize>, factor: f64) -> [Vec<f64>; 2] {
        let mean = |k| self.mean(k).unwrap_or(f64::NAN) * factor;
        let error = |k| self.standard_error(k) * factor;
        [bins.clone().map(mean).collect(), bins.map(error).collect()]
    }
}
