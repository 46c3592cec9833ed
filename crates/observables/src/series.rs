//! A time series of bounded length: when it is full, neighboring rows are averaged in pairs.

use crate::{Average, Table};
use lennard_core::{Persist, RestoreError, StateReader, StateWriter};

use crate::averages::of_series;

/// Named columns of equal length that a [`Series`] fills.
pub trait Columns {
    /// Names, in a fixed order.
    fn names(&self) -> Vec<&'static str>;
    /// The columns, in the order of the names.
    fn columns(&self) -> Vec<&[f64]>;
    /// The columns, to be filled.
    fn columns_mut(&mut self) -> Vec<&mut Vec<f64>>;
}

/// A growing time series with bounded memory.
///
/// Each row is the mean of `stride` successive samples. The stride starts at 1 and doubles when
/// `limit` rows are full. Rows are then averaged in pairs: nothing is dropped, and the mean of the
/// rows stays the mean of the samples. The standard error of the mean survives this, and the variance
/// of single samples does not. Source: Flyvbjerg and Petersen, "Error estimates on averages of
/// correlated data", J. Chem. Phys. 91, 461 (1989).
#[derive(Debug, Clone, PartialEq)]
pub struct Series<C> {
    rows: C,
    /// Sum of the samples of the row that is not yet complete, one entry a column.
    pending: Vec<f64>,
    pending_samples: u64,
    stride: u64,
    limit: usize,
}

impl<C: Columns> Series<C> {
    /// An empty series of at most `limit` rows (at least 2, rounded down to an even number).
    #[must_use]
    pub fn new(rows: C, limit: usize) -> Self {
        let width = rows.names().len();
        Self {
            rows,
            pending: vec![0.0; width],
            pending_samples: 0,
            stride: 1,
            limit: (limit / 2).max(1) * 2,
        }
    }

    /// Adds one sample, one value a column in the order of [`Columns::names`].
    pub fn push(&mut self, sample: &[f64]) {
        debug_assert_eq!(sample.len(), self.pending.len(), "one value for each column");
        for (sum, value) in self.pending.iter_mut().zip(sample) {
            *sum += value;
        }
        self.pending_samples += 1;
        if self.pending_samples < self.stride {
            return;
        }
        let weight = 1.0 / self.stride as f64;
        for (column, sum) in self.rows.columns_mut().into_iter().zip(&mut self.pending) {
            column.push(*sum * weight);
            *sum = 0.0;
        }
        self.pending_samples = 0;
        if self.len() == self.limit {
            for column in self.rows.columns_mut() {
                *column = column.chunks_exact(2).map(|p| 0.5 * (p[0] + p[1])).collect();
            }
            self.stride *= 2;
        }
    }

    /// The complete rows.
    #[must_use]
    pub fn rows(&self) -> &C {
        &self.rows
    }

    /// Number of complete rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.columns().first().map_or(0, |c| c.len())
    }

    /// Whether no row is complete yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The mean of a column after `cut` rows, with its error and what speaks against it.
    pub(crate) fn average(&self, name: &str, unit: &str, column: &[f64], cut: usize) -> Average {
        let mut average = of_series(name, unit, column, cut);
        average.estimate.equilibration_cut *= self.stride;
        average
    }

    /// Columns with their units against time, which is the first column; `what` are they.
    pub(crate) fn table<'a>(
        &self,
        name: &str,
        what: &str,
        columns: impl IntoIterator<Item = (&'a str, &'a str, &'a Vec<f64>)>,
    ) -> Table {
        let caption =
            format!("{what} against time; each row is the mean of {} samples", self.stride);
        let times = self.rows.columns()[0].to_vec();
        let table = Table::new(name, caption).with("time", "τ", times);
        columns
            .into_iter()
            .fold(table, |table, (name, unit, column)| table.with(name, unit, column.clone()))
    }

    /// Samples a row.
    #[must_use]
    pub fn stride(&self) -> u64 {
        self.stride
    }
}

