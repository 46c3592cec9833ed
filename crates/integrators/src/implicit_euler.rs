//! Implicit Euler: the force at the end of the step, found by solving for where the step ends.

use glam::DMat2;
use lennard_core::exact::exact_sum;
use lennard_core::parallel::{for_each_piece, for_each_piece_pair};
use lennard_core::{
    Backend, Configuration, DVec3, Energetics, ForceError, Integrator, IntegratorSpec, Masses,
    Method, Moving, Own, Part, Parts, PeriodicBox, State, Step, StepError, Want, check_finite,
    remembers_nothing,
};

use crate::methods::MethodOptions;
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of implicit Euler. The defaults lie far below what a step of first order leaves, and within reach of double precision.
    pub struct Options {
        /// Largest error of a position in its equation.
        tolerance: f64 = 1e-12, Between(1e-15, 1e-3), in "σ";
        /// Newton iterations after which a step fails.
        max_iterations: u32 = 60, Whole(1, 1_000_000);
    }
}

/// What implicit Euler declares about itself.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "implicit-euler",
    summary: "Implicit Euler, solved by Newton's method with conjugate gradients; stable at any step and damps every motion.",
    equations: "v(t+h) = v(t) + h a(x(t+h)); x(t+h) = x(t) + h v(t+h)",
    position_order: 1,
    velocity_order: 1,
    symplectic: false,
    reversible: false,
    half_kicks: false,
    force_evaluations: 0,
    stability_limit: None,
    oscillator_map: Some(oscillator_map),
    source: "Hairer, Lubich and Wanner, \"Geometric Numerical Integration\", 2nd ed., Springer (2006), section I.1.2, eq. 1.6; line-search Newton-CG: Nocedal and Wright, \"Numerical Optimization\", 2nd ed., Springer (2006), algorithm 7.1",
    on_ranks: false,
    ..VERLET
};

/// One step on ẍ = −ω²x as a matrix on (x, v): the inverse of [[1, −h], [ω²h, 1]]. Both eigenvalues
/// have the modulus 1/√(1 + ω²h²) < 1.
#[must_use]
pub fn oscillator_map(omega: f64, dt: f64) -> DMat2 {
    let weight = 1.0 / (1.0 + (omega * dt).powi(2));
    DMat2::from_cols_array_2d(&[[1.0, -omega * omega * dt], [dt, 1.0]]) * weight
}

/// Implicit Euler.
///
/// With x̂ = x + h·v the end y of a step solves M·(y − x̂)/h² = F(y). That is where the gradient of
/// Φ(y) = ½(y − x̂)ᵀM(y − x̂)/h² + U(y) vanishes, so each step is a minimisation with a line search
/// on Φ. Newton's directions come from conjugate gradients on M/h² + ∂²U/∂x². They stop at a
/// direction of negative curvature, which a fluid has, and which shows at large h. Where the force is
/// linear, one direction, solved to rounding, is the answer, and further directions only polish it.
///
/// [`lennard_core::StepReport::force_evaluations`] counts evaluations and [`lennard_core::StepReport::iterations`] products of the
/// Hessian with a vector, each worth two evaluations more unless the forces know their Hessian;
/// [`lennard_core::StepReport::residual`] is max |y − x̂ − h²·a(y)| in σ.
#[derive(Debug, Clone)]
pub struct ImplicitEuler {
    options: Options,
}

impl ImplicitEuler {
    /// With the given options.
    #[must_use]
    pub fn new(options: &Options) -> Self {
        Self { options: options.clone() }
    }
}

impl MethodOptions for Options {
    fn build(&self) -> Integrator {
        Integrator::new(ImplicitEuler::new(self))
    }
}

remembers_nothing!(ImplicitEuler { options });

/// A trial end of the step with everything known there.
struct Trial {
    positions: Vec<DVec3>,
    forces: Vec<DVec3>,
    /// −∇Φ = F − M·(y − x̂)/h², ε/σ.
    downhill: Vec<DVec3>,
    /// Φ in ε, where the forces have an energy.
    merit: Option<f64>,
    /// max |y − x̂ − h²·a(y)|, σ.
    residual: f64,
    /// What rounding leaves of that residual, σ.
    floor: f64,
}

