//! The residual chemical potential, by trial particles.

mod trial;
mod weights;

use crate::{
    Average, BuildContext, Doubt, Findings, Observable, ObservableError, ObservableSpec, Recipe,
    Surroundings, statistics,
};
use lennard_core::{
    Persist, RestoreError, SpeciesTable, StateReader, StateWriter, View, persist, tasks,
};

use crate::averages::{FEWEST_INDEPENDENT, estimate_of_fluctuations, of_fluctuations};
use crate::cells::Cells;
use crate::error::within;
use crate::series::{Series, columns};

use trial::Trials;
pub use trial::{Insertion, TrialEnergies};
use weights::Weights;

const SPEC: ObservableSpec = ObservableSpec {
    name: "chemical-potential",
    summary: "residual chemical potential and ln z of each species, by trial particles that are put in and taken out (Widom)",
    equation: "mu_res = -T ln(<V e^(-dU/T)>/<V>); ln z = mu_res/T + ln rho",
    source: "B. Widom, J. Chem. Phys. 39, 2808 (1963); D. Frenkel and B. Smit, Understanding Molecular Simulation, 2nd ed. (2002), section 7.2",
    suits: crate::Suits::Atoms,
    every: 20,
    surroundings: Surroundings::Periodic,
    needs_temperature: true,
    alone: Some("tries particles at places all over the box"),
    ..ObservableSpec::PLAIN
};

/// Rows kept before neighbors are averaged in pairs.
const MOST_ROWS: usize = 1 << 15;
/// Trial particles that one task puts in.
const INSERTIONS_A_TASK: usize = 64;
/// The fewest trial particles that must carry the sum of the weights. The mean weight is then known to 10 %, and its
/// logarithm has no bias that counts.
const FEWEST_CARRIERS: f64 = 100.0;

lennard_core::options! {
    /// Options of [`ChemicalPotential`].
    pub struct ChemicalPotentialOptions {
        /// Trial particles of each species at each sample.
        insertions: usize = 1000, Whole(1, 10_000_000);
    }
}

impl Recipe for ChemicalPotentialOptions {
    const SPEC: &'static ObservableSpec = &SPEC;

    fn build(&self, context: &BuildContext) -> Result<Box<dyn Observable>, ObservableError> {
        within("insertions", self.insertions, 1..=10_000_000)?;
        let Some(insertion) = &context.insertion else {
            return Err(ObservableError::new(
                "kind",
                format!("{:?} without a bath", SPEC.name),
                "a measured stage whose bath holds one temperature",
            ));
        };
        Ok(Box::new(ChemicalPotential::new(self, context, insertion)))
    }
}

columns! {
    /// Mean weight of the trial particles of a sample times the volume, and the volume, σ³.
    struct Rows { weight, volume }
}

/// What was found for one species.
struct OfSpecies {
    trials: Trials,
    weights: Weights,
    series: Series<Rows>,
}

/// The residual chemical potential of each species, μ_res = −T·ln(⟨V·w⟩/⟨V⟩), ε, with the weight w = e^{−ΔU/T}.
///
/// ΔU is the energy of a trial particle at a random place: Σ u(r) over the particles within its cutoff, and
/// its tail V⁻¹·∂U_tail/∂N, which is twice the tail energy of a particle. T is the temperature that the bath holds. At constant
/// volume V cancels. At constant energy the mean has other weights, so that the temperature must be held.
///
/// `ln_activity` is ln z = μ_res/T + ln(N/⟨V⟩), with z = e^{μ/T}/Λ³ in σ⁻³: two phases in equilibrium share it.
///
/// Nothing is corrected for the size of the system. In a dense liquid few trial particles find a hole. Where fewer than 100
/// carry the sum, the number has no error, and the reason stands beside it.
pub struct ChemicalPotential {
    insertions: usize,
    temperature: f64,
    species: SpeciesTable,
    found: Vec<OfSpecies>,
    /// The longest cutoff of any two species, σ.
    longest: f64,
}

impl ChemicalPotential {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(
        options: &ChemicalPotentialOptions,
        context: &BuildContext,
        insertion: &Insertion,
    ) -> Self {
        let n_species = context.species.n_species();
        Self {
            insertions: options.insertions,
            temperature: insertion.temperature,
            species: context.species.clone(),
            found: (0..n_species)
                .map(|a| OfSpecies {
                    trials: Trials::new(a, n_species, insertion),
                    weights: Weights::new(),
                    series: Series::new(Rows::default(), MOST_ROWS),
                })
                .collect(),
            longest: context.r_cut,
        }
    }

    fn suffix(&self, species: usize) -> String {
        if self.species.is_mixture() {
            format!("_{}", self.species.name(species))
        } else {
            String::new()
        }
    }

