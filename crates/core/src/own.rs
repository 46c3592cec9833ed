//! Which of all particles this process keeps, and what it tells the ranks beside it.

use std::borrow::Cow;
use std::fmt;
use std::iter;
use std::ops::Range;

use glam::DVec3;

use crate::Team;
use crate::exact::{ExactSums, Summand, exact_sum_over, exact_sums};

/// Bytes of one message on their way to rank 0, at most.
const PIECE: usize = 1 << 20;

/// The particles that this process keeps: all of them, or the particles of consecutive numbers on a rank.
///
/// Arrays of a state are indexed from 0. Their entry `i` belongs to the particle with the number `first + i`. One process is the
/// case without a team. Each function that all ranks take part in has to be called by all of them.
#[derive(Clone)]
pub struct Own {
    numbers: Range<usize>,
    all: usize,
    team: Option<Team>,
}

impl Own {
    /// All of `n` particles.
    #[must_use]
    pub fn all_of(n: usize) -> Self {
        Self { numbers: 0..n, all: n, team: None }
    }

    /// The particles, of `n`, that this rank keeps.
    #[must_use]
    pub fn of_rank(team: &Team, n: usize) -> Self {
        Self { numbers: team.numbers(n), all: n, team: Some(team.clone()) }
    }

    /// The number of particles on all ranks of a team, of which so many are here.
    #[must_use]
    pub fn whole_of(team: Option<&Team>, here: usize) -> usize {
        let mut words = [here as i64];
        if let Some(team) = team {
            team.sum(&mut words);
        }
        words[0] as usize
    }

    /// Some of these particles, counted anew: `all` on all ranks, and here those with these numbers.
    #[must_use]
    pub fn some(&self, numbers: Range<usize>, all: usize) -> Self {
        Self { numbers, all, team: self.team.clone() }
    }

    /// The numbers of the particles.
    #[must_use]
    pub fn numbers(&self) -> Range<usize> {
        self.numbers.clone()
    }

    /// The number of the first particle.
    #[must_use]
    pub fn first(&self) -> usize {
        self.numbers.start
    }

    /// How many particles this process keeps.
    #[must_use]
    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    /// Whether this process keeps none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// How many particles there are on all ranks.
    #[must_use]
    pub fn all(&self) -> usize {
        self.all
    }

    /// The ranks, where there are several.
    #[must_use]
    pub fn team(&self) -> Option<&Team> {
        self.team.as_ref()
    }

    /// Whether this process writes files: it is alone, or rank 0.
    #[must_use]
    pub fn leads(&self) -> bool {
        self.team.as_ref().is_none_or(Team::leads)
    }

    /// The index of the particle with a number, where this process keeps it.
    #[must_use]
    pub fn index(&self, number: usize) -> Option<usize> {
        self.numbers.contains(&number).then(|| number - self.numbers.start)
    }

    /// The exact sum of `term(0)`, …, `term(n − 1)` of all ranks, each with an `n` of its own.
    pub fn sum<T: Summand<N>, const N: usize>(
        &self,
        n: usize,
        term: impl Fn(usize) -> T + Sync,
    ) -> T {
        exact_sum_over(self.team(), n, term)
    }

    /// [`Own::sum`] of one term for each item, in less time where terms are simple.
    pub fn sum_of<T: Sync>(&self, items: &[T], term: impl Fn(&T) -> f64 + Sync) -> f64 {
        let (sums, _) = exact_sums(items.len(), |range, sums: &mut ExactSums<1>| {
            sums.add_of(&items[range], &term);
        });
        let [sum] = sums.over(self.team()).values();
        sum
    }

    /// How many there are on all ranks together, of whatever each has so many of.
    #[must_use]
    pub fn count(&self, here: usize) -> usize {
        Self::whole_of(self.team(), here)
    }

    /// Makes each whole number the sum over all ranks.
    pub fn add_up(&self, numbers: &mut [i64]) {
        if let Some(team) = &self.team {
            team.sum(numbers);
        }
    }

    /// Items in a list of all ranks, of which so many are here: one rank comes after another.
    #[must_use]
    pub fn list(&self, here: usize) -> Self {
        let Some(team) = &self.team else { return Self::all_of(here) };
        let counts = team.concat(&[here as u64]);
        let first: u64 = counts[..team.rank()].iter().sum();
        let first = first as usize;
        self.some(first..first + here, counts.iter().sum::<u64>() as usize)
    }

