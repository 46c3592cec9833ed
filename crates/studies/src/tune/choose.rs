//! Picks from the points of a chart that is predicted, not run: the cheapest settings whose errors keep the accuracy.

use lennard_forcefield::{ListMode, Precision, TruncationKind, TruncationOptions};
use lennard_scene::{Accuracy, Scene};

use super::predict::{Models, Prediction, Stability};
use super::prices::Prices;
use super::sample::Sample;
use super::survey::Survey;
use crate::StudyError;
use crate::settings::Settings;

/// Smallest cutoff tried, σ or σ_ab: well beyond the minimum of the potential.
const SMALLEST_CUTOFF: f64 = 2.0;
/// Distance between two cutoffs tried, σ.
const CUTOFF_STEP: f64 = 0.1;
/// Smallest time step tried, as a share of the careful one.
const SMALLEST_STEP: f64 = 0.2;
/// Standard errors by which a prediction must keep the target …
const MARGIN: f64 = 1.0;
/// … and by this share of what the cutoff leaves out, which is known to first order.
const HIGHER_ORDERS: f64 = 1.0 / 3.0;

/// What may be chosen among.
#[derive(Debug, Clone)]
pub(super) struct Freedom {
    truncations: Vec<TruncationOptions>,
    steps: Vec<f64>,
    precisions: Vec<Precision>,
    /// What the scene fixes by hand, of what is chosen for others.
    pub fixed: Vec<String>,
}

impl Freedom {
    /// What the scene leaves open; `but` names a key that is taken as open whatever the scene says.
    pub(crate) fn of(
        scene: &Scene,
        sample: &Sample,
        stability: &Stability,
        but: Option<&str>,
    ) -> Self {
        let fixed = |key: &str| scene.source.wrote(key) && but != Some(key);
        let truncations = truncations(scene, sample, &fixed);
        let measured = scene.stages.iter().rposition(|s| s.measure);
        let own_dt = measured.and_then(|i| Some((format!("stage.{i}.dt"), scene.stages[i].dt?)));
        let own_dt = own_dt.filter(|(key, _)| but != Some(key.as_str()));
        let steps = match &own_dt {
            Some((_, dt)) => vec![*dt],
            None if fixed("integrator.dt") => vec![scene.integrator.dt],
            None => plain_numbers(SMALLEST_STEP * sample.careful().dt, stability.ceiling),
        };
        let direct = scene.neighbor.mode == ListMode::Direct && fixed("neighbor.mode");
        let precisions = match fixed("kernel.precision") {
            true => vec![scene.kernel.precision],
            false if direct || scene.kernel.kernel != lennard_forcefield::Kernel::Auto => {
                vec![Precision::Double]
            }
            false => vec![Precision::Mixed, Precision::Double],
        };
        let mut hand: Vec<String> = vec![
            "truncation.kind".into(),
            "truncation.r_cut".into(),
            "truncation.tail_correction".into(),
            "integrator.dt".into(),
            "kernel.precision".into(),
        ];
        hand.retain(|key| fixed(key));
        hand.extend(own_dt.map(|(key, _)| key));
        Self { truncations, steps, precisions, fixed: hand }
    }

    fn all<'a>(&'a self, base: &'a Settings) -> impl Iterator<Item = Settings> + 'a {
        self.truncations.iter().flat_map(move |truncation| {
            self.precisions.iter().flat_map(move |precision| {
                self.steps.iter().map(move |dt| Settings {
                    dt: *dt,
                    truncation: *truncation,
                    precision: *precision,
                    ..base.clone()
                })
            })
        })
    }
}

fn truncations(
    scene: &Scene,
    sample: &Sample,
    fixed: &dyn Fn(&str) -> bool,
) -> Vec<TruncationOptions> {
    if !crate::settings::truncation_is_free(scene) {
        return vec![scene.truncation];
    }
    let accuracy = scene.accuracy.unwrap_or_default();
    let judged = accuracy.potential_energy.is_some() || accuracy.pressure.is_some();
    let kinds = if fixed("truncation.kind") {
        vec![scene.truncation.kind]
    } else if judged {
        // Nothing but the plain cutoff has a tail correction, and all cost the same.
        vec![TruncationKind::Cut]
    } else {
        vec![TruncationKind::Cut, TruncationKind::ForceShift]
    };
    let cutoffs = if fixed("truncation.r_cut") {
        vec![scene.truncation.r_cut]
    } else if judged {
        let largest = (sample.largest_cutoff * 100.0).floor() / 100.0;
        let mut tried: Vec<f64> = (0..)
            .map(|i| ((SMALLEST_CUTOFF + CUTOFF_STEP * f64::from(i)) * 100.0).round() / 100.0)
            .take_while(|r| *r < largest)
            .collect();
        tried.push(largest);
        tried
    } else {
        // Nothing was asked that the cutoff decides.
        vec![TruncationOptions::default().r_cut.min(sample.largest_cutoff)]
    };
    let mut all = Vec::new();
    for kind in kinds {
        for r_cut in &cutoffs {
            let tail = match fixed("truncation.tail_correction") {
                true => scene.truncation.tail_correction,
                false => kind == TruncationKind::Cut,
            };
            all.push(TruncationOptions {
                kind,
                r_cut: *r_cut,
                tail_correction: tail,
                ..scene.truncation
            });
        }
    }
    all
}