/// Rounding of the few operations behind the residual, each relative to the largest term.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The equations of one step.
struct Equations<'a> {
    masses: &'a Masses,
    cell: PeriodicBox,
    /// x̂ = x + h·v, σ.
    inertial: Vec<DVec3>,
    dt: f64,
    end_time: f64,
}

impl Equations<'_> {
    /// M/h² of particle `i`.
    fn inertia(&self, i: usize) -> f64 {
        self.masses.of(i) / (self.dt * self.dt)
    }

    fn at<'a>(&'a self, positions: &'a [DVec3]) -> Configuration<'a> {
        Configuration { cell: &self.cell, positions, velocities: None, time: self.end_time }
    }

    fn trial(&self, positions: Vec<DVec3>, forces: &mut dyn Backend) -> Result<Trial, ForceError> {
        let mut f = vec![DVec3::ZERO; positions.len()];
        let found = forces.evaluate(self.at(&positions), Part::All, Want::ENERGY, &mut f)?;
        check_finite(&Own::all_of(f.len()), &f)?;
        Ok(self.judge(positions, f, found.conserved_potential))
    }

    fn judge(&self, positions: Vec<DVec3>, forces: Vec<DVec3>, potential: Option<f64>) -> Trial {
        let n = positions.len();
        let downhill: Vec<DVec3> = (0..n)
            .map(|i| forces[i] - self.inertia(i) * (positions[i] - self.inertial[i]))
            .collect();
        let kinetic: f64 = exact_sum(n, |i| {
            0.5 * self.inertia(i) * (positions[i] - self.inertial[i]).length_squared()
        });
        let (mut residual, mut largest) = (0.0_f64, 0.0_f64);
        for i in 0..n {
            let inverse = self.inertia(i).recip();
            residual = residual.max(inverse * downhill[i].abs().max_element());
            largest = largest
                .max(positions[i].abs().max_element())
                .max(self.inertial[i].abs().max_element())
                .max(inverse * forces[i].abs().max_element());
        }
        Trial {
            positions,
            forces,
            downhill,
            merit: potential.map(|u| kinetic + u),
            residual,
            floor: ROUNDING * largest + f64::MIN_POSITIVE,
        }
    }

    /// The first guess: the step taken with the old force, or no move at all, whichever fits better.
    ///
    /// Without a move the residual follows from the old force, without an evaluation. A guess that
    /// fits worse (or overlaps) would begin the search in another valley.
    fn first_guess(
        &self,
        state: &State,
        forces: &mut dyn Backend,
    ) -> Result<(Trial, u32), StepError> {
        let at_rest = self.judge(state.positions.clone(), state.forces.clone(), None);
        let guess = (0..state.len())
            .map(|i| self.inertial[i] + state.forces[i] / self.inertia(i))
            .collect();
        match self.trial(guess, forces) {
            Ok(trial) if trial.residual <= at_rest.residual => Ok((trial, 1)),
            _ => Ok((self.trial(at_rest.positions, forces)?, 2)),
        }
    }
}

/// Sufficient decrease of Φ along a direction (Nocedal and Wright, section 3.1).
const ARMIJO: f64 = 1e-4;
/// Halvings of a step along a direction before it is given up.
const HALVINGS: u32 = 40;
/// Φ is a sum: where a change is below this share of it, rounding hides it and the residual decides.
const MERIT_ROUNDING: f64 = 1e-12;
/// Products for one direction: far more than a Hessian that the inertia dominates ever needs.
const MOST_PRODUCTS: u32 = 2000;

