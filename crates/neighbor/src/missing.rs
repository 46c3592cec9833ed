//! Whether a list misses a pair, looked for ahead of the particles that moved far since it was built.

use std::ops::Range;

use glam::DVec3;
use lennard_core::PeriodicBox;
use lennard_core::parallel::all_pieces;

use crate::columns::FIXED_ROUNDING;

/// Particles sorted into columns of cells along z, as they were when a list was built.
pub trait Cells: Sync {
    /// Cells along each axis.
    fn count(&self) -> [u32; 3];

    /// The places of the particles in the column at (x, y), from one cell along z to another, both included.
    fn places(&self, x: u32, y: u32, z: [u32; 2]) -> Range<u32>;
}

/// How particles moved since a list was built.
#[derive(Debug, Clone, Copy)]
pub struct Moves<'a> {
    /// Where they are, by particle, unwrapped, `[N]`, σ.
    pub positions: &'a [DVec3],
    /// The particle at each place, `[N]`.
    pub particle: &'a [u32],
    /// Where they were, by place, unwrapped, `[N]`, σ.
    pub built: &'a [DVec3],
}

impl Moves<'_> {
    /// Where the particle at a place is now, and how it moved.
    #[inline(always)]
    fn of(&self, place: u32) -> (DVec3, DVec3) {
        let at = self.positions[self.particle[place as usize] as usize];
        (at, at - self.built[place as usize])
    }
}

/// How far beyond the edge of a cell a particle of it may seem to lie, in cells: its place in the grid was found with
/// another rounding.
const BESIDE: f64 = 1e-3;

/// Whether two particles are within `inner` σ of each other, by an image that was farther than `radius` σ away when the
/// list was built, so that a list of that radius does not name it. `far` has the places of all particles that moved by more
/// than half the skin, which is the difference of the two distances.
///
/// With n the direction from one of the two to the other at the build, r ≥ r⁰ − (mᵢ − mⱼ)·n: two that came closer by more
/// than the skin moved by more than it along n, and one of them by more than half of it toward where the other was. So
/// the other is looked for ahead, in the part of a shell that a cone cuts out, cos θ ≥ ½·skin/|m|: few did move so far, and
/// most of these hardly farther.
#[must_use]
pub fn misses_a_pair<C: Cells>(
    cell: &PeriodicBox,
    radius: f64,
    inner: f64,
    moves: Moves<'_>,
    cells: &C,
    far: &[u32],
) -> bool {
    let moved2 = |place: &u32| moves.of(*place).1.length_squared();
    let farthest = far.iter().map(moved2).fold(0.0, f64::max).sqrt();
    let lengths = cell.lengths();
    let search = Search {
        moves,
        cells,
        count: cells.count(),
        lengths,
        boxes: 1.0 / lengths,
        // With some care for roundings.
        half: 0.5 * (radius - inner) * (1.0 - 1e-9),
        radius,
        inner,
        farthest,
    };
    !all_pieces(far.len(), |range| {
        !far[range]
            .iter()
            .any(|place| search.misses_ahead_of(*place))
    })
}

struct Search<'a, C> {
    moves: Moves<'a>,
    cells: &'a C,
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

