//! Stops a run that has gone wrong, and says what went wrong.
//!
//! Watching has two parts. The forces refuse numbers that are not finite at every evaluation. The
//! watchdog looks at the speeds (at every [`EVERY`]th step and wherever something is sampled), on sampled
//! steps at the conserved energy, and at every [`LISTS_EVERY`]th step at forces of a few particles
//! ([`crate::ForceCheck`]). A box too small for its cutoff is refused before the first step, and by the forces where it shrinks.

use lennard_core::{DVec3, ForceError, State, StepError, parallel};

use crate::initial::{ClosePair, closest_pair};
use crate::run::SET_ASIDE_EVERY;

/// Steps between two looks at the speeds: at a displacement limit of a fifth of σ a step nothing can
/// cross more than a few σ unseen, and the look costs far below 1 % of the steps between.
pub const EVERY: u64 = 20;

/// Steps between two looks at forces of a few particles, which show whether a list missed a pair; a multiple of [`EVERY`].
pub const LISTS_EVERY: u64 = 100;

/// What the watchdog does how often, for plans and benchmarks.
#[must_use]
pub fn what_is_done() -> String {
    format!(
        "speeds every {EVERY} steps, forces of one or two particles every {LISTS_EVERY}, a state set aside every {SET_ASIDE_EVERY}"
    )
}

/// The longest legal move of a particle in one step, σ. Thermal moves are √T·dt ≈ 0.005 σ; a fifth of σ in
/// one step carries two particles from contact to deep overlap.
pub const LARGEST_MOVE: f64 = 0.2;

/// The largest legal change of the conserved energy since the stage began, ε per particle. Sound runs
/// stay below 0.01; a run-away passes it within a few steps.
pub const LARGEST_ENERGY_CHANGE: f64 = 1.0;

/// Pairs nearer than this (σ) are called overlapping: U(0.6 σ) is 1750 ε.
const OVERLAP: f64 = 0.6;

/// Number densities (σ⁻³) above this are named as a likely mistake: at T = 10 ε/k_B the fluid freezes near 1.6.
const HIGHEST_USUAL_DENSITY: f64 = 1.6;

/// Temperatures (ε/k_B) above this are named as a likely mistake: the critical one is 1.3.
const HIGHEST_USUAL_TEMPERATURE: f64 = 20.0;

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
        let Self {
            step,
            time,
            stage,
            method,
            dt,
            ..
        } = self;
        write!(
            f,
            "the run failed at step {step} (t = {time:.4} τ, stage `{stage}`, {method} with dt = {dt} τ): "
        )?;
        match &self.symptom {
            Symptom::NonFinite(e) => write!(f, "{e}")?,
            Symptom::TooFast { particle, distance } => write!(
                f,
                "particle {particle} moves {distance:.3e} σ in one step, more than {LARGEST_MOVE} σ"
            )?,
            Symptom::EnergyRunAway { from, to } => write!(
                f,
                "the conserved energy ran from {from:.6} to {to:.6} ε per particle, by more than {LARGEST_ENERGY_CHANGE} ε"
            )?,
            Symptom::WrongForce {
                particle,
                found,
                wanted,
                tolerance,
            } => write!(
                f,
                "the force on particle {particle} is ({:.6}, {:.6}, {:.6}) ε/σ where all pairs give ({:.6}, {:.6}, {:.6}) ε/σ: \
                 they differ by {:.2e} ε/σ, and rounding explains {tolerance:.1e} ε/σ",
                found.x,
                found.y,
                found.z,
                wanted.x,
                wanted.y,
                wanted.z,
                (*found - *wanted).length()
            )?,
            Symptom::Method(e) => write!(f, "{e}")?,
        }
        if let Some(pair) = self.closest {
            let overlap = if pair.distance < OVERLAP {
                ", an overlap"
            } else {
                ""
            };
            write!(
                f,
                "\n  closest pair: particles {} and {} at {:.4} σ{overlap}",
                pair.i, pair.j, pair.distance
            )?;
        }
        if let Some((particle, speed)) = self.fastest {
            write!(
                f,
                "\n  fastest: particle {particle} at {speed:.4e} σ/τ (particles are counted from 0)"
            )?;
        }
        if self.non_finite > 0 {
            write!(
                f,
                "\n  {} positions are not finite numbers",
                self.non_finite
            )?;
        }
        write!(f, "\n  likely cause: {}", self.likely_cause())?;
        self.kept
            .iter()
            .try_for_each(|line| write!(f, "\n  {line}"))
    }
}

