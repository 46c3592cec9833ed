//! Stochastic cell rescaling: the volume follows its own Langevin equation, and Metropolis corrects each move.

use lennard_core::exact::exact_sum;
use lennard_core::parallel::for_each_piece;
use lennard_core::random::NoiseStream;
use lennard_core::{
    Barostat, BarostatSpec, BoxMoves, DVec3, Energetics, ForceError, Integrator, Part, Parts,
    PeriodicBox, PressureBath, Step, StepError, System, Want, persist,
};
use rand_distr::{Distribution, StandardNormal, StandardUniform};

use super::{BarostatParts, Coupling, move_centers, scale_box};
use crate::ThermostatOptions;

lennard_core::options! {
    /// Options of stochastic cell rescaling.
    ///
    /// The default time is half a sound crossing of a box of 10 σ. At the default interval changes cost about a sixth of the time.
    pub struct Options {
        /// Relaxation time of the volume, where the compressibility is the fluid's own.
        tau: f64 = 1.0, Between(1e-6, 1e9), in "τ";
        /// Steps between two changes of the box; the ensemble is exact at each interval.
        interval: u64 = 10, Whole(1, lennard_core::options::MOST_STEPS), in "steps";
        /// Which sides change together: "isotropic" for fluids, "z" for slabs across z, "xy-z" for crystals.
        coupling: Coupling = Coupling::Isotropic, Names(Coupling::names);
        /// Estimate of the isothermal compressibility κ, which sets the pace alone.
        compressibility: Option<f64> = None, else "the equation of state at (T, P); else 1/P for a gas and 0.1 for a liquid", Between(1e-9, 1e9), in "σ³/ε";
    }
}

impl BarostatParts for Options {
    fn couple(
        &self,
        method: Integrator,
        _thermostat: &ThermostatOptions,
        bath: PressureBath,
        noise: NoiseStream,
    ) -> Integrator {
        method.with_barostat(StochasticCellRescaling::new(self, bath, noise))
    }

    fn tau(&self) -> f64 {
        self.tau
    }

    fn interval(&self) -> u64 {
        self.interval
    }

    /// The forces of the new state.
    fn evaluations(&self) -> u64 {
        1
    }

    fn coupling(&self) -> Coupling {
        self.coupling
    }

    fn compressibility(&self) -> Option<f64> {
        self.compressibility
    }
}

/// What stochastic cell rescaling declares about itself.
pub const SPEC: BarostatSpec = BarostatSpec {
    name: "stochastic-cell-rescaling",
    summary: "Stochastic cell rescaling between steps, each change accepted by Metropolis: exact at any interval.",
    equation: "d(ln V) = -(kappa/tau)(P0 - P) dt + sqrt(2 T kappa/(V tau)) dW, P = (n_dof T/3 + W/3)/V + P_tail, with a Metropolis test; for molecules, n_dof and W are those of their centres",
    thermostat: None,
    source: "Bernetti and Bussi, \"Pressure control using stochastic cell rescaling\", J. Chem. Phys. 153, 114107 (2020), equation 6; the Metropolis test is the exact one of the Euler proposal in √V",
};

/// Stochastic cell rescaling as a proposal in λ = √V, accepted by Metropolis.
///
/// With D = κT/(4τ) and f(λ) = −2λ·(P₀ − P − T/(2V)) the proposal over Δ = interval·dt is
///
/// δ = (D/T)·f·Δ + √(2DΔ)·R, V′ = (λ + δ)², x ← x·(V′/V)^{1/3}.
///
/// It is accepted with min(1, e^{−ΔH/T}), where
///
/// ΔH = Δ[U_s + V·P_tail + P₀V − (n_dof/3 + ½)·T·ln V] + ½δ(f + f′) + (DΔ/4T)(f′² − f²).
///
/// P = (n_dof·T/3 + W/3)/V + P_tail takes the temperature of the bath; velocities stay as they are.
/// The volume is then sampled as p(V) ∝ V^{n_dof/3}·e^{−(U + P₀V)/T}.
///
/// Molecules move as a whole with their centres of mass, R ← R·(V′/V)^{1/3}. Bonds keep their length, and velocities and the
/// inside of a molecule are as they were. The centres alone feel the volume: n_dof counts their degrees of freedom, and W is
/// the molecular virial W − Σ (r_i − R)·F_i.
#[derive(Debug, Clone)]
pub struct StochasticCellRescaling {
    tau: f64,
    interval: u64,
    coupling: Coupling,
    bath: PressureBath,
    noise: NoiseStream,
    moves: BoxMoves,
    /// Working space: positions before the move, and forces after it.
    before: Vec<DVec3>,
    forces: Vec<DVec3>,
}

