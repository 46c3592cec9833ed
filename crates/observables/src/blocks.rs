//! Sums over successive stretches of the run: what the errors of functions (g(r), MSD) are made from.

use lennard_core::{Persist, RestoreError, StateReader, StateWriter};

use crate::statistics;

/// Sums and counts of `width` quantities for each of at most `limit` successive blocks of samples.
///
/// A block covers `stride` samples; when `limit` blocks are full, they are added in pairs and the
/// stride doubles. Totals are exact sums, block means give the standard error.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockedSums {
    width: usize,
    limit: usize,
    stride: u64,
    samples: u64,
    sums: Vec<Vec<f64>>,
    counts: Vec<Vec<u64>>,
}

/// Most blocks: errors come from 32 to 64.
const BLOCKS: usize = 64;

impl BlockedSums {
    /// Nothing summed yet; at most 64 blocks.
    pub fn new(width: usize) -> Self {
        Self::with_limit(width, BLOCKS)
    }

    /// At most `limit` blocks (rounded down to an even number, at least 2).
    fn with_limit(width: usize, limit: usize) -> Self {
        Self {
            width,
            limit: (limit / 2).max(1) * 2,
            stride: 1,
            samples: 0,
            sums: Vec::new(),
            counts: Vec::new(),
        }
    }

    /// Opens the next sample: what is added from now on belongs to it.
    pub fn begin_sample(&mut self) {
        if self.samples == self.stride * self.limit as u64 {
            self.merge_pairs();
        }
        if self.samples.is_multiple_of(self.stride) {
            self.sums.push(vec![0.0; self.width]);
            self.counts.push(vec![0; self.width]);
        }
        self.samples += 1;
    }

    /// Adds to quantity `k` of the sample that is open.
    ///
    /// # Panics
    /// Where no sample was begun: that is a bug of the caller.
    pub fn add(&mut self, k: usize, value: f64, count: u64) {
        let (sums, counts) = self.current();
        sums[k] += value;
        counts[k] += count;
    }

    /// Sums and counts of the block of the sample that is open.
    ///
    /// # Panics
    /// Where no sample was begun: that is a bug of the caller.
    pub fn current(&mut self) -> (&mut [f64], &mut [u64]) {
        let last = self.sums.len().checked_sub(1).expect("a sample was begun");
        (&mut self.sums[last], &mut self.counts[last])
    }

    fn merge_pairs(&mut self) {
        fn merged<T: Copy + std::ops::Add<Output = T>>(rows: &[Vec<T>]) -> Vec<Vec<T>> {
            rows.chunks(2)
                .map(|pair| match pair {
                    [a, b] => a.iter().zip(b).map(|(x, y)| *x + *y).collect(),
                    _ => pair[0].clone(),
                })
                .collect()
        }
        self.sums = merged(&self.sums);
        self.counts = merged(&self.counts);
        self.stride *= 2;
    }

    /// Samples begun so far.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Number of quantities.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of complete blocks.
    pub fn complete_blocks(&self) -> usize {
        (self.samples / self.stride) as usize
    }

    /// Sum and count of quantity `k` over the whole run.
    pub fn total(&self, k: usize) -> (f64, u64) {
        (self.sums.iter().map(|row| row[k]).sum(), self.counts.iter().map(|row| row[k]).sum())
    }

    /// Mean of quantity `k` over the whole run; `None` where nothing was added.
    pub fn mean(&self, k: usize) -> Option<f64> {
        let (sum, count) = self.total(k);
        (count > 0).then(|| sum / count as f64)
    }

    /// The means of quantity `k` over each complete block that holds any.
    pub fn block_means(&self, k: usize) -> Vec<f64> {
        (0..self.complete_blocks()).filter_map(|b| self.block_mean(b, k)).collect()
    }

    /// Mean of quantity `k` over block `b`; `None` where nothing was added there.
    pub fn block_mean(&self, b: usize, k: usize) -> Option<f64> {
        let count = self.counts[b][k];
        (count > 0).then(|| self.sums[b][k] / count as f64)
    }

