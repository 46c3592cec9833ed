//! Fused steps under a bath, or with friction and noise, have the bits of single steps.

use crate::common::*;
use lennard_core::random::Streams;
use lennard_core::{
    Backend, BathStep, DVec3, ForceTerm, FrictionAndNoise, FusedBath, FusedSteps, Masses, Moving,
    Part, PeriodicBox, Thermostat, Want,
};
use lennard_forcefield::{ForceFieldOptions, PairForces, TruncationKind, TruncationOptions};

const MASS: f64 = 1.5;

#[derive(Clone, PartialEq, Debug)]
struct Fluid {
    cell: PeriodicBox,
    positions: Vec<DVec3>,
    velocities: Vec<DVec3>,
    step: u64,
    bath: Option<Sensitive>,
    heats: Vec<f64>,
}

impl Fluid {
    fn step(&mut self, forces: &mut PairForces, noise: Option<FrictionAndNoise>) {
        let masses = Masses::Uniform(MASS);
        let found = evaluate(forces, self.cell, &self.positions, Part::All, Want::NOTHING);
        let (f, _) = found.unwrap();
        let v = &mut self.velocities;
        kick(v, &f, &masses, 0.5 * DT);
        if let Some(bath) = &mut self.bath
            && bath.acts_after(self.step)
        {
            let kinetic = masses.kinetic_energy(v);
            let factor = bath.factor(BathStep { kinetic, n_dof: 12.0, dt: DT, step: self.step });
            v.iter_mut().for_each(|v| *v *= factor);
            self.heats.push(factor * factor * kinetic - kinetic);
        }
        kick(v, &f, &masses, 0.5 * DT);
        if let Some(noise) = noise {
            drift(&mut self.positions, v, 0.5 * DT);
            let of_step = noise.in_step(self.step, DT);
            let (positions, velocities) = (&mut self.positions[..], &mut self.velocities[..]);
            let moving = Moving { positions, velocities, forces: &f };
            self.heats.push(moving.noise(&of_step, &masses));
            drift(&mut self.positions, &self.velocities, 0.5 * DT);
        } else {
            drift(&mut self.positions, v, DT);
        }
        self.step += 1;
    }

    fn stride(
        &mut self,
        forces: &mut PairForces,
        noise: Option<FrictionAndNoise>,
        steps: u64,
    ) -> u64 {
        let n = self.positions.len();
        let bath = match noise {
            Some(noise) => Some(FusedBath::noise(noise, DT, self.step)),
            None => self.bath.as_mut().map(|bath| FusedBath::scaling(bath, 12.0, DT, self.step)),
        };
        let mut steps = FusedSteps {
            cell: &self.cell,
            positions: &mut self.positions,
            velocities: &mut self.velocities,
            forces: &mut vec![DVec3::NAN; n],
            masses: &Masses::Uniform(MASS),
            dt: DT,
            steps,
            bath,
        };
        let taken = forces.advance(&mut steps);
        if let Some(bath) = steps.bath {
            self.heats.extend(bath.into_heats());
        }
        self.step += taken;
        taken
    }
}

#[test]
fn strides_under_baths_and_noise_have_the_bits_of_single_steps() {
    let noise = FrictionAndNoise {
        friction: 2.0,
        temperature: 1.3.into(),
        noise: Streams::new(9).noise("langevin"),
    };
    let bath = |every| Some(Sensitive { every, acted: 0 });
    // Each thread packs the rows of the first fluid, and all threads pack the rows of the second fluid.
    for k in [[7, 8, 9], [13, 14, 13]] {
        let (cell, positions) = liquid(k, 0.8, 0.1);
        let n = positions.len();
        let velocities = scatter(n, DVec3::splat(4.0), 0.7);
        let start = Fluid {
            cell,
            positions,
            velocities: velocities.iter().map(|v| *v - DVec3::splat(2.0)).collect(),
            step: 100,
            bath: None,
            heats: Vec::new(),
        };
        for kernel in kernels() {
            let options = ForceFieldOptions {
                kernel,
                truncation: TruncationOptions::new(TruncationKind::Shift, 2.3),
                neighbor: verlet(Some(0.15)),
                ..ForceFieldOptions::default()
            };
            let fresh = || built(&options, None, cell, n);
            for (bath, noise) in [(bath(1), None), (bath(3), None), (None, Some(noise))] {
                let start = Fluid { bath, ..start.clone() };
                let (mut one, mut forces) = (start.clone(), fresh());
                for _ in 0..40 {
                    one.step(&mut forces, noise);
                }
                let builds = forces.statistics().builds;
                assert!((2..40).contains(&builds) && one.heats.len() > 12, "{builds}");
                for (threads, lengths) in [(1, [40, 0]), (2, [39, 1]), (3, [7, 9])] {
                    let (mut all, mut forces) = (start.clone(), fresh());
                    in_threads(threads, || {
                        let mut left = 40;
                        for length in lengths.into_iter().cycle() {
                            left -= all.stride(&mut forces, noise, length.min(left));
                            if left == 0 {
                                break;
                            }
                            all.step(&mut forces, noise);
                            left -= 1;
                        }
                    });
                    let what = format!("{kernel:?}, {threads} threads, {lengths:?}");
                    assert!(all == one, "{what}");
                    assert_eq!(forces.statistics().builds, builds, "{what}");
                }
            }
        }
    }
}

#[test]
fn a_stride_that_fails_under_a_bath_changes_no_particle() {
    let (cell, positions) = liquid([8, 8, 8], 0.8, 0.1);
    let n = positions.len();
    let mut velocities = vec![DVec3::X; n];
    velocities[77].y = f64::INFINITY;
    let start = Fluid {
        cell,
        positions,
        velocities,
        step: 1,
        bath: Some(Sensitive { every: 1, acted: 0 }),
        heats: Vec::new(),
    };
    for kernel in kernels() {
        let options = ForceFieldOptions { kernel, ..ForceFieldOptions::default() };
        let (mut fluid, mut forces) = (start.clone(), built(&options, None, cell, n));
        let taken = fluid.stride(&mut forces, None, 9);
        assert_eq!(taken, 0);
        assert_eq!(fluid.positions, start.positions);
        assert_eq!(fluid.velocities, start.velocities);
        assert!(fluid.bath != start.bath, "the caller gives the bath its memory back");
        // The kinetic energy of the next stride has nothing of the last one.
        let [mut other, mut alone] = [start.clone(), start.clone()].map(|mut fluid| {
            fluid.velocities[77] = DVec3::X;
            fluid
        });
        assert_eq!(other.stride(&mut forces, None, 9), 9);
        alone.stride(&mut built(&options, None, cell, n), None, 9);
        assert!(other == alone, "{kernel:?}");
    }
}
