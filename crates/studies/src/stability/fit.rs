//! Orders of convergence from few errors.

/// An error against the step.
pub(super) struct ErrorLine {
    pub(super) kind: &'static str,
    /// What errs.
    pub(super) name: String,
    /// The order that theory gives.
    pub(super) theory: Option<f64>,
    /// (h, error).
    pub(super) errors: Vec<(f64, f64)>,
}

/// The slope between two points in logarithms.
pub(crate) fn slope(a: (f64, f64), b: (f64, f64)) -> f64 {
    (a.1 / b.1).ln() / (a.0 / b.0).ln()
}

/// The order p of an error e(h) ∝ h^p·(1 + c·h + …), from the smallest steps whose error stands
/// above `floor`. It is the slope between the last two points. The slope before them removes the
/// first correction.
///
/// `points` are (h, e) with h falling by the same factor; `None` with fewer than three usable points.
pub(crate) fn order(points: &[(f64, f64)], floor: f64) -> Option<f64> {
    let usable: Vec<(f64, f64)> =
        points.iter().copied().take_while(|(_, e)| e.is_finite() && *e > floor).collect();
    let [.., a, b, c] = usable.as_slice() else {
        return None;
    };
    let (coarse, fine) = (slope(*a, *b), slope(*b, *c));
    // The deviation of the slope falls at least as h does: by the factor of the steps.
    let factor = b.0 / c.0;
    Some(fine + (fine - coarse) / (factor - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_is_recovered() {
        let steps = |p: i32| -> Vec<(f64, f64)> {
            (3..9).map(|i| 0.5_f64.powi(i)).map(|h| (h, h.powi(p) * (1.0 + 0.4 * h))).collect()
        };
        for p in [1, 2, 4] {
            // What is left after one extrapolation is of the order h²: 10⁻⁴ at h = 2⁻⁸.
            assert!((order(&steps(p), 0.0).unwrap() - f64::from(p)).abs() < 1e-3);
        }
        assert_eq!(order(&steps(2)[..2], 0.0), None);
        assert_eq!(order(&steps(2), 1.0), None);
    }
}
