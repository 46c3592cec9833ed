//! A potential that a file lists.

use super::{LARGEST_EXPONENT, Potential, PotentialSpec, SMALLEST_EXPONENT};
use crate::pair::tabulated::{Checksum, ROWS_ADD, TablePath, Tabulated, stored};
use crate::pair::{Pair, PairPotential, Side, Tolerance};
use lennard_core::options::OptionError;

lennard_core::options! {
    /// A table: a file with the columns r, U and F = −U′ in σ, ε and ε/σ; a spline with the U and F of each row lies between.
    ///
    /// The spline is cubic in r² (Hermite), as in M. P. Allen and D. J. Tildesley, "Computer Simulation of Liquids", section 5.2.
    #[derive(Copy)]
    pub struct Table {
        /// The file, relative to the scene file.
        file: Option<TablePath> = None, else "needed", Words("the path of a file with the columns r, U and F");
        /// The checksum of the file (CRC-32), which every run writes into its scene; a file with another checksum is refused.
        checksum: Option<Checksum> = None, else "the checksum of the file", Words("eight hexadecimal digits in quotes");
        /// The exponent p of U ∝ r⁻ᵖ beyond the end of the table, for the tail correction.
        tail_exponent: Option<u32> = None, else "no tail correction", Whole(SMALLEST_EXPONENT, LARGEST_EXPONENT);
    }
}

/// By how much the decay at the end of a table may differ from `tail_exponent`.
const EXPONENT_MARGIN: f64 = 0.5;
/// A U and F at the end of a table below these, in ε and ε/σ, have no tail.
const NOTHING: f64 = 1e-12;

/// A pair is hardly ever nearer than where U is so many T: the share of such pairs is of the order e⁻¹⁰.
const OFTEN: f64 = 10.0;

impl Table {
    /// The table that a file holds.
    ///
    /// # Errors
    /// [`OptionError`] where there is no file, where it is no table, or where its content has changed.
    fn open(&self) -> Result<(&'static Tabulated, Checksum), OptionError> {
        let refuse = |found: String, allowed: String| OptionError { key: "file", found, allowed };
        let Some(path) = self.file else {
            return Err(OptionError {
                key: "kind",
                found: "\"table\" without a `file`".to_owned(),
                allowed: "`file`, the path of a file with the columns r, U and F".to_owned(),
            });
        };
        stored(path, self.checksum).map_err(|refusal| refuse(refusal.found, refusal.allowed))
    }

    /// The largest errors of the spline, of U and of F: relative to 1 + |U| and 1 + |F|.
    ///
    /// # Errors
    /// [`OptionError`] where the file is no table.
    pub fn stated_errors(&self) -> Result<(f64, f64), OptionError> {
        let (table, _) = self.open()?;
        Ok((table.error.energy, table.error.force))
    }

    /// The exponent of the tail, where U beyond the table is not zero.
    fn tail(&self, table: &Tabulated) -> Result<Option<u32>, OptionError> {
        let (energy, slope) = table.at_end();
        if energy.abs() < NOTHING && slope.abs() < NOTHING {
            return Ok(None);
        }
        let found = table.exponent_at_end();
        match self.tail_exponent {
            Some(p) if (found - f64::from(p)).abs() <= EXPONENT_MARGIN => Ok(Some(p)),
            Some(p) => Err(OptionError {
                key: "tail_exponent",
                found: p.to_string(),
                allowed: format!("the exponent of the decay at the end of the table, {found:.3}"),
            }),
            None => Err(OptionError {
                key: "file",
                found: format!("U ~ r^-{found:.3} at the end of the table, and no `tail_exponent`"),
                allowed:
                    "`tail_exponent` in [potential], or tail_correction = false in [truncation]"
                        .to_owned(),
            }),
        }
    }
}

impl Potential for Table {
    const SPEC: PotentialSpec = PotentialSpec {
        name: "table",
        title: "table",
        summary: "Any potential, from a file with the columns r, U and F.",
        equation: "cubic in r^2 between the rows, with U and F of each row",
        source: "M. P. Allen and D. J. Tildesley, Computer Simulation of Liquids, section 5.2",
        is_lennard_jones: false,
    };
    /// Each needs a file.
    const EXAMPLES: &'static [Self] = &[];
    type Formula = Formula;

    fn formula(&self) -> Formula {
        let (table, _) = self.open().expect("checked before");
        Formula { table, tail_exponent: self.tail_exponent }
    }

