//! Newton's method for chains, several molecules at a time.
//!
//! In bond vectors, with d_c before the drift, s̃_c = d_c + h·(v_c+1 − v_c) after it, and the multipliers Λ_c:
//!
//! ```text
//! f_c = Λ_c·d_c,   g_k = (f_k−1 − f_k)/m_k,   s_c = s̃_c + g_c+1 − g_c,   x_k ← x_k + h·v_k + g_k,   v_k ← v_k + g_k/h
//! A·δΛ = ½(r² − |s|²),   A_cc = (1/m_c + 1/m_c+1)·s_c·d_c,   A_c,c−1 = −s_c·d_c−1/m_c,   A_c−1,c = −s_c−1·d_c/m_c
//! p_c = 1/(A_cc − A_c,c−1·A_c−1,c·p_c−1),   y_c = ½(r_c² − |s_c|²) − A_c,c−1·p_c−1·y_c−1       forward
//! δΛ_c = p_c·y_c − A_c,c+1·p_c·δΛ_c+1                                                          backward
//! ```
//!
//! Each matrix serves for two iterations, which together are of order three: Shamanskii's method (C. T. Kelley, *Iterative
//! Methods for Linear and Nonlinear Equations*, SIAM 1995, chapter 5). The second iteration costs no division.

use lennard_core::lanes::{Block, Register, RegisterVector, Simd, WithSimd, in_lanes};
use lennard_core::moves;
use lennard_core::rigid::InverseMasses;
use lennard_core::{BondSolver, BoundDrift, DVec3, Drifted, Masses, StepError, System, Topology};

use super::molecule::{NoSolution, Outcome, TaskOf, over_tasks};

/// Newton's method converges in two to four iterations, or not at all.
const MOST_ITERATIONS: u32 = 50;
/// Iterations with one matrix.
const WITH_ONE_MATRIX: u32 = 2;

/// The direct solution for chains, with corrections along the bonds before the drift.
#[derive(Debug, Clone)]
pub struct Chains {
    /// The largest | |d|/r − 1 | that is left.
    pub tolerance: f64,
}

impl BondSolver for Chains {
    fn drift(&mut self, system: &System, moving: BoundDrift<'_>) -> Result<Drifted, StepError> {
        let masses = &system.masses;
        over_tasks(system, moving, |_, topology, task, outcome| {
            in_lanes(DriftChains { tolerance: self.tolerance, topology, masses, task, outcome });
        })
    }
}

/// Kicks, drifts and corrects the chains of a task.
pub(super) struct DriftChains<'a, 'b> {
    /// The largest | |d|/r − 1 | that is left.
    pub tolerance: f64,
    /// One chain.
    pub topology: &'a Topology,
    /// Masses of all particles.
    pub masses: &'a Masses,
    /// The chains.
    pub task: TaskOf<'b>,
    /// What it took.
    pub outcome: &'a mut Outcome,
}

impl WithSimd for DriftChains<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let TaskOf { first_molecule: mut molecule, drift } = self.task;
        let sites = self.topology.sites();
        let inverse_masses = InverseMasses::new(simd, self.masses);
        let mut chains = ChainsInLanes::new(simd, self.topology, self.tolerance);
        let size = Block::size::<S>(sites);
        let moving = (drift.positions.chunks_mut(size))
            .zip(drift.velocities.chunks_mut(size))
            .zip(drift.forces.chunks(size));
        for ((x, v), f) in moving {
            let block = Block::new(x.len(), sites);
            let molecules = x.len() / sites;
            let first = molecule * sites;
            if let Some(kick) = drift.kick {
                moves::kick(self.masses, first, v, f, kick);
            }
            chains.drift(&inverse_masses, &block, first, x, v, drift.h);
            match chains.solve() {
                Ok(iterations) => {
                    let residual = chains.finish(&block, x, v, drift.h);
                    self.outcome.solved(Drifted { iterations, residual, ..Drifted::default() });
                }
                Err(failures) => {
                    // Copies of the last chain fail with it.
                    for (lane, why) in failures.into_iter().filter(|(lane, _)| *lane < molecules) {
                        self.outcome.failed(molecule + lane, why);
                    }
                }
            }
            molecule += molecules;
        }
    }
}

/// What is known of bond c, and of site c + 1 at its end, in each molecule.
#[derive(Clone, Copy)]
struct Row<S: Simd> {
    /// d_c before the drift.
    d: RegisterVector<S>,
    /// s_c at the iterate.
    s: RegisterVector<S>,
    /// −A_c,c−1·p_c−1.
    factor: Register<S>,
    /// −A_c−1,c.
    above: Register<S>,
    /// p_c.
    inverse_pivot: Register<S>,
    /// ½(r² − |s|²), and y_c after the way forward.
    right: Register<S>,
    /// Λ_c.
    multiplier: Register<S>,
    /// 1/m of site c + 1.
    inverse_mass: Register<S>,
    /// r².
    square: Register<S>,
    /// 1/r².
    inverse_square: Register<S>,
}

