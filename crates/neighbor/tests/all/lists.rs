//! Lists against the brute-force search, after the particles have moved.

use std::collections::BTreeSet;

use glam::DVec3;
use lennard_core::PeriodicBox;
use lennard_neighbor::{
    Belongs, Block, ClusterList, GridError, Images, NeighborList, PairList, Positions, Reach,
    ScalarScanner, with_rounding,
};
use proptest::prelude::*;

/// The pairs within a radius, σ, found without a grid and without a list.
fn brute_force_pairs(cell: &PeriodicBox, positions: &[DVec3], radius: f64) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    for (j, rj) in positions.iter().enumerate() {
        for (i, ri) in positions[..j].iter().enumerate() {
            if cell.minimum_image(*ri - *rj).length_squared() <= radius * radius {
                pairs.push((i as u32, j as u32));
            }
        }
    }
    pairs
}

/// Reproducible numbers in [0, 1): Weyl's sequence, with one irrational number per axis.
fn scatter(n: usize, lengths: DVec3, seed: f64) -> Vec<DVec3> {
    let step = DVec3::new(0.819_172_513, 0.671_043_607, 0.549_700_478);
    (0..n).map(|i| ((i as f64 + 0.5 + seed) * step).fract() * lengths).collect()
}

fn build_rows(
    list: &mut NeighborList,
    cell: &PeriodicBox,
    radius: f64,
    positions: Positions<'_>,
) -> Result<(), GridError> {
    let built = list.build(cell, radius, positions, &ScalarScanner);
    assert!(built.is_err() || list.is_valid());
    built
}

fn build_clusters(
    list: &mut ClusterList,
    cell: &PeriodicBox,
    [r_cut, r_list]: [f64; 2],
    positions: Positions<'_>,
) -> Result<(), GridError> {
    let reach = Reach { r_cut, r_list };
    let built = list.build(cell, reach, positions, &ScalarScanner);
    assert!(built.is_err() || list.is_valid());
    built
}

fn row_list(cell: &PeriodicBox, radius: f64, images: Images, at: &[DVec3]) -> NeighborList {
    let mut list = NeighborList::new(images, 8);
    build_rows(&mut list, cell, radius, Positions::ById(at)).unwrap();
    list
}

fn cluster_list(cell: &PeriodicBox, radii: [f64; 2], at: &[DVec3]) -> ClusterList {
    let mut list = ClusterList::default();
    build_clusters(&mut list, cell, radii, Positions::ById(at)).unwrap();
    list
}

fn pairs_of(list: &NeighborList) -> BTreeSet<(u32, u32)> {
    let mut pairs = BTreeSet::new();
    for (i, neighbors) in list.neighbors().iter().enumerate() {
        for j in neighbors {
            pairs.insert((i as u32, *j));
        }
    }
    pairs
}

/// A pair within the radius that is listed for one of the two alone. Beyond the radius lies a margin for roundings, in which
/// one may know of the other and not the other way bounds.
fn listed_by_one_alone(
    cell: &PeriodicBox,
    at: &[DVec3],
    radius: f64,
    listed: &BTreeSet<(u32, u32)>,
) -> Option<(u32, u32)> {
    let near = |(i, j): &(u32, u32)| {
        let r_ij = at[*i as usize] - at[*j as usize];
        cell.minimum_image(r_ij).length() <= radius
    };
    let mut listed_once = listed.iter().filter(|(i, j)| !listed.contains(&(*j, *i)));
    listed_once.find(|pair| near(pair)).copied()
}

#[test]
fn both_ends_list_each_other_except_inside_the_margin_for_rounding() {
    // The property below once met this box: only one end lists a pair 1.9e-5 σ beyond the radius.
    let sides = DVec3::new(9.217523365621945, 7.082424794350008, 12.099558010694189);
    let (radius, filling) = (3.442004854113472, 0.36792482416237093);
    let (seed, origin) = (444.94401692190166, 48.291509618035214);
    let cell = PeriodicBox::new(sides).unwrap();
    let positions: Vec<DVec3> =
        scatter(265, sides * filling, seed).into_iter().map(|r| r + DVec3::splat(origin)).collect();
    let list = row_list(&cell, radius, Images::Ghosts, &positions);
    let listed = pairs_of(&list);
    assert_eq!(listed_by_one_alone(&cell, &positions, radius, &listed), None);
    assert_eq!(
        listed_by_one_alone(&cell, &positions, radius + 2e-5, &listed),
        Some((264, 1)),
        "the pair inside the margin"
    );
}

