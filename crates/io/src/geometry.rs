//! Boxes as files and other programs state them: rounding has touched each number.

use glam::DVec3;
use lennard_core::PeriodicBox;

use crate::error::Refusal;

/// Two statements of one length may differ by this share of the shortest side, and an edge may lean by as much.
const SAME_LENGTH: f64 = 1e-10;

/// Why three edges make no box.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum EdgeError {
    /// An edge leans away from its axis.
    #[error("an edge leans away from its axis by more than 1e-10 of a side")]
    Tilt,
    /// A side is not a finite positive number.
    #[error("a side is not a finite positive number")]
    Side,
}

/// The box of edges that stand in a file, with what readers allow.
pub(crate) fn upright(
    edges: [DVec3; 3],
    found: impl Fn() -> String,
) -> Result<PeriodicBox, Refusal> {
    const UPRIGHT: &str =
        "an orthorhombic box, to 1e-10 of a side; triclinic boxes are not there yet";
    box_of_edges(edges).map_err(|error| match error {
        EdgeError::Tilt => (format!("{}, a triclinic box", found()), UPRIGHT.into()),
        EdgeError::Side => (found(), "box sides that are positive".into()),
    })
}

/// The box whose edges are the vectors a, b and c along x, y and z.
///
/// A component across an axis counts as zero up to 1e-10 of the shortest edge.
///
/// # Errors
/// [`EdgeError`] where an edge leans by more, or a side is not positive.
pub fn box_of_edges(edges: [DVec3; 3]) -> Result<PeriodicBox, EdgeError> {
    let sides = DVec3::new(edges[0].x, edges[1].y, edges[2].z);
    let shortest = edges.map(DVec3::length).into_iter().fold(f64::MAX, f64::min);
    let is_across = |edge: &DVec3, axis: DVec3| {
        let across = *edge * (DVec3::ONE - axis);
        across.abs().max_element() > SAME_LENGTH * shortest
    };
    if edges.iter().zip(DVec3::AXES).any(|(edge, axis)| is_across(edge, axis)) {
        return Err(EdgeError::Tilt);
    }
    let is_finite = edges.iter().all(|edge| edge.is_finite());
    let cell = PeriodicBox::new(sides).ok().filter(|_| is_finite);
    cell.ok_or(EdgeError::Side)
}

/// Whether two statements mean the same box, to 1e-10 of its shortest side.
#[must_use]
pub fn is_same_box(one: &PeriodicBox, other: &PeriodicBox) -> bool {
    let apart = (one.lengths() - other.lengths()).abs().max_element();
    apart <= SAME_LENGTH * one.shortest()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_that_rounding_has_tilted_make_a_box_and_others_do_not() {
        let upright = [DVec3::X * 5.0, DVec3::Y * 6.0, DVec3::Z * 500.0];
        let lengths = DVec3::new(5.0, 6.0, 500.0);
        for (edge, axis) in [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)] {
            for sign in [1.0, -1.0] {
                let mut edges = upright;
                edges[edge][axis] = sign * 4.9e-10;
                assert_eq!(box_of_edges(edges).unwrap().lengths(), lengths);
                edges[edge][axis] = sign * 5.1e-10;
                assert_eq!(box_of_edges(edges), Err(EdgeError::Tilt));
                edges[edge][axis] = f64::NAN;
                assert!(box_of_edges(edges).is_err());
            }
        }
        let words = |edges| box_of_edges(edges).unwrap_err().to_string();
        assert_eq!(
            words([DVec3::ONE; 3]),
            "an edge leans away from its axis by more than 1e-10 of a side"
        );
        assert_eq!(words([DVec3::ZERO; 3]), "a side is not a finite positive number");
        let turned = [DVec3::Y * 5.0, DVec3::X * 5.0, DVec3::Z * 5.0];
        assert_eq!(box_of_edges(turned), Err(EdgeError::Tilt));
        for side in [0.0, -5.0, f64::NAN] {
            let edges = [DVec3::X * side, upright[1], upright[2]];
            assert_eq!(box_of_edges(edges), Err(EdgeError::Side));
        }
    }

    #[test]
    fn a_lattice_that_rounding_has_turned_is_read_and_one_that_is_turned_is_refused() {
        let read = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let [a, b] = [[8.0 * cos, 8.0 * sin], [-9.0 * sin, 9.0 * cos]];
            let edges = format!("{} {} 0 {} {} 0 0 0 7", a[0], a[1], b[0], b[1]);
            let text = format!("1\nLattice=\"{edges}\"\nAr 1 2 3\n");
            crate::read_configuration_bytes(text.as_bytes())
        };
        let start = read(-7e-11).unwrap();
        assert_eq!(start.cell.lengths(), DVec3::new(8.0, 9.0, 7.0));
        let error = read(1e-9).unwrap_err().to_string();
        assert!(error.contains("to 1e-10 of a side"), "{error}");
    }

    #[test]
    fn two_statements_of_a_box_may_be_rounded_apart() {
        let cell = |side: f64| PeriodicBox::new(DVec3::new(side, 8.0, 9.0)).unwrap();
        assert!(is_same_box(&cell(5.0), &cell(5.0 + 4.9e-10)));
        assert!(!is_same_box(&cell(5.0), &cell(5.0 + 5.1e-10)));
    }
}
