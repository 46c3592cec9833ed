//! The bit-reversible Verlet of Levesque and Verlet: positions are integers, and nothing is ever lost.

use lennard_core::parallel::{all_pieces, for_each_piece, for_each_piece_pair};
use lennard_core::{
    DVec3, ForceError, Integrator, IntegratorSpec, Masses, Method, Parts, Persist, RestoreError,
    State, StateReader, StateWriter, Step, StepError,
};

use crate::common::MethodOptions;
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of the bit-reversible method.
    ///
    /// The default spacing 2⁻⁴⁸ σ is the resolution of a double at a few dozen σ, with room for ±4096 σ.
    pub struct Options {
        /// Spacing of the grid of positions, best a power of two; the default is 2⁻⁴⁸.
        grid_spacing: f64 = 2.0_f64.powi(-48), Between(1e-18, 1e-3), in "σ";
    }
}

/// What the bit-reversible method declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "bit-reversible-verlet",
    summary: "Störmer–Verlet on integer positions: run back, it returns to its start to the last bit, where forces are a pure function of the positions.",
    equations: "q(t+h) = 2 q(t) - q(t-h) + round(h^2 a(t)/d) in whole multiples q of the grid spacing d, x = d q; published: v(t) = d (q(t+h) - q(t-h))/(2 h)",
    fixed_step_only: true,
    source: "Levesque and Verlet, \"Molecular dynamics and time reversibility\", J. Stat. Phys. 72, 519 (1993)",
    ..VERLET
};

/// Grid positions beyond this are refused: sums of four such numbers still fit into 64 bits.
const LARGEST: i64 = 1 << 60;

type Cell = [i64; 3];

/// Störmer–Verlet on a grid of spacing δ: x = δ·q with whole q.
///
/// With D = q − q⁻ and A = round(h²a/δ), the next position is q + D + A, and the published velocity is
/// the central one, δ·(2D + A)/(2h). A start with this velocity reversed has the predicted q(t+h) as its
/// q⁻, to the bit. The run therefore retraces its steps exactly: the rounded A is a function of the
/// positions alone, and cancels between there and back. This needs forces that are a pure function of the
/// positions, to the bit, which no neighbor list with a history gives by itself.
///
/// Positions and velocities given to `start` are rounded to the grid.
#[derive(Debug, Clone)]
pub struct BitReversibleVerlet {
    spacing: f64,
    started_dt: f64,
    current: Vec<Cell>,
    previous: Vec<Cell>,
}

impl BitReversibleVerlet {
    /// With the given options.
    #[must_use]
    pub fn new(options: &Options) -> Self {
        Self {
            spacing: options.grid_spacing,
            started_dt: 0.0,
            current: Vec::new(),
            previous: Vec::new(),
        }
    }

    /// The first particle without room for the next sums, if there is one.
    fn off_the_grid(&self) -> Option<usize> {
        let outside = |q: &Cell| q.iter().any(|c| c.abs() > LARGEST);
        let inside =
            all_pieces(self.current.len(), |range| !self.current[range].iter().any(outside));
        (!inside).then(|| self.current.iter().position(outside)).flatten()
    }

    /// Puts the positions of the state on the grid.
    ///
    /// Far from the origin a double is coarser than the grid. Where the state still holds the position that was
    /// published, the integers behind it are more exact and are kept.
    fn round_positions(&mut self, state: &mut State) -> Result<(), StepError> {
        self.current.resize(state.len(), [0; 3]);
        for (q, x) in self.current.iter_mut().zip(&mut state.positions) {
            if to_position(*q, self.spacing) != *x {
                *q = to_grid(*x / self.spacing);
                *x = to_position(*q, self.spacing);
            }
        }
        self.off_the_grid().map_or(Ok(()), |particle| {
            Err(StepError::Unsuited {
                method: SPEC.name,
                reason: format!(
                    "particle {particle} lies outside the position grid, ±{:e} σ",
                    LARGEST as f64 * self.spacing
                ),
            })
        })
    }

    /// A = round(h²a/δ) for one particle; saturates far outside the range of the grid.
    fn rounded_push(&self, masses: &Masses, forces: &[DVec3], i: usize) -> Cell {
        let dt = self.started_dt;
        to_grid(forces[i] * (dt * dt / (masses.of(i) * self.spacing)))
    }

