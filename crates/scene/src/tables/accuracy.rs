//! The table `[accuracy]`: how wrong U, P and the conserved energy may be, in place of settings.

use lennard_core::options::Options;

lennard_core::options! {
    /// The largest errors that are accepted; what is not named is not asked for.
    ///
    /// U and P of the full potential are wanted where the scene leaves the truncation free. Where it writes
    /// both `truncation.kind` and `truncation.r_cut`, U and P of its own model are wanted.
    #[derive(Copy)]
    pub struct Accuracy {
        /// Largest error of the mean potential energy, at equal temperature: of the full potential, or, where `truncation.kind` and `truncation.r_cut` are both written, of that model.
        potential_energy: Option<f64> = None, else "not asked for", Between(1e-15, 1e6), in "ε per particle";
        /// Largest error of the mean pressure, likewise.
        pressure: Option<f64> = None, else "not asked for", Between(1e-15, 1e6), in "ε/σ³";
        /// Largest drift of the conserved energy.
        drift: Option<f64> = None, else "not asked for", Between(1e-15, 1e6), in "ε/τ per particle";
    }
}

impl Accuracy {
    /// What is asked of a scene that asks for nothing: U to 1e-3 ε, P to 5e-3 ε/σ³, drift to 1e-5 ε/τ.
    pub const USUAL: Self =
        Self { potential_energy: Some(1e-3), pressure: Some(5e-3), drift: Some(1e-5) };

    /// The errors asked for with their keys and units.
    #[must_use]
    pub fn asked(&self) -> Vec<(&'static str, f64, &'static str)> {
        let Self { potential_energy, pressure, drift } = *self;
        let declared = Self::KEYS.iter().zip([potential_energy, pressure, drift]);
        declared.filter_map(|(key, value)| Some((key.key, value?, key.unit))).collect()
    }
}

/// Settings that are chosen for an accuracy where they are not written, and without which no step can be made.
pub(crate) const CHOSEN: [&str; 5] = [
    "truncation.kind",
    "truncation.r_cut",
    "truncation.tail_correction",
    "integrator.dt",
    "kernel.precision",
];
