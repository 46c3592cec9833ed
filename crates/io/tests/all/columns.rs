//! Columns, units and bounds that all readers share: what files of other programs say is read or refused.

use glam::DVec3;
use lennard_io::read_configuration_bytes;

pub const LATTICE: &str = "Lattice=\"4 0 0 0 5 0 0 0 6\"";

/// Two particles under `Properties`.
fn xyz(properties: &str, rows: [&str; 2]) -> String {
    format!(
        "2\n{LATTICE} Properties=species:S:1:pos:R:3:{properties}\nAr 1 2 3 {}\nAr 2 3 4 {}\n",
        rows[0], rows[1]
    )
}

/// A dump of two particles.
pub fn dump(columns: &str, rows: [&str; 2]) -> String {
    format!(
        "ITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 4\n0 5\n0 6\n\
         ITEM: ATOMS id type x y z {columns}\n1 1 1 2 3 {}\n2 1 2 3 4 {}\n",
        rows[0], rows[1]
    )
}

/// A data file of two particles, whose title this is.
pub fn data(title: &str, atoms: [&str; 2], more: &str) -> String {
    format!(
        "{title}\n\n2 atoms\n1 atom types\n0 4 xlo xhi\n0 5 ylo yhi\n0 6 zlo zhi\n\nAtoms # atomic\n\n\
         1 1 {}\n2 1 {}\n\n{more}",
        atoms[0], atoms[1]
    )
}

fn first_velocity(text: &str) -> DVec3 {
    let start = read_configuration_bytes(text.as_bytes()).unwrap_or_else(|e| panic!("{text}\n{e}"));
    assert_eq!(start.momenta, None, "{text}");
    start.velocities.unwrap_or_else(|| panic!("no velocities in {text}"))[0]
}

#[test]
fn velocities_are_read_under_any_usual_name() {
    let v = ["0.5 0 -0.25", "0 0 0"];
    for name in ["velo", "vel", "v", "velocity", "Velocities", "velocities"] {
        assert_eq!(first_velocity(&xyz(&format!("{name}:R:3"), v)), DVec3::new(0.5, 0.0, -0.25));
    }
    for names in [
        ["vx", "vy", "vz"],
        ["vel_x", "vel_y", "vel_z"],
        ["velocity.x", "velocity.y", "velocity.z"],
    ] {
        let properties = names.map(|name| format!("{name}:R:1")).join(":");
        assert_eq!(first_velocity(&xyz(&properties, v)), DVec3::new(0.5, 0.0, -0.25));
        assert_eq!(first_velocity(&dump(&names.join(" "), v)), DVec3::new(0.5, 0.0, -0.25));
    }
}

#[test]
fn momenta_over_masses_are_velocities() {
    for (properties, rows) in [
        ("momenta:R:3:masses:R:1", ["1 0 -0.5 2", "0 0 0 2"]),
        ("masses:R:1:momenta:R:3", ["2 1 0 -0.5", "2 0 0 0"]),
        // Rounded, beside the velocities.
        ("mass:R:1:p:R:3:velo:R:3", ["2 1.00001 0 -0.5 0.5 0 -0.25", "2 0 0 0 0 0 0"]),
    ] {
        assert_eq!(first_velocity(&xyz(properties, rows)), DVec3::new(0.5, 0.0, -0.25));
    }
    let of_dump = dump("mass px py pz", ["2 1 0 -0.5", "2 0 0 0"]);
    assert_eq!(first_velocity(&of_dump), DVec3::new(0.5, 0.0, -0.25));
    // The scene knows the masses that the file does not name.
    let text = xyz("momenta:R:3", ["1 0 -0.5", "0 0 1"]);
    let mut start = read_configuration_bytes(text.as_bytes()).unwrap();
    assert_eq!(start.velocities, None);
    start.take_momenta(|_| 4.0).unwrap();
    assert_eq!(
        start.velocities.unwrap(),
        [DVec3::new(0.25, 0.0, -0.125), DVec3::new(0.0, 0.0, 0.25)]
    );
    let text = xyz("momenta:R:3:vel:R:3", ["1 0 -0.5 1 0 -0.5", "0 0 1 0 0 0.9"]);
    let (found, allowed) =
        read_configuration_bytes(text.as_bytes()).unwrap().take_momenta(|_| 1.0).unwrap_err();
    assert!(found.contains("[0, 0, 0.9]") && found.ends_with("particle 2"), "{found}");
    assert!(allowed.contains("mass times velocity"), "{allowed}");
}

