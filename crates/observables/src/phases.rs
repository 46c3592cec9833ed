//! What a state tells of phases: a fluid that has separated, a crystal in it, and fronts between crystal and liquid.

use crate::{Average, Doubt, Estimate, Fronts, Remark};
use lennard_core::number::particles;
use lennard_core::{DVec3, Own, PeriodicBox};

use crate::bond_order::{solid_share_bytes, solid_share_of_all};
use crate::statistics::drift;
use crate::wave_vectors::WaveVectors;

/// Wave numbers that are looked at: in a cube, waves along one side, two sides and three.
const SHELLS: usize = 3;

/// The largest relative amplitude 2·|Σ_j exp(−i k·r_j)|/N of a wave of the density, over the longest waves that fit the box.
///
/// A homogeneous fluid has 4·S(k)/N for the mean of its square, with S(k) near ρTκ_T. Where vapor and liquid share the box it
/// does not fall with N: a slab that fills a part φ of the box has 2·(ρ_l − ρ_v)/ρ·sin(πφ)/π.
fn largest_density_wave(own: &Own, cell: &PeriodicBox, positions: &[DVec3]) -> f64 {
    let waves = WaveVectors::smallest(cell.lengths(), SHELLS);
    let waves = waves.densities(own, positions, cell).into_iter();
    let largest = waves.map(|wave| wave.length_squared()).fold(0.0, f64::max);
    2.0 * largest.sqrt() / own.all() as f64
}

/// A wave of the density with a larger amplitude is none of a homogeneous fluid.
const SEPARATED: f64 = 0.3;
/// A homogeneous fluid has waves of S(k) above this in one state of a thousand at most. Near a critical point S(k) is 3 on average.
const LARGEST_STRUCTURE_FACTOR: f64 = 20.0;
/// The amplitude up to which a fluid of so many molecules may be homogeneous.
fn homogeneous_up_to(molecules: usize) -> f64 {
    SEPARATED.max((4.0 * LARGEST_STRUCTURE_FACTOR / molecules as f64).sqrt())
}

/// That a state of so many molecules has separated into vapor and liquid, in words; `None` where it may be homogeneous.
#[must_use]
pub fn separated(
    own: &Own,
    cell: &PeriodicBox,
    positions: &[DVec3],
    molecules: usize,
) -> Option<String> {
    let wave = (molecules >= FEWEST).then(|| largest_density_wave(own, cell, positions))?;
    let allowed = homogeneous_up_to(molecules);
    (wave > allowed).then(|| {
        format!(
            "the density of the last state has a wave across the box of {:.0} % of its mean, where a homogeneous fluid of \
             {} has less than {:.0} %",
            100.0 * wave,
            particles(own.all(), molecules),
            100.0 * allowed
        )
    })
}

/// Above this share of solid-like particles a state is no liquid: dense liquids have some hundredths.
const FROZEN: f64 = 0.3;
/// Fewer particles or molecules say nothing.
const FEWEST: usize = 100;

/// Bytes that [`frozen`] takes for so many atoms.
#[must_use]
pub fn frozen_bytes(atoms: usize) -> usize {
    if atoms < FEWEST { 0 } else { solid_share_bytes(atoms) }
}

/// The remark on a state of atoms that is a crystal, or has one in it.
#[must_use]
pub fn frozen(own: &Own, cell: &PeriodicBox, positions: &[DVec3]) -> Option<Remark> {
    let share = (own.all() >= FEWEST).then(|| solid_share_of_all(own, cell, positions))?;
    (share > FROZEN).then_some(Remark::Frozen { solid_share: share })
}

/// The share of solid-like particles is followed while both phases are there: between these bounds.
const BOTH_PHASES: [f64; 2] = [0.15, 0.85];
/// Standard errors by which a velocity must differ from zero.
const ERRORS: f64 = 2.0;
/// Fewest samples of the share that tell a velocity.
const FEWEST_SAMPLES: usize = 30;

