//! Nosé–Hoover chains: deterministic friction that is itself kept warm by a chain of thermostats.

use lennard_core::random::NoiseStream;
use lennard_core::{BathStep, Integrator, Ramp, Thermostat, ThermostatSpec, persist};

use crate::methods::BathOptions;

lennard_core::options! {
    /// Options of Nosé–Hoover chains.
    ///
    /// The default period is a few vibrations of a liquid. Three thermostats are the fewest with which one oscillator is ergodic.
    pub struct Options {
        /// Period of the thermostats; their masses are Q₁ = n_dof·T·τ² and Q_j = T·τ².
        tau: f64 = 0.5, Between(1e-6, 1e9), in "τ";
        /// Thermostats in the chain; 1 is the plain Nosé–Hoover thermostat, which a stiff system defeats.
        chain: u32 = 3, Whole(1, 10), in "thermostats";
    }
}

impl BathOptions for Options {
    fn couple(&self, method: Integrator, temperature: Ramp, _noise: NoiseStream) -> Integrator {
        method.with_bath(NoseHoover::new(self, temperature))
    }

    /// The kinetic energy swings about its mean with about this period, and the chain damps the swing.
    fn relaxation(&self) -> f64 {
        self.tau
    }
}

/// What Nosé–Hoover chains declare about themselves.
pub const BATH: ThermostatSpec = ThermostatSpec {
    name: "nose-hoover",
    summary: "Nosé–Hoover chains: deterministic friction that a chain of thermostats keeps canonical; no random numbers.",
    canonical: true,
    keeps_motion: true,
    holds_half_steps: false,
    source: "Martyna, Klein and Tuckerman, \"Nosé–Hoover chains: the canonical ensemble via continuous dynamics\", J. Chem. Phys. 97, 2635 (1992), in the splitting of Martyna, Tuckerman, Tobias and Klein, Mol. Phys. 87, 1117 (1996)",
};

/// A Nosé–Hoover chain that acts once after each step, over the whole step.
///
/// The friction is v̇ = −ξ₁·v, with ξ₁ the velocity of the first thermostat of the chain.
/// The heat is the change of K; E minus its sum is conserved, and so is E plus the energy of the chain.
#[derive(Debug, Clone)]
pub struct NoseHoover {
    temperature: Ramp,
    chain: Chain,
}

impl NoseHoover {
    /// A chain at `temperature` (ε/k_B) that is at rest.
    #[must_use]
    pub fn new(options: &Options, temperature: impl Into<Ramp>) -> Self {
        Self { temperature: temperature.into(), chain: Chain::new(options.chain, options.tau) }
    }
}

persist!(NoseHoover { chain, fixed temperature });

impl Thermostat for NoseHoover {
    fn spec(&self) -> &'static ThermostatSpec {
        &BATH
    }

    fn factor(&mut self, at: BathStep) -> f64 {
        let temperature = self.temperature.at(at.step);
        (self.chain).advance(at.kinetic, at.n_dof, temperature, at.dt)
    }

    fn copy(&self) -> Box<dyn Thermostat> {
        Box::new(self.clone())
    }
}

/// w₁ of the Suzuki–Yoshida weights (w₁, w₂, w₁) of order 4, 1/(2 − 2^{1/3}).
const OUTER_WEIGHT: f64 = 1.351_207_191_959_657_8;
const WEIGHTS: [f64; 3] = [OUTER_WEIGHT, 1.0 - 2.0 * OUTER_WEIGHT, OUTER_WEIGHT];

/// A chain of thermostats that acts on a kinetic energy K with f degrees of freedom.
///
/// With ξ_j the velocities of the chain, the friction is v̇ = −ξ₁·v and
/// Q₁·ξ̇₁ = 2K − f·T − Q₁ξ₁ξ₂, Q_j·ξ̇_j = Q_{j−1}ξ_{j−1}² − T − Q_jξ_jξ_{j+1}, η̇_j = ξ_j.
/// The masses are Q₁ = f·T·τ² and Q_j = T·τ² for j ≥ 2.
#[derive(Debug, Clone)]
pub(crate) struct Chain {
    tau: f64,
    /// Velocities ξ_j of the thermostats, 1/τ.
    velocities: Box<[f64]>,
    /// Positions η_j of the thermostats, which the energy alone depends on.
    positions: Box<[f64]>,
}

impl Chain {
    /// A chain of `length` thermostats at rest with the period `tau` (τ).
    pub fn new(length: u32, tau: f64) -> Self {
        let zeros = || vec![0.0; length as usize].into_boxed_slice();
        Self { tau, velocities: zeros(), positions: zeros() }
    }

