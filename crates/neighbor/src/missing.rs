//! The pairs that a list misses, looked for ahead of the particles that moved far since it was built.

use std::hint::black_box;
use std::ops::Range;

use glam::DVec3;
use lennard_core::PeriodicBox;
use lennard_core::parallel::map_ranges;

use crate::columns::FIXED_ROUNDING;
use crate::reach::Reach;
use crate::ways::{Way, Ways};

/// Particles sorted into columns of cells along z, as they were when a list was built.
pub trait Cells: Sync {
    /// Cells along each axis.
    fn count(&self) -> [u32; 3];

    /// The places of the particles in the column at (x, y), from one cell along z to another, both included.
    fn places(&self, x: u32, y: u32, z: [u32; 2]) -> Range<u32>;
}

/// How particles moved since a list was built.
#[derive(Debug)]
pub struct Moves<'a, C, A> {
    /// Which places were in each cell.
    pub cells: &'a C,
    /// Where the particle at a place is, unwrapped, σ.
    pub at: A,
    /// Where they were, by place, unwrapped, `[N]`, σ.
    pub built: &'a [DVec3],
    /// The same in few bytes, by place, `[N]`; they spare time where many moved far.
    pub ways: Option<&'a [Way]>,
    /// The largest |x − x⁰|², σ².
    pub largest2: f64,
}

impl<C: Cells, A: Fn(u32) -> DVec3> Moves<'_, C, A> {
    /// Where the particle at a place is now, and how it moved.
    #[inline(always)]
    fn of(&self, place: u32) -> (DVec3, DVec3) {
        let at = (self.at)(place);
        (at, at - self.built[place as usize])
    }
}

/// How far beyond the edge of a cell a particle of it may seem to lie, in cells: its place in the grid was found with
/// another rounding.
const BESIDE: f64 = 1e-3;

/// Particles that moved far that are looked at together, stage by stage: what memory is asked for then comes at the same
/// time, and not one after the other.
const TOGETHER: usize = 16;

/// The places of all pairs within `inner` σ of each other by an image that was farther than `radius` σ away when the
/// list was built, so that a list of that radius need not name them; the lower one first, ascending. `far` has
/// the places of all particles that moved by more than half the skin, which is the difference of the two distances.
///
/// With n the direction from one of the two to the other at the build, r ≥ r⁰ − (mᵢ − mⱼ)·n: two that came closer by more
/// than the skin moved by more than it along n, and one of them by more than half of it toward where the other was. So
/// the other is looked for ahead, in the part of a shell that a cone cuts out, cos θ ≥ ½·skin/|m|, among those whose own way
/// makes up for what is left: few did move so far, and most of these hardly farther.
#[must_use]
pub fn missed_pairs<C: Cells, A: Fn(u32) -> DVec3 + Sync>(
    cell: &PeriodicBox,
    radius: f64,
    inner: f64,
    moves: Moves<'_, C, A>,
    far: &[u32],
) -> Vec<[u32; 2]> {
    let lengths = cell.lengths();
    // With some care for roundings.
    let half = 0.5 * (radius - inner) * (1.0 - 1e-9);
    let search = Search {
        count: moves.cells.count(),
        farthest: moves.largest2.sqrt() * (1.0 + 1e-9),
        moves,
        lengths,
        boxes: 1.0 / lengths,
        ways: Ways::new(half * half),
        half,
        radius,
        inner,
    };
    let mut missed: Vec<[u32; 2]> = map_ranges(far.len(), |range| {
        let mut scratch = Scratch::default();
        for some in far[range].chunks(TOGETHER) {
            search.look_ahead_of(some, &mut scratch);
        }
        scratch.missed
    })
    .concat();
    missed.sort_unstable();
    missed.dedup();
    missed
}

/// A particle that moved far.
#[derive(Clone, Copy)]
struct Mover {
    place: u32,
    /// Where it is, σ.
    at: DVec3,
    /// x − x⁰, σ.
    moved: DVec3,
}

/// Who was ahead of a particle that moved far.
#[derive(Clone)]
struct Ahead<T> {
    /// The number of the particle among those that are looked at together.
    mover: u8,
    /// Those whose square is not larger did not move enough.
    below: u8,
    /// Where they are.
    who: T,
}

/// Slices of a column of cells: x, y, and from one to another along z, both included.
type Slices = (u32, u32, [u32; 2]);