#[test]
fn a_bad_position_is_named_and_does_not_hang() {
    let cell = PeriodicBox::new(DVec3::splat(9.0)).unwrap();
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300] {
        let mut positions = scatter(50, cell.lengths(), 0.0);
        positions[17].z = bad;
        let mut list = NeighborList::new(Images::Ghosts, 8);
        let error = build_rows(&mut list, &cell, 3.0, Positions::ById(&positions)).unwrap_err();
        assert!(error.to_string().contains("17"));
    }
}

#[test]
fn lists_built_again_by_place_are_those_of_positions_by_particle() {
    for (sides, n) in [
        (DVec3::new(9.0, 8.0, 11.0), 700),
        (DVec3::new(6.0, 30.0, 20.0), 3000),
        // Several particles in most cells of the sort.
        (DVec3::splat(3000.0), 60),
        (DVec3::splat(5.5), 1),
    ] {
        let cell = PeriodicBox::new(sides).unwrap();
        let filled = if n == 60 { DVec3::splat(2.0) } else { sides };
        let before = scatter(n, filled, 0.0);
        let mut clusters = cluster_list(&cell, [2.5, 2.7], &before);
        let mut rows = row_list(&cell, 2.7, Images::Ghosts, &before);
        // Displacements exceed a cell, and some lead out of the box.
        let now: Vec<DVec3> = before
            .iter()
            .zip(scatter(n, DVec3::splat(3.0), 77.0))
            .map(|(r, way)| *r + way - DVec3::splat(1.5))
            .collect();
        let new_clusters = cluster_list(&cell, [2.5, 2.7], &now);
        let new_rows = row_list(&cell, 2.7, Images::Ghosts, &now);

        let by_slot = |particles: &[u32]| -> Vec<DVec3> {
            particles.iter().map(|p| now[*p as usize]).collect()
        };
        let (slots, row_slots) = (clusters.table().particle.clone(), rows.table().particle.clone());
        let (by_slot, by_row_slot) = (by_slot(&slots), by_slot(&row_slots));
        let by_slot = Positions::BySlot(&by_slot);
        build_clusters(&mut clusters, &cell, [2.5, 2.7], by_slot).unwrap();
        let by_slot = Positions::BySlot(&by_row_slot);
        build_rows(&mut rows, &cell, 2.7, by_slot).unwrap();
        for (table, source, slots) in [
            (&clusters.table().particle, clusters.table().source(), &slots),
            (&rows.table().particle, rows.table().source(), &row_slots),
        ] {
            for (particle, source) in table.iter().zip(source) {
                assert_eq!(*particle, slots[*source as usize]);
            }
        }
        assert_eq!(clusters.table().particle, new_clusters.table().particle);
        assert_eq!(clusters.table().at(), new_clusters.table().at());
        assert_eq!(clusters.chunks(), new_clusters.chunks());
        assert_eq!(rows.table().particle, new_rows.table().particle);
        assert_eq!(rows.table().row, new_rows.table().row);
        assert_eq!(rows.neighbors(), new_rows.neighbors());
    }
}

#[test]
fn a_bad_position_by_place_is_named_by_its_particle() {
    let cell = PeriodicBox::new(DVec3::splat(9.0)).unwrap();
    let positions = scatter(50, cell.lengths(), 0.0);
    let mut clusters = cluster_list(&cell, [2.5, 2.7], &positions);
    let mut rows = row_list(&cell, 2.7, Images::Ghosts, &positions);
    let bad = |particles: &[u32]| -> Vec<DVec3> {
        let position = |p: &u32| match p {
            17 => DVec3::splat(f64::NAN),
            _ => positions[*p as usize],
        };
        particles.iter().map(position).collect()
    };
    let (of_clusters, of_rows) = (bad(&clusters.table().particle), bad(&rows.table().particle));
    let by_slot = Positions::BySlot(&of_clusters);
    let error = build_clusters(&mut clusters, &cell, [2.5, 2.7], by_slot).unwrap_err();
    assert!(error.to_string().contains("particle 17"));
    let by_slot = Positions::BySlot(&of_rows);
    let error = build_rows(&mut rows, &cell, 2.7, by_slot).unwrap_err();
    assert!(error.to_string().contains("particle 17"));
}