impl PhysicsFailure {
    /// Which of the known causes fits, and what to change.
    #[must_use]
    pub fn likely_cause(&self) -> String {
        if let Symptom::WrongForce { .. } = self.symptom {
            return "a pair inside the cutoff was missed by the list, which is an error of this program: \
                    `neighbor.mode = \"direct\"` does without lists"
                .into();
        }
        if self.density > HIGHEST_USUAL_DENSITY {
            return format!(
                "the density is ρ = {:.4} σ⁻³, where no fluid is known: check `system.density` or `system.box`",
                self.density
            );
        }
        if self.temperature > HIGHEST_USUAL_TEMPERATURE {
            let limit = self.dt_limit.map_or_else(String::new, |limit| {
                format!(
                    "; if it is meant, use a dt of at most {:.2e} τ",
                    0.25 * limit
                )
            });
            return format!(
                "the temperature is T = {} ε/k_B, far above the critical 1.3: check `system.temperature` and that of the stage{limit}",
                self.temperature
            );
        }
        let limit = self.dt_limit.filter(|limit| self.dt > 0.5 * limit);
        if let Some(limit) = limit {
            return format!(
                "dt = {} τ is too large: {} is stable below about {limit:.3} τ here; use at most a quarter of it",
                self.dt, self.method
            );
        }
        if self.steps_into_stage < 50 && self.closest.is_some_and(|p| p.distance < OVERLAP) {
            return "particles overlapped at the start: relax the start configuration, or check density and box".into();
        }
        format!(
            "dt = {} τ too large for this temperature, or a mistyped temperature or density; try half the dt first",
            self.dt
        )
    }
}

/// Where and with what a run was when it failed.
#[derive(Debug, Clone, Copy)]
pub struct Circumstances<'a> {
    /// Name of the stage.
    pub stage: &'a str,
    /// Name of the method.
    pub method: &'static str,
    /// Step size in τ.
    pub dt: f64,
    /// The largest stable step, where it is known.
    pub dt_limit: Option<f64>,
    /// Steps since the stage began.
    pub steps_into_stage: u64,
    /// Temperature of the stage, ε/k_B.
    pub temperature: f64,
    /// Number density, σ⁻³.
    pub density: f64,
}

/// The largest squared speed, (σ/τ)², the same for any number of threads; NaN counts as infinite.
fn largest_squared_speed(velocities: &[DVec3]) -> f64 {
    #[derive(Clone, Copy)]
    struct Max(f64);
    impl std::ops::Add for Max {
        type Output = Self;
        fn add(self, other: Self) -> Self {
            Self(self.0.max(other.0))
        }
    }
    impl std::iter::Sum for Max {
        fn sum<I: Iterator<Item = Self>>(iter: I) -> Self {
            iter.fold(Self(0.0), |a, b| a + b)
        }
    }
    let squared = |v: &DVec3| {
        let v2 = v.length_squared();
        if v2.is_nan() { f64::INFINITY } else { v2 }
    };
    parallel::ordered_sum(velocities.len(), |range| {
        Max(velocities[range].iter().map(squared).fold(0.0, f64::max))
    })
    .0
}

/// Fails where a particle moves more than [`LARGEST_MOVE`] in one step.
///
/// # Errors
/// The symptom.
pub fn check_speeds(state: &State, dt: f64) -> Result<(), Symptom> {
    if largest_squared_speed(&state.velocities) * dt * dt <= LARGEST_MOVE * LARGEST_MOVE {
        return Ok(());
    }
    let (particle, speed) = fastest(state).unwrap_or((0, f64::INFINITY));
    Err(Symptom::TooFast {
        particle,
        distance: speed * dt,
    })
}

/// Fails where the conserved energy per particle has left its start by more than [`LARGEST_ENERGY_CHANGE`].
///
/// # Errors
/// The symptom.
pub fn check_energy(from: f64, to: f64) -> Result<(), Symptom> {
    if (to - from).abs() <= LARGEST_ENERGY_CHANGE {
        Ok(())
    } else {
        Err(Symptom::EnergyRunAway { from, to })
    }
}

