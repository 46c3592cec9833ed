//! A function of several means, with the error that their common fluctuations give it.

use crate::Estimate;

use crate::averages::estimate_of_fluctuations;
use crate::statistics::{less_control, mean};

/// One of the means: its rows, and the value that is put into the function.
#[derive(Debug, Clone)]
pub(super) struct Part {
    rows: Vec<f64>,
    value: f64,
}

impl Part {
    /// A plain mean.
    pub(super) fn mean_of(rows: Vec<f64>) -> Self {
        let value = mean(&rows);
        Self { rows, value }
    }

    /// A second moment about means of the same samples, which is too small by one part in the independent samples.
    pub(super) fn moment_of(rows: Vec<f64>, independent: f64) -> Self {
        let value = mean(&rows) / (1.0 - 1.0 / independent.max(2.0));
        Self { rows, value }
    }
}

/// Each value of a function of the means, with its error and the series whose mean has that error.
///
/// To first order f fluctuates as y_t = Σ_k (∂f/∂m_k)(x_{k,t} − m_k): the error of f is the error of the mean of y,
/// correlation included. Slopes are central differences; f is smooth. A control is a series whose true mean is zero; what f owes to
/// it is taken out.
pub(super) fn of<const N: usize>(
    parts: &[Part],
    control: Option<&[f64]>,
    f: impl Fn(&[f64]) -> [f64; N],
) -> Vec<(Estimate, Vec<f64>)> {
    /// Part of the size of the rows that a mean is moved by.
    const STEP: f64 = 1e-5;
    let means: Vec<f64> = parts.iter().map(|p| p.value).collect();
    let values = f(&means);
    let rows = parts.first().map_or(0, |p| p.rows.len());
    let mut influence = vec![vec![0.0; rows]; N];
    for (k, part) in parts.iter().enumerate() {
        let size = part.rows.iter().map(|x| x * x).sum::<f64>() / rows.max(1) as f64;
        let step = STEP * size.sqrt().min(part.value.abs().max(1e-3 * size.sqrt()));
        if step == 0.0 {
            continue;
        }
        let moved = |by: f64| {
            let mut means = means.clone();
            means[k] += by;
            f(&means)
        };
        let (low, high) = (moved(-step), moved(step));
        let centre = mean(&part.rows);
        for (series, (low, high)) in influence.iter_mut().zip(low.iter().zip(&high)) {
            let slope = (high - low) / (2.0 * step);
            for (y, x) in series.iter_mut().zip(&part.rows) {
                *y += slope * (x - centre);
            }
        }
    }
    let estimate = |(value, series): (f64, Vec<f64>)| {
        let (value, series) = match control {
            Some(control) => less_control(value, series, control),
            None => (value, series),
        };
        let error = estimate_of_fluctuations(&series);
        (Estimate { mean: value, ..error }, series)
    };
    values.into_iter().zip(influence).map(estimate).collect()
}
