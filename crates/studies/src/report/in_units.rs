//! Tables in units of a substance.

use lennard_literature::units::Units;
use lennard_observables::{Column, Table, Value};

use super::{Block, Section, significant};

/// The column whose words are the units of its rows.
const UNIT: &str = "Unit";

/// A table in units of a substance: columns that have a unit, or rows where a column names it.
#[must_use]
pub fn in_units(mut table: Table, units: &Units) -> Table {
    for Column { unit, cells, .. } in &mut table.columns {
        if let Some((one, physical)) = units.one(unit) {
            physical.clone_into(unit);
            cells.iter_mut().for_each(|cell| scale(&mut cell.value, one));
        }
    }
    let Some(column) = table.columns.iter().position(|column| column.name == UNIT) else {
        return table;
    };
    for row in 0..table.rows() {
        let Some(Value::Words(unit)) = table.columns[column].cells.get(row).map(|cell| &cell.value)
        else {
            continue;
        };
        if let Some((one, physical)) = units.one(unit) {
            let cells = table.columns.iter_mut().filter_map(|column| column.cells.get_mut(row));
            cells.for_each(|cell| scale(&mut cell.value, one));
            table.columns[column].cells[row].value = Value::Words(physical.to_owned());
        }
    }
    table
}

/// What the units are, and their source.
#[must_use]
pub fn in_words(units: &Units) -> String {
    format!("{}; {}", units.substance, units.substance.source)
}

/// A number in units of a substance, with four digits: `94.40 K`.
#[must_use]
pub fn physical(units: &Units, value: f64, reduced: &str) -> String {
    let (one, unit) = units.one(reduced).unwrap_or((1.0, reduced));
    format!("{} {unit}", significant(one * value, 4))
}

fn scale(value: &mut Value, by: f64) {
    match value {
        Value::Number { value, .. } => *value *= by,
        Value::Measured { value, error } => (*value, *error) = (*value * by, *error * by),
        Value::Missing | Value::Words(_) | Value::Figures(_) | Value::Whole(_) => {}
    }
}

impl Section {
    /// Its tables.
    pub fn tables(&self) -> impl Iterator<Item = &Table> {
        self.blocks.iter().filter_map(|block| match block {
            Block::Table(table) => Some(table),
            _ => None,
        })
    }

    /// With each table once more in units of a substance, where there is one.
    #[must_use]
    pub fn in_both(mut self, units: Option<&Units>) -> Self {
        let Some(units) = units else {
            return self;
        };
        let again = |block| match block {
            Block::Table(table) => {
                let physical = Block::Table(in_units(table.clone(), units));
                vec![Block::Table(table), Block::Text(in_words(units)), physical]
            }
            block => vec![block],
        };
        self.blocks = self.blocks.into_iter().flat_map(again).collect();
        self
    }
}
