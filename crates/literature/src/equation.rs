//! What every equation of state offers: all properties from the residual Helmholtz energy.

use serde::{Deserialize, Serialize};

use crate::fluid_state::{CriticalPoint, FluidState};
use crate::jet::Jet;
use crate::phase::{self, Phase};
use crate::saturation::{self, Saturation};

/// Where an equation may be used, in reduced units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Range {
    /// Lowest temperature, ε/k_B.
    pub t_min: f64,
    /// Highest temperature, ε/k_B.
    pub t_max: f64,
    /// Highest pressure, ε/σ³.
    pub p_max: f64,
    /// Highest density, σ⁻³, where the pressure does not set the limit.
    #[serde(default)]
    pub rho_max: Option<f64>,
    /// Where these limits come from.
    pub status: String,
}

/// How far an equation is from simulations of its own model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OwnUncertainty {
    /// In the potential energy per particle, ε.
    pub potential_energy: f64,
    /// In the pressure, ε/σ³.
    pub pressure: f64,
    /// How that was established.
    pub status: String,
}

/// What an equation of state declares about itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EquationSpec {
    /// Name for files and options.
    pub key: String,
    /// Name for tables.
    pub name: String,
    /// The model that it describes, in words.
    pub model: String,
    /// Authors, title, journal, table.
    pub citation: String,
    /// DOI; empty where it is not known here.
    pub doi: String,
    /// How the coefficients were obtained and checked.
    pub status: String,
    /// Why nothing is judged by it; `None` for an equation that judges.
    #[serde(default)]
    pub superseded: Option<String>,
    /// Where it may be used.
    pub range: Range,
    /// How good it is, where that has been established.
    pub uncertainty: Option<OwnUncertainty>,
    /// Its critical point.
    pub critical: CriticalPoint,
}

impl EquationSpec {
    /// Name and DOI (the name alone where the DOI is not known here), as beside a number that is compared with it.
    #[must_use]
    pub fn citation(&self) -> String {
        if self.doi.is_empty() {
            self.name.clone()
        } else {
            format!("{}, doi:{}", self.name, self.doi)
        }
    }
}

/// Why a state cannot be looked up.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OutsideRange {
    /// Density or temperature is not a finite positive number.
    #[error(
        "density and temperature must be finite positive numbers, found density {} and temperature {}",
        short(*rho), short(*temperature)
    )]
    NotAState {
        /// The density asked for.
        rho: f64,
        /// The temperature asked for.
        temperature: f64,
    },
    /// The temperature is outside.
    #[error("{equation} covers temperatures from {} to {}, found {}", short(*t_min), short(*t_max), short(*temperature))]
    Temperature {
        /// Which equation.
        equation: String,
        /// Its lowest temperature.
        t_min: f64,
        /// Its highest temperature.
        t_max: f64,
        /// The temperature asked for.
        temperature: f64,
    },
    /// The density is outside.
    #[error("{equation} covers densities up to {}, found {}", short(*rho_max), short(*rho))]
    Density {
        /// Which equation.
        equation: String,
        /// Its highest density.
        rho_max: f64,
        /// The density asked for.
        rho: f64,
    },
    /// The pressure is outside.
    #[error(
        "{equation} covers pressures up to {}, and at density {} and temperature {} it gives {pressure:.4}",
        short(*p_max), short(*rho), short(*temperature)
    )]
    Pressure {
        /// Which equation.
        equation: String,
        /// Its highest pressure.
        p_max: f64,
        /// The density asked for.
        rho: f64,
        /// The temperature asked for.
        temperature: f64,
        /// The pressure it gives there.
        pressure: f64,
    },
}

/// A number with six decimals at most.
fn short(number: f64) -> f64 {
    (number * 1e6).round() / 1e6
}

/// An equation of state: gives the residual Helmholtz energy, from which all else follows.
pub trait EquationOfState: Send + Sync + std::fmt::Debug {
    /// What it declares about itself.
    fn spec(&self) -> &EquationSpec;

    /// α = a_res/T per particle as a function of β = 1/T (k_B/ε) and ρ (σ⁻³), with its derivatives:
    /// called with β as the first and ρ as the second variable of the jet.
    fn residual(&self, beta: Jet, rho: Jet) -> Jet;

    /// The kinetic part of c_v in k_B: half the degrees of freedom of a particle.
    fn kinetic_heat_capacity(&self) -> f64 {
        1.5
    }

    /// How far the equation may be off at a density (σ⁻³) and a temperature (ε/k_B), where that has been established.
    fn uncertainty(&self, _rho: f64, _temperature: f64) -> Option<OwnUncertainty> {
        self.spec().uncertainty.clone()
    }

    /// Mass of a particle.
    fn mass(&self) -> f64 {
        1.0
    }

    /// The density in σ⁻³ at which the liquid freezes at this temperature; `None` where the freezing
    /// line of the model is not known or the temperature lies below the triple point.
    fn freezing_density(&self, temperature: f64) -> Option<f64>;

    /// Whether the freezing line of the model is known: every line reaches the critical temperature.
    fn has_freezing_line(&self) -> bool {
        let critical = self.spec().critical.temperature;
        self.freezing_density(critical).is_some()
    }

