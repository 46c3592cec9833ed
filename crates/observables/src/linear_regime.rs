//! A straight line through the part of a lag curve where its slope no longer changes.

use crate::statistics::{FEWEST_BLOCKS, Line, error_with_overlap, mean};

/// By default the longest lag of a fit is this part of the run: longer ones have few independent origins.
const LONGEST_PART: f64 = 0.05;

/// Two slopes agree where they differ by less than this many standard errors of their difference.
const AGREEMENT_SIGMAS: f64 = 2.0;

/// Slopes that differ by less than this part are taken as equal however small their errors are.
const AGREEMENT_PART: f64 = 0.005;

/// The slope must be constant up to so many times the lag s from which it is.
const SHORTEST_STRETCH: f64 = 3.0;

/// With weights 1/t³ lags beyond so many times the first hardly count.
const DECISIVE: f64 = 4.0;

/// Fewest points of a fit.
const FEWEST_POINTS: usize = 4;

/// A function of the lag.
#[derive(Debug, Clone)]
pub(crate) struct LagCurve {
    /// Lags in τ, rising.
    pub times: Vec<f64>,
    /// Values over the whole run.
    pub values: Vec<f64>,
    /// Their standard errors.
    pub errors: Vec<f64>,
    /// Length of the run in τ.
    pub duration: f64,
}

/// A fitted line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LinearFit {
    pub slope: f64,
    /// Value of the line at lag 0.
    pub intercept: f64,
    /// The same fit to each block.
    pub block_slopes: Vec<f64>,
    /// What the slope changes where the fit begins at twice the lag; 0 where the range was given.
    pub change: f64,
    /// The lags that decide the slope, in blocks: so many successive blocks share displacements.
    pub overlap: f64,
    /// Range of lags in τ.
    pub from: f64,
    pub to: f64,
    /// Whether the slope was seen to be constant (always where the range was given).
    pub settled: bool,
}

/// The least-squares line of a mean-square displacement, whose variance grows as t³: the weights are 1/t³. For Gaussian
/// increments, the variance of the square gives t² and the overlap of origins gives t. One set of weights for all blocks keeps
/// the fit linear in the data.
fn weighted_line(times: &[f64], values: &[f64]) -> Line {
    Line::weighted(times.iter().zip(values).map(|(&t, &y)| (t, y, t.powi(-3))))
}

fn weighted_slope(times: &[f64], values: &[f64]) -> f64 {
    weighted_line(times, values).slope()
}

impl LinearFit {
    /// The line at each lag of its range; not a number at any other lag.
    pub(crate) fn line(&self, times: &[f64]) -> Vec<f64> {
        let at = |t: &f64| match (self.from..=self.to).contains(t) {
            true => self.intercept + self.slope * t,
            false => f64::NAN,
        };
        times.iter().map(at).collect()
    }
}

