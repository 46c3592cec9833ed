//! Starts with a crystal beside its liquid, and runs of them.

use lennard_engine::Simulation;
use lennard_observables::{Remark, solid_share};

use crate::common::{self, prepared};

const CRYSTAL: &str = r#"
    system = { n_atoms = 700, temperature = 1.0, seed = 7 }
    start = { kind = "half-crystal", cells = 4, layers = 6 }
    truncation = { r_cut = 2.5 }
    integrator = { dt = 0.004 }
    stage = [{ name = "production", steps = 120, thermostat = "bussi" }]
    observable = [{ kind = "bond-order", every = 4 }]
    output = { thermo_every = 10 }
"#;

/// A barostat at a pressure with a coupling of the sides.
fn held(pressure: &str, coupling: &str) -> String {
    let kind = "stochastic-cell-rescaling";
    format!(
        "stage.production.barostat={{ kind = {kind:?}, pressure = {pressure}, coupling = {coupling:?} }}"
    )
}

fn build(overrides: &str) -> Simulation {
    prepared(common::scene(CRYSTAL, &format!("{} {overrides}", held("4.0", "z"))))
}

#[test]
fn half_a_crystal_has_its_particles_its_cross_section_and_no_overlap() {
    let s = build("");
    let start = *s.scene.half_crystal().unwrap();
    assert_eq!((s.state.len(), start.n_crystal()), (700, 384));
    // The lines of Mastny and de Pablo at T = 1.
    assert!((start.crystal_density - 1.00628).abs() < 1e-5);
    assert!((start.liquid_density - 0.91857).abs() < 1e-5);
    let sides = s.state.cell.lengths();
    assert!((sides.x - 4.0 * (4.0 / 1.00628_f64).cbrt()).abs() < 1e-4 && sides.x == sides.y);
    let length = start.crystal_length() + start.liquid_length();
    assert!((sides.z - length).abs() < 1e-9);
    // Relaxed: nothing is nearer than U = 30 ε allows, and more than half of the particles are no crystal.
    let positions = &s.state.positions;
    for (i, a) in positions.iter().enumerate() {
        for b in &positions[..i] {
            let distance = s.state.cell.minimum_image(*a - *b).length();
            assert!(distance > 0.85, "{distance}");
        }
    }
    let share = solid_share(&s.state.cell, positions);
    assert!((0.35..0.75).contains(&share), "{share}");
}

#[test]
fn hot_crystals_melt_and_their_fronts_go_back() {
    let mut s = build(
        "system.temperature=1.5 start.crystal_density=1.0063
        start.liquid_density=0.9186 stage.production.steps=1500",
    );
    common::follow(&mut s);
    let findings = s.findings();
    let front = common::average(&findings, "front_velocity").unwrap();
    assert!(front.estimate.mean < 0.0, "{front:?}");
    assert_eq!(common::average(&findings, "speed_of_sound"), None);
    let remarks: Vec<&Remark> = findings.iter().flat_map(|f| &f.remarks).collect();
    let told = remarks.iter().any(|r| matches!(r, Remark::Fronts(_)));
    assert!(told, "{remarks:?}");
}

#[test]
fn the_cross_section_may_change_beside_a_crystal_and_not_in_a_fluid() {
    assert_eq!(build(&held("4.0", "xy-z")).state.len(), 700);
    let start = "start = { kind = \"half-crystal\", cells = 4, layers = 6 }";
    let fluid = CRYSTAL.replace(start, "");
    let held = held("1.0", "xy-z");
    let as_fluid = format!("system.n_atoms=864 system.density=0.8 {held}");
    let error = common::refused(lennard_engine::prepare(common::scene(&fluid, &as_fluid)));
    common::contains(&error, &["has no stiffness of shape"]);
}
