//! Small systems for the tests: written apart from the library, so that each can judge the other.

use lennard_core::random::Streams;
use lennard_core::{
    Backend, Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceTerm, FusedBath,
    FusedSteps, Masses, Moving, Part, Want,
};
use rand::RngExt;

/// Lennard-Jones particles without any cutoff or box, a double loop, U = Σ 4·(r⁻¹² − r⁻⁶).
///
/// Split for RESPA by the potential's own two terms: near r⁻¹², far −r⁻⁶. Takes up to two steps in one go.
pub struct Cluster;

lennard_core::remembers_nothing!(Cluster);

impl ForceTerm for Cluster {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        let (repulsive, attractive) = match part {
            Part::All => (1.0, 1.0),
            Part::Near => (1.0, 0.0),
            Part::Far => (0.0, 1.0),
        };
        forces.fill(DVec3::ZERO);
        let mut energy = 0.0;
        for i in 0..forces.len() {
            for j in 0..i {
                let r_ij = at.positions[i] - at.positions[j];
                let inv_r2 = r_ij.length_squared().recip();
                let inv_r6 = inv_r2 * inv_r2 * inv_r2;
                let (r12, r6) = (repulsive * inv_r6 * inv_r6, attractive * inv_r6);
                energy += 4.0 * (r12 - r6);
                let f = (24.0 * (2.0 * r12 - r6) * inv_r2) * r_ij;
                forces[i] += f;
                forces[j] -= f;
            }
        }
        if let Some(particle) = forces.iter().position(|f| !f.is_finite()) {
            return Err(ForceError::NonFiniteForce { particle });
        }
        let energy = want.energy.then_some(energy);
        Ok(Energetics {
            potential_energy: energy,
            conserved_potential: energy,
            ..Energetics::default()
        })
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties { splits: true, ..ForceProperties::default() }
    }
}

impl Backend for Cluster {
    fn advance(&mut self, stride: &mut FusedSteps<'_>) -> u64 {
        let steps = stride.steps.min(2);
        let mut forces = vec![DVec3::ZERO; stride.positions.len()];
        for _ in 0..steps {
            let at = Configuration::at_rest(stride.cell, stride.positions);
            self.evaluate(at, Part::All, Want::NOTHING, &mut forces).unwrap();
            let (velocities, h) = (&mut *stride.velocities, stride.dt);
            kick(velocities, &forces, stride.masses, 0.5 * h);
            let scales = stride.bath.as_mut().filter(|bath| bath.scales());
            if let Some(bath) = scales {
                let factor = bath.factor(stride.masses.kinetic_energy(velocities));
                velocities.iter_mut().for_each(|v| *v *= factor);
                kick(velocities, &forces, stride.masses, 0.5 * h);
                drift(stride.positions, velocities, h);
                continue;
            }
            kick(velocities, &forces, stride.masses, 0.5 * h);
            let noise = stride.bath.as_ref().and_then(FusedBath::next_noise);
            drift(stride.positions, velocities, if noise.is_some() { 0.5 * h } else { h });
            let mut gained = 0.0;
            if let Some(noise) = &noise {
                let positions = &mut *stride.positions;
                let moving = Moving { positions, velocities, forces: &forces };
                gained = moving.noise(noise, stride.masses);
                drift(stride.positions, stride.velocities, 0.5 * h);
            }
            if let Some(bath) = &mut stride.bath {
                bath.pass(|| gained);
            }
        }
        steps
    }
}

/// The kick v ← v + (h/m)·F by the textbook.
pub fn kick(velocities: &mut [DVec3], forces: &[DVec3], masses: &Masses, h: f64) {
    for (i, (v, f)) in velocities.iter_mut().zip(forces).enumerate() {
        *v += (h / masses.of(i)) * *f;
    }
}

/// The drift x ← x + h·v by the textbook.
pub fn drift(positions: &mut [DVec3], velocities: &[DVec3], h: f64) {
    for (x, v) in positions.iter_mut().zip(velocities) {
        *x += h * *v;
    }
}

/// `n` points in a cube of the given side, no two closer than `closest`.
pub fn scattered(n: usize, side: f64, closest: f64, seed: u64) -> Vec<DVec3> {
    let mut rng = Streams::new(seed).sequential("scattered");
    let mut points: Vec<DVec3> = Vec::new();
    while points.len() < n {
        let p = side * DVec3::new(rng.random(), rng.random(), rng.random());
        if points.iter().all(|q| (p - *q).length() > closest) {
            points.push(p);
        }
    }
    points
}

/// A compact cluster on a cubic lattice near the pair minimum, with random velocities whose sum is
/// zero; `edge`³ particles.
pub fn cluster(edge: usize, speed: f64, seed: u64) -> (Vec<DVec3>, Vec<DVec3>) {
    let mut rng = Streams::new(seed).sequential("cluster");
    let mut positions = Vec::new();
    for i in 0..edge.pow(3) {
        let cell =
            DVec3::new((i % edge) as f64, (i / edge % edge) as f64, (i / edge / edge) as f64);
        positions.push(1.12 * cell);
    }
    let mut velocities: Vec<DVec3> = positions
        .iter()
        .map(|_| {
            let v = DVec3::new(rng.random(), rng.random(), rng.random());
            speed * (2.0 * v - DVec3::ONE)
        })
        .collect();
    let mean = velocities.iter().sum::<DVec3>() / velocities.len() as f64;
    for v in &mut velocities {
        *v -= mean;
    }
    (positions, velocities)
}