/// The velocity of each front into the liquid, and which phase grows, from the share of solid-like particles against time.
///
/// A front moves by `per_share` while the share grows from 0 to 1. `None` without samples.
#[must_use]
pub fn front(time: &[f64], share: &[f64], per_share: f64) -> Option<(Average, Fronts)> {
    let is_mixed = |share: &&f64| (BOTH_PHASES[0]..=BOTH_PHASES[1]).contains(*share);
    let samples = share.iter().take_while(is_mixed).count();
    let line = drift(&time[..samples], &share[..samples]);
    let velocity = line.slope * per_share;
    let standard_error =
        if samples >= FEWEST_SAMPLES { line.standard_error * per_share } else { f64::NAN };
    let solid_shares = [*share.first()?, *share.last()?];
    let too_few = standard_error.is_nan().then(|| {
        format!(
            "{samples} samples with both phases where {FEWEST_SAMPLES} are needed: look more often"
        )
    });
    let fronts = match &too_few {
        Some(why) => Fronts::TooFew { why: why.clone(), solid_shares },
        None if velocity.abs() > ERRORS * standard_error => {
            Fronts::Moving { velocity, standard_error, solid_shares }
        }
        None => Fronts::Neither { solid_shares },
    };
    let estimate = Estimate {
        freedom: line.blocks.saturating_sub(1) as f64,
        ..Estimate::new(velocity, standard_error, line.blocks as f64)
    };
    // A longer run has no more samples: one phase is gone.
    let doubt = too_few.map(Doubt::Incomplete);
    Some((Average::new("front_velocity", "σ/τ", estimate).doubted(doubt), fronts))
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
        largest_density_wave(
            &Own::all_of(positions.len()),
            &PeriodicBox::new(SIDES).unwrap(),
            positions,
        )
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

    /// A share that changes by `rate` per sample, with noise, up to its bounds.
    fn motion(rate: f64, samples: usize) -> (Average, Fronts) {
        let time: Vec<f64> = (0..samples).map(|i| 0.5 * i as f64).collect();
        let mut noise = 1_u64;
        let share: Vec<f64> = (0..samples)
            .map(|i| {
                noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                let noise = (noise >> 33) as f64 / 2.0_f64.powi(31) - 0.5;
                (0.5 + rate * i as f64 + 0.01 * noise).clamp(0.03, 0.98)
            })
            .collect();
        front(&time, &share, 12.0).unwrap()
    }

    #[test]
    fn a_front_has_its_velocity_while_both_phases_are_there() {
        for rate in [2e-3, -1e-3] {
            // The share ends at a bound, where nothing moves any more.
            let (average, fronts) = motion(rate, 1000);
            let exact = rate / 0.5 * 12.0;
            let Estimate { mean, standard_error, .. } = average.estimate;
            assert!((mean - exact).abs() < 0.02 * exact.abs(), "{average:?}");
            assert!(standard_error < 0.5 * exact.abs(), "{average:?}");
            let words = fronts.to_string();
            assert_eq!(words.starts_with("the crystal grows"), rate > 0.0, "{words}");
            assert_eq!(average.doubt, None);
            // The error is of ten slopes, and is itself known to 1/√18.
            assert_eq!((average.estimate.freedom, average.estimate.n_effective), (9.0, 10.0));
        }
        let (_, still) = motion(0.0, 1000);
        assert!(matches!(still, Fronts::Neither { .. }), "{still:?}");
    }

    #[test]
    fn too_few_samples_give_no_error() {
        let (average, fronts) = motion(2e-2, 1000);
        assert!(average.estimate.standard_error.is_nan(), "{average:?}");
        let Some(Doubt::Incomplete(why)) = average.doubt else { panic!("no doubt") };
        assert!(why.contains("look more often"), "{why}");
        let words = fronts.to_string();
        assert!(words.contains("98 % at the end"), "{words}");
        // The share rises from 50 to 98 %: it is not said that nothing grows.
        assert!(words.contains("no velocity is told") && !words.contains("neither"), "{words}");
    }

    #[test]
    fn few_molecules_may_have_larger_waves() {
        assert_eq!(homogeneous_up_to(10_000), SEPARATED);
        assert!((homogeneous_up_to(320) - 0.5).abs() < 1e-12);
    }
}
