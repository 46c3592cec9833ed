//! Pair laws as rows of numbers: cubics of −U′/r in s = r², found from the bits of s.
//!
//! ```text
//!   s·scale     1.0101 1101...·2^e     exponent and leading bits number a row; the other bits are the distance d from its begin
//!   a row       u, g₀, g₁, g₂|g₃       four numbers: the last bits of g₂, which are below its error, hold the leading bits of g₃
//!   −U′/r       g₀ + d·(g₁ + d·(g₂ + d·g₃))     with the −U′/r and its slope of the formula at both ends of the row
//!   U           u − ½ ∫ −U′/r ds                with the U of the formula at the begin of the row
//! ```
//!
//! Rows are of equal relative width. Their number follows from their error: it is the smallest that holds a [`Tolerance`]. Where a
//! formula gives way to another, s is scaled so that a row begins there.

use super::tabulated::Cubic;
use super::{Form, Pair, Side, Tolerance};
use crate::number::{Number, PairRows, RowsOf};

/// The smallest s that has a row, 2⁻²⁷ σ²: a pair nearer than 1e-4 σ has no finite force, and stops the run.
const SMALLEST: f64 = 7.450_580_596_923_828e-9;
/// Bits of the mantissa of s that number a row, from few rows for each octave to many.
const BITS: std::ops::RangeInclusive<u32> = 5..=11;
/// Where the error of a cubic is judged, as shares of its row.
const JUDGED_AT: [f64; 3] = [0.211_324_865, 0.5, 0.788_675_135];

/// A pair law that rows are made of, in units of its own σ and ε.
pub struct LawOfRows<'a> {
    /// r² where one formula gives way to another.
    pub joint2: Option<f64>,
    /// r² where values begin, below which U is a straight line in r²; none for a formula.
    pub begin2: Option<f64>,
    /// r² up to which there are rows.
    pub end2: f64,
    /// r_cut² of the form.
    pub r_cut2: f64,
    /// How far rows may be from it.
    pub tolerance: Tolerance,
    /// The values at r² by the formula of one side of the joint, which goes on beyond it.
    pub on: Box<dyn Fn(Side, f64) -> Pair<f64> + 'a>,
}

impl<'a> LawOfRows<'a> {
    /// The law of a form up to its cutoff.
    pub fn of(form: &'a Form, r_cut: f64) -> Self {
        Self {
            joint2: form.joint2(),
            begin2: form.formula.begin2(),
            end2: r_cut * r_cut,
            r_cut2: r_cut * r_cut,
            tolerance: form.formula.tolerance(),
            on: Box::new(|side, r2| form.on(side, r2)),
        }
    }

    /// Whether both are the same law of one formula.
    pub fn is(&self, other: &Self) -> bool {
        let ends = |law: &LawOfRows<'_>| (law.joint2, law.end2, law.r_cut2);
        ends(self) == ends(other)
    }
}

impl PairRows {
    /// Rows of these laws.
    ///
    /// # Errors
    /// The number of a law and the distance in its σ at which no number of rows holds its tolerance.
    pub fn new(laws: &[LawOfRows<'_>]) -> Result<Self, (usize, f64)> {
        let laws: Vec<Scaled<'_>> = laws.iter().map(Scaled::new).collect();
        let (mut wide, mut narrow) = (*BITS.start(), *BITS.start());
        for (number, law) in laws.iter().enumerate() {
            let fail = |r| (number, r);
            wide = wide.max(law.bits::<f64>(law.law.tolerance).map_err(fail)?);
            narrow = narrow.max(law.bits::<f32>(law.tolerance_of_singles()).map_err(fail)?);
        }
        Ok(Self {
            wide: rows_of(&laws, wide),
            narrow: rows_of(&laws, narrow),
            scales: laws.iter().map(|law| law.scale).collect(),
        })
    }
}

/// Rows of these laws with so many bits.
fn rows_of<T: Number>(laws: &[Scaled<'_>], bits: u32) -> RowsOf<T> {
    let grid = Grid { bits };
    let lowest = grid.before(SMALLEST);
    let end = laws.iter().map(|law| law.scale * law.law.end2).fold(0.0, f64::max);
    let highest = grid.next(grid.begin(end));
    let mut rows = Vec::new();
    for law in laws {
        let mut at = lowest;
        while at <= highest {
            rows.push(T::row(folded(law.row(grid, at), grid.next(at) - at)));
            at = grid.next(at);
        }
    }
    RowsOf {
        per_law: rows.len() / laws.len(),
        rows,
        lowest,
        highest,
        shift: T::MANTISSA - bits,
        first: T::of(lowest).bits() >> (T::MANTISSA - bits),
    }
}

/// A law in scaled s.
struct Scaled<'a> {
    law: &'a LawOfRows<'a>,
    scale: f64,
    /// The joint in scaled s, a power of two.
    joint: f64,
}

impl<'a> Scaled<'a> {
    fn new(law: &'a LawOfRows<'a>) -> Self {
        let (scale, joint) = match law.joint2 {
            Some(joint2) => {
                let joint = joint2.log2().round().exp2();
                (joint / joint2, joint)
            }
            None => (1.0, f64::INFINITY),
        };
        Self { law, scale, joint }
    }

    /// U, −U′/r and its slope by scaled s, on a side of the joint.
    fn at(&self, side: Side, scaled: f64) -> (f64, f64, f64) {
        let s = scaled / self.scale;
        let Pair { energy, force, curvature } = (self.law.on)(side, s);
        // U″ = −f − 2s·df/ds with f = −U′/r.
        (energy, force, -(curvature + force) / (2.0 * s * self.scale))
    }

    /// The side of the joint on which a row lies.
    fn side(&self, begin: f64) -> Side {
        if begin < self.joint { Side::Inside } else { Side::Outside }
    }

