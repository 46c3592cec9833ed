//! The mutual diffusion of two species.

use crate::{BuildContext, Findings, Frames, Observable, ObservableError, ObservableSpec, recipe};
use lennard_core::{DVec3, SpeciesTable, View, persist};

use super::green_kubo::{GreenKubo, LONG_ENOUGH, Words};
use super::{DEFAULT_WINDOW, checked_interval};

const SPEC: ObservableSpec = ObservableSpec {
    name: "mutual-diffusion",
    summary: "Maxwell–Stefan diffusion coefficient of two species from the correlation of their relative velocity (Green–Kubo), with its Einstein–Helfand cross-check",
    equation: "Đ = (N x_a x_b/3) ∫₀^∞ ⟨u(0)·u(t)⟩ dt, u = Σ_{i∈a} v_i/N_a − Σ_{i∈b} v_i/N_b",
    source: "M. Schoen and C. Hoheisel, Mol. Phys. 52, 33 (1984); R. Krishna and J. M. van Baten, Ind. Eng. Chem. Res. 44, 6939 (2005)",
    dynamic: true,
    suits: crate::Suits::Atoms,
    every: 4,
    species: [2, 2],
    // Velocities alone are followed, and a barostat leaves those as they are.
    frames: Frames::Flows,
    alone: None,
    ..ObservableSpec::PLAIN
};

const WORDS: Words = Words {
    name: "mutual_diffusion",
    plain: "mutual diffusion",
    unit: "σ²/τ",
    correlation_unit: "σ²/τ²",
};

lennard_core::options! {
    /// Options of [`MutualDiffusion`].
    pub struct MutualDiffusionOptions {
        /// Longest lag of the correlation of the relative velocity.
        window: f64 = DEFAULT_WINDOW, Between(1e-9, 1e9), in "τ";
    }
}

recipe! {
    MutualDiffusionOptions, lasting LONG_ENOUGH windows,
    |options, context| MutualDiffusion::new(options, context)?
}

/// The Maxwell–Stefan diffusion coefficient Đ of two species, in σ²/τ.
///
/// u is the mean velocity of one species relative to the other, in any frame. Particles that move independently have
/// Đ = x_b·D_a + x_a·D_b (Darken); what differs from it are correlations between different particles.
///
/// The flux that a gradient of composition drives is Fick's, with the coefficient Γ·Đ. The thermodynamic factor Γ is one of the
/// results of `kirkwood-buff`.
#[derive(Debug, Clone, PartialEq)]
pub struct MutualDiffusion {
    species: SpeciesTable,
    flux: GreenKubo,
}

impl MutualDiffusion {
    /// Nothing seen yet.
    ///
    /// # Errors
    /// [`ObservableError`] where the window is no positive number or shorter than 32 samples, or there are not two species.
    pub fn new(
        options: &MutualDiffusionOptions,
        context: &BuildContext,
    ) -> Result<Self, ObservableError> {
        let interval = checked_interval(options.window, context)?;
        context.has_species(SPEC.species)?;
        Ok(Self {
            species: context.species.clone(),
            flux: GreenKubo::with_helfand(3, interval, options.window),
        })
    }

    /// The mean velocity of one species relative to the other, σ/τ.
    fn relative_velocity(&self, view: &View<'_>) -> DVec3 {
        let velocities = &view.state.velocities;
        let of = |i: usize| match self.species.of(i) {
            0 => velocities[i] / self.species.count(0) as f64,
            _ => velocities[i] / -(self.species.count(1) as f64),
        };
        view.sum(of)
    }
}

impl Observable for MutualDiffusion {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn sample(&mut self, view: &View<'_>) {
        let u = self.relative_velocity(view);
        self.flux.push(&u.to_array(), view.temperature());
    }

    fn finish(&self, discarded: f64) -> Findings {
        let (x_a, x_b) = (self.species.fraction(0), self.species.fraction(1));
        let prefactor = self.species.n_particles() as f64 * x_a * x_b;
        let mut findings = self.flux.findings(discarded, prefactor, WORDS);
        findings.remark(
            "mutual_diffusion is the Maxwell–Stefan coefficient, not corrected for finite size; Fick's is the thermodynamic factor times it",
        );
        findings
    }
}

persist!(MutualDiffusion { ..flux, fixed species });

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{context, estimate, mixture, under_friction};

    /// Velocities that decay independently: D_a = T/(m_a·γ_a) each, and Đ is Darken's, but for the centre of mass.
    #[test]
    fn independent_particles_have_the_coefficient_of_darken() {
        let species = mixture(30, |i| usize::from(i % 3 == 0));
        let context = BuildContext { dt: 0.05, species, ..context(10.0, 30) };
        let options = MutualDiffusionOptions { window: 4.0 };
        let mut found = MutualDiffusion::new(&options, &context).unwrap();
        let d = under_friction(&context, (1, 40_000), [3.0, 5.0], |view| found.sample(view));
        let darken = context.species.fraction(1) * d[0] + context.species.fraction(0) * d[1];
        let findings = found.finish(0.0);
        for name in ["mutual_diffusion", "mutual_diffusion_einstein_helfand"] {
            let estimate = estimate(&findings, name);
            let off = (estimate.mean - darken).abs();
            assert!(estimate.standard_error < 0.06 * darken, "{estimate:?}");
            // What is left of the correlation beyond the lag at which it is lost in noise.
            assert!(
                off < 4.0 * estimate.standard_error + 0.02 * darken,
                "{name}: {estimate:?} {darken}"
            );
        }
    }

    #[test]
    fn one_species_and_three_have_no_such_coefficient() {
        for kinds in [1, 3] {
            let context = BuildContext { species: mixture(9, |i| i % kinds), ..context(10.0, 9) };
            let error = MutualDiffusion::new(&MutualDiffusionOptions { window: 4.0 }, &context);
            assert_eq!(error.unwrap_err().key(), "kind");
        }
    }
}
