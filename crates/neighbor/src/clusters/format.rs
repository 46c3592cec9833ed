//! The format of cluster lists.

/// Members of a cluster: the particles at consecutive slots that share one list.
pub const CLUSTER: usize = 4;

/// Entries of a block.
pub const BLOCK: usize = 16;

/// The factor of block entries: an entry is this factor times the distance in slots from the base.
///
/// A row has 16 bytes, so that eight times an entry is a distance in bytes. An address can contain it without a shift.
pub const ENTRY_SCALE: u16 = 2;

/// The largest distance in slots between an entry of a block and its base.
pub(crate) const BLOCK_REACH: u32 = (u16::MAX / ENTRY_SCALE) as u32;

/// A point near the middle of a cluster, from its second and its third member in fixed point.
#[inline(always)]
#[must_use]
pub fn cluster_center<const N: usize>(second: [i32; N], third: [i32; N]) -> [i32; N] {
    let mut center = second;
    for axis in 0..N {
        center[axis] = second[axis].wrapping_add(third[axis].wrapping_sub(second[axis]) >> 1);
    }
    center
}

/// The distances that a list is built for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// The cutoff r_cut, σ.
    pub r_cut: f64,
    /// The list radius r_list, σ.
    pub r_list: f64,
}
