//! Seeded mutations of a corpus.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::Target;

/// What a byte may be replaced by: those that formats give a meaning, and some that none does.
const TELLING_BYTES: &[u8] = b"0123456789.-+eE \t\n\r\"{}[]=:\\,#TFnaif\0\xff\x80\x01\x7f";

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
    random: Xoshiro256PlusPlus,
}

impl<'a> Mutator<'a> {
    /// # Panics
    /// Where the corpus is empty: there is nothing to start from.
    #[must_use]
    pub fn new(target: &'a Target, corpus: Vec<Vec<u8>>, seed: u64) -> Self {
        assert!(!corpus.is_empty(), "the corpus of {} is empty", target.name);
        Self { target, corpus, random: Xoshiro256PlusPlus::seed_from_u64(seed) }
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

    fn change(&mut self, bytes: &mut Vec<u8>) {
        if bytes.is_empty() {
            bytes.push(b'0');
        }
        let at = self.below(bytes.len());
        let end = (at + 1 + self.below(LONGEST_PIECE)).min(bytes.len());
        match self.below(9) {
            0 => bytes[at] = TELLING_BYTES[self.below(TELLING_BYTES.len())],
            1 => bytes[at] ^= 1 << self.below(8),
            2 => bytes[at] = self.random.random_range(0..=u8::MAX),
            3 => drop(bytes.drain(at..end)),
            4 => {
                let piece = bytes[at..end].to_vec();
                let to = self.below(bytes.len());
                bytes.splice(to..to, piece);
            }
            5 => {
                let piece: Vec<u8> = bytes.drain(at..end).collect();
                let to = self.below(bytes.len() + 1);
                bytes.splice(to..to, piece);
            }
            6 => {
                let word = self.target.words[self.below(self.target.words.len())];
                let over = if self.below(2) == 0 { at } else { (at + word.len()).min(bytes.len()) };
                bytes.splice(at..over, word.bytes());
            }
            7 => {
                // A line of another file of the corpus.
                let other = self.below(self.corpus.len());
                let lines: Vec<&[u8]> =
                    self.corpus[other].split_inclusive(|b| *b == b'\n').collect();
                let chosen = self.random.random_range(0..lines.len().max(1));
                let line = lines.get(chosen).map(|line| line.to_vec());
                bytes.splice(at..at, line.unwrap_or_default());
            }
            _ => {
                // Cutting off the end is common in life and rare here, or little would be left of anything.
                if self.below(4) == 0 {
                    bytes.truncate(at);
                }
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
