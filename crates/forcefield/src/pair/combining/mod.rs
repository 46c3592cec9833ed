//! The list of combining rules, which say σ and ε of two unlike species: one file and one line each.

mod explicit;
mod fender_halsey;
mod geometric;
mod lorentz_berthelot;
mod waldman_hagler;

use lennard_core::options::OptionError;
use serde::Serialize;

/// What a combining rule declares about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct CombiningSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// Name in sentences.
    pub title: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The formula, in plain text.
    pub equation: &'static str,
    /// Author, title, equation.
    pub source: &'static str,
}

/// Length and depth of a pair potential.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// σ, in σ of the scene.
    pub sigma: f64,
    /// ε, in ε of the scene.
    pub epsilon: f64,
}

/// The deviations of one pair from a combining rule: ε is multiplied by 1 − k, and σ by 1 − l.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Deviation {
    /// k; `None` leaves the rule's own.
    pub k: Option<f64>,
    /// l; `None` leaves the rule's own.
    pub l: Option<f64>,
}

/// The file of a combining rule provides this for its options type.
pub trait CombiningRule {
    /// Whether a pair may deviate from the rule by its own k and l.
    fn deviates(&self) -> bool {
        false
    }

    /// σ and ε of a pair of unlike species, with its deviation from a rule that allows one; `None` where the scene must write them.
    fn combine(&self, one: Size, other: Size, deviation: Deviation) -> Option<Size>;

    /// Whether the options go together; each alone lies in its range.
    ///
    /// # Errors
    /// [`OptionError`] with the key that does not fit the others.
    fn check_together(&self) -> Result<(), OptionError> {
        Ok(())
    }
}

lennard_core::list_of_methods! {
    /// The rule for σ and ε of unlike species: the scene's table `[mixing]`.
    #[serde(tag = "rule", rename_all = "kebab-case")]
    #[non_exhaustive]
    pub enum CombiningOptions: CombiningRule, declared by SPEC: CombiningSpec {
        /// Mean length and geometric mean of depths, with deviations k and l.
        LorentzBerthelot: lorentz_berthelot::LorentzBerthelot,
        /// Geometric means of both.
        Geometric: geometric::Geometric,
        /// Means of sixth powers.
        WaldmanHagler: waldman_hagler::WaldmanHagler,
        /// Mean length and harmonic mean of depths.
        FenderHalsey: fender_halsey::FenderHalsey,
        /// No rule: the scene writes each pair.
        Explicit: explicit::Explicit,
    }
}

/// Every combining rule that a scene may name.
#[must_use]
pub fn combining_rules() -> &'static [CombiningSpec] {
    CombiningOptions::SPECS
}
