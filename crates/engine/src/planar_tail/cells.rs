//! Sums over waves along z by cells, in time that hardly depends on the number of waves.
//!
//! Inside a cell, the cosine and the sine of each wave are polynomials. Particles give moments to cells, and moments of cells
//! give S_n. The way back gives a polynomial of the force to each cell.
//!
//! ```text
//!   z      |----•--|•------|---••--|--       cells of the width L_z/M, with centers at multiples of it
//!   y     -1   0   1                         y = (z − center)/(half a width)
//!   row    [Σ 1, Σ y, Σ y², … Σ y⁷]          one for each cell
//!   S_n  = Σ_cells exp(i·k_n·center)·Σ_p a_p(n)·iᵖ·row[p]
//! ```
//!
//! One polynomial serves sums and forces. The force of j on i is therefore the opposite of the force of i on j, to the
//! last bits.

use std::f64::consts::{PI, TAU};

use lennard_core::lanes::in_lanes;
use lennard_core::parallel::{CHUNK, for_each_piece, part};
use lennard_core::tasks::map_tasks;
use lennard_core::{DVec3, Team};

/// Terms of a polynomial.
pub(super) const TERMS: usize = 8;
/// Cells for each wave. A force is then exact to some 10⁻¹⁰ of the largest force.
const CELLS_PER_WAVE: usize = 4;
/// Moments of a cell, or coefficients of its force.
pub(super) type Row = [f64; TERMS];

/// The cells of a box along z.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cells {
    /// 1/L_z of the waves, σ⁻¹.
    pub turns_per_length: f64,
    /// M/2, an even number. Cells are counted from −M/2 to M/2, and the last is the first once more.
    pub half: usize,
    /// cos and sin of 2πni/M for each wave n and for i up to M/4.
    pub turns: Vec<Vec<[f64; 2]>>,
    /// a_p of each wave: cos(k·z) = Σ a_p·yᵖ over even p, and sin(k·z) likewise over odd p.
    pub polynomials: Vec<Row>,
}

impl Cells {
    /// Cells for so many waves of a box.
    pub fn new(length: f64, waves: usize) -> Self {
        let quarter = (CELLS_PER_WAVE * waves).div_ceil(4);
        let cells = 4 * quarter;
        let turn = |n: usize, i: usize| {
            let (sin, cos) = (TAU * ((n * i) % cells) as f64 / cells as f64).sin_cos();
            [cos, sin]
        };
        let all = 1..=waves;
        let turns = all.clone().map(|n| (0..=quarter).map(|i| turn(n, i)).collect());
        Self {
            turns_per_length: 1.0 / length,
            half: 2 * quarter,
            turns: turns.collect(),
            polynomials: all.map(|n| polynomial(PI * n as f64 / cells as f64)).collect(),
        }
    }

    /// Cells that are stored.
    pub fn stored(&self) -> usize {
        2 * self.half + 1
    }
}

/// a_p of cos(q·y) for even p and of sin(q·y) for odd p, for |y| ≤ 1: the polynomial through the values at Chebyshev's nodes.
fn polynomial(q: f64) -> Row {
    let angle = |j: usize| PI * (j as f64 + 0.5) / TERMS as f64;
    let mut powers = [0.0; TERMS];
    // Coefficients of Chebyshev's polynomials T_m and T_{m+1}.
    let (mut chebyshev, mut next) = ([0.0; TERMS], [0.0; TERMS]);
    (chebyshev[0], next[1]) = (1.0, 1.0);
    for m in 0..TERMS {
        let value = |j: usize| {
            let x = q * angle(j).cos();
            let value = if m % 2 == 0 { x.cos() } else { x.sin() };
            value * (m as f64 * angle(j)).cos()
        };
        let mean = (0..TERMS).map(value).sum::<f64>() / TERMS as f64;
        let coefficient = if m == 0 { mean } else { 2.0 * mean };
        let mut after = chebyshev.map(|c| -c);
        for p in 0..TERMS {
            powers[p] += coefficient * chebyshev[p];
            if p > 0 {
                after[p] += 2.0 * next[p - 1];
            }
        }
        (chebyshev, next) = (next, after);
    }
    powers
}

// The four passes between particles, rows of cells, and waves, with the widest registers of the machine.
//
// Terms of a row lie side by side in registers. Products and sums are rounded one by one, so that registers change no bit.
// Cells i and −i, and i and M/2 − i, have the same cosines and sines but for signs: a quarter of the cells is summed.

/// Particles whose cells are found side by side.
const BLOCK: usize = 8;
/// The axis across the surfaces.
const Z: usize = 2;
const ZEROS: Row = [0.0; TERMS];
/// Added and taken away, it rounds numbers below 2¹¹ to multiples of 2⁻⁴⁰. Sums of 2¹³ of them are exact.
const ROUNDER: f64 = 1.5 * (1_u64 << 12) as f64;
/// 2⁴⁰.
const UNITS: f64 = (1_u64 << 40) as f64;
/// Added and taken away, it rounds numbers below 2⁵¹ to whole ones. The lowest bits of the sum are that whole number.
const TO_WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;

