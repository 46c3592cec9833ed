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
