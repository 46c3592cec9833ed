//! The search for neighbors of each instruction set, as the neighbor lists call it.

use lennard_neighbor::{ScalarScanner, Scanner};

use super::level::Level;

impl Level {
    /// The search that builds lists at this level.
    pub fn scanner(&self) -> &dyn Scanner {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(isa) => isa,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(isa) => isa,
            _ => &ScalarScanner,
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::ops::Range;

    use lennard_neighbor::{
        CLUSTER, Candidates, Center, ClusterNeighbors, ColumnTable, Found, GroupBounds,
        GroupCandidates, Numbering, RowCoordinates, Scanner,
    };

    use crate::simd::avx2::F32x8;
    use crate::simd::avx512::F32x16;
    use crate::simd::level::{Avx2, Avx512};
    use crate::simd::scan;

    /// Implements the search for the token of an instruction set, on its registers of singles.
    macro_rules! scanner {
        ($token:ident, $singles:ident) => {
            impl Scanner for $token {
                fn gather_rows(
                    &self,
                    coordinates: &RowCoordinates,
                    numbering: Numbering<'_>,
                    runs: &[Range<u32>],
                    candidates: &mut Candidates,
                ) {
                    self.run(|| {
                        scan::gather_rows::<$singles>(
                            *self,
                            coordinates,
                            numbering,
                            runs,
                            candidates,
                        );
                    });
                }

                fn near(
                    &self,
                    candidates: &Candidates,
                    center: Center,
                    radius2: f32,
                    found: Found<'_>,
                ) -> usize {
                    match found {
                        Found::Narrow(found) => self.run(|| {
                            scan::near::<$singles, u16>(*self, candidates, center, radius2, found)
                        }),
                        Found::Wide(found) => self.run(|| {
                            scan::near::<$singles, u32>(*self, candidates, center, radius2, found)
                        }),
                    }
                }

                fn gather_slots(
                    &self,
                    table: &ColumnTable,
                    bounds: &GroupBounds,
                    runs: &[Range<u32>],
                    candidates: &mut GroupCandidates,
                ) {
                    self.run(|| {
                        scan::gather_slots::<$singles>(*self, table, bounds, runs, candidates);
                    });
                }

                fn near_cluster(
                    &self,
                    candidates: &GroupCandidates,
                    bounds: &GroupBounds,
                    own: [[f32; 3]; CLUSTER],
                    first: u32,
                    found: &mut ClusterNeighbors,
                ) {
                    // Each of the two loops has enough registers for its constants.
                    match bounds.folds {
                        None => self.run(|| {
                            let box_and_first = ([0.0; 3], first);
                            scan::near_cluster::<$singles, false>(
                                *self,
                                candidates,
                                bounds,
                                own,
                                box_and_first,
                                found,
                            );
                        }),
                        Some(sides) => self.run(|| {
                            let box_and_first = (sides, first);
                            scan::near_cluster::<$singles, true>(
                                *self,
                                candidates,
                                bounds,
                                own,
                                box_and_first,
                                found,
                            );
                        }),
                    }
                }
            }
        };
    }

    scanner!(Avx512, F32x16);
    scanner!(Avx2, F32x8);
}
