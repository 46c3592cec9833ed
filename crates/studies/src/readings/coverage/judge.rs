//! Do the printed errors of one quantity in one cell cover?

use std::collections::BTreeMap;

use lennard_io::AverageRecord;
use lennard_observables::quantities::quantity_of;
use lennard_observables::statistics::{Line, mean, variance};
use lennard_observables::{Allowed, Reference, Standing, Verdict, judge};
use serde::Serialize;

use super::super::agreement::{binomial_tails, chi_squared_tails};
use crate::lists::grouped;

/// The energy that a run conserves.
pub const CONSERVED: &str = "conserved_energy";

/// All runs that differ in their seed alone.
#[derive(Debug, Clone)]
pub struct Sample<'a> {
    /// What the runs are.
    pub cell: Cell,
    /// The means of each finished run.
    pub runs: Vec<&'a BTreeMap<String, AverageRecord>>,
}

/// What runs have in common that differ in their seed alone.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Cell {
    /// The state and what else the study chose, but for the length.
    pub state: String,
    /// Measured steps.
    pub steps: u64,
    /// Whether nothing holds a temperature: each run then has an energy of its own.
    #[serde(skip)]
    pub is_at_constant_energy: bool,
    /// Whether a run must have an error for each quantity: a long one of a liquid.
    #[serde(skip)]
    pub is_long_enough: bool,
}

/// Share of a normal distribution within one and two standard deviations.
pub const NORMAL: [f64; 2] = [0.6827, 0.9545];

/// A share is off where a true one would give it with less than this probability in either direction: 0.1 % in all.
pub const RARE: f64 = 5e-4;

/// χ² is off below its 0.1 % point and above its 99.9 % point.
const RARE_CHI_SQUARED: f64 = 1e-3;

/// Numbers below which a scatter says nothing.
const FEWEST: usize = 5;

/// Something that is wrong, and the probability that chance alone does it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fault {
    /// What is wrong.
    pub what: String,
    /// Probability of this or worse with right errors; 0 for what may never happen.
    pub probability: f64,
}

/// One quantity in one cell.
#[derive(Debug, Clone, Serialize)]
pub struct Covered {
    /// The cell.
    #[serde(flatten)]
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
    pub distance: f64,
    /// χ² of the scatter over the seeds, Σ(x − x̄)²/⟨s²⟩.
    pub chi_squared: f64,
    /// Its degrees of freedom; 0 where too few runs printed an error.
    pub degrees_of_freedom: usize,
    /// What is wrong.
    pub faults: Vec<Fault>,
}

impl Covered {
    /// Scatter over the seeds in printed errors, where enough runs printed one.
    pub fn scatter(&self) -> Option<f64> {
        (self.degrees_of_freedom > 0)
            .then(|| (self.chi_squared / self.degrees_of_freedom as f64).sqrt())
    }

    /// Probability of the worst fault.
    pub(crate) fn worst(&self) -> Option<f64> {
        self.faults.iter().map(|fault| fault.probability).min_by(f64::total_cmp)
    }
}

/// Whether a quantity is compared between seeds. What a run conserves is an accident of its start, and so is the
/// total energy at constant energy.
fn is_judged(quantity: &str, cell: &Cell) -> bool {
    quantity != CONSERVED && !(quantity == "total_energy" && cell.is_at_constant_energy)
}

/// Judges every quantity of every sample.
pub(crate) fn all(samples: &[Sample<'_>]) -> Vec<Covered> {
    let mut judged = Vec::new();
    for sample in samples {
        let Some(long) = long_run(samples, &sample.cell) else {
            continue;
        };
        let mut quantities: Vec<&String> =
            (sample.runs.iter()).flat_map(|run| run.keys()).collect();
        quantities.sort();
        quantities.dedup();
        judged.extend(
            (quantities.into_iter())
                .filter(|quantity| is_judged(quantity, &sample.cell))
                .filter_map(|quantity| one(sample, long, quantity)),
        );
    }
    judged
}

/// The sample whose means are the truth for a cell: the longest one of the same state and ensemble.
/// A length counts where it has at least half as many runs as any other length.
fn long_run<'s, 'a>(samples: &'s [Sample<'a>], cell: &Cell) -> Option<&'s Sample<'a>> {
    let of_the_same = || samples.iter().filter(|s| s.cell.state == cell.state);
    let most = of_the_same().map(|s| s.runs.len()).max()?;
    of_the_same()
        .filter(|s| 2 * s.runs.len() >= most && s.runs.len() >= FEWEST)
        .max_by_key(|s| s.cell.steps)
}