    /// Lets each rank change some numbers, one after another, with what the rank before has left: sums that round have the bits of
    /// one process. All ranks get what the last one leaves.
    pub fn in_turn(&self, numbers: &mut [f64], change: impl FnOnce(&mut [f64])) {
        let Some(team) = &self.team else { return change(numbers) };
        let mut change = Some(change);
        for turn in 0..team.ranks() {
            let mut given = vec![Vec::new(); team.ranks()];
            if turn == team.rank()
                && let Some(change) = change.take()
            {
                change(numbers);
                let words: Vec<u64> = numbers.iter().map(|x| x.to_bits()).collect();
                match given.get_mut(turn + 1) {
                    Some(next) => *next = words,
                    None => given.fill(words),
                }
            }
            let words = team.trade(given).concat();
            for (number, word) in numbers.iter_mut().zip(words) {
                *number = f64::from_bits(word);
            }
        }
    }

    /// The vectors of the runs of so many numbers that begin here. A rank that has the first particle of a run gets the others.
    #[must_use]
    pub fn whole_runs<'a>(&self, here: &'a [DVec3], run: usize) -> Cow<'a, [DVec3]> {
        let Some(team) = &self.team else { return here.into() };
        let ends = team.concat(&[self.numbers.end as u64]);
        let begin = self.numbers.start.next_multiple_of(run).min(self.numbers.end);
        let (before, own) = here.split_at(begin - self.numbers.start);
        let mut given = vec![Vec::new(); team.ranks()];
        if !before.is_empty() {
            let first = self.numbers.start / run * run;
            let rank = ends.iter().position(|end| first < *end as usize);
            given[rank.unwrap_or(0)] = bytemuck::cast_slice(before).to_vec();
        }
        let rest = vectors_of(&team.trade(given).concat());
        [own, &rest].concat().into()
    }

    /// The largest of some numbers of all ranks, none of them negative.
    #[must_use]
    pub fn largest(&self, here: f64) -> f64 {
        let Some(team) = &self.team else { return here };
        // Numbers that are not negative have the order of their bits.
        let mut words = [here.to_bits()];
        team.max(&mut words);
        f64::from_bits(words[0])
    }

    /// The words of the lowest rank that has some, on all ranks; `None` where no rank has any.
    #[must_use]
    pub fn told<const N: usize>(&self, here: Option<[u64; N]>) -> Option<[u64; N]> {
        let Some(team) = &self.team else { return here };
        let all = team.concat(here.as_ref().map_or(&[], |words| &words[..]));
        all.first_chunk().copied()
    }

    /// A vector that one rank has, on all ranks.
    ///
    /// # Panics
    /// Where no rank has it: that is a bug of the caller.
    #[must_use]
    pub fn vector(&self, here: Option<DVec3>) -> DVec3 {
        let words = here.map(|v| v.to_array().map(f64::to_bits));
        let words = self.told(words).expect("a rank keeps the particle");
        DVec3::from_array(words.map(f64::from_bits))
    }

    /// The words of all ranks on rank 0, one rank after another; nothing on the others.
    #[must_use]
    pub fn collect(&self, words: Vec<u64>) -> Vec<u64> {
        let Some(team) = &self.team else { return words };
        let mut given = vec![Vec::new(); team.ranks()];
        given[0] = words;
        team.trade(given).concat()
    }

    /// The number of this rank, from 0, and the number of ranks.
    #[must_use]
    pub fn rank_of(&self) -> [usize; 2] {
        self.team.as_ref().map_or([0, 1], |team| [team.rank(), team.ranks()])
    }

    /// Gives each rank the vectors that `of` names for it. Returns those that all ranks gave to this one, one rank after another.
    #[must_use]
    pub fn deal(&self, of: impl Fn(usize) -> Vec<DVec3>) -> Vec<DVec3> {
        let Some(team) = &self.team else { return of(0) };
        let words = |rank| bytemuck::cast_slice(&of(rank)).to_vec();
        vectors_of(&team.trade((0..team.ranks()).map(words).collect()).concat())
    }

    /// Gives rank 0 the bytes of all ranks, one rank after another.
    pub fn pass_bytes(&self, here: &[u8], take: impl FnMut(&[u8])) {
        let make = |range: Range<usize>, to: &mut Vec<u8>| to.extend_from_slice(&here[range]);
        self.pass_texts((here.len(), PIECE), &mut Vec::new(), make, take);
    }

    /// Gives rank 0 what all ranks make of their items, one rank after another. Here are so many items, of which so many make one
    /// piece; `make` adds the bytes of a piece to a buffer. A rank without items makes one empty piece.
    pub fn pass_texts(
        &self,
        (here, of_piece): (usize, usize),
        buffer: &mut Vec<u8>,
        mut make: impl FnMut(Range<usize>, &mut Vec<u8>),
        mut take: impl FnMut(&[u8]),
    ) {
        if self.leads() {
            for range in pieces(here, of_piece) {
                buffer.clear();
                make(range, buffer);
                take(buffer);
            }
        }
        let words = |range| {
            buffer.clear();
            make(range, buffer);
            let chunks = buffer.chunks(8).map(|chunk| {
                let mut bytes = [0; 8];
                bytes[..chunk.len()].copy_from_slice(chunk);
                u64::from_le_bytes(bytes)
            });
            iter::once(buffer.len() as u64).chain(chunks).collect()
        };
        self.pass_pieces((here, of_piece), words, |words| {
            let bytes: Vec<u8> = words[1..].iter().flat_map(|word| word.to_le_bytes()).collect();
            take(&bytes[..words[0] as usize]);
        });
    }

    /// Gives rank 0 the vectors of all ranks in words, one rank after another.
    pub fn pass(&self, here: &[DVec3], mut take: impl FnMut(&[u64])) {
        let words = |range: Range<usize>| bytemuck::cast_slice(&here[range]).to_vec();
        if self.leads() {
            take(bytemuck::cast_slice(here));
        }
        self.pass_pieces((here.len(), PIECE / size_of::<DVec3>()), words, take);
    }

    /// Gives rank 0 what other ranks have, one rank after another and in small pieces. Here are so many items, of which so many
    /// make one piece. `words` makes the words of a range of them, and `take` gets the words of each piece.
    fn pass_pieces(
        &self,
        (here, of_piece): (usize, usize),
        mut words: impl FnMut(Range<usize>) -> Vec<u64>,
        mut take: impl FnMut(&[u64]),
    ) {
        let Some(team) = &self.team else { return };
        for (rank, length) in team.concat(&[here as u64]).into_iter().enumerate().skip(1) {
            for range in pieces(length as usize, of_piece) {
                let mut given = vec![Vec::new(); team.ranks()];
                if rank == team.rank() {
                    given[0] = words(range);
                }
                let taken = team.trade(given);
                if team.leads() {
                    take(&taken[rank]);
                }
            }
        }
    }

    /// Vectors of all particles on rank 0, in the order of their numbers; nothing on the other ranks. Each gives one for each particle
    /// that it keeps.
    #[must_use]
    pub fn collect_vectors(&self, here: &[DVec3]) -> Vec<DVec3> {
        if self.team.is_none() {
            return here.to_vec();
        }
        vectors_of(&self.collect(bytemuck::cast_slice(here).to_vec()))
    }

    /// Rows of one vector for each particle, one after another, on rank 0; nothing on the other ranks.
    #[must_use]
    pub fn collect_rows<'a>(&self, rows: impl Iterator<Item = &'a [DVec3]>) -> Vec<DVec3> {
        rows.flat_map(|row| self.collect_vectors(row)).collect()
    }

    /// Of rows of one vector for each particle of all ranks, the parts for the particles that are kept here.
    pub fn parts_of_rows<'a, T>(&self, all: &'a [T]) -> impl Iterator<Item = &'a [T]> {
        all.chunks(self.all.max(1)).map(|row| &row[self.numbers.clone()])
    }
}

