//! Two half kicks and a drift of some particles, as fused steps take them.

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

use glam::DVec3;

use super::level::Level;

/// The coefficients of two half kicks and a drift.
#[derive(Debug, Clone, Copy)]
pub struct KickDrift {
    /// Half a time step over the mass, τ.
    pub half_kick: f64,
    /// The time step, τ.
    pub dt: f64,
}

impl KickDrift {
    /// Moves some particles: v ← v + (h/2m)·F twice, then x ← x + h·v, with the bits of [`lennard_core::sweeps`].
    ///
    /// Returns an upper bound of their steps |x − x_before|, σ.
    pub fn apply(
        self,
        level: Level,
        positions: &mut [DVec3],
        velocities: &mut [DVec3],
        forces: &[DVec3],
    ) -> f64 {
        match level.avx2() {
            // SAFETY: the token proves AVX2.
            #[cfg(target_arch = "x86_64")]
            Some(_) => unsafe { self.apply_avx2(positions, velocities, forces) },
            _ => self.apply_plain(positions, velocities, forces, DVec3::ZERO),
        }
    }

    /// [`KickDrift::apply`] by a plain loop; `longest` has the longest steps of other particles along each axis, σ.
    #[inline(always)]
    fn apply_plain(
        self,
        positions: &mut [DVec3],
        velocities: &mut [DVec3],
        forces: &[DVec3],
        mut longest: DVec3,
    ) -> f64 {
        for ((x, v), f) in positions.iter_mut().zip(velocities).zip(forces) {
            let (before, kick) = (*x, self.half_kick * *f);
            *v += kick;
            *v += kick;
            *x += self.dt * *v;
            longest = (*x - before).abs().max(longest);
        }
        // The factor covers the rounding of the bound.
        longest.length() * (1.0 + 1e-12)
    }

    /// [`KickDrift::apply`] in registers of four components.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn apply_avx2(
        self,
        positions: &mut [DVec3],
        velocities: &mut [DVec3],
        forces: &[DVec3],
    ) -> f64 {
        let [half_kick, dt] = [self.half_kick, self.dt].map(|h| _mm256_set1_pd(h));
        let sign = _mm256_set1_pd(-0.0);
        // The twelve components of four particles fill three registers.
        let mut longest = [_mm256_setzero_pd(); 3];
        let (x, x_rest) = positions.as_chunks_mut::<4>();
        let (v, v_rest) = velocities.as_chunks_mut::<4>();
        let (f, f_rest) = forces.as_chunks::<4>();
        for ((x, v), f) in x.iter_mut().zip(v).zip(f) {
            let (x, v) = (x.as_mut_ptr().cast::<f64>(), v.as_mut_ptr().cast::<f64>());
            let f = f.as_ptr().cast::<f64>();
            for (k, longest) in longest.iter_mut().enumerate() {
                // SAFETY: four vectors are twelve consecutive numbers.
                unsafe {
                    let (x, v) = (x.add(4 * k), v.add(4 * k));
                    let kick = _mm256_mul_pd(half_kick, _mm256_loadu_pd(f.add(4 * k)));
                    let v_next = _mm256_add_pd(_mm256_add_pd(_mm256_loadu_pd(v), kick), kick);
                    let before = _mm256_loadu_pd(x);
                    let after = _mm256_add_pd(before, _mm256_mul_pd(dt, v_next));
                    let step = _mm256_andnot_pd(sign, _mm256_sub_pd(after, before));
                    *longest = _mm256_max_pd(step, *longest);
                    _mm256_storeu_pd(v, v_next);
                    _mm256_storeu_pd(x, after);
                }
            }
        }
        let mut of_each = [DVec3::ZERO; 4];
        for (k, longest) in longest.into_iter().enumerate() {
            // SAFETY: as above.
            unsafe { _mm256_storeu_pd(of_each.as_mut_ptr().cast::<f64>().add(4 * k), longest) };
        }
        let longest = of_each.into_iter().fold(DVec3::ZERO, DVec3::max);
        self.apply_plain(x_rest, v_rest, f_rest, longest)
    }
}

/// The components of vectors, one after another.
#[inline(always)]
pub fn components(vectors: &[DVec3]) -> &[f64] {
    // SAFETY: a vector is three numbers, as the assertion below says.
    unsafe { std::slice::from_raw_parts(vectors.as_ptr().cast(), 3 * vectors.len()) }
}

/// As [`components`], to be written.
#[inline(always)]
pub fn components_mut(vectors: &mut [DVec3]) -> &mut [f64] {
    // SAFETY: as above.
    unsafe { std::slice::from_raw_parts_mut(vectors.as_mut_ptr().cast(), 3 * vectors.len()) }
}

const _: () =
    assert!(size_of::<DVec3>() == 3 * size_of::<f64>() && align_of::<DVec3>() == align_of::<f64>());

#[cfg(test)]
mod tests {
    use super::super::level::Avx2;
    use super::*;

    #[test]
    #[allow(clippy::print_stdout)]
    fn registers_move_particles_to_the_same_bits_as_plain_loops_within_the_same_bound() {
        let Some(avx2) = Avx2::detect() else {
            println!("skipped: this processor has no AVX2");
            return;
        };
        let noise = |k: usize| (k as f64 * 12.9898).sin();
        let vectors = |from: usize, n: usize, scale: f64| -> Vec<DVec3> {
            let at = |k: usize| DVec3::new(noise(k), noise(k + 700), noise(k + 1400)) * scale;
            (from..from + n).map(at).collect()
        };
        let kick_drift = KickDrift { half_kick: 0.002, dt: 0.004 };
        for n in [0, 1, 3, 4, 7, 50] {
            // Each particle in turn has the longest step.
            for fastest in 0..n {
                let start = vectors(0, n, 1e4);
                let mut v = vectors(99, n, 1.0);
                v[fastest] *= 7.0;
                let forces = vectors(333, n, 50.0);
                let [plain, found] = [Level::Portable, Level::Avx2(avx2)].map(|level| {
                    let (mut x, mut v) = (start.clone(), v.clone());
                    let bound = kick_drift.apply(level, &mut x, &mut v, &forces);
                    (x, v, bound)
                });
                assert_eq!(found, plain);
                let steps = found.0.iter().zip(&start).map(|(x, x0)| (x - x0).length());
                let longest = steps.fold(0.0, f64::max);
                assert!((longest..1.8 * longest).contains(&found.2), "{n} {fastest}");
            }
        }
    }
}
