//! Particles sorted in space: into rows with periodic images as ghosts, or into columns in fixed point.

mod around;
mod cell_sort;
mod cells;
mod columns;
mod coordinates;
mod positions;
mod row_table;

pub use around::Around;
pub use cells::Cells;
pub(crate) use cells::{CellRange, wrap_cell};
pub(crate) use columns::ColumnGrid;
pub use columns::ColumnTable;
pub use coordinates::{FIXED_ROUNDING, FIXED_UNITS, FixedRow, PADDING, RowCoordinates, to_fixed};
pub use positions::{GridError, Positions, Ranks};
pub use row_table::{Ghost, RowTable};
