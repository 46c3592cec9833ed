//! From estimates to averages: what has an error, and what is said in its place.

use crate::{Average, Doubt, Estimate, Findings};
use lennard_core::number::significant;

use crate::statistics::{self, TRANSIENT_OF_MANY_ERRORS, Trend};

/// The fewest independent samples of a time series that give an error. The widest window of the error is flat over a 21st
/// of the series. With 50 independent samples it loses e^{−2·50/21} = 1 % of an exponential correlation, with 25 a tenth.
pub(crate) const FEWEST_INDEPENDENT: f64 = 50.0;

/// The fewest independent blocks of a function of the run that give an error: the error is then known to 21 %.
pub(crate) const FEWEST_INDEPENDENT_BLOCKS: f64 = 12.0;

/// The fewest independent samples of the squares that a variance is made of: it is known to 8 %, and is hardly skewed.
pub(crate) const FEWEST_FLUCTUATIONS: f64 = 300.0;

/// The mean of a time series after `cut` rows, with what speaks against it.
pub(crate) fn of_series(name: &str, unit: &str, column: &[f64], cut: usize) -> Average {
    let rest = &column[cut.min(column.len())..];
    let estimate = statistics::estimate_after(column, cut);
    with_doubts(name, unit, estimate, rest, FEWEST_INDEPENDENT, |trend| changes("it", trend))
}

/// An estimate with the error of the mean of `influence`. It is too short with fewer than `fewest` independent samples,
/// and not in equilibrium where the influence has a trend.
pub(crate) fn of_fluctuations(
    name: &str,
    unit: &str,
    estimate: Estimate,
    influence: &[f64],
    fewest: f64,
) -> Average {
    with_doubts(name, unit, estimate, influence, fewest, fluctuations_change)
}

/// The error of the mean of `influence`, which is made of squares and products of fluctuations.
pub(crate) fn estimate_of_fluctuations(influence: &[f64]) -> Estimate {
    with_overlap(statistics::mean(influence), influence, 1.0)
}

/// A value with the error of the mean of a series whose members look `overlap` places ahead.
fn with_overlap(mean: f64, series: &[f64], overlap: f64) -> Estimate {
    let error = statistics::error_with_overlap(series, overlap);
    Estimate {
        mean,
        standard_error: error.standard_error,
        n_effective: error.n_effective,
        least_effective: error.least_effective,
        freedom: error.freedom,
        equilibration_cut: 0,
    }
}

fn with_doubts(
    name: &str,
    unit: &str,
    estimate: Estimate,
    influence: &[f64],
    fewest: f64,
    words: impl Fn(&Trend) -> String,
) -> Average {
    Average::new(name, unit, estimate).doubted(too_few(&estimate, influence.len(), fewest)).doubted(
        statistics::trend(influence, TRANSIENT_OF_MANY_ERRORS)
            .map(|trend| Doubt::NotInEquilibrium(words(&trend))),
    )
}

/// A trend of what a derived quantity is made of.
fn fluctuations_change(trend: &Trend) -> String {
    format!(
        "what it is made of still changes from the first to the last third ({} standard errors)",
        significant(trend.errors, 2)
    )
}

/// A function of the whole run with its value over each of successive blocks, or with the pseudo-values of a jackknife. A
/// value looks `overlap` blocks ahead: a mean-square displacement does, by its lag.
pub(crate) fn of_blocks(
    name: &str,
    unit: &str,
    value: f64,
    blocks: &[f64],
    overlap: f64,
) -> Average {
    let estimate = with_overlap(value, blocks, overlap);
    of_fluctuations(name, unit, estimate, blocks, FEWEST_INDEPENDENT_BLOCKS)
}

/// The same with half of what the number changes under another choice of the analysis that is as good, beside its error.
pub(crate) fn with_choice(mut average: Average, change: f64) -> Average {
    let error = &mut average.estimate.standard_error;
    *error = error.hypot(0.5 * change);
    average
}

/// Says in each average how many samples were discarded.
pub(crate) fn tell_discarded(findings: &mut Findings, samples: u64) {
    for average in &mut findings.averages {
        average.estimate.equilibration_cut = samples;
    }
}

fn too_few(estimate: &Estimate, samples: usize, fewest: f64) -> Option<Doubt> {
    if samples < statistics::FEWEST_BLOCKS {
        return Some(Doubt::TooShort {
            why: match samples {
                0 => "no sample".into(),
                1 => "a single sample".into(),
                n => format!("only {n} samples"),
            },
            longer: fewest / samples.max(1) as f64,
        });
    }
    // A few samples cannot show that they are worth more than their number.
    let independent = estimate.least_effective.min(samples as f64);
    // A constant has no error to be known.
    (estimate.standard_error != 0.0 && independent < fewest).then(|| Doubt::TooShort {
        why: format!(
            "worth {:.0} independent samples where {fewest:.0} are needed",
            independent.floor()
        ),
        longer: fewest / independent,
    })
}

/// A trend in words.
pub(crate) fn changes(what: &str, trend: &Trend) -> String {
    let verb = if trend.last > trend.first { "rises" } else { "falls" };
    format!(
        "{what} still {verb} from {} to {} (first and last third, {} standard errors)",
        significant(trend.first, 4),
        significant(trend.last, 4),
        significant(trend.errors, 2)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::statistics::synthetic::Ar1;

    #[test]
    fn few_independent_samples_are_too_short_and_say_how_much_longer() {
        // τ = 50 of 1000 samples: worth 10.
        let series = Ar1::new((-0.02_f64).exp(), 1).series(1000);
        let average = of_series("x", "", &series, 0);
        let Some(Doubt::TooShort { longer, .. }) = &average.doubt else { panic!("{average:?}") };
        assert!((1.5..10.0).contains(longer), "{longer}");
        let long = Ar1::new((-0.02_f64).exp(), 1).series(50_000);
        assert_eq!(of_series("x", "", &long, 0).doubt, None);
    }

    #[test]
    fn what_still_changes_is_not_in_equilibrium_with_both_values() {
        let mut series = Ar1::new(0.5, 2).series(2000);
        (0..2000).for_each(|i| series[i] += 10.0 - i as f64 / 200.0);
        let average = of_series("x", "", &series, 0);
        let Some(Doubt::NotInEquilibrium(why)) = &average.doubt else { panic!("{average:?}") };
        assert!(why.starts_with("it still falls from 8.3"), "{why}");
    }

    #[test]
    fn a_constant_is_exact_and_one_sample_is_none() {
        assert_eq!(of_series("x", "", &[2.0; 64], 0).doubt, None);
        assert!(of_series("x", "", &[2.0], 0).doubt.is_some());
        assert!(of_blocks("x", "", 1.0, &[], 0.0).doubt.is_some());
    }
}
