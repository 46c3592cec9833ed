//! Parts of the search for neighbors that all instruction sets share.

use std::ops::Range;

use lennard_neighbor::{Candidates, Numbering, PADDING, RowCoordinates};

/// See [`lennard_neighbor::RowScanner::gather`]; moves `WIDTH` elements at a time.
#[inline(always)]
pub fn gather<const WIDTH: usize>(
    coordinates: &RowCoordinates,
    numbering: Numbering<'_>,
    runs: &[Range<u32>],
    candidates: &mut Candidates,
) {
    const { assert!(WIDTH <= PADDING) };
    candidates.make_room(coordinates, &numbering, runs);
    let from = [&coordinates.x, &coordinates.y, &coordinates.z].map(|axis| axis.as_ptr());
    let to =
        [&mut candidates.x, &mut candidates.y, &mut candidates.z].map(|axis| axis.as_mut_ptr());
    let to_number = candidates.number.as_mut_ptr();
    let mut len = 0;
    for run in runs {
        let (start, end) = (run.start as usize, run.end as usize);
        for row in (start..end).step_by(WIDTH) {
            let at = len + row - start;
            // SAFETY: `make_room` checked that runs contain rows only, and made room for them and a register more. Rows and
            // slots have a register of padding.
            unsafe {
                for axis in 0..3 {
                    to[axis].add(at).copy_from_nonoverlapping(from[axis].add(row), WIDTH);
                }
                match numbering {
                    Numbering::Rows { base } => {
                        // A plain loop: a function that takes a closure may be a call, which leaves the instruction set.
                        let mut number = [(row as u32).wrapping_sub(base); WIDTH];
                        for (k, number) in number.iter_mut().enumerate() {
                            *number = number.wrapping_add(k as u32);
                        }
                        to_number.add(at).copy_from_nonoverlapping(number.as_ptr(), WIDTH);
                    }
                    Numbering::Slots(slots) => {
                        to_number.add(at).copy_from_nonoverlapping(slots.as_ptr().add(row), WIDTH);
                    }
                }
            }
        }
        len += end - start;
    }
    candidates.finish(len);
}

/// The lowest `left` bits, at most 32.
#[inline(always)]
pub fn first_bits(left: usize) -> u32 {
    (1_u64 << left.min(32)).wrapping_sub(1) as u32
}
