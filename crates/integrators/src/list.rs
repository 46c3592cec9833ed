//! The lists of methods, and everything that is made from them.

use lennard_core::options::{Keys, OptionError, Options};
use lennard_core::random::NoiseStream;
use lennard_core::{Integrator, IntegratorSpec, Ramp, ThermostatSpec};
use serde::{Deserialize, Serialize};

use crate::common::{BathOptions, MethodOptions, OscillatorModel};

/// One line of the list of integrators.
#[derive(Debug, Clone, Copy)]
pub struct IntegratorEntry {
    /// What the method declares about itself, at its default options.
    pub spec: &'static IntegratorSpec,
    /// How it is given the oscillator.
    pub oscillator: OscillatorModel,
    /// Its default options.
    pub default_options: fn() -> IntegratorOptions,
}

impl IntegratorEntry {
    /// The method with its default options.
    #[must_use]
    pub fn build(&self) -> Integrator {
        build(&(self.default_options)())
    }
}

/// Makes the options enum, the list and the constructor from lines `Variant: module,`.
macro_rules! list_of_integrators {
    ($($(#[$doc:meta])* $variant:ident: $module:ident,)*) => {
        /// An integrator by name, with its own options: the scene's `[integrator]` table without `dt`.
        ///
        /// `kind` is the name of the method; each variant holds the options type of the method's file.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "kind", rename_all = "kebab-case")]
        pub enum IntegratorOptions {
            $($(#[$doc])* $variant(crate::$module::Options),)*
        }

        static INTEGRATORS: &[IntegratorEntry] = &[
            $(IntegratorEntry {
                spec: &crate::$module::SPEC,
                oscillator: <crate::$module::Options as MethodOptions>::OSCILLATOR,
                default_options: || IntegratorOptions::$variant(Default::default()),
            },)*
        ];

        impl IntegratorOptions {
            /// What the chosen method declares about itself, at its default options.
            #[must_use]
            pub fn spec(&self) -> &'static IntegratorSpec {
                match self {
                    $(Self::$variant(_) => &crate::$module::SPEC,)*
                }
            }

            /// The scene keys of every entry of the list, by its name.
            #[must_use]
            pub fn keys() -> Vec<(&'static str, Keys)> {
                vec![$((crate::$module::SPEC.name, <crate::$module::Options as Options>::KEYS),)*]
            }

            /// Whether every option has a possible value.
            ///
            /// # Errors
            /// [`OptionError`], which names the key, what was found and what is allowed.
            pub fn check(&self) -> Result<(), OptionError> {
                match self {
                    $(Self::$variant(options) => options.check(),)*
                }
            }
        }

        /// Makes the integrator that the options describe.
        #[must_use]
        pub fn build(options: &IntegratorOptions) -> Integrator {
            match options {
                $(IntegratorOptions::$variant(options) => MethodOptions::build(options),)*
            }
        }
    };
}

list_of_integrators! {
    /// The exact solution, where one is known.
    Analytic: analytic,
    /// Explicit Euler.
    ExplicitEuler: explicit_euler,
    /// Implicit Euler, solved by Newton's method.
    ImplicitEuler: implicit_euler,
    /// Symplectic (semi-implicit) Euler.
    SymplecticEuler: symplectic_euler,
    /// SPOOK for at most one constraint.
    Spook: spook,
    /// Störmer–Verlet on positions, with the Taylor start.
    StormerVerlet: stormer_verlet,
    /// Störmer–Verlet corrected for a changing step.
    StormerVerletTimeCorrected: stormer_time_corrected,
    /// Störmer–Verlet for a changing step, of second order throughout.
    StormerVerletVariable: stormer_variable,
    /// Velocity Verlet in its four-step form.
    VelocityVerlet: velocity_verlet,
    /// Velocity Verlet in its short form.
    VelocityVerletShort: velocity_verlet_short,
    /// Leapfrog with velocities at half steps.
    Leapfrog: leapfrog,
    /// Störmer–Verlet on integer positions.
    BitReversibleVerlet: bit_reversible_verlet,
    /// Multiple time steps for a near and a far force.
    Respa: respa,
    /// Forest and Ruth's method of order 4.
    ForestRuth: forest_ruth,
    /// PEFRL, of order 4.
    Pefrl: pefrl,
    /// Blanes and Moan's method of order 4.
    BlanesMoan: blanes_moan,
}

impl IntegratorOptions {
    /// The name of the method in scene files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.spec().name
    }
}

impl Default for IntegratorOptions {
    fn default() -> Self {
        Self::VelocityVerlet(Default::default())
    }
}

/// Every integrator, in the order of `lennard list integrators`.
#[must_use]
pub fn integrators() -> &'static [IntegratorEntry] {
    INTEGRATORS
}

/// Makes the options enum, the list and the coupling from lines `Variant: module,`.
macro_rules! list_of_thermostats {
    ($($(#[$doc:meta])* $variant:ident: $module:ident,)*) => {
        /// A thermostat by name, with its options: the `thermostat` of a stage.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "kind", rename_all = "kebab-case")]
        pub enum ThermostatOptions {
            $($(#[$doc])* $variant(crate::$module::Options),)*
        }

        static THERMOSTATS: &[ThermostatSpec] = &[$(crate::$module::BATH,)*];

        impl ThermostatOptions {
            /// What the chosen thermostat declares about itself.
            #[must_use]
            pub fn spec(&self) -> &'static ThermostatSpec {
                match self {
                    $(Self::$variant(_) => &crate::$module::BATH,)*
                }
            }

            /// The time in τ in which the bath reduces a deviation of the kinetic energy from its mean by a factor of e. It
            /// is 0 for a bath that sets the energy.
            #[must_use]
            pub fn relaxation(&self) -> f64 {
                match self {
                    $(Self::$variant(options) => options.relaxation(),)*
                }
            }

            /// The scene keys of every entry of the list, by its name.
            #[must_use]
            pub fn keys() -> Vec<(&'static str, Keys)> {
                vec![$((crate::$module::BATH.name, <crate::$module::Options as Options>::KEYS),)*]
            }

            /// Whether every option has a possible value.
            ///
            /// # Errors
            /// [`OptionError`], which names the key, what was found and what is allowed.
            pub fn check(&self) -> Result<(), OptionError> {
                match self {
                    $(Self::$variant(options) => options.check(),)*
                }
            }

            /// Couples a method to the bath at `temperature` (in ε/k_B), whose random numbers come from `noise`, keyed by
            /// step and particle. A bath that stands inside the step takes the place of the method.
            #[must_use]
            pub fn couple(
                &self,
                method: Integrator,
                temperature: Ramp,
                noise: NoiseStream,
            ) -> Integrator {
                match self {
                    $(Self::$variant(options) => options.couple(method, temperature, noise),)*
                }
            }
        }
    };
}

list_of_thermostats! {
    /// Velocity rescaling to exactly T, every so many steps, as Verlet did.
    Rescale: rescale,
    /// Stochastic velocity rescaling of Bussi, Donadio and Parrinello.
    Bussi: bussi,
    /// Nosé–Hoover chains.
    NoseHoover: nose_hoover,
    /// Langevin dynamics by the BAOAB splitting, in place of the scene's integrator.
    Langevin: langevin,
}

impl ThermostatOptions {
    /// The name in scene files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.spec().name
    }
}

/// Every thermostat, in the order of `lennard list`.
#[must_use]
pub fn thermostats() -> &'static [ThermostatSpec] {
    THERMOSTATS
}