/// Energies and means of the runs that printed one, with the error where there is one.
fn values(
    runs: &[&BTreeMap<String, AverageRecord>],
    quantity: &str,
) -> Vec<((f64, f64), Option<f64>)> {
    let value = |run: &&BTreeMap<String, AverageRecord>| {
        let average = run.get(quantity).filter(|average| average.estimate.mean.is_finite())?;
        let error = Some(average.estimate.standard_error).filter(|error| error.is_finite());
        Some(((run.get(CONSERVED)?.estimate.mean, average.estimate.mean), error))
    };
    runs.iter().filter_map(value).collect()
}

/// The long-run mean: a straight line in the energy at constant energy, and one number elsewhere.
enum LongRun {
    Mean { n: f64, mean: f64, variance: f64 },
    Line(Line),
}

impl LongRun {
    /// Through points (energy, value); `None` where too few of them leave no scatter.
    fn of(points: &[(f64, f64)], is_line: bool) -> Option<Self> {
        if is_line {
            let line = Line::through(points);
            let has_scatter = points.len() > 2 && line.slope().is_finite();
            return has_scatter.then_some(Self::Line(line));
        }
        let values: Vec<f64> = points.iter().map(|(_, value)| *value).collect();
        (values.len() > 1).then(|| Self::Mean {
            n: values.len() as f64,
            mean: mean(&values),
            variance: variance(&values) * values.len() as f64 / (values.len() as f64 - 1.0),
        })
    }

    /// The distance of a point from it.
    fn residual(&self, (energy, value): (f64, f64)) -> f64 {
        match self {
            Self::Mean { mean, .. } => value - mean,
            Self::Line(line) => value - line.at(energy),
        }
    }

    /// Its variance at an energy, in variances of a single point.
    fn leverage(&self, energy: f64) -> f64 {
        match self {
            Self::Mean { n, .. } => 1.0 / n,
            Self::Line(line) => line.leverage(energy),
        }
    }

    /// Its variance at an energy.
    fn variance_at(&self, energy: f64) -> f64 {
        let of_one = match self {
            Self::Mean { variance, .. } => *variance,
            Self::Line(line) => line.variance_of_one(),
        };
        of_one * self.leverage(energy)
    }
}

/// One quantity; none where the long runs do not know its mean.
fn one(sample: &Sample<'_>, long: &Sample<'_>, quantity: &str) -> Option<Covered> {
    let is_line = sample.cell.is_at_constant_energy;
    let truth: Vec<(f64, f64)> = values(&long.runs, quantity).iter().map(|v| v.0).collect();
    let line = LongRun::of(&truth, is_line).filter(|_| truth.len() >= FEWEST)?;
    let own_mean = long.cell == sample.cell;
    let found = values(&sample.runs, quantity);
    let mut z = Vec::new();
    for (i, &(point, error)) in found.iter().enumerate() {
        let Some(error) = error else { continue };
        z.push(if own_mean {
            // The mean of the others: its variance is a known multiple of the run's own.
            let mut others = truth.clone();
            others.remove(i);
            let line = LongRun::of(&others, is_line)?;
            line.residual(point) / (error * (1.0 + line.leverage(point.0)).sqrt())
        } else {
            line.residual(point) / error.hypot(line.variance_at(point.0).sqrt())
        });
    }
    let printed: Vec<((f64, f64), f64)> =
        (found.iter()).filter_map(|&(point, error)| Some((point, error?))).collect();
    let (chi_squared, degrees_of_freedom) = scatter(&printed, &line, own_mean && is_line);
    let within = [1.0, 2.0].map(|k| z.iter().filter(|z| z.abs() <= k).count());
    let mut judged = Covered {
        cell: sample.cell.clone(),
        quantity: quantity.to_owned(),
        given: z.len(),
        without: without(&sample.runs, quantity),
        within,
        distance: z.iter().sum::<f64>() / z.len() as f64,
        chi_squared,
        degrees_of_freedom,
        faults: Vec::new(),
    };
    judged.faults = faults(&judged);
    Some(judged)
}

