//! The closed form for dumbbells: kick, drift and correction in one pass, four molecules at a time.

use lennard_core::{BondSolver, BoundDrift, DVec3, Drifted, Masses, StepError, System, rigid};

use super::molecule::{NoSolution, Outcome, over_tasks};

/// The closed form for one bond, with corrections along the bond before the drift.
///
/// With d before and s after the drift, and a = |d|², b = s·d, c = |s|² − r², the sites move by η = −c/(b + √(b² − a·c)) along d.
/// The sum in the denominator has no cancellation.
#[derive(Debug, Clone)]
pub struct Dumbbells;

/// Molecules that are worked on at once: their numbers lie side by side, so that the compiler takes several per instruction.
const LANES: usize = 4;

/// One number of each of some molecules.
type Lane = [f64; LANES];

/// A vector of each of some molecules, by components.
type Vectors = [Lane; 3];

#[inline(always)]
fn lane(of: impl Fn(usize) -> f64) -> Lane {
    std::array::from_fn(of)
}

#[inline(always)]
fn dot(a: &Vectors, b: &Vectors) -> Lane {
    lane(|l| a[0][l] * b[0][l] + a[1][l] * b[1][l] + a[2][l] * b[2][l])
}

/// d = x_j − x_i of each molecule.
#[inline(always)]
fn bonds(x: &[DVec3]) -> Vectors {
    std::array::from_fn(|axis| lane(|l| x[2 * l + 1][axis] - x[2 * l][axis]))
}

impl BondSolver for Dumbbells {
    fn drift(&mut self, system: &System, moving: BoundDrift<'_>) -> Result<Drifted, StepError> {
        let masses = &system.masses;
        over_tasks(system, moving, |_, topology, task, outcome| {
            let length = topology.bonds()[0].length;
            let blocks = task
                .positions
                .chunks_mut(2 * LANES)
                .zip(task.velocities.chunks_mut(2 * LANES))
                .zip(task.forces.chunks(2 * LANES));
            for (block, ((x, v), f)) in blocks.enumerate() {
                let molecule = task.first_molecule + block * LANES;
                if let Some(kick) = task.kick {
                    rigid::kick(masses, 2 * molecule, v, f, kick);
                }
                if x.len() == 2 * LANES {
                    drift_block(masses, molecule, length, x, v, task.h, outcome);
                    continue;
                }
                // The last block is filled up with copies of its first molecule.
                let fill = |from: &[DVec3]| -> [DVec3; 2 * LANES] {
                    std::array::from_fn(|k| from[if k < from.len() { k } else { k % 2 }])
                };
                let (mut xs, mut vs) = (fill(x), fill(v));
                drift_block(masses, molecule, length, &mut xs, &mut vs, task.h, outcome);
                x.copy_from_slice(&xs[..x.len()]);
                v.copy_from_slice(&vs[..v.len()]);
            }
        })
    }
}

/// 1/m of the first and of the second site of each molecule; molecules beyond the last have the masses of the first.
#[inline(always)]
fn inverse_masses(masses: &Masses, molecule: usize) -> [Lane; 2] {
    match masses {
        Masses::Uniform(m) => [[1.0 / m; LANES]; 2],
        Masses::Each(m) => [0, 1].map(|site| {
            lane(|l| {
                1.0 / m
                    .get(2 * (molecule + l) + site)
                    .unwrap_or(&m[2 * molecule + site])
            })
        }),
    }
}

/// Drifts and corrects some molecules.
#[inline(always)]
fn drift_block(
    masses: &Masses,
    molecule: usize,
    length: f64,
    x: &mut [DVec3],
    v: &mut [DVec3],
    h: f64,
    outcome: &mut Outcome,
) {
    let d = bonds(x);
    for (x, v) in x.iter_mut().zip(v.iter()) {
        *x += h * *v;
    }
    let s = bonds(x);
    let (a, b) = (dot(&d, &d), dot(&s, &d));
    let squares = dot(&s, &s);
    let c = lane(|l| squares[l] - length * length);
    let root2 = lane(|l| b[l] * b[l] - a[l] * c[l]);
    let [i, j] = inverse_masses(masses, molecule);
    // η/κ, with one division for each bond: divisions take most of the time here.
    let share = lane(|l| -c[l] / ((b[l] + root2[l].sqrt()) * (i[l] + j[l])));
    let rate = h.recip();
    let (first, second) = (lane(|l| -(share[l] * i[l])), lane(|l| share[l] * j[l]));
    for l in 0..LANES {
        let along = DVec3::new(d[0][l], d[1][l], d[2][l]);
        let moved = [first[l] * along, second[l] * along];
        for site in 0..2 {
            x[2 * l + site] += moved[site];
            v[2 * l + site] += rate * moved[site];
        }
    }
    let held = bonds(x);
    let held = dot(&held, &held);
    // | |d|/r − 1 | to first order, without a root.
    let inverse_square = (length * length).recip();
    let off = lane(|l| 0.5 * (held[l] * inverse_square - 1.0).abs());
    for l in 0..LANES {
        // Negated, so that numbers that are not finite fail too.
        if b[l] > 0.0 && root2[l] >= 0.0 {
            outcome.solved(Drifted {
                iterations: 1,
                residual: off[l],
                ..Drifted::default()
            });
        } else {
            let along = (1.0 / a[l]) * b[l];
            let across: f64 = (0..3)
                .map(|axis| (s[axis][l] - along * d[axis][l]).powi(2))
                .sum();
            outcome.failed(molecule + l, NoSolution::Turned(0, across.sqrt()));
        }
    }
}
