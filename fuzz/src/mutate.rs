//! Seeded mutations of a corpus.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::Target;

/// The most changes made to one input.
const MOST_CHANGES: u32 = 8;

/// The longest piece that is removed, doubled or moved, in bytes.
const LONGEST_PIECE: usize = 64;

/// Inputs longer than this (bytes) are cut, or doubling would make them grow without end.
const LONGEST_INPUT: usize = 1 << 16;

/// Makes inputs from a corpus: the same seed makes the same ones.
pub struct Mutator<'a> {
    target: &'a Target,
    corpus: Vec<Vec<u8>>,
    words: Vec<String>,
    random: Xoshiro256PlusPlus,
}

impl<'a> Mutator<'a> {
    /// # Panics
    /// Where the corpus is empty: there is nothing to start from.
    #[must_use]
    pub fn new(target: &'a Target, corpus: Vec<Vec<u8>>, seed: u64) -> Self {
        assert!(!corpus.is_empty(), "the corpus of {} is empty", target.name);
        let lists: toml::Table = include_str!("../words.toml").parse().expect("lists of words");
        let words = lists[target.words].clone().try_into().expect("a list of words");
        Self { target, corpus, words, random: Xoshiro256PlusPlus::seed_from_u64(seed) }
    }

    fn below(&mut self, end: usize) -> usize {
        self.random.random_range(0..end.max(1))
    }

    /// The next input.
    pub fn input(&mut self) -> Vec<u8> {
        let chosen = self.below(self.corpus.len());
        let mut bytes = self.corpus[chosen].clone();
        if let Some(reshape) = self.target.reshape
            && self.below(2) == 0
        {
            for _ in 0..=self.below(2) {
                reshape(&mut bytes, &mut |end| self.below(end));
            }
            if self.below(4) > 0 {
                return bytes;
            }
        }
        // Mostly one or two: after more, little is left that is read beyond its first fault.
        let most = self.random.random_range(1..=MOST_CHANGES);
        for _ in 0..self.random.random_range(1..=most) {
            self.change(&mut bytes);
        }
        bytes.truncate(LONGEST_INPUT);
        // One in eight keeps its wrong checksum.
        if let Some(repair) = self.target.repair
            && self.below(8) > 0
        {
            repair(&mut bytes);
        }
        bytes
    }

    /// A byte, a piece or a word changes, or the end is cut off.
    fn change(&mut self, bytes: &mut Vec<u8>) {
        let at = self.below(bytes.len());
        let end = (at + 1 + self.below(LONGEST_PIECE)).min(bytes.len());
        match self.below(16) {
            0..4 if at < end => bytes[at] = self.random.random_range(0..=u8::MAX),
            4..7 => drop(bytes.drain(at..end)),
            7..10 => {
                let piece = bytes[at..end].to_vec();
                let to = self.below(bytes.len());
                bytes.splice(to..to, piece);
            }
            10 => bytes.truncate(at),
            _ => {
                let chosen = self.below(self.words.len());
                let word = self.words[chosen].as_bytes().to_vec();
                let over = if self.below(2) == 0 { at } else { (at + word.len()).min(bytes.len()) };
                bytes.splice(at..over, word);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TARGETS;

    #[test]
    fn the_same_seed_makes_the_same_inputs_and_another_seed_makes_others() {
        let inputs = |seed| {
            let mut mutator =
                Mutator::new(&TARGETS[0], vec![b"[system]\nn_atoms = 108\n".to_vec()], seed);
            (0..50).map(|_| mutator.input()).collect::<Vec<_>>()
        };
        assert_eq!(inputs(7), inputs(7));
        assert_ne!(inputs(7), inputs(8));
    }
}