/// χ² of the scatter about the mean of the runs.
/// At constant energy the scatter is about a line, with the slope of the long runs or of these runs themselves.
fn scatter(printed: &[((f64, f64), f64)], long: &LongRun, own_slope: bool) -> (f64, usize) {
    if printed.len() < FEWEST {
        return (0.0, 0);
    }
    let points: Vec<(f64, f64)> = if own_slope {
        printed.iter().map(|p| p.0).collect()
    } else {
        (printed.iter()).map(|p| (p.0.0, long.residual(p.0))).collect()
    };
    let Some(line) = LongRun::of(&points, own_slope) else {
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

fn without(runs: &[&BTreeMap<String, AverageRecord>], quantity: &str) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for run in runs {
        let why = match run.get(quantity) {
            Some(average)
                if average.estimate.mean.is_finite()
                    && average.estimate.standard_error.is_finite() =>
            {
                continue;
            }
            Some(average) => average.standing.words().to_owned(),
            None => ABSENT.to_owned(),
        };
        *counts.entry(why).or_insert(0) += 1;
    }
    counts
}

/// What is said of a run that has no such average.
const ABSENT: &str = "absent";

/// What is wrong with the counts of a cell.
fn faults(judged: &Covered) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut add = |what: String, probability: f64| faults.push(Fault { what, probability });
    let percent = |k: usize| 100.0 * k as f64 / judged.given as f64;
    let [one, two] = judged.within;
    if judged.given > 0 {
        let (below, above) = binomial_tails(one, judged.given, NORMAL[0]);
        if below < RARE || above < RARE {
            add(format!("{:.0} % within one error", percent(one)), below.min(above));
        }
        let (below, _) = binomial_tails(two, judged.given, NORMAL[1]);
        if below < RARE {
            add(format!("{:.0} % within two errors", percent(two)), below);
        }
    }
    if judged.degrees_of_freedom > 0 {
        let (below, above) = chi_squared_tails(judged.chi_squared, judged.degrees_of_freedom);
        if below < RARE_CHI_SQUARED || above < RARE_CHI_SQUARED {
            add(
                format!("χ² {:.1} of {}", judged.chi_squared, judged.degrees_of_freedom),
                below.min(above),
            );
        }
    }
    if judged.cell.is_long_enough {
        // A bath changes how particles diffuse, however long the run: it may say so in place of a number. The tests of
        // equilibrium and of plateaus are wrong in some per cent of runs by their nature.
        for (why, n) in &judged.without {
            let by_nature =
                if why == Standing::TooShort.words() { 0 } else { judged.given / BY_NATURE };
            if why != ABSENT && why != Standing::Thermostat.words() && *n > by_nature {
                add(format!("{n} runs without a number ({why})"), 0.0);
            }
        }
    }
    faults
}

/// Shares that a group must have within one error, and at least within two.
const BARS: ([f64; 2], f64) = ([0.60, 0.76], 0.92);

/// Numbers that count as an independent one where quantities are pooled, since quantities of one run move together.
const TOGETHER: usize = 3;

/// The quantity that another one repeats; groups count only the first.
pub(crate) fn repeats(quantity: &str) -> Option<&'static str> {
    quantity_of(quantity)?.repeats
}

/// Sums over cells.
#[derive(Debug, Clone, Default)]
pub struct Sums {
    /// Means with errors.
    pub given: usize,
    /// Runs that printed none.
    pub without: usize,
    /// How many of the means are within one and two errors.
    pub within: [usize; 2],
    /// Numbers that count as an independent one.
    together: usize,
    /// Scatter over the seeds in printed errors, of each cell where it is known.
    scatters: Vec<f64>,
}

impl Sums {
    fn add(&mut self, judged: &Covered) {
        self.given += judged.given;
        self.without += judged.without.values().sum::<usize>();
        for (sum, within) in self.within.iter_mut().zip(judged.within) {
            *sum += within;
        }
        self.scatters.extend(judged.scatter());
    }

    /// Share within `k` + 1 errors.
    pub(crate) fn share(&self, k: usize) -> f64 {
        self.within[k] as f64 / self.given as f64
    }

    /// Scatter over the seeds in printed errors, the median over the cells: a few bad cells leave it alone.
    pub fn scatter(&self) -> Option<f64> {
        let mut sorted = self.scatters.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied()
    }