/// The sides that one move changes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Sides {
    All,
    Z,
    Xy,
}

impl Sides {
    /// The factors of the sides that make `ratio` of the volume.
    fn factors(self, ratio: f64) -> DVec3 {
        match self {
            Self::All => DVec3::splat(ratio.cbrt()),
            Self::Z => DVec3::new(1.0, 1.0, ratio),
            Self::Xy => DVec3::new(ratio.sqrt(), ratio.sqrt(), 1.0),
        }
    }
}

/// The volume and what belongs to it, with the force on λ.
struct AtVolume {
    volume: f64,
    /// U_s + V·P_tail, ε.
    energy: f64,
    /// f = −2λ·(P₀ − P − T/(2V)).
    force: f64,
}

/// One number serves the whole system, so its stream has a single index.
const WHOLE_SYSTEM: u32 = 0;

impl StochasticCellRescaling {
    /// A barostat that draws from `noise`, keyed by the step.
    #[must_use]
    pub fn new(options: &Options, bath: PressureBath, noise: NoiseStream) -> Self {
        Self {
            tau: options.tau,
            interval: options.interval,
            coupling: options.coupling,
            bath,
            noise,
            moves: BoxMoves::default(),
            before: Vec::new(),
            forces: Vec::new(),
        }
    }

    /// The sides of the move after a step: with two groups of sides, one in turn with the other.
    fn sides(&self, step: u64) -> Sides {
        match self.coupling {
            Coupling::Isotropic => Sides::All,
            Coupling::Z => Sides::Z,
            Coupling::XyZ if (step / self.interval).is_multiple_of(2) => Sides::Xy,
            Coupling::XyZ => Sides::Z,
        }
    }

    /// What belongs to a volume, from energy and virial there; `None` where these were not delivered.
    fn at_volume(
        &self,
        step: u64,
        n_dof: f64,
        sides: Sides,
        cell: &PeriodicBox,
        energetics: &Energetics,
        inside: DVec3,
    ) -> Option<AtVolume> {
        let (p0, t) = (self.bath.pressure.at(step), self.bath.temperature.at(step));
        let volume = cell.volume();
        let virial = match sides {
            Sides::All => (energetics.scalar_virial()? - inside.element_sum()) / 3.0,
            Sides::Z => energetics.virial?.z_axis.z - inside.z,
            Sides::Xy => {
                let w = energetics.virial?;
                0.5 * (w.x_axis.x - inside.x + w.y_axis.y - inside.y)
            }
        };
        let tail = self.bath.tail / (volume * volume);
        let pressure = (n_dof * t / 3.0 + virial) / volume + tail;
        let sampled = energetics.conserved_potential;
        Some(AtVolume {
            volume,
            energy: sampled.or(energetics.potential_energy)? + volume * tail,
            force: -2.0 * volume.sqrt() * (p0 - pressure - 0.5 * t / volume),
        })
    }

    /// Scales positions and box; the positions before are kept.
    fn scale(&mut self, s: &mut Step<'_>, factors: DVec3) -> Result<(), StepError> {
        let Parts { system, state, .. } = s.parts();
        scale_box(state, factors)?;
        self.before.clone_from(&state.positions);
        if system.molecules.are_atoms() {
            for_each_piece(&mut state.positions, |_, chunk| {
                for x in chunk {
                    *x *= factors;
                }
            });
            return Ok(());
        }
        move_centers(system, &mut state.positions, |_, center| (factors - DVec3::ONE) * center);
        Ok(())
    }
}

/// Degrees of freedom of the centres of mass, where all sites have n_dof. Each molecule has three, less one for each component of
/// the total momentum that is conserved.
#[must_use]
pub fn dof_of_centers(system: &System, n_dof: f64) -> f64 {
    let molecules = &system.molecules;
    if molecules.are_atoms() {
        return n_dof;
    }
    let n = system.n_molecules() as f64;
    let rigid = match molecules.are_rigid() {
        true => molecules.bonds().len() as f64 * n,
        false => 0.0,
    };
    let conserved = 3.0 * system.len() as f64 - rigid - n_dof;
    3.0 * n - conserved
}

