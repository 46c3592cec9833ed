//! Frames: how the cluster loop takes differences of fixed-point coordinates.
//!
//! ```text
//!   absolute   member (i32) - neighbor (i32)          exact difference, then conversion, for each pair
//!   compact    center (i32) - neighbor (i32)          one conversion per neighbor for all four members,
//!              member (f32) - neighbor (f32)          then differences of small singles
//! ```

use std::hint::black_box;

use lennard_neighbor::{CLUSTER, FixedRow, cluster_center};

use super::lanes::FixedLanes;

#[inline(always)]
fn constants<L: FixedLanes>(isa: L::Isa, [x, y, z]: [f64; 3]) -> [L; 3] {
    [L::constant(isa, x), L::constant(isa, y), L::constant(isa, z)]
}

/// Where a compact cluster has the members that it lacks, along each axis: beyond any cutoff, with a finite square.
const FAR_AWAY: f32 = 1e18;

/// The members of a cluster relative to its center, and the center.
#[repr(C, align(64))]
struct Relative([[f32; 4]; CLUSTER], FixedRow);

/// The frame of a cluster.
///
/// In an absolute frame each difference is exact, wraps around as the box does, and is rounded on its own. In a `COMPACT` frame
/// coordinates are relative to the center: neighbors are rounded once for all four members, and differences are taken between small
/// singles. In a `CUBIC` box the units are equal along all axes, and distances stay in units of the rows; such a frame is compact.
pub struct Frame<L: FixedLanes, const COMPACT: bool, const CUBIC: bool> {
    center: [L; 3],
    /// The members of the cluster.
    pub members: [[L; 3]; CLUSTER],
    scale: [L; 3],
}

impl<L: FixedLanes, const COMPACT: bool, const CUBIC: bool> Frame<L, COMPACT, CUBIC> {
    /// The frame of a cluster whose members have `rows`, the first `count` of which are particles, in units of `scale` along each axis, σ.
    #[inline(always)]
    pub fn new(isa: L::Isa, (rows, count): ([&FixedRow; CLUSTER], usize), scale: [f64; 3]) -> Self {
        const { assert!(COMPACT || !CUBIC) };
        if !COMPACT {
            let [a, b, c, d] = rows;
            let members =
                [L::spread(isa, a), L::spread(isa, b), L::spread(isa, c), L::spread(isa, d)];
            return Self { center: members[0], members, scale: constants(isa, scale) };
        }
        let scale = if CUBIC { [1.0; 3] } else { scale };
        let single = [scale[0] as f32, scale[1] as f32, scale[2] as f32, 0.0];
        let center = cluster_center(*rows[1], *rows[2]);
        let mut relative = Relative([[0.0; 4]; CLUSTER], center);
        for (own, row) in relative.0.iter_mut().zip(rows) {
            for axis in 0..4 {
                own[axis] = row[axis].wrapping_sub(center[axis]) as f32 * single[axis];
            }
        }
        if count < CLUSTER {
            relative.0[count..].fill([FAR_AWAY; 4]);
        }
        // Each value is broadcast as it is loaded, which leaves the arithmetic ports free.
        // Without the black box, the compiler would use shuffles.
        let Relative([a, b, c, d], center) = black_box(&relative);
        let members = [
            constants(isa, [a[0].into(), a[1].into(), a[2].into()]),
            constants(isa, [b[0].into(), b[1].into(), b[2].into()]),
            constants(isa, [c[0].into(), c[1].into(), c[2].into()]),
            constants(isa, [d[0].into(), d[1].into(), d[2].into()]),
        ];
        Self { center: L::spread(isa, center), members, scale: constants(isa, scale) }
    }

    /// The neighbors of gathered rows.
    #[inline(always)]
    pub fn neighbors(&self, rows: [L; 3]) -> [L; 3] {
        if COMPACT { self.converted(rows, self.center) } else { rows }
    }

    /// member − neighbor along each axis.
    #[inline(always)]
    pub fn apart(&self, member: [L; 3], neighbors: [L; 3]) -> [L; 3] {
        if COMPACT {
            [member[0] - neighbors[0], member[1] - neighbors[1], member[2] - neighbors[2]]
        } else {
            self.converted(member, neighbors)
        }
    }

    /// a − b of coordinates in fixed point, in the unit of distances.
    #[inline(always)]
    fn converted(&self, a: [L; 3], b: [L; 3]) -> [L; 3] {
        let [x, y, z] = [a[0].less(b[0]), a[1].less(b[1]), a[2].less(b[2])];
        let [sx, sy, sz] = self.scale;
        if CUBIC { [x, y, z] } else { [x * sx, y * sy, z * sz] }
    }
}
