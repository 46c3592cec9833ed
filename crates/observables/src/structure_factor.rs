//! The static structure factor.

mod partial;

use std::f64::consts::PI;

use lennard_core::{
    DVec3, Findings, Observable, ObservableSpec, PeriodicBox, Persist, RestoreError, StateReader,
    StateWriter, Table, View, Want,
};
use rayon::prelude::*;

use crate::averages::{of_blocks, tell_discarded};
use crate::blocks::BlockedSums;
use crate::error::{positive, within};
use crate::extrema::{extrema, fitted_extremum};
use crate::seen_box::SeenBox;
use crate::{BuildContext, ObservableError, Recipe, Surroundings};

use partial::Partial;

const SPEC: ObservableSpec = ObservableSpec {
    name: "structure-factor",
    summary: "static structure factor S(k) by a direct sum over wave vectors of the box, and its first peak",
    equation: "S(k) = ⟨|Σ_j exp(−i k·r_j)|²⟩/N, k = 2π(n_x/L_x, n_y/L_y, n_z/L_z) ≠ 0",
    source: "J.-P. Hansen and I. R. McDonald, Theory of Simple Liquids, 4th ed. (2013), equation 4.1.2; \
             freezing where the peak reaches 2.85: J.-P. Hansen and L. Verlet, Phys. Rev. 184, 151 (1969)",
    dynamic: false,
    suits: lennard_core::Suits::All,
};

/// Blocks of the run from which the errors come.
const BLOCKS: usize = 64;

/// Particles whose phases are summed at once: constant, part of the definition of the sum.
const PARTICLES_A_CHUNK: usize = 256;

/// A peak counts where the curve has come down from it by this much, and by four standard errors.
const SMALLEST_PROMINENCE: f64 = 0.05;

/// Standard errors that a peak must stand out by.
const PROMINENCE_SIGMAS: f64 = 4.0;

/// A cubic is fitted to S(k) within this distance (σ⁻¹) of its first peak.
const PEAK_HALF_WIDTH: f64 = 0.8;

/// The largest multiple of 2π/L along an axis.
const LARGEST_MULTIPLE: f64 = 4096.0;

lennard_core::options! {
    /// Options of [`StructureFactor`].
    pub struct StructureFactorOptions {
        /// Largest wave number.
        k_max: f64 = 15.0, Positive, in "σ⁻¹";
        /// Number of shells of equal width between 0 and `k_max`.
        shells: usize = 75, Whole(1, 1000);
        /// Wave vectors tried in each shell.
        directions: usize = 24, Whole(1, 1000);
    }
}

impl Recipe for StructureFactorOptions {
    const SPEC: &'static ObservableSpec = &SPEC;

    fn default_every(&self) -> u64 {
        100
    }

    fn surroundings(&self) -> Surroundings {
        Surroundings::Periodic
    }

    fn build(&self, context: &BuildContext) -> Result<Box<dyn Observable>, ObservableError> {
        Ok(Box::new(StructureFactor::new(self, context)?))
    }
}

