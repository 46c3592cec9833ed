//! Do the printed errors of one quantity in one cell cover?

use std::collections::BTreeMap;

use super::distributions::{binomial_tails, chi_squared_tails};
use super::line::Line;
use super::plan::{Cell, Ensemble, LENGTHS};
use super::records::{CONSERVED, Printed, Sample};

/// Share of a normal distribution within one and two standard deviations.
pub const NORMAL: [f64; 2] = [0.6827, 0.9545];

/// A share is off where a true one would give it with less than this probability in either direction: 0.1 % in all.
pub const RARE: f64 = 5e-4;

/// χ² is off below its 0.1 % point and above its 99.9 % point.
const RARE_CHI_SQUARED: f64 = 1e-3;

/// Numbers below which a scatter says nothing.
const FEWEST: usize = 5;

/// Something that is wrong, and the probability that chance alone does it.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// What is wrong.
    pub what: String,
    /// Probability of this or worse with right errors; 0 for what may never happen.
    pub probability: f64,
}

/// One quantity in one cell.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The cell.
    pub cell: Cell,
    /// The quantity.
    pub quantity: String,
    /// Runs that printed a mean with an error.
    pub given: usize,
    /// Runs that did not, by what they said.
    pub without: BTreeMap<String, usize>,
    /// Runs within one and two errors of the long-run mean.
    pub within: [usize; 2],
    /// Mean distance from the long-run mean, in errors.
    pub offset: f64,
    /// χ² of the scatter over the seeds, Σ(x − x̄)²/⟨s²⟩.
    pub chi_squared: f64,
    /// Its degrees of freedom; 0 where too few runs printed an error.
    pub degrees: usize,
    /// What is wrong.
    pub faults: Vec<Fault>,
}

impl Judged {
    /// Scatter over the seeds in printed errors, where enough runs printed one.
    #[must_use]
    pub fn scatter(&self) -> Option<f64> {
        (self.degrees > 0).then(|| (self.chi_squared / self.degrees as f64).sqrt())
    }

    /// Probability of the worst fault.
    #[must_use]
    pub fn worst(&self) -> Option<f64> {
        self.faults.iter().map(|fault| fault.probability).min_by(f64::total_cmp)
    }
}

/// Whether a quantity is compared between seeds. What a run conserves is an accident of its start, and so is the
/// total energy at constant energy.
fn is_judged(quantity: &str, ensemble: Ensemble) -> bool {
    quantity != CONSERVED && !(quantity == "total_energy" && ensemble == Ensemble::Energy)
}

/// Judges every quantity of every sample.
#[must_use]
pub fn all(samples: &[Sample]) -> Vec<Judged> {
    let mut judged = Vec::new();
    for sample in samples {
        let Some(long) = long_run(samples, sample.cell) else {
            continue;
        };
        let mut quantities: Vec<&String> =
            (sample.runs.iter()).flat_map(|run| run.averages.keys()).collect();
        quantities.sort();
        quantities.dedup();
        judged.extend(
            (quantities.into_iter())
                .filter(|quantity| is_judged(quantity, sample.cell.ensemble))
                .filter_map(|quantity| one(sample, long, quantity)),
        );
    }
    judged
}

/// The sample whose means are the truth for a cell: the longest one of the same state and ensemble.
/// A length counts where it has at least half as many runs as any other length.
fn long_run(samples: &[Sample], cell: Cell) -> Option<&Sample> {
    let of_the_same = || {
        (samples.iter())
            .filter(move |s| s.cell.state == cell.state && s.cell.ensemble == cell.ensemble)
    };
    let most = of_the_same().map(|s| s.runs.len()).max()?;
    of_the_same()
        .filter(|s| 2 * s.runs.len() >= most && s.runs.len() >= FEWEST)
        .max_by_key(|s| s.cell.length)
}

/// Energies and means of the runs that printed one, with the error where there is one.
fn values(runs: &[Printed], quantity: &str) -> Vec<((f64, f64), Option<f64>)> {
    runs.iter()
        .filter_map(|run| {
            let average = run.averages.get(quantity)?;
            Some(((run.energy, average.mean?), average.error))
        })
        .collect()
}

