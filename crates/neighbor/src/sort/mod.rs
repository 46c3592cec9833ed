//! Particles sorted in space: into rows with periodic images as ghosts, or into columns in fixed point.

mod around;
mod axis;
mod cell_grid;
mod cell_sort;
mod cells;
mod column_grid;
mod columns;
mod coordinates;
mod fixed;
mod fold;
mod layers;
mod positions;
mod row_table;

pub use around::Around;
pub(crate) use axis::{CellRange, wrap_cell};
pub use cells::Cells;
pub(crate) use column_grid::ColumnGrid;
pub use columns::ColumnTable;
pub use coordinates::{PADDING, RowCoordinates};
pub use fixed::{FIXED_ROUNDING, FIXED_UNITS, FixedRow, to_fixed};
pub use positions::{GridError, Positions, Ranks};
pub use row_table::{Ghost, RowTable};