/// Σ (r_i − R)·F_i for each axis, ε: what the molecular virial lacks of the virial of sites; zero for atoms.
fn inside_molecules(system: &System, positions: &[DVec3], forces: &[DVec3]) -> DVec3 {
    let molecules = &system.molecules;
    if molecules.are_atoms() {
        return DVec3::ZERO;
    }
    exact_sum(system.n_molecules(), |m| {
        let sites = molecules.sites_of(m);
        let x = &positions[sites.clone()];
        let center = molecules.center(&system.masses, sites.start, x);
        let both = x.iter().zip(&forces[sites]);
        both.map(|(r, f)| (*r - center) * *f).sum::<DVec3>()
    })
}

persist!(StochasticCellRescaling { ..moves, fixed tau, interval, coupling, bath, noise, before, forces });

impl Barostat for StochasticCellRescaling {
    fn acts_after(&self, step: u64) -> bool {
        // An interval of zero is refused by `check`; here it means never.
        self.interval != 0 && step.is_multiple_of(self.interval)
    }

    /// One side by itself feels its own component of the pressure.
    fn wants(&self) -> Want {
        match self.coupling {
            Coupling::Isotropic => Want::ENERGY_AND_VIRIAL,
            Coupling::Z | Coupling::XyZ => Want::ENERGY_AND_VIRIAL | Want::VIRIAL_TENSOR,
        }
    }

    fn apply(&mut self, s: &mut Step<'_>) -> Result<bool, StepError> {
        let n_dof = dof_of_centers(s.system(), s.n_dof());
        let want = s.want() | self.wants();
        let elapsed = self.interval as f64 * s.dt();
        let Parts { system, state, .. } = s.parts();
        let (step, cell) = (state.step, state.cell);
        let t = self.bath.temperature.at(step);
        let sides = self.sides(step);
        let inside = inside_molecules(system, &state.positions, &state.forces);
        let here = self.at_volume(step, n_dof, sides, &cell, &state.energetics, inside);
        let Some(old) = here else {
            return Ok(false);
        };

        let mut rng = self.noise.at(step, WHOLE_SYSTEM);
        let normal: f64 = StandardNormal.sample(&mut rng);
        let chance: f64 = StandardUniform.sample(&mut rng);
        let diffusion = self.bath.compressibility * t / (4.0 * self.tau);
        let root = old.volume.sqrt();
        let delta =
            diffusion / t * old.force * elapsed + (2.0 * diffusion * elapsed).sqrt() * normal;
        self.moves.tried += 1;
        if root + delta <= 0.0 {
            return Ok(false);
        }
        self.scale(s, sides.factors((1.0 + delta / root).powi(2)))?;

        let mut forces = std::mem::take(&mut self.forces);
        forces.resize(self.before.len(), DVec3::ZERO);
        let found = s.part_of_forces(Part::All, 1.0, want, &mut forces);
        let Parts { system, state, .. } = s.parts();
        let new = match &found {
            Ok(energetics) => {
                let inside = inside_molecules(system, &state.positions, &forces);
                self.at_volume(step, n_dof, sides, &state.cell, energetics, inside)
            }
            Err(_) => None,
        };
        let change = new.as_ref().map_or(f64::INFINITY, |new| {
            let h = |v: &AtVolume| {
                let entropy = (n_dof / 3.0 + 0.5) * t * v.volume.ln();
                v.energy + self.bath.pressure.at(step) * v.volume - entropy
            };
            let forces = 0.5 * delta * (old.force + new.force);
            let squares = new.force.powi(2) - old.force.powi(2);
            h(new) - h(&old) + forces + 0.25 * diffusion * elapsed / t * squares
        });
        let accepted = chance < (-change / t).exp();
        if let (true, Some(new), Ok(energetics)) = (accepted, new, &found) {
            std::mem::swap(&mut state.forces, &mut forces);
            state.energetics = energetics.clone();
            self.moves.accepted += 1;
            s.add_heat(new.energy - old.energy);
        } else {
            state.cell = cell;
            std::mem::swap(&mut state.positions, &mut self.before);
        }
        self.forces = forces;
        match found {
            // Two particles on top of each other: that move has no chance.
            Err(StepError::Force(ForceError::NonFiniteForce { .. })) => Ok(false),
            Err(error) => Err(error),
            Ok(_) => Ok(accepted),
        }
    }

    fn moves(&self) -> BoxMoves {
        self.moves
    }
}