    /// The means of several quantities over each block, blocks where one of them has no data left out.
    ///
    /// Where most blocks are too short to hold them all, neighboring blocks are joined in pairs until at
    /// least half of them do.
    pub fn complete_rows(&self, quantities: &[usize]) -> Vec<Vec<f64>> {
        let complete = self.complete_blocks();
        let mut joined = 1;
        loop {
            let groups = complete / joined;
            let rows: Vec<Vec<f64>> = (0..groups)
                .filter_map(|group| {
                    let members = group * joined..(group + 1) * joined;
                    quantities
                        .iter()
                        .map(|&k| {
                            let count: u64 = members.clone().map(|b| self.counts[b][k]).sum();
                            let sum: f64 = members.clone().map(|b| self.sums[b][k]).sum();
                            (count > 0).then(|| sum / count as f64)
                        })
                        .collect()
                })
                .collect();
            if 2 * rows.len() >= groups {
                return rows;
            }
            joined *= 2;
        }
    }

    /// The standard error of [`BlockedSums::mean`] from the scatter of the blocks; NaN for fewer than
    /// [`statistics::FEWEST_BLOCKS`] blocks.
    pub fn standard_error(&self, k: usize) -> f64 {
        statistics::error_of_mean(&self.block_means(k)).standard_error
    }

    /// The sums without the blocks of the first `discarded` part of the samples, from 0 to 1. A block that begins in that
    /// part is left out whole.
    pub fn after(&self, discarded: f64) -> Self {
        let samples = discarded.clamp(0.0, 1.0) * self.samples as f64;
        let blocks = ((samples / self.stride as f64).ceil() as usize).min(self.sums.len());
        Self {
            samples: self.samples - (blocks as u64 * self.stride).min(self.samples),
            sums: self.sums[blocks..].to_vec(),
            counts: self.counts[blocks..].to_vec(),
            ..*self
        }
    }

    /// A quantity made from all means together, with its pseudo-values: n·q − (n − 1)·q₍b₎ for each of the n complete
    /// blocks b, where q₍b₎ is the quantity without that block. Their scatter is the error of q, however the quantity
    /// depends on the means (M. H. Quenouille, Biometrika 43, 353 (1956)).
    ///
    /// `quantity` is given the mean of each sum, NaN where nothing was added; `None` where it has no value. A block
    /// without which it has none is left out.
    pub fn jackknife(&self, quantity: impl Fn(&[f64]) -> Option<f64>) -> Option<(f64, Vec<f64>)> {
        let of = |means: &[f64]| vec![quantity(means).unwrap_or(f64::NAN)];
        let found = self.jackknife_of_each(of).pop()?;
        (!found.0.is_nan()).then_some(found)
    }

    /// [`BlockedSums::jackknife`] of several quantities at once, each not a number where it has no value.
    pub fn jackknife_of_each(
        &self,
        quantities: impl Fn(&[f64]) -> Vec<f64>,
    ) -> Vec<(f64, Vec<f64>)> {
        let (sums, counts): (Vec<f64>, Vec<u64>) = (0..self.width).map(|k| self.total(k)).unzip();
        let means = |sums: &[f64], counts: &[u64]| -> Vec<f64> {
            let pairs = sums.iter().zip(counts);
            pairs.map(|(sum, count)| sum / *count as f64).collect()
        };
        let whole = quantities(&means(&sums, &counts));
        let blocks = self.complete_blocks();
        let n = blocks as f64;
        let mut found: Vec<(f64, Vec<f64>)> = whole.iter().map(|q| (*q, Vec::new())).collect();
        for b in 0..blocks {
            let less = |all: &[f64], block: &[f64]| -> Vec<f64> {
                all.iter().zip(block).map(|(x, y)| x - y).collect()
            };
            let left: Vec<u64> = counts.iter().zip(&self.counts[b]).map(|(x, y)| x - y).collect();
            let without = quantities(&means(&less(&sums, &self.sums[b]), &left));
            for ((whole, pseudo), without) in found.iter_mut().zip(without) {
                if !without.is_nan() {
                    pseudo.push(n * *whole - (n - 1.0) * without);
                }
            }
        }
        found
    }
}