impl ImplicitEuler {
    /// Finds the end of the step; returns it with the number of evaluations and products.
    fn solve(
        &self,
        equations: &Equations<'_>,
        state: &State,
        forces: &mut dyn Backend,
    ) -> Result<(Trial, u32, u32), StepError> {
        let linear = forces.properties().linear;
        let (mut current, mut evaluations) = equations.first_guess(state, forces)?;
        let mut products = 0;
        let mut direction = Vec::new();
        for iteration in 0..=self.options.max_iterations {
            // A linear system is solved to the floor; so is any where the tolerance lies below it.
            let wanted =
                if linear { current.floor } else { self.options.tolerance.max(current.floor) };
            if current.residual <= wanted {
                return Ok((current, evaluations, products));
            }
            let failed = |residual| StepError::NotConverged {
                method: SPEC.name,
                iterations: iteration,
                residual,
                wanted,
            };
            if iteration == self.options.max_iterations {
                return Err(failed(current.residual));
            }
            // Solve the more exactly the closer the end is: convergence faster than linear.
            let reduction =
                if linear { f64::EPSILON } else { current.residual.sqrt().clamp(1e-4, 0.1) };
            let at = equations.at(&current.positions);
            products += conjugate_gradients(
                |d, out| {
                    forces.hessian_vector(at, d, out)?;
                    for (i, (o, d)) in out.iter_mut().zip(d).enumerate() {
                        *o += equations.inertia(i) * *d;
                    }
                    Ok(())
                },
                |i| equations.inertia(i).recip(),
                &current.downhill,
                &mut direction,
                reduction,
                MOST_PRODUCTS,
            )?;
            match line_search(equations, &current, &direction, forces) {
                Ok((next, tried)) => {
                    current = next;
                    evaluations += tried;
                }
                Err(Some(error)) => return Err(error.into()),
                Err(None) => return Err(failed(current.residual)),
            }
        }
        unreachable!("the last iteration returns")
    }
}

/// The first of the steps 1, ½, ¼, … along `direction` that is good enough, and how many were tried.
///
/// Where forces fail (an overlap) the step was too long. Fails with the forces' own error where they
/// failed for every length, and with none where no length was good enough.
fn line_search(
    equations: &Equations<'_>,
    current: &Trial,
    direction: &[DVec3],
    forces: &mut dyn Backend,
) -> Result<(Trial, u32), Option<ForceError>> {
    let descent = dot(&current.downhill, direction);
    let mut length = 1.0;
    let (mut last_error, mut evaluated) = (None, false);
    for tried in 1..=HALVINGS {
        let positions =
            current.positions.iter().zip(direction).map(|(y, d)| *y + length * *d).collect();
        match equations.trial(positions, forces) {
            Ok(trial) if is_better(&trial, current, length * descent) => {
                return Ok((trial, tried));
            }
            Ok(_) => evaluated = true,
            Err(error) => last_error = Some(error),
        }
        length *= 0.5;
    }
    Err(if evaluated { None } else { last_error })
}

fn is_better(trial: &Trial, current: &Trial, descent: f64) -> bool {
    if trial.residual <= current.floor {
        return true;
    }
    let closer = trial.residual < current.residual;
    match (trial.merit, current.merit) {
        (Some(new), Some(old)) => {
            let hidden = MERIT_ROUNDING * old.abs().max(new.abs());
            new <= old - ARMIJO * descent || ((new - old).abs() <= hidden && closer)
        }
        _ => closer,
    }
}

impl Method for ImplicitEuler {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let (masses, dt) = (&s.system().masses, s.dt());
        let Parts { state, backend, .. } = s.parts();
        let mut inertial = state.positions.clone();
        Moving { positions: &mut inertial, ..Moving::of(state) }.drift(dt);
        let equations =
            Equations { masses, cell: state.cell, inertial, dt, end_time: state.time + dt };
        let (end, evaluations, products) = self.solve(&equations, state, backend)?;
        state.positions = end.positions;
        state.forces = end.forces;
        state.energetics = Energetics::default();
        s.solved(products, end.residual);
        s.count_evaluations(evaluations);
        // The solve ended with the forces of these positions. Whatever else is wanted comes with the same forces once more.
        if s.want().is_nothing() {
            s.arrive();
        } else {
            s.forces()?;
        }
        s.kick(1.0);
        Ok(())
    }
}

