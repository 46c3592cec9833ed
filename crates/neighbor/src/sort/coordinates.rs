//! Coordinates of rows in single precision, which the search for neighbors reads.

/// Number of elements that can be read or written beyond the last one: searches move whole registers.
pub const PADDING: usize = 16;

/// Coordinates of all rows in single precision, for the search alone.
///
/// The search radius has a margin for their rounding errors.
#[derive(Debug, Default, Clone)]
pub struct RowCoordinates {
    /// x of each row, σ, `[rows]` and padding.
    pub x: Vec<f32>,
    /// y of each row, σ, `[rows]` and padding.
    pub y: Vec<f32>,
    /// z of each row, σ, `[rows]` and padding.
    pub z: Vec<f32>,
}

impl RowCoordinates {
    /// Makes room for `rows` rows and the padding.
    pub fn resize(&mut self, rows: usize) {
        for axis in [&mut self.x, &mut self.y, &mut self.z] {
            axis.resize(rows + PADDING, 0.0);
        }
    }

    /// Coordinates of one row, σ.
    #[must_use]
    pub fn at(&self, row: usize) -> [f32; 3] {
        [self.x[row], self.y[row], self.z[row]]
    }

    /// Number of rows, without the padding.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.x.len().saturating_sub(PADDING)
    }
}
