//! Wave vectors that fit the box, and the Fourier components ρ(k) = Σ_j exp(−i k·r_j) of positions.

use std::f64::consts::PI;

use glam::DVec2;
use lennard_core::{DVec3, Own, PeriodicBox, SpeciesTable};
use rayon::prelude::*;

use crate::StructureFactorOptions;

/// Particles whose phases are summed at once: constant, part of the definition of the sum.
const PARTICLES_A_CHUNK: usize = 256;

/// Two wave numbers are the same where they differ by less than this part.
const SAME_LENGTH: f64 = 1e-9;

/// A wave vector of a box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WaveVector {
    /// Multiples of 2π/L along the three axes; the first that is not zero is positive, because |ρ(k)|² is even.
    pub multiples: [i32; 3],
    /// Number of the shell of similar wave numbers.
    pub shell: usize,
}

impl WaveVector {
    /// k of a box with these sides (σ), in σ⁻¹.
    fn in_box(self, sides: DVec3) -> DVec3 {
        glam::IVec3::from_array(self.multiples).as_dvec3() * (2.0 * PI / sides)
    }
}

/// Wave vectors in shells of rising wave number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct WaveVectors {
    vectors: Vec<WaveVector>,
}

/// One of two opposite wave vectors: the first multiple that is not zero is positive.
fn upper_half(n: glam::IVec3) -> glam::IVec3 {
    let first = n.to_array().into_iter().find(|c| *c != 0);
    if first.is_some_and(|c| c < 0) { -n } else { n }
}

impl WaveVectors {
    /// Evenly spread directions in shells of equal width, rounded to vectors of the box; `unit` is 2π/L along each axis.
    pub(crate) fn in_shells(unit: DVec3, options: &StructureFactorOptions) -> Self {
        let mut vectors: Vec<WaveVector> = Vec::new();
        let width = options.k_max / options.shells as f64;
        for shell in 0..options.shells {
            for k in 0..options.directions {
                let wanted = direction(k, options.directions) * (shell as f64 + 0.5) * width;
                let n = (wanted / unit).round().as_ivec3();
                let length = (n.as_dvec3() * unit).length();
                if length > 0.0 && length <= options.k_max {
                    vectors.push(WaveVector {
                        multiples: upper_half(n).to_array(),
                        shell: ((length / width) as usize).min(options.shells - 1),
                    });
                }
            }
        }
        vectors.sort_by_key(|v| (v.shell, v.multiples));
        vectors.dedup();
        // Shells without a vector are left out: the others are numbered anew.
        let mut shells = 0;
        let mut last = None;
        for v in &mut vectors {
            if last != Some(v.shell) {
                last = Some(v.shell);
                shells += 1;
            }
            v.shell = shells - 1;
        }
        Self { vectors }
    }