    fn add_species(&self, of: &OfSpecies, discarded: f64, findings: &mut Findings) {
        let suffix = self.suffix(of.trials.species());
        let rows = of.series.rows();
        let cut = (discarded * of.series.len() as f64).round() as usize;
        let (weight, volume) = (&rows.weight[cut..], &rows.volume[cut..]);
        let (mean_weight, mean_volume) = (statistics::mean(weight), statistics::mean(volume));
        let t = self.temperature;
        let residual = -t * (mean_weight / mean_volume).ln();
        // By how much each row moves the logarithms of the two means.
        let of_weight = |w: &f64| w / mean_weight - 1.0;
        let both: Vec<[f64; 2]> =
            weight.iter().zip(volume).map(|(w, v)| [of_weight(w), v / mean_volume - 1.0]).collect();
        let n = self.species.count(of.trials.species()) as f64;
        let rare = self.too_rare(of);
        let average = |name: &str, unit: &str, mean: f64, influence: Vec<f64>| -> Average {
            let mut estimate = estimate_of_fluctuations(&influence);
            estimate.mean = mean;
            estimate.equilibration_cut = cut as u64 * of.series.stride();
            let name = format!("{name}{suffix}");
            of_fluctuations(&name, unit, estimate, &influence, FEWEST_INDEPENDENT)
                .doubted(rare.clone())
        };
        findings.averages.push(average(
            "residual_chemical_potential",
            "ε",
            residual,
            both.iter().map(|[w, v]| -t * (w - v)).collect(),
        ));
        findings.averages.push(average(
            "ln_activity",
            "",
            n.ln() - mean_weight.ln(),
            both.iter().map(|[w, _]| -w).collect(),
        ));
        if of.weights.insertions() == 0 {
            return;
        }
        findings.tables.push(of.weights.table(&suffix));
        let tail = of.trials.tail(mean_volume);
        let tail = if tail == 0.0 {
            "no tail: μ is of the truncated potential".to_owned()
        } else {
            format!(
                "a trial particle has a tail of {tail:.4} ε, twice the tail energy of a particle"
            )
        };
        findings.remark(format!(
            "μ{suffix}: {} trial particles; the best 1 % of them give {:.1} % of the sum, and {:.0} carry it; {tail}",
            of.weights.insertions(),
            100.0 * of.weights.share_of_best(),
            of.weights.carriers(),
        ));
    }

    /// The doubt where too few trial particles find room.
    fn too_rare(&self, of: &OfSpecies) -> Option<Doubt> {
        if of.weights.insertions() == 0 {
            return None;
        }
        let carriers = of.weights.carriers();
        if carriers >= FEWEST_CARRIERS {
            return None;
        }
        Some(Doubt::TooShort {
            why: format!(
                "the fluid is too dense for trial particles: {carriers:.0} of {} carry the sum where {FEWEST_CARRIERS} are needed",
                of.weights.insertions()
            ),
            longer: FEWEST_CARRIERS / carriers,
        })
    }
}

impl Observable for ChemicalPotential {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn sample(&mut self, view: &View<'_>) {
        let (cell, positions) = (view.cell(), &view.state.positions);
        let fluid: Vec<Cells> = (0..self.species.n_species())
            .map(|b| {
                let of_species = self.species.particles(b);
                let chosen: Vec<(u32, _)> = of_species.map(|i| (i as u32, positions[i])).collect();
                Cells::new(&chosen, cell, self.longest)
            })
            .collect();
        let (volume, insertions) = (cell.volume(), self.insertions);
        for of in &mut self.found {
            let tail = of.trials.tail(volume) / self.temperature;
            let (trials, place) = (&of.trials, of.trials.places(cell, view.state.step));
            // Each task gives the logarithms of its own weights: sums have one order on any number of threads.
            let tasks = insertions.div_ceil(INSERTIONS_A_TASK);
            let logarithms = tasks::map_tasks(tasks, |near: &mut Vec<f64>, task| {
                let own = lennard_core::parallel::part(task, INSERTIONS_A_TASK, insertions);
                own.map(|k| trials.log_weight(&fluid, place(k), near) - tail).collect::<Vec<f64>>()
            });
            let mut sum = 0.0;
            for log_weight in logarithms.into_iter().flatten() {
                let weight = log_weight.exp();
                sum += weight;
                of.weights.add(log_weight, weight * volume);
            }
            of.series.push(&[volume * sum / insertions as f64, volume]);
        }
    }

    fn finish(&self, discarded: f64) -> Findings {
        let mut findings = Findings::default();
        for of in &self.found {
            self.add_species(of, discarded, &mut findings);
        }
        findings
    }
}

persist!(OfSpecies { series, weights, fixed trials });

impl Persist for ChemicalPotential {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { insertions: _, temperature: _, species: _, found, longest: _ } = self;
        for (a, of) in found.iter().enumerate() {
            of.save(&mut to.section(&format!("species_{a}")));
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        for (a, of) in self.found.iter_mut().enumerate() {
            of.restore(&from.section(&format!("species_{a}")))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
