//! Whether a list misses a pair, looked for among the particles that moved far since it was built.

use glam::{DVec3, IVec3};
use lennard_core::PeriodicBox;

/// A particle that moved far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Far {
    /// Where it is, unwrapped, σ.
    pub at: DVec3,
    /// How it moved since the build, σ.
    pub moved: DVec3,
}

/// Up to this many pairs are looked at one after another: a grid of cells costs as much.
const FEW_PAIRS: usize = 2000;

/// Whether two of these are within `inner` σ of each other, by an image that was farther than `radius` σ away when the
/// list was built, so that a list of that radius does not name it.
///
/// Two that came closer by more than the skin, which is the difference of the two distances, have moved by more than it
/// relative to each other, and one of them by more than half of it: few did.
#[must_use]
pub fn misses_a_pair(cell: &PeriodicBox, radius: f64, inner: f64, far: &[Far]) -> bool {
    // With some care for roundings.
    let skin = (radius - inner) * (1.0 - 1e-9);
    let skin2 = skin * skin;
    let most2 = far
        .iter()
        .map(|f| f.moved.length_squared())
        .fold(0.0, f64::max);
    let least2 = (skin - most2.sqrt()).max(0.0).powi(2) * (1.0 - 1e-9);
    let far: Vec<Far> = far
        .iter()
        .filter(|f| f.moved.length_squared() >= least2)
        .copied()
        .collect();
    let moved_most = |i: &usize| 4.0 * far[*i].moved.length_squared() > skin2;
    let leaders: Vec<usize> = (0..far.len()).filter(moved_most).collect();
    let (inner2, radius2) = (inner * inner, radius * radius);
    let is_missed = |a: &Far, b: &Far| {
        let apart = a.moved - b.moved;
        if apart.length_squared() <= skin2 {
            return false;
        }
        let now = cell.minimum_image(a.at - b.at);
        // The same image, at the build.
        let then = now - apart;
        now.length_squared() <= inner2 && then.length_squared() > radius2
    };
    if leaders.len() * far.len() <= FEW_PAIRS {
        return leaders.iter().any(|i| {
            let mut others = (0..far.len()).filter(|j| j != i);
            others.any(|j| is_missed(&far[*i], &far[j]))
        });
    }
    let grid = Grid::new(cell, inner, &far);
    leaders.iter().any(|i| {
        grid.cells_around(*i).any(|members| {
            let mut others = members.iter().map(|j| *j as usize).filter(|j| j != i);
            others.any(|j| is_missed(&far[*i], &far[j]))
        })
    })
}

/// The particles that moved far, by cells whose sides are at least the distance within which pairs are looked for.
struct Grid {
    counts: IVec3,
    /// Cell of each.
    home: Vec<IVec3>,
    /// Where the members of each cell begin, and the end.
    first: Vec<u32>,
    members: Vec<u32>,
}

impl Grid {
    fn new(cell: &PeriodicBox, inner: f64, far: &[Far]) -> Self {
        let lengths = cell.lengths();
        // More cells than particles would cost more than they save.
        let emptiest = (lengths.element_product() / far.len().max(1) as f64).cbrt();
        let count = |length: f64| {
            let count = (length / inner.max(emptiest)).floor();
            // Of fewer than three, all are next to each other.
            if count < 3.0 { 1 } else { count as i32 }
        };
        let counts = IVec3::new(count(lengths.x), count(lengths.y), count(lengths.z));
        let home_of = |far: &Far| {
            let share = far.at / lengths;
            let home = ((share - share.floor()) * counts.as_dvec3()).as_ivec3();
            home.min(counts - IVec3::ONE)
        };
        let home: Vec<IVec3> = far.iter().map(home_of).collect();
        let mut grid = Self {
            counts,
            home,
            first: vec![0; counts.element_product() as usize + 2],
            members: vec![0; far.len()],
        };
        // Two ahead: after the members are placed, entry c + 1 has moved from the first of c to that of c + 1.
        for home in &grid.home {
            grid.first[number(*home, counts) + 2] += 1;
        }
        let mut before = 0;
        for first in &mut grid.first {
            before += *first;
            *first = before;
        }
        for (i, home) in grid.home.iter().enumerate() {
            let place = &mut grid.first[number(*home, counts) + 1];
            grid.members[*place as usize] = i as u32;
            *place += 1;
        }
        grid
    }

