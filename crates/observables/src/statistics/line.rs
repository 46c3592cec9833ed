//! The straight line of least squares: every fit of a line in the project is this one.

use lennard_core::{Persist, RestoreError, StateReader, StateWriter};

/// The line y = a + b·x of weighted least squares, kept as sums about the mean point (x̄, ȳ).
///
/// It minimises Σ w·(y − a − b·x)². With x̄ = Σw·x/Σw and ȳ = Σw·y/Σw the slope is b = Σw(x − x̄)(y − ȳ)/Σw(x − x̄)², and the
/// line goes through (x̄, ȳ). Value and slope are not correlated at x̄.
///
/// - [`Line::through`] takes points without errors. Their scatter about the line, χ²/(n − 2), tells the errors of the line.
/// - [`Line::with_errors`] takes points with standard errors s and has w = 1/s². Where the points scatter by more than their
///   errors, variances of the line grow by χ²/(n − 2).
/// - [`Line::weighted`] takes any weights.
/// - [`Line::push`] adds one point of unit weight to a line whose points are not kept.
///
/// Numbers that too few points do not tell are NaN.
///
/// Sources: P. R. Bevington and D. K. Robinson, Data Reduction and Error Analysis for the Physical Sciences (2003), chapter 6;
/// for `push` the update formulas of B. P. Welford, "Note on a method for calculating corrected sums of squares and products",
/// Technometrics 4, 419 (1962), which lose no digits to a large mean.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Line {
    /// Number of points.
    n: f64,
    /// Σw; n where all weights are 1.
    weight: f64,
    mean_x: f64,
    mean_y: f64,
    /// Σw(x − x̄)², Σw(x − x̄)(y − ȳ), Σw(y − ȳ)².
    xx: f64,
    xy: f64,
    yy: f64,
    /// Whether the weights are 1/s² of known standard errors s.
    has_errors: bool,
}

impl Line {
    /// The line through points (x, y) of equal weight.
    #[must_use]
    pub fn through(points: &[(f64, f64)]) -> Self {
        Self::weighted(points.iter().map(|&(x, y)| (x, y, 1.0)))
    }

    /// The line through points (x, y, standard error of y); `None` for fewer than two abscissae, or where a point has no error.
    #[must_use]
    pub fn with_errors(points: &[(f64, f64, f64)]) -> Option<Self> {
        let good = |p: &(f64, f64, f64)| p.0.is_finite() && p.1.is_finite() && p.2 > 0.0;
        if !points.iter().all(good) {
            return None;
        }
        let line = Self::weighted(points.iter().map(|&(x, y, s)| (x, y, 1.0 / (s * s))));
        (line.xx > 0.0).then_some(Self { has_errors: true, ..line })
    }

    /// The correlation of x and y, from −1 to 1: r = Σw(x − x̄)(y − ȳ)/√(Σw(x − x̄)²·Σw(y − ȳ)²); NaN where one of them does not change.
    #[must_use]
    pub fn correlation(&self) -> f64 {
        self.xy / (self.xx * self.yy).sqrt()
    }

    /// The line through points (x, y, weight).
    #[must_use]
    pub fn weighted(points: impl Iterator<Item = (f64, f64, f64)> + Clone) -> Self {
        let (mut n, mut weight, mut wx, mut wy) = (0.0, 0.0, 0.0, 0.0);
        for (x, y, w) in points.clone() {
            n += 1.0;
            weight += w;
            wx += w * x;
            wy += w * y;
        }
        let (mean_x, mean_y) = (wx / weight, wy / weight);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for (x, y, w) in points {
            xx += w * (x - mean_x).powi(2);
            xy += w * (x - mean_x) * (y - mean_y);
            yy += w * (y - mean_y).powi(2);
        }
        Self { n, weight, mean_x, mean_y, xx, xy, yy, has_errors: false }
    }

    /// Takes one more point of unit weight.
    pub fn push(&mut self, x: f64, y: f64) {
        self.n += 1.0;
        self.weight = self.n;
        let (dx, dy) = (x - self.mean_x, y - self.mean_y);
        self.mean_x += dx / self.n;
        self.mean_y += dy / self.n;
        self.xx += dx * (x - self.mean_x);
        self.xy += dx * (y - self.mean_y);
        self.yy += dy * (y - self.mean_y);
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> u64 {
        self.n as u64
    }

    /// Whether there is no point yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.n == 0.0
    }

    /// The slope b.
    #[must_use]
    pub fn slope(&self) -> f64 {
        self.xy / self.xx
    }

    /// The value at x = 0.
    #[must_use]
    pub fn intercept(&self) -> f64 {
        self.mean_y - self.slope() * self.mean_x
    }