/// The ranges of so many items with so many in each, at least one range.
fn pieces(n: usize, of_piece: usize) -> impl Iterator<Item = Range<usize>> {
    (0..n.max(1)).step_by(of_piece.max(1)).map(move |begin| begin..n.min(begin + of_piece))
}

fn vectors_of(words: &[u64]) -> Vec<DVec3> {
    words.as_chunks().0.iter().map(|v| DVec3::from_array(v.map(f64::from_bits))).collect()
}

impl PartialEq for Own {
    fn eq(&self, other: &Self) -> bool {
        (&self.numbers, self.all) == (&other.numbers, other.all)
    }
}

impl fmt::Debug for Own {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} of {}", self.numbers, self.all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::team_of_threads;

    #[test]
    fn sums_counts_and_errors_are_those_of_all_ranks() {
        let term = |number: usize| (number as f64).sin() * 1e3;
        let alone = Own::all_of(100);
        let sum: f64 = alone.sum(100, term);
        for ranks in 1..4 {
            team_of_threads(ranks, |team| {
                let own = Own::of_rank(&team, 100);
                assert_eq!(own.sum(own.len(), |i| term(own.first() + i)), sum);
                let terms: Vec<f64> = own.numbers().map(term).collect();
                assert_eq!(own.sum_of(&terms, |x| *x), sum);
                assert_eq!(own.count(own.len()), 100);
                let largest = own.largest(own.numbers().end as f64);
                assert_eq!(largest, 100.0);
                let index = own.index(57);
                let found = own.vector(index.map(|i| DVec3::splat((own.first() + i) as f64)));
                assert_eq!(found, DVec3::splat(57.0));
                let all = own.collect(own.numbers().map(|k| k as u64).collect());
                let expected = if team.leads() { (0..100).collect() } else { Vec::new() };
                assert_eq!(all, expected);
            });
        }
    }
}