/// One quantity; none where the long runs do not know its mean.
fn one(sample: &Sample, long: &Sample, quantity: &str) -> Option<Judged> {
    let slope = sample.cell.ensemble == Ensemble::Energy;
    let truth: Vec<(f64, f64)> = values(&long.runs, quantity).iter().map(|v| v.0).collect();
    let line = Line::fit(&truth, slope).filter(|_| truth.len() >= FEWEST)?;
    let own_mean = long.cell == sample.cell;
    let found = values(&sample.runs, quantity);
    let mut z = Vec::new();
    for (i, &(point, error)) in found.iter().enumerate() {
        let Some(error) = error else { continue };
        z.push(if own_mean {
            // The mean of the others: its variance is a known multiple of the run's own.
            let mut others = truth.clone();
            others.remove(i);
            let line = Line::fit(&others, slope)?;
            line.residual(point) / (error * (1.0 + line.leverage(point.0)).sqrt())
        } else {
            line.residual(point) / error.hypot(line.variance_at(point.0).sqrt())
        });
    }
    let printed: Vec<((f64, f64), f64)> =
        (found.iter()).filter_map(|&(point, error)| Some((point, error?))).collect();
    let (chi_squared, degrees) = scatter(&printed, &line, own_mean && slope);
    let within = [1.0, 2.0].map(|k| z.iter().filter(|z| z.abs() <= k).count());
    let mut judged = Judged {
        cell: sample.cell,
        quantity: quantity.to_owned(),
        given: z.len(),
        without: without(&sample.runs, quantity),
        within,
        offset: z.iter().sum::<f64>() / z.len() as f64,
        chi_squared,
        degrees,
        faults: Vec::new(),
    };
    judged.faults = faults(&judged);
    Some(judged)
}

/// χ² of the scatter about the mean of the runs.
/// At constant energy the scatter is about a line, with the slope of the long runs or of these runs themselves.
fn scatter(printed: &[((f64, f64), f64)], long: &Line, own_slope: bool) -> (f64, usize) {
    if printed.len() < FEWEST {
        return (0.0, 0);
    }
    let points: Vec<(f64, f64)> = if own_slope {
        printed.iter().map(|p| p.0).collect()
    } else {
        (printed.iter()).map(|p| (p.0.0, long.residual(p.0))).collect()
    };
    let Some(line) = Line::fit(&points, own_slope) else {
        return (0.0, 0);
    };
    let n = printed.len();
    let degrees = if own_slope { n - 2 } else { n - 1 };
    let variance = printed.iter().map(|p| p.1 * p.1).sum::<f64>() / n as f64;
    let squares: f64 = points.iter().map(|p| line.residual(*p).powi(2)).sum();
    (squares / variance, degrees)
}

/// One run in so many may be called out of equilibrium or incomplete by chance.
const BY_NATURE: usize = 10;

fn without(runs: &[Printed], quantity: &str) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for run in runs {
        let why = match run.averages.get(quantity) {
            Some(average) if average.mean.is_some() && average.error.is_some() => continue,
            Some(average) => average.standing.clone(),
            None => ABSENT.to_owned(),
        };
        *counts.entry(why).or_insert(0) += 1;
    }
    counts
}

/// What is said of a run that has no such average.
const ABSENT: &str = "absent";

/// What is wrong with the counts of a cell.
fn faults(judged: &Judged) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut tell = |what: String, probability: f64| faults.push(Fault { what, probability });
    let percent = |k: usize| 100.0 * k as f64 / judged.given as f64;
    let [one, two] = judged.within;
    if judged.given > 0 {
        let (below, above) = binomial_tails(one, judged.given, NORMAL[0]);
        if below < RARE || above < RARE {
            tell(format!("{:.0} % within one error", percent(one)), below.min(above));
        }
        let (below, _) = binomial_tails(two, judged.given, NORMAL[1]);
        if below < RARE {
            tell(format!("{:.0} % within two errors", percent(two)), below);
        }
    }
    if judged.degrees > 0 {
        let (below, above) = chi_squared_tails(judged.chi_squared, judged.degrees);
        if below < RARE_CHI_SQUARED || above < RARE_CHI_SQUARED {
            tell(format!("χ² {:.1} of {}", judged.chi_squared, judged.degrees), below.min(above));
        }
    }
    if judged.cell.state.is_liquid() && Some(&judged.cell.length) == LENGTHS.last() {
        // A bath changes how particles diffuse, however long the run: it may say so in place of a number. The tests of
        // equilibrium and of plateaus are wrong in some per cent of runs by their nature.
        for (why, n) in &judged.without {
            let by_nature = if why == "too-short" { 0 } else { judged.given / BY_NATURE };
            if why != ABSENT && why != "thermostat" && *n > by_nature {
                tell(format!("{n} runs without a number ({why})"), 0.0);
            }
        }
    }
    faults
}

#[cfg(test)]
mod tests;
