//! Particles sorted in space: into rows with periodic images as ghosts, or into columns in fixed point.

mod cell_sort;
mod cells;
mod columns;
mod coordinates;
mod parts;
mod positions;
mod row_table;

pub use cells::Cells;
pub(crate) use cells::{CellRange, wrap_cell};
pub(crate) use columns::ColumnGrid;
pub use columns::ColumnTable;
pub use coordinates::{
    FIXED_ROUNDING, FIXED_UNITS, FixedRow, PADDING, RowCoordinates, is_usable, to_fixed,
};
pub use parts::{Belongs, Beyond, Columns, with_rounding};
pub use positions::{GridError, Positions};
pub use row_table::{Ghost, RowTable};