/// The static structure factor S(k) by a direct sum.
///
/// In each shell of wave numbers, evenly spread directions are rounded to wave vectors that fit the box;
/// the shells of a small box hold few different ones, some none. Each shell is told at the mean wave number
/// of its vectors. For an ideal gas S = 1 at every k. A mixture also has the factors of its species.
#[derive(Debug, Clone, PartialEq)]
pub struct StructureFactor {
    seen: SeenBox,
    vectors: Vec<WaveVector>,
    factors: BlockedSums,
    partial: Option<Partial>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct WaveVector {
    /// Multiples of 2π/L along the three axes; the first is not negative (S is even).
    multiples: [i32; 3],
    shell: usize,
}

impl StructureFactor {
    /// Nothing seen yet.
    ///
    /// # Errors
    /// [`ObservableError`] where `k_max` is not positive, fits no wave vector or too many, or there is no
    /// shell or direction.
    pub fn new(
        options: &StructureFactorOptions,
        context: &BuildContext,
    ) -> Result<Self, ObservableError> {
        positive("k_max", Some(options.k_max))?;
        within("shells", options.shells, 1..=10_000)?;
        within("directions", options.directions, 1..=10_000)?;
        let sides = context.cell.lengths();
        let unit = 2.0 * PI / sides;
        let (smallest, largest) = (unit.min_element(), LARGEST_MULTIPLE * unit.min_element());
        if !(smallest..=largest).contains(&options.k_max) {
            return Err(ObservableError::new(
                "k_max",
                options.k_max,
                format!("from {smallest} to {largest} σ⁻¹ in this box"),
            ));
        }
        let mut vectors: Vec<WaveVector> = Vec::new();
        let width = options.k_max / options.shells as f64;
        for shell in 0..options.shells {
            for k in 0..options.directions {
                let wanted = direction(k, options.directions) * (shell as f64 + 0.5) * width;
                let mut n = (wanted / unit).round().as_ivec3();
                let length = (n.as_dvec3() * unit).length();
                if n.to_array()
                    .into_iter()
                    .find(|c| *c != 0)
                    .is_some_and(|c| c < 0)
                {
                    n = -n;
                }
                if length > 0.0 && length <= options.k_max {
                    vectors.push(WaveVector {
                        multiples: n.to_array(),
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
        Ok(Self {
            seen: SeenBox::new(&context.cell),
            factors: BlockedSums::new(shells, BLOCKS),
            partial: Partial::new(&context.species, shells),
            vectors,
        })
    }

    /// Mean wave number of each shell in σ⁻¹, for the mean sides of the box.
    fn wave_numbers(&self) -> Vec<f64> {
        let unit = 2.0 * PI / self.seen.sides();
        let mut means = vec![0.0; self.factors.width()];
        let mut members = vec![0.0; means.len()];
        for v in &self.vectors {
            let length = (glam::IVec3::from_array(v.multiples).as_dvec3() * unit).length();
            members[v.shell] += 1.0;
            means[v.shell] += (length - means[v.shell]) / members[v.shell];
        }
        means
    }

    /// Σ_j exp(−i k·r_j) for each wave vector, as real and imaginary part.
    fn densities(&self, positions: &[DVec3], cell: &PeriodicBox) -> Vec<[f64; 2]> {
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
        let mut total = vec![[0.0; 2]; self.vectors.len()];
        for part in parts {
            for (t, p) in total.iter_mut().zip(part) {
                t[0] += p[0];
                t[1] += p[1];
            }
        }
        total
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
        let (sin, cos): (Vec<f64>, Vec<f64>) = chunk
            .iter()
            .map(|r| (-2.0 * PI * cell.wrap(*r)[axis] / side).sin_cos())
            .unzip();
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

impl Observable for StructureFactor {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn want(&self) -> Want {
        Want::NOTHING
    }

    fn sample(&mut self, view: &View<'_>) {
        self.seen.see(view.cell());
        let densities = self.sample_densities(&view.state.positions, view.cell());
        let n = view.state.len() as f64;
        self.factors.begin_sample();
        for (v, [re, im]) in self.vectors.iter().zip(densities) {
            self.factors.add(v.shell, (re * re + im * im) / n, 1);
        }
    }

    fn finish(&self, discarded: f64) -> Findings {
        let mut findings = Findings::default();
        let factors = self.factors.after(discarded);
        if factors.samples() == 0 {
            return findings;
        }
        let wave_numbers = self.wave_numbers();
        let shells = 0..wave_numbers.len();
        let values: Vec<f64> = shells
            .clone()
            .map(|k| factors.mean(k).unwrap_or(f64::NAN))
            .collect();
        let errors: Vec<f64> = shells.map(|k| factors.standard_error(k)).collect();
        let found = extrema(&wave_numbers, &values, |k| {
            let noise = if errors[k].is_nan() { 0.0 } else { errors[k] };
            SMALLEST_PROMINENCE.max(PROMINENCE_SIGMAS * noise)
        });
        match found.iter().find(|e| e.maximum) {
            Some(peak) => {
                let k = &wave_numbers;
                let top = |values: &[f64]| {
                    fitted_extremum(k, values, peak.place, PEAK_HALF_WIDTH, true)
                        // Where shells are few, and in a crystal, the peak is one shell.
                        .unwrap_or((peak.place, values[peak.bin]))
                };
                if let Some((height, blocks)) = factors.jackknife(|values| Some(top(values).1)) {
                    findings.averages.push(of_blocks(
                        "structure_factor_first_peak",
                        "",
                        height,
                        &blocks,
                        0.0,
                    ));
                }
                findings.remarks.push(format!(
                    "first peak of S(k) at k = {:.3} σ⁻¹; a fluid freezes where it reaches 2.85 (Hansen and Verlet)",
                    top(&values).0
                ));
            }
            None => findings.remarks.push("S(k) has no peak".into()),
        }
        let partial = self.finish_partial(discarded, &wave_numbers, &mut findings);
        tell_discarded(&mut findings, self.factors.samples() - factors.samples());
        let table = Table::new(
            "structure_factor",
            format!(
                "static structure factor over {} wave vectors and {} configurations",
                self.vectors.len(),
                factors.samples()
            ),
        )
        .with("k", "σ⁻¹", wave_numbers)
        .with("structure_factor", "", values)
        .with("standard_error", "", errors);
        let with = |table: Table, (name, numbers)| table.with(name, "", numbers);
        findings.tables.push(partial.into_iter().fold(table, with));
        findings
    }
}

impl Persist for StructureFactor {
    fn save(&self, to: &mut StateWriter<'_>) {
        self.factors.save(&mut to.section("factors"));
        self.seen.save(&mut to.section("box"));
        if let Some(partial) = &self.partial {
            partial.save(to);
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.factors.restore(&from.section("factors"))?;
        self.seen.restore(&from.section("box"))?;
        let partial = self.partial.as_mut();
        partial.map_or(Ok(()), |partial| partial.restore(from))
    }
}

#[cfg(test)]
mod tests;
