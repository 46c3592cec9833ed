//! The search of list building, written once for all registers of singles. Distances have the bits of no other instruction set.

use std::ops::Range;

use lennard_neighbor::{
    CLUSTER, Candidates, Center, ClusterNeighbors, ColumnTable, GroupBounds, GroupCandidates,
    Numbering, PADDING, RowCoordinates,
};

use super::lanes::FixedLanes;

/// See [`lennard_neighbor::Scanner::gather_rows`]; moves a register of elements at a time.
#[inline(always)]
pub fn gather_rows<L: FixedLanes>(
    isa: L::Isa,
    coordinates: &RowCoordinates,
    numbering: Numbering<'_>,
    runs: &[Range<u32>],
    candidates: &mut Candidates,
) {
    const { assert!(L::WIDTH <= PADDING) };
    candidates.make_room(coordinates, &numbering, runs);
    let from = [&coordinates.x, &coordinates.y, &coordinates.z].map(|axis| axis.as_ptr());
    let to =
        [&mut candidates.x, &mut candidates.y, &mut candidates.z].map(|axis| axis.as_mut_ptr());
    let to_number = candidates.number.as_mut_ptr();
    let mut len = 0;
    for run in runs {
        let (start, end) = (run.start as usize, run.end as usize);
        for row in (start..end).step_by(L::WIDTH) {
            let at = len + row - start;
            // SAFETY: `make_room` checked that runs contain rows only, and made room for them and a register more. Rows and
            // slots have a register of padding.
            unsafe {
                for axis in 0..3 {
                    to[axis].add(at).copy_from_nonoverlapping(from[axis].add(row), L::WIDTH);
                }
                let to = to_number.add(at);
                match numbering {
                    Numbering::Rows { base } => {
                        L::numbers_from(isa, (row as u32).wrapping_sub(base)).store(to.cast());
                    }
                    Numbering::Slots(slots) => {
                        to.copy_from_nonoverlapping(slots.as_ptr().add(row), L::WIDTH);
                    }
                }
            }
        }
        len += end - start;
    }
    candidates.finish(len);
}

/// See [`lennard_neighbor::Scanner::near`], for numbers of 16 or of 32 bits.
#[inline(always)]
pub fn near<L: FixedLanes, E>(
    isa: L::Isa,
    candidates: &Candidates,
    center: Center,
    radius2: f32,
    found: &mut [E],
) -> usize {
    let blocks = candidates.len.div_ceil(L::WIDTH);
    candidates.check(blocks * L::WIDTH, found.len());
    let single = |value: f32| L::constant(isa, value.into());
    let [x, y, z] = center.at;
    let (x, y, z, limit) = (single(x), single(y), single(z), single(radius2));
    let own = L::whole(isa, center.number);
    // Addresses stay in registers: as far as the compiler knows, what is found could be written over them.
    let from = [&candidates.x, &candidates.y, &candidates.z].map(|axis| axis.as_ptr());
    let (numbers, to) = (candidates.number.as_ptr(), found.as_mut_ptr());
    let mut count = 0_usize;
    for block in 0..blocks {
        let at = block * L::WIDTH;
        // SAFETY: all four arrays have whole registers, as the check found. `count` is at most the number of candidates read
        // so far, and `found` has room for all of them and a register more.
        unsafe {
            let dx = x - L::load(isa, from[0].add(at));
            let dy = y - L::load(isa, from[1].add(at));
            let dz = z - L::load(isa, from[2].add(at));
            let number = L::load(isa, numbers.add(at).cast());
            let r2 = dz.mul_add(dz, dy.mul_add(dy, dx * dx));
            let near = r2.near_others(limit, number, own);
            let to = to.add(count);
            if size_of::<E>() == 2 {
                number.pack_narrow(near, to.cast());
            } else {
                number.pack(near, to.cast());
            }
            count += near.count_ones() as usize;
        }
    }
    count
}

