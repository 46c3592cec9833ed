//! The way of vectors between numbers and places.

use glam::DVec3;
use lennard_core::{Parcel, Team};

use crate::simd::{vector_of, words_of};

/// Where the particles of this rank by place have their numbers, and where those by number have their places.
pub struct Route {
    /// For each rank, the own slots of the particles whose numbers it keeps, by ascending number.
    slots: Vec<Vec<u32>>,
    /// For each rank, the places in the arrays by number of the particles that it owns, ascending.
    numbers: Vec<Vec<u32>>,
}

impl Route {
    /// The route of particles at own slots, whose numbers are given. All ranks make it together.
    pub fn new(team: &Team, whole: usize, own: &[u32]) -> Self {
        let shares = team.shares(whole);
        let mut by_number: Vec<u32> = (0..own.len() as u32).collect();
        by_number.sort_unstable_by_key(|slot| own[*slot as usize]);
        let mut rest = &by_number[..];
        let slots: Vec<Vec<u32>> = shares
            .iter()
            .map(|share| {
                let end = rest.partition_point(|slot| (own[*slot as usize] as usize) < share.end);
                let (slots, others) = rest.split_at(end);
                rest = others;
                slots.to_vec()
            })
            .collect();
        let number = |slot: &u32| u64::from(own[*slot as usize]);
        let sent = slots.iter().map(|slots| slots.iter().map(number).collect());
        let first = shares[team.rank()].start as u64;
        let came = team.trade(sent.collect()).into_iter();
        let numbers = came.map(|words| words.iter().map(|word| (word - first) as u32).collect());
        Self { numbers: numbers.collect(), slots }
    }

    /// Takes vectors by number to the own slots.
    pub fn to_slots(&self, team: &Team, from: &[DVec3], to: &mut [DVec3]) {
        go(team, (&self.numbers, from), (&self.slots, to));
    }

    /// Takes vectors at own slots to their numbers.
    pub fn to_numbers(&self, team: &Team, from: &[DVec3], to: &mut [DVec3]) {
        go(team, (&self.slots, from), (&self.numbers, to));
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        4 * self.slots.iter().chain(&self.numbers).map(Vec::capacity).sum::<usize>()
    }
}

/// Sends the vectors at some places by rank, and puts those that come at others.
fn go(
    team: &Team,
    (given, from): (&[Vec<u32>], &[DVec3]),
    (taken, to): (&[Vec<u32>], &mut [DVec3]),
) {
    let me = team.rank();
    for (give, take) in given[me].iter().zip(&taken[me]) {
        to[*take as usize] = from[*give as usize];
    }
    let others = |lists: &[Vec<u32>], words: &dyn Fn(u32) -> [u32; 6]| -> Vec<Parcel> {
        let lists = lists.iter().enumerate();
        let lists = lists.filter(|(rank, list)| *rank != me && !list.is_empty());
        lists
            .map(|(rank, list)| Parcel {
                rank,
                words: list.iter().flat_map(|k| words(*k)).collect(),
            })
            .collect()
    };
    let outgoing = others(given, &|k| words_of(from[k as usize]));
    let mut incoming = others(taken, &|_| [0; 6]);
    team.exchange(&outgoing, &mut incoming, &mut || {});
    for parcel in incoming {
        for (take, words) in taken[parcel.rank].iter().zip(parcel.words.chunks_exact(6)) {
            to[*take as usize] = vector_of(words);
        }
    }
}