/// What a search writes.
#[derive(Default)]
struct Scratch {
    movers: Vec<Mover>,
    slices: Vec<Ahead<Slices>>,
    places: Vec<Ahead<Range<u32>>>,
    /// The number of a mover, and the place of one who was ahead of it and may have come closer by the skin.
    pairs: Vec<(u8, u32)>,
    missed: Vec<[u32; 2]>,
}

struct Search<'a, C, A> {
    moves: Moves<'a, C, A>,
    count: [u32; 3],
    lengths: DVec3,
    /// One over the lengths.
    boxes: DVec3,
    ways: Ways,
    /// Half the skin, σ.
    half: f64,
    radius: f64,
    inner: f64,
    /// How far anybody moved, σ.
    farthest: f64,
}

impl<C: Cells, A: Fn(u32) -> DVec3> Search<'_, C, A> {
    /// Adds the pairs that may be missed ahead of the particles at some places, at most [`TOGETHER`].
    fn look_ahead_of(&self, far: &[u32], scratch: &mut Scratch) {
        let Scratch {
            movers,
            slices,
            places,
            pairs,
            missed,
        } = scratch;
        movers.clear();
        movers.extend(far.iter().map(|place| {
            let (at, moved) = self.moves.of(*place);
            Mover {
                place: *place,
                at,
                moved,
            }
        }));
        slices.clear();
        for (number, mover) in (0..).zip(&*movers) {
            self.find_ahead(number, mover, slices);
        }
        places.clear();
        places.extend(slices.iter().map(|Ahead { mover, below, who }| Ahead {
            mover: *mover,
            below: *below,
            who: self.moves.cells.places(who.0, who.1, who.2),
        }));
        let mut look_at = |mover: u8, other: u32| {
            let mover = &movers[usize::from(mover)];
            if self.is_missed(mover, other) {
                missed.push([mover.place.min(other), mover.place.max(other)]);
            }
        };
        match self.moves.ways {
            Some(ways) => {
                find_closer(movers, places, ways, pairs);
                for (mover, other) in pairs.drain(..) {
                    look_at(mover, other);
                }
            }
            None => {
                for Ahead { mover, who, .. } in places {
                    for other in who.clone() {
                        look_at(*mover, other);
                    }
                }
            }
        }
    }

    /// Adds the slices of those who were ahead of a particle.
    #[inline(always)]
    fn find_ahead(&self, number: u8, mover: &Mover, to: &mut Vec<Ahead<Slices>>) {
        let Mover { at, moved, .. } = *mover;
        let way = moved.length();
        if way <= self.half {
            return;
        }
        let before = at - moved;
        let shell = [self.radius, self.inner + way + self.farthest];
        let cosine = self.half / way;
        let below = self.ways.below((2.0 * self.half - way).max(0.0));
        let axis = |axis: usize| self.ahead(axis, before[axis], moved[axis] / way, cosine, shell);
        let [x, y, z] = [axis(0), axis(1), axis(2)];
        let [nx, ny, nz] = self.count;
        for x in x.around(nx) {
            for y in y.around(ny) {
                for z in z.runs(nz) {
                    to.push(Ahead {
                        mover: number,
                        below,
                        who: (x, y, z),
                    });
                }
            }
        }
    }

    /// Whether the particle at the place `other` is near now, and was too far away to be listed.
    #[inline(always)]
    fn is_missed(&self, mover: &Mover, other: u32) -> bool {
        let Mover {
            place, at, moved, ..
        } = *mover;
        let (at_other, moved_other) = self.moves.of(other);
        let now = self.nearest(at - at_other);
        // The same image, at the build.
        let then = now - (moved - moved_other);
        now.length_squared() <= self.inner * self.inner
            && then.length_squared() > self.radius * self.radius
            && other != place
    }

    /// The cells along an axis that a part of a shell reaches to: seen from `from` σ in the box, in directions whose cosine
    /// with one of component `along` is at least `cosine`.
    #[inline(always)]
    fn ahead(
        &self,
        axis: usize,
        from: f64,
        along: f64,
        cosine: f64,
        [low, high]: [f64; 2],
    ) -> Reach {
        let across = ((1.0 - along * along).max(0.0) * (1.0 - cosine * cosine).max(0.0)).sqrt();
        let most = if along >= cosine {
            1.0
        } else {
            along * cosine + across
        };
        let least = if -along >= cosine {
            -1.0
        } else {
            along * cosine - across
        };
        let end = most * if most > 0.0 { high } else { low };
        let begin = least * if least < 0.0 { high } else { low };
        let count = f64::from(self.count[axis]);
        let share = from * self.boxes[axis];
        let share = share - ((share + FIXED_ROUNDING) - FIXED_ROUNDING);
        let number = |way: f64| (share + way * self.boxes[axis]) * count;
        // Nothing reaches farther than two boxes, and casts of what is positive round down.
        let down = |number: f64| (number + 4.0 * count) as i64 - 4 * i64::from(self.count[axis]);
        Reach {
            first: down(number(begin) - BESIDE),
            last: down(number(end) + BESIDE),
        }
    }

    /// The shortest image of a difference, σ: [`PeriodicBox::minimum_image`] without a call for each axis.
    #[inline(always)]
    fn nearest(&self, d: DVec3) -> DVec3 {
        d - self.lengths * ((d * self.boxes + FIXED_ROUNDING) - FIXED_ROUNDING)
    }
}

