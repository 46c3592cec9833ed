//! The scenes of `inputs/mechanics` against closed forms and solutions of high precision.

use lennard_core::DVec3;
use lennard_engine::{Simulation, StopAt, Unfollowed};
use lennard_observables::Observable;
use lennard_scene::Scene;

use crate::common::{self, ran};

/// A scene of `inputs/mechanics`.
fn scene_of_inputs(name: &str, overrides: &str) -> Scene {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../inputs/mechanics");
    let scene = Scene::load(&root.join(format!("{name}.toml")), &common::pairs(overrides));
    scene.unwrap_or_else(|e| panic!("{e}"))
}

/// The same after its last step.
fn of_inputs(name: &str, overrides: &str) -> Simulation {
    ran(scene_of_inputs(name, overrides))
}

/// The study of mechanics judges orders, energies and rules of these problems. Here, the scenes that come along end as it says.
#[test]
fn scenes_of_pendulums_and_chains_end_at_their_high_precision_solutions() {
    let at = DVec3::new;
    for (name, overrides, body, known, tolerance) in [
        // A whole period by the elliptic integral.
        ("pendulum", "", 1, at(1.0, 0.0, 0.0), 1e-8),
        (
            "double-pendulum",
            "0.00025 4000",
            1,
            at(-0.585_168_391_999, 0.0, -0.810_911_803_469),
            1e-5,
        ),
        (
            "double-pendulum",
            "0.00025 4000",
            2,
            at(-1.444_818_849_943, 0.0, -1.321_794_461_381),
            1e-5,
        ),
        ("chain", "0.000125 4000", 5, at(-0.056_664_541_268, 0.0, -0.975_802_326_581), 1e-4),
    ] {
        let keys = overrides.split_once(' ').map_or(String::new(), |(dt, steps)| {
            format!("integrator.dt={dt} stage.0.steps={steps}")
        });
        let run = of_inputs(name, &keys);
        let x = &run.state.positions;
        assert_eq!(x[0], DVec3::splat(5.0), "the held site stays to the bit");
        assert_eq!(run.state.velocities[0], DVec3::ZERO);
        assert!((x[body] - x[0] - known).length() < tolerance, "{name}: {}", x[body]);
    }
}

#[test]
fn rows_of_balls_part_as_their_rules_have_it() {
    for (name, known, tolerance) in [
        ("cradle", [0.0, 0.0, 0.0, 0.0, 1.0], 0.0),
        ("cradle-hertz", [-0.0711, -0.0303, -0.0145, 0.1270, 0.9888], 2e-4),
        ("cradle-spook", [-0.6, 0.4, 0.4, 0.4, 0.4], 1e-13),
    ] {
        let run = of_inputs(name, "");
        for (v, wanted) in run.state.velocities.iter().zip(known) {
            assert!((v.x - wanted).abs() <= tolerance, "{name}: {v} {wanted}");
        }
    }
    // The first flew 1 σ to the row, and the last as far after it; all else stands where it was hit.
    let run = of_inputs("cradle", "");
    for (x, wanted) in run.state.positions.iter().zip([5.0, 6.0, 7.0, 8.0, 10.0]) {
        assert!((x.x - wanted).abs() < 1e-12, "{x} {wanted}");
    }
}

#[test]
fn a_stack_at_rest_sinks_in_by_the_weight_above_over_the_stiffness() {
    let run = of_inputs("stack", "stage.0.steps=8000");
    let floor = lennard_core::ForceTerm::walls(run.forces.as_ref())[0];
    let z: Vec<f64> = run.state.positions.iter().map(|x| x.z - floor.position).collect();
    let weight = 0.001;
    for i in 0..5 {
        let gap = match i {
            0 => z[0],
            _ => z[i] - z[i - 1] - 1.0,
        };
        let wanted = -weight * (5 - i) as f64;
        assert!((gap / wanted - 1.0).abs() < 1e-6, "{i}: {gap} {wanted}");
        let v = run.state.velocities[i];
        assert!(v.length() < 1e-8, "{v}");
    }
    assert!((floor.force / 5.0 - 1.0).abs() < 1e-6, "{floor:?}");
}

#[test]
fn a_chain_on_a_floor_is_solved_for_with_its_contacts_and_comes_to_rest_flat() {
    let mut run = common::prepared(scene_of_inputs("chain-on-floor", "stage.0.steps=8000"));
    let mut impulses = [0.0; 2];
    for (impulse, step) in impulses.iter_mut().zip([6000, 8000]) {
        let stopped = run.follow(&mut StopAt::new(step));
        stopped.unwrap_or_else(|e| panic!("{e}"));
        let floor = lennard_core::ForceTerm::walls(run.forces.as_ref())[0];
        *impulse = floor.impulse;
        for x in &run.state.positions {
            let depth = floor.position - x.z;
            assert!((depth / 0.001 - 1.0).abs() < 1e-6, "{step}: {depth}");
        }
        for x in run.state.positions.windows(2) {
            let strain = (x[1] - x[0]).length() - 1.0;
            assert!(strain.abs() < 1e-4, "{step}: {strain}");
        }
    }
    let weight = (impulses[1] - impulses[0]) / 10.0;
    assert!((weight / 5.0 - 1.0).abs() < 1e-8, "{weight}");
}