#[test]
fn a_cluster_in_a_vacuum_does_not_pay_for_the_vacuum() {
    let cell = PeriodicBox::new(DVec3::splat(3000.0)).unwrap();
    let positions = scatter(200, DVec3::splat(8.0), 0.0);
    let list = row_list(&cell, 2.8, Images::Ghosts, &positions);
    // A grid with cells of the list radius would have 1.2e9 cells.
    assert!(list.bytes() < 2_000_000, "{}", list.bytes());
    let wanted = brute_force_pairs(&cell, &positions, 2.8).len() as u64;
    // The margin for rounding grows with the box: 4e-3 σ here.
    let most = brute_force_pairs(&cell, &positions, 2.81).len() as u64;
    assert!((wanted..=most).contains(&list.pairs()), "{} {wanted}", list.pairs());
}

#[test]
fn many_particles_get_wide_entries_only_where_narrow_ones_do_not_reach() {
    let cell = PeriodicBox::new(DVec3::new(9.0, 9.0, 30_000.0)).unwrap();
    let positions = scatter(60_000, cell.lengths(), 0.0);
    let list = row_list(&cell, 1.5, Images::Folded, &positions);
    let narrow = list
        .chunks()
        .iter()
        .filter(|c| matches!(c.entries, lennard_neighbor::Entries::Narrow(_)))
        .count();
    assert!(narrow > 0);
}

#[test]
fn cluster_lists_reach_over_more_slots_than_an_entry_can_count() {
    // A slab of a few columns along x: neighbors across it lie at least 18,000 slots apart.
    let cell = PeriodicBox::new(DVec3::new(6.0, 173.0, 173.0)).unwrap();
    let positions = scatter(72_000, cell.lengths(), 0.0);
    let clusters = cluster_list(&cell, [1.4, 1.5], &positions);
    let blocks = || clusters.chunks().iter().flat_map(|c| &c.blocks);
    assert!(blocks().any(|b| b.base > 0), "bases are in use");
    let rows = row_list(&cell, 1.5, Images::Ghosts, &positions);
    let mut listed_by_clusters = 0;
    for (i, (rows, clusters)) in rows.neighbors().iter().zip(clusters.neighbors()).enumerate() {
        assert!(clusters.windows(2).all(|w| w[0] < w[1]), "{i} has each once");
        assert!(rows.iter().all(|j| clusters.binary_search(j).is_ok()), "{i}");
        listed_by_clusters += clusters.len();
    }
    assert!(listed_by_clusters as u64 > 2 * rows.pairs(), "neighbors of other members too");
}

#[test]
fn chunks_begin_anew_in_each_bundle_and_their_lists_have_every_pair() {
    // Many bundles end with a cluster of fewer than four, beside particles of the next bundle.
    for (sides, n) in [(DVec3::new(24.0, 23.0, 11.0), 6000), (DVec3::new(9.0, 70.0, 9.0), 5001)] {
        let cell = PeriodicBox::new(sides).unwrap();
        let positions = scatter(n, sides, 0.0);
        let clusters = cluster_list(&cell, [2.0, 2.3], &positions);
        let rows = row_list(&cell, 2.3, Images::Ghosts, &positions);
        let clusters_listed = clusters.neighbors();
        let rows_listed = rows.neighbors();
        for (i, j) in brute_force_pairs(&cell, &positions, 2.3) {
            for (a, b) in [(i, j), (j, i)] {
                assert!(clusters_listed[a as usize].binary_search(&b).is_ok(), "{a} {b}");
                assert!(rows_listed[a as usize].binary_search(&b).is_ok(), "{a} {b}");
            }
        }
        for (chunks, particles) in
            [(clusters.chunk_slots(), clusters.particles()), (rows.chunk_slots(), rows.particles())]
        {
            assert!(chunks.count() > n.div_ceil(48) + 2);
            assert_eq!(chunks.of(0..chunks.count()), 0..particles.len());
            for chunk in 0..chunks.count() {
                let slots = chunks.of(chunk..chunk + 1);
                assert!((1..=48).contains(&slots.len()));
                assert!(slots.clone().all(|slot| chunks.chunk_of(slot as u32) == chunk));
            }
        }
        let ragged = clusters.chunks().iter().flat_map(|chunk| chunk.lists());
        assert!(ragged.filter(|(slots, _)| slots.len() < 4).count() > 10);
    }
}

