//! LAMMPS' dumps and data files as start configurations: what is taken, and what is refused and what is the same in both.

use glam::DVec3;
use lennard_io::read_configuration_bytes;

use crate::common::refused;

pub const DUMP: &str = "ITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n3\nITEM: BOX BOUNDS pp pp pp\n-1.0 7.0\n0 8.5\n0.5 9\n\
    ITEM: ATOMS id type x y z ix iy iz vx vy vz\n\
    3 2 1.0 2.0 3.0 0 -1 0 0.3 0 0\n1 1 0.0 1.0 1.5 0 0 0 0.1 0 0\n2 1 6.0 3.0 8.5 1 0 -1 0.2 0 0\n";

pub const DATA: &str = "three atoms of two kinds, written by hand\n\n3 atoms\n2 atom types\n0 bonds\n\n\
    -1.0 7.0 xlo xhi\n0.0 8.5 ylo yhi # a comment\n0.5 9.0 zlo zhi\n0 0 0 xy xz yz\n\n\
    Masses\n\n1 1.0 # Ar\n2 2.5\n\nPair Coeffs # lj/cut\n\n1 1.0 1.0\n2 1.0 1.1\n\n\
    Atoms # atomic\n\n3 2 1.0 2.0 3.0 0 -1 0\n1 1 0.0 1.0 1.5 0 0 0\n2 1 6.0 3.0 8.5 1 0 -1\n\n\
    Velocities\n\n1 0.1 0 0\n2 0.2 0 0\n3 0.3 0 0\n";

#[test]
fn dumps_and_data_files_are_read_from_their_corner_and_in_the_order_of_their_numbers() {
    for text in [DUMP, DATA] {
        let start = read_configuration_bytes(text.as_bytes()).unwrap();
        assert_eq!(start.cell.lengths(), DVec3::new(8.0, 8.5, 8.5));
        let wanted =
            [DVec3::new(1.0, 1.0, 1.0), DVec3::new(15.0, 3.0, -0.5), DVec3::new(2.0, -6.5, 2.5)];
        assert_eq!(start.positions, wanted);
        let velocities = start.velocities.unwrap();
        assert_eq!(velocities.map_x(), [0.1, 0.2, 0.3]);
        let name = |i: usize| start.species.names[start.species.of(i)].as_str();
        assert_eq!([name(0), name(1), name(2)], ["1", "1", "2"]);
    }
    let data = read_configuration_bytes(DATA.as_bytes()).unwrap();
    let heavy = data.species.of(2);
    assert_eq!((data.species.masses[heavy], data.step), (2.5, None));
    assert_eq!(read_configuration_bytes(DUMP.as_bytes()).unwrap().step, Some(7));
}

/// The dump with a tilt of its box along z.
fn tilted(tilt: &str) -> String {
    let bounds = format!("xy xz yz pp pp pp\n-1.0 7.0 0\n0 8.5 {tilt}\n0.5 9 0\n");
    DUMP.replace("pp pp pp\n-1.0 7.0\n0 8.5\n0.5 9\n", &bounds)
}

#[test]
fn a_tilt_that_rounding_has_left_is_none() {
    for text in [tilted("0.0"), tilted("-7.9e-10"), DATA.replace("0 0 0 xy", "3e-14 0 -7.9e-10 xy")]
    {
        let start = read_configuration_bytes(text.as_bytes()).unwrap();
        assert_eq!(start.cell.lengths(), DVec3::new(8.0, 8.5, 8.5));
        assert_eq!(start.positions[0], DVec3::ONE);
    }
}

trait MapX {
    fn map_x(&self) -> Vec<f64>;
}

impl MapX for Vec<DVec3> {
    fn map_x(&self) -> Vec<f64> {
        self.iter().map(|v| v.x).collect()
    }
}

#[test]
fn coordinates_may_be_unwrapped_or_scaled_and_the_last_frame_counts() {
    let frame = |step: u64, columns: &str, row: &str| {
        format!(
            "ITEM: UNITS\nlj\nITEM: TIME\n0.5\nITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n1\n\
             ITEM: BOX BOUNDS pp pp pp\n1 5\n0 8\n0 8\nITEM: ATOMS {columns}\n{row}\n"
        )
    };
    let at = |columns: &str, row: &str| {
        let text = frame(1, "id element x y z", "1 Kr 2 2 2") + &frame(2, columns, row);
        let start = read_configuration_bytes(text.as_bytes()).unwrap();
        assert_eq!((start.step, start.frames, start.velocities), (Some(2), 2, None));
        start.positions[0]
    };
    assert_eq!(at("xu yu zu", "9 -3 4"), DVec3::new(8.0, -3.0, 4.0));
    assert_eq!(at("id xs ys zs", "1 0.25 0.5 1"), DVec3::new(1.0, 4.0, 8.0));
    assert_eq!(at("xsu ysu zsu q", "-0.25 0.5 2 9"), DVec3::new(-1.0, 4.0, 16.0));
    assert_eq!(at("xu yu zu ix iy iz", "9 -3 4 1 1 1"), DVec3::new(8.0, -3.0, 4.0));
}

#[test]
fn labels_name_the_types_of_a_data_file() {
    let text = DATA.replace(
        "Masses\n\n1 1.0 # Ar\n2 2.5\n",
        "Atom Type Labels\n\n1 Ar\n2 Kr\n\nMasses\n\nAr 1.0\nKr 2.5\n",
    );
    // Rows of Masses begin with a letter now, which only sections do.
    refused(read_configuration_bytes(text.as_bytes()), &["the section `Ar 1.0`"]);
    let text = text.replace("\nAr 1.0\nKr 2.5\n", "\n1 1.0\n2 2.5\n");
    let start = read_configuration_bytes(text.as_bytes()).unwrap();
    assert_eq!(start.species.names, ["Kr", "Ar"]);
    assert_eq!(start.species.masses, [2.5, 1.0]);
}
