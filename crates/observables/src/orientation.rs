//! How long molecules remember their direction.

use crate::{BuildContext, Findings, Observable, ObservableError, ObservableSpec, Table, recipe};
use lennard_core::{DVec3, Own, View, persist};

use crate::averages::tell_discarded;
use crate::over_lags::OverLags;
use crate::time_origins::{Origins, TimeOrigins};

const SPEC: ObservableSpec = ObservableSpec {
    name: "orientation",
    summary: "autocorrelation functions of the directions of molecules, and their integrals, the times of reorientation",
    equation: "C_1(t) = ⟨u(t₀)·u(t₀+t)⟩; C_2(t) = ⟨(3(u(t₀)·u(t₀+t))² − 1)/2⟩ with u from the first to the last site; τ_l = ∫₀^∞ C_l dt",
    source: "Allen and Tildesley, Computer Simulation of Liquids, 2nd ed. (2017), section 2.7.1; \
             J.-P. Hansen and I. R. McDonald, Theory of Simple Liquids, 4th ed. (2013), section 11.5",
    dynamic: true,
    suits: crate::Suits::Molecules,
    every: 5,
    alone: Some("is for molecules"),
    ..ObservableSpec::PLAIN
};

lennard_core::options! {
    /// Options of [`Orientation`].
    pub struct OrientationOptions {
        /// Longest lag.
        window: f64 = 4.0, Between(1e-9, 1e9), in "τ";
        /// Number of time origins followed at once.
        origins: usize = 16, Whole(1, 10_000);
    }
}

recipe!(OrientationOptions, |options, context| Orientation::new(options, context)?);

/// The autocorrelation functions of the unit vectors u from the first to the last site of each molecule, over many time origins.
///
/// A free linear molecule that turns by the angle φ in a time has C_1 = cos φ and C_2 = (3cos²φ − 1)/2. C_2 does not tell the two ends
/// of a molecule apart. The times τ_1 and τ_2 are integrals by the trapezoidal rule up to the end of the window.
#[derive(Debug, Clone, PartialEq)]
pub struct Orientation {
    /// C_1 and C_2.
    products: OverLags<TimeOrigins>,
}

impl Orientation {
    /// Nothing seen yet.
    ///
    /// # Errors
    /// [`ObservableError`] where the window holds no two samples or more than 10,000, or there is no origin.
    pub fn new(
        options: &OrientationOptions,
        context: &BuildContext,
    ) -> Result<Self, ObservableError> {
        let window = (options.window, options.origins);
        let own = Own::all_of(context.n_molecules());
        let vectors = ("directions", &own);
        let origins = TimeOrigins::new(window, context.sample_interval(), vectors)?;
        Ok(Self { products: OverLags::new("products", 2, origins, &own, Vec::new()) })
    }

    /// ∫ C over the window by the trapezoidal rule.
    fn integral(&self, c: &[f64]) -> f64 {
        let pairs = c.windows(2).map(|c| 0.5 * (c[0] + c[1]));
        pairs.sum::<f64>() * self.products.origins.interval
    }
}

/// The unit vectors from the first to the last site of each molecule; zero where both have one place.
fn directions(view: &View<'_>) -> Vec<DVec3> {
    let molecules = &view.system.molecules;
    (0..view.system.n_molecules())
        .map(|m| {
            let x = &view.state.positions[molecules.sites_of(m)];
            (x[x.len() - 1] - x[0]).normalize_or_zero()
        })
        .collect()
}

/// The functions whose means are C_1 and C_2.
fn legendre(l: usize) -> impl Fn(DVec3, DVec3) -> f64 {
    move |a, b| if l == 1 { a.dot(b) } else { 1.5 * a.dot(b).powi(2) - 0.5 }
}

impl Observable for Orientation {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn sample(&mut self, view: &View<'_>) {
        self.products.sample(&directions(view), [1, 2].map(legendre));
    }

    fn finish(&self, discarded: f64) -> Findings {
        let mut findings = Findings::default();
        let products = self.products.after(discarded);
        let both = [1, 2].map(|l| {
            let words = format!("the function C_{l} of directions");
            let name = format!("reorientation_time_{l}");
            let integral = |c: &[f64]| self.integral(c);
            let (average, curve) =
                self.products.integrated(&products, (l - 1, &words), (&name, "τ"), integral)?;
            findings.averages.push(average);
            Some(curve)
        });
        let [Some([c_1, error_1]), Some([c_2, error_2])] = both else {
            findings.remark("no functions of directions: the run is shorter than their window");
            return findings;
        };
        tell_discarded(&mut findings, self.products.origins.samples() - products.samples());
        findings.tables.push(
            Table::new(
                "orientation",
                "autocorrelation functions of the directions of molecules against lag",
            )
            .with("time", "τ", self.products.origins.times())
            .with("c_1", "", c_1)
            .with("standard_error_1", "", error_1)
            .with("c_2", "", c_2)
            .with("standard_error_2", "", error_2),
        );
        findings
    }
}

