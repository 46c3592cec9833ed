//! Straight lines through means with errors.

/// A least-squares line y = a + b·x through points with standard errors, with the covariances of a and b.
///
/// Where the points scatter by more than their errors, covariances grow by χ² over its degrees of freedom.
///
/// Source: P. R. Bevington and D. K. Robinson, Data Reduction and Error Analysis for the Physical Sciences (2003), chapter 6.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WeightedLine {
    /// The mean abscissa, about which value and slope are uncorrelated.
    middle: f64,
    /// The value there.
    value: f64,
    /// b.
    pub slope: f64,
    variance_of_value: f64,
    variance_of_slope: f64,
}

impl WeightedLine {
    /// The line through points (x, y, standard error of y); `None` with fewer than two abscissae, or without errors.
    pub fn through(points: &[(f64, f64, f64)]) -> Option<Self> {
        let good = |p: &(f64, f64, f64)| p.0.is_finite() && p.1.is_finite() && p.2 > 0.0;
        if points.len() < 2 || !points.iter().all(good) {
            return None;
        }
        let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
            points.iter().map(|(x, y, s)| of(*x, *y) / (s * s)).sum()
        };
        let weight = sum(&|_, _| 1.0);
        let middle = sum(&|x, _| x) / weight;
        let value = sum(&|_, y| y) / weight;
        let spread = sum(&|x, _| (x - middle).powi(2));
        if spread <= 0.0 {
            return None;
        }
        let slope = sum(&|x, y| (x - middle) * (y - value)) / spread;
        let chi_squared = sum(&|x, y| (y - value - slope * (x - middle)).powi(2));
        let freedom = points.len() as f64 - 2.0;
        let excess = if freedom > 0.0 { (chi_squared / freedom).max(1.0) } else { 1.0 };
        Some(Self {
            middle,
            value,
            slope,
            variance_of_value: excess / weight,
            variance_of_slope: excess / spread,
        })
    }

    /// The value at x.
    pub fn at(&self, x: f64) -> f64 {
        self.value + self.slope * (x - self.middle)
    }

    /// The standard error of the value at x.
    pub fn error_at(&self, x: f64) -> f64 {
        (self.variance_of_value + self.variance_of_slope * (x - self.middle).powi(2)).sqrt()
    }

    /// The standard error of the slope.
    pub fn error_of_slope(&self) -> f64 {
        self.variance_of_slope.sqrt()
    }

    /// Where the line is zero, with its standard error to first order.
    pub fn zero(&self) -> (f64, f64) {
        let x = self.middle - self.value / self.slope;
        (x, self.error_at(x) / self.slope.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_through_exact_points_has_its_numbers_and_the_errors_of_theory() {
        let points: Vec<_> =
            (0..5).map(|i| (f64::from(i), 3.0 - 0.5 * f64::from(i), 0.1)).collect();
        let line = WeightedLine::through(&points).unwrap();
        assert!((line.at(0.0) - 3.0).abs() < 1e-13 && (line.slope + 0.5).abs() < 1e-13);
        // σ²/Σ(x − x̄)² with Σ = 10, and σ²/n.
        assert!((line.error_of_slope() - 0.1 / 10.0_f64.sqrt()).abs() < 1e-13);
        assert!((line.error_at(2.0) - 0.1 / 5.0_f64.sqrt()).abs() < 1e-13);
        let (zero, error) = line.zero();
        assert!((zero - 6.0).abs() < 1e-12);
        assert!((error - line.error_at(6.0) / 0.5).abs() < 1e-12);
    }

    #[test]
    fn scatter_beyond_the_errors_widens_them_and_too_few_points_make_no_line() {
        let points = [(0.0, 0.0, 0.01), (1.0, 1.5, 0.01), (2.0, 2.0, 0.01)];
        let line = WeightedLine::through(&points).unwrap();
        // χ² = (0.1667² + 0.3333² + 0.1667²)/0.01² with one degree of freedom.
        let plain = 0.01 / 2.0_f64.sqrt();
        assert!((line.error_of_slope() / plain - 1666.67_f64.sqrt()).abs() < 0.01);
        assert_eq!(WeightedLine::through(&points[..1]), None);
        assert_eq!(WeightedLine::through(&[(1.0, 0.0, 0.1), (1.0, 1.0, 0.1)]), None);
        assert_eq!(WeightedLine::through(&[(1.0, 0.0, 0.0), (2.0, 1.0, 0.1)]), None);
    }
}
