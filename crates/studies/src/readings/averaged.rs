//! Points of a study that differ in their seeds alone, taken together.

use lennard_observables::Estimate;

use crate::compare::Row;
use crate::lab::mean_of;
use crate::lists::grouped;
use crate::report::Point;
use crate::sweep::{Setting, SettingValue, SweptPoint};

/// From so many seeds on, their scatter is an error of its own.
const FEWEST_SEEDS: usize = 4;

/// Points with the same settings, whatever their seeds.
pub(super) struct Averaged<'a> {
    /// What was chosen for these points, without the seed.
    pub settings: &'a [Setting],
    /// The points.
    pub points: Vec<&'a SweptPoint>,
}

/// The points of a sweep, seeds together, in the order of the sweep.
pub(super) fn averaged(points: &[SweptPoint]) -> Vec<Averaged<'_>> {
    let all = grouped(points.iter().map(|point| (point.settings.as_slice(), point)));
    all.into_iter().map(|(settings, points)| Averaged { settings, points }).collect()
}

impl Averaged<'_> {
    /// The number that was chosen for a key.
    pub fn setting(&self, key: &str) -> Option<f64> {
        match self.value(key)? {
            SettingValue::Number(number) => Some(*number),
            SettingValue::Words(_) => None,
        }
    }

    /// What was chosen for a key.
    pub fn value(&self, key: &str) -> Option<&SettingValue> {
        self.settings.iter().find(|s| s.key == key).map(|s| &s.value)
    }

    /// The mean of a quantity over the seeds; `None` where no run has measured it.
    ///
    /// Its error is √Σs²/n of the printed errors, or the scatter of the seeds where it is larger and there are four seeds or more.
    /// Runs without an error are left out where others have one; where no run has one, the mean is no result.
    pub fn mean(&self, quantity: &str) -> Option<Estimate> {
        let rows = self.points.iter().filter_map(|p| p.row(quantity));
        let estimate = |r: &Row| Estimate::new(r.measured, r.standard_error, f64::NAN);
        let mut all: Vec<Estimate> = rows.map(estimate).collect();
        if all.iter().any(|one| one.standard_error.is_finite()) {
            all.retain(|one| one.standard_error.is_finite());
        }
        (!all.is_empty()).then(|| of_seeds(&all))
    }

    /// A mark at a mean over the seeds, with its error, its name and its page; `None` where no run has measured it.
    pub fn mark(&self, x: f64, quantity: &str) -> Option<Point> {
        let mean = self.mean(quantity)?;
        Some(Point {
            error: Some(mean.standard_error),
            note: Some(self.name()),
            link: self.page(),
            ..Point::from((x, mean.mean))
        })
    }

    /// The same mark with the mean along the abscissa, and its error too where it has one.
    pub fn mark_across(&self, quantity: &str, y: f64) -> Option<Point> {
        let mark = self.mark(f64::NAN, quantity)?;
        let error = mark.error.filter(|error| error.is_finite());
        Some(Point {
            x: mark.y,
            y,
            x_range: error.map(|error| (mark.y - error, mark.y + error)),
            error: mark.error.filter(|_| error.is_none()),
            ..mark
        })
    }

    /// The mean measured temperature, ε/k_B; `None` where no run has ended.
    pub fn temperature(&self) -> Option<f64> {
        let measured: Vec<f64> = self
            .points
            .iter()
            .filter_map(|p| Some(p.compared.as_ref()?.state.temperature))
            .collect();
        (!measured.is_empty()).then(|| measured.iter().sum::<f64>() / measured.len() as f64)
    }

    /// The name of the first of the points, and how many there are.
    pub fn name(&self) -> String {
        let first = &self.points[0].name;
        match self.points.len() {
            1 => first.clone(),
            n => format!("{first} and {} more seeds", n - 1),
        }
    }

    /// The page of the first of the points.
    pub fn page(&self) -> Option<String> {
        self.points.iter().find_map(|p| p.page.clone())
    }
}

/// The mean of values of several seeds.
fn of_seeds(values: &[Estimate]) -> Estimate {
    let mean = mean_of(values);
    let n = values.len() as f64;
    let squares: f64 = values.iter().map(|one| (one.mean - mean.mean).powi(2)).sum();
    let scatter = (squares / (n * (n - 1.0))).sqrt();
    let is_scatter = values.len() >= FEWEST_SEEDS && scatter > mean.standard_error;
    Estimate { standard_error: if is_scatter { scatter } else { mean.standard_error }, ..mean }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A point of these settings that has not been run.
    pub fn point(name: &str, settings: Vec<Setting>) -> SweptPoint {
        SweptPoint {
            name: name.to_owned(),
            settings,
            page: None,
            planned: crate::compare::StateOfMatter::new(0.5, 1.0, None),
            kept: false,
            failure: None,
            elsewhere: None,
            compared: None,
            record: None,
            wall_s: 0.0,
            ns_per_atom_step: 0.0,
        }
    }

    #[test]
    fn the_error_of_seeds_is_the_printed_one_or_their_scatter_where_it_is_larger() {
        let of = |pairs: &[[f64; 2]]| {
            let estimates = pairs.iter().map(|[mean, error]| Estimate::new(*mean, *error, 10.0));
            of_seeds(&estimates.collect::<Vec<_>>())
        };
        let two = of(&[[1.0, 0.3], [2.0, 0.4]]);
        assert_eq!(two.mean, 1.5);
        assert!((two.standard_error - 0.25).abs() < 1e-15);
        // Four seeds scatter by far more than they print.
        let four = of(&[[0.0, 0.1], [2.0, 0.1], [0.0, 0.1], [2.0, 0.1]]);
        assert!((four.standard_error - (4.0_f64 / 12.0).sqrt()).abs() < 1e-15);
        let quiet = of(&[[1.0, 0.1]; 4]);
        assert!((quiet.standard_error - 0.05).abs() < 1e-15);
        // Without a printed error the scatter makes no result.
        assert!(
            of(&[[0.0, f64::NAN], [1.0, f64::NAN], [0.0, f64::NAN], [1.0, f64::NAN]])
                .standard_error
                .is_nan()
        );
    }

    #[test]
    fn points_that_differ_in_their_seeds_stand_together() {
        let point =
            |name: &str, density: f64| point(name, vec![Setting::number("density", density)]);
        let points =
            [point("rho0.1-seed1", 0.1), point("rho0.2-seed1", 0.2), point("rho0.1-seed2", 0.1)];
        let together = averaged(&points);
        assert_eq!(together.len(), 2);
        assert_eq!(together[0].name(), "rho0.1-seed1 and 1 more seeds");
        assert_eq!(together[1].setting("density"), Some(0.2));
        assert_eq!(together[0].mean("pressure"), None);
        assert_eq!(together[0].temperature(), None);
    }
}
