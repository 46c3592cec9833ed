//! Spherical harmonics of one order, summed over bonds, and their invariants.

use std::f64::consts::PI;

use lennard_core::DVec3;

/// The largest order that is kept.
const MOST: usize = 6;

/// Moments q_lm for m = 0 to l, each with real and imaginary part. Negative m follow: q_l,−m = (−1)^m·q_lm*.
pub(super) type Moments = [[f64; 2]; MOST + 1];

/// No bond yet.
pub(super) const NOTHING: Moments = [[0.0; 2]; MOST + 1];

/// The spherical harmonics of one order l.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Harmonics {
    l: usize,
    /// The factor of each m ≥ 0.
    factors: [f64; MOST + 1],
    /// (l l l; m₁ m₂ m₃) for m₁ + m₂ + m₃ = 0, with the three m.
    couplings: Vec<([i32; 3], f64)>,
}

impl Harmonics {
    /// Of order `l`, at most 6.
    pub(super) fn new(l: usize) -> Self {
        let mut factors = [0.0; MOST + 1];
        for (m, factor) in factors.iter_mut().enumerate().take(l + 1) {
            let share = factorial(l - m) / factorial(l + m);
            *factor = ((2 * l + 1) as f64 / (4.0 * PI) * share).sqrt();
        }
        let l = l as i32;
        let mut couplings = Vec::new();
        for a in -l..=l {
            for b in -l..=l {
                if (a + b).abs() <= l {
                    let m = [a, b, -a - b];
                    couplings.push((m, three_j(l, m)));
                }
            }
        }
        Self { l: l as usize, factors, couplings }
    }

    /// Adds Y_lm of the direction of a bond.
    pub(super) fn add(&self, to: &mut Moments, bond: DVec3) {
        let u = bond.normalize();
        // Legendre functions without their factor (1 − z²)^{m/2}, which (x + iy)^m brings.
        let (mut first, mut re, mut im) = (1.0, 1.0, 0.0);
        for (m, moment) in to.iter_mut().enumerate().take(self.l + 1) {
            let (mut before, mut now) = (0.0, first);
            for l in m + 1..=self.l {
                let up = u.z * (2 * l - 1) as f64 * now - (l + m - 1) as f64 * before;
                (before, now) = (now, up / (l - m) as f64);
            }
            let value = self.factors[m] * now;
            moment[0] += value * re;
            moment[1] += value * im;
            (re, im) = (re * u.x - im * u.y, re * u.y + im * u.x);
            first *= -((2 * m + 1) as f64);
        }
    }

    /// Σ_m a_lm·b_lm*, which is real.
    pub(super) fn product(&self, a: &Moments, b: &Moments) -> f64 {
        let of = |m: usize| a[m][0] * b[m][0] + a[m][1] * b[m][1];
        of(0) + 2.0 * (1..=self.l).map(of).sum::<f64>()
    }

    /// Q_l = √(4π/(2l + 1)·Σ_m |q_lm|²).
    pub(super) fn q(&self, moments: &Moments) -> f64 {
        (4.0 * PI / (2 * self.l + 1) as f64 * self.product(moments, moments)).sqrt()
    }

    /// W_l = Σ (l l l; m₁ m₂ m₃)·q_lm₁·q_lm₂·q_lm₃/(Σ_m |q_lm|²)^{3/2}; 0 where no moment is left but by rounding.
    pub(super) fn w(&self, moments: &Moments) -> f64 {
        let norm = self.product(moments, moments);
        if norm < ROUNDING {
            return 0.0;
        }
        let at = |m: i32| -> [f64; 2] {
            let [re, im] = moments[m.unsigned_abs() as usize];
            match (m < 0, m % 2 == 0) {
                (false, _) => [re, im],
                (true, true) => [re, -im],
                (true, false) => [-re, im],
            }
        };
        let sum: f64 = self
            .couplings
            .iter()
            .map(|(m, coupling)| {
                let [a, b, c] = m.map(at);
                let re = a[0] * b[0] - a[1] * b[1];
                let im = a[0] * b[1] + a[1] * b[0];
                coupling * (re * c[0] - im * c[1])
            })
            .sum();
        sum / norm.powf(1.5)
    }
}

/// Σ|q_lm|² below which moments are rounding.
const ROUNDING: f64 = 1e-20;

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

/// (l l l; m₁ m₂ m₃) by Racah's formula, for m₁ + m₂ + m₃ = 0.
fn three_j(l: i32, [a, b, c]: [i32; 3]) -> f64 {
    let f = |n: i32| factorial(n as usize);
    let triangle = f(l).powi(3) / f(3 * l + 1);
    let moments = [a, b, c].into_iter().map(|m| f(l + m) * f(l - m));
    let scale = (triangle * moments.product::<f64>()).sqrt();
    let sum: f64 = (0..=l)
        .filter_map(|t| {
            let parts = [t, a + t, t - b, l - t, l - t - a, l - t + b];
            let positive = parts.iter().all(|n| *n >= 0);
            let sign = if t % 2 == 0 { 1.0 } else { -1.0 };
            positive.then(|| sign / parts.map(f).iter().product::<f64>())
        })
        .sum();
    // The sign (−1)^{l₁ − l₂ − m₃} with l₁ = l₂.
    let sign = if c % 2 == 0 { 1.0 } else { -1.0 };
    sign * scale * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_j_symbols_are_orthogonal_and_have_tabulated_values() {
        // (2 2 2; 0 0 0) = −√(2/35) and (4 4 4; 0 0 0) = √(18/1001).
        assert!((three_j(2, [0; 3]) + (2.0_f64 / 35.0).sqrt()).abs() < 1e-14);
        assert!((three_j(4, [0; 3]) - (18.0_f64 / 1001.0).sqrt()).abs() < 1e-14);
        for l in [4, 6] {
            let squares: f64 = Harmonics::new(l).couplings.iter().map(|(_, c)| c * c).sum();
            assert!((squares - 1.0).abs() < 1e-12, "{l}");
        }
    }

    #[test]
    fn one_bond_has_q_one_in_any_direction() {
        for l in [4, 6] {
            let harmonics = Harmonics::new(l);
            for bond in [DVec3::X, DVec3::Z, DVec3::new(0.3, -0.8, 1.7)] {
                let mut moments = NOTHING;
                harmonics.add(&mut moments, bond);
                assert!((harmonics.q(&moments) - 1.0).abs() < 1e-14);
            }
        }
    }
}
