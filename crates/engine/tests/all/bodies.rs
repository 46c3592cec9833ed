//! The scenes of `inputs/mechanics` against closed forms and solutions of high precision.

use lennard_core::DVec3;
use lennard_engine::{Simulation, StopAt, Unfollowed};
use lennard_observables::Observable;
use lennard_scene::Scene;

use crate::common::{self, ran};

/// A scene of `inputs/mechanics`.
fn scene_of_inputs(name: &str, overrides: &[(&str, &str)]) -> Scene {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../inputs/mechanics");
    let owned = |(key, value): &(&str, &str)| ((*key).to_owned(), (*value).to_owned());
    let overrides: Vec<_> = overrides.iter().map(owned).collect();
    let scene = Scene::load(&root.join(format!("{name}.toml")), &overrides);
    scene.unwrap_or_else(|e| panic!("{e}"))
}

/// The same after its last step.
fn of_inputs(name: &str, overrides: &[(&str, &str)]) -> Simulation {
    ran(scene_of_inputs(name, overrides))
}

/// The errors of the last position over a step, half of it and a quarter, against what is known.
fn errors(name: &str, dt: f64, steps: u64, body: usize, from_pivot: DVec3) -> [f64; 3] {
    [1, 2, 4].map(|finer| {
        let dt = (dt / f64::from(finer)).to_string();
        let steps = (steps * u64::from(finer as u32)).to_string();
        let run = of_inputs(name, &[("integrator.dt", &dt), ("stage.0.steps", &steps)]);
        let x = &run.state.positions;
        assert_eq!(x[0], DVec3::splat(5.0), "the held site stays to the bit");
        assert_eq!(run.state.velocities[0], DVec3::ZERO);
        (x[body] - x[0] - from_pivot).length()
    })
}

/// Whether errors fall by 4 as the step is halved.
fn is_of_order_two([coarse, fine, finest]: [f64; 3]) -> bool {
    [coarse / fine, fine / finest].iter().all(|ratio| (ratio / 4.0 - 1.0).abs() < 0.05)
}

#[test]
fn a_pendulum_has_the_period_of_the_elliptic_integral() {
    // At the turning point an error of the period is of second order: a quarter of a period shows it better.
    const PERIOD: f64 = 2.367_841_947_576_2;
    let run = of_inputs("pendulum", &[]);
    assert!((run.state.time - PERIOD).abs() < 1e-12);
    assert!((run.state.positions[1] - DVec3::new(6.0, 5.0, 5.0)).length() < 1e-8);
    let below = DVec3::new(0.0, 0.0, -1.0);
    let quarter = errors("pendulum", PERIOD / 400.0, 100, 1, below);
    assert!(is_of_order_two(quarter), "{quarter:?}");
    assert!(quarter[2] < 1e-5, "{quarter:?}");
    // The bond has its length at any time.
    let d = run.state.positions[1] - run.state.positions[0];
    assert!((d.length() - 1.0).abs() < 1e-14);
}

#[test]
fn a_double_pendulum_meets_its_high_precision_solution_with_order_two() {
    let inner = DVec3::new(-0.585_168_391_999, 0.0, -0.810_911_803_469);
    let outer = DVec3::new(-1.444_818_849_943, 0.0, -1.321_794_461_381);
    for (body, known) in [(1, inner), (2, outer)] {
        let found = errors("double-pendulum", 0.001, 1000, body, known);
        assert!(is_of_order_two(found) && found[2] < 1e-5, "{found:?}");
    }
}

#[test]
fn a_chain_meets_its_high_precision_solution_with_order_two() {
    let end = DVec3::new(-0.056_664_541_268, 0.0, -0.975_802_326_581);
    let found = errors("chain", 0.0005, 1000, 5, end);
    assert!(is_of_order_two(found) && found[2] < 1e-4, "{found:?}");
}

fn speeds(run: &Simulation) -> Vec<f64> {
    run.state.velocities.iter().map(|v| v.x).collect()
}

#[test]
fn the_last_ball_of_a_hard_cradle_flies_off_alone() {
    let run = of_inputs("cradle", &[]);
    assert_eq!(speeds(&run), [0.0, 0.0, 0.0, 0.0, 1.0]);
    // The first flew 1 σ to the row, and the last as far after it; all else stands where it was hit.
    let x: Vec<f64> = run.state.positions.iter().map(|x| x.x).collect();
    for (x, wanted) in x.iter().zip([5.0, 6.0, 7.0, 8.0, 10.0]) {
        assert!((x - wanted).abs() < 1e-12, "{x} {wanted}");
    }
}

