//! The long-run mean as a function of the energy.

/// A mean, or a straight line through points (energy, value), fitted with equal weights.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    n: usize,
    energy: f64,
    value: f64,
    slope: f64,
    /// Σ(e − ē)²; infinite for a mean, which no energy moves.
    width: f64,
    /// Variance of a single point about the line.
    variance: f64,
}

impl Line {
    /// Fits a line, or without `slope` the mean; none where too few points leave no scatter.
    #[must_use]
    pub fn fit(points: &[(f64, f64)], slope: bool) -> Option<Self> {
        let n = points.len();
        let parameters = if slope { 2 } else { 1 };
        if n <= parameters {
            return None;
        }
        let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n as f64;
        let (energy, value) = (mean(&|p| p.0), mean(&|p| p.1));
        let mut line = Self { n, energy, value, slope: 0.0, width: f64::INFINITY, variance: 0.0 };
        if slope {
            let width: f64 = points.iter().map(|p| (p.0 - energy).powi(2)).sum();
            if width <= 0.0 {
                return None;
            }
            let product: f64 = points.iter().map(|p| (p.0 - energy) * (p.1 - value)).sum();
            line.width = width;
            line.slope = product / width;
        }
        let squares: f64 = points.iter().map(|p| line.residual(*p).powi(2)).sum();
        line.variance = squares / (n - parameters) as f64;
        Some(line)
    }

    /// A point's distance from the line.
    #[must_use]
    pub fn residual(&self, point: (f64, f64)) -> f64 {
        point.1 - self.value - self.slope * (point.0 - self.energy)
    }

    /// Variance of the line at an energy, in variances of a single point: 1/n + (e − ē)²/Σ(e − ē)².
    #[must_use]
    pub fn leverage(&self, energy: f64) -> f64 {
        1.0 / self.n as f64 + (energy - self.energy).powi(2) / self.width
    }

    /// Variance of the line at an energy.
    #[must_use]
    pub fn variance_at(&self, energy: f64) -> f64 {
        self.variance * self.leverage(energy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_goes_through_points_on_it_and_a_mean_ignores_the_energy() {
        let points = [(0.0, 1.0), (1.0, 3.0), (2.0, 5.0), (3.0, 7.0)];
        let line = Line::fit(&points, true).unwrap();
        assert!(line.residual((10.0, 21.0)).abs() < 1e-12);
        assert!(line.variance_at(1.0) < 1e-20);
        assert!((line.leverage(1.5) - 0.25).abs() < 1e-12);
        assert!(line.leverage(3.0) > 0.5);
        let mean = Line::fit(&points, false).unwrap();
        assert!((mean.residual((10.0, 21.0)) - 17.0).abs() < 1e-12);
        assert!((mean.variance_at(10.0) - 20.0 / 3.0 / 4.0).abs() < 1e-12);
        assert!(Line::fit(&points[..2], true).is_none());
        assert!(Line::fit(&[(1.0, 2.0); 5], true).is_none());
    }
}
