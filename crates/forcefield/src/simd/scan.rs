//! What the searches of list building have in common, whatever the instruction set.

use std::ops::Range;

use lennard_neighbor::{Candidates, Names, Nearby, PADDING};

/// See [`lennard_neighbor::RowScanner::gather`]; moves `WIDTH` elements at a time.
#[inline(always)]
pub fn gather<const WIDTH: usize>(
    candidates: &Candidates,
    names: Names<'_>,
    runs: &[Range<u32>],
    nearby: &mut Nearby,
) {
    const { assert!(WIDTH <= PADDING) };
    nearby.make_room(candidates, &names, runs);
    let from = [&candidates.x, &candidates.y, &candidates.z].map(|axis| axis.as_ptr());
    let to = [&mut nearby.x, &mut nearby.y, &mut nearby.z].map(|axis| axis.as_mut_ptr());
    let to_name = nearby.name.as_mut_ptr();
    let mut len = 0;
    for run in runs {
        let (start, end) = (run.start as usize, run.end as usize);
        for row in (start..end).step_by(WIDTH) {
            let at = len + row - start;
            // SAFETY: `make_room` checked that runs are rows and made room for them and a register; rows and
            // places, padded as they are, can be read a register beyond their end.
            unsafe {
                for axis in 0..3 {
                    to[axis]
                        .add(at)
                        .copy_from_nonoverlapping(from[axis].add(row), WIDTH);
                }
                match names {
                    Names::Rows { base } => {
                        // A plain loop: what takes a closure may be a call, which leaves the instruction set behind.
                        let mut name = [(row as u32).wrapping_sub(base); WIDTH];
                        for (k, name) in name.iter_mut().enumerate() {
                            *name = name.wrapping_add(k as u32);
                        }
                        to_name
                            .add(at)
                            .copy_from_nonoverlapping(name.as_ptr(), WIDTH);
                    }
                    Names::Places(places) => {
                        to_name
                            .add(at)
                            .copy_from_nonoverlapping(places.as_ptr().add(row), WIDTH);
                    }
                }
            }
        }
        len += end - start;
    }
    nearby.finish(len);
}

/// A bit for each lane of a register of which `left` elements are there, and more bits where there are more.
#[inline(always)]
pub fn among_first(left: usize) -> u32 {
    (1_u64 << left.min(32)).wrapping_sub(1) as u32
}
