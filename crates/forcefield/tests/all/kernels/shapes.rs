//! Random shapes: every loop agrees with the reference.

use super::*;
use proptest::prelude::*;

/// A configuration of any shape: gas, liquid, a disturbed crystal, or a lump in a vacuum.
#[derive(Debug, Clone)]
struct Shape {
    n: usize,
    species: usize,
    /// Sides of the box, in cutoffs.
    sides: [f64; 3],
    /// Skin as a share of the largest that the box allows.
    skin_share: f64,
    /// Share of each side that particles fill.
    filling: f64,
    /// Whether particles stand on a grid, and how much they are disturbed, in distances of the grid.
    crystal: Option<f64>,
    seed: f64,
    origin: f64,
}

/// Boxes from two cutoffs on, which is the smallest that there can be.
fn shapes(longest: f64) -> impl Strategy<Value = Shape> {
    let side = prop_oneof![Just(2.0), 2.0_f64..7.0, 2.0_f64..longest];
    let cube = side.clone().prop_map(|side| [side; 3]);
    let sides = prop_oneof![1 => cube, 2 => prop::array::uniform3(side)];
    let skin = prop_oneof![Just(0.0), Just(1.0), 0.0_f64..0.3, 0.0_f64..=1.0];
    let n = prop_oneof![1_usize..10, 1_usize..400];
    (
        n,
        1_usize..4,
        sides,
        skin,
        0.05_f64..=1.0,
        prop::option::of(0.0_f64..0.3),
        0.0_f64..1000.0,
        -30.0_f64..30.0,
    )
        .prop_map(|(n, species, sides, skin_share, filling, crystal, seed, origin)| Shape {
            n,
            species,
            sides,
            skin_share,
            filling,
            crystal,
            seed,
            origin,
        })
}

impl Shape {
    fn positions(&self, lengths: DVec3) -> Vec<DVec3> {
        let filled = lengths * self.filling;
        let random = scatter(self.n, DVec3::ONE, self.seed);
        let across = (self.n as f64).cbrt().ceil() as usize;
        let step = filled / across as f64;
        let place = |(i, random): (usize, &DVec3)| match self.crystal {
            None => *random * filled,
            Some(disturbed) => {
                let [x, y, z] = [i % across, i / across % across, i / across / across];
                (DVec3::new(x as f64, y as f64, z as f64) + disturbed * *random) * step
            }
        };
        let at = random.iter().enumerate().map(place);
        at.map(|r| r + DVec3::splat(self.origin)).collect()
    }
}

/// Rounding of coordinates relative to the cluster center, up to 3 + 2.5 σ away: twice half a unit in the last place,
/// 2.4e-7 σ each.
const SEEN: f64 = 5e-7;

/// One particle in this many moves by more than half the skin: so few that the list looks ahead of them.
const MOVED_FAR: usize = 40;

/// Compares every kernel with the reference after its list was built and the particles have moved.
///
/// They move by just under half the skin, and some of them by up to the whole skin.
fn agrees_with_the_reference(shape: &Shape) -> Result<(), TestCaseError> {
    let r_cut = 2.5;
    // A last place more: at exactly two cutoffs, rounding must not make the box too small.
    let lengths = DVec3::from(shape.sides) * r_cut * (1.0 + 1e-15);
    let cell = PeriodicBox::new(lengths).unwrap();
    let skin = (shape.skin_share * (cell.largest_cutoff() - r_cut)).max(0.0);
    let start = shape.positions(lengths);
    let near = moved(&start, 0.49 * skin);
    agrees_there(shape.species, cell, skin, (&start, &near), true)?;
    let mut far = near;
    for (k, place) in (0..shape.n).step_by(MOVED_FAR).skip(1).enumerate() {
        let share = 0.9 + 0.02 * (k % 5) as f64;
        far[place] = moved(&start, share * skin)[place];
    }
    agrees_there(shape.species, cell, skin, (&start, &far), false)
}

