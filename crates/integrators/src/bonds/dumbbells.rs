//! The closed form for dumbbells: kick, drift and correction in one pass, several molecules at a time.

use lennard_core::lanes::{Register, RegisterVector, Simd, WithSimd, in_lanes};
use lennard_core::rigid::{self, InverseMasses};
use lennard_core::{BondSolver, BoundDrift, DVec3, Drifted, Masses, StepError, System};

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
            in_lanes(DriftDumbbells { length: topology.bonds()[0].length, masses, task, outcome });
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

/// Registers side by side: the root and the division of a bond wait for each other.
const SIDE_BY_SIDE: usize = 2;

impl WithSimd for DriftDumbbells<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let task = self.task;
        let mut lanes = DumbbellsInLanes::new(simd, self.length, self.masses, task.h);
        let mut first = 2 * task.first_molecule;
        let size = 2 * Register::<S, SIDE_BY_SIDE>::LANES;
        let moving = (task.positions.chunks_mut(size))
            .zip(task.velocities.chunks_mut(size))
            .zip(task.forces.chunks(size));
        for ((x, v), f) in moving {
            if let Some(kick) = task.kick {
                rigid::kick(self.masses, first, v, f, kick);
            }
            let particle = |lane: usize| first + 2 * lane;
            if x.len() == size {
                lanes.drift(particle, x, v);
            } else {
                let last = x.len() / 2 - 1;
                let (mut all_x, mut all_v) = (rigid::filled(x), rigid::filled(v));
                lanes.drift(|lane| particle(lane.min(last)), &mut all_x, &mut all_v);
                x.copy_from_slice(&all_x[..x.len()]);
                v.copy_from_slice(&all_v[..v.len()]);
            }
            for (lane, why) in lanes.failed.drain(..) {
                // Copies of the last molecule fail with it.
                if 2 * lane < x.len() {
                    self.outcome.failed(first / 2 + lane, why);
                }
            }
            first += x.len();
        }
        self.outcome.solved(Drifted {
            iterations: 1,
            // | |d|/r − 1 | to first order, without a root.
            residual: lanes.worst.largest(),
            ..Drifted::default()
        });
    }
}

/// One dumbbell in each lane.
struct DumbbellsInLanes<'a, S: Simd> {
    simd: S,
    /// r².
    square: Register<S, SIDE_BY_SIDE>,
    /// 1/r².
    inverse_square: Register<S, SIDE_BY_SIDE>,
    inverse_masses: InverseMasses<'a, S, SIDE_BY_SIDE>,
    /// h and 1/h.
    h: [Register<S, SIDE_BY_SIDE>; 2],
    /// The largest ½·| |d|²/r² − 1 | so far.
    worst: Register<S, SIDE_BY_SIDE>,
    /// Lanes of the last drift that have no solution, and why.
    failed: Vec<(usize, NoSolution)>,
}

impl<'a, S: Simd> DumbbellsInLanes<'a, S> {
    #[inline(always)]
    fn new(simd: S, length: f64, masses: &'a Masses, h: f64) -> Self {
        let square = length * length;
        Self {
            simd,
            square: Register::all(simd, square),
            inverse_square: Register::all(simd, 1.0 / square),
            inverse_masses: InverseMasses::new(simd, masses),
            h: [h, 1.0 / h].map(|number| Register::all(simd, number)),
            worst: Register::all(simd, 0.0),
            failed: Vec::new(),
        }
    }

    /// Drifts a dumbbell in each lane; `particle(lane)` is its first site.
    #[inline(always)]
    fn drift(&mut self, particle: impl Fn(usize) -> usize, x: &mut [DVec3], v: &mut [DVec3]) {
        let (simd, [h, rate]) = (self.simd, self.h);
        let [zero, half, one, least] =
            [0.0, 0.5, 1.0, f64::MIN_POSITIVE].map(|number| Register::all(simd, number));
        let x_i = RegisterVector::of_site::<2>(simd, x, 0);
        let x_j = RegisterVector::of_site::<2>(simd, x, 1);
        let v_i = RegisterVector::of_site::<2>(simd, v, 0);
        let v_j = RegisterVector::of_site::<2>(simd, v, 1);
        let d = x_j - x_i;
        let s = d + h * (v_j - v_i);
        let (a, b, c) = (d.dot(d), s.dot(d), s.dot(s) - self.square);
        let root2 = b * b - a * c;
        let i = self.inverse_masses.at(&particle);
        let j = self.inverse_masses.at(|lane| particle(lane) + 1);
        // −η/κ, with one division for each bond: divisions take most of the time here.
        let share = c / ((b + root2.sqrt()) * (i + j));
        let fine = least.choose_up_to(b, one, zero);
        let fine = zero.choose_up_to(root2, fine, zero);
        if (one - fine).largest() > 0.0 {
            self.fail(fine, d, s);
        }
        let moved_i = (i * share) * d;
        let moved_j = (zero - j * share) * d;
        let x_i = x_i + (h * v_i + moved_i);
        let x_j = x_j + (h * v_j + moved_j);
        x_i.to_site::<2>(x, 0);
        x_j.to_site::<2>(x, 1);
        (v_i + rate * moved_i).to_site::<2>(v, 0);
        (v_j + rate * moved_j).to_site::<2>(v, 1);
        let d = x_j - x_i;
        let off = half * (self.inverse_square * d.dot(d) - one).abs();
        self.worst = self.worst.max(off);
    }

    #[cold]
    fn fail(
        &mut self,
        fine: Register<S, SIDE_BY_SIDE>,
        d: RegisterVector<S, SIDE_BY_SIDE>,
        s: RegisterVector<S, SIDE_BY_SIDE>,
    ) {
        let lanes = 0..Register::<S, SIDE_BY_SIDE>::LANES;
        for lane in lanes.filter(|lane| fine.numbers()[*lane] == 0.0) {
            let why = NoSolution::turned(0, d.in_lane(lane), s.in_lane(lane));
            self.failed.push((lane, why));
        }
    }
}
