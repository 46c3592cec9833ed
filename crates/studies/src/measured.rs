//! What the parts of a study of claims have measured.

use lennard_observables::Table;

use crate::claims::Numbers;
use crate::report::Given;

/// Tables and numbers, to which each part of a study adds its own.
#[derive(Debug, Default)]
pub(crate) struct Measured {
    /// Tables with every digit: they are in the record, and files.
    pub tables: Vec<Table>,
    /// Tables of curves, which are files and figures alone.
    pub curves: Vec<Table>,
    /// The numbers that judge claims.
    pub numbers: Numbers,
    /// Words and lists of the page, and tables of the page alone.
    pub given: Given,
}

impl Measured {
    /// Words that the text of the page has in braces.
    pub fn word(&mut self, name: &'static str, word: String) {
        self.given.words.push((name, word));
    }
}
