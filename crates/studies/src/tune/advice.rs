//! What is said about a choice: what cannot be met, what is spent below the noise, what was judged by what.

use lennard_core::number::{short, signed, significant};
use lennard_scene::{Accuracy, Judged, Scene, SceneError};

use super::Row;
use super::choose::{Candidate, Freedom, Search, place_of};
use super::sample::{Sample, VERLET_LIMIT};
use super::verify::Runs;
use crate::StudyError;
use crate::lab;
use crate::settings::Settings;
use lennard_observables::Estimate;

impl Search<'_> {
    /// The error that the accuracy cannot be met. It names the setting fixed by hand where this is the cause. It says
    /// which accuracy can be met, and at what cost.
    pub(crate) fn refusal(&mut self, nearest: &Candidate) -> Result<SceneError, StudyError> {
        let accuracy = self.accuracy;
        let reachable = self.reachable(nearest);
        let wanted = accuracy.asked().into_iter().find(|(key, ..)| *key == nearest.limiting);
        let (key, target, unit) = wanted.unwrap_or((nearest.limiting, f64::NAN, ""));
        let fixed = Freedom::of(self.scene, self.sample, self.stability, None).fixed;
        let model_is_fixed = !self.scene.wants_full_potential();
        for hand in fixed {
            // Of a model that is fixed, U and P wanted are its own, whatever its cutoff.
            if model_is_fixed && hand.starts_with("truncation") {
                continue;
            }
            let free = self.choose(&accuracy, Some(&hand), f64::INFINITY)?;
            if let Some(better) = free.cheapest {
                let message = format!("contradicts `accuracy.{key}`");
                let found = format!("{hand} fixed by hand, {key} = {target} {unit} wanted");
                let allowed = format!(
                    "{reachable}; or {hand} left out, which gives {}",
                    better.settings.label()
                );
                return Ok(self.scene.contradiction(&hand, &message, &found, &allowed));
            }
        }
        let found = format!("{target} {unit}");
        Ok(self.scene.contradiction(
            &format!("accuracy.{key}"),
            "cannot be met",
            &found,
            &reachable,
        ))
    }

    /// What settings reach, and at which price.
    fn reachable(&self, nearest: &Candidate) -> String {
        let errors: Vec<String> = self
            .accuracy
            .asked()
            .into_iter()
            .map(|(key, ..)| format!("{key} = {:.1e}", round_up(nearest.reach(key))))
            .collect();
        let mut text = format!("{} and more, with {}", errors.join(", "), nearest.settings.label());
        let usual = self.base.usual(self.sample.largest_cutoff);
        if let Some(usual) = usual {
            let ratio = nearest.price / self.prices.of(&usual);
            text += &format!(
                ", at {ratio:.1} times the cost of r_cut = 2.5 and dt = 0.004 in double precision"
            );
        }
        text
    }
}

/// The next number of two digits.
fn round_up(x: f64) -> f64 {
    if !(x.is_finite() && x > 0.0) {
        return x;
    }
    let unit = 10_f64.powf(x.log10().floor() - 1.0);
    (x / unit).ceil() * unit
}

/// Whose U and P the accuracy is about.
pub(super) fn about(full: bool, settings: &Settings) -> String {
    match full {
        true => "the full potential, without any cutoff".into(),
        false => format!("the model that the scene fixes: {}", settings.truncation_label()),
    }
}

/// Standard errors of U and P that the run of the scene will have: the errors of the verification, scaled with time and
/// number of particles.
pub(super) fn planned_errors(scene: &Scene, sample: &Sample, runs: &Runs, dt: f64) -> [f64; 2] {
    let measured = scene.measured_stages();
    let time: f64 = measured.map(|s| s.steps as f64 * s.dt.unwrap_or(dt)).sum();
    let less = (runs.time * sample.start.len() as f64 / (time * sample.scene_atoms as f64)).sqrt();
    [runs.potential_energy, runs.pressure].map(|v| less * v.standard_error)
}

/// Points out accuracy that is paid for and drowned in the noise of the planned run.
pub(super) fn spending(rows: &[Row], relaxed: Option<&Candidate>, price: f64) -> Vec<String> {
    let drowned: Vec<&Row> = rows
        .iter()
        .filter(|row| row.planned_error.is_some_and(|e| row.judged.target < e))
        .collect();
    let mut notes: Vec<String> = drowned
        .iter()
        .filter_map(|row| {
            let Judged { quantity, target, .. } = &row.judged;
            let error = row.planned_error?;
            let longer = (error / target).powi(2);
            Some(format!(
                "{quantity} is wanted to {target:.1e}, but the planned run will know it to ±{error:.1e} only: {longer:.1} times as many steps would match"
            ))
        })
        .collect();
    if let Some(relaxed) = relaxed
        && relaxed.price < 0.95 * price
        && !drowned.is_empty()
    {
        notes.push(format!(
            "asking no more than the planned run can tell would cost {:.0} % less: {}",
            100.0 * (1.0 - relaxed.price / price),
            relaxed.settings.label()
        ));
    }
    notes
}