/// Adds, of those who were ahead of some particles, who may have come closer by the skin.
fn find_closer(
    movers: &[Mover],
    places: &[Ahead<Range<u32>>],
    ways: &[Way],
    to: &mut Vec<(u8, u32)>,
) {
    // Nothing depends on what is read here, so that a processor waits for none of it.
    let first = |ahead: &Ahead<Range<u32>>| ways.get(ahead.who.start as usize);
    let squares = places.iter().filter_map(first).map(|way| way.square);
    black_box(squares.fold(0, |all, square| all ^ square));
    for Ahead { mover, below, who } in places {
        let way = ways[movers[usize::from(*mover)].place as usize];
        let ways = &ways[who.start as usize..who.end as usize];
        for (place, other) in who.clone().zip(ways) {
            if other.square > *below && way.may_be_closer(*other) {
                to.push((*mover, place));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ColumnTable, Given, RowTable, for_each_pair};
    use lennard_core::random::Streams;
    use rand::RngExt;

    /// The particles of all pairs that are near now and that a list built at `built` misses.
    fn by_all_pairs(
        cell: &PeriodicBox,
        radius: f64,
        inner: f64,
        built: &[DVec3],
        now: &[DVec3],
    ) -> Vec<[u32; 2]> {
        let mut missed = Vec::new();
        for_each_pair(cell, now, inner, |i, j, r_ij| {
            let then = r_ij - ((now[i] - built[i]) - (now[j] - built[j]));
            if then.length() > radius {
                missed.push([i.min(j) as u32, i.max(j) as u32]);
            }
        });
        missed.sort_unstable();
        missed
    }

    /// The same by [`missed_pairs`] with these cells.
    fn by_cells_of<C: Cells>(
        (cell, radius, inner): (&PeriodicBox, f64, f64),
        (cells, particles): (&C, &[u32]),
        (built, now): (&[DVec3], &[DVec3]),
    ) -> Vec<[u32; 2]> {
        let built: Vec<DVec3> = particles.iter().map(|p| built[*p as usize]).collect();
        let at = |place: u32| now[particles[place as usize] as usize];
        let squares: Vec<f64> = (0..)
            .zip(&built)
            .map(|(place, built)| (at(place) - *built).length_squared())
            .collect();
        let far2 = (0.5 * (radius - inner)).powi(2);
        let far: Vec<u32> = (0..)
            .zip(&squares)
            .filter(|(_, square)| **square > far2)
            .map(|(place, _)| place)
            .collect();
        let ways = Ways::new(far2);
        let ways: Vec<Way> = (0..)
            .zip(&squares)
            .zip(&built)
            .map(|((place, square), built)| ways.way(at(place) - *built, *square))
            .collect();
        let missed = |ways| {
            let moves = Moves {
                cells,
                at,
                built: &built,
                ways,
                largest2: squares.iter().copied().fold(0.0, f64::max),
            };
            missed_pairs(cell, radius, inner, moves, &far)
        };
        let (missed, by_ways) = (missed(None), missed(Some(&ways[..])));
        assert_eq!(missed, by_ways);
        assert!(missed.is_sorted_by(|a, b| a < b));
        let particle = |place: u32| particles[place as usize];
        let mut missed: Vec<[u32; 2]> = missed
            .into_iter()
            .map(|[i, j]| [particle(i), particle(j)])
            .map(|[i, j]| [i.min(j), i.max(j)])
            .collect();
        missed.sort_unstable();
        missed
    }

    /// The same with both kinds of cells.
    fn by_cells(
        cell: &PeriodicBox,
        radius: f64,
        inner: f64,
        built: &[DVec3],
        now: &[DVec3],
    ) -> Vec<[u32; 2]> {
        let mut columns = ColumnTable::default();
        columns.sort(cell, Given::ByParticle(built)).unwrap();
        let mut rows = RowTable::default();
        rows.sort(cell, Given::ByParticle(built), radius).unwrap();
        let (list, moves) = ((cell, radius, inner), (built, now));
        let found = by_cells_of(list, (&columns, &columns.particle), moves);
        assert_eq!(found, by_cells_of(list, (&rows, &rows.particle), moves));
        found
    }

    /// Two particles that came from `apart` σ to `now` σ along x, across the face of the box.
    fn pair(apart: f64, now: f64) -> [[DVec3; 2]; 2] {
        let at = DVec3::new(0.1, 3.0, 7.0);
        let other = at - DVec3::X * now + DVec3::new(0.0, 40.0, -20.0);
        let moved = DVec3::X * 0.5 * (apart - now);
        [[at + moved, other - moved], [at, other]]
    }

    #[test]
    fn a_pair_is_missed_that_came_from_beyond_the_list_to_within_the_cutoff() {
        let cell = PeriodicBox::new(DVec3::new(12.0, 20.0, 10.0)).unwrap();
        let misses = |apart, now| {
            let [built, now] = pair(apart, now);
            !by_cells(&cell, 2.8, 2.5, &built, &now).is_empty()
        };
        assert!(misses(2.81, 2.49));
        assert!(!misses(2.79, 2.49), "the list names it");
        assert!(!misses(2.81, 2.51), "it does not count yet");
        let [built, now] = pair(2.81, 2.49);
        assert!(by_cells(&cell, 2.8, 2.5, &built[..1], &now[..1]).is_empty());
        assert!(by_cells(&cell, 2.8, 2.5, &[], &[]).is_empty());
    }

    #[test]
    fn one_that_moved_alone_is_enough() {
        let cell = PeriodicBox::new(DVec3::new(12.0, 20.0, 10.0)).unwrap();
        let built = [DVec3::ZERO, DVec3::new(11.0, 19.0, 2.4)];
        let toward = |way: f64| {
            let other = DVec3::new(-1.0, -1.0, 2.4);
            [other.normalize() * way, built[1]]
        };
        // 2.786 σ apart at the build.
        let missed = |radius, way| by_cells(&cell, radius, 2.5, &built, &toward(way));
        assert_eq!(missed(2.78, 0.29), [[0, 1]]);
        assert!(missed(2.78, 0.28).is_empty());
        assert!(missed(2.79, 0.29).is_empty());
    }

    #[test]
    fn the_image_counts_that_is_near_now() {
        // Half a box apart, one image was listed, and the other one has come near.
        let cell = PeriodicBox::new(DVec3::new(5.4, 20.0, 20.0)).unwrap();
        let now = [DVec3::ZERO, DVec3::X * 2.95];
        // Then 2.5 one way and 2.9 the other, now 2.95 and 2.45.
        let built = [DVec3::X * 0.1, DVec3::X * 2.6];
        assert_eq!(by_cells(&cell, 2.7, 2.5, &built, &now), [[0, 1]]);
    }

    #[test]
    fn cells_find_what_all_pairs_find() {
        let mut random = Streams::new(1967).sequential("missing");
        for (lengths, n) in [
            (DVec3::new(9.0, 30.0, 5.2), 300),
            (DVec3::new(5.1, 5.2, 5.3), 60),
            (DVec3::new(40.0, 11.0, 12.0), 800),
        ] {
            let cell = PeriodicBox::new(lengths).unwrap();
            let mut found = 0;
            for sample in 0..300 {
                let width = 0.02 + 0.001 * f64::from(sample % 60);
                let mut vector =
                    |width: f64| DVec3::from([0; 3].map(|_| random.random_range(-width..width)));
                let built: Vec<DVec3> = (0..n).map(|_| vector(1.5) * lengths).collect();
                let now: Vec<DVec3> = built.iter().map(|at| *at + vector(width)).collect();
                let all = by_all_pairs(&cell, 2.54, 2.5, &built, &now);
                assert_eq!(by_cells(&cell, 2.54, 2.5, &built, &now), all);
                found += usize::from(!all.is_empty());
            }
            assert!((50..290).contains(&found), "{found} of 300 miss a pair");
        }
    }
}
