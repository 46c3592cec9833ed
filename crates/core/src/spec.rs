//! What an integrator declares about itself, what happens in its steps, and why forces and steps fail.

use glam::{DMat2, DVec3};

use crate::{Momentum, Own};

/// What a method declares about itself; conformance tests measure each entry.
#[derive(Debug, Clone, Copy)]
pub struct IntegratorSpec {
    /// Name in scene files, with hyphens.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The update equations, in plain text.
    pub equations: &'static str,
    /// Global order of the positions in dt.
    pub position_order: u32,
    /// Global order of the published velocities in dt.
    pub velocity_order: u32,
    /// Preserves phase-space area (measured on the oscillator).
    pub symplectic: bool,
    /// Returns to its start when velocities are reversed.
    pub reversible: bool,
    /// Refuses a step size that changes.
    pub fixed_step_only: bool,
    /// Accepts forces that depend on velocities.
    pub velocity_dependent_forces: bool,
    /// Whether total momentum is conserved (no noise).
    pub conserves_momentum: bool,
    /// Ends every step with half a kick and begins the next step with the same half kick. Its velocities half
    /// a step later and earlier are therefore v_n ± (h/2)·a_n ([`crate::View::half_step_kinetic_energy`]).
    pub half_kicks: bool,
    /// Whether a step is half a kick, a drift, the forces and half a kick, and nothing else. A backend may then take several
    /// steps at once.
    pub is_kick_drift_kick: bool,
    /// Whether its kicks and drifts hold rigid bonds.
    pub holds_rigid_bonds: bool,
    /// Whether several ranks take its steps: they move each particle by what belongs to it, and by sums over all.
    pub on_ranks: bool,
    /// Force evaluations per step; 0 where their number varies or none is made.
    pub force_evaluations: u32,
    /// The largest stable ω·dt on the oscillator, if there is a finite one.
    pub stability_limit: Option<f64>,
    /// The one-step map on the oscillator ẍ = −ω²x, as the matrix on (x, v), for (ω, dt).
    pub oscillator_map: Option<fn(f64, f64) -> DMat2>,
    /// Author, title, equation.
    pub source: &'static str,
}

impl IntegratorSpec {
    /// Whether the motion keeps the total momentum.
    #[must_use]
    pub fn momentum(&self) -> Momentum {
        if self.conserves_momentum { Momentum::Conserved } else { Momentum::Free }
    }
}

/// What happened in a step, or in several that were taken at once.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StepReport {
    /// Force evaluations made.
    pub force_evaluations: u32,
    /// Iterations of an inner solver.
    pub iterations: u32,
    /// Residual that the inner solver ended with, in its own norm.
    pub residual: f64,
    /// Energy in ε put in by a heat bath in the last step: E − Σ heat is conserved.
    pub heat: f64,
    /// The same of the steps before the last, one by one.
    pub earlier_heats: Vec<f64>,
}

impl StepReport {
    /// Adds the heat of each step to a total, so that the total has the same bits for steps at once and one by one.
    pub fn add_heat_to(&self, total: &mut f64) {
        for heat in &self.earlier_heats {
            *total += heat;
        }
        *total += self.heat;
    }
}

/// Why a step failed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The forces failed.
    #[error(transparent)]
    Force(#[from] ForceError),
    /// The method assumes F(x).
    #[error(
        "`{method}` assumes that forces depend on positions alone, and these depend on velocities"
    )]
    VelocityDependentForce {
        /// The method's name.
        method: &'static str,
    },
    /// The step changed under a method that needs it fixed.
    #[error(
        "`{method}` needs a fixed step: it was started with dt = {started} and asked for dt = {asked}"
    )]
    ChangingStep {
        /// The method's name.
        method: &'static str,
        /// The step it was started with.
        started: f64,
        /// The step asked for.
        asked: f64,
    },
    /// The step is zero, negative or not finite.
    #[error("dt must be a finite positive number, found {0}")]
    BadStep(f64),
    /// An inner solver did not converge.
    #[error(
        "`{method}` did not solve its equations in {iterations} iterations: residual {residual:e}, wanted {wanted:e}"
    )]
    NotConverged {
        /// The method's name.
        method: &'static str,
        /// Iterations made.
        iterations: u32,
        /// Residual reached.
        residual: f64,
        /// Residual wanted.
        wanted: f64,
    },
    /// A bond turned so far in one step that no correction along its old direction restores its length.
    #[error(
        "bond {bond} of molecule {molecule} (counted from 1) turned too far in one step: {found:.4} σ across its old direction, \
         and it is {length} σ long; take a smaller dt"
    )]
    BondTurned {
        /// Number of the molecule, from 1.
        molecule: usize,
        /// Number of the bond in the molecule, from 1.
        bond: usize,
        /// The part of the drifted bond across its old direction, σ.
        found: f64,
        /// The length that the bond must have, σ.
        length: f64,
    },
    /// The bonds of a molecule did not reach their length.
    #[error(
        "molecule {molecule} (counted from 1) did not reach its bond lengths in {iterations} iterations: \
         | |d|/r − 1 | is {residual:.2e}, wanted {wanted:e}; take a smaller dt or `[bonds] method = \"direct\"`"
    )]
    BondsNotConverged {
        /// Number of the molecule, from 1.
        molecule: usize,
        /// Iterations or sweeps made.
        iterations: u32,
        /// The largest | |d|/r − 1 | reached.
        residual: f64,
        /// The tolerance.
        wanted: f64,
    },
    /// The impulses of contacts did not settle.
    #[error(
        "{contacts} contacts of bodies that touch each other were not solved for in {iterations} sweeps: the last one still \
         changed rates by {residual:e} of the largest, wanted {wanted:e}"
    )]
    ContactsNotConverged {
        /// Contacts of the group of bodies.
        contacts: usize,
        /// Sweeps made.
        iterations: u32,
        /// The largest change of a rate by the last sweep, over the largest rate.
        residual: f64,
        /// The residual up to which a solution counts as one.
        wanted: f64,
    },
    /// The method needs something that this system does not offer.
    #[error("`{method}` cannot run this system: {reason}")]
    Unsuited {
        /// The method's name.
        method: &'static str,
        /// What is missing.
        reason: String,
    },
}