impl<C: Columns> Persist for Series<C> {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { rows, pending, pending_samples, stride, limit: _ } = self;
        to.put_u64("stride", &[*stride, *pending_samples]);
        to.put_f64("pending", pending);
        for (name, column) in rows.names().into_iter().zip(rows.columns()) {
            to.put_f64(name, column);
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        let [stride, pending_samples] = from.u64s("stride")?;
        if stride == 0 || pending_samples >= stride {
            return Err(from.misfit("stride", format!("{pending_samples} of {stride} samples")));
        }
        let pending = from.f64("pending")?;
        if pending.len() != self.pending.len() {
            return Err(from.misfit(
                "pending",
                format!("{} columns, wanted {}", pending.len(), self.pending.len()),
            ));
        }
        let names = self.rows.names();
        let saved = names.iter().map(|name| from.f64(name)).collect::<Result<Vec<_>, _>>()?;
        for (name, column) in names.iter().zip(&saved) {
            if column.len() != saved[0].len() || column.len() >= self.limit {
                return Err(from.misfit(name, format!("{} rows", column.len())));
            }
        }
        for (column, saved) in self.rows.columns_mut().into_iter().zip(saved) {
            *column = saved.to_vec();
        }
        self.pending.copy_from_slice(pending);
        self.stride = stride;
        self.pending_samples = pending_samples;
        Ok(())
    }
}

/// Declares the columns of a [`Series`]: a struct with a `Vec<f64>` per column, and `of` a struct with the values of one row.
macro_rules! columns {
    ($(#[$about:meta])* $visible:vis struct $type:ident { $($(#[$doc:meta])* $column:ident),* $(,)? }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Default, PartialEq)]
        $visible struct $type {
            $($(#[$doc])* $visible $column: Vec<f64>),*
        }
        impl $crate::Columns for $type {
            fn names(&self) -> Vec<&'static str> {
                vec![$(stringify!($column)),*]
            }
            fn columns(&self) -> Vec<&[f64]> {
                vec![$(&self.$column),*]
            }
            fn columns_mut(&mut self) -> Vec<&mut Vec<f64>> {
                vec![$(&mut self.$column),*]
            }
        }
    };
    ($(#[$about:meta])* $visible:vis struct $type:ident of $row:ident { $($(#[$doc:meta])* $column:ident),* $(,)? }) => {
        columns! { $(#[$about])* $visible struct $type { $($(#[$doc])* $column),* } }
        /// One row of the series.
        #[derive(Debug, Clone, Copy)]
        $visible struct $row {
            $($(#[$doc])* $visible $column: f64),*
        }
        impl $row {
            /// The values in the order of the columns.
            pub(crate) fn values(&self) -> impl AsRef<[f64]> {
                [$(self.$column),*]
            }
        }
    };
}
pub(crate) use columns;

#[cfg(test)]
mod tests {
    use super::*;
    use lennard_core::StateArchive;

    columns! {
        struct Two { a, b }
    }

    #[test]
    fn a_full_series_halves_its_rows_and_keeps_their_mean() {
        let mut series = Series::new(Two::default(), 8);
        for i in 0..64 {
            series.push(&[f64::from(i), -f64::from(i)]);
            assert!(series.len() < 8);
        }
        // 64 samples with fewer than 8 rows: strides 2, 4, 8, 16 were reached at 8, 16, 32, 64 samples.
        assert_eq!(series.stride(), 16);
        assert_eq!(series.rows().a, [7.5, 23.5, 39.5, 55.5]);
        assert_eq!(series.rows().b, [-7.5, -23.5, -39.5, -55.5]);
    }

    #[test]
    fn a_series_restored_in_the_middle_of_a_row_continues_to_the_bit() {
        let mut whole = Series::new(Two::default(), 8);
        let mut first = Series::new(Two::default(), 8);
        let sample = |i: u32| [f64::from(i).sin(), f64::from(i).sqrt()];
        for i in 0..101 {
            whole.push(&sample(i));
            if i < 37 {
                first.push(&sample(i));
            }
        }
        let mut archive = StateArchive::default();
        first.save(&mut archive.writer());
        let mut second = Series::new(Two::default(), 8);
        second.restore(&archive.reader()).unwrap();
        for i in 37..101 {
            second.push(&sample(i));
        }
        assert_eq!(second, whole);
    }
}