    /// All properties at a density (σ⁻³) and a temperature (ε/k_B), both positive; not-a-number
    /// entries come back for other arguments. Whether the equation may be used there is told by
    /// [`EquationOfState::check`] and [`EquationOfState::phase`].
    fn at(&self, rho: f64, temperature: f64) -> FluidState {
        let beta = 1.0 / temperature;
        let a = self.residual(Jet::first(beta), Jet::second(rho));
        let ideal = rho * temperature;
        let dp_drho = temperature * (1.0 + rho * (2.0 * a.y + rho * a.yy));
        let dp_dt = rho * (1.0 + rho * (a.y - beta * a.xy));
        let du_dt = -beta * beta * a.xx;
        let heat_capacity_volume = self.kinetic_heat_capacity() + du_dt;
        let expansion = temperature * (dp_dt / rho).powi(2);
        FluidState {
            rho,
            temperature,
            residual_helmholtz: a.value,
            pressure: ideal * (1.0 + rho * a.y),
            potential_energy: a.x,
            heat_capacity_volume,
            heat_capacity_pressure: heat_capacity_volume + expansion / dp_drho,
            speed_of_sound: ((dp_drho + expansion / heat_capacity_volume) / self.mass()).sqrt(),
            du_dt,
            dp_dt,
            du_drho: a.xy,
            dp_drho,
        }
    }

    /// Pressure in ε/σ³, the ideal part included.
    fn pressure(&self, rho: f64, temperature: f64) -> f64 {
        self.at(rho, temperature).pressure
    }

    /// Potential energy per particle in ε.
    fn potential_energy(&self, rho: f64, temperature: f64) -> f64 {
        self.at(rho, temperature).potential_energy
    }

    /// Isochoric heat capacity per particle in k_B, the kinetic 3/2 included.
    fn heat_capacity_volume(&self, rho: f64, temperature: f64) -> f64 {
        self.at(rho, temperature).heat_capacity_volume
    }

    /// Speed of sound in σ/τ.
    fn speed_of_sound(&self, rho: f64, temperature: f64) -> f64 {
        self.at(rho, temperature).speed_of_sound
    }

    /// The coexisting vapor and liquid at a temperature; `None` at and above the critical
    /// temperature, within 0.01 % below it, and where no coexistence is found.
    fn saturation(&self, temperature: f64) -> Option<Saturation> {
        saturation::solve(&|rho, t| self.at(rho, t), self.spec().critical, temperature)
    }

    /// The densities in σ⁻³ at which the vapor and the liquid become unstable at a temperature; `None` where nothing coexists.
    fn spinodal(&self, temperature: f64) -> Option<[f64; 2]> {
        phase::spinodal(&|rho, t| self.at(rho, t), self.saturation(temperature)?)
    }

    /// The density in σ⁻³ of the stable fluid at a pressure (ε/σ³) and a temperature (ε/k_B).
    ///
    /// Below the critical temperature that is the gas up to the vapor pressure, and the liquid above it. `None` where the
    /// equation covers no such state.
    fn density(&self, pressure: f64, temperature: f64) -> Option<f64> {
        let saturation = self.saturation(temperature);
        let state_at = |rho| self.at(rho, temperature);
        let density = saturation::density_at(&state_at, saturation, pressure, temperature)?;
        self.check(density, temperature).ok().map(|()| density)
    }

    /// Which phase the state is in.
    fn phase(&self, rho: f64, temperature: f64) -> Phase {
        if self.check(rho, temperature).is_err() {
            return Phase::OutsideRange;
        }
        phase::classify(&phase::Question {
            state_at: &|r, t| self.at(r, t),
            critical: self.spec().critical,
            saturation: self.saturation(temperature),
            freezing_density: self.freezing_density(temperature),
            freezing_known: self.has_freezing_line(),
            rho,
            temperature,
        })
    }

    /// What a state that the equation covers is by it, where it is no stable fluid.
    fn unstable(&self, rho: f64, temperature: f64) -> Option<String> {
        let phase = self.phase(rho, temperature);
        (!phase.is_stable()).then(|| {
            let (name, phase) = (&self.spec().name, phase.describe());
            format!("by {name} the state ρ = {rho:.4}, T = {temperature:.4} is {phase}")
        })
    }

    /// Whether the equation covers this state.
    ///
    /// # Errors
    /// [`OutsideRange`] where density or temperature is no positive number, or the state lies
    /// outside the range of the equation.
    fn check(&self, rho: f64, temperature: f64) -> Result<(), OutsideRange> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !(positive(rho) && positive(temperature)) {
            return Err(OutsideRange::NotAState { rho, temperature });
        }
        let spec = self.spec();
        let range = &spec.range;
        if temperature < range.t_min || temperature > range.t_max {
            return Err(OutsideRange::Temperature {
                equation: spec.name.clone(),
                t_min: range.t_min,
                t_max: range.t_max,
                temperature,
            });
        }
        if let Some(rho_max) = range.rho_max.filter(|most| rho > *most) {
            return Err(OutsideRange::Density { equation: spec.name.clone(), rho_max, rho });
        }
        let pressure = self.pressure(rho, temperature);
        if pressure.is_nan() || pressure > range.p_max {
            return Err(OutsideRange::Pressure {
                equation: spec.name.clone(),
                p_max: range.p_max,
                rho,
                temperature,
                pressure,
            });
        }
        Ok(())
    }
}
