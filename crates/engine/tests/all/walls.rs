//! Fluids between walls and in fields: what is conserved, what walls feel, and how runs fail.

use lennard_core::random::Streams;
use lennard_core::{
    Axis, DVec3, ForceSum, ForceTerm, Masses, Momentum, NoForces, PeriodicBox, State, System,
    WallReading, Want,
};
use lennard_engine::{Simulation, Unfollowed};
use lennard_forcefield::{ConstantField, SlitPlanes, WallContext, WallPair, Walls, walls};
use lennard_integrators::Obstacles;

use crate::common::{self, prepared};

const SLIT: &str = r#"
    system = { n_atoms = 108, density = 0.6, temperature = 1.5, seed = 3 }
    truncation = { kind = "shift", r_cut = 2.2 }
    integrator = { dt = 0.004 }
    stage = [{ name = "production", steps = 2000 }]
"#;

fn build(overrides: &str) -> Simulation {
    prepared(common::scene(SLIT, overrides))
}

pub(crate) fn method() -> lennard_core::Integrator {
    lennard_integrators::build(&lennard_integrators::IntegratorOptions::default())
}

#[test]
fn momentum_across_the_walls_is_thermal_and_along_them_it_is_conserved() {
    for (wall, field, n_dof) in [
        ("[{kind=\"hard\"}]", "[0.0, 0.0, 0.0]", 322.0),
        ("[{kind=\"soft\", axis=\"x\"}]", "[0.1, 0.0, 0.0]", 322.0),
        ("[{kind=\"wca\"}, {kind=\"hard\", axis=\"y\"}]", "[0.0, 0.0, 0.0]", 323.0),
        ("[{kind=\"thermal\"}]", "[0.0, 0.0, 0.0]", 324.0),
    ] {
        let mut simulation = build(&format!("wall={wall} field.acceleration={field}"));
        let system = simulation.system.clone();
        assert_eq!(system.n_dof(Momentum::Conserved), n_dof, "{wall}");
        let temperature = system.temperature(&simulation.state.velocities, Momentum::Conserved);
        assert!((temperature - 1.5).abs() < 1e-12, "{wall}");
        simulation.follow(&mut Unfollowed).unwrap();
        let momentum = system.momentum(&simulation.state.velocities);
        assert!(system.kept_part(momentum).length() < 1e-11, "{wall}: {momentum}");
        assert!(n_dof == 324.0 || momentum.length() > 0.1, "{wall}: {momentum}");
    }
}

#[test]
fn every_wall_keeps_its_particles_and_its_energy() {
    for wall in walls() {
        for precision in ["double", "mixed"] {
            let tables = format!("[{{kind=\"{}\"}}]", wall.name);
            let mut simulation = build(&format!("wall={tables} kernel.precision={precision}"));
            simulation.follow(&mut Unfollowed).unwrap();
            let slit = simulation.scene.slits(&simulation.state.cell)[0];
            assert!(slit.width() > 5.0 && slit.room > 0.0);
            for r in &simulation.state.positions {
                let inside = (slit.lower - slit.room)..=(slit.upper + slit.room);
                assert!(inside.contains(&r.z), "{}: {r}", wall.name);
            }
            let kept = simulation.thermodynamics().conservation();
            assert!(kept.energy_rms_per_atom < 0.02, "{}: {kept:?}", wall.name);
            let felt = |w: &WallReading| w.hits > 20 || w.force != 0.0;
            let exerts_now = simulation.forces.walls().iter().any(felt);
            assert!(exerts_now || wall.name == "soft", "{}", wall.name);
            assert!(simulation.force_check.seen().forces > 0);
        }
    }
}

