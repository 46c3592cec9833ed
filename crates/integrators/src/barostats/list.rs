//! The list of barostats, and everything that is made from it.

use lennard_core::options::{Keys, OptionError, Options};
use lennard_core::random::NoiseStream;
use lennard_core::{BarostatSpec, Integrator, PressureBath};
use serde::{Deserialize, Serialize};

use crate::ThermostatOptions;

lennard_core::choices! {
    /// The sides of the box that change together.
    pub enum Coupling {
        /// All sides by one factor: for fluids.
        #[default]
        Isotropic = "isotropic",
        /// The side along z alone, with P_zz: for slabs across z.
        Z = "z",
        /// The sides along x and y by one factor with ½(P_xx + P_yy), and in turn the side along z with P_zz: for slabs and crystals.
        XyZ = "xy-z",
    }
}

/// What the options type of each barostat provides for the list.
pub(crate) trait BarostatParts: Options {
    /// The method of a stage with the barostat, whose random numbers come from `noise`, keyed by the step.
    fn couple(
        &self,
        method: Integrator,
        thermostat: &ThermostatOptions,
        bath: PressureBath,
        noise: NoiseStream,
    ) -> Integrator;
    /// The relaxation time of the volume in τ.
    fn tau(&self) -> f64;
    /// Steps between two changes of the box.
    fn interval(&self) -> u64;
    /// Force evaluations of each change, besides the evaluations of the steps.
    fn evaluations(&self) -> u64;
    /// The sides that change together.
    fn coupling(&self) -> Coupling {
        Coupling::Isotropic
    }
    /// Whether the barostat stands inside the step, in the place of the method.
    const IS_INSIDE_STEP: bool = false;
    /// The compressibility that the scene gives, σ³/ε.
    fn compressibility(&self) -> Option<f64> {
        None
    }
}

/// Makes the options enum, the list and the coupling from lines `Variant: module,`.
macro_rules! list_of_barostats {
    ($($(#[$doc:meta])* $variant:ident: $module:ident,)*) => {
        /// A barostat by name, with its options: the `barostat` of a stage without its `pressure`.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "kind", rename_all = "kebab-case")]
        pub enum BarostatOptions {
            $($(#[$doc])* $variant(super::$module::Options),)*
        }

        static BAROSTATS: &[BarostatSpec] = &[$(super::$module::SPEC,)*];

        impl BarostatOptions {
            /// What the chosen barostat declares about itself.
            #[must_use]
            pub fn spec(&self) -> &'static BarostatSpec {
                match self {
                    $(Self::$variant(_) => &super::$module::SPEC,)*
                }
            }

            /// The relaxation time of the volume in τ.
            #[must_use]
            pub fn tau(&self) -> f64 {
                match self {
                    $(Self::$variant(options) => options.tau(),)*
                }
            }

            /// Steps between two changes of the box.
            #[must_use]
            pub fn interval(&self) -> u64 {
                match self {
                    $(Self::$variant(options) => options.interval(),)*
                }
            }

            /// Force evaluations of each change of the box, besides the evaluations of the steps.
            #[must_use]
            pub fn evaluations(&self) -> u64 {
                match self {
                    $(Self::$variant(options) => options.evaluations(),)*
                }
            }

            /// The sides that change together.
            #[must_use]
            pub fn coupling(&self) -> Coupling {
                match self {
                    $(Self::$variant(options) => options.coupling(),)*
                }
            }

            /// Whether the barostat stands inside the step, in the place of the method of the scene.
            #[must_use]
            pub fn is_inside_step(&self) -> bool {
                match self {
                    $(Self::$variant(_) => <super::$module::Options as BarostatParts>::IS_INSIDE_STEP,)*
                }
            }

            /// The compressibility that the scene gives, σ³/ε; `None` where it is to be estimated.
            #[must_use]
            pub fn compressibility(&self) -> Option<f64> {
                match self {
                    $(Self::$variant(options) => options.compressibility(),)*
                }
            }

            /// Couples the method of a stage, with its heat bath, to the pressure bath.
            ///
            /// Random numbers come from `noise`, keyed by the step. A barostat inside the step takes the place of the method.
            #[must_use]
            pub fn couple(
                &self,
                method: Integrator,
                thermostat: &ThermostatOptions,
                bath: PressureBath,
                noise: NoiseStream,
            ) -> Integrator {
                match self {
                    $(Self::$variant(options) => options.couple(method, thermostat, bath, noise),)*
                }
            }

            /// Every barostat with its default options, in the order of the list.
            #[must_use]
            pub fn all() -> Vec<Self> {
                vec![$(Self::$variant(super::$module::Options::default()),)*]
            }

            /// The scene keys of every entry of the list, by its name.
            #[must_use]
            pub fn keys() -> Vec<(&'static str, Keys)> {
                vec![$((super::$module::SPEC.name, <super::$module::Options as Options>::KEYS),)*]
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
    };
}

list_of_barostats! {
    /// Stochastic cell rescaling of Bernetti and Bussi, accepted by Metropolis.
    StochasticCellRescaling: stochastic_cell_rescaling,
    /// The barostat of Martyna, Tobias and Klein, in place of the scene's integrator.
    Mtk: mtk,
}

impl BarostatOptions {
    /// The name in scene files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.spec().name
    }
}

/// Every barostat, in the order of `lennard list`.
#[must_use]
pub fn barostats() -> &'static [BarostatSpec] {
    BAROSTATS
}