/// Builds the lists of each part of a box, and compares what each particle has in them with the lists of the whole.
fn compare_parts<P: PairList>(
    empty: impl Fn() -> P,
    of_particles: impl Fn(&P) -> Vec<Vec<u32>>,
    (cell, reach): (&PeriodicBox, Reach),
    positions: &[DVec3],
    (ranks, seed): (usize, u64),
) {
    let mut whole = empty();
    whole.order(cell, reach, Positions::ById(positions)).unwrap();
    whole.place(cell, &by_slot(&whole, positions));
    whole.fill(&ScalarScanner, cell, reach);
    let wanted = of_particles(&whole);
    let mut slot_of = vec![0; positions.len()];
    for (slot, particle) in whole.particles().iter().enumerate() {
        slot_of[*particle as usize] = slot;
    }
    let mut owned = 0;
    for rank in 0..ranks {
        let mut part = empty();
        let columns = part.begin_part(cell, reach, positions.len());
        // Cuts are as good as drawn at random.
        let weights: Vec<u64> = (0..columns.bundles() as u64).map(|k| k * k * seed % 97).collect();
        let owners = columns.cut(&weights, ranks);
        assert!((0..ranks as u32).all(|rank| owners.contains(&rank)));
        let owner = |r: &DVec3| owners[columns.bundle(part.column_at(cell, *r))] as usize;
        let radius = with_rounding(cell.lengths(), reach.r_list);
        let beyond: Vec<_> =
            (0..ranks).map(|owner| columns.beyond(&owners, owner, radius)).collect();
        let mut near = Vec::new();
        let in_part = |(_, r): &(u32, &DVec3)| {
            let owner = owner(r);
            beyond[owner].ranks_near(part.column_at(cell, **r), **r, &mut near);
            owner == rank
                || near.iter().any(|(k, d2)| *k as usize == rank && *d2 <= radius * radius)
        };
        let (numbers, at): (Vec<u32>, Vec<DVec3>) = (0..).zip(positions).filter(in_part).unzip();
        let mut belongs = vec![Belongs::Nowhere; (columns.count[0] * columns.count[1]) as usize];
        let index = |[x, y]: [u32; 2]| (x * columns.count[1] + y) as usize;
        for r in &at {
            let is_own = owner(r) == rank;
            let column = part.column_at(cell, *r);
            belongs[index(column)] = if is_own { Belongs::Own } else { Belongs::Halo };
        }
        for (x, y) in (0..columns.count[0]).flat_map(|x| (0..columns.count[1]).map(move |y| (x, y)))
        {
            if owners[columns.bundle([x, y])] as usize == rank {
                belongs[index([x, y])] = Belongs::Own;
            }
        }
        part.take_part(&|column| belongs[index(column)], &numbers);
        part.order(cell, reach, Positions::BySlot(&at)).unwrap();
        part.place(cell, &by_slot(&part, positions));
        part.fill(&ScalarScanner, cell, reach);
        assert!(part.is_valid() && part.own() < at.len());
        owned += part.own();
        let found = of_particles(&part);
        for (slot, number) in part.particles()[..part.own()].iter().enumerate() {
            let wanted = &wanted[slot_of[*number as usize]];
            assert_eq!(found[slot], *wanted, "rank {rank} of {ranks}, particle {number}");
        }
    }
    assert_eq!(owned, positions.len());
}

fn by_slot<P: PairList>(list: &P, positions: &[DVec3]) -> Vec<DVec3> {
    list.particles().iter().map(|particle| positions[*particle as usize]).collect()
}