/// Compares the kernels after a move from `start` to `positions`; `lasts` says whether the list must last that long.
fn agrees_there(
    species: usize,
    cell: PeriodicBox,
    skin: f64,
    (start, positions): (&[DVec3], &[DVec3]),
    lasts: bool,
) -> Result<(), TestCaseError> {
    let (r_cut, n) = (2.5, start.len());
    let lengths = cell.lengths();
    let mixture = mixture_or_one(species, r_cut, n);
    let mixture = mixture.as_ref();
    // A soft potential: random positions overlap.
    let potential = PotentialOptions::SoftSphere(SoftSphere { exponent: 4 });
    let judged = |kind| {
        let base = ForceFieldOptions {
            potential,
            truncation: TruncationOptions::new(kind, r_cut),
            neighbor: verlet(Some(skin)),
            ..ForceFieldOptions::default()
        };
        let sizes = magnitudes_of(&base, mixture, cell, positions);
        (base, reference_of(&base, mixture, cell, positions), sizes)
    };
    // Fixed-point coordinates can carry a pair across the cutoff. The force of a shifted potential jumps
    // there by more than any rounding. Mixed precision is therefore judged where the force ends at zero.
    let sharp = judged(TruncationKind::Shift);
    let smooth = judged(TruncationKind::ForceShift);
    // Last places of coordinates, and of fixed point in the longest side.
    let (place, unit) = (2e-15 * lengths.max_element(), 1e-9 * lengths.max_element());
    for kernel in kernels() {
        let (base, (wanted, totals), sizes) = match kernel.precision {
            Precision::Double => &sharp,
            Precision::Mixed => &smooth,
        };
        let options = ForceFieldOptions { kernel, ..*base };
        let mut forces = built(&options, mixture, cell, n);
        all(&mut forces, cell, start, Want::NOTHING);
        let (found, energetics) = all(&mut forces, cell, positions, Want::ENERGY);
        one_by_one(&options, mixture, cell, positions, &found)?;
        let (options_sharp, found_sharp) = {
            let options = ForceFieldOptions { kernel, ..sharp.0 };
            let mut forces = built(&options, mixture, cell, n);
            (options, all(&mut forces, cell, positions, Want::NOTHING).0)
        };
        one_by_one(&options_sharp, mixture, cell, positions, &found_sharp)?;
        if lasts && skin > 1e-9 {
            prop_assert_eq!(forces.statistics().builds, 1);
        }
        if kernel.precision == Precision::Double {
            prop_assert_eq!(energetics.pairs, totals.pairs);
        }
        for ((f, w), (size, stiffness)) in found.iter().zip(wanted).zip(sizes) {
            let bound = match kernel.precision {
                Precision::Double => {
                    1e-13 * size
                        + (1e-13 + place) * stiffness
                        + off_by_rows(base, species) * (size + n as f64)
                }
                Precision::Mixed => 1e-6 * size + (SEEN + unit) * stiffness + 1e-6,
            };
            prop_assert!(
                (*f - *w).length() <= bound,
                "{:?}: {} against {}, bound {:e}",
                options,
                f,
                w,
                bound
            );
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    #[ignore = "a hundred thousand configurations take some minutes: cargo xtask physics"]
    fn a_hundred_thousand_shapes_agree_with_the_reference(shape in shapes(20.0)) {
        agrees_with_the_reference(&shape)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_shape_agrees_with_the_reference(shape in shapes(20.0)) {
        agrees_with_the_reference(&shape)?;
    }

    #[test]
    fn forces_do_not_depend_on_the_skin_the_order_or_the_place(
        skin in 0.0_f64..1.0,
        shift in prop::array::uniform3(-50.0_f64..50.0),
        stride in 1_usize..500,
    ) {
        let (cell, positions) = liquid([8, 8, 8], 0.8442, 0.15);
        let n = positions.len();
        // A permutation: multiplication by an odd number modulo 512.
        let order: Vec<usize> = (0..n).map(|i| i * (2 * stride + 1) % n).collect();
        let moved: Vec<DVec3> = order.iter().map(|i| positions[*i] + DVec3::from(shift)).collect();
        for kernel in kernels() {
            let get = |skin, at: &[DVec3]| {
                let options = ForceFieldOptions { kernel, neighbor: verlet(Some(skin)), ..ForceFieldOptions::default() };
                all(&mut build(&options, &conditions(cell, n)).unwrap(), cell, at, Want::NOTHING).0
            };
            let wanted = get(0.3, &positions);
            let sizes = magnitudes(&ForceFieldOptions::default(), cell, &positions);
            // Double: shifted coordinates of 60 σ have a last place of 7e-15 each.
            let (relative, here, absolute) = match kernel.precision {
                Precision::Double => (1e-14, 0.0, 2e-14),
                Precision::Mixed => (1e-6, SEEN, SEEN),
            };
            for (i, (a, b)) in get(skin, &positions).iter().zip(&wanted).enumerate() {
                prop_assert!((*a - *b).length() <= relative * sizes[i].0 + here * sizes[i].1);
            }
            for (k, f) in get(skin, &moved).iter().enumerate() {
                let i = order[k];
                let bound = relative * sizes[i].0 + absolute * sizes[i].1;
                prop_assert!((*f - wanted[i]).length() <= bound, "{} against {}", f, wanted[i]);
            }
        }
    }
}
