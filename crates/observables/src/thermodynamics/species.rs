//! The kinetic temperature of each species of a mixture.

use crate::Findings;
use lennard_core::{Persist, RestoreError, SpeciesTable, StateReader, StateWriter, View};

use super::MOST_ROWS;
use crate::series::{Series, columns};

/// Standard errors by which temperatures of two species may differ unsaid.
const EQUAL: f64 = 5.0;

/// The kinetic temperature of each species on whole steps,
///
/// T_a = 2K_a/(3N_a − κ·N_a·m_a/M),
///
/// where κ components of the total momentum are conserved and M is the mass of all. Of their motion a species lacks the share of
/// its mass, and in equilibrium all T_a are equal (equipartition).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SpeciesTemperatures {
    species: SpeciesTable,
    series: Vec<Series<Temperature>>,
}

columns! {
    struct Temperature { temperature }
}

impl SpeciesTemperatures {
    /// Nothing seen yet; `None` where there is one species.
    pub(super) fn new(species: &SpeciesTable) -> Option<Self> {
        let series = || Series::new(Temperature::default(), MOST_ROWS);
        species.is_mixture().then(|| Self {
            series: (0..species.n_species()).map(|_| series()).collect(),
            species: species.clone(),
        })
    }

    pub(super) fn sample(&mut self, view: &View<'_>) {
        let (velocities, masses) = (&view.state.velocities, &view.system.masses);
        let n = self.species.n_particles();
        let moves = |i: usize| f64::from(u8::from(!masses.is_held(i)));
        let moving = (n - masses.n_held()) as f64;
        let kept = 3.0 * moving - view.n_dof();
        let sum = |of: &(dyn Fn(usize) -> f64 + Sync)| -> f64 { view.sum(of) };
        let all = sum(&|i| masses.moving(i));
        for (a, series) in self.series.iter_mut().enumerate() {
            let of_species = |i: usize| f64::from(u8::from(self.species.of(i) == a));
            let mass = sum(&|i| of_species(i) * masses.moving(i));
            let twice = sum(&|i| of_species(i) * masses.moving(i) * velocities[i].length_squared());
            let count = sum(&|i| of_species(i) * moves(i));
            let n_dof = 3.0 * count - kept * mass / all;
            series.push(&[twice / n_dof]);
        }
    }

    pub(super) fn finish(&self, discarded: f64, findings: &mut Findings) {
        let mut averages = Vec::new();
        for (a, series) in self.series.iter().enumerate() {
            let column = &series.rows().temperature;
            let cut = (discarded * column.len() as f64).round() as usize;
            let name = format!("temperature_{}", self.species.name(a));
            averages.push(series.average(&name, "ε/k_B", column, cut));
        }
        for (a, first) in averages.iter().enumerate() {
            for second in &averages[a + 1..] {
                let (x, y) = (&first.estimate, &second.estimate);
                let errors = (x.mean - y.mean).abs() / x.standard_error.hypot(y.standard_error);
                if errors > EQUAL {
                    findings.remark(format!(
                        "{} and {} differ by {errors:.0} standard errors: the species are not in equilibrium with each other",
                        first.name, second.name
                    ));
                }
            }
        }
        findings.averages.extend(averages);
    }
}

impl Persist for SpeciesTemperatures {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { species: _, series } = self;
        for (a, series) in series.iter().enumerate() {
            series.save(&mut to.section(&format!("species_{a}")));
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        for (a, series) in self.series.iter_mut().enumerate() {
            series.restore(&from.section(&format!("species_{a}")))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{context, mixture, normal};
    use lennard_core::{DVec3, Momentum, State, System};

    /// Maxwell velocities at T = 0.8 of masses 1 and 2, without motion of the whole; B may be hotter.
    fn measured(hotter: f64) -> Findings {
        let n = 12;
        let species = mixture(n, |i| usize::from(i % 3 == 0));
        let system = System::of_species(species.clone());
        let cell = context(8.0, n).cell;
        let mut temperatures = SpeciesTemperatures::new(&species).unwrap();
        for step in 0..4000 {
            let speed = |i: usize| {
                let factor = if species.of(i) == 1 { hotter } else { 1.0 };
                (factor * 0.8 / system.masses.of(i)).sqrt()
            };
            let mut v: Vec<DVec3> = (0..n).map(|i| speed(i) * normal(4, step, i)).collect();
            let drift = system.momentum(&v) / (8.0 + 2.0 * 4.0);
            v.iter_mut().for_each(|v| *v -= drift);
            let state = State::new(cell, vec![DVec3::ZERO; n], v);
            let view = View::of(&state, &system);
            assert_eq!(system.n_dof(Momentum::Conserved), view.n_dof());
            temperatures.sample(&view);
        }
        let mut findings = Findings::default();
        temperatures.finish(0.0, &mut findings);
        findings
    }

    #[test]
    fn every_species_of_few_particles_has_the_temperature_of_all() {
        let findings = measured(1.0);
        assert_eq!(findings.averages[0].name, "temperature_A");
        for average in &findings.averages {
            // Without the share of the motion of all T would be too low: A by 1/16, B by 1/8.
            let found = average.estimate;
            assert!(found.standard_error < 0.007, "{found:?}");
            assert!((found.mean - 0.8).abs() < 4.0 * found.standard_error, "{found:?}");
        }
        assert!(findings.remarks.is_empty(), "{:?}", findings.remarks);
        assert!(measured(1.3).remarks_in_words().contains("not in equilibrium"));
    }
}
