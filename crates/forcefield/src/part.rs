//! The part of space that a rank owns: its particles by slot, the halo around them, and what all ranks decide together.
//!
//! ```text
//!   by number   | rank 0 | rank 1 | rank 2 |     what methods, observables and files have: consecutive numbers
//!                   route: at the begin and the end of fused steps, and around single evaluations
//!   by place    own slots | halo                 what the lists of this rank name, in the order of its list
//!                           positions come once a step, while chunks that name no halo run; no force goes back
//! ```
//!
//! The lists of a part are the lists of the whole, and its sums are exact. So no bit depends on the cuts.

mod halo;
mod movers;
mod route;
mod settle;

use std::collections::HashSet;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::DVec3;
use lennard_core::{Parcel, SpeedLimit, Team};
use lennard_neighbor::{Beyond, Columns, PairList, Partners, SMALLEST_CUT};

use crate::simd::{MotionSummary, SomeRows};

pub use self::movers::Settled;

use self::halo::{Halo, Mail};
use self::route::Route;

/// What one rank has of a system that several share.
pub struct Part {
    team: Team,
    /// Number of particles of all ranks.
    whole: usize,
    limit: SpeedLimit,
    /// The columns of the last build, and the rank of each bundle.
    columns: Columns,
    owners: Vec<u32>,
    /// Builds since the last cut.
    builds: usize,
    /// Particles within the list radius of the part, whose positions come in each step, and others that lists name.
    near: Halo,
    /// The distance from a part, σ, within which particles have slots there: they may come within the cutoff before the next build.
    far: f64,
    /// The rank of each slot behind the own ones.
    halo_ranks: Vec<u32>,
    /// What lies beyond the own columns.
    beyond: Beyond,
    /// Searches for unlisted pairs since the build.
    searches: AtomicU64,
    /// The pairs with an own particle that were inserted since the build: the search, and both places in the order of the whole.
    inserted: Vec<[u64; 3]>,
    /// The pairs of slots across the face of the part that were found since the build.
    crossing: HashSet<[u32; 2]>,
    /// Between numbers and slots; none before it is asked for.
    route: Mutex<Option<Route>>,
    /// The chunks that name no halo, and the others.
    inner_and_outer: [Vec<u32>; 2],
    /// The rows of this rank, and the rows of its halo.
    rows: [RowRuns; 2],
    /// The own slots, as partners of far movers.
    partners: Partners,
    /// Whether a force of this rank is not finite, or a particle too fast, since all ranks asked last.
    broken: AtomicBool,
    buffers: Mutex<[Vec<Parcel>; 2]>,
}

/// Runs of slots and of ghosts, whose rows are packed together.
#[derive(Default)]
struct RowRuns {
    slots: Vec<Range<usize>>,
    ghosts: Vec<Range<usize>>,
}

/// Particles on their way to their places.
#[derive(Default)]
pub struct Particles {
    /// Whether they have velocities; all ranks say the same.
    pub move_on: bool,
    /// The number of each particle.
    pub numbers: Vec<u32>,
    /// Unwrapped positions, σ.
    pub positions: Vec<DVec3>,
    /// Velocities, σ/τ.
    pub velocities: Vec<DVec3>,
}

impl Part {
    /// The part of this rank, of a system of `whole` particles: nothing, before particles settle.
    pub fn new(team: &Team, whole: usize, limit: SpeedLimit) -> Self {
        Self {
            team: team.clone(),
            whole,
            limit,
            columns: Columns::default(),
            owners: Vec::new(),
            builds: 0,
            near: Halo::default(),
            far: 0.0,
            halo_ranks: Vec::new(),
            beyond: Beyond::default(),
            searches: AtomicU64::new(0),
            inserted: Vec::new(),
            crossing: HashSet::new(),
            route: Mutex::new(None),
            inner_and_outer: Default::default(),
            rows: Default::default(),
            partners: Partners::default(),
            broken: AtomicBool::new(false),
            buffers: Mutex::default(),
        }
    }

    /// The team.
    pub fn team(&self) -> &Team {
        &self.team
    }

    /// The numbers of the particles that this rank keeps.
    pub fn numbers(&self) -> Range<usize> {
        self.team.numbers(self.whole)
    }

    /// The chunks that name no halo, and the others.
    pub fn inner_and_outer(&self) -> [&[u32]; 2] {
        let [inner, outer] = &self.inner_and_outer;
        [inner, outer]
    }

