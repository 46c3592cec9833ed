//! Frames: how the cluster loop takes differences of fixed-point coordinates.
//!
//! ```text
//!   AbsoluteFrame   member (i32) - neighbor (i32)          exact difference, then conversion, for each pair
//!   ClusterFrame    center (i32) - neighbor (i32)          one conversion per neighbor for all four members,
//!                   member (f32) - neighbor (f32)          then differences of small singles
//! ```

use std::hint::black_box;

use lennard_neighbor::{CLUSTER, FixedRow, cluster_center};

use super::lanes::FixedLanes;

/// A way to take differences between members and neighbors.
pub trait Frame<L: FixedLanes> {
    /// Whether distances are in σ; otherwise they are in units of the rows, which are then equal along all axes.
    const IN_SIGMA: bool;
    /// Whether neighbors are converted once for all members.
    const CONVERTS: bool;
    /// One member, in every lane.
    type Member: Copy;
    /// One register of neighbors.
    type Neighbors: Copy;

    /// The members of the cluster.
    fn members(&self) -> [Self::Member; CLUSTER];

    /// The neighbors of gathered rows.
    fn neighbors(&self, rows: L::Rows) -> Self::Neighbors;

    /// member − neighbor along each axis.
    fn apart(&self, member: Self::Member, neighbors: Self::Neighbors) -> [L; 3];
}

#[inline(always)]
fn constants<L: FixedLanes>(isa: L::Isa, [x, y, z]: [f64; 3]) -> [L; 3] {
    [L::constant(isa, x), L::constant(isa, y), L::constant(isa, z)]
}

#[inline(always)]
fn stretch<L: FixedLanes>([x, y, z]: [L; 3], [sx, sy, sz]: [L; 3]) -> [L; 3] {
    [x * sx, y * sy, z * sz]
}

/// Differences of fixed-point coordinates: each is exact, wraps around as the box does, and is rounded on its own.
pub struct AbsoluteFrame<L: FixedLanes> {
    members: [L::Rows; CLUSTER],
    scale: [L; 3],
}

impl<L: FixedLanes> AbsoluteFrame<L> {
    /// The frame of a cluster whose members have `rows`, in units of `scale` along each axis, σ.
    #[inline(always)]
    pub fn new(isa: L::Isa, [a, b, c, d]: [&FixedRow; CLUSTER], scale: [f64; 3]) -> Self {
        Self {
            members: [L::spread(isa, a), L::spread(isa, b), L::spread(isa, c), L::spread(isa, d)],
            scale: constants(isa, scale),
        }
    }
}

impl<L: FixedLanes> Frame<L> for AbsoluteFrame<L> {
    const IN_SIGMA: bool = true;
    const CONVERTS: bool = false;
    type Member = L::Rows;
    type Neighbors = L::Rows;

    #[inline(always)]
    fn members(&self) -> [L::Rows; CLUSTER] {
        self.members
    }

    #[inline(always)]
    fn neighbors(&self, rows: L::Rows) -> L::Rows {
        rows
    }

    #[inline(always)]
    fn apart(&self, member: L::Rows, neighbors: L::Rows) -> [L; 3] {
        stretch(L::apart(member, neighbors), self.scale)
    }
}

/// The members of a cluster relative to its center, and the center.
#[repr(C, align(64))]
struct Relative([[f32; 4]; CLUSTER], FixedRow);

/// Coordinates relative to the center of a compact cluster.
///
/// Neighbors are rounded once for all four members, and differences are taken between small singles.
/// In a `CUBIC` box the units are equal along all axes, and distances stay in units of the rows.
pub struct ClusterFrame<L: FixedLanes, const CUBIC: bool> {
    center: L::Rows,
    members: [[L; 3]; CLUSTER],
    scale: [L; 3],
}

impl<L: FixedLanes, const CUBIC: bool> ClusterFrame<L, CUBIC> {
    /// The frame of a cluster whose members have `rows`, in units of `scale` along each axis, σ.
    #[inline(always)]
    pub fn new(isa: L::Isa, rows: [&FixedRow; CLUSTER], scale: [f64; 3]) -> Self {
        let scale = if CUBIC { [1.0; 3] } else { scale };
        let single = [scale[0] as f32, scale[1] as f32, scale[2] as f32, 0.0];
        let center = cluster_center(*rows[1], *rows[2]);
        let mut relative = Relative([[0.0; 4]; CLUSTER], center);
        for (own, row) in relative.0.iter_mut().zip(rows) {
            for axis in 0..4 {
                own[axis] = row[axis].wrapping_sub(center[axis]) as f32 * single[axis];
            }
        }
        // Each value is broadcast as it is loaded, which leaves the arithmetic ports free.
        // Without the black box, the compiler would use shuffles.
        let Relative([a, b, c, d], center) = black_box(&relative);
        let spread = |[x, y, z, _]: &[f32; 4]| constants(isa, [*x, *y, *z].map(f64::from));
        let members = [spread(a), spread(b), spread(c), spread(d)];
        Self { center: L::spread(isa, center), members, scale: constants(isa, scale) }
    }
}

impl<L: FixedLanes, const CUBIC: bool> Frame<L> for ClusterFrame<L, CUBIC> {
    const IN_SIGMA: bool = !CUBIC;
    const CONVERTS: bool = true;
    type Member = [L; 3];
    type Neighbors = [L; 3];

    #[inline(always)]
    fn members(&self) -> [[L; 3]; CLUSTER] {
        self.members
    }

    #[inline(always)]
    fn neighbors(&self, rows: L::Rows) -> [L; 3] {
        let apart = L::apart(rows, self.center);
        if CUBIC { apart } else { stretch(apart, self.scale) }
    }

    #[inline(always)]
    fn apart(&self, member: [L; 3], neighbors: [L; 3]) -> [L; 3] {
        [member[0] - neighbors[0], member[1] - neighbors[1], member[2] - neighbors[2]]
    }
}
