//! Conjugate gradients for a matrix that is known only by what it does to a vector.

use lennard_core::exact::exact_sum;
use lennard_core::parallel::for_each_piece_pair;
use lennard_core::{DVec3, ForceError};

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Outcome {
    /// Products with the matrix.
    pub(crate) products: u32,
    /// Whether a direction of negative curvature was met, which ends the solve early: the solution so
    /// far is still a direction of descent.
    pub(crate) negative_curvature: bool,
}

/// Solves A·p = b for a symmetric A by preconditioned conjugate gradients, started from p = 0.
///
/// `inverse_diagonal` is the inverse of a positive diagonal preconditioner, one number a particle. It
/// ends when the residual, in the norm of the preconditioner, has fallen by `reduction`, or when `most`
/// products are spent. It also ends at a direction d with dᵀA·d ≤ 0. Then p is kept as it is, or, if it
/// is still zero, becomes the preconditioned b. In every case bᵀp > 0 (Steihaug, "The conjugate
/// gradient method and trust regions in large scale optimization", SIAM J. Numer. Anal. 20, 626, 1983).
pub(crate) fn conjugate_gradients<A>(
    mut apply: A,
    inverse_diagonal: impl Fn(usize) -> f64 + Sync,
    b: &[DVec3],
    p: &mut Vec<DVec3>,
    reduction: f64,
    most: u32,
) -> Result<Outcome, ForceError>
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
    let (mut products, mut negative_curvature) = (0, false);
    while rz > wanted && products < most {
        apply(&direction, &mut product)?;
        products += 1;
        let curvature = dot(&direction, &product);
        if curvature <= 0.0 {
            if products == 1 {
                p.clone_from(&direction);
            }
            negative_curvature = true;
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
    Ok(Outcome { products, negative_curvature })
}

/// Σ aᵢ·bᵢ, an exact total.
pub(crate) fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    exact_sum(a.len(), |i| a[i].dot(b[i]))
}

/// y ← y + factor·x.
fn add_scaled(y: &mut [DVec3], factor: f64, x: &[DVec3]) {
    lennard_core::parallel::for_each_piece(y, |first, chunk| {
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
        let outcome = conjugate_gradients(chain(0.1), |_| 0.5, &b, &mut p, 1e-14, 1000).unwrap();
        let mut product = vec![DVec3::ZERO; b.len()];
        chain(0.1)(&p, &mut product).unwrap();
        let worst =
            product.iter().zip(&b).map(|(x, y)| (*x - *y).abs().max_element()).fold(0.0, f64::max);
        // Condition number 41: rounding of 1e-15 grows to 1e-13 at most.
        assert!(worst < 1e-12 && !outcome.negative_curvature, "{worst:e}");
        // Exact arithmetic ends after as many products as there are distinct eigenvalues: 50.
        assert!(outcome.products <= 60, "{}", outcome.products);
    }

    #[test]
    fn negative_curvature_still_gives_a_direction_of_descent() {
        for shift in [-0.5, -2.0, -5.0] {
            let b = vec![DVec3::ONE; 20];
            let mut p = Vec::new();
            let outcome =
                conjugate_gradients(chain(shift), |_| 0.5, &b, &mut p, 1e-12, 1000).unwrap();
            assert!(outcome.negative_curvature, "{shift}");
            assert!(dot(&b, &p) > 0.0);
        }
    }
}