#[test]
fn one_bound_holds_for_positions_velocities_and_masses_in_every_reader() {
    let (row, flags) = (["1 2 3", "2 3 4"], ["0 0 0", "0 0 0"]);
    let velocities = |v: &str| data("two", row, &format!("Velocities\n\n1 0 0 0\n2 0 {v} 0\n"));
    let masses = |m: &str| data("two", row, &format!("Masses\n\n1 {m}\n"));
    let far = |x: &str| {
        [
            (format!("2\n{LATTICE}\nAr 1 2 3\nAr 2 {x} 4\n"), 4),
            (dump("ix iy iz", flags).replace("2 1 2 3 4", &format!("2 1 2 {x} 4")), 11),
            (data("two", ["1 2 3", &format!("2 {x} 4")], ""), 12),
            (format!("4 5 6\n2\n1 1 2 3\n2 2 {x} 4\n"), 4),
        ]
    };
    let mut cases: Vec<(String, u64, &str)> = Vec::new();
    for x in ["1e15", "-1.1e9", "1e300"] {
        cases.extend(far(x).map(|(text, line)| (text, line, "coordinates from -1e9 to 1e9 σ")));
        cases.push((
            xyz("velo:R:3", ["0 0 0", &format!("0 {x} 0")]),
            4,
            "components from -1e9 to 1e9 σ/τ",
        ));
        cases.push((
            dump("vx vy vz", ["0 0 0", &format!("0 {x} 0")]),
            11,
            "components from -1e9 to 1e9 σ/τ",
        ));
        cases.push((velocities(x), 17, "components from -1e9 to 1e9 σ/τ"));
    }
    for flag in ["2147483647", "-2147483648", "300000000"] {
        let rows = format!("0 {flag} 0");
        let last = format!("2 3 4 {rows}");
        cases.push((xyz("map_shift:I:3", ["0 0 0", &rows]), 4, "coordinates from -1e9 to 1e9 σ"));
        cases.push((dump("ix iy iz", ["0 0 0", &rows]), 11, "coordinates from -1e9 to 1e9 σ"));
        cases.push((data("two", ["1 2 3", &last], ""), 12, "coordinates from -1e9 to 1e9 σ"));
    }
    cases.push((
        xyz("map_shift:I:3", ["0 0 0", "0 0 2147483648"]),
        4,
        "an image flag, an integer of 32 bits",
    ));
    cases.push((
        dump("ix iy iz", ["0 0 0", "0 0 2147483648"]),
        11,
        "an image flag, an integer of 32 bits",
    ));
    cases.push((
        data("two", ["1 2 3", "2 3 4 0 0 2147483648"], ""),
        12,
        "an image flag, an integer of 32 bits",
    ));
    for mass in ["0", "-1", "1e308", "1e-308", "-0.0"] {
        cases.push((xyz("mass:R:1", [mass, mass]), 3, "a mass from 1e-6 to 1e6"));
        cases.push((dump("mass", [mass, mass]), 10, "a mass from 1e-6 to 1e6"));
        cases.push((masses(mass), 16, "a mass from 1e-6 to 1e6"));
    }
    for (text, line, allowed) in cases {
        let error = read_configuration_bytes(text.as_bytes()).expect_err(&text);
        let message = error.to_string();
        assert_eq!(error.line(), Some(line), "{text}\n{message}");
        assert!(message.contains(allowed), "wanted `{allowed}` in {message}");
    }
    for (text, _) in far("9e8") {
        read_configuration_bytes(text.as_bytes()).unwrap_or_else(|e| panic!("{text}\n{e}"));
    }
}