impl<S: Simd> Row<S> {
    /// Moves the bond vector; returns ½·| |s|²/r² − 1 |.
    #[inline(always)]
    fn moved_by(&mut self, by: RegisterVector<S>, half: Register<S>) -> Register<S> {
        self.s = self.s + by;
        self.right = half * (self.square - self.s.dot(self.s));
        self.inverse_square * self.right.abs()
    }
}

/// One chain in each lane.
struct ChainsInLanes<S: Simd> {
    simd: S,
    tolerance: f64,
    /// What ½·| |d|²/r² − 1 | may be.
    limit: Register<S>,
    /// 1/m of the first site.
    first_mass: Register<S>,
    rows: Vec<Row<S>>,
}

impl<S: Simd> ChainsInLanes<S> {
    #[inline(always)]
    fn new(simd: S, topology: &Topology, tolerance: f64) -> Self {
        let nowhere = RegisterVector::all(simd, DVec3::ZERO);
        let zero = Register::all(simd, 0.0);
        let row = |length: f64| Row {
            d: nowhere,
            s: nowhere,
            factor: zero,
            above: zero,
            inverse_pivot: zero,
            right: zero,
            multiplier: zero,
            inverse_mass: zero,
            square: Register::all(simd, length * length),
            inverse_square: Register::all(simd, 1.0 / (length * length)),
        };
        Self {
            simd,
            tolerance,
            // With |d|/r = 1 − δ it is δ·(1 − δ/2): no bond with δ above the tolerance is within the limit.
            limit: Register::all(simd, tolerance * (1.0 - 0.5 * tolerance)),
            first_mass: zero,
            rows: topology.bonds().iter().map(|bond| row(bond.length)).collect(),
        }
    }

    #[inline(always)]
    fn all(&self, number: f64) -> Register<S> {
        Register::all(self.simd, number)
    }

    /// The bonds before the drift and after it.
    #[inline(always)]
    fn drift(
        &mut self,
        inverse_masses: &InverseMasses<'_, S>,
        block: &Block,
        first: usize,
        x: &[DVec3],
        v: &[DVec3],
        h: f64,
    ) {
        let (simd, h, zero, half) = (self.simd, self.all(h), self.all(0.0), self.all(0.5));
        self.first_mass = inverse_masses.of(block, first, 0);
        let (mut x_k, mut v_k) = (block.gather(simd, x, 0), block.gather(simd, v, 0));
        for (c, row) in self.rows.iter_mut().enumerate() {
            let x_next = block.gather(simd, x, c + 1);
            let v_next = block.gather(simd, v, c + 1);
            row.d = x_next - x_k;
            row.s = row.d + h * (v_next - v_k);
            row.right = half * (row.square - row.s.dot(row.s));
            row.multiplier = zero;
            row.inverse_mass = inverse_masses.of(block, first, c + 1);
            (x_k, v_k) = (x_next, v_next);
        }
    }

    /// Iterates until all chains have their lengths; else the lanes that have no solution, and why.
    #[inline(always)]
    fn solve(&mut self) -> Result<u32, Vec<(usize, NoSolution)>> {
        let (zero, one) = (self.all(0.0), self.all(1.0));
        let mut off = self.all(f64::INFINITY);
        for iteration in 0..MOST_ITERATIONS {
            if iteration % WITH_ONE_MATRIX == 0 {
                let fine = self.factor(off);
                if (one - fine).largest() > 0.0 {
                    return Err(self.turned(fine));
                }
            } else {
                self.forward(off);
            }
            off = self.backward();
            if off.choose_up_to(self.limit, zero, one).largest() == 0.0 {
                return Ok(iteration + 1);
            }
        }
        Err(self.not_converged(off))
    }

    /// Factors the matrix at the iterate and goes forward; returns 0 in lanes that fail by a pivot that is not positive, else 1.
    ///
    /// Chains whose residual `off` is within the limit stay as they are, whatever their neighbors need, and whatever their pivots.
    #[inline(always)]
    fn factor(&mut self, off: Register<S>) -> Register<S> {
        let (zero, one, least) = (self.all(0.0), self.all(1.0), self.all(f64::MIN_POSITIVE));
        let nowhere = RegisterVector::all(self.simd, DVec3::ZERO);
        let (mut d, mut s) = (nowhere, nowhere);
        let (mut inverse_pivot, mut right, mut fine) = (zero, zero, one);
        let mut inverse_mass = self.first_mass;
        for row in &mut self.rows {
            let below = inverse_mass * row.s.dot(d);
            let above = inverse_mass * s.dot(row.d);
            let diagonal = (inverse_mass + row.inverse_mass) * row.s.dot(row.d);
            // In this order the division before is waited for by two operations alone.
            let pivot = diagonal - (below * above) * inverse_pivot;
            let factor = below * inverse_pivot;
            right = off.choose_up_to(self.limit, zero, row.right) + factor * right;
            inverse_pivot = one / pivot;
            fine = least.choose_up_to(pivot, fine, zero);
            (row.factor, row.above, row.inverse_pivot, row.right) =
                (factor, above, inverse_pivot, right);
            (d, s, inverse_mass) = (row.d, row.s, row.inverse_mass);
        }
        off.choose_up_to(self.limit, one, fine)
    }