    /// The value at x.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        self.mean_y + self.slope() * (x - self.mean_x)
    }

    /// Where the line is zero, with the standard error to first order.
    #[must_use]
    pub fn zero(&self) -> (f64, f64) {
        let x = self.mean_x - self.mean_y / self.slope();
        (x, self.error_at(x) / self.slope().abs())
    }

    /// Root mean square of the deviations from the line, over all points; NaN for fewer than three.
    #[must_use]
    pub fn rms(&self) -> f64 {
        if self.n < 3.0 { f64::NAN } else { (self.chi_squared() / self.weight).sqrt() }
    }

    /// The standard error of the value at x.
    #[must_use]
    pub fn error_at(&self, x: f64) -> f64 {
        (self.variance_of_one() * self.leverage(x)).sqrt()
    }

    /// The standard error of the slope.
    #[must_use]
    pub fn error_of_slope(&self) -> f64 {
        (self.variance_of_one() / self.xx).sqrt()
    }

    /// Variance of the value at x over the variance of a point of unit weight: 1/Σw + (x − x̄)²/Σw(x − x̄)².
    #[must_use]
    pub fn leverage(&self, x: f64) -> f64 {
        1.0 / self.weight + (x - self.mean_x).powi(2) / self.xx
    }

    /// χ² = Σw·(y − a − b·x)².
    fn chi_squared(&self) -> f64 {
        // Rounding can leave a tiny negative rest where all points lie on the line.
        (self.yy - self.xy * self.xy / self.xx).max(0.0)
    }

    /// The variance of a point of unit weight: χ²/(n − 2), and at least 1 where the errors of the points are known.
    #[must_use]
    pub fn variance_of_one(&self) -> f64 {
        let freedom = self.n - 2.0;
        let scatter = if freedom > 0.0 { self.chi_squared() / freedom } else { f64::NAN };
        // The larger of NaN and 1 is 1.
        if self.has_errors { scatter.max(1.0) } else { scatter }
    }
}

impl Persist for Line {
    /// A line that grows over a run has unit weights, so that Σw is n.
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { n, weight: _, mean_x, mean_y, xx, xy, yy, has_errors: _ } = *self;
        to.put_f64("line", &[n, mean_x, mean_y, xx, xy, yy]);
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        let [n, mean_x, mean_y, xx, xy, yy] = from.f64s("line")?;
        *self = Self { n, weight: n, mean_x, mean_y, xx, xy, yy, has_errors: false };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_through_exact_points_has_its_numbers_and_the_errors_of_theory() {
        let points: Vec<_> =
            (0..5).map(|i| (f64::from(i), 3.0 - 0.5 * f64::from(i), 0.1)).collect();
        let line = Line::with_errors(&points).unwrap();
        assert!((line.at(0.0) - 3.0).abs() < 1e-13 && (line.slope() + 0.5).abs() < 1e-13);
        // σ²/Σ(x − x̄)² with Σ = 10, and σ²/n.
        assert!((line.error_of_slope() - 0.1 / 10.0_f64.sqrt()).abs() < 1e-13);
        assert!((line.error_at(2.0) - 0.1 / 5.0_f64.sqrt()).abs() < 1e-13);
        let (zero, error) = line.zero();
        assert!((zero - 6.0).abs() < 1e-12);
        assert!((error - line.error_at(6.0) / 0.5).abs() < 1e-12);
    }

    #[test]
    fn scatter_tells_the_errors_and_widens_known_ones() {
        let points = [(0.0, 0.0, 0.01), (1.0, 1.5, 0.01), (2.0, 2.0, 0.01)];
        let line = Line::with_errors(&points).unwrap();
        // χ² = (0.1667² + 0.3333² + 0.1667²)/0.01² with one degree of freedom.
        let plain = 0.01 / 2.0_f64.sqrt();
        assert!((line.error_of_slope() / plain - 1666.67_f64.sqrt()).abs() < 0.01);
        let without = Line::through(&points.map(|(x, y, _)| (x, y)));
        assert!((without.error_of_slope() / line.error_of_slope() - 1.0).abs() < 1e-12);
        assert!((without.leverage(1.0) - 1.0 / 3.0).abs() < 1e-15);
        assert!(Line::through(&[(0.0, 1.0), (1.0, 2.0)]).error_of_slope().is_nan());
        assert!(
            Line::with_errors(&[(0.0, 1.0, 0.5), (1.0, 2.0, 0.5)]).unwrap().error_of_slope() > 0.5
        );
    }

    #[test]
    fn too_few_points_or_points_without_errors_make_no_line() {
        assert_eq!(Line::with_errors(&[(0.0, 0.0, 0.01)]), None);
        assert_eq!(Line::with_errors(&[(1.0, 0.0, 0.1), (1.0, 1.0, 0.1)]), None);
        assert_eq!(Line::with_errors(&[(1.0, 0.0, 0.0), (2.0, 1.0, 0.1)]), None);
        assert!(Line::through(&[(1.0, 2.0)]).slope().is_nan());
    }

    #[test]
    fn a_line_that_grows_is_the_line_through_all_points() {
        let points: Vec<_> = (0..50).map(|i| (f64::from(i), 7.0 + f64::from(i).sin())).collect();
        let mut grown = Line::default();
        points.iter().for_each(|(x, y)| grown.push(*x, *y));
        let whole = Line::through(&points);
        for (a, b) in [
            (grown.slope(), whole.slope()),
            (grown.intercept(), whole.intercept()),
            (grown.rms(), whole.rms()),
        ] {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        assert_eq!(grown.len(), 50);
    }
}
