//! What speaks against a figure of a benchmark.

use lennard_core::stopwatch::{BUSY, Spread};
use serde::Serialize;

/// A block below this, s, is as long as what disturbs it.
const SHORT: f64 = 0.02;
/// Fewest list builds of a block of which one more or less changes little.
const FEWEST_BUILDS: f64 = 3.0;

/// Why a figure is to be doubted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Doubt {
    /// Blocks of the same work took times that differ by more than a fifth.
    Scattered,
    /// Blocks were too short for the clock of a shared machine.
    ShortBlocks,
    /// Blocks hold so few list builds that one more or less is seen.
    FewBuilds,
    /// The arithmetic limit was passed, which nothing can.
    AboveLimit,
}

impl Doubt {
    /// What it means for the reader.
    #[must_use]
    pub fn sentence(self) -> String {
        match self {
            Self::Scattered => format!(
                "times of blocks differ by more than {:.0} % of their median: the machine was busy",
                100.0 * BUSY
            ),
            Self::ShortBlocks => format!(
                "blocks took less than {:.0} ms, too short for a figure to rest on",
                1e3 * SHORT
            ),
            Self::FewBuilds => format!(
                "blocks hold fewer than {FEWEST_BUILDS:.0} list builds, so that one more or less changes the figure"
            ),
            Self::AboveLimit => {
                "a share of the limit above 100 % means that the limit was measured on a busy machine, or does not hold for this model"
                    .into()
            }
        }
    }

    /// Whether it is about the speed, not about the limit.
    #[must_use]
    pub fn is_of_speed(self) -> bool {
        self != Self::AboveLimit
    }
}

/// What speaks against the figures of some blocks.
pub(super) fn doubts(
    seconds: Spread,
    builds_per_block: Option<f64>,
    limit_share: Option<f64>,
) -> Vec<Doubt> {
    [
        (Doubt::Scattered, seconds.is_scattered()),
        (Doubt::ShortBlocks, seconds.median < SHORT),
        (Doubt::FewBuilds, builds_per_block.is_some_and(|builds| builds < FEWEST_BUILDS)),
        (Doubt::AboveLimit, limit_share.is_some_and(|share| share > 1.0)),
    ]
    .into_iter()
    .filter_map(|(doubt, holds)| holds.then_some(doubt))
    .collect()
}

/// The doubts of several results in words, each once.
pub(super) fn sentences<'a>(of: impl Iterator<Item = &'a [Doubt]>) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for sentence in of.flatten().map(|doubt| doubt.sentence()) {
        if !all.contains(&sentence) {
            all.push(sentence);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_scattered_and_impossible_figures_are_doubted_and_sound_ones_are_not() {
        let of = |seconds: &[f64]| Spread::of(seconds.iter().copied()).unwrap();
        let sound = of(&[0.100, 0.105, 0.119]);
        assert_eq!(doubts(sound, Some(8.0), Some(0.93)), []);
        assert_eq!(doubts(sound, None, None), []);
        let scattered = of(&[0.100, 0.105, 0.125]);
        assert_eq!(doubts(scattered, Some(8.0), None), [Doubt::Scattered]);
        assert_eq!(
            doubts(of(&[0.0199]), Some(2.0), Some(1.82)),
            [Doubt::ShortBlocks, Doubt::FewBuilds, Doubt::AboveLimit]
        );
        let said = sentences(
            [&[Doubt::Scattered][..], &[Doubt::Scattered, Doubt::AboveLimit]].into_iter(),
        );
        assert_eq!(said.len(), 2, "{said:?}");
    }
}
