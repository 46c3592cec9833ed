//! A run that physics stopped: what was found, and what probably caused it.

use lennard_core::number::short;
use lennard_core::{DVec3, ForceError, StepError};

use crate::close_pairs::ClosePair;

/// Pairs nearer than this (σ_ab) are called overlapping: U(0.6 σ) is 1750 ε.
const OVERLAP: f64 = 0.6;

/// Number densities (σ⁻³) above this are named as a likely mistake: at T = 10 ε/k_B the fluid freezes near 1.6.
const HIGHEST_USUAL_DENSITY: f64 = 1.6;

/// Temperatures (ε/k_B) above this are named as a likely mistake: the critical one is 1.3.
const HIGHEST_USUAL_TEMPERATURE: f64 = 20.0;

/// Speeds (σ/τ) from here on are written with an exponent.
const MOST_IN_PLAIN_DIGITS: f64 = 1e5;

/// The longest legal move of a particle in one step, σ. Thermal moves are √T·dt ≈ 0.005 σ; a fifth of σ in
/// one step carries two particles from contact to deep overlap.
pub const LARGEST_MOVE: f64 = 0.2;

/// The largest legal change of the conserved energy since the stage began, ε per particle. Sound runs
/// stay below 0.01; a run-away passes it within a few steps.
pub const LARGEST_ENERGY_CHANGE: f64 = 1.0;

/// What was found wrong.
#[derive(Debug, Clone, PartialEq)]
pub enum Symptom {
    /// A position or a force is not a finite number.
    NonFinite(ForceError),
    /// A particle moves too far in one step.
    TooFast {
        /// Index of the particle, from 0.
        particle: usize,
        /// Distance of one step, σ.
        distance: f64,
        /// The longest legal one, σ.
        largest: f64,
    },
    /// The conserved energy has run away.
    EnergyRunAway {
        /// Energy at the start of the stage, ε per particle.
        from: f64,
        /// Energy now.
        to: f64,
    },
    /// The force on a particle is not the sum over all pairs.
    WrongForce {
        /// Index of the particle, from 0.
        particle: usize,
        /// The force found, ε/σ.
        found: DVec3,
        /// The sum over all pairs, ε/σ.
        wanted: DVec3,
        /// The largest difference that rounding explains, ε/σ.
        tolerance: f64,
    },
    /// The method itself gave up (a solver did not converge).
    Method(StepError),
}

/// A run that physics stopped: exit code 3.
#[derive(Debug, Clone, PartialEq)]
pub struct PhysicsFailure {
    /// Step at which it was found.
    pub step: u64,
    /// Time in τ.
    pub time: f64,
    /// Name of the stage.
    pub stage: String,
    /// Name of the method.
    pub method: &'static str,
    /// Step size in τ.
    pub dt: f64,
    /// The largest stable step, where it is known.
    pub dt_limit: Option<f64>,
    /// What was found.
    pub symptom: Symptom,
    /// The closest pair, where it is near enough to matter.
    pub closest: Option<ClosePair>,
    /// Positions that are not finite.
    pub non_finite: usize,
    /// The fastest particle with its speed in σ/τ.
    pub fastest: Option<(usize, f64)>,
    /// Speed of the particle that is beyond a wall, σ/τ.
    pub speed_beyond: Option<f64>,
    /// Steps since the stage began.
    pub steps_into_stage: u64,
    /// Temperature of the stage, ε/k_B.
    pub temperature: f64,
    /// Number density, σ⁻³.
    pub density: f64,
    /// What was kept, one line each: states saved, the last checkpoint. Filled in by whoever writes files.
    pub kept: Vec<String>,
}

impl std::error::Error for PhysicsFailure {}

impl std::fmt::Display for PhysicsFailure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { step, time, stage, method, dt, .. } = self;
        write!(
            f,
            "the run failed at step {step} (t = {time:.4} τ, stage `{stage}`, {method} with dt = {} τ): ",
            short(*dt)
        )?;
        match &self.symptom {
            Symptom::NonFinite(e) => write!(f, "{e}")?,
            Symptom::TooFast { particle, distance, largest } => write!(
                f,
                "particle {particle} moves {distance:.3e} σ in one step, more than {largest} σ"
            )?,
            Symptom::EnergyRunAway { from, to } => write!(
                f,
                "the conserved energy ran from {from:.6} to {to:.6} ε per particle, by more than {LARGEST_ENERGY_CHANGE} ε"
            )?,
            Symptom::WrongForce { particle, found, wanted, tolerance } => {
                let three = |v: &DVec3| format!("({:.6}, {:.6}, {:.6}) ε/σ", v.x, v.y, v.z);
                write!(
                    f,
                    "the force on particle {particle} is {} where all pairs give {}: they differ by {:.2e} ε/σ, \
                     and rounding explains {tolerance:.1e} ε/σ",
                    three(found),
                    three(wanted),
                    (*found - *wanted).length()
                )?
            }
            Symptom::Method(e) => write!(f, "{e}")?,
        }
        if let Some(speed) = self.speed_beyond {
            write!(f, ", at a speed of {speed:.4} σ/τ")?;
        }
        if let Some(pair) = self.closest {
            let overlap = if pair.in_own_units() < OVERLAP { ", an overlap" } else { "" };
            write!(
                f,
                "\n  closest pair: particles {} and {} at {:.4} σ{overlap}",
                pair.i, pair.j, pair.distance
            )?;
        }
        if let Some((particle, speed)) = self.fastest {
            let speed = match speed < MOST_IN_PLAIN_DIGITS {
                true => format!("{speed:.4}"),
                false => format!("{speed:.4e}"),
            };
            write!(
                f,
                "\n  fastest: particle {particle} at {speed} σ/τ (particles are counted from 0)"
            )?;
        }
        if self.non_finite > 0 {
            write!(f, "\n  {} positions are not finite numbers", self.non_finite)?;
        }
        write!(f, "\n  likely cause: {}", self.likely_cause())?;
        self.kept.iter().try_for_each(|line| write!(f, "\n  {line}"))
    }
}

