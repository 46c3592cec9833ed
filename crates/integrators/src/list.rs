//! The lists of integrators and thermostats, and everything that is made from them.

use std::sync::LazyLock;

use lennard_core::{Integrator, IntegratorSpec, ThermostatSpec};

use crate::methods::{BathOptions, MethodOptions, OscillatorModel};
use crate::{
    analytic, blanes_moan, bussi, explicit_euler, forest_ruth, implicit_euler, langevin, leapfrog,
    nose_hoover, pefrl, rescale, respa, spook, stormer_time_corrected, stormer_variable,
    stormer_verlet, symplectic_euler, velocity_verlet, velocity_verlet_short,
};

lennard_core::list_of_methods! {
    /// An integrator by name, with its own options: the scene's `[integrator]` table without `dt`.
    ///
    /// `kind` is the name of the method; each variant holds the options type of the method's file.
    #[serde(tag = "kind", rename_all = "kebab-case")]
    pub enum IntegratorOptions: MethodOptions, declared by SPEC: IntegratorSpec {
        /// The exact solution, where one is known.
        Analytic: analytic::Options,
        /// Explicit Euler.
        ExplicitEuler: explicit_euler::Options,
        /// Implicit Euler, solved by Newton's method.
        ImplicitEuler: implicit_euler::Options,
        /// Symplectic (semi-implicit) Euler.
        SymplecticEuler: symplectic_euler::Options,
        /// SPOOK for at most one constraint.
        Spook: spook::Options,
        /// Störmer–Verlet on positions, with the Taylor start.
        StormerVerlet: stormer_verlet::Options,
        /// Störmer–Verlet corrected for a changing step.
        StormerVerletTimeCorrected: stormer_time_corrected::Options,
        /// Störmer–Verlet for a changing step, of second order throughout.
        StormerVerletVariable: stormer_variable::Options,
        /// Velocity Verlet in its four-step form.
        VelocityVerlet: velocity_verlet::Options,
        /// Velocity Verlet in its short form.
        VelocityVerletShort: velocity_verlet_short::Options,
        /// Leapfrog with velocities at half steps.
        Leapfrog: leapfrog::Options,
        /// Multiple time steps for a near and a far force.
        Respa: respa::Options,
        /// Forest and Ruth's method of order 4.
        ForestRuth: forest_ruth::Options,
        /// PEFRL, of order 4.
        Pefrl: pefrl::Options,
        /// Blanes and Moan's method of order 4.
        BlanesMoan: blanes_moan::Options,
    }
}

impl Default for IntegratorOptions {
    fn default() -> Self {
        Self::VelocityVerlet(Default::default())
    }
}

/// Makes the integrator that the options describe.
#[must_use]
pub fn build(options: &IntegratorOptions) -> Integrator {
    options.build()
}

/// One line of the list of integrators.
#[derive(Debug, Clone)]
pub struct IntegratorEntry {
    /// What the method declares about itself, at its default options.
    pub spec: &'static IntegratorSpec,
    /// How it is given the oscillator.
    pub oscillator: OscillatorModel,
    /// Its default options.
    pub default_options: IntegratorOptions,
}

impl IntegratorEntry {
    /// The method with its default options.
    #[must_use]
    pub fn build(&self) -> Integrator {
        build(&self.default_options)
    }
}

/// Every integrator, in the order of `lennard list integrators`.
#[must_use]
pub fn integrators() -> &'static [IntegratorEntry] {
    static ENTRIES: LazyLock<Vec<IntegratorEntry>> = LazyLock::new(|| {
        let entry = |options: IntegratorOptions| IntegratorEntry {
            spec: options.spec(),
            oscillator: options.oscillator(),
            default_options: options,
        };
        IntegratorOptions::all().into_iter().map(entry).collect()
    });
    &ENTRIES
}

lennard_core::list_of_methods! {
    /// A thermostat by name, with its options: the `thermostat` of a stage.
    #[serde(tag = "kind", rename_all = "kebab-case")]
    pub enum ThermostatOptions: BathOptions, declared by BATH: ThermostatSpec {
        /// Velocity rescaling to exactly T, every so many steps, as Verlet did.
        Rescale: rescale::Options,
        /// Stochastic velocity rescaling of Bussi, Donadio and Parrinello.
        Bussi: bussi::Options,
        /// Nosé–Hoover chains.
        NoseHoover: nose_hoover::Options,
        /// Langevin dynamics by the BAOAB splitting, in place of the scene's integrator.
        Langevin: langevin::Options,
    }
}

/// Every thermostat, in the order of `lennard list`.
#[must_use]
pub fn thermostats() -> &'static [ThermostatSpec] {
    ThermostatOptions::SPECS
}