/// Numbers of two digits, evenly spaced within each power of ten.
fn plain_numbers(from: f64, to: f64) -> Vec<f64> {
    let mut found = Vec::new();
    for exponent in -6..1 {
        for digits in 10..100 {
            // Written and read, so that 0.0052 is the number that it looks like.
            let text = format!("{digits}e{}", exponent - 1);
            let number: f64 = text.parse().unwrap_or(f64::NAN);
            if number >= from && number <= to {
                found.push(number);
            }
        }
    }
    found
}

/// A point of the predicted chart: settings with what they are expected to err and to cost.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub settings: Settings,
    pub predicted: [Prediction; 2],
    pub drift: f64,
    /// Wall time, s for each particle and τ.
    pub price: f64,
    /// The largest error with its uncertainty over its target; at most 1 where all is met.
    pub worst: f64,
    /// The key of `[accuracy]` which that is.
    pub limiting: &'static str,
}

impl Candidate {
    /// The predicted error of a quantity with its uncertainty.
    pub(crate) fn reach(&self, key: &str) -> f64 {
        let Some(i) = place_of(key) else {
            return self.drift.abs();
        };
        let Prediction { truncation, total, .. } = &self.predicted[i];
        total.mean.abs() + HIGHER_ORDERS * truncation.mean.abs() + MARGIN * total.standard_error
    }
}

/// Where U or P stands in pairs of both; the drift has no place there.
pub(super) fn place_of(key: &str) -> Option<usize> {
    ["potential_energy", "pressure"].into_iter().position(|known| known == key)
}

/// The outcome of a search.
pub(super) struct Choice {
    /// The cheapest that meets everything.
    pub cheapest: Option<Candidate>,
    /// What comes nearest to the targets.
    pub nearest: Candidate,
}

/// What a search is made with.
pub(super) struct Search<'a> {
    pub scene: &'a Scene,
    pub sample: &'a Sample,
    pub survey: &'a Survey,
    pub stability: &'a Stability,
    pub prices: &'a Prices,
    pub base: &'a Settings,
    /// The accuracy that the scene asks for.
    pub accuracy: Accuracy,
    pub models: Models<'a>,
}

impl Search<'_> {
    /// Looks through everything that the scene leaves open; `but` names a key that is taken as open too. `largest_step` bounds
    /// dt beside the ceiling.
    pub(super) fn choose(
        &mut self,
        accuracy: &Accuracy,
        but: Option<&str>,
        largest_step: f64,
    ) -> Result<Choice, StudyError> {
        let freedom = Freedom::of(self.scene, self.sample, self.stability, but);
        let mut cheapest: Option<Candidate> = None;
        let mut nearest: Option<Candidate> = None;
        let shortest = freedom.steps.first().copied().unwrap_or(f64::NAN);
        for settings in freedom.all(self.base) {
            if settings.dt > largest_step && settings.dt > shortest {
                continue;
            }
            let candidate = self.judge(settings, accuracy)?;
            // Of equal prices, the smaller errors.
            let better =
                |than: &Candidate| (candidate.price, candidate.worst) < (than.price, than.worst);
            if candidate.worst <= 1.0 && cheapest.as_ref().is_none_or(better) {
                cheapest = Some(candidate.clone());
            }
            if nearest.as_ref().is_none_or(|c| candidate.worst < c.worst) {
                nearest = Some(candidate);
            }
        }
        let nearest = nearest
            .ok_or_else(|| StudyError::Nothing("no settings are left to choose among".into()))?;
        Ok(Choice { cheapest, nearest })
    }

    /// What settings are expected to err and to cost.
    fn judge(&mut self, settings: Settings, accuracy: &Accuracy) -> Result<Candidate, StudyError> {
        let predicted = self.models.of(&settings)?;
        let drift = self.models.drift(&settings)?;
        let price = self.prices.of(&settings);
        let mut candidate =
            Candidate { settings, predicted, drift, price, worst: 0.0, limiting: "drift" };
        for (key, target, _) in accuracy.asked() {
            let worse = candidate.reach(key) / target;
            // An unknown error is not a small error.
            let worse = if worse.is_nan() { f64::INFINITY } else { worse };
            if worse > candidate.worst {
                (candidate.worst, candidate.limiting) = (worse, key);
            }
        }
        Ok(candidate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_numbers_are_what_a_person_would_write() {
        let found = plain_numbers(0.00098, 0.0103);
        assert_eq!(found.first(), Some(&0.00098));
        assert_eq!(found.last(), Some(&0.010));
        assert!(found.contains(&0.0052) && found.is_sorted());
        assert!(plain_numbers(0.5, 0.1).is_empty());
    }
}
