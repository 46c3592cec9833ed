//! The bias of a short cutoff, from the run's own g(r).

use std::f64::consts::PI;

use super::RunFolder;

/// The bias of a tail correction beyond `r_cut` (σ), which takes g(r) = 1 there: measured − true, with the g(r) that the run
/// has measured inside its cutoff. The first is of U (ε per particle), the second of P (ε/σ³).
///
/// ΔU = 2πρ ∫ (1 − g) u r² dr and ΔP = −(2π/3)ρ² ∫ (1 − g) u′ r³ dr from r_cut to where g(r) was measured, u the full
/// Lennard-Jones potential. How the cutoff changes the structure inside it is of the next order and left out. `None` where
/// the run has no g(r) beyond its cutoff.
pub(super) fn tail_bias(run: &RunFolder, r_cut: f64) -> Option<[f64; 2]> {
    let table = run.table("rdf")?;
    let (r, g) = (table.numbers("r")?, table.numbers("g")?);
    of_distribution(&r, &g, run.density, r_cut)
}

fn of_distribution(r: &[f64], g: &[f64], density: f64, r_cut: f64) -> Option<[f64; 2]> {
    /// Less than this (σ) beyond the cutoff misses most of what the tail gets wrong: half a period of g(r).
    const SHORTEST_REACH: f64 = 0.5;
    let width = r.get(1)? - r.first()?;
    if r.last()? - r_cut < SHORTEST_REACH {
        return None;
    }
    let mut bias = [0.0; 2];
    for (r, g) in r.iter().zip(g).filter(|(r, g)| **r > r_cut && g.is_finite()) {
        let sixth = r.powi(-6);
        let u = 4.0 * (sixth * sixth - sixth);
        let slope = -24.0 * (2.0 * sixth * sixth - sixth) / r;
        bias[0] += 2.0 * PI * density * (1.0 - g) * u * r * r * width;
        bias[1] -= 2.0 / 3.0 * PI * density * density * (1.0 - g) * slope * r.powi(3) * width;
    }
    Some(bias)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_structure_there_is_no_bias_and_without_particles_it_is_the_whole_tail() {
        let r: Vec<f64> = (0..3000).map(|k| 0.01 * (f64::from(k) + 0.5)).collect();
        let bias = of_distribution(&r, &vec![1.0; r.len()], 0.8, 2.5).unwrap();
        assert_eq!(bias, [0.0; 2]);
        // g = 0 beyond the cutoff: the tail itself, u_tail = (8π/3)ρ(r⁻⁹/3 − r⁻³), p_tail = (16π/3)ρ²(2r⁻⁹/3 − r⁻³).
        let bias = of_distribution(&r, &vec![0.0; r.len()], 0.8, 2.5).unwrap();
        let (third, ninth) = (2.5_f64.powi(-3), 2.5_f64.powi(-9));
        let u = 8.0 * PI / 3.0 * 0.8 * (ninth / 3.0 - third);
        let p = 16.0 * PI / 3.0 * 0.64 * (2.0 * ninth / 3.0 - third);
        // What lies beyond 30 σ, and the sum over bins.
        assert!((bias[0] / u - 1.0).abs() < 1e-3, "{bias:?} {u}");
        assert!((bias[1] / p - 1.0).abs() < 1e-3, "{bias:?} {p}");
        assert_eq!(of_distribution(&r[..280], &vec![1.0; 280], 0.8, 2.5), None);
    }
}