/// See [`lennard_neighbor::Scanner::gather_slots`].
#[inline(always)]
pub fn gather_slots<L: FixedLanes>(
    isa: L::Isa,
    table: &ColumnTable,
    bounds: &GroupBounds,
    runs: &[Range<u32>],
    candidates: &mut GroupCandidates,
) {
    candidates.make_room(table, runs);
    let from = table.at().map(<[i32]>::as_ptr);
    let to = candidates.at.each_mut().map(|axis| axis.as_mut_ptr());
    let to_square = candidates.square.as_mut_ptr();
    let to_slot = candidates.slot.as_mut_ptr();
    let single = |value: f32| L::constant(isa, value.into());
    let (limit, zero) = (single(bounds.radius2), single(0.0));
    let mut len = 0_usize;
    for run in runs {
        let mut slot = run.start;
        while slot < run.end {
            let mut at = [zero; 3];
            let (mut gap2, mut square) = (zero, zero);
            for axis in 0..3 {
                // SAFETY: `slot` is a slot, and the arrays have a register of padding, as `make_room` checked.
                let fixed = unsafe { L::load(isa, from[axis].add(slot as usize).cast()) };
                let middle = L::whole(isa, bounds.middle[axis] as u32);
                at[axis] = fixed.less(middle) * single(bounds.scale[axis]);
                let gap = (at[axis].abs() - single(bounds.half[axis])).max(zero);
                gap2 = gap.mul_add(gap, gap2);
                square = at[axis].mul_add(at[axis], square);
            }
            let near = L::bits(gap2.at_most(limit)) & first_bits((run.end - slot) as usize);
            // SAFETY: `len` is at most the number of slots read so far, and there is room for all of them and a register more.
            unsafe {
                for axis in 0..3 {
                    at[axis].pack(near, to[axis].add(len));
                }
                square.pack(near, to_square.add(len));
                L::numbers_from(isa, slot).pack(near, to_slot.add(len).cast());
            }
            len += near.count_ones() as usize;
            slot += L::WIDTH as u32;
        }
    }
    candidates.len = len;
}

/// See [`lennard_neighbor::Scanner::near_cluster`]; distances are folded into a box of these sides where `FOLDED`.
#[inline(always)]
pub fn near_cluster<L: FixedLanes, const FOLDED: bool>(
    isa: L::Isa,
    candidates: &GroupCandidates,
    bounds: &GroupBounds,
    own: [[f32; 3]; CLUSTER],
    (sides, first): ([f32; 3], u32),
    found: &mut ClusterNeighbors,
) {
    found.check(candidates);
    let to = found.slots.each_mut().map(|slots| slots.as_mut_ptr());
    let from = candidates.at.each_ref().map(|axis| axis.as_ptr());
    let spheres = own.map(|own| bounds.sphere(own));
    let single = |value: f32| L::constant(isa, value.into());
    let first = L::whole(isa, first);
    // Counts stay in registers: from memory, each would wait for its last store.
    let [mut for_all, mut for_first_half, mut for_second_half] = found.len;
    for at in (0..candidates.len).step_by(L::WIDTH) {
        // SAFETY: a register behind the last candidate is readable, as the check found.
        let (square, x, y, z, slot) = unsafe {
            (
                L::load(isa, candidates.square.as_ptr().add(at)),
                L::load(isa, from[0].add(at)),
                L::load(isa, from[1].add(at)),
                L::load(isa, from[2].add(at)),
                L::load(isa, candidates.slot.as_ptr().add(at).cast()),
            )
        };
        let mut near = [0; CLUSTER];
        for ((near, own), (t, limit)) in near.iter_mut().zip(own).zip(spheres) {
            let (mut squares, mut limit) = (square, limit);
            if FOLDED {
                (squares, limit) = (single(0.0), bounds.radius2);
                for ((c, own), length) in [x, y, z].into_iter().zip(own).zip(sides) {
                    let d = c - single(own);
                    let boxes = (d * single(1.0 / length)).round();
                    let d = boxes.mul_add(single(-length), d);
                    squares = d.mul_add(d, squares);
                }
            } else {
                for (c, t) in [x, y, z].into_iter().zip(t) {
                    squares = c.mul_add(single(t), squares);
                }
            }
            *near = L::bits(squares.at_most(single(limit)));
        }
        let others = slot.others(first) & first_bits(candidates.len - at);
        let (first_half, second_half) = (near[0] | near[1], near[2] | near[3]);
        let write = |to: *mut u32, len: &mut usize, bits: u32| {
            // SAFETY: `len` has grown by at most the number of candidates read so far, and `found` has room for all of
            // them and a register more.
            unsafe { slot.pack(bits, to.add(*len).cast()) };
            *len += bits.count_ones() as usize;
        };
        write(to[0], &mut for_all, first_half & second_half & others);
        write(to[1], &mut for_first_half, first_half & !second_half & others);
        write(to[2], &mut for_second_half, second_half & !first_half & others);
    }
    found.len = [for_all, for_first_half, for_second_half];
}

/// The lowest `left` bits, at most 32.
#[inline(always)]
fn first_bits(left: usize) -> u32 {
    (1_u64 << left.min(32)).wrapping_sub(1) as u32
}
