//! The list of observables: one line for each.

use std::ops::RangeInclusive;

use lennard_core::options::{Keys, Options};
use lennard_core::{Observable, ObservableSpec};
use serde::{Deserialize, Serialize};

use crate::ObservableError;
use crate::recipe::{BuildContext, Recipe, Surroundings};

macro_rules! catalog {
    ($($(#[$doc:meta])* $variant:ident => $options:ty,)*) => {
        /// The options of one observable, as a scene's `[[observable]]` table gives them (`kind` and
        /// the keys of that kind; `every` belongs to the scene and is not among them).
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
        pub enum ObservableOptions {
            $($(#[$doc])* $variant($options),)*
        }

        impl ObservableOptions {
            /// What the observable declares about itself.
            #[must_use]
            pub fn spec(&self) -> &'static ObservableSpec {
                match self {
                    $(Self::$variant(_) => <$options as Recipe>::SPEC,)*
                }
            }

            /// Steps between two samples where the scene names none.
            #[must_use]
            pub fn default_every(&self) -> u64 {
                match self {
                    $(Self::$variant(o) => o.default_every(),)*
                }
            }

            /// The surroundings in which the observable means what its equation says.
            #[must_use]
            pub fn surroundings(&self) -> Surroundings {
                match self {
                    $(Self::$variant(o) => o.surroundings(),)*
                }
            }

            /// Whether its equation needs a bath that holds one temperature.
            #[must_use]
            pub fn needs_temperature(&self) -> bool {
                match self {
                    $(Self::$variant(o) => o.needs_temperature(),)*
                }
            }

            /// Whether the observable is right in a box that a barostat changes.
            #[must_use]
            pub fn follows_changing_box(&self) -> bool {
                match self {
                    $(Self::$variant(o) => o.follows_changing_box(),)*
                }
            }

            /// The numbers of species that the observable is right for.
            #[must_use]
            pub fn species(&self) -> RangeInclusive<usize> {
                match self {
                    $(Self::$variant(o) => o.species(),)*
                }
            }

            /// The shortest measured part of a run that gives the observable an error, τ.
            #[must_use]
            pub fn least_length(&self) -> f64 {
                match self {
                    $(Self::$variant(o) => o.least_length(),)*
                }
            }

            /// The scene keys of every observable, by its name.
            #[must_use]
            pub fn keys() -> Vec<(&'static str, Keys)> {
                vec![$((<$options as Recipe>::SPEC.name, <$options as Options>::KEYS),)*]
            }

            /// Every observable with its default options, in the order of the list.
            #[must_use]
            pub fn all() -> Vec<Self> {
                vec![$(Self::$variant(<$options>::default()),)*]
            }
        }

        /// Builds an observable from its options.
        ///
        /// # Errors
        /// [`ObservableError`] where an option is impossible in this context.
        pub fn build(
            options: &ObservableOptions,
            context: &BuildContext,
        ) -> Result<Box<dyn Observable>, ObservableError> {
            match options {
                $(ObservableOptions::$variant(o) => o.build(context),)*
            }
        }

        const SPECS: &[ObservableSpec] = &[$(*<$options as Recipe>::SPEC,)*];
    };
}

catalog! {
    /// Temperature, energies, pressure, configurational temperature, conservation.
    Thermodynamics => crate::ThermodynamicsOptions,
    /// The nine components of the pressure tensor.
    PressureTensor => crate::PressureTensorOptions,
    /// The pressure on each wall.
    WallPressure => crate::WallPressureOptions,
    /// The density along one axis.
    DensityProfile => crate::DensityProfileOptions,
    /// A slab of liquid beside its vapor.
    Interface => crate::InterfaceOptions,
    /// Total momentum.
    Momentum => crate::MomentumOptions,
    /// Temperatures, bonds and pressure of molecules.
    Molecules => crate::MolecularMotionOptions,
    /// How long molecules remember their direction.
    Orientation => crate::OrientationOptions,
    /// The radial distribution function g(r).
    Rdf => crate::RdfOptions,
    /// The mean-square displacement and the diffusion coefficient.
    Msd => crate::MsdOptions,
    /// The velocity autocorrelation function.
    Vacf => crate::VacfOptions,
    /// The static structure factor S(k).
    StructureFactor => crate::StructureFactorOptions,
    /// The order of the directions to neighbors.
    BondOrder => crate::BondOrderOptions,
    /// The residual chemical potential.
    ChemicalPotential => crate::ChemicalPotentialOptions,
    /// Kirkwood–Buff integrals of the species.
    KirkwoodBuff => crate::KirkwoodBuffOptions,
    /// The mutual diffusion coefficient of two species.
    MutualDiffusion => crate::MutualDiffusionOptions,
    /// The shear viscosity.
    ShearViscosity => crate::ShearViscosityOptions,
    /// The thermal conductivity.
    ThermalConductivity => crate::ThermalConductivityOptions,
}

impl ObservableOptions {
    /// The observable's name in scene files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.spec().name
    }
}

/// All observables, in the order of the list.
#[must_use]
pub fn observables() -> &'static [ObservableSpec] {
    SPECS
}