    /// Goes forward with the factors of the iteration before.
    #[inline(always)]
    fn forward(&mut self, off: Register<S>) {
        let zero = self.all(0.0);
        let mut right = zero;
        for row in &mut self.rows {
            right = off.choose_up_to(self.limit, zero, row.right) + row.factor * right;
            row.right = right;
        }
    }

    /// Goes backward, moves the bonds, and returns the largest ½·| |s|²/r² − 1 |.
    #[inline(always)]
    fn backward(&mut self) -> Register<S> {
        let (zero, half) = (self.all(0.0), self.all(0.5));
        let nowhere = RegisterVector::all(self.simd, DVec3::ZERO);
        let (mut worst, mut sum) = (zero, zero);
        // f_c+1 and g_c+2 of the bond and of the site behind.
        let (mut f, mut g) = (nowhere, nowhere);
        let (mut step, mut above) = (zero, zero);
        for c in (0..self.rows.len()).rev() {
            let row = &mut self.rows[c];
            step = row.right * row.inverse_pivot + (above * row.inverse_pivot) * step;
            above = row.above;
            row.multiplier = row.multiplier + step;
            let own = step * row.d;
            let moved = row.inverse_mass * (own - f);
            if let Some(behind) = self.rows.get_mut(c + 1) {
                let off = behind.moved_by(g - moved, half);
                (worst, sum) = (worst.max(off), sum + off);
            }
            (f, g) = (own, moved);
        }
        if let Some(first) = self.rows.first_mut() {
            let off = first.moved_by(g + self.first_mass * f, half);
            (worst, sum) = (worst.max(off), sum + off);
        }
        // A largest number may pass over what is no number; a sum does not.
        worst + zero * sum
    }

    /// Moves the sites, and returns the largest ½·| |d|²/r² − 1 | where they are.
    #[inline(always)]
    fn finish(&self, block: &Block, x: &mut [DVec3], v: &mut [DVec3], h: f64) -> f64 {
        let (simd, zero, half, one) = (self.simd, self.all(0.0), self.all(0.5), self.all(1.0));
        let (rate, h) = (self.all(1.0 / h), self.all(h));
        let nowhere = RegisterVector::all(simd, DVec3::ZERO);
        let (mut f, mut x_before) = (nowhere, nowhere);
        let (mut inverse_mass, mut inverse_square) = (self.first_mass, zero);
        let mut worst = zero;
        for k in 0..=self.rows.len() {
            let row = self.rows.get(k);
            let own = match row {
                Some(row) => row.multiplier * row.d,
                None => nowhere,
            };
            let moved = inverse_mass * (f - own);
            let v_k = block.gather(simd, v, k);
            let x_k = block.gather(simd, x, k) + (h * v_k + moved);
            block.scatter(x_k, x, k);
            block.scatter(v_k + rate * moved, v, k);
            if k > 0 {
                let d = x_k - x_before;
                worst = worst.max(half * (inverse_square * d.dot(d) - one).abs());
            }
            if let Some(row) = row {
                (inverse_mass, inverse_square) = (row.inverse_mass, row.inverse_square);
            }
            (f, x_before) = (own, x_k);
        }
        worst.largest()
    }

    /// For each lane with a pivot that is not positive: the bond, and its part across its old direction.
    #[cold]
    fn turned(&self, fine: Register<S>) -> Vec<(usize, NoSolution)> {
        let lanes = (0..Register::<S>::LANES).filter(|lane| fine.numbers()[*lane] == 0.0);
        lanes
            .map(|lane| {
                let is_fine = |row: &Row<S>| 1.0 / row.inverse_pivot.numbers()[lane] > 0.0;
                let c = self.rows.iter().position(|row| !is_fine(row)).unwrap_or(0);
                let [d, s] = [self.rows[c].d, self.rows[c].s].map(|all| all.in_lane(lane));
                (lane, NoSolution::turned(c, d, s))
            })
            .collect()
    }

    /// The lanes whose residual is above the limit.
    #[cold]
    fn not_converged(&self, off: Register<S>) -> Vec<(usize, NoSolution)> {
        let found = off.numbers().into_iter().take(Register::<S>::LANES).enumerate();
        let limit = self.limit.numbers()[0];
        found
            .filter(|(_, off)| off.is_nan() || *off > limit)
            .map(|(lane, off)| {
                (lane, NoSolution::NotConverged(MOST_ITERATIONS, off, self.tolerance))
            })
            .collect()
    }
}