/// Solves A·p = b for a symmetric A by preconditioned conjugate gradients, started from p = 0; returns the number of products with A.
///
/// `inverse_diagonal` is the inverse of a positive diagonal preconditioner, one number a particle. It
/// ends when the residual, in the norm of the preconditioner, has fallen by `reduction`, or when `most`
/// products are spent. It also ends at a direction d with dᵀA·d ≤ 0. Then p is kept as it is, or, if it
/// is still zero, becomes the preconditioned b. In every case bᵀp > 0 (Steihaug, "The conjugate
/// gradient method and trust regions in large scale optimization", SIAM J. Numer. Anal. 20, 626, 1983).
fn conjugate_gradients<A>(
    mut apply: A,
    inverse_diagonal: impl Fn(usize) -> f64 + Sync,
    b: &[DVec3],
    p: &mut Vec<DVec3>,
    reduction: f64,
    most: u32,
) -> Result<u32, ForceError>
where
    A: FnMut(&[DVec3], &mut [DVec3]) -> Result<(), ForceError>,
{
    let n = b.len();
    p.clear();
    p.resize(n, DVec3::ZERO);
    // Solved for b/|b|, whose squares neither vanish nor overflow.
    let scale = b.iter().fold(0.0_f64, |m, b| m.max(b.abs().max_element()));
    let mut residual: Vec<DVec3> = b.iter().map(|b| *b / scale.max(f64::MIN_POSITIVE)).collect();
    let precondition = |r: &[DVec3]| -> Vec<DVec3> {
        r.iter().enumerate().map(|(i, r)| inverse_diagonal(i) * *r).collect()
    };
    let mut z = precondition(&residual);
    let mut direction = z.clone();
    let mut product = vec![DVec3::ZERO; n];
    let mut rz = dot(&residual, &z);
    let wanted = reduction * reduction * rz;
    let mut products = 0;
    while rz > wanted && products < most {
        apply(&direction, &mut product)?;
        products += 1;
        let curvature = dot(&direction, &product);
        if curvature <= 0.0 {
            if products == 1 {
                p.clone_from(&direction);
            }
            break;
        }
        let alpha = rz / curvature;
        add_scaled(p, alpha, &direction);
        add_scaled(&mut residual, -alpha, &product);
        z = precondition(&residual);
        let next_rz = dot(&residual, &z);
        let beta = next_rz / rz;
        for_each_piece_pair(&mut direction, &mut z, |_, ds, zs| {
            for (d, z) in ds.iter_mut().zip(zs) {
                *d = *z + beta * *d;
            }
        });
        rz = next_rz;
    }
    for p in p.iter_mut() {
        *p *= scale;
    }
    Ok(products)
}

/// Σ aᵢ·bᵢ, an exact total.
pub(crate) fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    exact_sum(a.len(), |i| a[i].dot(b[i]))
}

/// y ← y + factor·x.
fn add_scaled(y: &mut [DVec3], factor: f64, x: &[DVec3]) {
    for_each_piece(y, |first, chunk| {
        for (y, x) in chunk.iter_mut().zip(&x[first..]) {
            *y += factor * *x;
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second difference of a chain with a shift: tridiagonal, positive definite for shift > 0.
    fn chain(shift: f64) -> impl FnMut(&[DVec3], &mut [DVec3]) -> Result<(), ForceError> {
        move |x, out| {
            for i in 0..x.len() {
                let left = if i > 0 { x[i - 1] } else { DVec3::ZERO };
                let right = x.get(i + 1).copied().unwrap_or(DVec3::ZERO);
                out[i] = (2.0 + shift) * x[i] - left - right;
            }
            Ok(())
        }
    }

    #[test]
    fn the_solution_solves_the_equations() {
        let b: Vec<DVec3> =
            (0..50).map(|i| DVec3::new(f64::from(i).sin(), 1.0, f64::from(i % 7))).collect();
        let mut p = Vec::new();
        let products = conjugate_gradients(chain(0.1), |_| 0.5, &b, &mut p, 1e-14, 1000).unwrap();
        let mut product = vec![DVec3::ZERO; b.len()];
        chain(0.1)(&p, &mut product).unwrap();
        let worst =
            product.iter().zip(&b).map(|(x, y)| (*x - *y).abs().max_element()).fold(0.0, f64::max);
        // Condition number 41: rounding of 1e-15 grows to 1e-13 at most.
        assert!(worst < 1e-12, "{worst:e}");
        // Exact arithmetic ends after as many products as there are distinct eigenvalues: 50.
        assert!(products <= 60, "{products}");
    }

    #[test]
    fn negative_curvature_still_gives_a_direction_of_descent() {
        for shift in [-0.5, -2.0, -5.0] {
            let b = vec![DVec3::ONE; 20];
            let mut p = Vec::new();
            // Twenty products would solve it.
            let products = conjugate_gradients(chain(shift), |_| 0.5, &b, &mut p, 1e-12, 1000);
            assert!(products.unwrap() < 20 && dot(&b, &p) > 0.0, "{shift}");
        }
    }
}