persist!(Orientation { ..products });

#[cfg(test)]
mod tests {
    use crate::Doubt;
    use lennard_core::{Bonds, Molecules, State, System};

    use super::*;
    use crate::testing::{context, normal};

    /// Samples of dumbbells whose direction `of(sample, molecule)` gives.
    fn found(n: usize, samples: u64, of: impl Fn(u64, usize) -> DVec3) -> Findings {
        let molecules = Molecules::chains(2, 1.0, Bonds::Rigid);
        let context =
            BuildContext { dt: 0.05, molecules: molecules.clone(), ..context(10.0, 2 * n) };
        let system = System::of_molecules(2 * n, molecules);
        let options = OrientationOptions::default();
        let mut seen = Orientation::new(&options, &context).unwrap();
        for s in 0..samples {
            let sites = |m| [DVec3::ZERO, of(s, m)].map(|u| DVec3::splat(m as f64) + u);
            let x: Vec<DVec3> = (0..n).flat_map(sites).collect();
            let state = State::new(context.cell, x, vec![DVec3::ZERO; 2 * n]);
            seen.sample(&View::of(&state, &system));
        }
        seen.finish(0.0)
    }

    #[test]
    fn molecules_that_turn_steadily_have_cosines() {
        // Each about an axis of its own, by 0.11 rad per sample.
        let turn = |s: u64, m: usize| {
            let axis = normal(3, 0, m).normalize();
            let (u, w) = axis.any_orthonormal_pair();
            let angle = 0.11 * s as f64 + m as f64;
            angle.cos() * u + angle.sin() * w
        };
        let findings = found(20, 400, turn);
        let table = &findings.tables[0];
        for k in [0, 1, 7, 40, 80] {
            let cosine = (0.11 * k as f64).cos();
            let [c_1, c_2] = [1, 3].map(|column: usize| table.columns[column].numbers()[k]);
            assert!((c_1 - cosine).abs() < 1e-12, "{k}: {c_1}");
            assert!((c_2 - (1.5 * cosine * cosine - 0.5)).abs() < 1e-12, "{k}");
        }
        // Cosines do not decay: the times are no results, and say so.
        assert_eq!(findings.averages.len(), 2);
        for average in &findings.averages {
            assert!(average.name.starts_with("reorientation_time_"));
            assert!(matches!(average.doubt, Some(Doubt::Incomplete(_))), "{average:?}");
        }
    }

    /// Rotational diffusion: C_l = e^{−l(l+1)·D·t}, and τ_1 = 3·τ_2.
    #[test]
    fn rotational_diffusion_decays_exponentially_with_its_two_times() {
        let (n, samples, d, dt) = (200, 2000, 0.6, 0.05);
        let mut u: Vec<DVec3> = (0..n).map(|m| normal(5, u64::MAX, m).normalize()).collect();
        let mut path = Vec::new();
        for s in 0..samples {
            path.push(u.clone());
            // Many small steps in one, so that a step is diffusion on the sphere.
            for part in 0..10 {
                for (m, u) in u.iter_mut().enumerate() {
                    let kick = (2.0 * d * dt / 10.0_f64).sqrt() * normal(5, 10 * s + part, m);
                    *u = (*u + kick.cross(*u)).normalize();
                }
            }
        }
        let findings = found(n, samples, |s, m| path[s as usize][m]);
        let table = &findings.tables[0];
        for (column, rate) in [(1, 2.0 * d), (3, 6.0 * d)] {
            for k in [2, 10, 20] {
                let wanted = (-rate * dt * k as f64).exp();
                let c = table.columns[column].numbers()[k];
                let error = table.columns[column + 1].numbers()[k];
                assert!((c - wanted).abs() < 4.0 * error + 0.005, "{k}: {c} {wanted}");
            }
        }
        for (average, rate) in findings.averages.iter().zip([2.0 * d, 6.0 * d]) {
            // The trapezoidal sum of e^{−rate·t} is dt/2·coth(rate·dt/2).
            let wanted = 0.5 * dt / (0.5 * rate * dt).tanh();
            let estimate = &average.estimate;
            assert!(
                (estimate.mean - wanted).abs() < 4.0 * estimate.standard_error + 0.01 * wanted,
                "{average:?} {wanted}"
            );
        }
    }
}
