//! Extended XYZ written and read back.

use crate::common::{cell, frames_of, refused, scratch, system};
use glam::DVec3;
use lennard_core::{PeriodicBox, Species, SpeciesTable, State};
use lennard_io::{
    Beside, Frame, FrameStyle, TrajectoryFormat, TrajectoryWriter, WriteError, read_configuration,
    read_configuration_in, write_frame,
};
use proptest::prelude::*;

fn style() -> FrameStyle {
    FrameStyle::default()
}

fn frame(state: &State) -> Frame<'_> {
    Frame { state, extra: &[] }
}

fn text_of(style: &FrameStyle, frame: &Frame<'_>) -> String {
    let (_folder, path) = scratch("f.xyz");
    write_frame(&path, style, frame).unwrap();
    std::fs::read_to_string(path).unwrap()
}

fn two_particles() -> State {
    let cell = PeriodicBox::new(DVec3::new(4.0, 5.0, 6.5)).unwrap();
    let positions = vec![DVec3::new(0.1, -1.0, 13.25), DVec3::new(1.0, 2.0, 3.0)];
    let velocities = vec![DVec3::new(1e-7, -2.5, 0.0), DVec3::new(0.0, 1e22, -0.1)];
    let mut state = State::new(cell, positions, velocities);
    state.forces = vec![DVec3::new(48.0, 0.0, -24.0), DVec3::new(-48.0, 0.0, 24.0)];
    (state.step, state.time) = (100, 0.5);
    state
}

#[test]
fn the_dialect_is_written_byte_for_byte() {
    let state = two_particles();
    let extra = [("potential_energy", -5.5), ("temperature", 1.0)];
    let frame = Frame { extra: &extra, ..frame(&state) };
    assert_eq!(
        text_of(&style(), &frame),
        "2\n\
         Lattice=\"4.0 0.0 0.0 0.0 5.0 0.0 0.0 0.0 6.5\" \
         Properties=species:S:1:pos:R:3:velo:R:3:map_shift:I:3 pbc=\"T T T\" \
         Time=0.5 Step=100 potential_energy=-5.5 temperature=1.0 units=lj\n\
         Ar 0.1 4.0 0.25 1e-7 -2.5 0.0 0 -1 2\n\
         Ar 1.0 2.0 3.0 0.0 1e+22 -0.1 0 0 0\n"
    );
    let other = FrameStyle {
        species: named("X"),
        velocities: false,
        forces: true,
        wrapped: false,
        length_scale: 2.0,
        ..FrameStyle::default()
    };
    assert_eq!(
        text_of(&other, &self::frame(&state)),
        "2\n\
         Lattice=\"8.0 0.0 0.0 0.0 10.0 0.0 0.0 0.0 13.0\" \
         Properties=species:S:1:pos:R:3:forces:R:3 pbc=\"T T T\" \
         Time=0.5 Step=100 units=lj length_scale=2.0\n\
         X 0.2 -2.0 26.5 24.0 0.0 -12.0\n\
         X 2.0 4.0 6.0 -24.0 0.0 12.0\n"
    );
}

#[test]
fn the_same_bytes_are_written_for_any_number_of_threads() {
    let state = system(20_000, 2.0, 2);
    let text = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
            .install(|| text_of(&style(), &frame(&state)))
    };
    let one = text(1);
    assert_eq!(one.lines().count(), 20_002);
    for threads in [2, 3, 8] {
        assert!(text(threads) == one, "{threads} threads");
    }
}

/// One unit in the last place of x.
fn ulp(x: f64) -> f64 {
    x.abs().next_up() - x.abs()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn wrapped_positions_read_back_within_the_rounding_that_is_stated(
        seed in any::<u64>(), reach in 0.5_f64..1e6,
    ) {
        let state = system(50, reach, seed);
        let text = text_of(&style(), &frame(&state));
        let read = frames_of(text.as_bytes()).unwrap();
        for (written, read) in state.positions.iter().zip(&read[0].positions) {
            for axis in 0..3 {
                let (w, r, side) = (written[axis], read[axis], cell().lengths()[axis]);
                prop_assert!((w - r).abs() <= ulp(w).max(ulp(side)), "{w} {r}");
                // Away from the faces only −L/2 < r < 0 loses bits.
                let from_face = (w / side - (w / side).round()).abs();
                if from_face > 1e-6 && !(-0.5 * side..0.0).contains(&w) {
                    prop_assert_eq!(w.to_bits(), r.to_bits());
                }
            }
        }
        prop_assert_eq!(read[0].velocities.as_ref(), Some(&state.velocities));
    }

    #[test]
    fn a_length_scale_is_taken_out_again_within_rounding(seed in any::<u64>(), scale in 1e-3_f64..1e3) {
        let style = FrameStyle { length_scale: scale, wrapped: false, forces: true, ..style() };
        let state = system(20, 3.0, seed);
        let text = text_of(&style, &frame(&state));
        let read = frames_of(text.as_bytes()).unwrap();
        // One multiplication and one division round once each, by at most half a unit in the last place.
        let close = |a: DVec3, b: DVec3| (a - b).abs().cmple(2.0 * f64::EPSILON * a.abs()).all();
        let read = &read[0];
        for i in 0..20 {
            prop_assert!(close(state.positions[i], read.positions[i]));
            prop_assert!(close(state.velocities[i], read.velocities.as_ref().unwrap()[i]));
            prop_assert!(close(state.forces[i], read.forces.as_ref().unwrap()[i]));
        }
        prop_assert!(close(cell().lengths(), read.cell.unwrap().lengths()));
    }
}

