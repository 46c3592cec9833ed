//! The transform of a tail along z.

use std::f64::consts::PI;

/// Where the transform ends, in cutoffs: what lies beyond is below 10⁻⁹ of it for r⁻⁶.
pub(super) const FARTHEST: f64 = 100.0;
/// Points of a panel.
const POINTS: usize = 16;
/// The length of a panel is at most this part of its distance.
const LONGEST_PANEL: f64 = 0.25;
/// Below this argument the functions of Bessel are taken by their series.
const SMALL: f64 = 0.3;

/// φ̂(k) and k·φ̂′(k), ε·σ³.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transform {
    pub value: f64,
    pub slope: f64,
}

/// The transform of w(r) = u(r) beyond `r_cut` and u(r_cut) inside, from u′(r) = `slope(r)`:
///
/// φ̂(k) = −4π·∫ r³·u′·F(kr) dr and k·φ̂′(k) = 4π·∫ r³·u′·j₂(kr) dr from r_cut on, with F(x) = j₁(x)/x.
///
/// Both follow from 4π·∫ r²·w·sin(kr)/(kr) dr by parts, since w is continuous. The second is the exact derivative of the first,
/// also of the sum over panels.
pub(super) fn transform(slope: &dyn Fn(f64) -> f64, r_cut: f64, k: f64) -> Transform {
    let rule = legendre();
    let end = FARTHEST * r_cut;
    let (mut value, mut derivative) = (0.0, 0.0);
    let mut start = r_cut;
    while start < end {
        let length = (LONGEST_PANEL * start).min(PI / k).min(end - start);
        for [x, weight] in &rule {
            let r = start + 0.5 * length * (x + 1.0);
            let part = 0.5 * length * weight * r.powi(3) * slope(r);
            let [f, j2] = bessel(k * r);
            value -= part * f;
            derivative += part * j2;
        }
        start += length;
    }
    Transform { value: 4.0 * PI * value, slope: 4.0 * PI * derivative }
}

/// The transform of 1 inside a sphere: 4π·r³·F(kr), σ³.
pub(super) fn of_sphere(radius: f64, k: f64) -> f64 {
    4.0 * PI * radius.powi(3) * bessel(k * radius)[0]
}

/// F(x) = (sin x − x·cos x)/x³ and j₂(x).
fn bessel(x: f64) -> [f64; 2] {
    let y = x * x;
    if x < SMALL {
        let f =
            1.0 / 3.0 - y / 30.0 + y * y / 840.0 - y.powi(3) / 45_360.0 + y.powi(4) / 3_991_680.0;
        let j2 = y / 15.0 - y * y / 210.0 + y.powi(3) / 7560.0 - y.powi(4) / 498_960.0;
        return [f, j2];
    }
    let (sin, cos) = x.sin_cos();
    let f = (sin - x * cos) / (x * y);
    [f, 3.0 * f - sin / x]
}

/// Nodes and weights of Gauss and Legendre on −1 to 1, the nodes by Newton's method.
fn legendre() -> [[f64; 2]; POINTS] {
    let n = POINTS as f64;
    std::array::from_fn(|i| {
        let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..10 {
            let (mut p, mut before) = (x, 1.0);
            for k in 2..=POINTS {
                let k = k as f64;
                (p, before) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k, p);
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        [x, 2.0 / ((1.0 - x * x) * slope * slope)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// u′ of Lennard-Jones.
    fn slope(r: f64) -> f64 {
        -48.0 * r.powi(-13) + 24.0 * r.powi(-7)
    }

    #[test]
    fn the_rule_integrates_polynomials_up_to_its_order() {
        for power in [0, 2, 10, 30] {
            let sum: f64 = legendre().iter().map(|[x, w]| w * x.powi(power)).sum();
            assert!((sum - 2.0 / f64::from(power + 1)).abs() < 1e-14, "{power}");
        }
    }

    #[test]
    fn series_and_formulas_of_the_bessel_functions_meet() {
        let below = bessel(SMALL - 1e-12);
        let above = bessel(SMALL + 1e-12);
        for (a, b) in below.into_iter().zip(above) {
            // The slopes over the gap, and the rounding of the formula.
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }

    #[test]
    fn a_long_wave_sees_the_whole_tail() {
        // φ̂(0) = −(4π/3)·∫ r³·u′ dr.
        let r = 2.5_f64;
        let whole = -4.0 * PI / 3.0 * (-48.0 / 9.0 * r.powi(-9) + 8.0 * r.powi(-3));
        let found = transform(&slope, r, 1e-4).value;
        assert!((found / whole - 1.0).abs() < 1e-5, "{found} {whole}");
    }

    #[test]
    fn the_slope_is_the_derivative_and_the_value_the_transform_along_z() {
        for k in [0.2, 0.9, 2.7] {
            let h = 1e-4;
            let at = |k| transform(&slope, 2.5, k);
            let difference = k * (at(k + h).value - at(k - h).value) / (2.0 * h);
            assert!((at(k).slope - difference).abs() < 1e-7, "{k}");
            // φ̂ = 2·∫ φ(ξ)·cos kξ dξ with the closed form of φ.
            let phi = |x: f64| {
                let m = x.max(2.5);
                let shift = 4.0 * (2.5_f64.powi(-12) - 2.5_f64.powi(-6));
                let plane = 4.0 * PI * (0.2 * m.powi(-10) - 0.5 * m.powi(-4));
                plane + PI * (6.25 - x * x).max(0.0) * shift
            };
            let steps = 400_000;
            let width = 100.0 / f64::from(steps);
            let sum: f64 = (0..steps)
                .map(|i| (f64::from(i) + 0.5) * width)
                .map(|x| 2.0 * width * phi(x) * (k * x).cos())
                .sum();
            assert!((at(k).value - sum).abs() < 1e-5, "{k}: {sum}");
        }
    }
}
