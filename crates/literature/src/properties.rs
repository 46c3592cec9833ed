//! Every property that an equation of state gives at a state: one line for each.

use crate::fluid_state::FluidState;

/// The size beside which a difference in a property is small or large.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// The size of the value, which cannot pass through zero.
    Value,
    /// 1.
    One,
    /// k_B T.
    Thermal,
    /// ρ k_B T.
    IdealPressure,
    /// 1/c_p: the product of μ_JT and c_p is a volume of the size of σ³.
    PerHeat,
}

impl Scale {
    /// The size at a density (σ⁻³), a temperature (ε/k_B) and a heat capacity c_p (k_B); `None` for the size of the value itself.
    #[must_use]
    pub fn at(self, rho: f64, temperature: f64, heat_capacity_pressure: f64) -> Option<f64> {
        match self {
            Self::Value => None,
            Self::One => Some(1.0),
            Self::Thermal => Some(temperature),
            Self::IdealPressure => Some(rho * temperature),
            Self::PerHeat => Some(1.0 / heat_capacity_pressure),
        }
    }
}

/// A property of a fluid in a state.
#[derive(Debug, Clone, Copy)]
pub struct Property {
    /// Name in options and files; the name of the same quantity among the averages of a run, with words and a unit.
    pub key: &'static str,
    /// Its formula in plain text.
    pub equation: &'static str,
    /// The size beside which a difference in it is small or large.
    pub scale: Scale,
    /// Its value.
    pub of: fn(&FluidState) -> f64,
}

macro_rules! properties {
    ($($key:literal, $equation:literal, $scale:ident, $of:expr;)*) => {
        /// All properties, in the order of a table.
        pub const PROPERTIES: &[Property] = &[$(Property {
            key: $key,
            equation: $equation,
            scale: Scale::$scale,
            of: $of,
        }),*];
    };
}

properties! {
    "pressure", "ρT(1 + ρ ∂α/∂ρ), α = a_res/T", IdealPressure, |s| s.pressure;
    "compressibility_factor", "P/(ρT)", One, |s| s.pressure / (s.rho * s.temperature);
    "potential_energy", "∂α/∂β", Thermal, |s| s.potential_energy;
    "total_energy", "U/N + kinetic part", Thermal, FluidState::total_energy;
    "enthalpy", "E/N + P/ρ", Thermal, |s| s.total_energy() + s.pressure / s.rho;
    "heat_capacity", "kinetic part − β² ∂²α/∂β²", Value, |s| s.heat_capacity_volume;
    "heat_capacity_pressure", "c_v + T γ_V² κ_T/ρ", Value, |s| s.heat_capacity_pressure;
    "thermal_pressure_coefficient", "∂P/∂T at constant V", Value, |s| s.dp_dt;
    "isothermal_compressibility", "(1/ρ) ∂ρ/∂P at constant T", Value, FluidState::isothermal_compressibility;
    "isentropic_compressibility", "κ_T c_v/c_p", Value, |s| s.isothermal_compressibility() * s.heat_capacity_volume / s.heat_capacity_pressure;
    "thermal_expansion", "γ_V κ_T", Value, |s| s.dp_dt * s.isothermal_compressibility();
    "speed_of_sound", "1/√(ρ m κ_S)", Value, |s| s.speed_of_sound;
    "joule_thomson_coefficient", "(T α_P − 1)/(ρ c_p)", PerHeat, FluidState::joule_thomson;
    "grueneisen_parameter", "γ_V/(ρ c_v)", Value, |s| s.dp_dt / (s.rho * s.heat_capacity_volume);
    "density_scaling_exponent", "⟨δW δU⟩/(3⟨δU²⟩) = (γ_V/ρ − 1)/(∂u/∂T)", Value, |s| (s.dp_dt / s.rho - 1.0) / s.du_dt;
    "structure_factor_zero", "ρ T κ_T", Value, |s| s.temperature / s.dp_drho;
    "residual_helmholtz_energy", "T α", Thermal, |s| s.temperature * s.residual_helmholtz;
    "residual_entropy", "(U/N − a_res)/T", Value, |s| s.potential_energy / s.temperature - s.residual_helmholtz;
    "residual_chemical_potential", "a_res + T(Z − 1)", Thermal, |s| s.temperature * (s.residual_helmholtz - 1.0) + s.pressure / s.rho;
}

/// The property with this name.
#[must_use]
pub fn property(key: &str) -> Option<&'static Property> {
    PROPERTIES.iter().find(|p| p.key == key)
}

impl FluidState {
    /// Kinetic and potential energy per particle, ε: the kinetic part of c_v is constant.
    fn total_energy(&self) -> f64 {
        self.potential_energy + (self.heat_capacity_volume - self.du_dt) * self.temperature
    }

    /// κ_T, σ³/ε.
    fn isothermal_compressibility(&self) -> f64 {
        1.0 / (self.rho * self.dp_drho)
    }

    /// μ_JT = ∂T/∂P at constant enthalpy, σ³/k_B; finite where κ_T diverges.
    fn joule_thomson(&self) -> f64 {
        let Self { rho, temperature: t, dp_dt, dp_drho, .. } = *self;
        let per_slope = self.heat_capacity_volume * dp_drho + t * (dp_dt / rho).powi(2);
        (t * dp_dt / rho - dp_drho) / (rho * per_slope)
    }
}