impl Persist for BlockedSums {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { width, limit, stride, samples, sums, counts } = self;
        to.put_u64("shape", &[*width as u64, *limit as u64, *stride, *samples]);
        to.put_f64("sums", &sums.concat());
        to.put_u64("counts", &counts.concat());
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        let [width, limit, stride, samples] = from.u64s("shape")?;
        if width != self.width as u64 || limit != self.limit as u64 || stride == 0 {
            return Err(from.misfit(
                "shape",
                format!(
                    "{limit} blocks of {width} values, wanted {} of {}",
                    self.limit, self.width
                ),
            ));
        }
        let (sums, counts) = (from.f64("sums")?, from.u64("counts")?);
        let expected = samples.div_ceil(stride).saturating_mul(width);
        if sums.len() as u64 != expected || counts.len() != sums.len() {
            return Err(from.misfit("sums", format!("{} values, wanted {expected}", sums.len())));
        }
        self.stride = stride;
        self.samples = samples;
        self.sums = sums.chunks(self.width).map(<[f64]>::to_vec).collect();
        self.counts = counts.chunks(self.width).map(<[u64]>::to_vec).collect();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn totals_are_exact_and_blocks_stay_bounded() {
        let mut blocks = BlockedSums::with_limit(2, 8);
        for i in 0..1000_u32 {
            blocks.begin_sample();
            blocks.add(0, f64::from(i), 1);
            if i % 2 == 0 {
                blocks.add(1, 1.0, 1);
            }
        }
        assert_eq!(blocks.total(0), (499_500.0, 1000));
        assert_eq!(blocks.total(1), (500.0, 500));
        assert_eq!(blocks.stride, 128);
        assert_eq!(blocks.complete_blocks(), 7);
        assert_eq!(blocks.block_means(0)[0], 63.5);
    }

    #[test]
    fn blocks_too_short_for_every_quantity_are_joined() {
        let mut blocks = BlockedSums::new(2);
        for i in 0..12 {
            blocks.begin_sample();
            blocks.add(0, f64::from(i), 1);
            if i % 3 == 2 {
                blocks.add(1, 10.0 * f64::from(i), 1);
            }
        }
        assert_eq!(blocks.complete_rows(&[0]).len(), 12);
        // Every third sample: pairs of blocks hold it two times out of three.
        let rows = blocks.complete_rows(&[0, 1]);
        assert_eq!(rows, [[2.5, 20.0], [4.5, 50.0], [8.5, 80.0], [10.5, 110.0]]);
    }

    #[test]
    fn blocks_of_the_discarded_part_are_left_out_whole() {
        let mut blocks = BlockedSums::with_limit(1, 8);
        for i in 0..40_u32 {
            blocks.begin_sample();
            blocks.add(0, f64::from(i), 1);
        }
        // Stride 8: five blocks, of which the first two begin in the first quarter.
        assert_eq!(blocks.after(0.0), blocks);
        let rest = blocks.after(0.25);
        assert_eq!((rest.samples(), rest.mean(0)), (24, Some(27.5)));
        assert_eq!(blocks.after(1.0).samples(), 0);
    }

    #[test]
    fn the_jackknife_gives_the_error_of_a_product_of_means() {
        // x·y of two means, 3 and 4, of independent normal samples: error √((4² + 3²)/n) at unit variance.
        let (n, seeds) = (64_usize, 200);
        let make = |seed: u64| {
            let mut blocks = BlockedSums::new(2);
            let x = crate::statistics::synthetic::Ar1::new(0.0, 2 * seed).series(n);
            let y = crate::statistics::synthetic::Ar1::new(0.0, 2 * seed + 1).series(n);
            for i in 0..n {
                blocks.begin_sample();
                blocks.add(0, 3.0 + x[i], 1);
                blocks.add(1, 4.0 + y[i], 1);
            }
            blocks.jackknife(|m| Some(m[0] * m[1])).unwrap()
        };
        let exact = (25.0 / n as f64).sqrt();
        let mut sum = 0.0;
        for seed in 0..seeds {
            let (_, pseudo) = make(seed);
            sum += statistics::error_of_mean(&pseudo).standard_error.powi(2);
        }
        let printed = (sum / seeds as f64).sqrt();
        assert!((0.95..1.12).contains(&(printed / exact)), "{printed} {exact}");
    }

    #[test]
    fn the_error_from_blocks_is_that_of_independent_samples() {
        // Equally spread values −1, 1, −1, 1 in blocks of one sample: variance 4/3 for four blocks, and an error widened
        // for three degrees of freedom.
        let mut blocks = BlockedSums::new(1);
        for i in 0..4 {
            blocks.begin_sample();
            blocks.add(0, if i % 2 == 0 { -1.0 } else { 1.0 }, 1);
        }
        let plain = (4.0_f64 / 3.0 / 4.0).sqrt();
        assert!((1.5..1.7).contains(&(blocks.standard_error(0) / plain)));
    }
}
