use glam::DVec3;

use super::*;
use crate::ScalarScanner;
use crate::sort::{Cells, Positions};

#[test]
fn lists_that_are_built_aside_are_the_same_and_fill_their_room() {
    let lengths = DVec3::new(11.0, 12.0, 10.0);
    let cell = PeriodicBox::new(lengths).unwrap();
    let positions: Vec<DVec3> = (0..ATOMS_PER_CHUNK as i32 * 7 + 5)
        .map(|k| DVec3::new(0.819_17, 0.671_04, 0.549_73) * lengths * f64::from(k))
        .collect();
    let mut table = ColumnTable::default();
    table.sort(&cell, Positions::ById(&positions)).unwrap();
    let slots_of_chunk = |c: usize| {
        let first = c * ATOMS_PER_CHUNK;
        first..(first + ATOMS_PER_CHUNK).min(positions.len())
    };
    let clusters = ATOMS_PER_CHUNK / CLUSTER;
    let mut chunks = [(); 2].map(|()| vec![ClusterChunk::default(); 8]);
    // Lists grow and shrink from build to build.
    for r_list in [2.7, 2.71, 3.1, 3.0, 2.4] {
        let reach = Reach { r_cut: 2.3, r_list };
        let exclusions = (&Exclusions::NONE, &[][..]);
        let mut search = Search::new(&table, &cell, reach, &ScalarScanner, exclusions);
        for (aside, chunks) in [false, true].into_iter().zip(&mut chunks) {
            search.aside = aside;
            let mut scratch = Scratch::default();
            for (c, chunk) in chunks.iter_mut().enumerate() {
                chunk.clear(clusters);
                search.fill(slots_of_chunk(c), &mut scratch, chunk);
                assert_eq!(chunk.spans.capacity(), clusters);
            }
        }
        let [in_place, aside] = &chunks;
        assert_eq!(in_place, aside);
        for chunk in aside {
            let (blocks, room) = (chunk.blocks.len(), chunk.blocks.capacity());
            assert!(room <= blocks + blocks / 8, "{blocks} blocks in {room}");
        }
    }
}

#[test]
fn a_rank_knows_of_all_columns_that_its_groups_look_into() {
    let lengths = DVec3::new(41.0, 39.0, 5.6);
    let cell = PeriodicBox::new(lengths).unwrap();
    let positions: Vec<DVec3> = (0..600)
        .map(|k| DVec3::new(0.819_17, 0.671_04, 0.549_73) * lengths * f64::from(k))
        .collect();
    let mut table = ColumnTable::default();
    table.sort(&cell, Positions::ById(&positions)).unwrap();
    let reach = Reach { r_cut: 2.3, r_list: 2.7 };
    let exclusions = (&Exclusions::NONE, &[][..]);
    let search = Search::new(&table, &cell, reach, &ScalarScanner, exclusions);
    let mut lacking = 0;
    for own in [0..240, 240..432, 432..600, 96..144] {
        let mut around = Around::new(Cells::Columns(&table), lengths, reach.r_list, &own);
        let bare: Vec<usize> = around.near().into_iter().flatten().collect();
        search.mark_near(own.clone(), &mut around);
        let near: Vec<usize> = around.near().into_iter().flatten().collect();
        let mut scratch = Scratch::default();
        for group in own.clone().step_by(GROUP) {
            let bounds = search.bounds(group..(group + GROUP).min(own.end));
            search.find_runs(&bounds, group, &mut scratch);
            let found = scratch.runs.iter().cloned().flatten();
            for slot in found.map(|slot| slot as usize).filter(|s| !own.contains(s)) {
                assert!(near.contains(&slot), "slot {slot}");
                lacking += usize::from(!bare.contains(&slot));
            }
        }
    }
    // Corners of bounding boxes lie in columns that are far from every member's column.
    assert!(lacking > 0);
}