    /// The first row that has values of the law.
    fn begin(&self, grid: Grid) -> f64 {
        let Some(begin2) = self.law.begin2 else { return SMALLEST };
        let at = grid.begin(self.scale * begin2);
        if at < self.scale * begin2 { grid.next(at) } else { at }
    }

    /// u, g₀, g₁, g₂ and g₃ of a row.
    fn row(&self, grid: Grid, begin: f64) -> [f64; 5] {
        let first = self.begin(grid);
        let half = 0.5 / self.scale;
        if begin < first {
            if self.law.begin2.is_none() {
                return [f64::INFINITY, f64::INFINITY, 0.0, 0.0, 0.0];
            }
            let (energy, force, _) = self.at(self.side(first), first);
            return [energy + half * force * (first - begin), force, 0.0, 0.0, 0.0];
        }
        let (side, end) = (self.side(begin), grid.next(begin));
        let (energy, at_begin, slope) = self.at(side, begin);
        let (_, at_end, end_slope) = self.at(side, end);
        let cubic = Cubic::hermite(end - begin, (at_begin, slope), (at_end, end_slope));
        let [g0, g1, g2, g3] = cubic.0;
        [energy, g0, g1, g2, g3]
    }

    /// The fewest bits whose rows hold a tolerance.
    ///
    /// # Errors
    /// A distance at which no rows hold it.
    fn bits<T: Number>(&self, tolerance: Tolerance) -> Result<u32, f64> {
        let mut failed = 0.0;
        for bits in BITS {
            match self.missed::<T>(Grid { bits }, tolerance) {
                None => return Ok(bits),
                Some(r) => failed = r,
            }
        }
        Err(failed)
    }

    /// The largest distance at which rows miss a tolerance.
    fn missed<T: Number>(&self, grid: Grid, tolerance: Tolerance) -> Option<f64> {
        let end = self.scale * self.law.end2;
        let first = self.begin(grid);
        let mut begin = grid.begin(end);
        while begin >= first {
            let width = grid.next(begin) - begin;
            let row = self.row(grid, begin);
            if !has_room::<T>(row) {
                return None;
            }
            let [u, g0, g1, g2, g3] = unfolded(folded::<T>(row, width));
            for share in JUDGED_AT {
                let d = share * width;
                let s = (begin + d) / self.scale;
                if s > self.law.end2 {
                    continue;
                }
                let exact = (self.law.on)(Side::of(s, self.law.joint2), s);
                let integral = g0 + d * (g1 / 2.0 + d * (g2 / 3.0 + d * g3 / 4.0));
                let found = u - 0.5 / self.scale * d * integral;
                let force = g0 + d * (g1 + d * (g2 + d * g3));
                let r = s.sqrt();
                if !tolerance.holds([exact.energy, found], [r * exact.force, r * force]) {
                    return Some(r);
                }
            }
            begin = grid.before(begin);
        }
        None
    }

    /// The tolerance in single precision.
    fn tolerance_of_singles(&self) -> Tolerance {
        let (own, single) = (self.law.tolerance, Tolerance::SINGLE);
        Tolerance { energy: own.energy.max(single.energy), force: own.force.max(single.force) }
    }
}

/// Boundaries of rows: numbers with so many leading bits of a mantissa.
#[derive(Clone, Copy)]
struct Grid {
    bits: u32,
}

impl Grid {
    fn unit(self) -> u64 {
        1 << (<f64 as Number>::MANTISSA - self.bits)
    }

    /// The begin of the row of a number.
    fn begin(self, s: f64) -> f64 {
        f64::from_bits(s.to_bits() & !(self.unit() - 1))
    }

    /// The next boundary.
    fn next(self, boundary: f64) -> f64 {
        f64::from_bits(boundary.to_bits() + self.unit())
    }

    /// The boundary before.
    fn before(self, boundary: f64) -> f64 {
        f64::from_bits(boundary.to_bits() - self.unit())
    }
}

/// A row over a width, with the leading bits of g₃ in the last bits of g₂.
///
/// g₂ takes what g₃ loses at the end of the row. Where a cubic has no room, a straight line has its ends.
fn folded<T: Number>(row: [f64; 5], width: f64) -> [T; 4] {
    let [u, g0, g1, g2, g3] = row;
    if !has_room::<T>(row) {
        let rise = T::of(g1 + width * (g2 + width * g3));
        let rise = if rise.value().is_finite() { rise } else { T::of(0.0) };
        return [T::of(u), T::of(g0), rise, T::of(0.0)];
    }
    let (shift, unit) = (T::BITS - T::FOLDED, 1 << T::FOLDED);
    let leading = (T::of(g3).bits() + (1 << (shift - 1))) >> shift;
    let wanted = g2 + (g3 - T::from_bits(leading << shift).value()) * width;
    let begin = T::of(wanted).bits() & !(unit - 1) | leading;
    let near = [begin, begin.wrapping_add(unit), begin.wrapping_sub(unit)].map(T::from_bits);
    let off = |g: &T| (g.value() - wanted).abs();
    let best = near.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    [T::of(u), T::of(g0), T::of(g1), best.unwrap_or(near[0])]
}

/// Whether all numbers of a row, and some more than they, are finite as `T`.
fn has_room<T: Number>(row: [f64; 5]) -> bool {
    row.iter().all(|number| T::of(4.0 * number).value().is_finite())
}

/// u, g₀, g₁, g₂ and g₃ of a row, as loops take them.
fn unfolded<T: Number>([u, g0, g1, g2]: [T; 4]) -> [f64; 5] {
    let g3 = T::from_bits(g2.bits() << (T::BITS - T::FOLDED));
    [u, g0, g1, g2, g3].map(T::value)
}

#[cfg(test)]
mod tests;