impl PhysicsFailure {
    /// Which of the known causes fits, and what to change.
    #[must_use]
    pub fn likely_cause(&self) -> String {
        let dt = short(self.dt);
        match &self.symptom {
            Symptom::WrongForce { .. } => {
                return "a pair inside the cutoff was missed by the list, which is an error of this program: \
                        `neighbor.mode = \"direct\"` does without lists"
                    .into();
            }
            Symptom::Method(StepError::ContactsNotConverged { .. }) => {
                return "sweeps settle slowly where so many bodies touch each other: at rest take `contact.compliance` above 0; \
                        in impacts, which are rigid, say with `contact.sweeps` how many are enough"
                    .into();
            }
            Symptom::NonFinite(ForceError::BeyondWall { .. }) => {
                return format!(
                    "the wall is too weak for a particle so fast, or dt = {dt} τ is too large: take a stiffer wall or a smaller dt"
                );
            }
            Symptom::NonFinite(ForceError::ContactTooDeep { .. }) => {
                return format!(
                    "the spring of the contact is too weak for bodies so fast or so heavy, or dt = {dt} τ is too large: take a larger `contact.stiffness`, a smaller `contact.compliance` or a smaller dt"
                );
            }
            Symptom::NonFinite(ForceError::CutoffOverHalfBox { r_cut, .. }) => {
                return format!(
                    "the barostat compresses the fluid: at this pressure so few particles do not fill a box of {} σ",
                    short(2.0 * r_cut)
                );
            }
            Symptom::NonFinite(ForceError::BoxTooWide { .. }) => {
                return "the barostat expands the fluid: at this pressure it becomes a thin gas"
                    .into();
            }
            _ => {}
        }
        if self.density > HIGHEST_USUAL_DENSITY {
            return format!(
                "the density is ρ = {:.4} σ⁻³, where no fluid is known: check `system.density` or `system.box`",
                self.density
            );
        }
        if self.temperature > HIGHEST_USUAL_TEMPERATURE {
            let limit = self.dt_limit.map_or_else(String::new, |limit| {
                format!("; if it is meant, use a dt of at most {:.2e} τ", 0.25 * limit)
            });
            return format!(
                "the temperature is T = {} ε/k_B, far above the critical 1.3: check `system.temperature` and the temperature of the stage{limit}",
                short(self.temperature)
            );
        }
        let limit = self.dt_limit.filter(|limit| self.dt > 0.5 * limit);
        if limit == Some(0.0) {
            return format!(
                "{} is stable at no step, since it gains energy at every dt: take another `integrator.kind`",
                self.method
            );
        }
        if let Some(limit) = limit {
            return format!(
                "dt = {dt} τ is too large: {} is stable below about {limit:.3} τ here; use at most a quarter of it",
                self.method
            );
        }
        if self.steps_into_stage < 50 && self.closest.is_some_and(|p| p.in_own_units() < OVERLAP) {
            return "particles overlapped at the start: relax the start configuration, or check density and box".into();
        }
        format!(
            "dt = {dt} τ too large for this temperature, or a mistyped temperature or density; try half the dt first"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cause_named_fits_what_happened() {
        let overlap = PhysicsFailure {
            step: 3,
            time: 0.003,
            stage: "s".into(),
            method: "velocity-verlet",
            dt: 0.001,
            dt_limit: Some(0.03),
            symptom: Symptom::TooFast { particle: 1, distance: 3.0, largest: LARGEST_MOVE },
            closest: Some(ClosePair { i: 0, j: 1, distance: 0.5, sigma: 1.0 }),
            non_finite: 0,
            fastest: Some((1, 3e3)),
            speed_beyond: None,
            steps_into_stage: 3,
            temperature: 0.7,
            density: 0.8,
            kept: Vec::new(),
        };
        assert!(overlap.likely_cause().contains("overlapped at the start"), "{overlap}");
        let pair = "particles 0 and 1 at 0.5000 σ, an overlap";
        assert!(overlap.to_string().contains(pair), "{overlap}");
        let usual = || overlap.clone();
        let large = PhysicsFailure { dt: 0.05, ..usual() }.likely_cause();
        assert!(large.contains("dt = 0.05 τ is too large"), "{large}");
        assert!(large.contains("stable below about 0.030 τ"), "{large}");
        let hot = PhysicsFailure { temperature: 722.0, ..usual() }.likely_cause();
        assert!(hot.contains("T = 722") && hot.contains("`system.temperature`"), "{hot}");
        let dense = PhysicsFailure { density: 8.442, ..usual() }.likely_cause();
        assert!(dense.contains("ρ = 8.4420") && dense.contains("`system.density`"), "{dense}");
        let later = PhysicsFailure { steps_into_stage: 5000, dt: 0.01, ..usual() };
        assert!(later.likely_cause().contains("try half the dt first"), "{later}");
    }
}
