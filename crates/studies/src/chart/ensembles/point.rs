//! One choice of barostat and thermostat, as it is stored.

use lennard_core::stopwatch::Spread;
use lennard_integrators::{BarostatOptions, ThermostatOptions};
use serde::{Deserialize, Serialize};

use crate::chart::Outcome;
use crate::chart::point::Charted;
use crate::lab::{Drift, Failed, Value};

/// A thermostat and a barostat with their keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Baths {
    /// The heat bath.
    pub thermostat: ThermostatOptions,
    /// The pressure bath, without its pressure.
    pub barostat: BarostatOptions,
}

impl Baths {
    /// In a line: `stochastic-cell-rescaling every 10, τ_p 1; bussi, τ_T 0.5`.
    #[must_use]
    pub fn label(&self) -> String {
        let digits = |x: f64| crate::report::significant(x, 3);
        let every = match self.barostat.is_inside_step() {
            true => String::new(),
            false => format!(" every {}", self.barostat.interval()),
        };
        format!(
            "{}{every}, τ_p {}; {}, τ_T {}",
            self.barostat.name(),
            digits(self.barostat.tau()),
            self.thermostat.name(),
            digits(tau_of(&self.thermostat)),
        )
    }
}

/// What a run of these baths sampled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sampled {
    /// Time that was sampled, τ.
    pub time: f64,
    /// Temperature of the positions, ε/k_B.
    pub temperature: Value,
    /// Pressure ρT + W/(3V) with tail, ε/σ³.
    pub pressure: Value,
    /// The same less what the ensemble of this N has: P₀ + (1 − n_dof/3N)·⟨ρ⟩·T.
    pub pressure_off: Value,
    /// Number density of molecules or particles, σ⁻³.
    pub density: Value,
    /// Volume, σ³.
    pub volume: Value,
    /// Variance of the volume, σ⁶.
    pub variance: Value,
    /// Drift of the conserved energy, ε/τ per particle.
    pub drift: Drift,
    /// Accepted share of the proposed changes of the box; absent where none is proposed.
    pub acceptance: Option<f64>,
}

impl Sampled {
    /// Independent volumes in a τ.
    #[must_use]
    pub fn pace(&self) -> f64 {
        self.volume.n_effective / self.time
    }
}

/// One choice with what it costs and samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EnsemblePoint {
    /// Its number on the diagrams, from 1.
    pub number: usize,
    /// The choice in a line.
    pub label: String,
    /// The choice.
    pub baths: Baths,
    /// Wall times for each particle and step, s.
    #[serde(default)]
    pub timings: Vec<f64>,
    /// Why it could not be timed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_timed: Option<Failed>,
    /// What it sampled, once that is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sampled: Option<Outcome<Sampled>>,
}

impl EnsemblePoint {
    pub(super) fn new(number: usize, baths: Baths) -> Self {
        Self {
            number,
            label: baths.label(),
            baths,
            timings: Vec::new(),
            not_timed: None,
            sampled: None,
        }
    }

    /// What its run sampled, where it came to its end.
    #[must_use]
    pub fn found(&self) -> Option<&Sampled> {
        self.sampled.as_ref()?.found()
    }

    /// The median wall time for each particle and step, s, with the lowest and the highest.
    #[must_use]
    pub fn cost(&self) -> Option<Spread> {
        Spread::of(self.timings.iter().copied())
    }
}

impl Charted for EnsemblePoint {
    fn number(&self) -> usize {
        self.number
    }

    fn is_of(&self, fresh: &Self) -> bool {
        self.baths == fresh.baths
    }

    fn is_measured(&self) -> bool {
        self.sampled.is_some()
    }

    fn is_timed(&self, repeats: usize) -> bool {
        self.not_timed.is_some() || self.timings.len() >= repeats
    }
}

/// The relaxation time of a thermostat, τ: of Langevin noise the inverse of its friction.
pub(super) fn tau_of(thermostat: &ThermostatOptions) -> f64 {
    match thermostat {
        ThermostatOptions::Bussi(o) => o.tau,
        ThermostatOptions::NoseHoover(o) => o.tau,
        ThermostatOptions::Langevin(o) => 1.0 / o.friction,
        ThermostatOptions::Rescale(_) => 0.0,
    }
}