    /// All vectors of the `shells` smallest wave numbers of a box with these sides, σ.
    pub(crate) fn smallest(sides: DVec3, shells: usize) -> Self {
        // The longest axis alone has as many multiples: no vector of the shells is longer than the last of them.
        let unit = 2.0 * PI / sides;
        let longest = unit.min_element() * shells as f64 * (1.0 + SAME_LENGTH);
        let most = (longest / unit).floor().as_ivec3();
        let mut found: Vec<(f64, [i32; 3])> = Vec::new();
        for x in -most.x..=most.x {
            for y in -most.y..=most.y {
                for z in -most.z..=most.z {
                    let n = glam::IVec3::new(x, y, z);
                    let length = (n.as_dvec3() * unit).length();
                    if n != glam::IVec3::ZERO && n == upper_half(n) && length <= longest {
                        found.push((length, n.to_array()));
                    }
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut vectors = Vec::new();
        let (mut shell, mut first) = (0, found.first().map_or(0.0, |(length, _)| *length));
        for (length, multiples) in found {
            if length > first * (1.0 + SAME_LENGTH) {
                shell += 1;
                first = length;
            }
            if shell == shells {
                break;
            }
            vectors.push(WaveVector { multiples, shell });
        }
        Self { vectors }
    }

    /// Number of vectors.
    pub(crate) fn len(&self) -> usize {
        self.vectors.len()
    }

    /// Number of shells.
    pub(crate) fn shells(&self) -> usize {
        self.vectors.last().map_or(0, |v| v.shell + 1)
    }

    /// The vectors, shell by shell.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &WaveVector> {
        self.vectors.iter()
    }

    /// Number of vectors in each shell.
    pub(crate) fn members(&self) -> Vec<usize> {
        let mut members = vec![0; self.shells()];
        for v in &self.vectors {
            members[v.shell] += 1;
        }
        members
    }

    /// Mean wave number of each shell in σ⁻¹, for a box with these sides, σ.
    pub(crate) fn wave_numbers(&self, sides: DVec3) -> Vec<f64> {
        let mut means = vec![0.0; self.shells()];
        let mut members = vec![0.0; means.len()];
        for v in &self.vectors {
            let length = v.in_box(sides).length();
            members[v.shell] += 1.0;
            means[v.shell] += (length - means[v.shell]) / members[v.shell];
        }
        means
    }

    /// Σ_j exp(−i k·r_j) over the particles of all ranks for each wave vector, as real and imaginary part. The positions are of those
    /// that this process keeps.
    pub(crate) fn densities(
        &self,
        own: &Own,
        positions: &[DVec3],
        cell: &PeriodicBox,
    ) -> Vec<DVec2> {
        let positions = &own.whole_runs(positions, PARTICLES_A_CHUNK)[..];
        let highest = |axis: usize| {
            self.vectors
                .iter()
                .map(|v| v.multiples[axis].unsigned_abs() as usize)
                .max()
                .unwrap_or(0)
        };
        let highest = [highest(0), highest(1), highest(2)];
        let parts: Vec<Vec<[f64; 2]>> = positions
            .par_chunks(PARTICLES_A_CHUNK)
            .map(|chunk| {
                let phases: [Phases; 3] =
                    std::array::from_fn(|axis| Phases::new(chunk, cell, axis, highest[axis]));
                self.vectors
                    .iter()
                    .map(|v| {
                        let [x, y, z] =
                            std::array::from_fn(|axis| phases[axis].of(v.multiples[axis]));
                        sum_of_products(x, y, z)
                    })
                    .collect()
            })
            .collect();
        let mut total = vec![0.0; 2 * self.vectors.len()];
        own.in_turn(&mut total, |total| {
            for part in &parts {
                for (total, part) in total.iter_mut().zip(part.as_flattened()) {
                    *total += part;
                }
            }
        });
        total.as_chunks().0.iter().map(|wave| DVec2::from_array(*wave)).collect()
    }

    /// The same sums over the particles of each species.
    pub(crate) fn densities_by_species(
        &self,
        own: &Own,
        species: &SpeciesTable,
        positions: &[DVec3],
        cell: &PeriodicBox,
    ) -> Vec<Vec<DVec2>> {
        let members = |a| species.particles(a).map(|i| positions[i]).collect::<Vec<DVec3>>();
        let of_species = |a| {
            let members = members(a);
            self.densities(&own.list(members.len()), &members, cell)
        };
        (0..species.n_species()).map(of_species).collect()
    }
}

/// Evenly spread directions: the k-th of `n` points of the Fibonacci spiral on the sphere.
fn direction(k: usize, n: usize) -> DVec3 {
    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
    let z = 1.0 - (2.0 * k as f64 + 1.0) / n as f64;
    let radius = (1.0 - z * z).sqrt();
    let angle = golden_angle * k as f64;
    DVec3::new(radius * angle.cos(), radius * angle.sin(), z)
}

/// exp(−2πi n x/L) of a chunk of particles along one axis for n = 0, 1, …: cosines and sines.
struct Phases {
    powers: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Phases {
    fn new(chunk: &[DVec3], cell: &PeriodicBox, axis: usize, highest: usize) -> Self {
        let side = cell.lengths()[axis];
        let (sin, cos): (Vec<f64>, Vec<f64>) =
            chunk.iter().map(|r| (-2.0 * PI * cell.wrap(*r)[axis] / side).sin_cos()).unzip();
        let mut powers = vec![(vec![1.0; chunk.len()], vec![0.0; chunk.len()])];
        for n in 0..highest {
            let (c, s) = &powers[n];
            // One multiplication a power: the rounding grows as n·2⁻⁵³.
            let next = (0..chunk.len())
                .map(|j| (c[j] * cos[j] - s[j] * sin[j], c[j] * sin[j] + s[j] * cos[j]))
                .unzip();
            powers.push(next);
        }
        Self { powers }
    }

    /// Cosines, sines and the sign of the latter: a negative multiple is the complex conjugate.
    fn of(&self, multiple: i32) -> (&[f64], &[f64], f64) {
        let (c, s) = &self.powers[multiple.unsigned_abs() as usize];
        (c, s, if multiple < 0 { -1.0 } else { 1.0 })
    }
}

type Phase<'a> = (&'a [f64], &'a [f64], f64);

fn sum_of_products(x: Phase<'_>, y: Phase<'_>, z: Phase<'_>) -> [f64; 2] {
    let (mut re, mut im) = (0.0, 0.0);
    for j in 0..x.0.len() {
        let (cx, sx) = (x.0[j], x.2 * x.1[j]);
        let (cy, sy) = (y.0[j], y.2 * y.1[j]);
        let (cz, sz) = (z.0[j], z.2 * z.1[j]);
        let (cxy, sxy) = (cx * cy - sx * sy, cx * sy + sx * cy);
        re += cxy * cz - sxy * sz;
        im += cxy * sz + sxy * cz;
    }
    [re, im]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_vectors_of_a_cube_are_in_shells_of_one_length() {
        let cube = WaveVectors::smallest(DVec3::splat(10.0), 4);
        // (1, 0, 0), (1, 1, 0), (1, 1, 1) and (2, 0, 0): half of 6, 12, 8 and 6 vectors.
        assert_eq!(cube.members(), [3, 6, 4, 3]);
        let numbers = cube.wave_numbers(DVec3::splat(10.0));
        for (k, square) in numbers.iter().zip([1.0, 2.0, 3.0, 4.0_f64]) {
            assert!((k - 0.2 * PI * square.sqrt()).abs() < 1e-12);
        }
    }

    #[test]
    fn the_smallest_vectors_of_a_long_box_lie_along_it() {
        let sides = DVec3::new(5.0, 5.0, 40.0);
        let long = WaveVectors::smallest(sides, 3);
        assert_eq!(long.members(), [1, 1, 1]);
        assert!(long.iter().all(|v| v.multiples[..2] == [0, 0]));
    }
}
