//! From options to the one truncated potential that the loops sum.

use super::{Form, Pair, PotentialOptions, TruncationOptions};
use crate::error::ForceFieldError;
use crate::options::ForceFieldOptions;

/// A truncated potential with its cutoff.
#[derive(Clone, Copy, Debug)]
pub struct Model {
    /// The formula.
    pub form: Form,
    /// The cutoff in force, σ: the cutoff of the options, or the end of a potential that ends by
    /// itself.
    pub r_cut: f64,
    /// U(r_cut) of the formula, ε: what the conserved energy subtracts for every pair.
    pub energy_at_cutoff: f64,
}

impl Model {
    /// The model that options describe.
    ///
    /// # Errors
    /// [`ForceFieldError`] where potential and truncation do not go together or are out of range.
    pub fn new(
        potential: &PotentialOptions,
        truncation: &TruncationOptions,
    ) -> Result<Self, ForceFieldError> {
        let r_cut = check(potential, truncation)?;
        let mut model =
            Self { form: Form::new(potential, truncation), r_cut, energy_at_cutoff: 0.0 };
        if truncation.kind.spec().jumps && potential.own_end().is_none() {
            model.energy_at_cutoff = model.eval(r_cut * r_cut).energy;
        }
        Ok(model)
    }

    /// U, −U′/r and U″ at r² = `r2` σ² ≤ r_cut².
    #[must_use]
    pub fn eval(&self, r2: f64) -> Pair<f64> {
        self.form.eval(r2)
    }
}

/// Checks that potential and truncation are in range and go together; returns the cutoff in force.
fn check(
    potential: &PotentialOptions,
    truncation: &TruncationOptions,
) -> Result<f64, ForceFieldError> {
    let (r_cut, kind) = (truncation.r_cut, truncation.kind);
    if !(r_cut.is_finite() && r_cut > 0.0) {
        return Err(ForceFieldError::BadCutoff(r_cut));
    }
    if truncation.tail_correction && !kind.spec().jumps {
        return Err(ForceFieldError::TailWithoutCut(kind.name()));
    }
    kind.check(truncation)?;
    potential.check().map_err(ForceFieldError::BadPotential)?;
    let fits = potential.check_with(r_cut, truncation.tail_correction);
    fits.map_err(ForceFieldError::BadPotential)?;
    let Some(end) = potential.own_end() else {
        return Ok(r_cut);
    };
    let title = potential.spec().title;
    if truncation.switch_from.is_some() || kind.spec().weights {
        return Err(ForceFieldError::SwitchAtOwnEnd { title, kind: kind.name() });
    }
    if r_cut < end.r {
        return Err(ForceFieldError::CutoffInsideEnd { title, r_cut, end });
    }
    Ok(end.r)
}

/// The name of the model in output: `Lennard-Jones, cut at 2.5 σ, with tail correction`.
#[must_use]
pub fn model_name(o: &ForceFieldOptions) -> String {
    let potential = o.potential.in_words();
    if o.potential.own_end().is_some() {
        return potential;
    }
    format!("{potential}, {}", o.truncation.kind.in_words(&o.truncation))
}
