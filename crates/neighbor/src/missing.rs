//! Whether a list misses a pair, looked for ahead of the particles that moved far since it was built.

use std::hint::black_box;
use std::ops::Range;

use glam::DVec3;
use lennard_core::PeriodicBox;
use lennard_core::parallel::all_pieces;

use crate::columns::FIXED_ROUNDING;
use crate::reach::Reach;

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

/// Particles that moved far whose surroundings are found before any of them is looked at: what memory is asked for then
/// comes at the same time, and not one after the other.
const TOGETHER: usize = 16;

/// Whether two particles are within `inner` σ of each other, by an image that was farther than `radius` σ away when the
/// list was built, so that a list of that radius does not name it. `far` has the places of all particles that moved by more
/// than half the skin, which is the difference of the two distances.
///
/// With n the direction from one of the two to the other at the build, r ≥ r⁰ − (mᵢ − mⱼ)·n: two that came closer by more
/// than the skin moved by more than it along n, and one of them by more than half of it toward where the other was. So
/// the other is looked for ahead, in the part of a shell that a cone cuts out, cos θ ≥ ½·skin/|m|: few did move so far, and
/// most of these hardly farther.
#[must_use]
pub fn misses_a_pair<C: Cells, A: Fn(u32) -> DVec3 + Sync>(
    cell: &PeriodicBox,
    radius: f64,
    inner: f64,
    moves: Moves<'_, C, A>,
    far: &[u32],
) -> bool {
    let moved2 = |place: &u32| moves.of(*place).1.length_squared();
    let farthest = far.iter().map(moved2).fold(0.0, f64::max).sqrt();
    let lengths = cell.lengths();
    let search = Search {
        count: moves.cells.count(),
        moves,
        lengths,
        boxes: 1.0 / lengths,
        // With some care for roundings.
        half: 0.5 * (radius - inner) * (1.0 - 1e-9),
        radius,
        inner,
        farthest,
    };
    !all_pieces(far.len(), |range| {
        let mut ahead = Vec::new();
        !far[range]
            .chunks(TOGETHER)
            .any(|some| search.misses_ahead_of(some, &mut ahead))
    })
}

/// A particle that moved far.
#[derive(Clone, Copy)]
struct Mover {
    place: u32,
    /// Where it is, σ.
    at: DVec3,
    /// How it moved, σ.
    moved: DVec3,
    /// How far from where it was one may have been at the build that is near to it now, σ.
    farthest: f64,
    /// Whether nobody that far away comes around the box.
    nobody_comes_around: bool,
}

struct Search<'a, C, A> {
    moves: Moves<'a, C, A>,
    count: [u32; 3],
    lengths: DVec3,
    /// One over the lengths.
    boxes: DVec3,
    /// Half the skin, σ.
    half: f64,
    radius: f64,
    inner: f64,
    /// How far anybody moved, σ.
    farthest: f64,
}

