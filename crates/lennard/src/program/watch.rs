//! `--watch`: T, U and P as lines of blocks beside the progress, and a page of the run while it is under way.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use lennard_core::PeriodicBox;
use lennard_engine::Moment;
use lennard_studies::report::significant;
use lennard_studies::run_page;

/// Heights of a line of blocks, from the least value to the largest.
const BLOCKS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
/// Columns that a line of blocks has at most. At this number, pairs of columns become one.
const COLUMNS: usize = 48;
/// The longest time between two pages.
const PAGE_EVERY: Duration = Duration::from_secs(60);
/// The least time between two pages, in times that one takes: pages take two percent of a run at most.
const PAGES_PER_RUN: u32 = 50;

/// T, U and P of a whole run in a bounded number of columns: each is a mean over equally many moments.
#[derive(Default)]
pub struct History {
    columns: Vec<[f64; 3]>,
    /// Moments of a full column.
    moments: u32,
    sum: [f64; 3],
    summed: u32,
}

impl History {
    /// Adds a moment.
    pub fn add(&mut self, fluid: Moment) {
        self.moments = self.moments.max(1);
        let values = [fluid.temperature, fluid.potential_energy, fluid.pressure];
        (0..3).for_each(|i| self.sum[i] += values[i]);
        self.summed += 1;
        if self.summed == self.moments {
            let mean = self.sum.map(|sum| sum / f64::from(self.summed));
            self.columns.push(mean);
            (self.sum, self.summed) = ([0.0; 3], 0);
        }
        if self.columns.len() == COLUMNS {
            let mean = |pair: &[[f64; 3]]| [0, 1, 2].map(|i| 0.5 * (pair[0][i] + pair[1][i]));
            self.columns = self.columns.chunks_exact(2).map(mean).collect();
            self.moments *= 2;
        }
    }

    /// A line for each quantity that is known: its symbol, its blocks, and the values of the lowest and the highest block.
    pub fn lines(&self) -> Vec<String> {
        let line = |(i, symbol): (usize, &str)| {
            let known = || self.columns.iter().map(|column| column[i]).filter(|x| x.is_finite());
            let (low, high) = (known().reduce(f64::min)?, known().reduce(f64::max)?);
            let top = (BLOCKS.len() - 1) as f64;
            let height = |x: f64| ((x - low) / (high - low).max(f64::MIN_POSITIVE) * top).round();
            let blocks: String = known().map(|x| BLOCKS[height(x) as usize]).collect();
            Some(format!("{symbol} {blocks} {} to {}", significant(low, 4), significant(high, 4)))
        };
        ["T", "U", "P"].into_iter().enumerate().filter_map(line).collect()
    }
}

/// The page of a run that is under way: written at once, then whenever the run has become twice as old, then every minute.
pub struct LivePage {
    folder: PathBuf,
    cell: PeriodicBox,
    started: Instant,
    due: Instant,
}

impl LivePage {
    /// The page in `folder` of a run that goes on in this box.
    pub fn new(folder: &Path, cell: PeriodicBox) -> Self {
        let started = Instant::now();
        Self { folder: folder.to_owned(), cell, started, due: started }
    }

    /// Writes the page where it is due; false where it cannot be written, which is told once, since the run needs none.
    pub fn write(&mut self) -> bool {
        let now = Instant::now();
        if now < self.due {
            return true;
        }
        if let Err(error) = run_page::write_under_way(&self.folder, self.cell) {
            eprintln!("no page while the run goes on: {error}");
            return false;
        }
        let age = self.started.elapsed().clamp(Duration::from_secs(1), PAGE_EVERY);
        self.due = Instant::now() + age.max(PAGES_PER_RUN * now.elapsed());
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(temperature: f64, pressure: f64) -> Moment {
        Moment { temperature, kinetic_energy: 1.0, potential_energy: -6.0, pressure }
    }

    #[test]
    fn a_line_of_blocks_rises_with_its_values_and_what_is_unknown_has_none() {
        let mut history = History::default();
        (0..8).for_each(|i| history.add(moment(1.0 + 0.1 * f64::from(i), f64::NAN)));
        assert_eq!(history.lines(), ["T ▁▂▃▄▅▆▇█ 1.000 to 1.700", "U ▁▁▁▁▁▁▁▁ −6.000 to −6.000"]);
    }

    #[test]
    fn a_long_run_keeps_its_whole_course_in_few_columns() {
        let mut history = History::default();
        let n = 10_000_u32;
        (0..n).for_each(|i| history.add(moment(f64::from(i), 1.0)));
        let width = history.columns.len();
        assert!((COLUMNS / 2..COLUMNS).contains(&width), "{width}");
        // Each column is the mean of as many moments as every other.
        let moments = f64::from(history.moments);
        for (k, column) in (0..).zip(&history.columns) {
            assert_eq!(column[0], f64::from(k) * moments + 0.5 * (moments - 1.0));
        }
        assert!(n - history.moments * width as u32 <= history.moments);
    }
}
