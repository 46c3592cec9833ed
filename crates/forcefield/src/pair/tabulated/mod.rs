//! Potentials that a file lists as r, U and F, with a spline through them.

mod file;
mod rows;
mod spline;
mod store;

pub use rows::TableRows;
pub use store::{Checksum, TablePath, stored};

use file::Knot;
use spline::{Deviation, Spline};

/// A potential from a file: a spline through its rows, and the rows that kernels read.
#[derive(Debug)]
pub struct Tabulated {
    spline: Spline,
    rows: TableRows,
    /// Number of rows of the file.
    pub knots: usize,
    /// Smallest and largest distance of the file, σ.
    pub range: (f64, f64),
    /// The largest error that the spline states, of U and of F: relative to 1 + |U| and 1 + |F|.
    pub error: Deviation,
}

impl Tabulated {
    /// The potential that a text lists.
    ///
    /// # Errors
    /// What was found, and what is allowed, for the first row that is wrong.
    pub fn parse(text: &str) -> Result<Self, file::Refusal> {
        let knots = file::read(text)?;
        file::check(&knots)?;
        Ok(Self::new(&knots))
    }

    fn new(knots: &[Knot]) -> Self {
        let spline = Spline::through(knots);
        let rows = TableRows::of(&spline);
        let resolved = spline::left_out(knots);
        let stored = rows.deviation(&spline);
        Self {
            knots: knots.len(),
            range: (knots[0].r, knots[knots.len() - 1].r),
            error: Deviation {
                energy: resolved.energy + stored.energy,
                force: resolved.force + stored.force,
            },
            spline,
            rows,
        }
    }

    /// The rows that kernels read.
    pub fn rows(&self) -> &TableRows {
        &self.rows
    }

    /// U at the first row, ε.
    pub fn at_begin(&self) -> f64 {
        let r = self.range.0;
        self.spline.at(r * r).0
    }

    /// U and U′ at the end of the file, ε and ε/σ.
    pub fn at_end(&self) -> (f64, f64) {
        let r = self.range.1;
        let (energy, slope) = self.spline.at(r * r);
        (energy, 2.0 * r * slope)
    }

    /// The exponent p of the decay at the end of the file, −r·U′/U: U falls as r⁻ᵖ there. Not finite where U is 0.
    pub fn exponent_at_end(&self) -> f64 {
        let (energy, slope) = self.at_end();
        -self.range.1 * slope / energy
    }

    /// ∫ r² U dr from `r_cut` to the end of the file, ε·σ³: Gauss's rule of three points between knots, exact for the spline to
    /// rounding.
    pub fn integral(&self, r_cut: f64) -> f64 {
        self.spline.integral(r_cut)
    }
}

#[cfg(test)]
mod tests;
