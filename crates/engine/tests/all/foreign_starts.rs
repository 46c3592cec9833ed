//! Starts from files of other programs: velocities, species and units come through to the forces.

use std::fmt::Write as _;
use std::path::Path;

use lennard_core::{DVec3, Momentum};
use lennard_engine::{Simulation, evaluate_energy, prepare};
use lennard_scene::Scene;

use crate::common;

const SIDE: f64 = 5.2;

/// A simple cubic start of 64 particles, each line by `row` of its number and place.
fn rows(mut row: impl FnMut(&mut String, usize, DVec3)) -> String {
    let mut text = String::new();
    for i in 0..64 {
        let cell = DVec3::new((i / 16) as f64, (i / 4 % 4) as f64, (i % 4) as f64);
        row(&mut text, i, (cell + 0.5) * SIDE / 4.0);
    }
    text
}

/// A momentum, m σ/τ, of a total of zero.
fn momentum(i: usize) -> DVec3 {
    let sign = if i.is_multiple_of(2) { 1.0 } else { -1.0 };
    sign * DVec3::new(0.5, 0.25, -1.0) * (1 + i / 2 % 3) as f64
}

fn xyz(properties: &str, row: impl Fn(usize) -> String) -> String {
    let header = format!(
        "64\nLattice=\"{SIDE} 0 0 0 {SIDE} 0 0 0 {SIDE}\" Properties=species:S:1:pos:R:3:{properties}\n"
    );
    let element = |i: usize| if i % 4 < 2 { "Ar" } else { "Kr" };
    let line = |text: &mut String, i: usize, r: DVec3| {
        writeln!(text, "{} {} {} {} {}", element(i), r.x, r.y, r.z, row(i)).unwrap();
    };
    header + &rows(line)
}

fn dump(elements: [&str; 2]) -> String {
    let header = format!(
        "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n64\nITEM: BOX BOUNDS pp pp pp\n0 {SIDE}\n0 {SIDE}\n0 {SIDE}\n\
         ITEM: ATOMS id type element x y z\n"
    );
    let line = |text: &mut String, i: usize, r: DVec3| {
        let kind = i % 2;
        writeln!(text, "{} {} {} {} {} {}", i + 1, kind + 1, elements[kind], r.x, r.y, r.z)
            .unwrap();
    };
    header + &rows(line)
}

fn scene_of(path: &Path, more: &str) -> Scene {
    let text = format!(
        "[system]\ntemperature = 1.0\nseed = 5\n[start]\nkind = \"file\"\nfile = {path:?}\n{more}\n\
         [[stage]]\nname = \"production\"\nsteps = 10\n"
    );
    common::scene(&text, "")
}

const MIXTURE: &str = "[mixing]\nrule = \"lorentz-berthelot\"\n[[species]]\nname = \"Ar\"\nmass = 2.0\n\
    [[species]]\nname = \"Kr\"\nepsilon = 0.5\nmass = 4.0\n";

fn temperature(simulation: &Simulation) -> f64 {
    let (system, state) = (&simulation.system, &simulation.state);
    system.temperature(&state.velocities, Momentum::Conserved)
}

#[test]
fn momenta_over_the_masses_of_the_scene_are_the_velocities_of_the_start() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("momenta.xyz");
    let with = |i: usize| {
        let p = momentum(i);
        format!("{} {} {}", p.x, p.y, p.z)
    };
    std::fs::write(&path, xyz("momenta:R:3", with)).unwrap();
    let simulation = common::prepared(scene_of(&path, MIXTURE));
    let mass = |i: usize| if i % 4 < 2 { 2.0 } else { 4.0 };
    let twice_kinetic: f64 = (0..64).map(|i| momentum(i).length_squared() / mass(i)).sum();
    let wanted = twice_kinetic / (3.0 * 63.0);
    assert!((temperature(&simulation) / wanted - 1.0).abs() < 1e-12, "{wanted}");
    assert_eq!(simulation.state.velocities[2], momentum(2) / 4.0);
    let drawn = |s: &Simulation| s.remarks.iter().any(|r| r.contains("has no velocities"));
    assert!(!drawn(&simulation), "{:?}", simulation.remarks);

    // Velocities beside them that are others.
    let twice = |i: usize| format!("{} {}", with(i), with(i));
    std::fs::write(&path, xyz("momenta:R:3:velo:R:3", twice)).unwrap();
    let refused = common::refused(prepare(scene_of(&path, MIXTURE)));
    common::contains(&refused, &["beside the momentum", "particle 1 of"]);

    // Without any, the run says in its first lines that it draws them.
    std::fs::write(&path, xyz("tag:I:1", |_| "0".to_owned())).unwrap();
    let simulation = common::prepared(scene_of(&path, MIXTURE));
    assert!((temperature(&simulation) - 1.0).abs() < 1e-12);
    let wanted = "momenta.xyz has no velocities: they are drawn at T = 1 with seed 5";
    assert!(simulation.remarks[0].ends_with(wanted), "{:?}", simulation.remarks);
}

#[test]
fn types_of_a_dump_tell_species_apart_where_elements_do_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("start.lammpstrj");
    let energy = |elements: [&str; 2], more: &str| {
        std::fs::write(&path, dump(elements)).unwrap();
        evaluate_energy(&scene_of(&path, more))
            .map(|e| e.report.potential_energy)
            .map_err(|e| e.to_string())
    };
    let named = energy(["Ar", "Kr"], MIXTURE).unwrap();
    assert_eq!(energy(["C", "C"], MIXTURE), Ok(named));
    assert_eq!(energy(["Ar", "Ar"], MIXTURE), Ok(named));
    let turned = energy(["Kr", "Ar"], MIXTURE).unwrap();
    assert!((turned / named - 1.0).abs() < 1e-12, "each species has half of the sites");
    assert!(energy(["C", "N"], MIXTURE).unwrap_err().contains("species \"C\""));
    assert!(energy(["C", "C"], "").unwrap_err().contains("types 1, 2 in"));
}