    /// How far the shares are outside their bars.
    pub(crate) fn far(&self) -> f64 {
        let ([low, high], least) = BARS;
        let one = Reference::band(low, high).difference(self.share(0));
        let two = Reference::band(least, f64::INFINITY).difference(self.share(1));
        one.abs().max(two.abs())
    }

    /// The verdict on the shares. Outside their bars as chance may have it with so few numbers they are too coarse.
    pub(crate) fn verdict(&self) -> Verdict {
        if self.given == 0 {
            return Verdict::Agrees;
        }
        let verdict = judge(self.far(), Reference::value(0.0), Allowed::within(0.0));
        let shares = [self.share(0), self.share(1)];
        let n = self.given.div_ceil(self.together.max(1));
        let tails =
            |k: usize| binomial_tails((shares[k] * n as f64).round() as usize, n, NORMAL[k]);
        let ((below, above), (below_two, _)) = (tails(0), tails(1));
        let is_chance = below.min(above).min(below_two) >= RARE;
        if verdict == Verdict::Differs && is_chance { Verdict::TooCoarse } else { verdict }
    }
}

/// A row of a table: a name, and sums by length.
#[derive(Debug, Clone)]
pub struct Row {
    /// Quantity, or state and ensemble.
    pub name: String,
    /// Sums for each of the lengths; empty ones where nothing was run.
    pub sums: Vec<Sums>,
}

/// Sums over the cells that share a name, for each length.
fn rows(
    judged: &[Covered],
    lengths: &[u64],
    together: usize,
    name: impl Fn(&Covered) -> String,
) -> Vec<Row> {
    let sums_of = |cells: &[&Covered], length: u64| {
        let mut sums = Sums { together, ..Sums::default() };
        cells.iter().filter(|one| one.cell.steps == length).for_each(|one| sums.add(one));
        sums
    };
    let named = grouped(judged.iter().map(|one| (name(one), one))).into_iter();
    named
        .map(|(name, cells)| {
            let sums = lengths.iter().map(|length| sums_of(&cells, *length)).collect();
            Row { name, sums }
        })
        .collect()
}

/// Each quantity over all states and ensembles.
pub(crate) fn by_quantity(judged: &[Covered], lengths: &[u64]) -> Vec<Row> {
    let mut rows = rows(judged, lengths, 1, |one| one.quantity.clone());
    rows.sort_by(|a, b| a.name.cmp(&b.name));
    rows
}

/// Each state and ensemble, and all of them, over all quantities that do not repeat another one.
pub(crate) fn by_state(judged: &[Covered], lengths: &[u64]) -> Vec<Row> {
    let once: Vec<Covered> =
        (judged.iter()).filter(|one| repeats(&one.quantity).is_none()).cloned().collect();
    let mut all = rows(&once, lengths, TOGETHER, |one| one.cell.state.clone());
    all.sort_by(|a, b| a.name.cmp(&b.name));
    all.extend(rows(&once, lengths, TOGETHER, |_| "all".to_owned()));
    all
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod tests_of_groups {
    use super::*;

    fn sums(given: usize, together: usize, one: f64, two: f64) -> Sums {
        let part = |share: f64| (share * given as f64).round() as usize;
        Sums { given, together, within: [part(one), part(two)], ..Sums::default() }
    }

    #[test]
    fn bars_hold_for_many_numbers_and_give_way_for_few() {
        assert_eq!(sums(900, 1, 0.68, 0.95).verdict(), Verdict::Agrees);
        assert_eq!(sums(900, 1, 0.61, 0.925).verdict(), Verdict::Agrees);
        for (one, two) in [(0.58, 0.95), (0.78, 0.99), (0.65, 0.9)] {
            let found = sums(900, 1, one, two);
            assert_eq!(found.verdict(), Verdict::Differs);
            assert!(found.far() < 0.021, "{found:?}");
        }
        assert_eq!(sums(500, 3, 0.59, 0.95).verdict(), Verdict::TooCoarse);
        assert_eq!(sums(30, 1, 0.5, 0.9).verdict(), Verdict::TooCoarse);
        // Errors too small by a factor of two.
        assert_eq!(sums(150, 3, 0.38, 0.68).verdict(), Verdict::Differs);
        assert_eq!(sums(0, 1, 0.0, 0.0).verdict(), Verdict::Agrees);
    }
}
