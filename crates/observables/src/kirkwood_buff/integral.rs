//! From counts of pairs to Kirkwood–Buff integrals.

use std::f64::consts::PI;

use crate::statistics::Line;

/// The volume of a sphere, σ³.
fn sphere(r: f64) -> f64 {
    4.0 / 3.0 * PI * r.powi(3)
}

/// The weight of h(r) at x = r/R for the integral over the infinite space, from h inside R alone:
///
/// w = 1 − (23/8)x³ + (3/4)x⁴ + (9/8)x⁵.
///
/// The integral over a finite volume differs from the infinite one by its surface over its volume, times a moment of h. The
/// weight takes that term off. It falls to 0 at R with slope 0, so that noise at large r does not add up.
///
/// P. Krüger and T. J. H. Vlugt, Phys. Rev. E 97, 051301 (2018).
fn weight(x: f64) -> f64 {
    1.0 - x.powi(3) * (23.0 / 8.0 - x * (0.75 + 1.125 * x))
}

/// The number of particles around a particle, in bins of equal width.
pub(super) struct Surroundings<'a> {
    /// Width of a bin, σ.
    pub width: f64,
    /// Mean number of neighbors in each bin.
    pub neighbors: &'a [f64],
    /// Number of particles of the neighbors' species in the box.
    pub others: f64,
    /// Whether the particle in the middle is one of those.
    pub alike: bool,
    /// Volume of the box, σ³.
    pub volume: f64,
}

impl Surroundings<'_> {
    /// g(r) of an infinite system in each bin.
    ///
    /// A box has a fixed number of particles. Those that gather inside r are missing outside, where the density is
    ///
    /// ρ·[N(1 − v) − ΔN − δ]/[N(1 − v)], with v = (4π/3)r³/V, ΔN the excess inside r, and δ = 1 for like particles.
    ///
    /// g is taken relative to that density. For an ideal gas it is 1 in every bin. (P. Ganguly and N. F. A. van der Vegt,
    /// J. Chem. Theory Comput. 9, 1347 (2013).)
    pub(super) fn distribution(&self) -> Vec<f64> {
        let density = self.others / self.volume;
        let own = if self.alike { 1.0 } else { 0.0 };
        let mut excess = 0.0;
        let bins = self.neighbors.iter().enumerate();
        bins.map(|(k, found)| {
            let (inner, outer) = (k as f64 * self.width, (k + 1) as f64 * self.width);
            let (shell, middle) = (sphere(outer) - sphere(inner), sphere(0.5 * (inner + outer)));
            let expected = density * shell;
            let here = found - expected;
            let all = self.others * (1.0 - middle / self.volume);
            let left = all - (excess + here * (middle - sphere(inner)) / shell) - own;
            excess += here;
            found / expected * all / left
        })
        .collect()
    }
}

/// ∫ [g(r) − 1]·w(r/R)·4πr² dr up to R = `bins`·`width`, in σ³.
pub(super) fn integral(g: &[f64], width: f64, bins: usize) -> f64 {
    let reach = bins as f64 * width;
    let shells = g.iter().take(bins).enumerate();
    shells
        .map(|(k, g)| {
            let (inner, outer) = (k as f64 * width, (k + 1) as f64 * width);
            let x = 0.5 * (inner + outer) / reach;
            (g - 1.0) * weight(x) * (sphere(outer) - sphere(inner))
        })
        .sum()
}

/// The value at k = 0 of the line through S(k²), with weights; not a number for fewer than two points.
pub(super) fn at_zero(squares: &[f64], values: &[f64], weights: &[f64]) -> f64 {
    let points = squares.iter().zip(values).zip(weights);
    Line::weighted(points.map(|((&x, &y), &weight)| (x, y, weight))).intercept()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// h = −e^{−r}·cos 3r has ∫h·4πr²dr = −8π·Re (1 − 3i)⁻³ = 208π/1000.
    #[test]
    fn the_weight_finds_the_infinite_integral_from_a_short_range() {
        let exact = 208.0 * PI / 1000.0;
        let of = |reach: f64, weighted: bool| {
            let bins = 2000;
            let width = reach / bins as f64;
            let g: Vec<f64> = (0..bins)
                .map(|k| (k as f64 + 0.5) * width)
                .map(|r| 1.0 - (-r).exp() * (3.0 * r).cos())
                .collect();
            match weighted {
                true => integral(&g, width, bins),
                // A sphere of this diameter: 1 − 3x/2 + x³/2.
                false => {
                    let shells = g.iter().enumerate();
                    let of_shell = |(k, g): (usize, &f64)| {
                        let (inner, outer) = (k as f64 * width, (k + 1) as f64 * width);
                        let x = 0.5 * (inner + outer) / reach;
                        (g - 1.0)
                            * (1.0 - 1.5 * x + 0.5 * x.powi(3))
                            * (sphere(outer) - sphere(inner))
                    };
                    shells.map(of_shell).sum()
                }
            }
        };
        for reach in [8.0, 12.0] {
            let (weighted, sphere) = (of(reach, true) - exact, of(reach, false) - exact);
            assert!(weighted.abs() < 0.25 * sphere.abs(), "{reach}: {weighted} {sphere}");
        }
        assert!((of(20.0, true) - exact).abs() < 0.003, "{}", of(20.0, true) - exact);
    }

    #[test]
    fn particles_that_gather_inside_are_given_back_outside() {
        // Ten neighbors more than expected in the first bin, taken from the rest of the box evenly.
        let (width, bins, volume, others) = (0.5, 9, 1000.0, 500.0);
        let shell = |k: usize| sphere((k + 1) as f64 * width) - sphere(k as f64 * width);
        let gathered = others / volume * shell(0) + 10.0;
        let outside = (others - gathered) / (volume - shell(0));
        let neighbors: Vec<f64> =
            (0..bins).map(|k| if k == 0 { gathered } else { outside * shell(k) }).collect();
        let around = Surroundings { width, neighbors: &neighbors, others, alike: false, volume };
        for (k, g) in around.distribution().iter().enumerate().skip(1) {
            assert!((g - 1.0).abs() < 1e-12, "{k}: {g}");
        }
    }

    #[test]
    fn a_line_through_weighted_points_meets_the_axis_where_it_should() {
        let x = [1.0, 2.0, 3.0, 4.0];
        let line: Vec<f64> = x.iter().map(|x| 0.3 - 0.05 * x).collect();
        assert!((at_zero(&x, &line, &[3.0, 6.0, 4.0, 3.0]) - 0.3).abs() < 1e-12);
        // With all weight on two points the line goes through those.
        assert!((at_zero(&x, &[1.0, 2.0, 0.0, 0.0], &[1.0, 1.0, 0.0, 0.0])).abs() < 1e-12);
    }
}