#[test]
fn the_lists_of_a_part_are_the_lists_of_the_whole_lane_by_lane() {
    for (sides, n) in [(DVec3::new(24.0, 23.0, 11.0), 6000), (DVec3::new(6.0, 90.0, 173.0), 72_000)]
    {
        let cell = PeriodicBox::new(sides).unwrap();
        let positions = scatter(n, sides, 0.0);
        let reach = Reach { r_cut: 1.4, r_list: 1.5 };
        let cuts = if n < 10_000 { vec![(2, 3), (3, 5), (7, 11)] } else { vec![(4, 7)] };
        for how in cuts {
            // The particle in each lane of each block, or none: their order is the order of sums.
            let of_clusters = |list: &ClusterList| {
                let lists = list.chunks().iter().flat_map(|chunk| chunk.lists());
                let particle = list.particles();
                lists
                    .flat_map(|(slots, blocks)| {
                        let of = |member: usize| {
                            let lanes = |block: &Block| {
                                let lanes = (0..16).filter(|k| block.valid >> k & 1 == 1);
                                let slots = lanes.zip(block.slots());
                                slots
                                    .flat_map(|(lane, slot)| [lane, particle[slot as usize]])
                                    .collect::<Vec<u32>>()
                            };
                            blocks.for_member(member).flat_map(lanes).collect::<Vec<u32>>()
                        };
                        (0..slots.len()).map(of).collect::<Vec<_>>()
                    })
                    .collect()
            };
            compare_parts(ClusterList::default, of_clusters, (&cell, reach), &positions, how);
            let of_rows = |list: &NeighborList| {
                let mut all = Vec::new();
                for chunk in list.chunks() {
                    let mut start = 0;
                    for count in &chunk.counts {
                        let entries = chunk.entries.offsets(start..start + *count as usize);
                        let slot = |entry: u32| list.table().slots()[(chunk.base + entry) as usize];
                        let of = |entry: u32| list.particles()[slot(entry) as usize];
                        all.push(entries.into_iter().map(of).collect());
                        start += count.next_multiple_of(8) as usize;
                    }
                }
                all
            };
            let rows = || NeighborList::new(Images::Ghosts, 8);
            compare_parts(rows, of_rows, (&cell, reach), &positions, how);
        }
    }
}

#[test]
fn cluster_lists_insert_pairs_after_the_build_once_and_lose_none() {
    // In a dense box, halves of a cluster have blocks of their own. In a wide box, slots lie beyond the reach of a block.
    let dense = PeriodicBox::new(DVec3::new(9.0, 10.0, 11.0)).unwrap();
    let wide = PeriodicBox::new(DVec3::new(6.0, 173.0, 173.0)).unwrap();
    for (cell, n) in [(dense, 1500), (wide, 72_000)] {
        let positions = scatter(n, cell.lengths(), 0.0);
        let mut list = cluster_list(&cell, [1.9, 2.1], &positions);
        let before = list.neighbors();
        let (lanes, pairs) = (list.lanes_computed(), list.pairs());
        let particle = list.table().particle.clone();
        // Near and far particles: the list accepts every pair.
        let n = n as u32;
        let step = (n / 700) as usize;
        let wanted = (0..n - 1).step_by(step).flat_map(|slot| {
            let far = (u64::from(slot) * 7919 % u64::from(n)) as u32;
            [[slot, (slot + 40) % n], [slot, far], [far, slot]]
        });
        let wanted: Vec<[u32; 2]> = wanted.filter(|[a, b]| a != b).collect();
        let new = wanted.iter().filter(|pair| !list.contains(**pair)).count();
        assert!(new > 700, "{new} of {}", wanted.len());
        for pair in &wanted {
            list.insert(*pair);
            assert!(list.contains(*pair));
        }
        let after = list.neighbors();
        let mut has: Vec<BTreeSet<u32>> = Vec::new();
        for (i, neighbors) in after.iter().enumerate() {
            assert!(neighbors.windows(2).all(|w| w[0] < w[1]), "{i} has each once");
            has.push(neighbors.iter().copied().collect());
            assert!(before[i].iter().all(|j| has[i].contains(j)), "{i} lost one");
        }
        for pair in &wanted {
            let [a, b] = pair.map(|slot| particle[slot as usize]);
            assert!(has[a as usize].contains(&b) && has[b as usize].contains(&a));
        }
        assert!(list.pairs() > pairs && list.lanes_computed() > lanes);
        // A second insertion changes nothing.
        for pair in &wanted {
            list.insert(*pair);
        }
        assert_eq!(list.neighbors(), after);
    }
}

