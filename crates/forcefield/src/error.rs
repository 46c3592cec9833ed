//! Why a force field cannot be built, with the scene key that each reason is about.

use lennard_core::MOST_SPECIES;
use lennard_core::options::{OptionError, upper_bound};

use crate::pair::OwnEnd;

/// The largest number of particles: rows, ghosts included, are numbered in 32 bits.
pub const LARGEST_N: usize = 500_000_000;

/// Why a force field cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ForceFieldError {
    /// A cutoff that is not a finite positive number.
    #[error("the cutoff must be a finite positive number, found {0}")]
    BadCutoff(f64),
    /// A cutoff beyond half the shortest side of the box.
    #[error("the cutoff {r_cut} is over half the shortest side of the box, {}", upper_bound(*largest))]
    CutoffOverHalfBox {
        /// The cutoff found, σ.
        r_cut: f64,
        /// The largest legal one, σ.
        largest: f64,
    },
    /// A cutoff inside the end of a potential that ends by itself.
    #[error("the {title} potential ends at {} σ: a cutoff of {r_cut} would cut into it", end.in_words)]
    CutoffInsideEnd {
        /// The potential's name in sentences.
        title: &'static str,
        /// The cutoff found, σ.
        r_cut: f64,
        /// Where the potential ends.
        end: OwnEnd,
    },
    /// A switch for a potential that ends by itself.
    #[error("the {title} potential ends smoothly by itself and takes no switch")]
    SwitchAtOwnEnd {
        /// The potential's name in sentences.
        title: &'static str,
        /// The truncation found.
        kind: &'static str,
    },
    /// A switch that does not begin between 0 and the cutoff.
    #[error("the switch must begin between 0 and r_cut = {r_cut}, found {found}")]
    BadSwitch {
        /// The start of the switch found, σ.
        found: f64,
        /// The cutoff, σ.
        r_cut: f64,
    },
    /// A start of a switch without a switch.
    #[error("`switch_from` belongs to the truncations `switch` and `xplor` alone")]
    SwitchWithoutSwitch(f64),
    /// A tail correction with anything but the plain cutoff.
    #[error("a tail correction belongs to the plain cutoff alone, not to `{0}`")]
    TailWithoutCut(&'static str),
    /// An option of the potential that is out of range or does not go with the others.
    #[error("the potential's {0}")]
    BadPotential(OptionError),
    /// A skin that is negative or not a finite number.
    #[error("the skin must be a finite number, zero or more, found {0}")]
    BadSkin(f64),
    /// A skin fixed by hand that does not fit the box.
    #[error("a skin of {skin} makes the list radius larger than half the box")]
    SkinTooLarge {
        /// The skin found, σ.
        skin: f64,
        /// The largest legal one, σ.
        largest: f64,
    },
    /// A skin fixed by hand where no list is used.
    #[error("a skin is set and the list mode is `direct`, which has none")]
    SkinWithoutList(f64),
    /// An instruction set that this processor lacks.
    #[error("this processor does not have the instruction set `{0}`")]
    IsaNotAvailable(&'static str),
    /// A split radius outside (0, r_cut).
    #[error("the split radius must lie between 0 and r_cut = {r_cut}, found {found}")]
    BadSplit {
        /// The split radius found, σ.
        found: f64,
        /// The cutoff, σ.
        r_cut: f64,
    },
    /// A split width outside (0, r_split].
    #[error("the split width must lie between 0 and the split radius, found {0}")]
    BadSplitWidth(f64),
    /// A number of species that no loop can tell apart.
    #[error("a mixture has 1 to {MOST_SPECIES} species, found {0}")]
    NumberOfSpecies(usize),
    /// A particle of a species that does not exist.
    #[error("particle {particle} has species {found}, and there are {species}")]
    NoSuchSpecies {
        /// The particle.
        particle: usize,
        /// The number of its species, from 0.
        found: usize,
        /// Number of species.
        species: usize,
    },
    /// A parameter of a pair of species out of range.
    #[error("`{key}` of the pair of species {} and {} cannot be {found}", species[0], species[1])]
    BadSpeciesPair {
        /// The two species, from 0.
        species: [usize; 2],
        /// The parameter.
        key: &'static str,
        /// The value found.
        found: f64,
    },
    /// What does not go together for one pair of species.
    #[error("the pair of species {} and {}, in units of its own σ and ε: {reason}", species[0], species[1])]
    OfPair {
        /// The two species, from 0.
        species: [usize; 2],
        /// The reason.
        reason: Box<ForceFieldError>,
    },
    /// A mixture of another number of particles.
    #[error("the mixture has {found} particles, and the system has {n_atoms}")]
    OtherParticles {
        /// Particles of the mixture.
        found: usize,
        /// Particles of the system.
        n_atoms: usize,
    },
    /// No particle at all.
    #[error("there is no particle")]
    NoParticles,
    /// More particles than list entries can number.
    #[error("{0} particles are more than a list can number")]
    TooManyParticles(usize),
}

impl ForceFieldError {
    /// The scene key that the reason is about.
    #[must_use]
    pub fn key(&self) -> String {
        let key = match self {
            Self::BadCutoff(_) | Self::CutoffOverHalfBox { .. } | Self::CutoffInsideEnd { .. } => {
                "truncation.r_cut"
            }
            Self::SwitchAtOwnEnd { .. } => "truncation.kind",
            Self::BadSwitch { .. } | Self::SwitchWithoutSwitch(_) => "truncation.switch_from",
            Self::TailWithoutCut(_) => "truncation.tail_correction",
            Self::BadPotential(option) => return format!("potential.{}", option.key),
            Self::BadSkin(_) | Self::SkinTooLarge { .. } | Self::SkinWithoutList(_) => {
                "neighbor.skin"
            }
            Self::IsaNotAvailable(_) => "kernel.isa",
            Self::BadSplit { .. } => "integrator.r_split",
            Self::BadSplitWidth(_) => "integrator.split_width",
            Self::NumberOfSpecies(_) | Self::NoSuchSpecies { .. } => "species",
            Self::BadSpeciesPair { key, .. } => return format!("pair.{key}"),
            Self::OfPair { reason, .. } => return reason.key(),
            Self::NoParticles | Self::TooManyParticles(_) | Self::OtherParticles { .. } => {
                "system.n_atoms"
            }
        };
        key.to_owned()
    }

    /// What is wrong with the value of the key, after its name: `is not allowed`.
    #[must_use]
    pub fn problem(&self) -> String {
        match self {
            // Key, value and range stand beside it.
            Self::BadPotential(_) => "is not allowed".to_owned(),
            other => format!("does not fit: {other}"),
        }
    }

    /// The value found.
    #[must_use]
    pub fn found(&self) -> String {
        match self {
            Self::BadCutoff(x)
            | Self::SwitchWithoutSwitch(x)
            | Self::BadSkin(x)
            | Self::SkinWithoutList(x)
            | Self::BadSplitWidth(x) => x.to_string(),
            Self::CutoffOverHalfBox { r_cut, .. } | Self::CutoffInsideEnd { r_cut, .. } => {
                r_cut.to_string()
            }
            Self::SwitchAtOwnEnd { kind, .. } => (*kind).into(),
            Self::BadSwitch { found, .. } | Self::BadSplit { found, .. } => found.to_string(),
            Self::TailWithoutCut(kind) => format!("true with kind = \"{kind}\""),
            Self::BadPotential(option) => option.found.clone(),
            Self::SkinTooLarge { skin, .. } => skin.to_string(),
            Self::IsaNotAvailable(isa) => (*isa).into(),
            Self::NumberOfSpecies(n) => n.to_string(),
            Self::NoSuchSpecies { found, .. } => found.to_string(),
            Self::BadSpeciesPair { found, .. } => found.to_string(),
            Self::OfPair { reason, .. } => reason.found(),
            Self::OtherParticles { n_atoms, .. } => n_atoms.to_string(),
            Self::NoParticles => "0".into(),
            Self::TooManyParticles(n) => n.to_string(),
        }
    }

    /// The values allowed.
    #[must_use]
    pub fn allowed(&self) -> String {
        match self {
            Self::BadCutoff(_) => "a finite number above 0, at most half the shortest side".into(),
            Self::CutoffOverHalfBox { largest, .. } => {
                format!("at most {}, half the shortest side of the box", upper_bound(*largest))
            }
            Self::CutoffInsideEnd { end, .. } => {
                format!("at least {} = {:.4}, or nothing at all", end.in_words, end.r)
            }
            Self::SwitchAtOwnEnd { .. } => "cut or shift".into(),
            Self::BadSwitch { r_cut, .. } => format!("above 0 and below r_cut = {r_cut}"),
            Self::SwitchWithoutSwitch(_) => {
                "only with kind = \"switch\" or kind = \"xplor\"".into()
            }
            Self::TailWithoutCut(_) => "false, or kind = \"cut\"".into(),
            Self::BadPotential(option) => option.allowed.clone(),
            Self::BadSkin(_) => "a finite number, 0 or more".into(),
            Self::SkinTooLarge { largest, .. } => {
                format!("at most {}, so that r_cut + skin fits half the box", upper_bound(*largest))
            }
            Self::SkinWithoutList(_) => "only with mode = \"auto\" or \"verlet\"".into(),
            Self::IsaNotAvailable(_) => "auto, or one that this processor has".into(),
            Self::BadSplit { r_cut, .. } => format!("above 0 and below r_cut = {r_cut}"),
            Self::BadSplitWidth(_) => "above 0 and at most r_split".into(),
            Self::NumberOfSpecies(_) => format!("1 to {MOST_SPECIES}"),
            Self::NoSuchSpecies { species, .. } => format!("0 to {}", species - 1),
            Self::BadSpeciesPair { key: "epsilon", .. } => "a finite number, 0 or more".into(),
            Self::BadSpeciesPair { .. } => "a finite number above 0".into(),
            Self::OfPair { reason, .. } => reason.allowed(),
            Self::OtherParticles { found, .. } => found.to_string(),
            Self::NoParticles => "at least 1".into(),
            Self::TooManyParticles(_) => format!("at most {}", LARGEST_N),
        }
    }
}
