//! The static structure factor.

mod partial;

use std::f64::consts::PI;

use crate::{
    BuildContext, Findings, Observable, ObservableError, ObservableSpec, Surroundings, Table,
    recipe,
};
use lennard_core::{SpeciesTable, View, persist};

use crate::averages::{of_blocks, tell_discarded};
use crate::binned::Binned;
use crate::error::{positive, within};
use crate::extrema::{extrema, fitted_extremum};
use crate::seen_box::SeenBox;
use crate::wave_vectors::WaveVectors;

use partial::Kind;

const SPEC: ObservableSpec = ObservableSpec {
    name: "structure-factor",
    summary: "static structure factor S(k) by a direct sum over wave vectors of the box, and its first peak",
    equation: "S(k) = ⟨|Σ_j exp(−i k·r_j)|²⟩/N, k = 2π(n_x/L_x, n_y/L_y, n_z/L_z) ≠ 0",
    source: "J.-P. Hansen and I. R. McDonald, Theory of Simple Liquids, 4th ed. (2013), equation 4.1.2; \
             freezing where the peak reaches 2.85: J.-P. Hansen and L. Verlet, Phys. Rev. 184, 151 (1969)",
    every: 100,
    surroundings: Surroundings::Periodic,
    alone: None,
    ..ObservableSpec::PLAIN
};

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
        k_max: f64 = 15.0, Between(1e-6, 1e6), in "σ⁻¹";
        /// Number of shells of equal width between 0 and `k_max`.
        shells: usize = 75, Whole(1, 1000);
        /// Wave vectors tried in each shell.
        directions: usize = 24, Whole(1, 1000);
    }
}

recipe!(StructureFactorOptions, |options, context| StructureFactor::new(options, context)?);

/// The static structure factor S(k) by a direct sum.
///
/// In each shell of wave numbers, evenly spread directions are rounded to wave vectors that fit the box.
/// The shells of a small box hold few different vectors, and some shells none. Each shell stands at the
/// mean wave number of its vectors. For an ideal gas S = 1 at every k. A mixture also has the factors of
/// its species.
#[derive(Debug, Clone, PartialEq)]
pub struct StructureFactor {
    seen: SeenBox,
    vectors: WaveVectors,
    species: SpeciesTable,
    factors: Binned<Kind>,
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
        let vectors = WaveVectors::in_shells(unit, options);
        let shells = vectors.shells();
        Ok(Self {
            seen: SeenBox::new(&context.cell),
            factors: Binned::new("factors", shells, Kind::of_mixture(&context.species)),
            species: context.species.clone(),
            vectors,
        })
    }
}

impl Observable for StructureFactor {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn sample(&mut self, view: &View<'_>) {
        self.seen.see(view.cell());
        let densities = self.sample_densities(view);
        let n = view.len() as f64;
        self.factors.whole.begin_sample();
        for (v, density) in self.vectors.iter().zip(densities) {
            self.factors.whole.add(v.shell, density.length_squared() / n, 1);
        }
    }

    fn finish(&self, discarded: f64) -> Findings {
        let mut findings = Findings::default();
        let Binned { whole: factors, parts, .. } = self.factors.after(discarded);
        if factors.samples() == 0 {
            return findings;
        }
        let wave_numbers = self.vectors.wave_numbers(self.seen.sides());
        let [values, errors] = factors.curve(0..wave_numbers.len(), 1.0);
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
                findings.remark(format!(
                    "first peak of S(k) at k = {:.3} σ⁻¹; a fluid freezes where it reaches 2.85 (Hansen and Verlet)",
                    top(&values).0
                ));
            }
            None => findings.remark("S(k) has no peak"),
        }
        let partial = self.finish_partial(&parts, &wave_numbers, &mut findings);
        tell_discarded(&mut findings, self.factors.whole.samples() - factors.samples());
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

persist!(StructureFactor { ..factors, seen as "box", fixed vectors, species });

#[cfg(test)]
mod tests;
