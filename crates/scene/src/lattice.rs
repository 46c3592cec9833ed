//! Which numbers of particles a lattice can have in a region, and how many cells that makes.

use lennard_core::DVec3;

use crate::Lattice;
use crate::limits::MOST_ATOMS;

/// In a region that is not a cube, cells may be this much longer along one axis than along another.
/// The lattice is only the start of a fluid.
const MOST_STRETCHED_CELL: f64 = 1.1;

/// How many times more cells than particles may be looked at when the nearest legal number is sought.
const CELLS_TO_SPARE: f64 = 8.0;

/// Sides that differ by less than this fraction make a cube: room for decimals typed by hand.
const SAME_SIDE: f64 = 1e-9;

/// Why `n_atoms` particles make no whole lattice in a region.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NoLattice {
    /// What numbers are allowed.
    pub rule: String,
    /// The nearest legal number below.
    pub below: Option<usize>,
    /// The nearest legal number above.
    pub above: Option<usize>,
}

/// Cells along each axis of a region with the given sides.
///
/// In a cube there are m cells along each axis, so N = 4m³ (fcc), 2m³ (bcc) or m³ (sc). In another region the
/// counts are those that come nearest to cubic cells, with edges that differ by at most a tenth.
pub(crate) fn cells(
    lattice: Lattice,
    n_atoms: usize,
    sides: DVec3,
) -> Result<[usize; 3], NoLattice> {
    if sides.max_element() - sides.min_element() <= SAME_SIDE * sides.max_element() {
        in_cube(lattice, n_atoms).map(|m| [m; 3])
    } else {
        in_cuboid(lattice, n_atoms, sides)
    }
}

fn in_cube(lattice: Lattice, n_atoms: usize) -> Result<usize, NoLattice> {
    let per_cell = lattice.basis().len();
    let count = |m: usize| per_cell * m.pow(3);
    let nearest = (n_atoms as f64 / per_cell as f64).cbrt().round() as usize;
    if nearest > 0 && count(nearest) == n_atoms {
        return Ok(nearest);
    }
    let mut below = nearest;
    while below > 0 && count(below) > n_atoms {
        below -= 1;
    }
    let factor = match per_cell {
        1 => String::new(),
        p => p.to_string(),
    };
    Err(NoLattice {
        rule: format!("{factor}m³ for a whole number m: {} in a cube", lattice.name()),
        below: (below > 0).then(|| count(below)),
        above: Some(count(below + 1)),
    })
}

