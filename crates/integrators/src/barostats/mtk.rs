//! The barostat of Martyna, Tobias and Klein with Nosé–Hoover chains: deterministic, inside the step.

use lennard_core::exact::exact_sum;
use lennard_core::parallel::{for_each_piece, for_each_piece_pair};
use lennard_core::random::NoiseStream;
use lennard_core::{
    BarostatSpec, DVec3, ForceProperties, Integrator, IntegratorSpec, Method, Moving, Parts,
    PressureBath, State, Step, StepError, System, Want, persist, rigid, rigid_bonds_alone,
};

use super::stochastic_cell_rescaling::dof_of_centers;
use super::{BarostatParts, move_centers, scale_box};
use crate::nose_hoover::Chain;
use crate::velocity_verlet::VERLET;
use crate::{ThermostatOptions, nose_hoover};

lennard_core::options! {
    /// Options of the barostat of Martyna, Tobias and Klein. The thermostat beside it gives the chain of the particles.
    pub struct Options {
        /// Period of the box; its mass is (n_dof + 3)·T·τ², with the degrees of freedom of the centres of molecules.
        tau: f64 = 1.0, Between(1e-6, 1e9), in "τ";
        /// Thermostats in the chain of the box.
        chain: u32 = 3, Whole(1, 10), in "thermostats";
    }
}

impl BarostatParts for Options {
    /// Box and chains stand inside the step: they take the place of the method.
    fn couple(
        &self,
        method: Integrator,
        thermostat: &ThermostatOptions,
        bath: PressureBath,
        _noise: NoiseStream,
    ) -> Integrator {
        match thermostat {
            ThermostatOptions::NoseHoover(chain) => Integrator::new(Mtk::new(self, chain, bath)),
            // A scene with another thermostat is refused by the spec.
            _ => method,
        }
    }

    fn is_inside_step(&self) -> bool {
        true
    }

    fn tau(&self) -> f64 {
        self.tau
    }

    fn interval(&self) -> u64 {
        1
    }

    fn evaluations(&self) -> u64 {
        0
    }
}

const NAME: &str = "mtk";
const SUMMARY: &str = "Martyna, Tobias and Klein: the box as a particle with a mass, chains on box and fluid; isotropic.";
const EQUATION: &str = "W dv/dt = (1 + 3/n_dof) 2K + W_pairs + 3 V P_tail - 3 V P0 - W v xi_b, dV/dt = 3 V v, W = (n_dof + 3) T tau^2; for molecules, n_dof, K and W_pairs are those of their centres";
const SOURCE: &str = "Martyna, Tobias and Klein, \"Constant pressure molecular dynamics algorithms\", J. Chem. Phys. 101, 4177 (1994), in the splitting of Tuckerman, Alejandre, López-Rendón, Jochim and Martyna, J. Phys. A 39, 5629 (2006)";

/// What the barostat declares about itself.
pub const SPEC: BarostatSpec = BarostatSpec {
    name: NAME,
    summary: SUMMARY,
    equation: EQUATION,
    thermostat: Some(nose_hoover::BATH.name),
    source: SOURCE,
};

/// What its step declares about itself as an integrator.
static STEP: IntegratorSpec = IntegratorSpec {
    name: NAME,
    summary: SUMMARY,
    equations: EQUATION,
    symplectic: false,
    holds_rigid_bonds: true,
    oscillator_map: None,
    source: SOURCE,
    ..VERLET
};

/// The box as a particle: with v_ε = V̇/(3V) and α = 1 + 3/n_dof,
///
/// ẋ = v + v_ε·x, v̇ = F/m − α·v_ε·v, W·v̇_ε = α·2K + W_pairs + 3V·P_tail − 3V·P₀,
///
/// with one chain on the velocities and another on v_ε. The conserved quantity is
/// K + U_s + V·P_tail + P₀V + ½W·v_ε² + the energies of both chains; all but the first three count as heat.
///
/// For molecules the terms with v_ε act on the centres of mass R and their velocities U alone, with α = 1 + 3/n_c. The centres
/// have the numbers n_c, K and W_pairs, while the chain acts on all sites. Sites keep their places around the centre, so that bonds
/// keep their length in a box that changes. The flow of R, U and the box then has no divergence of its own, as for atoms.
#[derive(Debug, Clone)]
pub struct Mtk {
    tau: f64,
    bath: PressureBath,
    /// v_ε in 1/τ.
    expansion: f64,
    of_particles: Chain,
    of_box: Chain,
    /// W_pairs at the positions, ε; for molecules the virial of their centres.
    virial: f64,
}

