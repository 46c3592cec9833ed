//! Positions at rising distances in time.

use std::collections::VecDeque;

use lennard_core::{DVec3, Own, Persist, RestoreError, StateReader, StateWriter};

use crate::time_origins::Origins;

/// Samples that each level remembers; also the number of lags of the first level.
const POINTS: u64 = 16;

/// Level ℓ keeps the last 16 samples of every 2^ℓ-th, and serves lags of 8·2^ℓ to 16·2^ℓ samples.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Levels {
    /// Which vectors of a sample this process has.
    own: Own,
    samples: u64,
    /// Latest sample first.
    levels: Vec<VecDeque<Vec<DVec3>>>,
}

impl Levels {
    /// As many levels as a longest lag takes, in samples.
    pub(super) fn new(longest: f64, own: &Own) -> Self {
        // Level ℓ reaches 16·2^ℓ samples.
        let levels = (longest / POINTS as f64).log2().ceil().clamp(0.0, 40.0) as usize + 1;
        Self { own: own.clone(), samples: 0, levels: vec![VecDeque::new(); levels] }
    }

    /// The lags in samples, rising, with the number of each.
    pub(super) fn in_samples(&self) -> impl Iterator<Item = (u64, usize)> {
        (0..self.levels.len()).flat_map(|level| {
            let first = if level == 0 { 1 } else { POINTS / 2 + 1 };
            (first..=POINTS).map(move |j| (j << level, level * POINTS as usize + j as usize - 1))
        })
    }

    /// The vectors of the last sample.
    pub(super) fn last(&self) -> Option<&Vec<DVec3>> {
        self.levels[0].front()
    }
}

impl Origins for Levels {
    fn lags(&self) -> usize {
        self.levels.len() * POINTS as usize
    }

    fn samples(&self) -> u64 {
        self.samples
    }

    fn see(&mut self, now: &[DVec3], mut add: impl FnMut(usize, &[DVec3])) {
        for (level, history) in self.levels.iter_mut().enumerate() {
            if !self.samples.is_multiple_of(1 << level) {
                break;
            }
            // The lower half of the lags of every level but the first belongs to the level before.
            let nearest = if level == 0 { 0 } else { POINTS as usize / 2 };
            for (back, then) in history.iter().enumerate().skip(nearest) {
                add(level * POINTS as usize + back, then);
            }
            history.truncate(POINTS as usize - 1);
            history.push_front(now.to_vec());
        }
        self.samples += 1;
    }
}

impl Persist for Levels {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { own, samples, levels } = self;
        samples.save(&mut to.section("samples"));
        for (level, history) in levels.iter().enumerate() {
            let all = own.collect_rows(history.iter().map(|row| &row[..]));
            to.put_vec3(&format!("level_{level}"), &all);
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.samples.restore(&from.section("samples"))?;
        let n = self.own.all();
        for (level, history) in self.levels.iter_mut().enumerate() {
            let name = format!("level_{level}");
            let all = from.vec3(&name)?;
            let expected = POINTS.min(self.samples.div_ceil(1 << level)) as usize * n;
            if all.len() != expected {
                return Err(from.misfit(&name, format!("{} vectors, wanted {expected}", all.len())));
            }
            *history = self.own.parts_of_rows(all).map(<[DVec3]>::to_vec).collect();
        }
        Ok(())
    }
}
