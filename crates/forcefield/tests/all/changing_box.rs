//! Lists in a box that changes: every loop against the reference, and the limits of the box.

use crate::common::*;
use lennard_core::{
    Backend, DVec3, Energetics, ForceError, ForceTerm, FusedSteps, Masses, Part, PeriodicBox,
    Persist, StateArchive, Want,
};
use lennard_forcefield::{
    AllPairs, ForceFieldOptions, Kernel, KernelOptions, ListMode, NeighborOptions, PairForces,
    Precision, SplitOptions, TruncationKind, TruncationOptions, build,
};

/// Thin, so that a box of 4 % less brings pairs from beyond the list inside the cutoff.
const SKIN: f64 = 0.12;

/// Reproducible numbers in [−1, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        // Knuth's constants for a linear congruential generator of 64 bits.
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }
}

/// A fluid in a box, scaled together.
#[derive(Clone, PartialEq)]
struct Fluid {
    cell: PeriodicBox,
    positions: Vec<DVec3>,
}

impl Fluid {
    fn scale(&mut self, factors: DVec3) {
        self.cell = self.cell.scaled(factors).unwrap();
        self.positions.iter_mut().for_each(|r| *r *= factors);
    }
}

/// The configurations of a fluid that moves a little at every step, in a box that changes by up to 1 % at random steps.
///
/// The box shrinks by several per cent in the first half, and it grows in the second half.
fn trajectory(cells: [usize; 3]) -> Vec<Fluid> {
    let (cell, positions) = liquid(cells, 0.75, 0.1);
    let mut fluid = Fluid { cell, positions };
    let (mut random, mut of_box) = (Random(1967), Random(3));
    let mut all = vec![fluid.clone()];
    for step in 0..24 {
        for r in &mut fluid.positions {
            *r += 0.006 * random.vector();
        }
        if of_box.next() < 0.4 {
            let trend = if step < 12 { -0.7 } else { 0.7 };
            let factors = match step % 3 {
                0 => 0.3 * of_box.vector(),
                _ => DVec3::splat(0.3 * of_box.next()),
            };
            fluid.scale(DVec3::ONE + 0.01 * (factors + DVec3::splat(trend)));
        }
        all.push(fluid.clone());
    }
    let changes = all.windows(2).filter(|w| w[0].cell != w[1].cell).count();
    let shortest = all.iter().map(|f| f.cell.lengths() / cell.lengths());
    let shortest = shortest.fold(1.0, |all: f64, l| all.min(l.min_element()));
    assert!(changes > 10 && shortest < 0.95, "{changes} {shortest}");
    all
}

/// Every loop that this machine can run, with its list.
fn loops() -> Vec<ForceFieldOptions> {
    let base = ForceFieldOptions {
        truncation: TruncationOptions::new(TruncationKind::Shift, 2.5),
        neighbor: verlet(Some(SKIN)),
        ..ForceFieldOptions::default()
    };
    let mut all: Vec<ForceFieldOptions> =
        kernels().into_iter().map(|kernel| ForceFieldOptions { kernel, ..base }).collect();
    all.push(ForceFieldOptions { canonical: true, ..base });
    all.push(ForceFieldOptions {
        neighbor: NeighborOptions { mode: ListMode::Direct, skin: None },
        ..base
    });
    all
}

fn of_reference(options: &ForceFieldOptions) -> ForceFieldOptions {
    ForceFieldOptions {
        kernel: KernelOptions { kernel: Kernel::Reference, ..KernelOptions::default() },
        neighbor: NeighborOptions::default(),
        ..*options
    }
}

