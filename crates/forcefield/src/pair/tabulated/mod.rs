//! Potentials that a file lists as r, U and F, with a spline through them.

mod file;
mod spline;
mod store;

pub use store::{Checksum, TablePath, stored};

use crate::pair::Pair;
use file::Knot;
pub(crate) use spline::Cubic;
use spline::{Deviation, Spline};

/// What the rows of loops may add to the error of the spline, as a share of it.
pub const ROWS_ADD: f64 = 0.5;

/// A potential from a file: a spline through its rows.
#[derive(Debug)]
pub struct Tabulated {
    spline: Spline,
    /// Number of rows of the file.
    pub knots: usize,
    /// Smallest and largest distance of the file, σ.
    pub range: (f64, f64),
    /// The largest error that the spline states with the rows of loops, of U and of F: relative to 1 + |U| and 1 + |F|.
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
        Self {
            knots: knots.len(),
            range: (knots[0].r, knots[knots.len() - 1].r),
            error: spline::left_out(knots).times(1.0 + ROWS_ADD),
            spline: Spline::through(knots),
        }
    }

    /// U, −U′/r and U″ at r² = `r2` σ²; below the first row U is a straight line in r², and beyond the last one its cubic goes on.
    pub fn at(&self, r2: f64) -> Pair<f64> {
        let begin2 = self.range.0 * self.range.0;
        let (energy, slope, bend) = self.spline.at(r2.max(begin2));
        if r2 < begin2 {
            let force = -2.0 * slope;
            return Pair { energy: energy + slope * (r2 - begin2), force, curvature: -force };
        }
        // U″ = 2·dU/ds + 4s·d²U/ds².
        Pair { energy, force: -2.0 * slope, curvature: 2.0 * slope + 4.0 * r2 * bend }
    }

    /// U at the first row, ε.
    pub fn at_begin(&self) -> f64 {
        let r = self.range.0;
        self.at(r * r).energy
    }

    /// U and U′ at the end of the file, ε and ε/σ.
    pub fn at_end(&self) -> (f64, f64) {
        let r = self.range.1;
        let end = self.at(r * r);
        (end.energy, -end.force * r)
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
