//! Molecules in registers have the bits of molecules one by one, which is the form that runs where there is no AVX2.

use lennard_core::lanes::{Scalar, WithSimd, in_lanes};
use lennard_core::{Bonds, BoundDrift, DVec3, Masses, Molecules};

use super::chains::DriftChains;
use super::molecule::{Outcome, TaskOf};

const LENGTH: f64 = 0.8;

/// A vector for each number, without order.
fn scattered(k: usize) -> DVec3 {
    let at = 2.3 * k as f64;
    DVec3::new(at.sin(), (0.7 * at).cos(), (1.9 * at + 0.2).sin())
}

#[test]
fn molecules_have_the_same_bits_in_registers_and_one_by_one() {
    // The last register is not full, and neighbors need different numbers of iterations.
    for (sites, n) in [(2, 1), (2, 7), (3, 6), (10, 13)] {
        let molecules = Molecules::chains(sites, LENGTH, Bonds::Rigid);
        let topology = molecules.topology().unwrap();
        let mut x = Vec::new();
        for m in 0..n {
            let mut at = 9.0 * scattered(m);
            for k in 0..sites {
                x.push(at);
                at += LENGTH * (DVec3::X + 0.6 * scattered(50 + m * sites + k)).normalize();
            }
        }
        let speed = |i: usize| 3.0 * (i / sites) as f64 / n as f64;
        let v: Vec<DVec3> = (0..x.len()).map(|i| speed(i) * scattered(i + 7)).collect();
        let f: Vec<DVec3> = (0..x.len()).map(|i| 9.0 * scattered(i + 3)).collect();
        let each = (0..x.len()).map(|i| 1.0 + 0.1 * i as f64).collect();
        for masses in [Masses::Uniform(1.3), Masses::Each(each)] {
            let drifted = |one_by_one: bool| {
                let (mut x, mut v) = (x.clone(), v.clone());
                let mut outcome = Outcome::default();
                let drift = BoundDrift {
                    positions: &mut x,
                    velocities: &mut v,
                    forces: &f,
                    kick: Some(0.005),
                    h: 0.01,
                };
                let task = TaskOf { first_molecule: 0, drift };
                let drift = DriftChains {
                    tolerance: 1e-12,
                    topology,
                    masses: &masses,
                    task,
                    outcome: &mut outcome,
                };
                match one_by_one {
                    true => drift.with_simd(Scalar),
                    false => in_lanes(drift),
                }
                let bits = |of: &[DVec3]| -> Vec<[u64; 3]> {
                    of.iter().map(|v| v.to_array().map(f64::to_bits)).collect()
                };
                (bits(&x), bits(&v), outcome.finish(topology).unwrap())
            };
            assert!(drifted(false) == drifted(true), "{n} of {sites} sites");
        }
    }
}