impl<C: Cells, A: Fn(u32) -> DVec3> Search<'_, C, A> {
    /// Whether the list misses somebody ahead of one of the particles at some places; `ahead` is scratch.
    fn misses_ahead_of(&self, places: &[u32], ahead: &mut Vec<(Mover, Range<u32>)>) -> bool {
        ahead.clear();
        for place in places {
            self.look_ahead_of(*place, ahead);
        }
        // Nothing depends on what is read here, so that a processor waits for none of it.
        let first = |(_, others): &(Mover, Range<u32>)| {
            let first = self.moves.built.get(others.start as usize);
            first.map_or(0, |at| at.x.to_bits())
        };
        black_box(ahead.iter().map(first).fold(0, |all, bits| all ^ bits));
        ahead
            .iter()
            .any(|(mover, others)| others.clone().any(|other| self.is_missed(mover, other)))
    }

    /// Adds the places of those who were ahead of the particle at a place.
    fn look_ahead_of(&self, place: u32, ahead: &mut Vec<(Mover, Range<u32>)>) {
        let (at, moved) = self.moves.of(place);
        let way = moved.length();
        if way <= self.half {
            return;
        }
        let before = at - moved;
        let farthest = self.inner + way + self.farthest;
        let shell = [self.radius, farthest];
        let cosine = self.half / way;
        let axis = |axis: usize| self.ahead(axis, before[axis], moved[axis] / way, cosine, shell);
        let [x, y, z] = [axis(0), axis(1), axis(2)];
        let mover = Mover {
            place,
            at,
            moved,
            farthest,
            nobody_comes_around: 2.0 * farthest * (1.0 + 1e-9) < self.lengths.min_element(),
        };
        let [nx, ny, nz] = self.count;
        for x in x.around(nx) {
            for y in y.around(ny) {
                for z in z.runs(nz) {
                    ahead.push((mover, self.moves.cells.places(x, y, z)));
                }
            }
        }
    }

    /// Whether the particle at the place `other` is near now, and was too far away to be listed.
    #[inline(always)]
    fn is_missed(&self, mover: &Mover, other: u32) -> bool {
        let Mover {
            place,
            at,
            moved,
            farthest,
            nobody_comes_around,
        } = *mover;
        if nobody_comes_around {
            let before = at - moved;
            let then2 = self
                .nearest(before - self.moves.built[other as usize])
                .length_squared();
            if then2 <= self.radius * self.radius || then2 > farthest * farthest * (1.0 + 1e-9) {
                return false;
            }
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ColumnTable, Given, RowTable, for_each_pair};
    use lennard_core::random::Streams;
    use rand::RngExt;

    /// Whether a list built at `built` misses one of the pairs that are near now.
    fn by_all_pairs(
        cell: &PeriodicBox,
        radius: f64,
        inner: f64,
        built: &[DVec3],
        now: &[DVec3],
    ) -> bool {
        let mut misses = false;
        for_each_pair(cell, now, inner, |i, j, r_ij| {
            let then = r_ij - ((now[i] - built[i]) - (now[j] - built[j]));
            misses |= then.length() > radius;
        });
        misses
    }

    /// The same by [`misses_a_pair`] with these cells.
    fn by_cells_of<C: Cells>(
        (cell, radius, inner): (&PeriodicBox, f64, f64),
        (cells, particles): (&C, &[u32]),
        (built, now): (&[DVec3], &[DVec3]),
    ) -> bool {
        let built: Vec<DVec3> = particles.iter().map(|p| built[*p as usize]).collect();
        let moves = Moves {
            cells,
            at: |place| now[particles[place as usize] as usize],
            built: &built,
        };
        let half = 0.5 * (radius - inner);
        let far: Vec<u32> = (0..particles.len() as u32)
            .filter(|place| moves.of(*place).1.length() > half)
            .collect();
        misses_a_pair(cell, radius, inner, moves, &far)
    }

    /// The same with both kinds of cells.
    fn by_cells(
        cell: &PeriodicBox,
        radius: f64,
        inner: f64,
        built: &[DVec3],
        now: &[DVec3],
    ) -> bool {
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
            by_cells(&cell, 2.8, 2.5, &built, &now)
        };
        assert!(misses(2.81, 2.49));
        assert!(!misses(2.79, 2.49), "the list names it");
        assert!(!misses(2.81, 2.51), "it does not count yet");
        let [built, now] = pair(2.81, 2.49);
        assert!(!by_cells(&cell, 2.8, 2.5, &built[..1], &now[..1]));
        assert!(!by_cells(&cell, 2.8, 2.5, &[], &[]));
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
        assert!(by_cells(&cell, 2.78, 2.5, &built, &toward(0.29)));
        assert!(!by_cells(&cell, 2.78, 2.5, &built, &toward(0.28)));
        assert!(!by_cells(&cell, 2.79, 2.5, &built, &toward(0.29)));
    }

    #[test]
    fn the_image_counts_that_is_near_now() {
        // Half a box apart, one image was listed, and the other one has come near.
        let cell = PeriodicBox::new(DVec3::new(5.4, 20.0, 20.0)).unwrap();
        let now = [DVec3::ZERO, DVec3::X * 2.95];
        // Then 2.5 one way and 2.9 the other, now 2.95 and 2.45.
        let built = [DVec3::X * 0.1, DVec3::X * 2.6];
        assert!(by_cells(&cell, 2.7, 2.5, &built, &now));
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
                found += usize::from(all);
            }
            assert!((50..290).contains(&found), "{found} of 300 miss a pair");
        }
    }
}
