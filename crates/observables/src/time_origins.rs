//! The time origins of a correlation function, each with the vectors that were seen there.

use std::collections::VecDeque;

use crate::{Doubt, ObservableError};
use lennard_core::number::short;
use lennard_core::{DVec3, Own, Persist, RestoreError, StateReader, StateWriter};

use crate::error::{positive, within};

/// Most lags of a function.
const MOST_LAGS: usize = 10_000;
/// A function counts as decayed where its end is below this part of its beginning.
const DECAYED: f64 = 0.01;

/// The earlier samples that each sample is compared with.
pub(crate) trait Origins: Persist {
    /// Number of lags.
    fn lags(&self) -> usize;

    /// Samples so far.
    fn samples(&self) -> u64;

    /// Takes a sample, and calls `add` with the number of the lag and the vectors of each earlier sample.
    fn see(&mut self, now: &[DVec3], add: impl FnMut(usize, &[DVec3]));
}

/// Time origins at equal distances, as many at once as the window of the function takes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TimeOrigins {
    /// The time between two samples, τ.
    pub interval: f64,
    /// Number of lags, the lag 0 among them.
    pub lags: usize,
    /// What the vectors are called in a saved state.
    name: &'static str,
    samples: u64,
    spacing: u64,
    /// Which vectors of a sample this process has.
    own: Own,
    /// Oldest first: number of the sample and vectors there.
    kept: VecDeque<(u64, Vec<DVec3>)>,
}

impl TimeOrigins {
    /// No origin yet, for a window, τ, with so many origins at once, and samples of so many vectors, which have a name.
    ///
    /// # Errors
    /// [`ObservableError`] where the window holds no two samples or more than 10,000, or there is no origin.
    pub(crate) fn new(
        (window, origins): (f64, usize),
        interval: f64,
        (name, own): (&'static str, &Own),
    ) -> Result<Self, ObservableError> {
        positive("window", Some(window))?;
        let steps = (window / interval).round();
        if !(2.0..=MOST_LAGS as f64).contains(&steps) {
            return Err(ObservableError::new(
                "window",
                window,
                format!(
                    "from 2 to {MOST_LAGS} sampling intervals of {} τ (change `window` or `every`)",
                    short(interval)
                ),
            ));
        }
        within("origins", origins, 1..=MOST_LAGS)?;
        let lags = steps as usize + 1;
        Ok(Self {
            interval,
            lags,
            name,
            samples: 0,
            spacing: lags.div_ceil(origins) as u64,
            own: own.clone(),
            kept: VecDeque::new(),
        })
    }

    /// The lags, τ.
    pub(crate) fn times(&self) -> Vec<f64> {
        (0..self.lags).map(|k| k as f64 * self.interval).collect()
    }

    /// That a function with these errors has not decayed at the end of its window.
    pub(crate) fn undecayed(&self, function: &str, c: &[f64], errors: &[f64]) -> Option<Doubt> {
        let last = self.lags - 1;
        (c[last].abs() > (DECAYED * c[0]).max(3.0 * errors[last])).then(|| {
            Doubt::Incomplete(format!(
                "{function} has not decayed at the end of its window, {:.3} τ",
                last as f64 * self.interval
            ))
        })
    }
}

impl Origins for TimeOrigins {
    fn lags(&self) -> usize {
        self.lags
    }

    fn samples(&self) -> u64 {
        self.samples
    }

    fn see(&mut self, now: &[DVec3], mut add: impl FnMut(usize, &[DVec3])) {
        let expired = |&(born, _): &(u64, _)| self.samples - born >= self.lags as u64;
        while self.kept.front().is_some_and(expired) {
            self.kept.pop_front();
        }
        if self.samples.is_multiple_of(self.spacing) {
            self.kept.push_back((self.samples, now.to_vec()));
        }
        for (born, then) in &self.kept {
            add((self.samples - born) as usize, then);
        }
        self.samples += 1;
    }
}

impl Persist for TimeOrigins {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { interval: _, lags: _, name, samples, spacing: _, own, kept } = self;
        samples.save(&mut to.section("samples"));
        let born: Vec<u64> = kept.iter().map(|(born, _)| *born).collect();
        to.put_u64("origins", &born);
        to.put_vec3(name, &own.collect_rows(kept.iter().map(|(_, v)| &v[..])));
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.samples.restore(&from.section("samples"))?;
        let born = from.u64("origins")?;
        let all = from.vec3(self.name)?;
        let n = self.own.all();
        if all.len() != born.len() * n || born.iter().any(|b| *b >= self.samples) {
            return Err(from.misfit(
                self.name,
                format!("{} vectors for {} origins of {n}", all.len(), born.len()),
            ));
        }
        let rows = self.own.parts_of_rows(all).map(<[DVec3]>::to_vec);
        self.kept = born.iter().copied().zip(rows).collect();
        Ok(())
    }
}
