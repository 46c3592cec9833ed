//! The forces, as an integrator sees them.

use glam::DVec3;

use crate::{Configuration, Energetics, Masses, Part, Persist, Want};

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
    /// The provider has no near and far part.
    #[error("these forces cannot be split into a near and a far part")]
    NotSplit,
    /// The force needs velocities and got none.
    #[error("the force depends on velocities, and the method gives none")]
    NeedsVelocities,
}

/// What kind of force it is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ForceProperties {
    /// F depends on velocities: methods that assume F(x) refuse it.
    pub velocity_dependent: bool,
    /// F = −K·x with a constant matrix K: implicit methods may solve exactly.
    pub linear: bool,
    /// [`Part::Near`] and [`Part::Far`] are available.
    pub splits: bool,
}

/// What the provider did so far, for the run record.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ForceStatistics {
    /// Evaluations so far.
    pub evaluations: u64,
    /// Neighbor-list builds so far.
    pub builds: u64,
    /// The skin in use, σ; 0 for a direct sum.
    pub skin: f64,
    /// Seconds spent in pair loops.
    pub force_seconds: f64,
    /// Seconds spent building lists.
    pub neighbor_seconds: f64,
    /// Pairs (counted once each) in the current list.
    pub listed_pairs: u64,
    /// Bytes held by lists and private copies.
    pub bytes: u64,
}

/// Steps of kick-drift-kick that follow each other and that nobody looks at in between.
///
/// It begins where forces are due: after a drift, with half a kick given. Each of its steps is F at x,
/// v ← v + (h/2m)·F twice (the closing half kick of one step and the opening one of the next), x ← x + h·v, so that it
/// ends where forces are due again.
#[derive(Debug)]
pub struct Stride<'a> {
    /// Unwrapped positions, `[N]`, σ.
    pub positions: &'a mut [DVec3],
    /// Velocities, `[N]`, σ/τ.
    pub velocities: &'a mut [DVec3],
    /// The masses.
    pub masses: &'a Masses,
    /// The step h, τ.
    pub dt: f64,
    /// How many to take.
    pub steps: u64,
}

/// Gives forces; knows of lists, box and potentials, none of which an integrator sees.
pub trait ForceProvider: Persist {
    /// Writes F = −∂U/∂r at `at` to `forces` (`[N]`, ε/σ) and returns what `want` asks for.
    ///
    /// Forces are the same to the bit whatever `want` asks for.
    ///
    /// # Errors
    /// [`ForceError`] where a position or a force is not finite, or the part is not to be had.
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError>;

    /// Takes steps in one go, and says how many: as many as were asked for, fewer, or none. Positions and velocities are
    /// then those of that many steps, the same to the bit as by [`ForceProvider::evaluate`] and [`crate::sweeps`]; forces
    /// are nowhere written. It never fails: what it leaves is for the caller to do step by step, who meets any error there.
    ///
    /// The default takes none.
    fn stride(&mut self, stride: Stride<'_>) -> u64 {
        let _ = stride;
        0
    }

    /// What kind of force this is.
    fn properties(&self) -> ForceProperties;

    /// What was done so far.
    fn statistics(&self) -> ForceStatistics {
        ForceStatistics::default()
    }

    /// Applies the Hessian to a direction, `out = ∂²U/∂x² · d`, as implicit methods need it.
    ///
    /// The default takes a central difference of forces, −(F(x + η·d) − F(x − η·d))/(2η), with
    /// η = ε_machine^{1/3}/max|d|, whose error is of the order η²·U⁗.
    ///
    /// # Errors
    /// As [`ForceProvider::evaluate`].
    fn hessian_vector(
        &mut self,
        at: Configuration<'_>,
        direction: &[DVec3],
        out: &mut [DVec3],
    ) -> Result<(), ForceError> {
        let largest = direction
            .iter()
            .fold(0.0_f64, |m, d| m.max(d.abs().max_element()));
        if largest == 0.0 {
            out.fill(DVec3::ZERO);
            return Ok(());
        }
        let eta = f64::EPSILON.cbrt() / largest;
        let mut displaced: Vec<DVec3> = at
            .positions
            .iter()
            .zip(direction)
            .map(|(x, d)| *x + eta * *d)
            .collect();
        let mut backward = vec![DVec3::ZERO; displaced.len()];
        self.evaluate(
            Configuration {
                positions: &displaced,
                ..at
            },
            Part::All,
            Want::NOTHING,
            out,
        )?;
        for ((p, x), d) in displaced.iter_mut().zip(at.positions).zip(direction) {
            *p = *x - eta * *d;
        }
        self.evaluate(
            Configuration {
                positions: &displaced,
                ..at
            },
            Part::All,
            Want::NOTHING,
            &mut backward,
        )?;
        for (o, b) in out.iter_mut().zip(&backward) {
            *o = (*b - *o) / (2.0 * eta);
        }
        Ok(())
    }
}