    /// Advances the chain by `h` τ beside a kinetic energy `kinetic` (ε) of `n_dof` degrees of freedom, at `temperature` (ε/k_B).
    ///
    /// Returns the factor of all velocities.
    pub fn advance(&mut self, kinetic: f64, n_dof: f64, temperature: f64, h: f64) -> f64 {
        let mut factor = 1.0;
        for weight in WEIGHTS {
            let d = weight * h;
            for j in (0..self.velocities.len()).rev() {
                self.kick(j, kinetic * factor * factor, n_dof, temperature, d);
            }
            factor *= (-d * self.velocities[0]).exp();
            for (position, velocity) in self.positions.iter_mut().zip(&self.velocities) {
                *position += d * velocity;
            }
            for j in 0..self.velocities.len() {
                self.kick(j, kinetic * factor * factor, n_dof, temperature, d);
            }
        }
        factor
    }

    /// The energy of the chain in ε: Σ ½Q_jξ_j² + f·T·η₁ + T·Σ_{j≥2} η_j. E plus this energy is conserved.
    pub fn energy(&self, n_dof: f64, temperature: f64) -> f64 {
        let dof = |j: usize| if j == 0 { n_dof } else { 1.0 };
        let pairs = self.velocities.iter().zip(&self.positions).enumerate();
        pairs
            .map(|(j, (velocity, position))| {
                let kinetic = 0.5 * (self.tau * velocity).powi(2);
                dof(j) * temperature * (kinetic + position)
            })
            .sum()
    }

    /// ξ_j ← (ξ_j·e + ½d·G_j)·e with e = exp(−¼d·ξ_{j+1}): half a kick, with the friction of the next thermostat about it.
    fn kick(&mut self, j: usize, kinetic: f64, n_dof: f64, t: f64, d: f64) {
        let mass = t * self.tau * self.tau;
        let acceleration = match j {
            0 => (2.0 * kinetic - n_dof * t) / (n_dof * mass),
            1 => (n_dof * mass * self.velocities[0].powi(2) - t) / mass,
            _ => (mass * self.velocities[j - 1].powi(2) - t) / mass,
        };
        let damping = match self.velocities.get(j + 1) {
            Some(next) => (-0.25 * d * next).exp(),
            None => 1.0,
        };
        let velocity = &mut self.velocities[j];
        *velocity = (*velocity * damping + 0.5 * d * acceleration) * damping;
    }
}

persist!(Chain { velocities, positions, fixed tau });

#[cfg(test)]
mod tests {
    use lennard_core::Persist;

    use super::*;

    /// One oscillator ẍ = −x at T = 1 under a chain: ⟨x²⟩, ⟨p²⟩, ⟨p⁴⟩/3 and the spread of E plus the energy of the chain.
    fn oscillator(length: u32, steps: u64) -> ([f64; 3], f64) {
        let h = 0.02;
        let mut chain = Chain::new(length, 1.0);
        let (mut x, mut p) = (1.2_f64, 0.4_f64);
        let mut moments = [0.0; 3];
        let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
        for _ in 0..steps {
            p -= 0.5 * h * x;
            x += h * p;
            p -= 0.5 * h * x;
            p *= chain.advance(0.5 * p * p, 1.0, 1.0, h);
            for (sum, value) in moments.iter_mut().zip([x * x, p * p, p.powi(4) / 3.0]) {
                *sum += value / steps as f64;
            }
            let conserved = 0.5 * (x * x + p * p) + chain.energy(1.0, 1.0);
            lowest = conserved.min(lowest);
            highest = conserved.max(highest);
        }
        (moments, highest - lowest)
    }

    #[test]
    fn a_chain_of_three_gives_an_oscillator_its_canonical_moments_and_a_single_thermostat_does_not()
    {
        let steps = 1_000_000;
        for length in [3, 5] {
            let (moments, spread) = oscillator(length, steps);
            // 20,000 τ are worth about 5,000 independent samples; the spread of x² is √2 and of p⁴/3 is 3.3.
            for (moment, error) in moments.into_iter().zip([0.02, 0.02, 0.046]) {
                assert!((moment - 1.0).abs() < 4.0 * error, "{length}: {moments:?}");
            }
            // The energy of the splitting is off by h²/8 of the energies that it meets.
            assert!(spread < 0.01, "{length}: {spread}");
        }
        let (single, _) = oscillator(1, steps);
        assert!(single.iter().any(|moment| (moment - 1.0).abs() > 0.15), "{single:?}");
    }

    #[test]
    fn a_restored_chain_goes_on_to_the_bit_and_another_length_is_refused() {
        let mut chain = Chain::new(3, 0.4);
        let run = |chain: &mut Chain| -> Vec<u64> {
            (0..50)
                .map(|i| chain.advance(20.0 + f64::from(i % 7), 33.0, 1.1, 0.01).to_bits())
                .collect()
        };
        run(&mut chain);
        let mut archive = lennard_core::StateArchive::default();
        chain.save(&mut archive.writer());
        let mut restored = Chain::new(3, 0.4);
        restored.restore(&archive.reader()).unwrap();
        let energy = |chain: &Chain| chain.energy(33.0, 1.1).to_bits();
        assert_eq!(energy(&restored), energy(&chain));
        assert_eq!(run(&mut restored), run(&mut chain));
        assert!(Chain::new(4, 0.4).restore(&archive.reader()).is_err());
    }
}
