//! A team of threads in one process: channels in the place of a network.

use std::panic::resume_unwind;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Mutex, PoisonError};

use super::{Parcel, Team, Wire};

/// A message between two ranks.
enum Message {
    Words(Vec<u64>),
    ShortWords(Vec<u32>),
}

/// One rank: its ends of the channels, by the other rank.
struct Channels {
    rank: usize,
    to: Vec<Mutex<Sender<Message>>>,
    from: Vec<Mutex<Receiver<Message>>>,
}

/// Does work on each rank of a team, which is a thread of its own: for tests, and to see what a team does.
///
/// # Panics
/// Where the work panics on a rank: the others panic at their next message.
pub fn team_of_threads<R: Send>(ranks: usize, work: impl Fn(Team) -> R + Sync) -> Vec<R> {
    let work = &work;
    std::thread::scope(|scope| {
        let start = |team| scope.spawn(move || work(team));
        let running: Vec<_> = teams(ranks).map(start).collect();
        let joined = running.into_iter().map(|rank| rank.join());
        joined.map(|done| done.unwrap_or_else(|panic| resume_unwind(panic))).collect()
    })
}

/// The team as each of its ranks sees it.
fn teams(ranks: usize) -> impl Iterator<Item = Team> {
    let mut to: Vec<_> = (0..ranks).map(|_| Vec::new()).collect();
    let mut from: Vec<_> = (0..ranks).map(|_| Vec::new()).collect();
    for senders in &mut to {
        for receivers in &mut from {
            let (sender, receiver) = channel();
            senders.push(Mutex::new(sender));
            receivers.push(Mutex::new(receiver));
        }
    }
    let ends = (0..).zip(to.into_iter().zip(from));
    let all = ends.map(|(rank, (to, from))| Channels { rank, to, from });
    all.map(|channels| Team::new(Box::new(channels)))
}

/// What a rank panics with whose team has lost a rank.
const GONE: &str = "another rank of the team is gone";

impl Channels {
    fn send(&self, to: usize, message: Message) {
        let channel = self.to[to].lock().unwrap_or_else(PoisonError::into_inner);
        channel.send(message).expect(GONE);
    }

    fn receive(&self, from: usize) -> Message {
        let channel = self.from[from].lock().unwrap_or_else(PoisonError::into_inner);
        channel.recv().expect(GONE)
    }

    fn words(&self, from: usize) -> Vec<u64> {
        match self.receive(from) {
            Message::Words(words) => words,
            Message::ShortWords(_) => {
                unreachable!("ranks call the same functions in the same order")
            }
        }
    }

    fn short_words(&self, from: usize) -> Vec<u32> {
        match self.receive(from) {
            Message::ShortWords(words) => words,
            Message::Words(_) => unreachable!("ranks call the same functions in the same order"),
        }
    }

    /// The words of each rank.
    fn all(&self, words: &[u64]) -> Vec<Vec<u64>> {
        for to in 0..self.ranks() {
            self.send(to, Message::Words(words.to_vec()));
        }
        (0..self.ranks()).map(|from| self.words(from)).collect()
    }
}

impl Wire for Channels {
    fn rank(&self) -> usize {
        self.rank
    }

    fn ranks(&self) -> usize {
        self.from.len()
    }

    fn sum(&self, words: &mut [i64]) {
        let mine: Vec<u64> = words.iter().map(|word| *word as u64).collect();
        words.fill(0);
        for other in self.all(&mine) {
            assert_eq!(other.len(), words.len(), "ranks add up as many words");
            for (sum, word) in words.iter_mut().zip(other) {
                *sum += word as i64;
            }
        }
    }

    fn max(&self, words: &mut [u64]) {
        for other in self.all(words) {
            assert_eq!(other.len(), words.len(), "ranks compare as many words");
            for (largest, word) in words.iter_mut().zip(other) {
                *largest = word.max(*largest);
            }
        }
    }

    fn trade(&self, words: Vec<Vec<u64>>) -> Vec<Vec<u64>> {
        assert_eq!(words.len(), self.ranks(), "a list for each rank");
        for (to, words) in words.into_iter().enumerate() {
            self.send(to, Message::Words(words));
        }
        (0..self.ranks()).map(|from| self.words(from)).collect()
    }

    fn exchange(&self, outgoing: &[Parcel], incoming: &mut [Parcel], meanwhile: &mut dyn FnMut()) {
        for parcel in outgoing {
            self.send(parcel.rank, Message::ShortWords(parcel.words.clone()));
        }
        meanwhile();
        for parcel in incoming {
            parcel.words.copy_from_slice(&self.short_words(parcel.rank));
        }
    }
}