#[test]
fn every_loop_gives_the_forces_of_the_reference_while_the_box_changes() {
    // Few particles, which each thread packs for itself, and many.
    for (cells, species) in [([8, 9, 8], 1), ([13, 14, 13], 1), ([8, 9, 8], 2)] {
        let fluids = trajectory(cells);
        let n = fluids[0].positions.len();
        let mixture = mixture_or_one(species, 2.5, n);
        let mixture = mixture.as_ref();
        let reference: Vec<_> = fluids
            .iter()
            .map(|fluid| reference_of(&loops()[0], mixture, fluid.cell, &fluid.positions))
            .collect();
        for options in loops() {
            let mut forces = built(&options, mixture, fluids[0].cell, n);
            let all_pairs = AllPairs::new(&options, mixture).unwrap();
            for (step, (fluid, (wanted, totals))) in fluids.iter().zip(&reference).enumerate() {
                let (found, energetics) =
                    all(&mut forces, fluid.cell, &fluid.positions, Want::ENERGY);
                let what = format!("{options:?}, step {step} of {n} particles");
                if options.kernel.precision == Precision::Double {
                    assert_eq!(energetics.pairs, totals.pairs, "{what}");
                }
                // A bound of rounding for each particle; it is below the force of one pair at the cutoff, 0.039.
                for (i, f) in found.iter().enumerate().step_by(1 + n / 600) {
                    let checked = all_pairs.force_on(i, &fluid.cell, &fluid.positions);
                    let off = (*f - checked.force).length();
                    assert!(off <= checked.tolerance, "{what}: {f} against {checked:?}");
                }
                for (i, (f, w)) in found.iter().zip(wanted).enumerate() {
                    let off = (*f - *w).length();
                    assert!(off <= 0.02 + 1e-5 * w.length(), "{what}, {i}: {f} {w}");
                }
            }
            let builds = forces.statistics().builds;
            if options.neighbor.mode == ListMode::Verlet {
                // Most lists survive a change of the box. Without affine displacements there are 18 builds.
                assert!((2..6).contains(&builds), "{options:?}: {builds} builds");
            }
        }
    }
}

#[test]
fn near_and_far_parts_are_those_of_the_reference_while_the_box_changes() {
    let fluids = trajectory([8, 9, 8]);
    let at = conditions(fluids[0].cell, fluids[0].positions.len());
    for base in loops() {
        let options =
            ForceFieldOptions { split: Some(SplitOptions { r_split: 1.8, width: 0.4 }), ..base };
        let mut forces = build(&options, &at).unwrap();
        let mut reference = build(&of_reference(&options), &at).unwrap();
        for fluid in &fluids {
            let sizes = magnitudes(&options, fluid.cell, &fluid.positions);
            for part in [Part::Near, Part::Far] {
                let get = |forces: &mut PairForces| {
                    evaluate(forces, fluid.cell, &fluid.positions, part, Want::NOTHING).unwrap().0
                };
                let (found, wanted) = (get(&mut forces), get(&mut reference));
                let relative = match options.kernel.precision {
                    Precision::Double => 1e-12,
                    // Singles have a last place of 6e-8, and the force is steeper than the distance by a factor of 13.
                    Precision::Mixed => 1e-5,
                };
                for ((f, w), (size, stiffness)) in found.iter().zip(&wanted).zip(&sizes) {
                    // The near part has rows, of which the far part takes its share.
                    let bound = relative * (size + stiffness) + 1e-9 * (size + 100.0);
                    assert!((*f - *w).length() <= bound, "{options:?}, {part:?}: {f} {w}");
                }
            }
        }
    }
}

