//! The two routes to the integrals, and what follows from each.

use crate::{Doubt, statistics};

use super::KirkwoodBuff;
use super::integral::{Surroundings, at_zero, integral};
use crate::blocks::BlockedSums;
use crate::species_pairs::SpeciesPair;

/// Standard errors of a difference beyond which the integral has not converged, and beyond which the routes disagree.
const STILL_CHANGES: f64 = 4.0;

/// What the integrals of one route say together.
struct Sums {
    /// G_ab in σ³, in the order of the pairs.
    integrals: Vec<f64>,
    /// Γ and ρTκ; not a number with three species or more.
    factor: f64,
    compressibility: f64,
}

/// A number with its pseudo-values over blocks of the run.
pub(super) type Found = (f64, Vec<f64>);

impl KirkwoodBuff {
    /// g_ab in each bin from the mean counts of that pair: the mean of b around a and of a around b.
    pub(super) fn distribution(&self, pair: SpeciesPair, counts: &[f64]) -> Vec<f64> {
        let alike = pair.a == pair.b;
        let of = |middle: usize, others: usize| -> Vec<f64> {
            let each = if alike { 2.0 } else { 1.0 };
            // Counts are weighted by V over the first V: divided by the mean of that weight they are numbers of neighbors.
            let weight = self.seen.volume() / self.seen.first_volume();
            let scale = each / (self.species.count(middle) as f64 * weight);
            let neighbors: Vec<f64> = counts.iter().map(|c| c * scale).collect();
            Surroundings {
                width: self.width(),
                neighbors: &neighbors,
                others: self.species.count(others) as f64,
                alike,
                volume: self.seen.volume(),
            }
            .distribution()
        };
        let one = of(pair.a, pair.b);
        if alike {
            return one;
        }
        let other = of(pair.b, pair.a);
        let both = one.iter().zip(&other);
        both.map(|(x, y)| 0.5 * (x + y)).collect()
    }

    /// G_ab of every pair over a range of so many bins, from the mean counts of all.
    pub(super) fn of_counts(&self, counts: &[f64], bins: usize) -> Vec<f64> {
        let of_pairs = self.pairs.iter().zip(counts.chunks(self.bins));
        of_pairs
            .map(|(pair, counts)| integral(&self.distribution(*pair, counts), self.width(), bins))
            .collect()
    }

    /// G_ab of every pair from the mean factors of all, by the line through the first `shells` wave numbers.
    pub(super) fn of_factors(&self, factors: &[f64], shells: usize) -> Vec<f64> {
        let numbers = self.vectors.wave_numbers(self.seen.sides());
        let squares: Vec<f64> = numbers[..shells].iter().map(|k| k * k).collect();
        let members: Vec<f64> = self.vectors.members().iter().map(|n| *n as f64).collect();
        let of_pairs = self.pairs.iter().zip(factors.chunks(self.vectors.shells()));
        of_pairs
            .map(|(pair, values)| {
                let at_zero = at_zero(&squares, &values[..shells], &members[..shells]);
                let (x, y) = (self.species.fraction(pair.a), self.species.fraction(pair.b));
                let own = if pair.a == pair.b { 1.0 } else { 0.0 };
                (at_zero - own) / (self.density() * (x * y).sqrt())
            })
            .collect()
    }

    /// Γ and ρTκ from the integrals.
    fn sums(&self, integrals: Vec<f64>) -> Sums {
        let rho = self.density();
        let (factor, compressibility) = match integrals[..] {
            [g] => (f64::NAN, 1.0 + rho * g),
            [aa, ab, bb] => {
                let (x, y) = (self.species.fraction(0), self.species.fraction(1));
                let factor = 1.0 / (1.0 + rho * x * y * (aa + bb - 2.0 * ab));
                let numbers =
                    1.0 + rho * (x * aa + y * bb) + rho * rho * x * y * (aa * bb - ab * ab);
                (factor, factor * numbers)
            }
            _ => (f64::NAN, f64::NAN),
        };
        Sums { integrals, factor, compressibility }
    }

    /// All numbers of a route with their pseudo-values: G_ab, then Γ and ρTκ.
    pub(super) fn route(
        &self,
        sums: &BlockedSums,
        integrals: impl Fn(&[f64]) -> Vec<f64>,
    ) -> Vec<(f64, Vec<f64>)> {
        sums.jackknife_of_each(|means| {
            let Sums { mut integrals, factor, compressibility } = self.sums(integrals(means));
            integrals.extend([factor, compressibility]);
            integrals
        })
    }

    /// Names and units of the numbers of a route; the last two are Γ and ρTκ.
    pub(super) fn names(&self, route: &str) -> Vec<(String, &'static str)> {
        let of_pairs = self.pairs.iter();
        let mut names: Vec<_> = of_pairs
            .map(|pair| (format!("kirkwood_buff{route}{}", self.suffix(*pair)), "σ³"))
            .collect();
        names.push((format!("thermodynamic_factor{route}"), ""));
        names.push((format!("compressibility_kirkwood_buff{route}"), "σ³/ε"));
        names
    }
}

/// How far two numbers with pseudo-values over the same blocks differ, in standard errors of the difference.
fn difference_in_errors(one: &(f64, Vec<f64>), other: &(f64, Vec<f64>)) -> f64 {
    let pairs = one.1.iter().zip(&other.1);
    let differences: Vec<f64> = pairs.map(|(x, y)| x - y).collect();
    let error = statistics::error_of_mean(&differences).standard_error;
    ((one.0 - other.0) / error).abs()
}

impl KirkwoodBuff {
    /// Why number k has not converged; `None` where it has, as far as this run tells.
    pub(super) fn doubt(
        k: usize,
        by_distance: &[Found],
        by_less: &[Found],
        by_waves: &[Found],
    ) -> Option<Doubt> {
        let change = difference_in_errors(&by_distance[k], &by_less[k]);
        if change > STILL_CHANGES {
            return Some(Doubt::Incomplete(format!(
                "the integral over g(r) still changes by {change:.1} standard errors over the last 15 % of its range: take a larger box"
            )));
        }
        let apart = difference_in_errors(&by_distance[k], &by_waves[k]);
        (apart > STILL_CHANGES).then(|| {
        Doubt::Incomplete(format!(
            "g(r) and S(k) give numbers that are {apart:.1} standard errors apart: take a larger box"
        ))
    })
    }
}
