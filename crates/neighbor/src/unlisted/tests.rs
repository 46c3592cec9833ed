//! The search for unlisted pairs against all pairs.

use lennard_core::random::Streams;
use rand::RngExt;

use super::*;
use crate::sort::{ColumnTable, Positions, RowTable};

/// The particles of all pairs that are near now and that a list built at `built` lacks.
fn by_all_pairs(
    cell: &PeriodicBox,
    radius: f64,
    inner: f64,
    built: &[DVec3],
    now: &[DVec3],
) -> Vec<[u32; 2]> {
    let mut unlisted = Vec::new();
    for j in 0..now.len() {
        for i in 0..j {
            let r_ij = cell.minimum_image(now[i] - now[j]);
            let then = r_ij - ((now[i] - built[i]) - (now[j] - built[j]));
            if r_ij.length() <= inner && then.length() > radius {
                unlisted.push([i as u32, j as u32]);
            }
        }
    }
    unlisted.sort_unstable();
    unlisted
}

/// The same pairs, found by [`unlisted_pairs`] with these cells.
fn by_cells_of(
    (cell, radius, inner): (&PeriodicBox, f64, f64),
    (cells, particles): (Cells<'_>, &[u32]),
    (built, now): (&[DVec3], &[DVec3]),
) -> Vec<[u32; 2]> {
    let built: Vec<DVec3> = particles.iter().map(|p| built[*p as usize]).collect();
    let at = |slot: u32| now[particles[slot as usize] as usize];
    let squares: Vec<f64> =
        (0..).zip(&built).map(|(slot, built)| (at(slot) - *built).length_squared()).collect();
    let far2 = (0.5 * (radius - inner)).powi(2);
    let far: Vec<u32> =
        (0..).zip(&squares).filter(|(_, square)| **square > far2).map(|(slot, _)| slot).collect();
    let scale = DisplacementScale::new(far2);
    let packed: Vec<PackedDisplacement> = (0..)
        .zip(&squares)
        .zip(&built)
        .map(|((slot, square), built)| scale.pack(at(slot) - *built, *square))
        .collect();
    let n = built.len() as u32;
    let unlisted = |packed, partners: Option<Partners>| {
        let displacements = Displacements {
            cells,
            at: |slot| [at(slot), built[slot as usize]],
            packed,
            largest2: squares.iter().copied().fold(0.0, f64::max),
            partners: partners.as_ref(),
        };
        unlisted_pairs(cell, radius, inner, displacements, &far)
    };
    let found = unlisted(None, None);
    for packed in [None, Some(&packed[..])] {
        assert_eq!(found, unlisted(packed, None));
        // Ranks that own a range of slots each find all pairs together.
        let ends = [0, n / 3, n / 3, n / 2, n];
        let parts = ends
            .windows(2)
            .map(|ends| unlisted(packed, Some(Partners::new(cells, ends[0]..ends[1]))));
        let mut together = parts.collect::<Vec<_>>().concat();
        together.sort_unstable();
        together.dedup();
        assert_eq!(found, together);
    }
    assert!(found.is_sorted_by(|a, b| a < b));
    let particle = |slot: u32| particles[slot as usize];
    let mut unlisted: Vec<[u32; 2]> = found
        .into_iter()
        .map(|[i, j]| [particle(i), particle(j)])
        .map(|[i, j]| [i.min(j), i.max(j)])
        .collect();
    unlisted.sort_unstable();
    unlisted
}

/// The same pairs, found with both kinds of cells.
fn by_cells(
    cell: &PeriodicBox,
    radius: f64,
    inner: f64,
    built: &[DVec3],
    now: &[DVec3],
) -> Vec<[u32; 2]> {
    let mut columns = ColumnTable::default();
    columns.sort(cell, Positions::ById(built)).unwrap();
    let mut rows = RowTable::default();
    rows.sort(cell, Positions::ById(built), radius).unwrap();
    let (list, moves) = ((cell, radius, inner), (built, now));
    let found = by_cells_of(list, (Cells::Columns(&columns), &columns.particle), moves);
    assert_eq!(found, by_cells_of(list, (Cells::Rows(&rows), &rows.particle), moves));
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
fn a_pair_is_unlisted_that_came_from_beyond_the_list_to_within_the_cutoff() {
    let cell = PeriodicBox::new(DVec3::new(12.0, 20.0, 10.0)).unwrap();
    let misses = |apart, now| {
        let [built, now] = pair(apart, now);
        !by_cells(&cell, 2.8, 2.5, &built, &now).is_empty()
    };
    assert!(misses(2.81, 2.49));
    assert!(!misses(2.79, 2.49), "the list contains it");
    assert!(!misses(2.81, 2.51), "it is beyond the cutoff");
    let [built, now] = pair(2.81, 2.49);
    assert!(by_cells(&cell, 2.8, 2.5, &built[..1], &now[..1]).is_empty());
    assert!(by_cells(&cell, 2.8, 2.5, &[], &[]).is_empty());
}

#[test]
fn one_far_mover_is_enough() {
    let cell = PeriodicBox::new(DVec3::new(12.0, 20.0, 10.0)).unwrap();
    let built = [DVec3::ZERO, DVec3::new(11.0, 19.0, 2.4)];
    let toward = |way: f64| {
        let other = DVec3::new(-1.0, -1.0, 2.4);
        [other.normalize() * way, built[1]]
    };
    // 2.786 σ apart at the build.
    let unlisted = |radius, way| by_cells(&cell, radius, 2.5, &built, &toward(way));
    assert_eq!(unlisted(2.78, 0.29), [[0, 1]]);
    assert!(unlisted(2.78, 0.28).is_empty());
    assert!(unlisted(2.79, 0.29).is_empty());
}

#[test]
fn the_image_counts_that_is_near_now() {
    // The particles are half a box apart: one image was listed, and the other image has come near.
    let cell = PeriodicBox::new(DVec3::new(5.4, 20.0, 20.0)).unwrap();
    let now = [DVec3::ZERO, DVec3::X * 2.95];
    // Distances of the two images: 2.5 and 2.9 at the build, 2.95 and 2.45 now.
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
        assert!((50..290).contains(&found), "{found} of 300 lists lack a pair");
    }
}