impl Cells {
    /// Σ cos and Σ sin of each wave.
    ///
    /// Moments are exact totals: each power is rounded to a multiple of 2⁻⁴⁰ first. They depend on no order of the particles. With
    /// a team, each rank gives the positions of some particles, and the sums are over all.
    pub fn sums(&self, positions: &[DVec3], team: Option<&Team>) -> Vec<[f64; 2]> {
        const { assert!(CHUNK <= 1 << 13, "the moments of a range are exact") };
        let n = positions.len();
        let of_range = |(): &mut (), k: usize| -> Vec<Row> {
            let positions = &positions[part(k, CHUNK, n)];
            in_lanes(
                #[inline(always)]
                || self.moments(positions),
            )
        };
        let mut of_ranges = map_tasks(n.div_ceil(CHUNK), of_range);
        let rows = if of_ranges.len() == 1 && team.is_none() {
            of_ranges.swap_remove(0)
        } else {
            exact_totals(self.stored(), &of_ranges, team)
        };
        in_lanes(
            #[inline(always)]
            || self.waves_of(&rows),
        )
    }

    /// Adds Σ_n (a_n·sin k_n·z + b_n·cos k_n·z) to F_z of particles, from a_n and b_n.
    pub fn push(&self, waves: &[[f64; 2]], positions: &[DVec3], forces: &mut [DVec3]) {
        let rows = &in_lanes(
            #[inline(always)]
            || self.rows_of(waves),
        );
        for_each_piece(forces, |first, forces| {
            let positions = &positions[first..first + forces.len()];
            in_lanes(
                #[inline(always)]
                || self.add_forces(rows, positions, forces),
            );
        });
    }
}

/// Sums of the moments of all ranges, in whole units of 2⁻⁴⁰: 2²³ particles fit into a cell.
fn exact_totals(stored: usize, of_ranges: &[Vec<Row>], team: Option<&Team>) -> Vec<Row> {
    let mut totals = vec![[0_i64; TERMS]; stored];
    for rows in of_ranges {
        for (total, row) in totals.iter_mut().zip(rows) {
            for (total, moment) in total.iter_mut().zip(row) {
                *total += (moment * UNITS) as i64;
            }
        }
    }
    if let Some(team) = team {
        team.sum(totals.as_flattened_mut());
    }
    let in_units = |row: [i64; TERMS]| row.map(|total| total as f64 / UNITS);
    totals.into_iter().map(in_units).collect()
}

/// The cell of a particle among the stored cells, and its distance y from the center in half widths.
#[derive(Clone, Copy, Default)]
struct Place {
    cell: usize,
    y: f64,
}

impl Place {
    /// The place at a height z. A height that is no number has some cell, and y is no number either.
    #[inline(always)]
    fn at(cells: &Cells, z: f64) -> Self {
        let turns = z * cells.turns_per_length;
        let in_box = turns - ((turns + TO_WHOLE) - TO_WHOLE);
        let width = (2 * cells.half) as f64;
        let shifted = in_box * width + TO_WHOLE;
        let from_middle = shifted.to_bits().wrapping_sub(TO_WHOLE.to_bits());
        let cell = from_middle.wrapping_add(cells.half as u64) as usize;
        Self { cell: cell.min(2 * cells.half), y: 2.0 * (in_box * width - (shifted - TO_WHOLE)) }
    }

    #[inline(always)]
    fn of_block(cells: &Cells, block: &[DVec3]) -> [Self; BLOCK] {
        let mut places = [Self::default(); BLOCK];
        for (place, r) in places.iter_mut().zip(block) {
            *place = Self::at(cells, r[Z]);
        }
        places
    }

    /// 1, y, y², …
    #[inline(always)]
    fn powers(self) -> Row {
        let y = self.y;
        let square = y * y;
        let low = [1.0, y, square, square * y];
        let high = low.map(|power| power * (square * square));
        std::array::from_fn(|p| if p < 4 { low[p] } else { high[p - 4] })
    }
}

impl Cells {
    /// Moments of all cells.
    #[inline(always)]
    fn moments(&self, positions: &[DVec3]) -> Vec<Row> {
        // Two rows for each cell: neighbors in the list are often in one cell, and would wait for each other.
        let mut pairs = vec![[ZEROS; 2]; self.stored()];
        for block in positions.chunks(BLOCK) {
            let places = Place::of_block(self, block);
            for (k, place) in places[..block.len()].iter().enumerate() {
                let powers = place.powers();
                let row = &mut pairs[place.cell][k % 2];
                for p in 0..TERMS {
                    row[p] += (powers[p] + ROUNDER) - ROUNDER;
                }
            }
        }
        let sum = |[a, b]: [Row; 2]| std::array::from_fn(|p| a[p] + b[p]);
        pairs.into_iter().map(sum).collect()
    }