#[test]
fn a_start_configuration_is_the_last_frame() {
    let (_folder, path) = scratch("t.xyz");
    let mut writer = TrajectoryWriter::create(&path, TrajectoryFormat::Xyz, &style()).unwrap();
    for seed in 0..3 {
        let mut state = system(10, 0.9, seed);
        state.step = seed;
        writer.write(&frame(&state)).unwrap();
    }
    writer.sync().unwrap();
    let start = read_configuration(&path).unwrap();
    assert_eq!(start.step, Some(2));
    assert_eq!(start.velocities.unwrap(), system(10, 0.9, 2).velocities);
    // A box beside the file is for a file without one.
    let other = PeriodicBox::new(DVec3::splat(20.0)).unwrap();
    let beside = Beside { cell: Some(other), ..Beside::default() };
    assert_eq!(read_configuration_in(&path, beside).unwrap().cell, cell());
}

#[test]
fn numbers_that_are_not_finite_are_never_written() {
    let (_folder, path) = scratch("t.xyz");
    let mut writer = TrajectoryWriter::create(&path, TrajectoryFormat::Xyz, &style()).unwrap();
    writer.write(&frame(&system(5000, 1.0, 0))).unwrap();
    let before = std::fs::read(&path).unwrap();
    for bad in [f64::NAN, f64::INFINITY] {
        let mut state = system(5000, 1.0, 0);
        state.velocities[4321].y = bad;
        state.velocities[4999].y = bad;
        let error = writer.write(&frame(&state)).unwrap_err();
        assert!(
            matches!(error, WriteError::NotFinite { quantity: "velocity", particle: 4321, .. }),
            "{error}"
        );
    }
    let mut state = system(5, 1.0, 0);
    state.positions[3].x = 1e200;
    let error = writer.write(&frame(&state)).unwrap_err();
    assert!(matches!(error, WriteError::NotFinite { particle: 3, .. }));
    state.positions[3].x = 0.0;
    state.time = f64::NAN;
    assert!(writer.write(&frame(&state)).is_err());
    assert!(std::fs::read(&path).unwrap() == before);
}

fn named(element: &str) -> SpeciesTable {
    let species = Species { element: element.to_owned(), ..Species::unnamed() };
    SpeciesTable::one(species, 0)
}

/// A mixture comes back with names, species and masses of its particles; its header says which element is which species.
#[test]
fn a_mixture_is_written_with_elements_and_masses_and_read_back() {
    let (_folder, path) = scratch("t.xyz");
    let species = |name: &str, element: &str, mass| Species {
        name: name.to_owned(),
        element: element.to_owned(),
        mass,
    };
    let all = [species("A", "Ar", 1.0), species("big", "Kr", 2.5)];
    let style = FrameStyle {
        species: SpeciesTable::new(all, &[1, 0]),
        velocities: false,
        wrapped: false,
        ..style()
    };
    let state = two_particles();
    let text = text_of(&style, &frame(&state));
    assert!(text.contains(" species_names=\"Ar=A Kr=big\" units=lj\n"), "{text}");
    assert!(text.contains("Properties=species:S:1:pos:R:3:masses:R:1 "), "{text}");
    assert!(text.contains("\nKr ") && text.contains(" 2.5\nAr "), "{text}");
    write_frame(&path, &style, &frame(&state)).unwrap();
    let found = read_configuration(&path).unwrap().species;
    assert_eq!(found.names, ["Kr", "Ar"]);
    assert_eq!(found.of_particle, [0, 1]);
    assert_eq!(found.masses, [2.5, 1.0]);
    let short = FrameStyle { species: SpeciesTable::new(style.species.all(), &[1]), ..style };
    refused(write_frame(&path, &short, &frame(&state)), &["1 for 2 particles"]);
}

#[test]
fn what_readers_would_take_for_something_else_is_refused() {
    let (folder, path) = scratch("t.xyz");
    let state = two_particles();
    for element in ["", "LJ", "ar", "Ar ", "1"] {
        let style = FrameStyle { species: named(element), ..style() };
        refused(
            TrajectoryWriter::create(&path, TrajectoryFormat::Xyz, &style),
            &["chemical symbol"],
        );
    }
    for key in ["energy", "Lattice", "a b", "", "1st", "a=b"] {
        let extra = [(key, 1.0)];
        let frame = Frame { extra: &extra, ..frame(&state) };
        assert!(write_frame(&path, &style(), &frame).is_err(), "{key}");
    }
    let empty = State::new(state.cell, vec![], vec![]);
    assert!(write_frame(&path, &style(), &self::frame(&empty)).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn sites_of_molecules_carry_the_number_of_their_molecule() {
    let cell = PeriodicBox::new(DVec3::splat(9.0)).unwrap();
    let state = State::new(cell, vec![DVec3::ONE; 5], vec![DVec3::ZERO; 5]);
    let style = FrameStyle { sites_per_molecule: 2, ..style() };
    let text = text_of(&style, &frame(&state));
    let header = text.lines().nth(1).unwrap();
    assert!(header.contains("map_shift:I:3:molecule:I:1 "), "{header}");
    let numbers: Vec<&str> = text.lines().skip(2).map(|l| l.rsplit(' ').next().unwrap()).collect();
    assert_eq!(numbers, ["1", "1", "2", "2", "3"]);
}