/// What a step takes from the baths, and what follows from them.
struct Held {
    n_dof: f64,
    /// Degrees of freedom of the centres of molecules.
    of_centers: f64,
    temperature: f64,
    pressure: f64,
    /// Mass W of the box, ε·τ².
    mass: f64,
}

impl Mtk {
    /// A box at rest, with the chain of the thermostat on the particles.
    #[must_use]
    pub fn new(options: &Options, chain: &nose_hoover::Options, bath: PressureBath) -> Self {
        Self {
            tau: options.tau,
            bath,
            expansion: 0.0,
            of_particles: Chain::new(chain.chain, chain.tau),
            of_box: Chain::new(options.chain, options.tau),
            virial: 0.0,
        }
    }

    /// The baths as they are at the end of a step, which they are taken at throughout it.
    fn held(&self, s: &mut Step<'_>) -> Held {
        let n_dof = s.n_dof();
        let of_centers = dof_of_centers(s.system(), n_dof);
        let end = s.parts().state.step + 1;
        let temperature = self.bath.temperature.at(end);
        Held {
            n_dof,
            of_centers,
            temperature,
            pressure: self.bath.pressure.at(end),
            mass: (of_centers + 3.0) * temperature * self.tau * self.tau,
        }
    }

    /// P₀V + ½W·v_ε² + the energies of the chains, ε.
    fn energy(&self, held: &Held, volume: f64) -> f64 {
        held.pressure * volume
            + 0.5 * held.mass * self.expansion.powi(2)
            + self.of_particles.energy(held.n_dof, held.temperature)
            + self.of_box.energy(1.0, held.temperature)
    }

    /// Half a step of the chain of the box.
    fn advance_chain_of_box(&mut self, held: &Held, half: f64) {
        let kinetic = 0.5 * held.mass * self.expansion.powi(2);
        self.expansion *= self.of_box.advance(kinetic, 1.0, held.temperature, half);
    }

    /// Half a step of the chain of the particles.
    fn advance_chain_of_particles(&mut self, s: &mut Step<'_>, held: &Held, half: f64) {
        let Parts { system, state, .. } = s.parts();
        let kinetic = system.kinetic_energy(&state.velocities);
        if kinetic <= 0.0 {
            return;
        }
        let chain = &mut self.of_particles;
        let factor = chain.advance(kinetic, held.n_dof, held.temperature, half);
        Moving::of(state).scale(factor);
    }

    /// Half a kick of the box.
    fn kick_box(&mut self, s: &mut Step<'_>, held: &Held, half: f64) {
        let Parts { system, state, .. } = s.parts();
        let volume = state.cell.volume();
        let twice_kinetic = 2.0 * kinetic_energy_of_centers(system, &state.velocities);
        let force = held.alpha() * twice_kinetic + self.virial + 3.0 * self.bath.tail / volume
            - 3.0 * volume * held.pressure;
        self.expansion += half * force / held.mass;
    }

    /// Half a kick of the particles: v ← v·e^{−2y} + (h/2m)·F·e^{−y}·sinhc(y) with y = α·v_ε·h/4.
    fn kick_particles(&self, s: &mut Step<'_>, held: &Held, half: f64) {
        let y = 0.5 * half * held.alpha() * self.expansion;
        let (damping, push) = ((-2.0 * y).exp(), half * (-y).exp() * sinhc(y));
        if !s.system().molecules.are_atoms() {
            return kick_molecules(s, (damping, push), half);
        }
        let Parts { system, state, .. } = s.parts();
        let forces = &state.forces;
        for_each_piece(&mut state.velocities, |first, chunk| {
            for (i, v) in (first..).zip(chunk) {
                *v = damping * *v + (push / system.masses.of(i)) * forces[i];
            }
        });
    }

    /// The drift of particles and box: x ← x·e^{2y} + h·v·e^y·sinhc(y) with y = v_ε·h/2, L ← L·e^{2y}.
    fn drift(&self, s: &mut Step<'_>) -> Result<(), StepError> {
        let h = s.dt();
        let y = 0.5 * h * self.expansion;
        let (stretch, way) = ((2.0 * y).exp(), h * y.exp() * sinhc(y));
        let are_atoms = s.system().molecules.are_atoms();
        if !are_atoms {
            drift_molecules(s, stretch, way);
        }
        let state = s.parts().state;
        scale_box(state, DVec3::splat(stretch))?;
        if !are_atoms {
            return Ok(());
        }
        for_each_piece_pair(&mut state.positions, &mut state.velocities, |_, xs, vs| {
            for (x, v) in xs.iter_mut().zip(vs) {
                *x = stretch * *x + way * *v;
            }
        });
        Ok(())
    }

