//! Registers pack the bits of the plain loops.

use super::super::level::{Avx2, Level};
use super::super::motion::{MotionSummary, SlotSpecies, SomeRows};
use super::super::pack::{Threads, pack_double, pack_fixed};
use super::super::row::species_of_fixed;
use super::*;
use lennard_core::PeriodicBox;
use lennard_neighbor::Positions;

/// The level of these tests; says so where this processor lacks it.
#[allow(clippy::print_stdout)]
fn level() -> Option<Level> {
    let level = Avx2::detect().map(Level::Avx2);
    if level.is_none() {
        println!("skipped: this processor has no AVX2");
    }
    level
}

/// Rows, summaries and packed displacements in double precision and in fixed point.
type Packed =
    (Vec<DoubleRow>, MotionSummary, Vec<FixedRow>, MotionSummary, [Vec<PackedDisplacement>; 2]);

/// Species of the slots. Their number is no multiple of four or of a batch, and it gives more than one task.
static SPECIES: [u8; 2307] = {
    let mut species = [0; 2307];
    let mut slot = 0;
    while slot < species.len() {
        species[slot] = (slot % 7) as u8;
        slot += 1;
    }
    species
};

const LENGTHS: DVec3 = DVec3::new(9.0, 8.0, 10.0);

/// Packs particles `shift` boxes away from home, in a box that is `stretch` times the box of the build.
fn packed(level: Level, by: Threads, shift: f64, stretch: DVec3, broken: bool) -> Packed {
    let cell = PeriodicBox::new(LENGTHS).unwrap();
    let n = SPECIES.len();
    let noise = |k: usize| ((k as f64 * 12.9898).sin() * 43_758.545_3).rem_euclid(1.0);
    let start: Vec<DVec3> = (0..n)
        .map(|i| {
            let at = DVec3::new(noise(i), noise(i + 5000), noise(i + 9000));
            let image = if i % 3 == 0 { DVec3::splat(shift) } else { DVec3::NEG_X };
            (at + image) * LENGTHS
        })
        .collect();
    let mut now: Vec<DVec3> = start.clone();
    for (i, r) in now.iter_mut().enumerate() {
        *r *= stretch;
        *r += DVec3::splat(noise(i + 777) - 0.5) * 0.3;
    }
    if broken {
        now[1234].y = f64::NAN;
    }
    let built = |particles: &[u32]| -> Vec<DVec3> {
        particles.iter().map(|p| start[*p as usize]).collect()
    };
    fn motion_of<'a>(
        (positions, stretch): (&'a [DVec3], DVec3),
        order: &'a [u32],
        built: &'a [DVec3],
    ) -> Motion<'a> {
        Motion {
            positions,
            order: Some(order),
            built,
            stretch,
            far2: 0.01,
            lengths: LENGTHS * stretch,
            // Rows with and without species.
            species: (stretch == DVec3::ONE).then_some(SlotSpecies {
                at: &SPECIES,
                paddings: DoubleRow::paddings(Level::Portable),
            }),
        }
    }
    let mut in_bytes =
        [vec![PackedDisplacement::default(); n], vec![PackedDisplacement::default(); n]];
    let mut by_cell = RowTable::default();
    by_cell.sort(&cell, Positions::ById(&start), 2.8).unwrap();
    let at = built(&by_cell.particle);
    let mut double = vec![DoubleRow::default(); by_cell.rows()];
    let moved_double = pack_double(
        level,
        by,
        &by_cell,
        (
            motion_of((&now, stretch), &by_cell.particle, &at),
            SomeRows {
                slots: std::slice::from_ref(&(0..n)),
                ghosts: std::slice::from_ref(&(0..by_cell.ghosts.len())),
            },
        ),
        &mut double,
        Some(&mut in_bytes[0]),
    );
    let mut columns = ColumnTable::default();
    columns.sort(&cell, Positions::ById(&start)).unwrap();
    assert_eq!(columns.is_near_home(), shift.abs() < 1e5);
    let at = built(&columns.particle);
    let mut fixed = vec![FixedRow::default(); n];
    let moved_fixed = pack_fixed(
        level,
        by,
        &columns,
        (
            motion_of((&now, stretch), &columns.particle, &at),
            // The same in two runs, as a rank and its halo are packed.
            SomeRows { slots: &[0..n / 3, n / 3..n], ghosts: &[] },
        ),
        &mut fixed,
        Some(&mut in_bytes[1]),
    );
    if stretch == DVec3::ONE {
        for (slot, species) in SPECIES.iter().enumerate() {
            let row = double[by_cell.row[slot] as usize];
            let named = [row.species_by_lowest_bits(), species_of_fixed(&fixed[slot])];
            assert_eq!(named, [usize::from(*species); 2]);
        }
    }
    (double, moved_double, fixed, moved_fixed, in_bytes)
}

/// The bits of everything, so that NaN equals itself.
fn bits((double, moved_double, fixed, moved_fixed, in_bytes): Packed) -> impl PartialEq {
    let double: Vec<[u64; 4]> = double.iter().map(|r| r.0.map(f64::to_bits)).collect();
    let bits = |m: MotionSummary| (m.largest2.to_bits(), m.finite, m.far);
    // A displacement that is not finite has packed components without a meaning.
    let in_bytes = in_bytes.map(|mut in_bytes| {
        in_bytes.retain(|packed| packed.square < 255);
        in_bytes
    });
    (double, bits(moved_double), fixed, bits(moved_fixed), in_bytes)
}

#[test]
fn registers_pack_the_same_bits_as_plain_loops() {
    let Some(level) = level() else { return };
    let stretched = DVec3::new(1.01, 0.99, 1.003);
    for (shift, stretch) in [
        (0.0, DVec3::ONE),
        (3.0, DVec3::ONE),
        (-3e6, DVec3::ONE),
        (0.0, stretched),
        (3.0, stretched),
    ] {
        for broken in [false, true] {
            let plain = packed(Level::Portable, Threads::All, shift, stretch, broken);
            for moved in [&plain.1, &plain.3] {
                assert_eq!(moved.finite, !broken);
                assert!(!moved.far.is_empty() && moved.largest2 > 0.06);
                assert!(moved.far.is_sorted());
            }
            let plain = bits(plain);
            for by in [Threads::One, Threads::All] {
                let found = bits(packed(level, by, shift, stretch, broken));
                assert!(found == plain, "{shift} boxes away, {by:?}, broken: {broken}");
            }
        }
    }
}