    /// Sum and difference of the rows of cells i and −i, where these are two cells.
    #[inline(always)]
    fn both(&self, rows: &[Row], i: usize) -> [Row; 2] {
        let half = self.half;
        let (one, other) = (&rows[half + i], &rows[half - i]);
        if i == 0 {
            return [*one, ZEROS];
        }
        let sum = std::array::from_fn(|p| one[p] + other[p]);
        if i == half {
            return [sum, ZEROS];
        }
        [sum, std::array::from_fn(|p| one[p] - other[p])]
    }

    /// Σ cos and Σ sin of each wave, from the moments of cells.
    #[inline(always)]
    fn waves_of(&self, rows: &[Row]) -> Vec<[f64; 2]> {
        let half = self.half;
        let quarter = half / 2;
        // Of even waves, and of odd ones: what cosines and sines multiply.
        let mut even = vec![[ZEROS; 2]; quarter + 1];
        let mut odd = even.clone();
        for i in 0..quarter {
            let ([sum, difference], [far_sum, far_difference]) =
                (self.both(rows, i), self.both(rows, half - i));
            for p in 0..TERMS {
                even[i][0][p] = sum[p] + far_sum[p];
                even[i][1][p] = difference[p] - far_difference[p];
                odd[i][0][p] = sum[p] - far_sum[p];
                odd[i][1][p] = difference[p] + far_difference[p];
            }
        }
        let [sum, difference] = self.both(rows, quarter);
        (even[quarter][0], odd[quarter][1]) = (sum, difference);
        let of_wave = |(index, (turns, a)): (usize, (&Vec<[f64; 2]>, &Row))| {
            let n = index + 1;
            let folded = if n % 2 == 0 { &even } else { &odd };
            let (mut c, mut s) = (ZEROS, ZEROS);
            for ([cos, sin], [with_cos, with_sin]) in turns.iter().zip(folded) {
                for p in 0..TERMS {
                    c[p] += cos * with_cos[p];
                    s[p] += sin * with_sin[p];
                }
            }
            let (mut re, mut im) = (0.0, 0.0);
            for p in (0..TERMS).step_by(2) {
                re += a[p] * c[p] - a[p + 1] * s[p + 1];
                im += a[p] * s[p] + a[p + 1] * c[p + 1];
            }
            [re, im]
        };
        let both = self.turns.iter().zip(&self.polynomials);
        both.enumerate().map(of_wave).collect()
    }

    /// Coefficients of the force in each cell, from coefficients of sines and cosines of the waves.
    #[inline(always)]
    fn rows_of(&self, waves: &[[f64; 2]]) -> Vec<Row> {
        let half = self.half;
        // a·sin(k·center + q·y) + b·cos(k·center + q·y): what cos(k·center) and sin(k·center) multiply.
        let of_wave = |(polynomial, [a, b]): (&Row, &[f64; 2])| -> [Row; 2] {
            let (mut with_cos, mut with_sin) = (ZEROS, ZEROS);
            for p in (0..TERMS).step_by(2) {
                with_cos[p] = polynomial[p] * b;
                with_cos[p + 1] = polynomial[p + 1] * a;
                with_sin[p] = polynomial[p] * a;
                with_sin[p + 1] = -polynomial[p + 1] * b;
            }
            [with_cos, with_sin]
        };
        let both = self.polynomials.iter().zip(waves);
        let waves: Vec<[Row; 2]> = both.map(of_wave).collect();
        let mut rows = vec![ZEROS; self.stored()];
        for i in 0..=half / 2 {
            // Sums over odd waves, and over even ones.
            let (mut c, mut s) = ([ZEROS; 2], [ZEROS; 2]);
            let all = self.turns.iter().zip(&waves).enumerate();
            for (index, (turns, [with_cos, with_sin])) in all {
                let [cos, sin] = turns[i];
                let kind = index % 2;
                for p in 0..TERMS {
                    c[kind][p] += cos * with_cos[p];
                    s[kind][p] += sin * with_sin[p];
                }
            }
            for p in 0..TERMS {
                let (near, far) = (c[1][p] + c[0][p], c[1][p] - c[0][p]);
                let (near_sine, far_sine) = (s[1][p] + s[0][p], s[0][p] - s[1][p]);
                rows[half + i][p] = near + near_sine;
                rows[half - i][p] = near - near_sine;
                rows[2 * half - i][p] = far + far_sine;
                rows[i][p] = far - far_sine;
            }
        }
        rows
    }

    /// Adds F_z to the forces, from the coefficients of cells.
    #[inline(always)]
    fn add_forces(&self, rows: &[Row], positions: &[DVec3], forces: &mut [DVec3]) {
        let blocks = positions.chunks(BLOCK);
        for (block, forces) in blocks.zip(forces.chunks_mut(BLOCK)) {
            let places = Place::of_block(self, block);
            for (place, force) in places.iter().zip(forces) {
                let powers = place.powers();
                let row = &rows[place.cell];
                let pair = |p: usize| powers[p] * row[p] + powers[p + 4] * row[p + 4];
                let sums: [f64; 4] = std::array::from_fn(pair);
                force[Z] += (sums[0] + sums[2]) + (sums[1] + sums[3]);
            }
        }
    }
}

#[cfg(test)]
mod tests;
