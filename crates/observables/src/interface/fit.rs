//! The density across a slab as two hyperbolic tangents.

/// Parameters of the fit.
const PARAMETERS: usize = 6;
/// Most steps of the fit.
const MOST_STEPS: usize = 200;
/// The fit has ended where a step changes the sum of squares by less than this part.
const CONVERGED: f64 = 1e-12;
/// The width with which the fit begins, σ.
const FIRST_WIDTH: f64 = 2.0;
/// The part of the box about its middle, and about its ends, from which the fit takes its first densities.
const BULK: f64 = 0.05;

/// ρ(z) = ρ_v + ½(ρ_l − ρ_v)·{tanh[2(z − z₁)/D₁] − tanh[2(z − z₂)/D₂]}, fitted by least squares with equal weights.
///
/// Source: J. P. R. B. Walton, D. J. Tildesley, J. S. Rowlinson and J. R. Henderson, Mol. Phys. 48, 1357 (1983).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slab {
    /// ρ_v, σ⁻³.
    pub vapor: f64,
    /// ρ_l − ρ_v, σ⁻³.
    pub contrast: f64,
    /// Places z₁ and z₂ of the two surfaces, σ.
    pub places: [f64; 2],
    /// Widths D₁ and D₂ of the two surfaces, σ.
    pub widths: [f64; 2],
}

impl Slab {
    /// ρ_l, σ⁻³.
    pub fn liquid(&self) -> f64 {
        self.vapor + self.contrast
    }

    /// z₂ − z₁, σ.
    pub fn thickness(&self) -> f64 {
        self.places[1] - self.places[0]
    }

    /// The mean width D of the two surfaces, σ.
    pub fn width(&self) -> f64 {
        0.5 * (self.widths[0] + self.widths[1])
    }

    /// The density at z.
    pub fn at(&self, z: f64) -> f64 {
        self.value_and_slopes(z).0
    }

    /// The density at z with its derivatives by the parameters, in the order of [`Slab::from_numbers`].
    fn value_and_slopes(&self, z: f64) -> (f64, [f64; PARAMETERS]) {
        let half = 0.5 * self.contrast;
        let surface = |k: usize| {
            let u = 2.0 * (z - self.places[k]) / self.widths[k];
            let tanh = u.tanh();
            (tanh, half * (1.0 - tanh * tanh), u)
        };
        let ((t1, s1, u1), (t2, s2, u2)) = (surface(0), surface(1));
        let [d1, d2] = self.widths;
        let slopes =
            [1.0, 0.5 * (t1 - t2), -2.0 * s1 / d1, 2.0 * s2 / d2, -s1 * u1 / d1, s2 * u2 / d2];
        (self.vapor + half * (t1 - t2), slopes)
    }

    fn from_numbers([vapor, contrast, z1, z2, d1, d2]: [f64; PARAMETERS]) -> Self {
        Self { vapor, contrast, places: [z1, z2], widths: [d1, d2] }
    }

    fn numbers(&self) -> [f64; PARAMETERS] {
        let ([z1, z2], [d1, d2]) = (self.places, self.widths);
        [self.vapor, self.contrast, z1, z2, d1, d2]
    }

    /// A first guess from a profile whose liquid is in the middle.
    pub fn guess(density: &[f64], length: f64) -> Option<Self> {
        let bins = density.len();
        let few = ((BULK * bins as f64) as usize).max(1);
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let middle = &density[bins / 2 - few..bins / 2 + few];
        let (first, last) = (&density[..few], &density[bins - few..]);
        let liquid = mean(middle);
        let vapor = 0.5 * (mean(first) + mean(last));
        let half = 0.5 * (liquid + vapor);
        let place = |k: usize| (k as f64 + 0.5) * length / bins as f64;
        let rises = (0..bins / 2).rev().find(|k| density[*k] < half)?;
        let falls = (bins / 2..bins).find(|k| density[*k] < half)?;
        Some(Self {
            vapor,
            contrast: liquid - vapor,
            places: [place(rises), place(falls)],
            widths: [FIRST_WIDTH; 2],
        })
    }

