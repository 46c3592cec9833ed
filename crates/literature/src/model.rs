//! Which equation of state fits which model: like is compared with like.

use std::sync::LazyLock;

use crate::equation::EquationOfState;
use crate::johnson::Johnson;
use crate::kolafa_nezbeda::KolafaNezbeda;
use crate::one_fluid::{LARGEST_SIZE_RATIO, OneFluid, one_fluid};
use crate::pohl::pohl_2023;
use crate::thol::Thol;
use crate::two_center::two_center;
use crate::virial::{Mie, virial_series};

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
    /// A Mie potential other than Lennard-Jones, plain cutoff, with tail corrections.
    Mie {
        /// The exponent of the repulsion.
        repulsive: f64,
        /// The exponent of the attraction.
        attractive: f64,
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
    /// A Lennard-Jones mixture of species of nearly one size, plain cutoff, with tail corrections.
    Mixture {
        /// The one fluid that stands for it.
        fluid: OneFluid,
        /// The largest σ of two species over the smallest.
        size_ratio: f64,
        /// The shortest cutoff of two species, in units of their σ.
        r_cut: f64,
    },
    /// The mixture of Kob and Andersen, cut and shifted at 2.5 σ_ab, at any composition.
    KobAndersen,
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

static JOHNSON: LazyLock<Johnson> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../data/johnson-1993.json"))
        .expect("the shipped coefficients of Johnson 1993 are well formed: a test reads them")
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

/// Johnson, Zollweg and Gubbins 1993, for the full Lennard-Jones potential: shown, and nothing is judged by it.
#[must_use]
pub fn johnson_1993() -> &'static dyn EquationOfState {
    &*JOHNSON
}

/// Pohl 2023 for the full Lennard-Jones potential.
fn pohl_lennard_jones() -> &'static dyn EquationOfState {
    pohl_2023(Mie::LENNARD_JONES.repulsive).expect("12 lies within 11 and 13")
}

/// Whether the exponents of a Mie potential are 12 and 6.
pub(crate) fn is_lennard_jones(repulsive: f64, attractive: f64) -> bool {
    let lj = Mie::LENNARD_JONES;
    repulsive == lj.repulsive && attractive == lj.attractive
}

/// All equations of state of atoms.
#[must_use]
pub fn list() -> [&'static dyn EquationOfState; 6] {
    [
        thol_2016(),
        kolafa_nezbeda_1994(),
        pohl_lennard_jones(),
        johnson_1993(),
        thol_2015(),
        virial_series(Mie::LENNARD_JONES),
    ]
}

/// Every equation that describes a model, the one that judges runs of it first; none where there is none.
#[must_use]
pub fn equations_for(model: ModelKind) -> Vec<&'static dyn EquationOfState> {
    match model {
        ModelKind::CutWithTail { .. } => vec![
            thol_2016(),
            kolafa_nezbeda_1994(),
            pohl_lennard_jones(),
            virial_series(Mie::LENNARD_JONES),
            johnson_1993(),
        ],
        ModelKind::Mie { repulsive, attractive, .. } => {
            let first = equation_of_state_for(model).ok();
            let potential = Mie { repulsive, attractive };
            first.into_iter().chain([virial_series(potential) as &dyn EquationOfState]).collect()
        }
        ModelKind::TwoCenter { bond_length, .. } => two_center(bond_length)
            .into_iter()
            .flatten()
            .map(|e| e as &dyn EquationOfState)
            .collect(),
        other => equation_of_state_for(other).into_iter().collect(),
    }
}

/// The cutoff in σ of the truncated-shifted model that Thol 2015 describes.
pub(crate) const THOL_2015_CUTOFF: f64 = 2.5;

/// The cutoff in σ from which the tail's assumption g(r) = 1 errs less than the equation itself. At
/// 2.5 it biases p of the dense liquid by about −0.03.
pub const GOOD_TAIL_CUTOFF: f64 = 4.0;

