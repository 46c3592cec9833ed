//! What a scene file may say about the end of the potential.

use lennard_core::number::short;
use lennard_core::options::{Keys, OptionError, Options};
use serde::{Deserialize, Serialize};

use super::TruncationKind;

/// The shortest cutoff, σ: the powers of its inverse are numbers still.
pub const SHORTEST_CUTOFF: f64 = 0.1;
/// Where a switch begins if the scene does not say: this share of r_cut.
const DEFAULT_SHARE: f64 = 0.8;
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

    /// Where the switch begins, σ.
    pub(super) fn switch_begins(&self) -> f64 {
        self.switch_from.unwrap_or(DEFAULT_SHARE * self.r_cut)
    }

    /// A length of the truncation in words: `2.5 σ`, or `2.5 σ_ab`.
    pub(super) fn length_in_words(&self, length: f64) -> String {
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