impl<C: Cells> Search<'_, C> {
    /// Whether the list misses somebody ahead of the particle at a place.
    fn misses_ahead_of(&self, place: u32) -> bool {
        let (at, moved) = self.moves.of(place);
        let way = moved.length();
        if way <= self.half {
            return false;
        }
        let before = at - moved;
        let shell = [self.radius, self.inner + way + self.farthest];
        let cosine = self.half / way;
        let axis = |axis: usize| self.ahead(axis, before[axis], moved[axis] / way, cosine, shell);
        let [x, y, z] = [axis(0), axis(1), axis(2)];
        let nobody_comes_around = 2.0 * shell[1] * (1.0 + 1e-9) < self.lengths.min_element();
        let is_missed = |other: u32| {
            if nobody_comes_around {
                let then2 = self
                    .nearest(before - self.moves.built[other as usize])
                    .length_squared();
                if then2 <= self.radius * self.radius || then2 > shell[1] * shell[1] * (1.0 + 1e-9)
                {
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
        };
        let [nx, ny, nz] = self.count;
        x.around(nx).any(|x| {
            y.around(ny).any(|y| {
                z.runs(nz)
                    .into_iter()
                    .flatten()
                    .any(|z| self.cells.places(x, y, z).any(is_missed))
            })
        })
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

    /// The shortest image of a difference, σ.
    #[inline(always)]
    fn nearest(&self, d: DVec3) -> DVec3 {
        d - self.lengths * ((d * self.boxes + FIXED_ROUNDING) - FIXED_ROUNDING)
    }
}

/// Cells along an axis, both included, counted beyond the faces of the box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Reach {
    first: i64,
    last: i64,
}

impl Reach {
    /// Where there are more than all, all, and each once.
    fn among(self, count: u32) -> Self {
        let all = i64::from(count);
        if self.last - self.first + 1 < all {
            return self;
        }
        Self {
            first: 0,
            last: all - 1,
        }
    }

    /// The cells in the box.
    fn around(self, count: u32) -> impl Iterator<Item = u32> {
        let Self { first, last } = self.among(count);
        (first..=last).map(move |k| k.rem_euclid(i64::from(count)) as u32)
    }

    /// The cells in the box, in one run or two.
    fn runs(self, count: u32) -> [Option<[u32; 2]>; 2] {
        let Self { first, last } = self.among(count);
        let [a, b] = [first, last].map(|k| k.rem_euclid(i64::from(count)) as u32);
        if a <= b {
            [Some([a, b]), None]
        } else {
            [Some([a, count - 1]), Some([0, b])]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ColumnTable, RowTable};
    use lennard_core::random::Streams;
    use rand::RngExt;

    /// Whether a pair is missed by a list built at `built`, looked for among all pairs and images.
    fn by_all_pairs(
        lengths: DVec3,
        radius: f64,
        inner: f64,
        built: &[DVec3],
        now: &[DVec3],
    ) -> bool {
        let n = built.len();
        (0..n).any(|i| {
            (0..n).filter(|j| *j != i).any(|j| {
                let d = now[i] - now[j];
                let d = d - lengths * (d / lengths).round();
                let then = d - ((now[i] - built[i]) - (now[j] - built[j]));
                d.length() <= inner && then.length() > radius
            })
        })
    }

    /// The same by [`misses_a_pair`] with cells that have these particles at their places.
    fn by_cells_of<C: Cells>(
        (cell, radius, inner): (&PeriodicBox, f64, f64),
        (particle, cells): (&[u32], &C),
        (built, now): (&[DVec3], &[DVec3]),
    ) -> bool {
        let built: Vec<DVec3> = particle.iter().map(|p| built[*p as usize]).collect();
        let moves = Moves {
            positions: now,
            particle,
            built: &built,
        };
        let half = 0.5 * (radius - inner);
        let far: Vec<u32> = (0..particle.len() as u32)
            .filter(|place| moves.of(*place).1.length() > half)
            .collect();
        misses_a_pair(cell, radius, inner, moves, cells, &far)
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
        columns.sort(cell, built).unwrap();
        let mut rows = RowTable::default();
        rows.sort(cell, built, radius).unwrap();
        let (list, moves) = ((cell, radius, inner), (built, now));
        let found = by_cells_of(list, (&columns.particle, &columns), moves);
        assert_eq!(found, by_cells_of(list, (&rows.particle, &rows), moves));
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
                let all = by_all_pairs(lengths, 2.54, 2.5, &built, &now);
                assert_eq!(by_cells(&cell, 2.54, 2.5, &built, &now), all);
                found += usize::from(all);
            }
            assert!((50..290).contains(&found), "{found} of 300 miss a pair");
        }
    }

    #[test]
    fn a_reach_beyond_the_faces_is_taken_around_and_no_cell_comes_twice() {
        let around = |first, last| Reach { first, last }.around(5).collect::<Vec<_>>();
        assert_eq!(around(-2, 1), [3, 4, 0, 1]);
        assert_eq!(around(4, 8), [0, 1, 2, 3, 4]);
        assert_eq!(around(-7, 9), [0, 1, 2, 3, 4]);
        let runs = |first, last| Reach { first, last }.runs(5);
        assert_eq!(runs(-2, 1), [Some([3, 4]), Some([0, 1])]);
        assert_eq!(runs(6, 8), [Some([1, 3]), None]);
        assert_eq!(runs(-1, 6), [Some([0, 4]), None]);
    }
}
