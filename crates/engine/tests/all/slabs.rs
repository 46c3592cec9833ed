//! Starts as a slab of liquid beside its vapor, and runs of them.

use lennard_engine::{Simulation, Unfollowed, start};
use lennard_observables::{Findings, Remark};

use crate::common::{self, prepared};

const SLAB: &str = r#"
    system = { n_atoms = 700, temperature = 0.8, seed = 7 }
    start = { kind = "slab" }
    truncation = { kind = "shift", r_cut = 2.5 }
    integrator = { dt = 0.004 }
    stage = [{ name = "production", steps = 120, thermostat = "bussi" }]
    observable = [{ kind = "interface", every = 4 }]
    output = { thermo_every = 7 }
"#;

fn build(overrides: &str) -> Simulation {
    prepared(common::scene(SLAB, overrides))
}

#[test]
fn a_slab_has_its_particles_its_two_densities_and_no_overlap() {
    for n in ["300", "701", "1500"] {
        let scene = common::scene(SLAB, &format!("system.n_atoms={n}"));
        let slab = *scene.slab().unwrap();
        let beginning = start(&scene).unwrap();
        let n: usize = n.parse().unwrap();
        assert_eq!(beginning.positions.len(), n);
        let sides = beginning.cell.lengths();
        // The saturation of Vrabec et al. 2006, and the default proportions.
        assert!((slab.liquid_density - 0.73021).abs() < 1e-4);
        assert!((slab.vapor_density - 0.019782).abs() < 1e-4);
        assert!((slab.thickness / sides.x - 1.5).abs() < 1e-9 && sides.x == sides.y);
        assert!((sides.z / slab.thickness - 3.0).abs() < 1e-9);
        let in_liquid = beginning
            .positions
            .iter()
            .filter(|r| (r.z - 0.5 * sides.z).abs() < 0.5 * slab.thickness)
            .count();
        let density = in_liquid as f64 / (sides.x * sides.y * slab.thickness);
        assert!((density - slab.liquid_density).abs() < 1.0 / slab.area());
        let vapor = slab.vapor_density * sides.x * sides.y * (sides.z - slab.thickness);
        assert!(((n - in_liquid) as f64 - vapor).abs() <= 0.5);
        for (i, a) in beginning.positions.iter().enumerate() {
            for b in &beginning.positions[..i] {
                let distance = beginning.cell.minimum_image(*a - *b).length();
                assert!(distance > 0.8, "{distance}");
            }
        }
    }
}

/// The potential that is shifted, and the full one with its tail as a force.
const TAILS: [&str; 2] = ["", "truncation.kind=cut truncation.tail_correction=planar"];

#[test]
fn the_planar_tail_is_conserved_with_the_rest_and_keeps_the_middle_of_the_box() {
    let steps = "stage.production.thermostat=none stage.production.steps=400 integrator.dt=0.002";
    let mut s = build(&format!("{} {steps}", TAILS[1]));
    assert!(s.tail().is_none(), "no number is added to means");
    s.follow(&mut Unfollowed).unwrap_or_else(|e| panic!("{e}"));
    let start = s.stage_run().start_energy;
    let want = lennard_core::Want::ENERGY_AND_VIRIAL;
    let mut forces = vec![lennard_core::DVec3::ZERO; s.state.len()];
    let at = lennard_core::Configuration::at_rest(&s.state.cell, &s.state.positions);
    let found = s.forces.evaluate(at, lennard_core::Part::All, want, &mut forces).unwrap();
    s.state.energetics = found;
    let now = s.conserved_energy_per_particle().unwrap();
    // A tail that were left out of the energy would show with some 0.1.
    assert!((now - start).abs() < 2e-4, "{now} {start}");
    let momentum = s.system.momentum(&s.state.velocities);
    assert!(momentum.length() < 1e-9, "{momentum}");
}

#[test]
fn a_study_of_homogeneous_fluids_refuses_a_planar_tail() {
    let scene = common::scene(SLAB, TAILS[1]);
    let text = scene.homogeneous_for("lennard study bench").unwrap_err().to_string();
    assert!(text.contains("`truncation.tail_correction` does not go with `lennard study bench`"));
    assert!(text.contains("allowed: a homogeneous fluid, with true or false"), "{text}");
}

#[test]
fn means_of_one_phase_are_left_out_of_a_slab_and_told_by_name() {
    let told = |overrides: &str| {
        let both = r#"observable=[{ kind = "interface" }, { kind = "rdf" }]"#;
        common::ran(common::scene(SLAB, &format!("{both} {overrides}"))).findings()
    };
    let has = |findings: &[Findings], name: &str| common::average(findings, name).is_some();
    for (overrides, is_planar) in [(TAILS[0], false), (TAILS[1], true)] {
        let findings = told(overrides);
        for name in lennard_observables::response_functions() {
            assert!(!has(&findings, name), "{name}");
        }
        assert!(!has(&findings, "two_body_entropy"));
        assert!(has(&findings, "potential_energy"));
        // U without a tail that is among the forces is no number of the run.
        for name in ["potential_energy_without_tail", "pressure_without_tail"] {
            assert_eq!(has(&findings, name), !is_planar, "{name}");
            let mut columns = findings[0].tables.iter().flat_map(|t| &t.columns);
            assert_eq!(columns.any(|c| c.name == name), !is_planar, "{name}");
        }
        let remarks: Vec<&Remark> = findings.iter().flat_map(|f| &f.remarks).collect();
        let left_out = remarks.iter().filter_map(|r| match r {
            Remark::LeftOut { quantities, .. } => Some(quantities),
            _ => None,
        });
        let left_out: Vec<_> = left_out.collect();
        assert_eq!(left_out.len(), 1 + usize::from(is_planar), "{remarks:?}");
        assert!(left_out[0].contains(&"heat_capacity".to_owned()), "{remarks:?}");
        assert!(left_out[0].contains(&"two_body_entropy".to_owned()), "{remarks:?}");
        assert!(!remarks.iter().any(|r| matches!(r, Remark::HeatCapacity { .. })));
    }
}
