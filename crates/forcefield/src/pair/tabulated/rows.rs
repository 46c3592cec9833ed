//! Rows of coefficients that pair loops read, found from the bits of r².

use super::spline::{Cubic, Deviation, Spline};

/// Bits of the mantissa of r² that number a row: 512 rows per octave of r², all of the same relative width.
const MANTISSA_BITS: u32 = 9;
/// Mantissa bits of double and of single precision.
const DOUBLE_BITS: u32 = 52;
const SINGLE_BITS: u32 = 23;

/// A row in double precision: U at its begin, and g₀, g₁ and g₂ of −U′/r = g₀ + d·(g₁ + d·g₂).
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub struct WideRow(pub [f64; 4]);

/// The same in single precision.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(16))]
pub struct NarrowRow(pub [f32; 4]);

/// Cubics of U in s = r² over rows of equal relative width.
///
/// Exponent and leading mantissa bits of s are the number of a row, and the same bits are its begin. The distance d from the begin is
/// exact. Row 0 goes on below the table as a straight line in s; one row more than the range needs makes every number of a
/// clamped s valid.
#[derive(Debug)]
pub struct TableRows {
    wide: Vec<WideRow>,
    narrow: Vec<NarrowRow>,
    lowest: f64,
    highest: f64,
}

/// Where the rows begin, and how to number them.
#[derive(Debug, Clone, Copy)]
pub struct Numbering<T> {
    /// The smallest s that has a row.
    pub lowest: f64,
    /// The largest s that has a row.
    pub highest: f64,
    /// What numbers a row after a shift: the number of the first row.
    pub first: T,
}

impl TableRows {
    /// Bits to shift away in double and in single precision.
    pub const SHIFTS: (u32, u32) = (DOUBLE_BITS - MANTISSA_BITS, SINGLE_BITS - MANTISSA_BITS);

    /// Rows for the range of a spline.
    pub fn of(spline: &Spline) -> Self {
        let (from, to) = spline.range();
        // The first row with values of the table begins at the first boundary inside it; row 0 is below.
        let mut at = boundary(from);
        if at < from {
            at = next(at);
        }
        let lowest = before(at);
        let mut cubics = vec![straight(lowest, at, spline.at(at))];
        while at < to {
            let end = next(at);
            cubics.push(Cubic::hermite(end - at, spline.at(at), spline.at(end)));
            at = end;
        }
        // Nothing beyond the cutoff counts: the last row only makes the number of `highest` valid.
        cubics.push(Cubic([0.0; 4]));
        let coefficients = |Cubic([u, b, c, e]): &Cubic| [*u, -2.0 * b, -4.0 * c, -6.0 * e];
        Self {
            wide: cubics.iter().map(|c| WideRow(coefficients(c))).collect(),
            narrow: cubics.iter().map(|c| NarrowRow(coefficients(c).map(|x| x as f32))).collect(),
            lowest,
            highest: at,
        }
    }

    /// The distance below which U goes on as a straight line in r², σ.
    pub fn begin(&self) -> f64 {
        next(self.lowest).sqrt()
    }

    /// The rows in double precision; a [`Numbering`] numbers them.
    #[inline(always)]
    pub fn wide(&self) -> (&[WideRow], Numbering<u64>) {
        let numbering = Numbering {
            lowest: self.lowest,
            highest: self.highest,
            first: self.lowest.to_bits() >> Self::SHIFTS.0,
        };
        (&self.wide, numbering)
    }

    /// The rows in single precision; all boundaries are numbers of single precision.
    #[inline(always)]
    pub fn narrow(&self) -> (&[NarrowRow], Numbering<u32>) {
        let numbering = Numbering {
            lowest: self.lowest,
            highest: self.highest,
            first: (self.lowest as f32).to_bits() >> Self::SHIFTS.1,
        };
        (&self.narrow, numbering)
    }

    /// Distance from the begin of its row, and the row, of one s in double precision.
    pub fn look_up(&self, s: f64) -> (f64, [f64; 4]) {
        // A number that is not a number becomes the lowest.
        let held = s.max(self.lowest).min(self.highest);
        let number = (held.to_bits() >> Self::SHIFTS.0) - (self.lowest.to_bits() >> Self::SHIFTS.0);
        (s - boundary(held), self.wide[number as usize].0)
    }

    /// How far rows and spline are apart at the most, halfway and where slopes of cubics differ most.
    pub fn deviation(&self, spline: &Spline) -> Deviation {
        let (_, to) = spline.range();
        let mut largest = Deviation::default();
        let mut begin = next(self.lowest);
        while begin < to {
            let width = next(begin) - begin;
            for share in [0.211_324_865, 0.5, 0.788_675_135] {
                let s = begin + share * width;
                if s > to {
                    continue;
                }
                let (d, [u, g0, g1, g2]) = self.look_up(s);
                let energy = u - 0.5 * d * (g0 + d * (0.5 * g1 + d * (g2 / 3.0)));
                let slope = -0.5 * (g0 + d * (g1 + d * g2));
                let (exact, exact_slope) = spline.at(s);
                let to_force = -2.0 * s.sqrt();
                largest = largest.or(
                    (exact, energy - exact),
                    (to_force * exact_slope, to_force * (slope - exact_slope)),
                );
            }
            begin += width;
        }
        largest
    }
}

/// The straight line with value and slope of the boundary above, counted from the begin below it.
fn straight(begin: f64, end: f64, (energy, slope): (f64, f64)) -> Cubic {
    Cubic([energy - slope * (end - begin), slope, 0.0, 0.0])
}

/// The begin of the row of s.
fn boundary(s: f64) -> f64 {
    f64::from_bits(s.to_bits() >> TableRows::SHIFTS.0 << TableRows::SHIFTS.0)
}

/// The next boundary.
fn next(boundary: f64) -> f64 {
    f64::from_bits(boundary.to_bits() + (1 << TableRows::SHIFTS.0))
}

/// The boundary before.
fn before(boundary: f64) -> f64 {
    f64::from_bits(boundary.to_bits() - (1 << TableRows::SHIFTS.0))
}