#[test]
fn cluster_lists_of_a_wide_box_cost_few_lanes_more() {
    let lanes_an_atom = |n: usize| {
        let cell = PeriodicBox::new(DVec3::splat((n as f64 / 0.85).cbrt())).unwrap();
        let list = cluster_list(&cell, [2.5, 2.8], &scatter(n, cell.lengths(), 0.0));
        list.lanes_computed() as f64 / n as f64
    };
    // With blocks cut wherever slots lie too far apart, the ratio was 1.13.
    let (narrow, wide) = (lanes_an_atom(32_000), lanes_an_atom(97_556));
    assert!(wide < 1.06 * narrow, "{narrow} {wide}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_pair_is_missed_after_moves_below_half_the_skin(
        n in 1_usize..500,
        sides in prop::array::uniform3(4.0_f64..25.0),
        r_cut_share in 0.2_f64..=1.0,
        skin_share in 0.0_f64..=1.0,
        filling in 0.02_f64..=1.0,
        seed in 0.0_f64..1000.0,
        origin in -100.0_f64..100.0,
        folded in any::<bool>(),
    ) {
        let cell = PeriodicBox::new(DVec3::from(sides)).unwrap();
        let r_cut = r_cut_share * cell.largest_cutoff();
        let skin = skin_share * (cell.largest_cutoff() - r_cut);
        let start: Vec<DVec3> = scatter(n, cell.lengths() * filling, seed)
            .into_iter()
            .map(|r| r + DVec3::splat(origin))
            .collect();
        let images = if folded { Images::Folded } else { Images::Ghosts };
        let list = row_list(&cell, r_cut + skin, images, &start);

        let listed = pairs_of(&list);
        // A full list: both ends list each other.
        let one_sided = listed_by_one_alone(&cell, &start, r_cut + skin, &listed);
        prop_assert_eq!(one_sided, None);
        // No duplicates: at most one image lies within half a box. Exactly half is left out because of rounding.
        if r_cut + skin < 0.999 * cell.largest_cutoff() {
            for (i, neighbors) in list.neighbors().iter().enumerate() {
                prop_assert!(neighbors.windows(2).all(|w| w[0] < w[1]), "particle {}", i);
                prop_assert!(!neighbors.contains(&(i as u32)));
            }
        }
        // No listed pair is clearly too far apart.
        for (i, j) in &listed {
            let r = cell.minimum_image(start[*i as usize] - start[*j as usize]).length();
            prop_assert!(r <= r_cut + skin + 1e-3);
        }
        // The largest allowed displacements: just under half the skin, in many directions.
        let moved: Vec<DVec3> = start
            .iter()
            .zip(scatter(n, DVec3::splat(2.0), seed + 0.3))
            .map(|(r, s)| *r + (s - DVec3::ONE).normalize_or_zero() * (0.4999 * skin))
            .collect();
        for pair in brute_force_pairs(&cell, &moved, r_cut) {
            prop_assert!(listed.contains(&pair), "{:?} of {}", pair, n);
        }
        // Cluster lists contain more than the near particles, and each of them once.
        let clusters = cluster_list(&cell, [r_cut, r_cut + skin], &start);
        let mut listed = BTreeSet::new();
        for (i, neighbors) in clusters.neighbors().iter().enumerate() {
            prop_assert!(neighbors.windows(2).all(|w| w[0] < w[1]), "particle {}", i);
            prop_assert!(!neighbors.contains(&(i as u32)));
            listed.extend(neighbors.iter().map(|j| (i as u32, *j)));
        }
        for pair in brute_force_pairs(&cell, &moved, r_cut) {
            prop_assert!(listed.contains(&pair), "{:?} of {} in cluster lists", pair, n);
        }
    }
}
