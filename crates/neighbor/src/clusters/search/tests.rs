use glam::DVec3;

use super::*;
use crate::ScalarScanner;
use crate::sort::Positions;

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