// Why forces fail.

/// Why forces cannot be given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ForceError {
    /// A position is not a finite number.
    #[error("the position of particle {particle} is not finite")]
    NonFinitePosition {
        /// Index of the particle, from 0.
        particle: usize,
    },
    /// A force is not a finite number: two particles lie on top of each other.
    #[error("the force on particle {particle} is not finite")]
    NonFiniteForce {
        /// Index of the particle, from 0.
        particle: usize,
    },
    /// The box changed, and the cutoff exceeds half of its shortest side.
    #[error(
        "the box has shrunk to {:.3} σ, below twice the cutoff of {r_cut} σ; \
         take more particles, a shorter cutoff or a lower pressure",
        2.0 * .largest
    )]
    CutoffOverHalfBox {
        /// The cutoff, σ.
        r_cut: f64,
        /// Half the shortest side, σ.
        largest: f64,
    },
    /// The box changed, and the loop in use does not resolve positions in it.
    #[error(
        "the box has grown to {widest:.3} σ, and its pair loop resolves positions up to {largest:.0} σ a side; \
         take `kernel.precision = \"double\"` or a higher pressure"
    )]
    BoxTooWide {
        /// The longest side, σ.
        widest: f64,
        /// The longest side that the loop takes, σ.
        largest: f64,
    },
    /// A particle is beyond a wall, where the wall exerts no force that could bring it back.
    #[error("particle {particle} is {depth:.4} σ beyond the wall at the {end} end of {axis}")]
    BeyondWall {
        /// Index of the particle, from 0.
        particle: usize,
        /// The axis of the wall.
        axis: &'static str,
        /// `lower` or `upper`.
        end: &'static str,
        /// Distance beyond the plane, σ.
        depth: f64,
    },
    /// Two bodies in contact overlap so deeply that they would pass through each other.
    #[error("particles {first} and {second} overlap by {depth:.4} σ at ({:.3}, {:.3}, {:.3}) σ: deeper than {deepest:.4} σ, half their contact distance", .at.x, .at.y, .at.z)]
    ContactTooDeep {
        /// Index of the first particle, from 0.
        first: usize,
        /// Index of the second.
        second: usize,
        /// The depth of the overlap, σ.
        depth: f64,
        /// The deepest overlap that is allowed, σ.
        deepest: f64,
        /// The middle between the two, σ.
        at: DVec3,
    },
    /// The forces have no near and far part.
    #[error("these forces cannot be split into a near and a far part")]
    NotSplit,
    /// The force needs velocities and got none.
    #[error("the force depends on velocities, and the method gives none")]
    NeedsVelocities,
}

// An error of one rank is the error of all.

impl Own {
    /// What all ranks found. Where some met errors of their own particles, all get the error of the lowest rank.
    ///
    /// # Errors
    /// The error.
    pub fn agree<T>(&self, found: Result<T, ForceError>) -> Result<T, ForceError> {
        let Some(team) = self.team() else { return found };
        if !team.any(found.is_err()) {
            return found;
        }
        // An error without words is one that all ranks meet.
        match (self.told(found.as_ref().err().and_then(words_of)), found) {
            (Some(words), _) => Err(error_of(words)),
            (None, found) => found,
        }
    }
}

/// Names of the axes and of the ends of walls, in the order of the words.
const AXES: [&str; 3] = ["x", "y", "z"];
const ENDS: [&str; 2] = ["lower", "upper"];

/// An error of one particle in words; `None` for one that all ranks meet alike.
fn words_of(error: &ForceError) -> Option<[u64; 5]> {
    let place = |names: &[&str], name: &str| names.iter().position(|n| *n == name);
    match error {
        ForceError::NonFinitePosition { particle } => Some([0, *particle as u64, 0, 0, 0]),
        ForceError::NonFiniteForce { particle } => Some([1, *particle as u64, 0, 0, 0]),
        ForceError::BeyondWall { particle, axis, end, depth } => {
            let (axis, end) = (place(&AXES, axis)?, place(&ENDS, end)?);
            Some([2, *particle as u64, axis as u64, end as u64, depth.to_bits()])
        }
        _ => None,
    }
}

/// The error of some words.
fn error_of([kind, particle, axis, end, depth]: [u64; 5]) -> ForceError {
    let particle = particle as usize;
    match kind {
        0 => ForceError::NonFinitePosition { particle },
        1 => ForceError::NonFiniteForce { particle },
        _ => ForceError::BeyondWall {
            particle,
            axis: AXES[axis as usize],
            end: ENDS[end as usize],
            depth: f64::from_bits(depth),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::team_of_threads;

    #[test]
    fn an_error_of_one_rank_is_met_by_all() {
        for ranks in 1..4 {
            team_of_threads(ranks, |team| {
                let own = Own::of_rank(&team, 100);
                let beyond = |particle| ForceError::BeyondWall {
                    particle,
                    axis: "y",
                    end: "upper",
                    depth: 0.3,
                };
                let failed = own.agree(match own.index(99) {
                    Some(_) => Err(beyond(99)),
                    None => Ok(()),
                });
                assert_eq!(failed, Err(beyond(99)));
                assert_eq!(own.agree(Ok(3)), Ok(3));
            });
        }
    }
}