fn fastest(state: &State) -> Option<(usize, f64)> {
    state
        .velocities
        .iter()
        .map(|v| {
            if v.is_finite() {
                v.length()
            } else {
                f64::INFINITY
            }
        })
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Puts together what is known of a failure.
#[must_use]
pub fn diagnose(state: &State, at: Circumstances<'_>, symptom: Symptom) -> PhysicsFailure {
    PhysicsFailure {
        step: state.step,
        time: state.time,
        stage: at.stage.to_owned(),
        method: at.method,
        dt: at.dt,
        dt_limit: at.dt_limit,
        symptom,
        closest: closest_pair(&state.cell, &state.positions, 0.9),
        non_finite: state.positions.iter().filter(|r| !r.is_finite()).count(),
        fastest: fastest(state),
        steps_into_stage: at.steps_into_stage,
        temperature: at.temperature,
        density: at.density,
        kept: Vec::new(),
    }
}

/// An estimate of the largest stable dt of an explicit method with limit ωh = `limit` in a fluid:
/// h = limit/ω_max, where ω_max² = U″(r₀)·c/m at the closest approach r₀ that thermal pairs reach, U(r₀) ≈ 4T.
///
/// For Lennard-Jones 4(s² − s) = 4T with s = r₀⁻⁶, and U″ = 4(156 s² − 42 s)·s^{1/3}. A pair vibrates with
/// its reduced mass, a factor 2 in ω². Rough (±30 %), which is enough to name a cause.
#[must_use]
pub fn rough_stable_dt(temperature: f64, limit: f64) -> f64 {
    let s = 0.5 * (1.0 + (1.0 + 4.0 * temperature).sqrt());
    let curvature = 4.0 * (156.0 * s * s - 42.0 * s) * s.cbrt();
    limit / (2.0 * curvature).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lennard_core::PeriodicBox;

    fn state(speed: f64) -> State {
        let mut s = State::new(
            PeriodicBox::new(DVec3::splat(10.0)).unwrap(),
            vec![DVec3::ZERO, DVec3::new(0.5, 0.0, 0.0)],
            vec![DVec3::ZERO; 2],
        );
        s.velocities[1].y = speed;
        s
    }

    #[test]
    fn a_particle_is_stopped_just_past_the_limit_and_not_just_below() {
        let dt = 0.01;
        assert!(check_speeds(&state(0.999 * LARGEST_MOVE / dt), dt).is_ok());
        let found = check_speeds(&state(1.001 * LARGEST_MOVE / dt), dt);
        assert!(
            matches!(found, Err(Symptom::TooFast { particle: 1, .. })),
            "{found:?}"
        );
        assert!(check_speeds(&state(f64::NAN), dt).is_err());
        assert!(check_energy(-4.0, f64::NAN).is_err());
    }

    #[test]
    fn the_cause_named_fits_what_happened() {
        let at = Circumstances {
            stage: "s",
            method: "velocity-verlet",
            dt: 0.001,
            dt_limit: Some(0.03),
            steps_into_stage: 3,
            temperature: 0.7,
            density: 0.8,
        };
        let symptom = Symptom::TooFast {
            particle: 1,
            distance: 3.0,
        };
        let overlap = diagnose(&state(3e3), at, symptom.clone());
        assert!(
            overlap.likely_cause().contains("overlapped at the start"),
            "{overlap}"
        );
        assert!(
            overlap
                .to_string()
                .contains("particles 0 and 1 at 0.5000 σ, an overlap"),
            "{overlap}"
        );
        let cause = |at| diagnose(&state(3e3), at, symptom.clone()).likely_cause();
        let large = cause(Circumstances { dt: 0.05, ..at });
        assert!(
            large.contains("dt = 0.05 τ is too large")
                && large.contains("stable below about 0.030 τ"),
            "{large}"
        );
        let hot = cause(Circumstances {
            temperature: 722.0,
            ..at
        });
        assert!(
            hot.contains("T = 722") && hot.contains("`system.temperature`"),
            "{hot}"
        );
        let dense = cause(Circumstances {
            density: 8.442,
            ..at
        });
        assert!(
            dense.contains("ρ = 8.4420") && dense.contains("`system.density`"),
            "{dense}"
        );
        let later = diagnose(
            &state(3e3),
            Circumstances {
                steps_into_stage: 5000,
                dt: 0.01,
                ..at
            },
            symptom.clone(),
        );
        assert!(
            later.likely_cause().contains("try half the dt first"),
            "{later}"
        );
    }

    #[test]
    fn the_rough_limit_lies_near_the_known_one() {
        // Blow-up of velocity Verlet near the triple point is seen between 0.02 and 0.04 τ.
        let h = rough_stable_dt(0.722, 2.0);
        assert!((0.02..0.06).contains(&h), "{h}");
    }
}
