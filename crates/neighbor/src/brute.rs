//! The brute-force search: it looks at every pair, without a grid and without a list.

use glam::DVec3;
use lennard_core::PeriodicBox;

/// All pairs (i, j), i < j, with minimum-image distance r ≤ `radius` σ, in ascending order.
///
/// The cost is O(N²): it serves tests, and systems so small that no list pays.
#[must_use]
pub fn brute_force_pairs(cell: &PeriodicBox, positions: &[DVec3], radius: f64) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    for_each_pair(cell, positions, radius, |i, j, _| {
        pairs.push((i as u32, j as u32));
    });
    pairs
}

/// Calls `visit(i, j, r_ij)` for all pairs i < j with minimum-image distance r ≤ `radius` σ.
pub fn for_each_pair(
    cell: &PeriodicBox,
    positions: &[DVec3],
    radius: f64,
    mut visit: impl FnMut(usize, usize, DVec3),
) {
    for (i, ri) in positions.iter().enumerate() {
        for (j, rj) in positions.iter().enumerate().skip(i + 1) {
            let r_ij = cell.minimum_image(*ri - *rj);
            if r_ij.length_squared() <= radius * radius {
                visit(i, j, r_ij);
            }
        }
    }
}
