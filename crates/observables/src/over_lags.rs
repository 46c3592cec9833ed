//! Functions of the lag between two samples: means over particles and over many time origins.

use crate::Average;
use lennard_core::{DVec3, Own, Persist, RestoreError, StateReader, StateWriter};

use crate::averages::of_blocks;
use crate::blocks::BlockedSums;
use crate::time_origins::{Origins, TimeOrigins};
use crate::tracked::{Members, mean_over_members, sum_over_pairs};

/// Functions of two samples at each lag, over all particles and over each species of a mixture.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct OverLags<O> {
    pub(crate) origins: O,
    /// Which vectors of a sample this process has.
    own: Own,
    /// What sums are called in a saved state.
    name: &'static str,
    /// Function after function, each at all lags.
    all: BlockedSums,
    /// The species of a mixture; empty where there is one.
    of_species: Vec<(Members, BlockedSums)>,
}

impl<O: Origins> OverLags<O> {
    /// Nothing seen yet, for so many functions.
    pub(crate) fn new(
        name: &'static str,
        functions: usize,
        origins: O,
        own: &Own,
        of_species: Vec<Members>,
    ) -> Self {
        let sums = || BlockedSums::new(functions * origins.lags());
        let of_species = of_species.into_iter().map(|members| (members, sums())).collect();
        Self { name, all: sums(), of_species, own: own.clone(), origins }
    }

    /// Takes a sample, and adds the mean of each function over the particles, at the lag of each origin.
    pub(crate) fn sample<const N: usize>(
        &mut self,
        now: &[DVec3],
        functions: [impl Fn(DVec3, DVec3) -> f64 + Sync; N],
    ) {
        let Self { origins, own, all, of_species, .. } = self;
        let (weight, lags) = (1.0 / own.all().max(1) as f64, origins.lags());
        all.begin_sample();
        for (_, sums) in &mut *of_species {
            sums.begin_sample();
        }
        origins.see(now, |lag, then| {
            for (f, function) in functions.iter().enumerate() {
                let k = f * lags + lag;
                all.add(k, sum_over_pairs(own, now, then, function) * weight, 1);
                for (members, sums) in &mut *of_species {
                    sums.add(k, mean_over_members(own, members, now, then, function), 1);
                }
            }
        });
    }

    /// The sums over all particles without the first `discarded` part of the samples.
    pub(crate) fn after(&self, discarded: f64) -> BlockedSums {
        self.all.after(discarded)
    }

    /// The same for each species.
    pub(crate) fn of_species(
        &self,
        discarded: f64,
    ) -> impl Iterator<Item = (&Members, BlockedSums)> {
        self.of_species.iter().map(move |(members, sums)| (members, sums.after(discarded)))
    }
}

impl OverLags<TimeOrigins> {
    /// A function at each lag with its errors, and the average that its integral is; `None` where the run is shorter than the
    /// window. `function` is its number and its words.
    pub(crate) fn integrated(
        &self,
        sums: &BlockedSums,
        (function, words): (usize, &str),
        (name, unit): (&str, &str),
        integral: impl Fn(&[f64]) -> f64,
    ) -> Option<(Average, [Vec<f64>; 2])> {
        let lags = self.origins.lags;
        let own: Vec<usize> = (function * lags..(function + 1) * lags).collect();
        let c = own.iter().map(|k| sums.mean(*k)).collect::<Option<Vec<f64>>>()?;
        let errors: Vec<f64> = own.iter().map(|k| sums.standard_error(*k)).collect();
        let blocks: Vec<f64> = sums.complete_rows(&own).iter().map(|c| integral(c)).collect();
        let overlap = (lags - 1) as f64 * blocks.len() as f64 / sums.samples() as f64;
        let average = of_blocks(name, unit, integral(&c), &blocks, overlap);
        Some((average.doubted(self.origins.undecayed(words, &c, &errors)), [c, errors]))
    }
}

impl<O: Origins> Persist for OverLags<O> {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { origins, own: _, name, all, of_species } = self;
        origins.save(to);
        all.save(&mut to.section(name));
        for (Members { suffix, .. }, sums) in of_species {
            sums.save(&mut to.section(&format!("{name}{suffix}")));
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.origins.restore(from)?;
        self.all.restore(&from.section(self.name))?;
        for (Members { suffix, .. }, sums) in &mut self.of_species {
            sums.restore(&from.section(&format!("{}{suffix}", self.name)))?;
        }
        Ok(())
    }
}