#[test]
fn the_walls_carry_the_weight_of_a_gas_and_both_feel_a_fluid_alike() {
    let pressures = |overrides: &str| -> [(f64, f64); 2] {
        let keys = format!(r#"observable=[{{kind="wall-pressure"}}] {overrides}"#);
        let simulation = common::ran(common::scene(SLIT, &keys));
        let found = [simulation.observers[1].observable.finish(0.2)];
        let names = ["wall_pressure_z_lower", "wall_pressure_z_upper"];
        names.map(|name| {
            let found = common::average(&found, name).unwrap().estimate;
            (found.mean, found.standard_error)
        })
    };
    for kind in ["hard", "lennard-jones-9-3", "wca", "soft"] {
        let wall = format!("[{{kind=\"{kind}\"}}]");
        let found = pressures(&format!("wall={wall} stage.production.steps=8000"));
        let [(lower, error), (upper, other)] = found;
        assert!(lower > 0.3, "{kind}: {found:?}");
        assert!((lower - upper).abs() < 4.0 * error.hypot(other), "{kind}: {found:?}");
    }
    let found = pressures(
        r#"wall=[{kind="hard"}] system.density=0.02
        field.acceleration=[0.0, 0.0, -0.4] stage.production.thermostat=langevin
        stage.production.steps=30000"#,
    );
    let [(lower, error), (upper, other)] = found;
    // N·g/A, with N = 108 in a cube of density 0.02.
    let weight = 108.0 * 0.4 / (108.0_f64 / 0.02).powf(2.0 / 3.0);
    let difference = lower - upper - weight;
    assert!(difference.abs() < 4.0 * error.hypot(other), "{found:?} {weight}");
    assert!(error < 0.1 * weight, "{found:?}");
}

/// Walls across z of a cube of side 10, between 2 and 8.
pub(crate) fn slit_of(options: &str) -> Obstacles {
    let cell = PeriodicBox::new(DVec3::splat(10.0)).unwrap();
    let planes = SlitPlanes::new(&cell, Axis::Z.index(), 4.0, 0.0);
    let context = WallContext { temperature: 1.0 };
    let pair = WallPair::new(&toml::from_str(options).unwrap(), planes, &context);
    Obstacles::new(Walls::new(vec![pair], Streams::new(1).noise("walls")), None)
}

/// One ball in gravity between walls, dropped from the middle.
pub(crate) fn ball(options: &str, h: f64) -> (State, ForceSum<NoForces>, System) {
    let cell = PeriodicBox::new(DVec3::splat(10.0)).unwrap();
    let field = ConstantField::new(DVec3::new(0.0, 0.0, -1.0), Masses::Uniform(1.0));
    let mut forces = ForceSum::new(NoForces).with(slit_of(options)).with(field);
    let system = System::atoms(1).pushed_along(forces.properties().breaks_momentum);
    let mut state = State::new(cell, vec![DVec3::new(5.0, 5.0, 3.0)], vec![DVec3::ZERO]);
    let mut method = method();
    method.start(&system, &mut state, &mut forces, h, Want::ENERGY).unwrap();
    (state, forces, system)
}

#[test]
fn a_ball_at_rest_on_a_wall_that_takes_energy_counts_no_heat() {
    let h = 0.01;
    for options in [
        "kind = \"hard\"\nrestitution = 0.5",
        "kind = \"hard\"\nrestitution = 0.0",
        "kind = \"hard\"\nresponse = \"event\"\nrestitution = 0.5",
        "kind = \"hard\"\nresponse = \"project\"",
        "kind = \"hard\"\nresponse = \"mirror\"\nrestitution = 0.5",
    ] {
        let (mut state, mut forces, system) = ball(options, h);
        // The mirror gains energy at each bounce: a ball that lies still stays, and one that bounces hops on.
        let lies_still = options.contains("mirror");
        if lies_still {
            state.positions[0].z = 2.0;
        }
        let mut method = method();
        method.start(&system, &mut state, &mut forces, h, Want::ENERGY).unwrap();
        let (mut heat, mut halfway) = (0.0, (0.0, 0.0));
        for step in 0..4000 {
            if step == 2000 {
                halfway = (heat, forces.walls()[0].impulse);
            }
            let stepped = method.step(&system, &mut state, &mut forces, h, Want::ENERGY);
            heat += stepped.unwrap().heat;
        }
        assert_eq!(heat, halfway.0, "{options}: {}", heat - halfway.0);
        assert_eq!(state.positions[0].z, 2.0, "{options}");
        let weight = (forces.walls()[0].impulse - halfway.1) / 20.0;
        assert!((weight - 1.0).abs() < 1e-12, "{options}: {weight}");
        // All that the ball had is heat now: 1 ε, to a few kicks of a step at the speed of the first hit.
        let had = if lies_still { 0.0 } else { 1.0 };
        assert!((heat + had).abs() < 4.0 * h, "{options}: {heat}");
    }
}

#[test]
fn a_particle_through_a_soft_wall_fails_with_the_wall_and_the_cause() {
    let mut simulation = build(r#"wall=[{kind="soft", stiffness=5.0}]"#);
    let error = simulation.follow(&mut Unfollowed).unwrap_err().to_string();
    let words = [
        "σ beyond the wall at the",
        " end of z, at a speed of ",
        "likely cause: the wall is too weak for a particle so fast",
    ];
    common::contains(&error, &words);
}