fn in_cuboid(lattice: Lattice, n_atoms: usize, sides: DVec3) -> Result<[usize; 3], NoLattice> {
    let per_cell = lattice.basis().len();
    let none = |below, above| NoLattice {
        rule: format!(
            "{per_cell}·a·b·c for whole numbers a, b, c of {} cells along the sides, with cell edges within 10 % of each other",
            lattice.name()
        ),
        below,
        above,
    };
    // A cell is no longer than the shortest side, however few the particles.
    let edge = (sides.element_product() * per_cell as f64 / n_atoms as f64)
        .cbrt()
        .min(sides.min_element());
    let most_cells = (sides / edge + DVec3::ONE).element_product();
    if most_cells > MOST_ATOMS as f64 * CELLS_TO_SPARE {
        return Err(none(None, None));
    }
    // Edges within a tenth of each other lie within a tenth of their geometric mean, so no better counts
    // are missed. One more count on either side gives `below` and `above` room for another number.
    let range = |axis: usize| {
        let ideal = sides[axis] / edge;
        let low = (ideal / MOST_STRETCHED_CELL).floor().max(1.0) as usize;
        let high = (ideal * MOST_STRETCHED_CELL).ceil() as usize + 1;
        low..=high
    };
    // The longest side's count follows from the other two, so that a needle or a sheet costs no more than a cube.
    let mut axes = [0, 1, 2];
    axes.sort_by(|a, b| sides[*a].total_cmp(&sides[*b]));
    let (mut exact, mut below, mut above) = (None::<(f64, [usize; 3])>, None, None);
    for short in range(axes[0]) {
        for middle in range(axes[1]) {
            // The longest count may make its edge a tenth shorter or longer than the other two, no more.
            let edges = [sides[axes[0]] / short as f64, sides[axes[1]] / middle as f64];
            let (least, most) = (edges[0].min(edges[1]), edges[0].max(edges[1]));
            let fewest = (sides[axes[2]] / (least * MOST_STRETCHED_CELL)).ceil().max(1.0) as usize;
            let largest = (sides[axes[2]] * MOST_STRETCHED_CELL / most).floor() as usize;
            if fewest > largest {
                continue;
            }
            let ideal = n_atoms / per_cell / (short * middle);
            for long in [ideal.saturating_sub(1), ideal, ideal + 1] {
                let long = long.clamp(fewest, largest);
                let mut counts = [0; 3];
                (counts[axes[0]], counts[axes[1]], counts[axes[2]]) = (short, middle, long);
                let edges = sides / DVec3::from_array(counts.map(|count| count as f64));
                let stretch = edges.max_element() / edges.min_element();
                if stretch > MOST_STRETCHED_CELL {
                    continue;
                }
                let n = per_cell * short * middle * long;
                if n == n_atoms && exact.is_none_or(|(best, _)| stretch < best) {
                    exact = Some((stretch, counts));
                }
                if n < n_atoms && below.is_none_or(|other| n > other) {
                    below = Some(n);
                }
                if n > n_atoms && above.is_none_or(|other| n < other) {
                    above = Some(n);
                }
            }
        }
    }
    exact.map(|(_, counts)| counts).ok_or_else(|| none(below, above))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_takes_four_times_a_cube_number_on_fcc_and_names_the_neighbors_otherwise() {
        let cube = DVec3::splat(10.0);
        assert_eq!(cells(Lattice::Fcc, 864, cube), Ok([6; 3]));
        assert_eq!(cells(Lattice::Bcc, 432, cube), Ok([6; 3]));
        assert_eq!(cells(Lattice::Sc, 1, cube), Ok([1; 3]));
        let wrong = cells(Lattice::Fcc, 1000, cube).unwrap_err();
        assert_eq!((wrong.below, wrong.above), (Some(864), Some(1372)));
        let few = cells(Lattice::Fcc, 3, cube).unwrap_err();
        assert_eq!((few.below, few.above), (None, Some(4)));
        let largest = 4 * 629_usize.pow(3);
        assert_eq!(cells(Lattice::Fcc, largest, cube), Ok([629; 3]));
        let wrong = cells(Lattice::Fcc, largest + 1, cube).unwrap_err();
        assert_eq!((wrong.below, wrong.above), (Some(largest), Some(4 * 630_usize.pow(3))));
    }

    #[test]
    fn a_long_region_takes_nearly_cubic_cells() {
        let sides = DVec3::new(10.0, 10.0, 20.0);
        assert_eq!(cells(Lattice::Fcc, 1000, sides), Ok([5, 5, 10]));
        assert_eq!(cells(Lattice::Sc, 16, DVec3::new(2.0, 2.0, 4.05)), Ok([2, 2, 4]));
    }

    #[test]
    fn an_illegal_number_in_a_long_region_names_legal_ones() {
        let sides = DVec3::new(10.0, 10.0, 20.0);
        let legal = |n: usize| cells(Lattice::Fcc, n, sides).is_ok();
        for n in [1, 999, 1001, 2000, 5000, 12_345] {
            let wrong = cells(Lattice::Fcc, n, sides).unwrap_err();
            // Tried one by one, there is no nearer legal number on either side.
            assert_eq!(wrong.below, (1..n).rev().find(|n| legal(*n)), "{n}");
            assert_eq!(wrong.above, (n + 1..2 * n + 100).find(|n| legal(*n)), "{n}");
        }
    }

    #[test]
    fn sheets_and_needles_are_told_that_no_lattice_is_near() {
        for sides in [[1e-300, 1e6, 1e6], [1e-6, 1.0, 1e6], [1e-300, 1e-300, 1e6]] {
            for n in [1, 1000, MOST_ATOMS as usize] {
                let wrong = cells(Lattice::Fcc, n, DVec3::from_array(sides)).unwrap_err();
                assert_eq!((wrong.below, wrong.above), (None, None), "{sides:?}");
            }
        }
        let plate = DVec3::new(1e6, 1e6, 60.0);
        let many = MOST_ATOMS as usize;
        assert!(cells(Lattice::Fcc, many, plate).is_ok());
        let wrong = cells(Lattice::Fcc, many - 1, plate).unwrap_err();
        assert!(wrong.below.is_some_and(|n| n < many && many - n < 100_000), "{wrong:?}");
        assert_eq!(wrong.above, Some(many));
    }

    #[test]
    fn a_layer_one_cell_thin_is_a_lattice_too() {
        let sides = DVec3::new(10.0, 10.0, 2.0);
        assert_eq!(cells(Lattice::Fcc, 100, sides), Ok([5, 5, 1]));
    }
}
