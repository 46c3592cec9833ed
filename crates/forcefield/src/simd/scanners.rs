//! The searches for neighbors of each instruction set, as the neighbor lists call them.

use lennard_neighbor::{ClusterScanner, RowScanner, ScalarClusterScanner, ScalarScanner};

use super::level::Level;

impl Level {
    /// The search that builds row lists at this level.
    pub fn row_scanner(&self) -> &(dyn RowScanner + 'static) {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(isa) => isa,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(isa) => isa,
            _ => &ScalarScanner,
        }
    }

    /// The search that builds cluster lists at this level.
    pub fn cluster_scanner(&self) -> &(dyn ClusterScanner + 'static) {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(isa) => isa,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(isa) => isa,
            _ => &ScalarClusterScanner,
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::ops::Range;

    use lennard_neighbor::{
        CLUSTER, Candidates, Center, ClusterNeighbors, ClusterScanner, ColumnTable, GroupBounds,
        GroupCandidates, Numbering, RowCoordinates, RowScanner,
    };

    use crate::simd::level::{Avx2, Avx512};
    use crate::simd::{scan256, scan512};

    /// Implements the searches for the token of an instruction set, by the functions of a module.
    macro_rules! scanner {
        ($token:ident, $module:ident) => {
            impl RowScanner for $token {
                fn gather(
                    &self,
                    coordinates: &RowCoordinates,
                    numbering: Numbering<'_>,
                    runs: &[Range<u32>],
                    candidates: &mut Candidates,
                ) {
                    // SAFETY: the token proves the instruction set, here and below.
                    unsafe { $module::gather(coordinates, numbering, runs, candidates) }
                }

                fn near_narrow(
                    &self,
                    candidates: &Candidates,
                    center: Center,
                    radius2: f32,
                    found: &mut [u16],
                ) -> usize {
                    // SAFETY: as above.
                    unsafe { $module::near_narrow(candidates, center, radius2, found) }
                }

                fn near_wide(
                    &self,
                    candidates: &Candidates,
                    center: Center,
                    radius2: f32,
                    found: &mut [u32],
                ) -> usize {
                    // SAFETY: as above.
                    unsafe { $module::near_wide(candidates, center, radius2, found) }
                }
            }

            impl ClusterScanner for $token {
                fn gather(
                    &self,
                    table: &ColumnTable,
                    bounds: &GroupBounds,
                    runs: &[Range<u32>],
                    candidates: &mut GroupCandidates,
                ) {
                    // SAFETY: as above.
                    unsafe { $module::gather_cluster(table, bounds, runs, candidates) }
                }

                fn near(
                    &self,
                    candidates: &GroupCandidates,
                    bounds: &GroupBounds,
                    own: [[f32; 3]; CLUSTER],
                    first: u32,
                    found: &mut ClusterNeighbors,
                ) {
                    // Each of the two loops has enough registers for its constants.
                    // SAFETY: as above.
                    unsafe {
                        match bounds.folds {
                            None => $module::near_cluster::<false>(
                                candidates, bounds, own, [0.0; 3], first, found,
                            ),
                            Some(sides) => $module::near_cluster::<true>(
                                candidates, bounds, own, sides, first, found,
                            ),
                        }
                    }
                }
            }
        };
    }

    scanner!(Avx512, scan512);
    scanner!(Avx2, scan256);
}
