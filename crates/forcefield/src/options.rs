//! What a scene file may say about forces: list and kernel, beside potential and truncation.

use lennard_core::Exclusions;
use serde::{Deserialize, Serialize};

use crate::pair::{PotentialOptions, TruncationOptions};
use crate::simd::Isa;

lennard_core::choices! {
    /// How neighbors are found.
    pub enum ListMode {
        /// Chosen from the scene: a list where box and number of particles let it pay.
        #[default]
        Auto = "auto",
        /// Every pair, every time.
        Direct = "direct",
        /// A Verlet list over a cell grid.
        Verlet = "verlet",
    }
}

lennard_core::options! {
    /// The scene table `[neighbor]`.
    #[derive(Copy)]
    pub struct NeighborOptions {
        /// Every pair each time, or a Verlet list over a cell grid; `auto` chooses from the scene.
        mode: ListMode = ListMode::Auto, Names(ListMode::names);
        /// The list holds pairs up to r_cut + skin; that may not exceed half the shortest box side.
        skin: Option<f64> = None, else "chosen from density, temperature, dt and precision", NotNegative, in "σ";
    }
}

lennard_core::choices! {
    /// Which force loop runs.
    pub enum Kernel {
        /// The fastest that suits the scene.
        #[default]
        Auto = "auto",
        /// The ten-line double loop over all pairs, scalar, serial: what every other one is judged by.
        Reference = "reference",
    }
}

lennard_core::choices! {
    /// In which precision pairs are computed; sums and integration are always in double.
    pub enum Precision {
        /// Everything in f64.
        #[default]
        Double = "double",
        /// Pairs in f32 on coordinate differences that are exact, sums in f64.
        Mixed = "mixed",
    }
}

lennard_core::options! {
    /// The scene table `[kernel]`.
    #[derive(Copy)]
    pub struct KernelOptions {
        /// The fastest loop that suits the scene; the plain double loop that all others are judged by.
        kernel: Kernel = Kernel::Auto, Names(Kernel::names);
        /// Precision of the pair terms; sums and integration are always double.
        precision: Precision = Precision::Double, Names(Precision::names);
        /// Instruction set of the loop.
        isa: Isa = Isa::Auto, Names(Isa::names);
    }
}

/// A split of the pair force by distance, for multiple-time-step integrators.
///
/// The near part carries the weight w(r) = 1 up to `r_split − width`, falling smoothly to 0 at
/// `r_split`; the far part carries 1 − w.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SplitOptions {
    /// Where the near part ends, σ.
    pub r_split: f64,
    /// Over which distance it ends, σ.
    pub width: f64,
}

/// Everything that decides what the forces are and how they are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ForceFieldOptions {
    /// The pair potential.
    pub potential: PotentialOptions,
    /// How it ends.
    pub truncation: TruncationOptions,
    /// How neighbors are found.
    pub neighbor: NeighborOptions,
    /// Which loop computes.
    pub kernel: KernelOptions,
    /// The split into a near and a far part; set by whoever runs a method that asks for parts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub split: Option<SplitOptions>,
    /// Whether forces must be a pure function of the positions, to the bit, whatever the list, its
    /// history and the number of threads. The judge of forces in studies needs this.
    pub canonical: bool,
    /// Pairs that do not interact: the ends of the bonds of molecules.
    #[serde(skip)]
    pub exclusions: Exclusions,
}
