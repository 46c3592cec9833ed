//! Shares pooled over cells, where seeds are many enough for narrow bars.

use lennard_observables::quantities::quantity_of;
use lennard_observables::{Allowed, Reference, Verdict, judge};

use super::super::probability::binomial_tails;
use super::judge::{Judged, NORMAL, RARE};
use crate::lists::grouped;

/// Shares that a group must have within one error, and at least within two.
const BARS: ([f64; 2], f64) = ([0.60, 0.76], 0.92);

/// Numbers that count as an independent one where quantities are pooled, since quantities of one run move together.
const TOGETHER: usize = 3;

/// The quantity that another one repeats; groups count only the first.
pub fn repeats(quantity: &str) -> Option<&'static str> {
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
    fn add(&mut self, judged: &Judged) {
        self.given += judged.given;
        self.without += judged.without.values().sum::<usize>();
        for (sum, within) in self.within.iter_mut().zip(judged.within) {
            *sum += within;
        }
        self.scatters.extend(judged.scatter());
    }

    /// Share within `k` + 1 errors.
    pub fn share(&self, k: usize) -> f64 {
        self.within[k] as f64 / self.given as f64
    }

    /// Scatter over the seeds in printed errors, the median over the cells: a few bad cells leave it alone.
    pub fn scatter(&self) -> Option<f64> {
        let mut sorted = self.scatters.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied()
    }

    /// How far the shares are outside their bars.
    pub fn far(&self) -> f64 {
        let ([low, high], least) = BARS;
        let one = Reference::band(low, high).difference(self.share(0));
        let two = Reference::band(least, f64::INFINITY).difference(self.share(1));
        one.abs().max(two.abs())
    }

    /// The verdict on the shares. Outside their bars as chance may have it with so few numbers they are too coarse.
    pub fn verdict(&self) -> Verdict {
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
    judged: &[Judged],
    lengths: &[u64],
    together: usize,
    name: impl Fn(&Judged) -> String,
) -> Vec<Row> {
    let sums_of = |cells: &[&Judged], length: u64| {
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
pub fn by_quantity(judged: &[Judged], lengths: &[u64]) -> Vec<Row> {
    let mut rows = rows(judged, lengths, 1, |one| one.quantity.clone());
    rows.sort_by(|a, b| a.name.cmp(&b.name));
    rows
}

/// Each state and ensemble, and all of them, over all quantities that do not repeat another one.
pub fn by_state(judged: &[Judged], lengths: &[u64]) -> Vec<Row> {
    let once: Vec<Judged> =
        (judged.iter()).filter(|one| repeats(&one.quantity).is_none()).cloned().collect();
    let mut all = rows(&once, lengths, TOGETHER, |one| one.cell.state.clone());
    all.sort_by(|a, b| a.name.cmp(&b.name));
    all.extend(rows(&once, lengths, TOGETHER, |_| "all".to_owned()));
    all
}

#[cfg(test)]
mod tests {
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