/// Fits the linear regime of a lag curve; `None` where there are too few lags. `blocks(end)` gives the values
/// at the first `end` lags over each of successive blocks of the run.
///
/// The end is `fit_to`, or a twentieth of the run. The start is `fit_from`, or 2s, where s is the first lag from which the
/// slope no longer changes. There the slope over [s, 2s] agrees with the slope from 2s to the end, and the same holds for
/// every later octave. Slopes agree within two standard errors of their difference, taken block by block, or within half a
/// per cent. The octave [s, 2s] is left out: it may be off by two standard errors, and with these weights it would decide.
pub(crate) fn fit_linear_regime(
    curve: &LagCurve,
    blocks: impl Fn(usize) -> Vec<Vec<f64>>,
    fit_from: Option<f64>,
    fit_to: Option<f64>,
) -> Option<LinearFit> {
    // A lag given in decimal must not be lost to rounding.
    let slack = 1.0 + 1e-9;
    let end_time = fit_to.unwrap_or(curve.duration * LONGEST_PART) * slack;
    let end = curve.times.partition_point(|t| *t <= end_time);
    let blocks = blocks(end);
    let first_from = |time: f64| curve.times.partition_point(|t| *t * slack < time);
    let fit = |start: usize, settled: bool| -> Option<LinearFit> {
        let later = first_from(2.0 * curve.times.get(start)?);
        if end < start + FEWEST_POINTS {
            return None;
        }
        let line_from =
            |first: usize| weighted_line(&curve.times[first..end], &curve.values[first..end]);
        let line = line_from(start);
        let slope = line.slope();
        Some(LinearFit {
            slope,
            intercept: line.intercept(),
            change: if fit_from.is_none() && later + FEWEST_POINTS <= end {
                line_from(later).slope() - slope
            } else {
                0.0
            },
            block_slopes: blocks
                .iter()
                .map(|b| weighted_slope(&curve.times[start..end], &b[start..end]))
                .collect(),
            overlap: curve.times[end - 1].min(DECISIVE * curve.times[start]) * blocks.len() as f64
                / curve.duration,
            from: curve.times[start],
            to: curve.times[end - 1],
            settled,
        })
    };
    if let Some(from) = fit_from {
        return fit(first_from(from), true);
    }
    let first = *curve.times.first()?;
    let mut octaves = Vec::new();
    let mut time = first;
    while first_from(2.0 * time) + FEWEST_POINTS <= end {
        octaves.push((first_from(time), first_from(2.0 * time)));
        time *= 2.0;
    }
    let agrees = |&(start, middle): &(usize, usize)| {
        let difference: Vec<f64> = blocks
            .iter()
            .map(|b| {
                let early = (b[middle] - b[start]) / (curve.times[middle] - curve.times[start]);
                early - weighted_slope(&curve.times[middle..end], &b[middle..end])
            })
            .collect();
        let late = weighted_slope(&curve.times[middle..end], &curve.values[middle..end]);
        let overlap = curve.times[end - 1] * blocks.len() as f64 / curve.duration;
        let allowed = AGREEMENT_SIGMAS * error_with_overlap(&difference, overlap).standard_error;
        difference.len() >= FEWEST_BLOCKS
            && mean(&difference).abs() <= allowed.max(AGREEMENT_PART * late.abs())
    };
    // The last octave that disagrees is followed by the start; one octave at least must agree.
    let settled_from =
        octaves.iter().rposition(|octave| !agrees(octave)).map_or(0, |last| last + 1);
    match octaves.get(settled_from) {
        Some(&(start, _)) => {
            let from = curve.times[start];
            let settled = curve.times[end - 1] >= SHORTEST_STRETCH * from;
            fit(first_from(2.0 * from), settled)
        }
        None => fit(end.saturating_sub(FEWEST_POINTS.max(end / 4)), false),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(value: impl Fn(f64) -> f64) -> LagCurve {
        let times: Vec<f64> = (1..=200).map(|k| 0.1 * f64::from(k)).collect();
        let values: Vec<f64> = times.iter().map(|t| value(*t)).collect();
        LagCurve { errors: vec![0.0; times.len()], times, values, duration: 400.0 }
    }

    /// Blocks that differ by a small part of the curve.
    fn fit(curve: &LagCurve, from: Option<f64>, to: Option<f64>) -> Option<LinearFit> {
        let blocks = |end: usize| {
            (0..16)
                .map(|b| 1.0 + 0.01 * f64::from(b).sin())
                .map(|factor| curve.values[..end].iter().map(|v| v * factor).collect())
                .collect()
        };
        fit_linear_regime(curve, blocks, from, to)
    }

    #[test]
    fn a_straight_line_with_an_intercept_is_fitted_exactly() {
        let fit = fit(&curve(|t| 0.4 + 0.2 * t), Some(1.0), Some(8.0)).unwrap();
        assert!((fit.slope - 0.2).abs() < 1e-12 && (fit.intercept - 0.4).abs() < 1e-12);
        let line = fit.line(&[0.5, 2.0, 9.0]);
        assert!(line[0].is_nan() && (line[1] - 0.8).abs() < 1e-12 && line[2].is_nan());
        assert!((fit.from - 1.0).abs() < 1e-9 && (fit.to - 8.0).abs() < 1e-9);
    }

    #[test]
    fn the_bend_at_short_lags_is_left_out() {
        let fit = fit(&curve(|t| t - 1.0 + (-t).exp()), None, None).unwrap();
        assert!(fit.settled && fit.from > 6.0, "{fit:?}");
        // Two octaves agree to half a per cent; less of the bend is left behind the first of them.
        assert!((fit.slope - 1.0).abs() < 0.0005, "{fit:?}");
    }

    #[test]
    fn a_curve_that_keeps_bending_is_said_to() {
        let fit = fit(&curve(|t| t * t), None, None).unwrap();
        assert!(!fit.settled);
    }

    #[test]
    fn a_short_run_has_no_fit() {
        let mut short = curve(|t| t);
        short.duration = 1.0;
        assert!(fit(&short, None, None).is_none());
    }
}
