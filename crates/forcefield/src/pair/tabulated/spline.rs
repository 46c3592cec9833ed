//! The spline of a table: cubic in s = r², with the U and F of each row.

use super::file::Knot;

/// A cubic of the distance d from its begin, in s = r².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cubic(pub [f64; 4]);

impl Cubic {
    /// The cubic with the values and slopes of two rows (Hermite), from the first on.
    pub fn between(a: &Knot, b: &Knot) -> Self {
        Self::hermite(b.s() - a.s(), (a.energy, a.slope()), (b.energy, b.slope()))
    }

    /// The cubic over a width with these values and slopes at both ends.
    pub fn hermite(width: f64, (u0, slope0): (f64, f64), (u1, slope1): (f64, f64)) -> Self {
        let mean = (u1 - u0) / width;
        Self([
            u0,
            slope0,
            (3.0 * mean - 2.0 * slope0 - slope1) / width,
            (slope0 + slope1 - 2.0 * mean) / (width * width),
        ])
    }

    /// Value, slope and second derivative at a distance from the begin.
    pub fn at(&self, d: f64) -> (f64, f64, f64) {
        let [a, b, c, e] = self.0;
        let slope = b + d * (2.0 * c + d * (3.0 * e));
        (a + d * (b + d * (c + d * e)), slope, 2.0 * c + d * (6.0 * e))
    }
}

/// Deviations of U and of F, relative to 1 + |U| and 1 + |F|.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Deviation {
    /// Of U.
    pub energy: f64,
    /// Of F.
    pub force: f64,
}

impl Deviation {
    /// The deviations times a number.
    pub fn times(self, by: f64) -> Self {
        Self { energy: by * self.energy, force: by * self.force }
    }

    /// The larger deviations, with those at a distance where U, F and their errors are known.
    pub fn or(self, energy: (f64, f64), force: (f64, f64)) -> Self {
        let relative = |(value, error): (f64, f64)| error.abs() / (1.0 + value.abs());
        Self { energy: self.energy.max(relative(energy)), force: self.force.max(relative(force)) }
    }
}

/// The spline through all rows.
#[derive(Debug)]
pub struct Spline {
    begins: Vec<f64>,
    pieces: Vec<Cubic>,
    end: f64,
}

impl Spline {
    /// The spline that has U and F of every row: U and U′ are continuous.
    pub fn through(knots: &[Knot]) -> Self {
        let pairs = knots.windows(2);
        Self {
            begins: knots[..knots.len() - 1].iter().map(Knot::s).collect(),
            pieces: pairs.map(|two| Cubic::between(&two[0], &two[1])).collect(),
            end: knots[knots.len() - 1].s(),
        }
    }

    /// U, dU/ds and d²U/ds² at s; the first and the last piece go on beyond the ends.
    pub fn at(&self, s: f64) -> (f64, f64, f64) {
        let piece = self.begins.partition_point(|begin| *begin <= s).max(1) - 1;
        self.pieces[piece].at(s - self.begins[piece])
    }

    /// ∫ r² U dr = ½ ∫ √s U ds from r_cut² to the end.
    pub fn integral(&self, r_cut: f64) -> f64 {
        let from = r_cut * r_cut;
        let ends = self.begins.iter().skip(1).chain([&self.end]);
        let mut sum = 0.0;
        for (begin, end) in self.begins.iter().zip(ends) {
            let begin = begin.max(from);
            if begin >= *end {
                continue;
            }
            let (middle, half) = (0.5 * (begin + end), 0.5 * (end - begin));
            let reach = half * 0.6_f64.sqrt();
            let f = |s: f64| s.sqrt() * self.at(s).0;
            sum +=
                half / 9.0 * (5.0 * f(middle - reach) + 8.0 * f(middle) + 5.0 * f(middle + reach));
        }
        0.5 * sum
    }
}

/// The error of a spline through the rows, from splines that leave out one row each.
///
/// The cubic between the rows before and after a row misses its U by u₄·w⁴/384 in the middle, where w is the width and u₄ the fourth
/// derivative. Half the width leaves a 16th of it. The slope errs by √3/216·u₄·(w/2)³ at most.
pub fn left_out(knots: &[Knot]) -> Deviation {
    let mut largest = Deviation::default();
    for three in knots.windows(3) {
        let [before, at, after] = three else { continue };
        let (width, x) = (after.s() - before.s(), at.s() - before.s());
        let (energy, ..) = Cubic::between(before, after).at(x);
        // The error of a cubic is u₄/24·x²(w − x)².
        let shape = x * x * (width - x) * (width - x);
        let fourth = 24.0 * (energy - at.energy).abs() / shape;
        let step = x.max(width - x);
        let of_energy = fourth * step.powi(4) / 384.0;
        let of_slope = fourth * step.powi(3) * 3.0_f64.sqrt() / 216.0;
        let of_force = 2.0 * at.r * of_slope;
        largest = largest.or((at.energy, of_energy), (at.force, of_force));
    }
    largest
}