/// The equation of state by which a run of this model may be judged.
///
/// | Model | Equation |
/// |---|---|
/// | plain cutoff with tail corrections, any r_cut | Thol 2016 |
/// | truncated and shifted at exactly 2.5 σ | Thol 2015 |
/// | Mie (n, 6) with 11 ≤ n ≤ 13, plain cutoff with tail corrections | Pohl 2023 |
/// | rigid dumbbells, plain cutoff with tail corrections, bonds of 0.1 to 1 σ | Lísal 2004 |
/// | mixtures, plain cutoff with tail corrections, sizes within 10 % | the one-fluid theory |
/// | anything else | none |
///
/// # Errors
/// [`NoReference`] with the reason in words, where no equation describes the model.
pub fn equation_of_state_for(
    model: ModelKind,
) -> Result<&'static dyn EquationOfState, NoReference> {
    let none = |model: String, reason: &str| Err(NoReference { model, reason: reason.to_owned() });
    match model {
        ModelKind::CutWithTail { .. } => Ok(thol_2016()),
        ModelKind::Shifted { r_cut } if r_cut == THOL_2015_CUTOFF => Ok(thol_2015()),
        ModelKind::Shifted { r_cut } => none(
            format!("Lennard-Jones truncated and shifted at {r_cut} σ"),
            "the one for the truncated-shifted potential is for a cutoff of exactly 2.5 σ",
        ),
        ModelKind::CutWithoutTail { r_cut } => none(
            format!("Lennard-Jones cut at {r_cut} σ without tail corrections"),
            "without tail corrections, energy and pressure differ from the full potential",
        ),
        ModelKind::ForceShifted { r_cut } => none(
            format!("Lennard-Jones with shifted force at {r_cut} σ"),
            "its thermodynamics differs strongly from the full and from the truncated-shifted potential",
        ),
        ModelKind::Switched { r_cut } => none(
            format!("Lennard-Jones switched off at {r_cut} σ"),
            "its thermodynamics depends on the switch, and none was published for it",
        ),
        ModelKind::Mie { repulsive, attractive, .. } => {
            match pohl_2023(repulsive).filter(|_| attractive == Mie::LENNARD_JONES.attractive) {
                Some(pohl) => Ok(pohl),
                None => none(
                    format!("the Mie potential with exponents {repulsive} and {attractive}"),
                    "the one for Mie potentials is for repulsive exponents from 11 to 13 and the attractive exponent 6",
                ),
            }
        }
        ModelKind::TwoCenter { bond_length, .. } => match two_center(bond_length) {
            Some([lisal, _]) => Ok(lisal),
            None => none(
                format!("dumbbells with bonds of {bond_length} σ"),
                "the equations for two-center fluids are for bonds of 0.1 to 1 σ",
            ),
        },
        ModelKind::Mixture { fluid, size_ratio, .. } if size_ratio <= LARGEST_SIZE_RATIO => {
            Ok(one_fluid(fluid))
        }
        ModelKind::Mixture { size_ratio, .. } => none(
            format!("a mixture with a ratio of sizes of {size_ratio:.3}"),
            "the band of the one-fluid theory is stated for ratios up to 1.1",
        ),
        ModelKind::KobAndersen => none(
            "the mixture of Kob and Andersen".to_owned(),
            "single states of it stand in the table `kob-andersen`",
        ),
        ModelKind::Other { potential } => {
            none(potential.to_owned(), "the equations of state here are for Lennard-Jones")
        }
    }
}

/// What must be said beside a comparison with [`equation_of_state_for`]; `None` where nothing.
#[must_use]
pub fn remark_for(model: ModelKind) -> Option<String> {
    match model {
        ModelKind::CutWithTail { r_cut }
        | ModelKind::Mie { r_cut, .. }
        | ModelKind::TwoCenter { r_cut, .. }
        | ModelKind::Mixture { r_cut, .. }
            if r_cut < GOOD_TAIL_CUTOFF =>
        {
            Some(format!(
                "the tail correction takes g(r) = 1 beyond {r_cut:.3} σ; in a dense liquid that biases P, \
             by about −0.03 at 2.5 σ: judge P at r_cut ≥ {GOOD_TAIL_CUTOFF} σ"
            ))
        }
        _ => None,
    }
}