    /// The velocity (2D + A)·δ/(2h) of one particle.
    fn central_velocity(&self, now: Cell, before: Cell, push: Cell) -> DVec3 {
        let factor = self.spacing / (2.0 * self.started_dt);
        DVec3::from_array(std::array::from_fn(|c| {
            factor * (2 * (now[c] - before[c]) + push[c]) as f64
        }))
    }

    /// Publishes velocities from grid positions and forces.
    fn publish_velocities(&self, masses: &Masses, state: &mut State) {
        let forces = &state.forces;
        for_each_piece(&mut state.velocities, |first, vs| {
            for (i, v) in (first..).zip(vs) {
                let push = self.rounded_push(masses, forces, i);
                *v = self.central_velocity(self.current[i], self.previous[i], push);
            }
        });
    }
}

/// The nearest whole numbers; saturating, halves away from zero, so that f(−x) = −f(x).
fn to_grid(x: DVec3) -> Cell {
    x.to_array().map(|c| c.round().clamp(-2.0 * LARGEST as f64, 2.0 * LARGEST as f64) as i64)
}

fn to_position(q: Cell, spacing: f64) -> DVec3 {
    DVec3::from_array(q.map(|c| c as f64 * spacing))
}

impl MethodOptions for Options {
    fn build(&self) -> Integrator {
        Integrator::new(BitReversibleVerlet::new(self))
    }
}

impl Persist for BitReversibleVerlet {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { spacing: _, started_dt, current, previous } = self;
        to.put_f64("started_dt", &[*started_dt]);
        to.put_i64("current", current.as_flattened());
        to.put_i64("previous", previous.as_flattened());
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        [self.started_dt] = from.f64s("started_dt")?;
        for (name, target) in [("current", &mut self.current), ("previous", &mut self.previous)] {
            let (cells, rest) = from.i64(name)?.as_chunks::<3>();
            if !rest.is_empty() {
                return Err(from.misfit(name, "not three numbers per particle"));
            }
            *target = cells.to_vec();
        }
        Ok(())
    }
}

impl Method for BitReversibleVerlet {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    fn lets_box_change(&self) -> Result<(), &'static str> {
        Err(
            "it keeps positions on a grid of the box as it was; take \"velocity-verlet\" with a barostat",
        )
    }

    fn start(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        self.started_dt = s.dt();
        self.round_positions(s.parts().state)?;
        s.forces_at_start()?;
        self.remember(s)
    }

    fn remember(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let Parts { system, state, .. } = s.parts();
        let masses = &system.masses;
        let to_steps = 2.0 * self.started_dt / self.spacing;
        self.previous = (0..state.len())
            .map(|i| {
                let push = self.rounded_push(masses, &state.forces, i);
                let twice = to_grid(state.velocities[i] * to_steps);
                // 2D = 2hv/δ − A: even where the velocity was published by this method.
                std::array::from_fn(|c| self.current[i][c] - (twice[c] - push[c]).div_euclid(2))
            })
            .collect();
        self.publish_velocities(masses, state);
        Ok(())
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let masses = &s.system().masses;
        let state = s.parts().state;
        // The new positions overwrite the positions of one step ago, which are no longer needed.
        let mut next = std::mem::take(&mut self.previous);
        for_each_piece_pair(&mut state.positions, &mut next, |first, xs, nexts| {
            for (i, (x, next)) in (first..).zip(xs.iter_mut().zip(nexts)) {
                let push = self.rounded_push(masses, &state.forces, i);
                let now = self.current[i];
                *next = std::array::from_fn(|c| 2 * now[c] - next[c] + push[c]);
                *x = to_position(*next, self.spacing);
            }
        });
        self.previous = std::mem::replace(&mut self.current, next);
        // Only a run-away gets here: it ends as one does in floating point.
        if let Some(particle) = self.off_the_grid() {
            return Err(ForceError::NonFinitePosition { particle }.into());
        }
        s.forces()?;
        self.publish_velocities(masses, s.parts().state);
        Ok(())
    }
}
