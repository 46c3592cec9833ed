//! From options to the one truncated potential that the kernels run.

use crate::error::ForceFieldError;
use crate::options::{
    ForceFieldOptions, PotentialOptions, SplitOptions, TruncationKind, TruncationOptions,
};
use crate::potential::{
    LARGEST_EXPONENT, LENNARD_JONES_MINIMUM, LennardJones, Pair, PairPotential, SMALLEST_EXPONENT,
    SoftSphere, Wca,
};
use crate::real::Real;
use crate::truncation::{ForceShift, PairForm, Part, Plain, Smoothstep, Switch};

/// Where the switch begins if the scene does not say: this share of r_cut.
pub const DEFAULT_SWITCH_SHARE: f64 = 0.8;

/// Every combination of potential and truncation that can run.
#[derive(Clone, Copy, Debug)]
pub enum Form {
    /// Lennard-Jones, cut or shifted.
    LennardJonesPlain(Plain<LennardJones>),
    /// Lennard-Jones, force-shifted.
    LennardJonesForceShift(ForceShift<LennardJones>),
    /// Lennard-Jones, switched.
    LennardJonesSwitch(Switch<LennardJones>),
    /// WCA.
    Wca(Plain<Wca>),
    /// Soft sphere, cut or shifted.
    SoftSpherePlain(Plain<SoftSphere>),
    /// Soft sphere, force-shifted.
    SoftSphereForceShift(ForceShift<SoftSphere>),
    /// Soft sphere, switched.
    SoftSphereSwitch(Switch<SoftSphere>),
}

/// Runs `$body` with `$form` bound to the concrete truncated potential of a [`Form`]: the one place
/// where combinations are listed for the kernels.
macro_rules! with_form {
    ($value:expr, $form:ident => $body:expr) => {
        match $value {
            $crate::form::Form::LennardJonesPlain($form) => $body,
            $crate::form::Form::LennardJonesForceShift($form) => $body,
            $crate::form::Form::LennardJonesSwitch($form) => $body,
            $crate::form::Form::Wca($form) => $body,
            $crate::form::Form::SoftSpherePlain($form) => $body,
            $crate::form::Form::SoftSphereForceShift($form) => $body,
            $crate::form::Form::SoftSphereSwitch($form) => $body,
        }
    };
}
pub(crate) use with_form;

/// A truncated potential with its cutoff.
#[derive(Clone, Copy, Debug)]
pub struct Model {
    /// The formula.
    pub form: Form,
    /// The cutoff in force, σ: that of the options, or 2^{1/6} for WCA.
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
        let form = match potential {
            PotentialOptions::LennardJones {} => match truncated(LennardJones, truncation) {
                Truncated::Plain(f) => Form::LennardJonesPlain(f),
                Truncated::ForceShift(f) => Form::LennardJonesForceShift(f),
                Truncated::Switch(f) => Form::LennardJonesSwitch(f),
            },
            PotentialOptions::Wca {} => Form::Wca(Plain {
                potential: Wca,
                shift: 0.0,
            }),
            PotentialOptions::SoftSphere { exponent } => {
                let exponent = *exponent;
                match truncated(SoftSphere { exponent }, truncation) {
                    Truncated::Plain(f) => Form::SoftSpherePlain(f),
                    Truncated::ForceShift(f) => Form::SoftSphereForceShift(f),
                    Truncated::Switch(f) => Form::SoftSphereSwitch(f),
                }
            }
        };
        let jump = matches!(
            (potential, truncation.kind),
            (
                PotentialOptions::LennardJones {} | PotentialOptions::SoftSphere { .. },
                TruncationKind::Cut
            )
        );
        let mut model = Self {
            form,
            r_cut,
            energy_at_cutoff: 0.0,
        };
        if jump {
            model.energy_at_cutoff = model.eval(r_cut * r_cut).energy;
        }
        Ok(model)
    }

    /// U, −U′/r and U″ at r² = `r2` σ² ≤ r_cut².
    pub fn eval<R: Real>(&self, r2: R) -> Pair<R> {
        with_form!(&self.form, form => form.eval_in_epsilon(r2))
    }
}

/// The weights of a split, as forms want them.
#[derive(Clone, Copy, Debug)]
pub struct SplitWeights {
    /// w(r²).
    pub step: Smoothstep,
    /// See [`Part`].
    pub offset: f64,
    /// See [`Part`].
    pub sign: f64,
}

impl SplitWeights {
    /// The weights of the near part, or of the far one.
    pub fn new(split: &SplitOptions, near: bool) -> Self {
        Self {
            step: Smoothstep::new(split.r_split - split.width, split.r_split),
            offset: if near { 0.0 } else { 1.0 },
            sign: if near { 1.0 } else { -1.0 },
        }
    }