    /// The rows of this rank (0), or the rows of its halo (1).
    pub fn rows(&self, of: usize) -> SomeRows<'_> {
        let RowRuns { slots, ghosts } = &self.rows[of];
        SomeRows { slots, ghosts }
    }

    /// The own slots, as partners of far movers.
    pub fn partners(&self) -> &Partners {
        &self.partners
    }

    fn buffers(&self) -> MutexGuard<'_, [Vec<Parcel>; 2]> {
        self.buffers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The mail of a step, with so many words for each particle.
    pub fn mail(&self, words: usize) -> Mail<'_> {
        let mut buffers = self.buffers();
        let [outgoing, incoming] = &mut *buffers;
        Halo::address(&self.near.given, words, outgoing);
        Halo::address(&self.near.wanted, words, incoming);
        Mail { halo: &self.near, team: &self.team, words, buffers }
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        let buffers = self.buffers();
        let sent: usize = buffers.iter().flatten().map(|p| p.words.capacity()).sum();
        let route = self.route.lock().unwrap_or_else(PoisonError::into_inner);
        let route = route.as_ref().map_or(0, Route::bytes);
        let chunks: usize = self.inner_and_outer.iter().map(Vec::capacity).sum();
        self.near.bytes() + route + 4 * (sent + chunks + self.halo_ranks.capacity())
    }

    /// Takes vectors by number to the own slots, which `to` begins with.
    pub fn to_slots<P: PairList>(&self, list: &P, from: &[DVec3], to: &mut [DVec3]) {
        self.with_route(list, |route| route.to_slots(&self.team, from, to));
    }

    /// Takes vectors at the own slots, which `from` begins with, to their numbers.
    pub fn to_numbers<P: PairList>(&self, list: &P, from: &[DVec3], to: &mut [DVec3]) {
        self.with_route(list, |route| route.to_numbers(&self.team, from, to));
    }

    fn with_route<P: PairList>(&self, list: &P, go: impl FnOnce(&Route)) {
        let mut route = self.route.lock().unwrap_or_else(PoisonError::into_inner);
        let own = &list.particles()[..list.own()];
        go(route.get_or_insert_with(|| Route::new(&self.team, self.whole, own)));
    }

    /// Notes whether a force of this rank is not finite.
    pub fn note_broken(&self, broken: bool) {
        self.broken.fetch_or(broken, Ordering::Relaxed);
    }

    /// Notes where an own particle may be too fast around a step at which speeds are checked: no step is then taken at once.
    ///
    /// Velocities stand half a step before or behind it. They change little in half a step.
    pub fn note_speeds(&self, step: u64, dt: f64, velocities: &[DVec3]) {
        let near = [step - 1, step, step + 1];
        if near.iter().any(|step| step.is_multiple_of(self.limit.every)) {
            let largest2 = (NEAR_LIMIT * self.limit.largest / dt).powi(2);
            // The comparison is false for NaN.
            self.note_broken(!velocities.iter().all(|v| v.length_squared() <= largest2));
        }
    }

    /// Whether a force of any rank is not finite since all ranks asked last.
    pub fn is_broken(&self) -> bool {
        self.team.any(self.broken.swap(false, Ordering::Relaxed))
    }

    /// The largest |d|² of all ranks, σ², and the number of their far movers; `None` where a position or a force of any rank is
    /// not finite.
    pub fn motion(&self, own: &MotionSummary) -> Option<(f64, usize)> {
        let broken = self.broken.swap(false, Ordering::Relaxed);
        // Numbers that are not negative have the order of their bits. Behind them each rank has a word of its own.
        let mut words = vec![0; 2 + self.team.ranks()];
        words[0] = own.largest2.max(0.0).to_bits();
        words[1] = u64::from(!own.finite || broken);
        words[2 + self.team.rank()] = own.far.len() as u64;
        self.team.max(&mut words);
        let far = words[2..].iter().sum::<u64>() as usize;
        (words[1] == 0).then(|| (f64::from_bits(words[0]), far))
    }

    /// The lowest number of a particle that any rank names, if there is one.
    pub fn lowest(&self, own: Option<usize>) -> Option<usize> {
        let mut words = [own.map_or(0, |number| u64::MAX - number as u64)];
        self.team.max(&mut words);
        (words[0] > 0).then(|| (u64::MAX - words[0]) as usize)
    }
}

/// The part of the largest speed from which on steps are taken one by one, and checked exactly.
const NEAR_LIMIT: f64 = 0.8;
/// The fewest particles of a rank: some bundles of columns.
pub const LEAST_OF_A_RANK: usize = 500;
/// The fewest particles of a system that ranks share: below it, one bundle is the whole box.
pub const FEWEST_ON_RANKS: usize = SMALLEST_CUT;

/// The largest number of ranks that can share lists of `n` particles.
pub fn most_ranks(n: usize) -> usize {
    if n < FEWEST_ON_RANKS { 1 } else { n / LEAST_OF_A_RANK }
}

/// Runs of consecutive numbers.
fn runs_of(numbers: impl Iterator<Item = usize>) -> Vec<Range<usize>> {
    let mut numbers: Vec<usize> = numbers.collect();
    numbers.sort_unstable();
    let mut runs: Vec<Range<usize>> = Vec::new();
    for number in numbers {
        match runs.last_mut() {
            Some(run) if run.end == number => run.end += 1,
            _ => runs.push(number..number + 1),
        }
    }
    runs
}
