//! What a scene file may say about forces: potential, truncation, list and kernel.

use lennard_core::Exclusions;
use lennard_core::number::short;
use lennard_core::options::{Keys, OptionError, Options};
use serde::{Deserialize, Serialize};

use crate::pair::{PotentialOptions, TruncationKind};

/// The shortest cutoff, σ: the powers of its inverse are numbers still.
pub const SHORTEST_CUTOFF: f64 = 0.1;
/// The longest cutoff, σ: as long as the longest box.
pub const LONGEST_CUTOFF: f64 = 1e6;

lennard_core::choices! {
    /// The length that cutoffs of a mixture are written in.
    pub enum CutoffUnit {
        /// σ of the scene: one radius for all pairs.
        #[default]
        Sigma = "sigma",
        /// σ_ab of each pair of species.
        Pair = "pair",
    }
}

/// The scene table `[truncation]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "TruncationTable", into = "TruncationTable")]
pub struct TruncationOptions {
    /// How the potential ends.
    pub kind: TruncationKind,
    /// Cutoff radius r_cut, σ; pairs with r ≤ r_cut count.
    pub r_cut: f64,
    /// The length that cutoffs are written in, for a mixture; `None` for one species, whose cutoffs are in σ.
    pub r_cut_in: Option<CutoffUnit>,
    /// Where the switch begins, σ; for [`TruncationKind::Switch`] and [`TruncationKind::Xplor`] alone. Default 0.8·r_cut.
    pub switch_from: Option<f64>,
    /// Whether means are corrected for the tail beyond r_cut; for [`TruncationKind::Cut`] alone,
    /// and on there unless the scene says otherwise.
    pub tail_correction: bool,
}

lennard_core::options! {
    /// The table as written: an absent `tail_correction` means "on for the plain cutoff".
    struct TruncationTable {
        /// How the potential ends at `r_cut`.
        kind: TruncationKind = TruncationKind::default(), Names(TruncationKind::names);
        /// Cutoff radius; at most half the shortest box side.
        r_cut: f64 = 2.5, Between(SHORTEST_CUTOFF, LONGEST_CUTOFF), in "σ";
        /// Unit of the cutoffs of a mixture: σ of the scene, or σ_ab of each pair of species.
        r_cut_in: Option<CutoffUnit> = None, else "`\"sigma\"`", Names(CutoffUnit::names);
        /// Where the switch begins.
        switch_from: Option<f64> = None, else "0.8·`r_cut`", Words("a number between 0 and `r_cut`, with kind \"switch\" or \"xplor\" alone"), in "σ";
        /// Whether U and P are corrected for the fluid beyond the cutoff. `"planar"` makes the correction a force across flat surfaces.
        tail_correction: Option<bool> = None, else "`true` for `\"cut\"`, else `false`", Words("true, false or \"planar\"; true and \"planar\" with kind \"cut\" alone, true only in a homogeneous fluid, \"planar\" only with surfaces across z");
    }
}

/// A scene with `"planar"` reads the word itself, and leaves a flag in its place.
impl Options for TruncationOptions {
    const KEYS: Keys = TruncationTable::KEYS;

    fn check(&self) -> Result<(), OptionError> {
        TruncationTable::from(*self).check()
    }
}

impl From<TruncationTable> for TruncationOptions {
    fn from(table: TruncationTable) -> Self {
        Self {
            kind: table.kind,
            r_cut: table.r_cut,
            r_cut_in: table.r_cut_in,
            switch_from: table.switch_from,
            tail_correction: table.tail_correction.unwrap_or(table.kind.spec().jumps),
        }
    }
}

impl From<TruncationOptions> for TruncationTable {
    fn from(options: TruncationOptions) -> Self {
        Self {
            kind: options.kind,
            r_cut: options.r_cut,
            r_cut_in: options.r_cut_in,
            switch_from: options.switch_from,
            tail_correction: Some(options.tail_correction),
        }
    }
}

impl TruncationOptions {
    /// A truncation of this kind at `r_cut` σ, with the tail correction on for the plain cutoff.
    #[must_use]
    pub fn new(kind: TruncationKind, r_cut: f64) -> Self {
        Self { kind, r_cut, r_cut_in: None, switch_from: None, tail_correction: kind.spec().jumps }
    }

    /// The same truncation at another cutoff, σ; a switch keeps its share of it.
    #[must_use]
    pub fn at_cutoff(&self, r_cut: f64) -> Self {
        if r_cut == self.r_cut {
            return *self;
        }
        let share = |from: f64| from / self.r_cut * r_cut;
        Self { r_cut, switch_from: self.switch_from.map(share), ..*self }
    }

    /// A length of the truncation in words: `2.5 σ`, or `2.5 σ_ab`.
    pub(crate) fn length_in_words(&self, length: f64) -> String {
        let unit = match self.r_cut_in {
            Some(CutoffUnit::Pair) => "σ_ab",
            Some(CutoffUnit::Sigma) | None => "σ",
        };
        format!("{} {unit}", short(length))
    }
}

impl Default for TruncationOptions {
    fn default() -> Self {
        TruncationTable::default().into()
    }
}

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

lennard_core::choices! {
    /// Which instruction set the pair loop uses.
    pub enum Isa {
        /// The widest that this processor has.
        #[default]
        Auto = "auto",
        /// AVX-512 (F, BW, DQ and VL).
        Avx512 = "avx512",
        /// AVX2 with FMA.
        Avx2 = "avx2",
        /// No particular instruction set.
        Portable = "portable",
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
    /// history and the number of threads. The bit-reversible integrator needs this.
    pub canonical: bool,
    /// Pairs that do not interact: the ends of the bonds of molecules.
    #[serde(skip)]
    pub exclusions: Exclusions,
}
