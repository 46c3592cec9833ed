//! The closed form for dumbbells: kick, drift and correction in one pass, several molecules at a time.

use lennard_core::lanes::{Block, Register, Simd, WithSimd, in_lanes};
use lennard_core::rigid::{self, InverseMasses};
use lennard_core::{BondSolver, BoundDrift, Drifted, Masses, StepError, System};

use super::molecule::{NoSolution, Outcome, TaskOf, over_tasks};

/// The closed form for one bond, with corrections along the bond before the drift.
///
/// With d before and s after the drift, and a = |d|², b = s·d, c = |s|² − r², the sites move by η = −c/(b + √(b² − a·c)) along d.
/// The sum in the denominator has no cancellation.
#[derive(Debug, Clone)]
pub struct Dumbbells;

impl BondSolver for Dumbbells {
    fn drift(&mut self, system: &System, moving: BoundDrift<'_>) -> Result<Drifted, StepError> {
        let masses = &system.masses;
        over_tasks(system, moving, |_, topology, task, outcome| {
            in_lanes(DriftDumbbells {
                length: topology.bonds()[0].length,
                masses,
                task,
                outcome,
            });
        })
    }
}

/// Kicks, drifts and corrects the dumbbells of a task.
pub(super) struct DriftDumbbells<'a, 'b> {
    /// The length of the bond, σ.
    pub length: f64,
    /// Masses of all particles.
    pub masses: &'a Masses,
    /// The dumbbells.
    pub task: TaskOf<'b>,
    /// What it took.
    pub outcome: &'a mut Outcome,
}

impl WithSimd for DriftDumbbells<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let task = self.task;
        let inverse_masses = InverseMasses::new(simd, self.masses);
        let square = self.length * self.length;
        let [zero, half, one] = [0.0, 0.5, 1.0].map(|number| Register::all(simd, number));
        let [square, inverse_square] =
            [square, 1.0 / square].map(|number| Register::all(simd, number));
        let [h, rate] = [task.h, 1.0 / task.h].map(|number| Register::all(simd, number));
        let least = Register::all(simd, f64::MIN_POSITIVE);
        let mut worst = zero;
        let mut molecule = task.first_molecule;
        let size = Block::size::<S>(2);
        let moving = (task.positions.chunks_mut(size))
            .zip(task.velocities.chunks_mut(size))
            .zip(task.forces.chunks(size));
        for ((x, v), f) in moving {
            let block = Block::new(x.len(), 2);
            let molecules = x.len() / 2;
            let first = 2 * molecule;
            if let Some(kick) = task.kick {
                rigid::kick(self.masses, first, v, f, kick);
            }
            let [x_i, x_j] = [block.gather(simd, x, 0), block.gather(simd, x, 1)];
            let [v_i, v_j] = [block.gather(simd, v, 0), block.gather(simd, v, 1)];
            let d = x_j - x_i;
            let s = d + h * (v_j - v_i);
            let (a, b, c) = (d.dot(d), s.dot(d), s.dot(s) - square);
            let root2 = b * b - a * c;
            let i = inverse_masses.of(&block, first, 0);
            let j = inverse_masses.of(&block, first, 1);
            // −η/κ, with one division for each bond: divisions take most of the time here.
            let share = c / ((b + root2.sqrt()) * (i + j));
            let fine = least.choose_up_to(b, one, zero);
            let fine = zero.choose_up_to(root2, fine, zero);
            if (one - fine).largest() > 0.0 {
                for lane in (0..molecules).filter(|lane| fine.numbers()[*lane] == 0.0) {
                    let why = NoSolution::turned(0, d.in_lane(lane), s.in_lane(lane));
                    self.outcome.failed(molecule + lane, why);
                }
            }
            let moved_i = (i * share) * d;
            let moved_j = (zero - j * share) * d;
            let x_i = x_i + (h * v_i + moved_i);
            let x_j = x_j + (h * v_j + moved_j);
            block.scatter(x_i, x, 0);
            block.scatter(x_j, x, 1);
            block.scatter(v_i + rate * moved_i, v, 0);
            block.scatter(v_j + rate * moved_j, v, 1);
            let d = x_j - x_i;
            worst = worst.max(half * (inverse_square * d.dot(d) - one).abs());
            molecule += molecules;
        }
        self.outcome.solved(Drifted {
            iterations: 1,
            // | |d|/r − 1 | to first order, without a root.
            residual: worst.largest(),
            ..Drifted::default()
        });
    }
}
