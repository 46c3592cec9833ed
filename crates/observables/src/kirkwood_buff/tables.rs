//! The tables of Kirkwood–Buff integrals.

use crate::{Table, statistics};

use super::KirkwoodBuff;
use crate::blocks::BlockedSums;

/// Rows of the table of the running integral.
const ROWS: usize = 50;

impl KirkwoodBuff {
    /// g and the running integral with its error.
    pub(super) fn running(&self, counts: &BlockedSums, bins: usize) -> Table {
        let step = bins.div_ceil(ROWS).max(1);
        let ends: Vec<usize> = (1..=bins / step).map(|row| row * step).collect();
        let radius = |end: &usize| *end as f64 * self.width();
        let mut table = Table::new(
            "kirkwood_buff",
            "Kirkwood–Buff integral from g(r) up to r, with the weight for the range beyond",
        )
        .with("r", "σ", ends.iter().map(radius).collect());
        let found: Vec<Vec<(f64, Vec<f64>)>> = ends
            .iter()
            .map(|end| counts.jackknife_of_each(|means| self.of_counts(means, *end)))
            .collect();
        for (p, pair) in self.pairs.iter().enumerate() {
            let suffix = self.suffix(*pair);
            let values = found.iter().map(|row| row[p].0).collect();
            let error =
                |row: &Vec<(f64, Vec<f64>)>| statistics::error_of_mean(&row[p].1).standard_error;
            table = table.with(format!("integral{suffix}"), "σ³", values).with(
                format!("standard_error{suffix}"),
                "σ³",
                found.iter().map(error).collect(),
            );
        }
        table
    }

    /// The factors from which the values at k = 0 are taken.
    pub(super) fn factors_table(&self, factors: &BlockedSums) -> Table {
        let shells = self.vectors.shells();
        let mut table = Table::new(
            "kirkwood_buff_structure",
            "structure factors at the smallest wave numbers, which are carried to k = 0",
        )
        .with("k", "σ⁻¹", self.vectors.wave_numbers(self.seen.sides()));
        for (p, pair) in self.pairs.iter().enumerate() {
            let suffix = self.suffix(*pair);
            let [values, errors] = factors.curve(p * shells..(p + 1) * shells, 1.0);
            table = table.with(format!("structure_factor{suffix}"), "", values).with(
                format!("standard_error{suffix}"),
                "",
                errors,
            );
        }
        table
    }
}