    /// The members of the cell of the `i`th and of each cell next to it.
    fn cells_around(&self, i: usize) -> impl Iterator<Item = &[u32]> {
        let reach = |axis: usize| {
            if self.counts[axis] == 1 {
                0..=0
            } else {
                -1..=1
            }
        };
        let home = self.home[i];
        let offsets = reach(0).flat_map(move |x| {
            reach(1).flat_map(move |y| reach(2).map(move |z| IVec3::new(x, y, z)))
        });
        offsets.map(move |offset| {
            let next = (home + offset).rem_euclid(self.counts);
            let cell = number(next, self.counts);
            let members = self.first[cell] as usize..self.first[cell + 1] as usize;
            &self.members[members]
        })
    }
}

fn number(cell: IVec3, counts: IVec3) -> usize {
    ((cell.x * counts.y + cell.y) * counts.z + cell.z) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two particles that came from `apart` σ to `now` σ along x, across the face of the box.
    fn pair(apart: f64, now: f64) -> [Far; 2] {
        let moved = DVec3::X * 0.5 * (apart - now);
        let at = DVec3::new(0.1, 3.0, 7.0);
        let other = at - DVec3::X * now + DVec3::new(0.0, 40.0, -20.0);
        [Far { at, moved: -moved }, Far { at: other, moved }]
    }

    #[test]
    fn a_pair_is_missed_that_came_from_beyond_the_list_to_within_the_cutoff() {
        let cell = PeriodicBox::new(DVec3::new(12.0, 20.0, 10.0)).unwrap();
        let misses = |apart, now| misses_a_pair(&cell, 2.8, 2.5, &pair(apart, now));
        assert!(misses(2.81, 2.49));
        assert!(!misses(2.79, 2.49), "the list names it");
        assert!(!misses(2.81, 2.51), "it does not count yet");
        assert!(!misses_a_pair(&cell, 2.8, 2.5, &[]));
        assert!(!misses_a_pair(&cell, 2.8, 2.5, &pair(2.81, 2.49)[..1]));
    }

    #[test]
    fn the_image_counts_that_is_near_now() {
        // Half a box apart, one image was listed, and the other one has come near.
        let cell = PeriodicBox::new(DVec3::new(5.4, 20.0, 20.0)).unwrap();
        let a = Far {
            at: DVec3::ZERO,
            moved: DVec3::X * -0.1,
        };
        let b = Far {
            at: DVec3::X * 2.95,
            moved: DVec3::X * 0.35,
        };
        // Then 2.5 one way and 2.9 the other, now 2.95 and 2.45.
        assert!(misses_a_pair(&cell, 2.7, 2.5, &[a, b]));
    }

    #[test]
    fn cells_find_what_all_pairs_find() {
        let cell = PeriodicBox::new(DVec3::new(9.0, 30.0, 5.2)).unwrap();
        let noise = |k: i32| ((f64::from(k) * 12.9898).sin() * 43_758.545_3).rem_euclid(1.0);
        let mut found = 0;
        for sample in 0..200 {
            let far: Vec<Far> = (0..50)
                .map(|i| {
                    let k = 31 * sample + 7 * i;
                    let at = DVec3::new(noise(k), noise(k + 501), noise(k + 907));
                    let moved = DVec3::new(noise(k + 77), noise(k + 333), noise(k + 555));
                    Far {
                        at: (at * 3.0 - DVec3::ONE) * cell.lengths(),
                        moved: (moved - DVec3::splat(0.5)) * 0.06,
                    }
                })
                .collect();
            let all = far.iter().enumerate().any(|(i, a)| {
                far[i + 1..]
                    .iter()
                    .any(|b| misses_a_pair(&cell, 2.52, 2.5, &[*a, *b]))
            });
            assert_eq!(misses_a_pair(&cell, 2.52, 2.5, &far), all);
            found += usize::from(all);
        }
        assert!((20..180).contains(&found), "{found} of 200 miss a pair");
    }
}