#[test]
fn a_column_that_sweeps_do_not_solve_ends_the_run_and_a_number_of_sweeps_is_taken_as_it_is() {
    let places: Vec<String> = (0..80).map(|i| format!("[10, 10, {i}]")).collect();
    let column = format!(
        "start.positions=[{}] system.box=[20, 20, 100] contact.compliance=0.0 stage.0.steps=10",
        places.join(", ")
    );
    let falling = ["[0, 0, -1]"; 80].join(", ");
    let hitting = format!("{column} start.velocities=[{falling}] contact.compliance=0.001");
    for (column, advice) in [
        (&column, "at rest take `contact.compliance` above 0"),
        (&hitting, "in impacts, which are rigid, say with `contact.sweeps`"),
    ] {
        let mut run = common::prepared(scene_of_inputs("stack-spook", column));
        let words = run.follow(&mut Unfollowed).unwrap_err().to_string();
        let told =
            "80 contacts of bodies that touch each other were not solved for in 20000 sweeps";
        common::contains(&words, &[told, "take `contact.compliance` above 0", advice]);
    }
    for way in ["contact.compliance=0.001", "contact.sweeps=50"] {
        assert_eq!(of_inputs("stack-spook", &format!("{column} {way}")).state.step, 10);
    }
}

#[test]
fn a_ball_that_loses_a_share_at_each_bounce_rises_to_the_squares_of_it() {
    // Under the event rule: after the fall of 2 τ, bounce 2 comes 4·0.9 τ after bounce 1, and the top is as far behind it as 2·0.9² τ.
    let steps = ((2.0 + 3.6 + 2.0 * 0.81) / 0.001_f64).round();
    let run = of_inputs("ball", &format!("stage.0.steps={steps} integrator.dt=0.001"));
    let floor = lennard_core::ForceTerm::walls(run.forces.as_ref())[0].position;
    let height = run.state.positions[0].z - floor;
    assert!((height / (2.0 * 0.81_f64.powi(2)) - 1.0).abs() < 1e-5, "{height}");
}

/// A liquid at constant energy whose force ends smoothly.
const LIQUID: &str = r#"
    system = { n_atoms = 108, density = 0.7, temperature = 1.2 }
    truncation = { kind = "switch", r_cut = 2.2 }
    integrator = { dt = 0.002 }
    stage = [{ name = "production", steps = 500 }]
"#;

fn held_to(simulation: &Simulation) -> f64 {
    let rows = simulation.thermodynamics().series();
    let energies = &rows.conserved_energy;
    energies.iter().map(|e| (e - energies[0]).abs()).fold(0.0, f64::max)
}

#[test]
fn a_fluid_with_held_particles_keeps_its_energy_and_they_their_places() {
    let run = ran(common::scene(LIQUID, "system.held=[2, 3, 50, 108]"));
    let start = common::prepared(common::scene(LIQUID, ""));
    for i in [1, 2, 49, 107] {
        assert_eq!(run.state.positions[i], start.state.positions[i]);
        assert_eq!(run.state.velocities[i], DVec3::ZERO);
    }
    assert_eq!(run.view().n_dof(), 3.0 * 104.0);
    assert!(held_to(&run) < 1e-3, "{}", held_to(&run));
    let found = [run.thermodynamics().finish(0.0)];
    let pressure = common::average(&found, "pressure").unwrap();
    assert!(pressure.doubt.is_some(), "no one pressure with held particles");
}

#[test]
fn molecules_between_walls_that_exert_forces_keep_their_energy_and_their_bonds() {
    let run = ran(common::scene(
        LIQUID,
        r#"system={ n_molecules = 108, density = 0.3, temperature = 1.5 } molecule.bond_length=0.7
            wall=[{ kind = "lennard-jones-9-3" }, { kind = "wca", axis = "x" }]"#,
    ));
    assert_eq!(run.view().n_dof(), 6.0 * 108.0 - 108.0 - 1.0);
    assert!(held_to(&run) < 2e-3, "{}", held_to(&run));
    let residual = run.view().constraint_sums().largest_residual;
    assert!(residual < 1e-10, "{residual}");
}

#[test]
fn a_contact_too_weak_for_its_load_stops_the_run_and_says_who_and_where() {
    let mut run = common::prepared(scene_of_inputs("stack", "contact.stiffness=3.0"));
    let error = run.follow(&mut lennard_engine::Unfollowed).unwrap_err().to_string();
    let words = [
        "particles 0 and 1 overlap by 0.5",
        "half their contact distance",
        "the spring of the contact is too weak for bodies so fast or so heavy",
        "contact.stiffness",
    ];
    common::contains(&error, &words);
}

#[test]
fn sites_that_are_listed_are_not_multiplied_by_the_sites_of_a_molecule() {
    let scene = scene_of_inputs("double-pendulum", "");
    let (n, density) = lennard_engine::size_and_density(&scene).unwrap();
    assert_eq!((n, density), (3, 3.0 / 1000.0));
}
