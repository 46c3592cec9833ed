//! What observables see of a run.

use std::sync::OnceLock;

use serde::Serialize;

use crate::exact::Summand;
use crate::rigid::ConstraintSums;
use crate::{Momentum, PeriodicBox, State, System, WallReading};

/// The tail correction of a homogeneous fluid beyond the cutoff (g(r) = 1 there).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct TailCorrection {
    /// Energy per particle, of a molecule where there are some: u_tail = 2πρ ∫ r² U dr for each site, in ε.
    pub energy_per_particle: f64,
    /// Pressure, p_tail = −(2π/3)ρ² ∫ r³ U′ dr, in ε/σ³.
    pub pressure: f64,
}

/// What an observable may look at: nothing here can be changed.
#[derive(Debug, Clone)]
pub struct View<'a> {
    /// Everything at `state.time`.
    pub state: &'a State,
    /// Masses and constraints.
    pub system: &'a System,
    /// Whether the motion keeps the total momentum, which degrees of freedom depend on.
    pub momentum: Momentum,
    /// The tail correction in use; `None` where the scene has none.
    pub tail: Option<TailCorrection>,
    /// Σ heat that thermostats have put in since the stage began, in ε: E − heat is conserved.
    pub heat: f64,
    /// V·P_tail in ε where a barostat changes the box, else 0: the energy of the tail that the motion of the box feels.
    /// E + V·P_tail − heat is then conserved.
    pub tail_work: f64,
    /// The step h in τ of a method that kicks by halves ([`crate::IntegratorSpec::half_kicks`]); `None` for others.
    pub half_kick_step: Option<f64>,
    /// The walls with what they have felt; empty where there are none.
    pub walls: &'a [WallReading],
    /// Sums that several observers ask for.
    pub shared: Shared,
}

/// Sums over a state that are made when an observer first asks for them, and kept for the others.
#[derive(Debug, Clone, Default)]
pub struct Shared {
    constraints: OnceLock<ConstraintSums>,
}

impl<'a> View<'a> {
    /// A state whose total momentum is conserved, without tail, heat and half steps.
    #[must_use]
    pub fn of(state: &'a State, system: &'a System) -> Self {
        Self {
            state,
            system,
            momentum: Momentum::Conserved,
            tail: None,
            heat: 0.0,
            tail_work: 0.0,
            half_kick_step: None,
            walls: &[],
            shared: Shared::default(),
        }
    }

    /// The sums of the instantaneous constraint forces ([`crate::rigid::constraint_sums`]).
    #[must_use]
    pub fn constraint_sums(&self) -> ConstraintSums {
        *self
            .shared
            .constraints
            .get_or_init(|| crate::rigid::constraint_sums(self.system, self.state))
    }

    /// The exact sum of a term over all particles, with its index in the arrays of the state. Each rank gives the terms of the
    /// particles that it keeps.
    pub fn sum<T: Summand<N>, const N: usize>(&self, term: impl Fn(usize) -> T + Sync) -> T {
        self.system.sum(term)
    }

    /// Number of particles, on all ranks.
    #[must_use]
    pub fn len(&self) -> usize {
        self.system.len()
    }

    /// Whether there is no particle at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.system.is_empty()
    }

    /// The box at this time.
    #[must_use]
    pub fn cell(&self) -> &PeriodicBox {
        &self.state.cell
    }

    /// Degrees of freedom n_dof in T = 2K/n_dof.
    #[must_use]
    pub fn n_dof(&self) -> f64 {
        self.system.n_dof(self.momentum)
    }

    /// The kinetic energy K in ε.
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        self.system.kinetic_energy(&self.state.velocities)
    }

    /// Σ (r_i − R)·F_i over the sites of molecules, in ε; zero for atoms. The virial less this number is the molecular one,
    /// Σ R_ab·F_ab, to which forces inside molecules contribute nothing ([`crate::rigid::intramolecular_virial`]).
    #[must_use]
    pub fn intramolecular_virial(&self) -> f64 {
        crate::rigid::intramolecular_virial(self.system, &self.state.positions, &self.state.forces)
    }

    /// The kinetic temperature 2K/n_dof in ε/k_B.
    #[must_use]
    pub fn temperature(&self) -> f64 {
        2.0 * self.kinetic_energy() / self.n_dof()
    }

    /// The mean of the kinetic energies half a step later and half a step earlier, in ε; `None` for a method that does
    /// not kick by halves.
    ///
    /// With v± = v_n ± (h/2)·a_n the mean of ½Σm·v±² is K_n + (h²/8)·Σ|F_n|²/m: the products v·a cancel, and the
    /// forces at hand are enough.
    ///
    /// Why it is wanted: of ẍ = −ω²x the method keeps ½v_n² + ½ω²(1 − h²ω²/4)·x_n² exactly (M. E. Tuckerman,
    /// Statistical Mechanics: Theory and Molecular Simulation, equation 3.13.3, in other letters). Over a long time
    /// the two terms have equal means, so that ⟨v_n²⟩ = (1 − h²ω²/4)·ω²⟨x_n²⟩: on whole steps the kinetic energy is
    /// too low for the positions. Half a step on, ⟨v±²⟩ = ⟨v_n²⟩ + (h²/4)·ω⁴⟨x_n²⟩ = ω²⟨x_n²⟩, without any error. In a
    /// fluid, frequencies are spread and forces are not linear. An error of order h² is left, but a small one: see
    /// `Thermodynamics` in the observables.
    #[must_use]
    pub fn half_step_kinetic_energy(&self) -> Option<f64> {
        let half = 0.5 * self.half_kick_step?;
        let (system, state) = (self.system, self.state);
        if system.molecules.are_rigid() {
            // Constraint forces accelerate sites as all other forces do.
            let squares = self.constraint_sums().squared_forces;
            return Some(self.kinetic_energy() + 0.5 * half * half * squares);
        }
        let squares: f64 = self.sum(|i| state.forces[i].length_squared() / system.masses.of(i));
        Some(self.kinetic_energy() + 0.5 * half * half * squares)
    }

    /// The temperature that belongs to the positions, in ε/k_B: 2K/n_dof. K is the kinetic energy of half steps
    /// where there is one, else of the whole step.
    #[must_use]
    pub fn temperature_of_positions(&self) -> f64 {
        let kinetic = self.half_step_kinetic_energy().unwrap_or_else(|| self.kinetic_energy());
        2.0 * kinetic / self.n_dof()
    }
}