    fn keep_virial(&mut self, s: &mut Step<'_>) {
        let Parts { system, state, .. } = s.parts();
        let virial = state.energetics.scalar_virial().unwrap_or(f64::NAN);
        self.virial =
            virial - rigid::intramolecular_virial(system, &state.positions, &state.forces);
    }
}

impl Held {
    /// α = 1 + 3/n_c.
    fn alpha(&self) -> f64 {
        1.0 + 3.0 / self.of_centers
    }
}

/// ½·Σ M·U² over the centres of mass, ε.
fn kinetic_energy_of_centers(system: &System, velocities: &[DVec3]) -> f64 {
    let (molecules, masses) = (&system.molecules, &system.masses);
    if molecules.are_atoms() {
        return system.kinetic_energy(velocities);
    }
    exact_sum(system.n_molecules(), |m| {
        let sites = molecules.sites_of(m);
        let mass: f64 = sites.clone().map(|i| masses.of(i)).sum();
        let center = molecules.center(masses, sites.start, &velocities[sites]);
        0.5 * mass * center.length_squared()
    })
}

/// Half a kick of molecules, after which U is U·`damping` + `push`·F/M. The velocities around the centre take a plain kick.
fn kick_molecules(s: &mut Step<'_>, (damping, push): (f64, f64), half: f64) {
    s.kick(half / s.dt());
    let Parts { system, state, .. } = s.parts();
    let State { velocities, forces, .. } = state;
    move_centers(system, velocities, |m, kicked| {
        let sites = system.molecules.sites_of(m);
        let mass: f64 = sites.clone().map(|i| system.masses.of(i)).sum();
        let acceleration = forces[sites].iter().sum::<DVec3>() / mass;
        // Impulses of bonds leave the centre alone.
        let before = kicked - half * acceleration;
        damping * before + push * acceleration - kicked
    });
}

/// The drift of molecules, after which R is `stretch`·R + `way`·U. The sites drift around the centre, with their bonds held.
fn drift_molecules(s: &mut Step<'_>, stretch: f64, way: f64) {
    let h = s.dt();
    s.drift(1.0);
    let Parts { system, state, .. } = s.parts();
    let State { positions, velocities, .. } = state;
    move_centers(system, positions, |m, drifted| {
        let sites = system.molecules.sites_of(m);
        let velocity =
            system.molecules.center(&system.masses, sites.start, &velocities[sites.clone()]);
        let before = drifted - h * velocity;
        (stretch - 1.0) * before + (way - h) * velocity
    });
}

/// sinh(y)/y; by its series where y is small.
fn sinhc(y: f64) -> f64 {
    if y.abs() > 0.1 {
        return y.sinh() / y;
    }
    let y2 = y * y;
    1.0 + y2 / 6.0 * (1.0 + y2 / 20.0 * (1.0 + y2 / 42.0 * (1.0 + y2 / 72.0)))
}

persist!(Mtk {
    [expansion, virial] as "box",
    of_particles as "chain_of_particles",
    of_box as "chain_of_box",
    fixed tau, bath
});

impl Method for Mtk {
    fn spec(&self) -> &'static IntegratorSpec {
        &STEP
    }

    fn suits(&self, system: &System, _forces: ForceProperties) -> Result<(), String> {
        if dof_of_centers(system, system.n_dof(STEP.momentum())) <= 0.0 {
            return Err("it has one molecule, whose centre has no degree of freedom".to_owned());
        }
        rigid_bonds_alone(system)
    }

    fn wants(&self) -> Want {
        Want::ENERGY_AND_VIRIAL
    }

    fn start(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        s.forces_at_start()?;
        self.keep_virial(s);
        Ok(())
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let (held, half) = (self.held(s), 0.5 * s.dt());
        let before = self.energy(&held, s.parts().state.cell.volume());
        self.advance_chain_of_box(&held, half);
        self.advance_chain_of_particles(s, &held, half);
        self.kick_box(s, &held, half);
        self.kick_particles(s, &held, half);
        self.drift(s)?;
        s.forces()?;
        self.keep_virial(s);
        self.kick_particles(s, &held, half);
        self.kick_box(s, &held, half);
        self.advance_chain_of_particles(s, &held, half);
        self.advance_chain_of_box(&held, half);
        let after = self.energy(&held, s.parts().state.cell.volume());
        s.add_heat(before - after);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::sinhc;

    #[test]
    fn the_series_meets_the_quotient() {
        for y in [1e-9_f64, 0.05, -0.0999, 0.1001, 0.7] {
            let exact = y.sinh() / y;
            assert!((sinhc(y) - exact).abs() < 1e-14, "{y}");
        }
        assert_eq!(sinhc(0.0), 1.0);
    }
}