#[test]
fn fused_steps_have_the_bits_of_single_steps_in_a_box_that_is_not_that_of_the_build() {
    let masses = Masses::Uniform(1.0);
    let dt = 0.004;
    for cells in [[8, 9, 8], [13, 14, 13]] {
        let (cell, positions) = liquid(cells, 0.75, 0.1);
        let n = positions.len();
        let start = Fluid { cell, positions };
        let noise = scatter(n, DVec3::splat(2.0), 0.7);
        let velocities: Vec<DVec3> = noise.iter().map(|v| *v - DVec3::ONE).collect();
        for options in loops().into_iter().filter(|o| !o.canonical) {
            let run = |fused: bool| {
                let mut forces = build(&options, &conditions(cell, n)).unwrap();
                let (mut fluid, mut v) = (start.clone(), velocities.clone());
                let mut random = Random(7);
                for stride in [7, 5, 9, 6, 8] {
                    let mut left = stride;
                    if fused {
                        left -= forces.advance(&mut FusedSteps {
                            cell: &fluid.cell,
                            positions: &mut fluid.positions,
                            velocities: &mut v,
                            forces: &mut vec![DVec3::NAN; n],
                            masses: &masses,
                            dt,
                            steps: stride,
                            first: 0,
                            bath: None,
                        });
                    }
                    for _ in 0..left {
                        let (f, _) = all(&mut forces, fluid.cell, &fluid.positions, Want::NOTHING);
                        kick(&mut v, &f, &masses, 0.5 * dt);
                        kick(&mut v, &f, &masses, 0.5 * dt);
                        drift(&mut fluid.positions, &v, dt);
                    }
                    fluid.scale(DVec3::ONE + 0.004 * random.vector());
                }
                let found = forces.statistics();
                (fluid, v, (found.builds, found.evaluations))
            };
            assert!(run(true) == run(false), "{options:?}, {n} particles");
        }
    }
}

#[test]
fn a_restart_in_a_changed_box_continues_with_the_same_bits() {
    let fluids = trajectory([8, 9, 8]);
    let at = conditions(fluids[0].cell, fluids[0].positions.len());
    for options in loops() {
        let mut one = build(&options, &at).unwrap();
        let (before, after) = fluids.split_at(11);
        for fluid in before {
            all(&mut one, fluid.cell, &fluid.positions, Want::NOTHING);
        }
        let mut archive = StateArchive::default();
        one.save(&mut archive.writer());
        let mut other = build(&options, &at).unwrap();
        other.restore(&archive.reader()).unwrap();
        for fluid in after {
            let get =
                |forces: &mut PairForces| all(forces, fluid.cell, &fluid.positions, Want::TOTALS);
            assert!(get(&mut one) == get(&mut other), "{options:?}");
        }
        let builds = |forces: &PairForces| forces.statistics().builds;
        assert_eq!(builds(&one), builds(&other), "{options:?}");
    }
}

#[test]
fn a_shrinking_box_gets_a_thinner_skin_and_ends_with_an_error_at_twice_the_cutoff() {
    let (cell, positions) = liquid([5, 5, 5], 0.7, 0.1);
    let n = positions.len();
    for mut options in loops() {
        if options.neighbor.mode == ListMode::Verlet {
            options.neighbor = verlet(Some(0.3));
        }
        let mut fluid = Fluid { cell, positions: positions.clone() };
        // From half a side of 2.82 σ, where the skin fits, to 2.505 σ, where it is 0.005 σ.
        fluid.scale(DVec3::splat(2.82 / cell.largest_cutoff()));
        let mut forces = build(&options, &conditions(fluid.cell, n)).unwrap();
        for half in [2.82, 2.7, 2.6, 2.505, 2.6, 2.82] {
            fluid.scale(DVec3::splat(half / fluid.cell.largest_cutoff()));
            let (found, _) = all(&mut forces, fluid.cell, &fluid.positions, Want::NOTHING);
            let all_pairs = AllPairs::new(&options, None).unwrap();
            for (i, f) in found.iter().enumerate() {
                let checked = all_pairs.force_on(i, &fluid.cell, &fluid.positions);
                let off = (*f - checked.force).length();
                assert!(off <= checked.tolerance, "{options:?}, half a side {half}");
            }
        }
        let mut small = fluid.clone();
        small.scale(DVec3::new(1.0, 2.49 / fluid.cell.largest_cutoff(), 1.0));
        let error = evaluate(&mut forces, small.cell, &small.positions, Part::All, Want::NOTHING)
            .unwrap_err();
        let ForceError::CutoffOverHalfBox { r_cut, largest } = error else {
            panic!("{options:?}: {error}")
        };
        assert!(r_cut == 2.5 && (largest - 2.49).abs() < 1e-12);
        let velocities = &mut vec![DVec3::ZERO; n];
        let taken = forces.advance(&mut FusedSteps {
            cell: &small.cell,
            positions: &mut small.positions,
            velocities,
            forces: &mut vec![DVec3::NAN; n],
            masses: &Masses::Uniform(1.0),
            dt: 0.001,
            steps: 5,
            first: 0,
            bath: None,
        });
        assert_eq!(taken, 0);
        // The forces are usable again once the box is large enough.
        all(&mut forces, fluid.cell, &fluid.positions, Want::TOTALS);
    }
}