    /// The fit to a profile in equal bins over `length`, from a first guess, by the method of Levenberg and Marquardt; `None`
    /// where it does not converge to two surfaces inside the box.
    pub fn fit(density: &[f64], length: f64, guess: Self) -> Option<Self> {
        let step = length / density.len() as f64;
        let points = || {
            let bins = density.iter().enumerate();
            bins.map(move |(k, rho)| ((k as f64 + 0.5) * step, *rho))
        };
        let squares = |slab: &Self| -> f64 {
            points().map(|(z, rho)| (rho - slab.at(z)).powi(2)).sum::<f64>()
        };
        let mut slab = guess;
        let mut sum = squares(&slab);
        let mut damping = 1e-3;
        for _ in 0..MOST_STEPS {
            let mut matrix = [[0.0; PARAMETERS]; PARAMETERS];
            let mut vector = [0.0; PARAMETERS];
            for (z, rho) in points() {
                let (value, slopes) = slab.value_and_slopes(z);
                for (a, row) in matrix.iter_mut().enumerate() {
                    vector[a] += slopes[a] * (rho - value);
                    for (b, entry) in row.iter_mut().enumerate() {
                        *entry += slopes[a] * slopes[b];
                    }
                }
            }
            for (a, row) in matrix.iter_mut().enumerate() {
                row[a] *= 1.0 + damping;
            }
            let change = solve(matrix, vector)?;
            let mut next = slab.numbers();
            for (number, change) in next.iter_mut().zip(change) {
                *number += change;
            }
            let next = Self::from_numbers(next);
            let next_sum = squares(&next);
            let possible = next.widths.iter().all(|d| *d > 0.0) && next_sum.is_finite();
            if possible && next_sum <= sum {
                let done = sum - next_sum <= CONVERGED * sum;
                (slab, sum) = (next, next_sum);
                if done {
                    return slab.is_inside(length).then_some(slab);
                }
                damping *= 0.1;
            } else {
                damping *= 10.0;
                // No step downhill is left: rounding.
                if damping > 1e12 {
                    return slab.is_inside(length).then_some(slab);
                }
            }
        }
        None
    }

    /// Whether both surfaces lie inside the box, with liquid and vapor between them.
    fn is_inside(&self, length: f64) -> bool {
        let widest = self.widths[0].max(self.widths[1]);
        let [low, high] = self.places;
        let vapor = length - self.thickness();
        low > 0.0 && high < length && self.thickness() > widest && vapor > widest
    }
}

/// Solves A·x = b by elimination with pivots; `None` for a singular matrix.
fn solve(
    mut a: [[f64; PARAMETERS]; PARAMETERS],
    mut b: [f64; PARAMETERS],
) -> Option<[f64; PARAMETERS]> {
    for k in 0..PARAMETERS {
        let pivot = (k..PARAMETERS).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs()))?;
        a.swap(k, pivot);
        b.swap(k, pivot);
        if a[k][k] == 0.0 || !a[k][k].is_finite() {
            return None;
        }
        let (row, right) = (a[k], b[k]);
        for i in k + 1..PARAMETERS {
            let factor = a[i][k] / row[k];
            for (entry, above) in a[i].iter_mut().zip(row) {
                *entry -= factor * above;
            }
            b[i] -= factor * right;
        }
    }
    let mut x = [0.0; PARAMETERS];
    for k in (0..PARAMETERS).rev() {
        let known: f64 = (k + 1..PARAMETERS).map(|j| a[k][j] * x[j]).sum();
        x[k] = (b[k] - known) / a[k][k];
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRUE: Slab =
        Slab { vapor: 0.02, contrast: 0.71, places: [14.2, 29.1], widths: [2.1, 2.6] };
    const LENGTH: f64 = 45.0;

    fn profile(noise: f64) -> Vec<f64> {
        let deviates = crate::statistics::synthetic::Ar1::new(0.0, 4).series(180);
        let place = |k: usize| (k as f64 + 0.5) * LENGTH / 180.0;
        (0..180).map(|k| TRUE.at(place(k)) + noise * deviates[k]).collect()
    }

    #[test]
    fn a_profile_without_noise_gives_its_own_parameters() {
        let profile = profile(0.0);
        let guess = Slab::guess(&profile, LENGTH).unwrap();
        let found = Slab::fit(&profile, LENGTH, guess).unwrap();
        for (a, b) in found.numbers().into_iter().zip(TRUE.numbers()) {
            assert!((a - b).abs() < 1e-7, "{found:?}");
        }
    }

    #[test]
    fn slopes_are_those_of_differences() {
        for z in [3.0, 13.0, 15.0, 22.0, 29.0, 31.0] {
            let (_, slopes) = TRUE.value_and_slopes(z);
            for (k, slope) in slopes.into_iter().enumerate() {
                let moved = |h: f64| {
                    let mut numbers = TRUE.numbers();
                    numbers[k] += h;
                    Slab::from_numbers(numbers).at(z)
                };
                let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                assert!((slope - difference).abs() < 1e-9, "{z} {k}");
            }
        }
    }

    #[test]
    fn noise_moves_densities_by_its_own_error() {
        let profile = profile(0.01);
        let guess = Slab::guess(&profile, LENGTH).unwrap();
        let found = Slab::fit(&profile, LENGTH, guess).unwrap();
        // Some 60 bins of liquid and 110 of vapor with 0.01 each: four errors.
        assert!((found.liquid() - TRUE.liquid()).abs() < 4.0 * 0.01 / 60.0_f64.sqrt());
        assert!((found.vapor - TRUE.vapor).abs() < 4.0 * 0.01 / 110.0_f64.sqrt());
    }

    #[test]
    fn a_flat_profile_has_no_surfaces() {
        let flat = vec![0.3; 100];
        let guess = Slab::guess(&flat, LENGTH);
        assert_eq!(guess.and_then(|g| Slab::fit(&flat, LENGTH, g)), None);
    }
}