/// Points out targets that are kept because errors of opposite sign cancel.
pub(super) fn cancelling(candidate: &Candidate, accuracy: &Accuracy) -> Option<String> {
    let cancels = |(key, target, _): (&str, f64, &str)| {
        let predicted = &candidate.predicted[place_of(key)?];
        let alone = predicted.truncation.mean.abs().max(predicted.step.mean.abs());
        (alone > target).then(|| key.replace('_', " "))
    };
    let found: Vec<String> = accuracy.asked().into_iter().filter_map(cancels).collect();
    (!found.is_empty()).then(|| {
        format!(
            "in the {} the errors of truncation and time step cancel in part: change neither alone",
            found.join(" and ")
        )
    })
}

/// An accuracy in which U and P are wanted no better than a run will know them.
pub(super) fn relaxed(accuracy: &Accuracy, planned: [f64; 2]) -> Accuracy {
    Accuracy {
        potential_energy: accuracy.potential_energy.map(|t| t.max(planned[0])),
        pressure: accuracy.pressure.map(|t| t.max(planned[1])),
        ..*accuracy
    }
}

/// How the chosen settings stand beside an equation of state, or why they do not.
pub(super) fn beside_equation(scene: &Scene, runs: &Runs) -> String {
    let value =
        |v: &Estimate| format!("{} ± {}", signed(v.mean, 2), significant(v.standard_error, 1));
    match &runs.against_equation {
        Some((source, u, p)) => {
            let said = format!("beside {source}: U {}, P {}", value(u), value(p));
            match scene.mixture.is_some() && scene.cutoff_of_one_fluid().is_none() {
                true => format!(
                    "{said}; a theory with a band of its own, so the safest run alone judges"
                ),
                false => said,
            }
        }
        None => {
            let what = match (&scene.mixture, &scene.molecule) {
                (Some(_), _) if scene.cutoff_of_one_fluid().is_none() => "this mixture",
                (_, Some(_)) => "these molecules",
                _ => "this model here",
            };
            format!("no equation of state describes {what}: judged by the safest run alone")
        }
    }
}

/// What is to be known of how it was judged.
pub(super) fn notes(scene: &Scene, sample: &Sample) -> Vec<String> {
    let mut notes = modes(scene, sample);
    if sample.start.len() != sample.scene_atoms {
        notes.push(format!(
            "errors were judged with {} particles at the density of the {} of the scene",
            sample.start.len(),
            sample.scene_atoms
        ));
    }
    let accuracy = scene.accuracy.unwrap_or_default();
    if accuracy.potential_energy.is_none()
        && accuracy.pressure.is_none()
        && scene.wants_full_potential()
    {
        notes.push(
            "no U and no P was asked for, so nothing decides the cutoff: it is the usual one"
                .into(),
        );
    }
    notes
}

/// What bounds the step of a mixture and of molecules, and how their errors are judged.
fn modes(scene: &Scene, sample: &Sample) -> Vec<String> {
    let mut notes = Vec::new();
    let digits = |x: f64| crate::report::significant(x, 3);
    if let (Some(_), Some(pair)) = (&scene.mixture, &sample.fastest) {
        let species = sample.fluid.system().species();
        let [a, b] = pair.species.map(|a| species.name(a));
        let [i, j] = pair.species;
        let size = scene.species_pair(i, j);
        let masses = pair.species.map(|a| species.species(a).mass);
        notes.push(format!(
            "the fastest pair is {a}–{b} (σ {}, ε {}, masses {} and {}): ω·dt = 2 near dt {}",
            short(size.sigma),
            short(size.epsilon),
            masses[0],
            masses[1],
            digits(pair.stable_dt)
        ));
        notes.push(
            "errors of cutoffs and tails are added pair of species by pair of species".into(),
        );
    }
    let Some(molecule) = &scene.molecule else {
        return notes;
    };
    let of_pairs = sample.fastest.map_or(f64::INFINITY, |pair| pair.stable_dt);
    notes.push(match lab::stable_dt_of_springs(scene, VERLET_LIMIT) {
        Some(springs) => format!(
            "springs of bonds have ω·dt = 2 at dt {}, and colliding sites near {}: {} bound the step",
            digits(springs),
            digits(of_pairs),
            if springs < of_pairs { "springs" } else { "sites" }
        ),
        None => format!(
            "bonds ({}) do not limit the step: colliding sites have ω·dt = 2 near dt {}",
            molecule.bonds.name(),
            digits(of_pairs)
        ),
    });
    notes.push(
        "no law is known for the error of the step with bonds: it is fitted to a short and a long step".into(),
    );
    if !sample.has_a_lattice {
        notes.push(
            "molecules without a shape fill no lattice: they are judged and timed as they are"
                .into(),
        );
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_reachable_is_never_promised_too_small() {
        assert!((round_up(0.001_23) - 0.0013).abs() < 1e-12);
        assert!((round_up(4.31e-5) - 4.4e-5).abs() < 1e-12);
        assert_eq!(round_up(0.0), 0.0);
    }
}