/// Particles 1.3 σ apart in one corner of a box with these sides, σ, and as many in the middle of it, where they have digits left.
fn clumps(sides: DVec3) -> Fluid {
    let cell = PeriodicBox::new(sides).unwrap();
    let clump =
        (0..27).map(|i| DVec3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)));
    // Some lie beyond a face: folded into a wide box, they would all lie at it.
    let clump: Vec<DVec3> = clump.map(|r| 1.3 * r - DVec3::splat(1.5)).collect();
    let middle = clump.iter().map(|r| *r + (0.5 * sides).floor());
    let has_digits = sides.max_element() < 1e14;
    let middle = middle.filter(|_| has_digits);
    let positions = clump.iter().copied().chain(middle).collect();
    Fluid { cell, positions }
}

#[test]
fn in_a_box_too_wide_for_fixed_point_mixed_precision_has_the_bits_of_double() {
    let with = |precision| ForceFieldOptions {
        kernel: KernelOptions { precision, ..KernelOptions::default() },
        truncation: TruncationOptions { r_cut: 1.32, ..TruncationOptions::default() },
        ..ForceFieldOptions::default()
    };
    // A long slab and a cube, on either side of 10⁻⁶·2³² = 4294.97 σ, and boxes beyond any search.
    for (x, z, is_mixed) in [
        (20.0, 4294.0, true),
        (20.0, 4296.0, false),
        (1e9, 1e9, false),
        (1e30, 1e30, false),
        (1e300, 1e300, false),
    ] {
        let fluid = clumps(DVec3::new(x, x, z));
        let n = fluid.positions.len();
        let [mixed, double] = [Precision::Mixed, Precision::Double].map(|precision| {
            let mut forces = build(&with(precision), &conditions(fluid.cell, n)).unwrap();
            let plan = forces.plan();
            assert_eq!(
                plan.precision == Precision::Mixed,
                is_mixed && precision == Precision::Mixed
            );
            assert_eq!(plan.remark.is_some(), !is_mixed && precision == Precision::Mixed);
            all(&mut forces, fluid.cell, &fluid.positions, Want::TOTALS)
        });
        assert_eq!(mixed == double, !is_mixed, "{x} {z}");
        let energy = |found: &(_, Energetics)| found.1.potential_energy.unwrap();
        let (a, b) = (energy(&mixed), energy(&double));
        assert!((a - b).abs() < 1e-4 * b.abs(), "{a} {b}");
        // Each clump has 54 pairs.
        assert_eq!(double.1.pairs, Some(2 * n as u64));
    }
}

#[test]
fn a_box_that_grows_too_wide_for_fixed_point_ends_with_an_error() {
    let mut fluid = clumps(DVec3::new(30.0, 20.0, 4294.0));
    let options = ForceFieldOptions {
        kernel: KernelOptions { precision: Precision::Mixed, ..KernelOptions::default() },
        ..ForceFieldOptions::default()
    };
    let n = fluid.positions.len();
    let mut forces = build(&options, &conditions(fluid.cell, n)).unwrap();
    all(&mut forces, fluid.cell, &fluid.positions, Want::TOTALS);
    fluid.scale(DVec3::new(1.0, 1.0, 1.001));
    let (at, want) = (&fluid.positions, Want::NOTHING);
    let error = evaluate(&mut forces, fluid.cell, at, Part::All, want).unwrap_err();
    assert!(matches!(error, ForceError::BoxTooWide { .. }), "{error}");
    fluid.scale(DVec3::new(1.0, 1.0, 0.999));
    all(&mut forces, fluid.cell, &fluid.positions, Want::TOTALS);
}
