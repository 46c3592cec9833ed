//! Waves of the density as long as the box, by which a fluid that has separated is known.

use lennard_core::{DVec3, PeriodicBox};

use crate::wave_vectors::WaveVectors;

/// Wave numbers that are looked at: in a cube, waves along one side, two sides and three.
const SHELLS: usize = 3;

/// The largest relative amplitude 2·|Σ_j exp(−i k·r_j)|/N of a wave of the density, over the longest waves that fit the box.
///
/// A homogeneous fluid has 4·S(k)/N for the mean of its square, with S(k) near ρTκ_T. Where vapor and liquid share the box it
/// does not fall with N: a slab that fills a part φ of the box has 2·(ρ_l − ρ_v)/ρ·sin(πφ)/π.
#[must_use]
pub fn largest_density_wave(cell: &PeriodicBox, positions: &[DVec3]) -> f64 {
    let waves = WaveVectors::smallest(cell.lengths(), SHELLS);
    let waves = waves.densities(positions, cell).into_iter();
    let largest = waves.map(|wave| wave.length_squared()).fold(0.0, f64::max);
    2.0 * largest.sqrt() / positions.len() as f64
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use lennard_core::random::Streams;
    use rand_distr::{Distribution, StandardUniform};

    use super::*;

    const SIDES: DVec3 = DVec3::new(9.0, 10.0, 12.0);

    fn positions(n: usize, place: impl Fn(DVec3) -> DVec3) -> Vec<DVec3> {
        let mut rng = Streams::new(3).sequential("positions");
        let mut draw = || -> f64 { StandardUniform.sample(&mut rng) };
        (0..n).map(|_| place(DVec3::new(draw(), draw(), draw())) * SIDES).collect()
    }

    fn wave(positions: &[DVec3]) -> f64 {
        largest_density_wave(&PeriodicBox::new(SIDES).unwrap(), positions)
    }

    #[test]
    fn a_slab_has_the_wave_of_its_part_of_the_box_along_any_axis() {
        let filled = 0.3;
        let wanted = 2.0 * (PI * filled).sin() / (PI * filled);
        for axis in 0..3 {
            let slab = positions(20_000, |mut r| {
                r[axis] = 0.9 + filled * r[axis];
                r
            });
            assert!((wave(&slab) - wanted).abs() < 0.01, "{axis}");
        }
    }

    #[test]
    fn an_ideal_gas_has_waves_that_fall_with_its_particles() {
        for n in [500, 50_000] {
            let found = wave(&positions(n, |r| r));
            // Of three waves with S = 1 on average, the largest has S between 0.03 and 12 in all but one case of 10⁴.
            let bar = (4.0 * 12.0 / n as f64).sqrt();
            assert!(found < bar && found > 0.05 * bar, "{found} {bar}");
        }
    }
}