    fn in_words(&self) -> String {
        let Ok((table, checksum)) = self.open() else {
            return Self::SPEC.title.to_owned();
        };
        let name = self.file.and_then(|file| file.path().file_name());
        let name = name.unwrap_or_default().to_string_lossy();
        let (energy, force) = (table.error.energy, table.error.force);
        let mut words = format!(
            "table {name} ({} rows, checksum {checksum}, spline within {energy:.0e}·(1 + |U|) and {force:.0e}·(1 + |F|))",
            table.knots
        );
        if let Some(p) = self.tail_exponent {
            let error = self.formula().tail_error();
            words += &format!(", tail r^-{p} within {error:.1e} of ∫r²U dr");
        }
        words
    }

    fn check_together(&self) -> Result<(), OptionError> {
        self.open().map(drop)
    }

    fn check_with(&self, r_cut: f64, has_tail: bool) -> Result<(), OptionError> {
        let (table, _) = self.open()?;
        let end = table.range.1;
        if end < r_cut {
            return Err(OptionError {
                key: "file",
                found: format!("rows up to r = {end}"),
                allowed: format!("rows up to r_cut = {r_cut} at least"),
            });
        }
        if has_tail {
            self.tail(table)?;
        }
        Ok(())
    }

    /// That particles come nearer than the first row.
    fn remark_at(&self, temperature: f64) -> Option<String> {
        let (table, _) = self.open().ok()?;
        let (r, energy, enough) = (table.range.0, table.at_begin(), OFTEN * temperature);
        (energy < enough).then(|| {
            format!(
                "the table begins at r = {r} σ with U = {energy:.3} ε, below {OFTEN}·T = {enough:.3} ε: particles come nearer, where U is a \
                 straight line in r²; let it begin where U is larger"
            )
        })
    }

    fn file(&self) -> Option<TablePath> {
        self.file
    }

    fn with_file(&self, file: TablePath) -> Result<Self, OptionError> {
        let moved = Self { file: Some(file), ..*self };
        let (_, checksum) = moved.open()?;
        Ok(Self { checksum: Some(checksum), ..moved })
    }
}

/// The formula of a table.
#[derive(Clone, Copy, Debug)]
pub struct Formula {
    table: &'static Tabulated,
    tail_exponent: Option<u32>,
}

impl Formula {
    /// ∫ r² U dr from the end of the table to ∞ for U ∝ r⁻ᵖ, ε·σ³.
    fn beyond(&self, exponent: f64) -> f64 {
        let (energy, _) = self.table.at_end();
        energy * self.table.range.1.powi(3) / (exponent - 3.0)
    }

    /// By how much ∫ r² U dr beyond the table changes from the exponent of the options to the exponent at the end of the table.
    fn tail_error(&self) -> f64 {
        let written = self.tail_exponent.map_or(0.0, |p| self.beyond(f64::from(p)));
        (written - self.beyond(self.table.exponent_at_end())).abs()
    }
}

impl PairPotential for Formula {
    fn on(&self, _side: Side, r2: f64) -> Pair<f64> {
        self.table.at(r2)
    }

    fn begin2(&self) -> Option<f64> {
        Some(self.table.range.0 * self.table.range.0)
    }

    /// Rows add to the error of the spline what the table states.
    fn tolerance(&self) -> Tolerance {
        let added = self.table.error.times(ROWS_ADD / (1.0 + ROWS_ADD));
        let rows = Tolerance::FORMULA;
        Tolerance { energy: rows.energy.max(added.energy), force: rows.force.max(added.force) }
    }

    fn tail_energy(&self, r_cut: f64) -> f64 {
        let beyond = self.tail_exponent.map_or(0.0, |p| self.beyond(f64::from(p)));
        self.table.integral(r_cut) + beyond
    }

    /// By parts: ∫ r³U′ dr = −r_cut³·U(r_cut) − 3·∫ r²U dr, where r³U vanishes at ∞.
    fn tail_virial(&self, r_cut: f64) -> f64 {
        let r2 = r_cut * r_cut;
        let at_cut = self.table.at(r2).energy;
        let (end, (energy, _)) = (self.table.range.1, self.table.at_end());
        // Without a tail the integral ends with the table.
        let at_end = if self.tail_exponent.is_some() { 0.0 } else { end.powi(3) * energy };
        at_end - r_cut.powi(3) * at_cut - 3.0 * self.tail_energy(r_cut)
    }
}
