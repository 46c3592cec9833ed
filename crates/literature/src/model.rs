//! Which equation of state fits which model: like is compared with like.

use std::sync::LazyLock;

use crate::equation::EquationOfState;
use crate::kolafa_nezbeda::KolafaNezbeda;
use crate::thol::Thol;
use crate::two_center::two_center;

/// The model that a run simulates, as far as the choice of a reference goes. Lengths in σ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModelKind {
    /// Lennard-Jones, plain cutoff, with tail corrections: stands for the full potential.
    CutWithTail {
        /// The cutoff.
        r_cut: f64,
    },
    /// Lennard-Jones, plain cutoff, without tail corrections.
    CutWithoutTail {
        /// The cutoff.
        r_cut: f64,
    },
    /// Lennard-Jones, truncated and shifted to zero at the cutoff.
    Shifted {
        /// The cutoff.
        r_cut: f64,
    },
    /// Lennard-Jones with energy and force shifted to zero at the cutoff.
    ForceShifted {
        /// The cutoff.
        r_cut: f64,
    },
    /// Lennard-Jones, switched off smoothly.
    Switched {
        /// The cutoff.
        r_cut: f64,
    },
    /// Rigid dumbbells of two Lennard-Jones sites, plain cutoff, with tail corrections.
    TwoCenter {
        /// Length of the bond.
        bond_length: f64,
        /// The cutoff.
        r_cut: f64,
    },
    /// Another potential.
    Other {
        /// Its name.
        potential: &'static str,
    },
}

/// There is no equation of state for this model.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no equation of state for {model}: {reason}")]
pub struct NoReference {
    /// The model in words.
    pub model: String,
    /// Why there is none.
    pub reason: String,
}

static THOL_2016: LazyLock<Thol> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../data/thol-2016.json"))
        .expect("the shipped coefficients of Thol 2016 are well formed: a test reads them")
});
static THOL_2015: LazyLock<Thol> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../data/thol-2015.json"))
        .expect("the shipped coefficients of Thol 2015 are well formed: a test reads them")
});
static KOLAFA_NEZBEDA: LazyLock<KolafaNezbeda> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../data/kolafa-nezbeda-1994.json"))
        .expect("the shipped coefficients of Kolafa and Nezbeda are well formed: a test reads them")
});

/// Thol 2016, for the full Lennard-Jones potential.
#[must_use]
pub fn thol_2016() -> &'static dyn EquationOfState {
    &*THOL_2016
}

/// Thol 2015, for the potential truncated at 2.5 σ and shifted.
#[must_use]
pub fn thol_2015() -> &'static dyn EquationOfState {
    &*THOL_2015
}

/// Kolafa and Nezbeda 1994, for the full Lennard-Jones potential.
#[must_use]
pub fn kolafa_nezbeda_1994() -> &'static dyn EquationOfState {
    &*KOLAFA_NEZBEDA
}

/// All equations of state.
#[must_use]
pub fn list() -> [&'static dyn EquationOfState; 3] {
    [thol_2016(), kolafa_nezbeda_1994(), thol_2015()]
}

/// The cutoff in σ of the truncated-shifted model that Thol 2015 describes.
const THOL_2015_CUTOFF: f64 = 2.5;

/// The cutoff in σ from which the tail's assumption g(r) = 1 is good enough for comparison to the
/// equation's own accuracy: at 2.5 it biases p of the dense liquid by about −0.03.
pub const GOOD_TAIL_CUTOFF: f64 = 4.0;

/// The equation of state by which a run of this model may be judged.
///
/// | Model | Equation |
/// |---|---|
/// | plain cutoff with tail corrections, any r_cut | Thol 2016 |
/// | truncated and shifted at exactly 2.5 σ | Thol 2015 |
/// | rigid dumbbells, plain cutoff with tail corrections, bonds of 0.1 to 1 σ | Lísal 2004 |
/// | anything else | none |
///
/// # Errors
/// [`NoReference`] with the reason in words, where no equation describes the model.
pub fn equation_of_state_for(
    model: ModelKind,
) -> Result<&'static dyn EquationOfState, NoReference> {
    let none = |model: String, reason: &str| {
        Err(NoReference {
            model,
            reason: reason.to_owned(),
        })
    };
    match model {
        ModelKind::CutWithTail { .. } => Ok(thol_2016()),
        ModelKind::Shifted { r_cut } if r_cut == THOL_2015_CUTOFF => Ok(thol_2015()),
        ModelKind::Shifted { r_cut } => none(
            format!("Lennard-Jones truncated and shifted at {r_cut} σ"),
            "the one for the truncated-shifted potential is for a cutoff of exactly 2.5 σ",
        ),
        ModelKind::CutWithoutTail { r_cut } => none(
            format!("Lennard-Jones cut at {r_cut} σ without tail corrections"),
            "without tail corrections energy and pressure are not those of the full potential",
        ),
        ModelKind::ForceShifted { r_cut } => none(
            format!("Lennard-Jones with shifted force at {r_cut} σ"),
            "its thermodynamics differs strongly from that of the full and of the truncated-shifted potential",
        ),
        ModelKind::Switched { r_cut } => none(
            format!("Lennard-Jones switched off at {r_cut} σ"),
            "its thermodynamics depends on the switch, and none was published for it",
        ),
        ModelKind::TwoCenter { bond_length, .. } => match two_center(bond_length) {
            Some([lisal, _]) => Ok(lisal),
            None => none(
                format!("dumbbells with bonds of {bond_length} σ"),
                "the equations for two-center fluids are for bonds of 0.1 to 1 σ",
            ),
        },
        ModelKind::Other { potential } => none(
            potential.to_owned(),
            "the equations of state here are for Lennard-Jones",
        ),
    }
}

/// What must be said beside a comparison with [`equation_of_state_for`]; `None` where nothing.
#[must_use]
pub fn remark_for(model: ModelKind) -> Option<String> {
    match model {
        ModelKind::CutWithTail { r_cut } | ModelKind::TwoCenter { r_cut, .. }
            if r_cut < GOOD_TAIL_CUTOFF =>
        {
            Some(format!(
                "the tail correction takes g(r) = 1 beyond {r_cut} σ; in a dense liquid that biases P, \
             by about −0.03 at 2.5 σ: judge P at r_cut ≥ {GOOD_TAIL_CUTOFF} σ"
            ))
        }
        _ => None,
    }
}