    /// A form times these weights.
    pub fn of<F: PairForm>(&self, form: F) -> Part<F> {
        Part {
            form,
            step: self.step,
            offset: self.offset,
            sign: self.sign,
        }
    }
}

enum Truncated<P> {
    Plain(Plain<P>),
    ForceShift(ForceShift<P>),
    Switch(Switch<P>),
}

fn truncated<P: PairPotential>(potential: P, truncation: &TruncationOptions) -> Truncated<P> {
    let r_cut = truncation.r_cut;
    match truncation.kind {
        TruncationKind::Cut => Truncated::Plain(Plain {
            potential,
            shift: 0.0,
        }),
        TruncationKind::Shift => Truncated::Plain(Plain {
            potential,
            shift: potential.eval((r_cut * r_cut).recip()).energy,
        }),
        TruncationKind::ForceShift => Truncated::ForceShift(ForceShift::new(potential, r_cut)),
        TruncationKind::Switch => Truncated::Switch(Switch {
            potential,
            step: Smoothstep::new(switch_from(truncation), r_cut),
        }),
    }
}

/// Where the switch of these options begins, σ.
pub fn switch_from(truncation: &TruncationOptions) -> f64 {
    truncation
        .switch_from
        .unwrap_or(DEFAULT_SWITCH_SHARE * truncation.r_cut)
}

fn kind_name(kind: TruncationKind) -> &'static str {
    match kind {
        TruncationKind::Cut => "cut",
        TruncationKind::Shift => "shift",
        TruncationKind::ForceShift => "force-shift",
        TruncationKind::Switch => "switch",
    }
}

/// Checks that potential and truncation are in range and go together; gives the cutoff in force.
fn check(
    potential: &PotentialOptions,
    truncation: &TruncationOptions,
) -> Result<f64, ForceFieldError> {
    let r_cut = truncation.r_cut;
    if !(r_cut.is_finite() && r_cut > 0.0) {
        return Err(ForceFieldError::BadCutoff(r_cut));
    }
    if truncation.tail_correction && truncation.kind != TruncationKind::Cut {
        return Err(ForceFieldError::TailWithoutCut(kind_name(truncation.kind)));
    }
    match (truncation.kind, truncation.switch_from) {
        (TruncationKind::Switch, Some(from)) if !(from > 0.0 && from < r_cut) => {
            return Err(ForceFieldError::BadSwitch { found: from, r_cut });
        }
        (TruncationKind::Switch, _) | (_, None) => {}
        (_, Some(from)) => return Err(ForceFieldError::SwitchWithoutSwitch(from)),
    }
    match potential {
        PotentialOptions::Wca {} if truncation.kind == TruncationKind::Switch => {
            Err(ForceFieldError::SwitchedWca)
        }
        PotentialOptions::Wca {} if r_cut < LENNARD_JONES_MINIMUM => {
            Err(ForceFieldError::CutoffInsideWca(r_cut))
        }
        PotentialOptions::Wca {} => Ok(LENNARD_JONES_MINIMUM),
        PotentialOptions::SoftSphere { exponent }
            if !(SMALLEST_EXPONENT..=LARGEST_EXPONENT).contains(exponent) =>
        {
            Err(ForceFieldError::BadExponent(*exponent))
        }
        PotentialOptions::LennardJones {} | PotentialOptions::SoftSphere { .. } => Ok(r_cut),
    }
}

/// What the model is called in output: `Lennard-Jones, cut at 2.5 σ, with tail correction`.
#[must_use]
pub fn model_name(o: &ForceFieldOptions) -> String {
    let t = &o.truncation;
    let potential = match o.potential {
        PotentialOptions::LennardJones {} => "Lennard-Jones".to_owned(),
        PotentialOptions::Wca {} => {
            return "Weeks–Chandler–Andersen, ending at 2^(1/6) σ".to_owned();
        }
        PotentialOptions::SoftSphere { exponent } => format!("soft sphere r^-{exponent}"),
    };
    let r_cut = t.r_cut;
    let truncation = match t.kind {
        TruncationKind::Cut if t.tail_correction => {
            format!("cut at {r_cut} σ, with tail correction")
        }
        TruncationKind::Cut => format!("cut at {r_cut} σ, without tail correction"),
        TruncationKind::Shift => format!("cut and shifted at {r_cut} σ"),
        TruncationKind::ForceShift => format!("force-shifted at {r_cut} σ"),
        TruncationKind::Switch => format!("switched off from {} to {r_cut} σ", switch_from(t)),
    };
    format!("{potential}, {truncation}")
}