#[test]
fn balls_by_hertz_share_the_momentum_of_a_hit() {
    let run = of_inputs("cradle-hertz", &[]);
    for (v, wanted) in speeds(&run).iter().zip([-0.0711, -0.0303, -0.0145, 0.1270, 0.9888]) {
        assert!((v - wanted).abs() < 2e-4, "{v} {wanted}");
    }
    let energy: f64 = run.state.velocities.iter().map(|v| v.length_squared()).sum();
    assert!((energy - 1.0).abs() < 1e-6, "{energy}");
}

#[test]
fn a_stack_at_rest_sinks_in_by_the_weight_above_over_the_stiffness() {
    let run = of_inputs("stack", &[("stage.0.steps", "8000")]);
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
fn a_stack_of_spook_carries_its_weight_and_sinks_in_by_the_compliance_times_its_forces() {
    let mut run = common::prepared(scene_of_inputs("stack-spook", &[("stage.0.steps", "18000")]));
    let mut impulses = [0.0; 2];
    for (impulse, step) in impulses.iter_mut().zip([16_000, 18_000]) {
        let stopped = run.follow(&mut StopAt::new(step));
        stopped.unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(run.state.step, step);
        let floor = lennard_core::ForceTerm::walls(run.forces.as_ref())[0];
        *impulse = floor.impulse;
        let x = &run.state.positions;
        for i in 0..5 {
            let gap = match i {
                0 => x[0].z - floor.position,
                _ => x[i].z - x[i - 1].z - 1.0,
            };
            let wanted = -0.001 * (5 - i) as f64;
            assert!((gap / wanted - 1.0).abs() < 1e-8, "{i}: {gap} {wanted}");
            let v = run.state.velocities[i];
            assert!(v.length() < 1e-8, "{v}");
        }
    }
    // 2000 steps of 0.005 τ.
    let weight = (impulses[1] - impulses[0]) / 10.0;
    assert!((weight / 5.0 - 1.0).abs() < 1e-10, "{weight}");
}

#[test]
fn a_chain_on_a_floor_is_solved_for_with_its_contacts_and_comes_to_rest_flat() {
    let mut run = common::prepared(scene_of_inputs("chain-on-floor", &[("stage.0.steps", "8000")]));
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
    let column = [
        ("start.positions", format!("[{}]", places.join(", "))),
        ("system.box", "[20, 20, 100]".to_owned()),
        ("contact.compliance", "0.0".to_owned()),
        ("stage.0.steps", "10".to_owned()),
    ];
    let mut column: Vec<(&str, &str)> = column.iter().map(|(k, v)| (*k, v.as_str())).collect();
    let falling = format!("[{}]", ["[0, 0, -1]"; 80].join(", "));
    let hits_the_floor = [("start.velocities", falling.as_str()), ("contact.compliance", "0.001")];
    let hitting = [column.as_slice(), &hits_the_floor].concat();
    for (column, advice) in [
        (&column, "at rest take `contact.compliance` above 0"),
        (&hitting, "in impacts, which are rigid, say with `contact.sweeps`"),
    ] {
        let mut run = common::prepared(scene_of_inputs("stack-spook", column));
        let words = run.follow(&mut Unfollowed).unwrap_err().to_string();
        for part in [
            "80 contacts of bodies that touch each other were not solved for in 20000 sweeps",
            "take `contact.compliance` above 0",
            advice,
        ] {
            assert!(words.contains(part), "{words}");
        }
    }
    let compliant = [column.as_slice(), &hits_the_floor[1..]].concat();
    column.push(("contact.sweeps", "50"));
    for solved in [compliant, column] {
        assert_eq!(of_inputs("stack-spook", &solved).state.step, 10);
    }
}

#[test]
fn a_row_of_spook_follows_newtons_rule_for_all_contacts_at_once() {
    let run = of_inputs("cradle-spook", &[]);
    for (v, wanted) in speeds(&run).iter().zip([-0.6, 0.4, 0.4, 0.4, 0.4]) {
        assert!((v - wanted).abs() < 1e-13, "{v} {wanted}");
    }
}

#[test]
fn a_ball_that_loses_a_share_at_each_bounce_rises_to_the_squares_of_it() {
    // Under the event rule heights are 2·0.81ⁿ: after the fall of 2 τ, bounce n + 1 comes 4·0.9ⁿ τ after bounce n.
    let run = of_inputs("ball", &[("stage.0.steps", "200"), ("integrator.dt", "0.01")]);
    let floor = lennard_core::ForceTerm::walls(run.forces.as_ref())[0].position;
    let height = |run: &Simulation| run.state.positions[0].z - floor;
    assert!(height(&run) < 1e-9);
    for n in 1..4_i32 {
        let top = 2.0 + (1..n).map(|k| 4.0 * 0.9_f64.powi(k)).sum::<f64>() + 2.0 * 0.9_f64.powi(n);
        let steps = (top / 0.001).round().to_string();
        let run = of_inputs("ball", &[("stage.0.steps", &steps), ("integrator.dt", "0.001")]);
        assert!((height(&run) / (2.0 * 0.81_f64.powi(n)) - 1.0).abs() < 1e-5, "{n}");
    }
}

/// A liquid at constant energy whose force ends smoothly.
const LIQUID: &str = r#"
    [system]
    n_atoms = 108
    density = 0.7
    temperature = 1.2
    [truncation]
    kind = "switch"
    r_cut = 2.2
    [integrator]
    dt = 0.002
    [[stage]]
    name = "production"
    steps = 500
"#;

fn held_to(simulation: &Simulation) -> f64 {
    let rows = simulation.thermodynamics().series();
    let energies = &rows.conserved_energy;
    energies.iter().map(|e| (e - energies[0]).abs()).fold(0.0, f64::max)
}

#[test]
fn a_fluid_with_held_particles_keeps_its_energy_and_they_their_places() {
    let run = ran(common::scene(LIQUID, &[("system.held", "[2, 3, 50, 108]")]));
    let start = common::prepared(common::scene(LIQUID, &[]));
    for i in [1, 2, 49, 107] {
        assert_eq!(run.state.positions[i], start.state.positions[i]);
        assert_eq!(run.state.velocities[i], DVec3::ZERO);
    }
    assert_eq!(run.view().n_dof(), 3.0 * 104.0);
    assert!(held_to(&run) < 1e-3, "{}", held_to(&run));
    let pressure = run.thermodynamics().finish(0.0).averages;
    let pressure = pressure.iter().find(|a| a.name == "pressure").unwrap();
    assert!(pressure.doubt.is_some(), "no one pressure with held particles");
}

#[test]
fn molecules_between_walls_that_exert_forces_keep_their_energy_and_their_bonds() {
    let run = ran(common::scene(
        LIQUID,
        &[
            ("system", "{ n_molecules = 108, density = 0.3, temperature = 1.5 }"),
            ("molecule.bond_length", "0.7"),
            ("wall", "[{ kind = \"lennard-jones-9-3\" }, { kind = \"wca\", axis = \"x\" }]"),
        ],
    ));
    assert_eq!(run.view().n_dof(), 6.0 * 108.0 - 108.0 - 1.0);
    assert!(held_to(&run) < 2e-3, "{}", held_to(&run));
    let residual = run.view().constraint_sums().largest_residual;
    assert!(residual < 1e-10, "{residual}");
}

#[test]
fn a_contact_too_weak_for_its_load_stops_the_run_and_says_who_and_where() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../inputs/mechanics");
    let weak = [("contact.stiffness".to_owned(), "3.0".to_owned())];
    let scene = Scene::load(&root.join("stack.toml"), &weak).unwrap();
    let mut run = common::prepared(scene);
    let error = run.follow(&mut lennard_engine::Unfollowed).unwrap_err().to_string();
    for words in [
        "particles 0 and 1 overlap by 0.5",
        "half their contact distance",
        "the spring of the contact is too weak for bodies so fast or so heavy",
        "contact.stiffness",
    ] {
        assert!(error.contains(words), "{words}: {error}");
    }
}

#[test]
fn sites_that_are_listed_are_not_multiplied_by_the_sites_of_a_molecule() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../inputs/mechanics");
    let scene = Scene::load(&root.join("double-pendulum.toml"), &[]).unwrap();
    let (n, density) = lennard_engine::size_and_density(&scene).unwrap();
    assert_eq!((n, density), (3, 3.0 / 1000.0));
}
