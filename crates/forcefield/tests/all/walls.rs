//! Walls and the constant field: formulas, hits, and what walls feel.

use lennard_core::random::Streams;
use lennard_core::{
    Configuration, DMat3, DVec3, ForceSum, ForceTerm, Masses, NoForces, Part, PeriodicBox, State,
    StateArchive, System, WallReading, Want,
};
use lennard_core::{Persist, Step};
use lennard_forcefield::{
    ConstantField, SlitPlanes, Surface, WallContext, WallOptions, WallPair, WallPoint, Walls, walls,
};
use rand::RngExt;

const CONTEXT: WallContext = WallContext { temperature: 1.5 };

fn options(text: &str) -> WallOptions {
    toml::from_str(text).unwrap()
}

/// Walls across z of a cube of side 10, between 2 and 8.
fn slit(text: &str) -> Walls {
    let cell = PeriodicBox::new(DVec3::splat(10.0)).unwrap();
    let planes = SlitPlanes::new(&cell, 2, 4.0, 2.5);
    let pair = WallPair::new(&options(text), planes, &CONTEXT);
    Walls::new(vec![pair], Streams::new(7).noise("walls"))
}

/// The walls that exert forces, with the formula at the lower end.
fn exerting() -> Vec<(&'static str, std::sync::Arc<dyn lennard_forcefield::WallForce>)> {
    let all = WallOptions::all()
        .into_iter()
        .chain([options("kind = \"soft\"\nlaw = \"hertz\"\nstiffness = 50.0")]);
    all.filter_map(|wall| match wall.surface(&CONTEXT, false) {
        Surface::Exerts(force) => Some((wall.spec().name, force)),
        Surface::Hit(_) => None,
    })
    .collect()
}

#[test]
fn the_list_the_names_and_the_scene_tables_agree() {
    let all = WallOptions::all();
    assert_eq!(all.len(), walls().len());
    for (wall, spec) in all.iter().zip(walls()) {
        let written = toml::to_string(wall).unwrap();
        assert!(written.contains(&format!("kind = \"{}\"", spec.name)), "{written}");
        assert_eq!(&options(&format!("kind = \"{}\"", spec.name)), wall);
        assert!(wall.check().is_ok());
        for text in [spec.summary, spec.equation, spec.source] {
            assert!(!text.is_empty());
        }
    }
}

#[test]
fn force_and_curvature_are_derivatives_of_the_energy_and_vanish_at_the_end() {
    for (name, wall) in exerting() {
        let behind = wall.acts_behind_plane();
        for k in 1..60 {
            let z = match behind {
                true => -0.02 * f64::from(k),
                false => 0.6 + (wall.reach() - 0.62) * f64::from(k) / 60.0,
            };
            let h = 1e-5;
            let [below, here, above] = [z - h, z, z + h].map(|z| wall.at(z));
            let close = |a: f64, b: f64| (a - b).abs() < 1e-6 * (1.0 + a.abs());
            assert!(close(here.force, (below.energy - above.energy) / (2.0 * h)), "{name} at {z}");
            assert!(
                close(here.curvature, (below.force - above.force) / (2.0 * h)),
                "{name} at {z}"
            );
        }
        assert!(wall.at(wall.reach()).energy.abs() < 1e-13, "{name}");
    }
}

/// The integral of f over x from `from` to `to` by Simpson's rule.
fn simpson(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    let n = 20_000;
    let h = (to - from) / f64::from(n);
    let weight = |k: i32| match k {
        0 => 1.0,
        k if k == n => 1.0,
        k => f64::from(2 + 2 * (k % 2)),
    };
    (0..=n).map(|k| weight(k) * f(from + f64::from(k) * h)).sum::<f64>() * h / 3.0
}

#[test]
fn walls_are_integrals_of_lennard_jones_sites() {
    let far = "cutoff = 1000.0";
    // A plane of n_w = 1: ∫ U(√(z² + s²))·2π·s ds = π·∫ U(√t) dt from z² on, by x = 1/t.
    let plane = |z: f64| {
        simpson(0.0, 1.0 / (z * z), |x| {
            if x == 0.0 {
                return 0.0;
            }
            std::f64::consts::PI * 4.0 * (x.powi(6) - x.powi(3)) / (x * x)
        })
    };
    let of = |text: &str| -> std::sync::Arc<dyn lennard_forcefield::WallForce> {
        match options(text).surface(&CONTEXT, false) {
            Surface::Exerts(force) => force,
            Surface::Hit(_) => panic!("{text}"),
        }
    };
    let layer = of(&format!("kind = \"lennard-jones-10-4\"\n{far}"));
    let half_space = of(&format!("kind = \"lennard-jones-9-3\"\n{far}"));
    for z in [0.9, 1.0, 1.3, 2.0, 3.5] {
        assert!((layer.at(z).energy - plane(z)).abs() < 1e-8, "{z}");
        // Layers behind the plane, ρ_w = 1, ε_w = 2π/3; by y = 1/depth.
        let space = simpson(0.0, 1.0 / z, |y| match y {
            0.0 => 0.0,
            y => plane_formula(1.0 / y) / (y * y),
        });
        let strength = 2.0 * std::f64::consts::PI / 3.0;
        assert!((strength * half_space.at(z).energy - space).abs() < 1e-7, "{z}");
    }
}

/// The 10-4 formula, written apart from the library.
fn plane_formula(z: f64) -> f64 {
    2.0 * std::f64::consts::PI * (0.4 * z.powi(-10) - z.powi(-4))
}

#[test]
fn minima_stand_where_the_formulas_say() {
    let of = |text: &str, z: f64| -> WallPoint {
        match options(text).surface(&CONTEXT, false) {
            Surface::Exerts(force) => force.at(z),
            Surface::Hit(_) => panic!("{text}"),
        }
    };
    let nine_three = of("kind = \"lennard-jones-9-3\"\ncutoff = 1000.0", 0.858_374_218_932_559);
    assert!((nine_three.energy + 10_f64.sqrt() / 3.0).abs() < 1e-8);
    assert!(nine_three.force.abs() < 1e-12);
    let ten_four = of("kind = \"lennard-jones-10-4\"\ncutoff = 1000.0", 1.0);
    assert!((ten_four.energy + 1.2 * std::f64::consts::PI).abs() < 1e-10);
    assert!(ten_four.force.abs() < 1e-12);
}

#[test]
fn the_term_pushes_inward_from_both_ends_and_the_walls_feel_the_opposite() {
    let cell = PeriodicBox::new(DVec3::splat(10.0)).unwrap();
    for (name, _) in exerting() {
        let mut walls = slit(&format!("kind = \"{name}\""));
        let depth = if name == "soft" { -0.1 } else { 0.8 };
        let positions = [
            DVec3::new(1.0, 2.0, 2.0 + depth),
            DVec3::new(1.0, 2.0, 8.0 - depth),
            DVec3::new(1.0, 2.0, 5.0),
        ];
        let mut forces = vec![DVec3::ONE; 3];
        let at = Configuration::at_rest(&cell, &positions);
        let want = Want { per_particle: true, ..Want::TOTALS };
        let all = walls.evaluate(at, Part::All, want, &mut forces).unwrap();
        assert!(forces[0].z > 0.0 && (forces[0].z + forces[1].z).abs() < 1e-9, "{name}");
        assert_eq!(forces[2], DVec3::ZERO);
        let [lower, upper]: [WallReading; 2] = walls.walls().try_into().unwrap();
        assert!((lower.force - forces[0].z).abs() < 1e-12, "{name}");
        assert!((upper.force + forces[1].z).abs() < 1e-12, "{name}");
        let each = all.per_particle.clone().unwrap();
        let sum: f64 = each.iter().map(|e| e.0).sum();
        assert!((sum - all.potential_energy.unwrap()).abs() < 1e-12 * sum.abs());
        assert_eq!(all.virial, Some(DMat3::ZERO));
        // Near and far add up to the whole.
        let mut parts = vec![DVec3::ZERO; 3];
        let near = walls.add(at, Part::Near, Want::ENERGY, &mut vec![], &mut parts);
        let far = walls.add(at, Part::Far, Want::ENERGY, &mut vec![], &mut parts);
        assert_eq!(parts, forces, "{name}");
        let energy = |e: Result<lennard_core::Energetics, _>| e.unwrap().potential_energy.unwrap();
        assert_eq!(Some(energy(near) + energy(far)), all.potential_energy);
    }
}

#[test]
fn a_particle_beyond_a_wall_is_an_error_with_axis_end_and_depth() {
    let cell = PeriodicBox::new(DVec3::splat(10.0)).unwrap();
    for (kind, z, words) in [
        ("wca", 1.75, "particle 1 is 0.2500 σ beyond the wall at the lower end of z"),
        ("soft", 8.875, "particle 1 is 0.8750 σ beyond the wall at the upper end of z"),
    ] {
        let mut walls = slit(&format!("kind = \"{kind}\""));
        let positions = [DVec3::splat(5.0), DVec3::new(0.0, 0.0, z)];
        let at = Configuration::at_rest(&cell, &positions);
        let error = walls.evaluate(at, Part::All, Want::NOTHING, &mut [DVec3::ZERO; 2]);
        assert_eq!(error.unwrap_err().to_string(), words);
    }
}

/// One drift of 1 τ of a particle from the middle between the walls.
fn fly(walls: Walls, velocity: DVec3) -> (State, Vec<WallReading>, f64) {
    let system = System::atoms(1);
    let cell = PeriodicBox::new(DVec3::splat(10.0)).unwrap();
    let mut state = State::new(cell, vec![DVec3::new(0.0, 0.0, 5.0)], vec![velocity]);
    let mut forces = ForceSum::new(NoForces).with(walls);
    let spec = &lennard_spec();
    let mut step = Step::new(&system, &mut state, &mut forces, spec, 1.0, Want::NOTHING);
    step.drift(1.0);
    let heat = step.finish().heat;
    let readings = forces.walls().to_vec();
    (state, readings, heat)
}

fn lennard_spec() -> &'static lennard_core::IntegratorSpec {
    static SPEC: lennard_core::IntegratorSpec = lennard_core::IntegratorSpec {
        name: "drift",
        summary: "",
        equations: "",
        position_order: 1,
        velocity_order: 1,
        symplectic: true,
        reversible: true,
        fixed_step_only: false,
        velocity_dependent_forces: false,
        conserves_momentum: true,
        half_kicks: false,
        is_kick_drift_kick: false,
        holds_rigid_bonds: false,
        force_evaluations: 0,
        stability_limit: None,
        oscillator_map: None,
        source: "",
    };
    &SPEC
}

#[test]
fn a_billiard_flight_keeps_the_restitution_to_rounding_and_hands_over_its_momentum() {
    for e in [1.0_f64, 0.9, 0.5, 0.1] {
        let (state, walls, heat) =
            fly(slit(&format!("kind = \"hard\"\nrestitution = {e:?}")), DVec3::new(0.5, 0.0, 4.0));
        // Up 3 σ in 0.75 τ, then back at 4e for 0.25 τ.
        assert!((state.velocities[0].z + 4.0 * e).abs() < 1e-12);
        assert!((state.positions[0] - DVec3::new(0.5, 0.0, 8.0 - e)).length() < 1e-12);
        assert!((walls[1].impulse - 4.0 * (1.0 + e)).abs() < 1e-12);
        assert_eq!((walls[0].hits, walls[1].hits), (0, 1));
        assert!((heat + 8.0 * (1.0 - e * e)).abs() < 1e-12);
    }
    // Several hits in one flight: 3 up, 6 down, 6 up, 5 down.
    let (state, walls, heat) = fly(slit("kind = \"hard\""), DVec3::new(0.0, 0.0, 20.0));
    assert!((state.positions[0].z - 3.0).abs() < 1e-12);
    assert_eq!((walls[0].hits, walls[1].hits, heat), (1, 2, 0.0));
    assert!((walls[1].impulse - 80.0).abs() < 1e-12);
}

#[test]
fn a_particle_with_too_many_hits_rests_at_the_plane() {
    let (state, walls, _) = fly(slit("kind = \"hard\""), DVec3::new(0.0, 0.0, 1000.0));
    assert_eq!(walls[0].hits + walls[1].hits, 16);
    assert_eq!(state.velocities[0].z, 0.0);
    assert!((2.0..=8.0).contains(&state.positions[0].z));
}

#[test]
fn thermal_walls_give_the_speeds_of_the_flux() {
    let (mut normal, mut square, mut tangential) = (0.0, 0.0, 0.0);
    let n = 40_000_u64;
    let mut walls = slit("kind = \"thermal\"\ntemperature = 2.0\nupper_temperature = 0.5");
    let mut heat = 0.0;
    let system = System::atoms(1);
    let cell = PeriodicBox::new(DVec3::splat(10.0)).unwrap();
    for step in 0..n {
        let mut positions = [DVec3::new(0.0, 0.0, 7.999)];
        let mut velocities = [DVec3::new(3.0, 0.0, 1.0)];
        let drifted = walls.boundary().unwrap().fly(lennard_core::Flight {
            cell: &PeriodicBox::new(DVec3::splat(10.0)).unwrap(),
            positions: &mut positions,
            velocities: &mut velocities,
            forces: &[DVec3::ZERO],
            masses: &system.masses,
            h: 0.0011,
            step,
            is_later: false,
        });
        heat += drifted.unwrap().heat;
        let v = velocities[0];
        assert!(v.z <= 0.0 && cell.wrap(positions[0]).z < 8.0 + 1e-12);
        normal += -v.z / n as f64;
        square += v.z * v.z / n as f64;
        tangential += v.x * v.x / n as f64;
    }
    // The flux at T = 0.5: ⟨v⟩ = √(πT/2), ⟨v²⟩ = 2T; along the wall ⟨v²⟩ = T. Errors: four standard ones.
    let error = 4.0 / (n as f64).sqrt();
    assert!((normal - (std::f64::consts::PI * 0.25).sqrt()).abs() < error * 0.5);
    assert!((square - 1.0).abs() < error);
    assert!((tangential - 0.5).abs() < error * 0.8);
    let kinetic = 0.5 * (square + 2.0 * tangential) - 5.0;
    assert!((heat / n as f64 - kinetic).abs() < 4.0 * error);
}

#[test]
fn a_gas_without_collisions_between_two_temperatures_conducts_as_theory_says() {
    let (lower, upper) = (2.0_f64, 0.5_f64);
    let mut walls = slit(&format!(
        "kind = \"thermal\"\ntemperature = {lower:?}\nupper_temperature = {upper:?}"
    ));
    const N: usize = 2000;
    let mut random = Streams::new(5).sequential("gas");
    let mut positions: Vec<DVec3> =
        (0..N).map(|_| DVec3::new(0.0, 0.0, 2.0 + 6.0 * random.random::<f64>())).collect();
    let mut velocities = vec![DVec3::new(0.3, -0.2, 1.0); N];
    let (mut temperature, mut flux, mut lower_half, mut samples) = (0.0, 0.0, 0.0, 0.0);
    for step in 0..3000 {
        let drifted = walls.boundary().unwrap().fly(lennard_core::Flight {
            cell: &PeriodicBox::new(DVec3::splat(10.0)).unwrap(),
            positions: &mut positions,
            velocities: &mut velocities,
            forces: &[DVec3::ZERO; N],
            masses: &Masses::Uniform(1.0),
            h: 1.0,
            step,
            is_later: false,
        });
        drifted.unwrap();
        if step < 200 {
            continue;
        }
        samples += N as f64;
        for (x, v) in positions.iter().zip(&velocities) {
            temperature += v.length_squared() / 3.0;
            flux += 0.5 * v.length_squared() * v.z;
            lower_half += f64::from(x.z < 5.0);
        }
    }
    let wanted = (lower * upper).sqrt();
    assert!((temperature / samples / wanted - 1.0).abs() < 0.01, "{temperature}");
    // Of n = 1: q = 2n·√(2·T₁·T₂/π)·(√T₁ − √T₂).
    let heat =
        2.0 * (2.0 * lower * upper / std::f64::consts::PI).sqrt() * (lower.sqrt() - upper.sqrt());
    assert!((flux / samples / heat - 1.0).abs() < 0.02, "{} {heat}", flux / samples);
    assert!((lower_half / samples - 0.5).abs() < 0.005, "{lower_half}");
}

#[test]
fn what_walls_felt_is_saved_and_a_state_of_other_walls_is_refused() {
    let (_, before, _) = fly(slit("kind = \"hard\""), DVec3::new(0.0, 0.0, 4.0));
    let mut walls = slit("kind = \"hard\"");
    let mut archive = StateArchive::default();
    let mut saved = slit("kind = \"hard\"");
    let mut positions = [DVec3::new(0.0, 0.0, 5.0)];
    let mut velocities = [DVec3::new(0.0, 0.0, 4.0)];
    let drifted = saved.boundary().unwrap().fly(lennard_core::Flight {
        cell: &PeriodicBox::new(DVec3::splat(10.0)).unwrap(),
        positions: &mut positions,
        velocities: &mut velocities,
        forces: &[DVec3::ZERO],
        masses: &Masses::Uniform(1.0),
        h: 1.0,
        step: 0,
        is_later: false,
    });
    drifted.unwrap();
    saved.save(&mut archive.writer());
    walls.restore(&archive.reader()).unwrap();
    assert_eq!(walls.walls(), before);
    let mut none = Walls::new(Vec::new(), Streams::new(1).noise("walls"));
    let error = none.restore(&archive.reader()).unwrap_err().to_string();
    assert!(error.contains("another number of walls"), "{error}");
}

#[test]
fn a_field_has_the_energy_of_its_force() {
    let g = DVec3::new(0.0, 0.5, -2.0);
    let mut field = ConstantField::new(g, Masses::Each(vec![1.0, 3.0]));
    let cell = PeriodicBox::new(DVec3::splat(10.0)).unwrap();
    let positions = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)];
    let at = Configuration::at_rest(&cell, &positions);
    let mut forces = vec![DVec3::ONE; 2];
    let found = field.evaluate(at, Part::All, Want::TOTALS, &mut forces).unwrap();
    assert_eq!(forces, [g, 3.0 * g]);
    let energy = -(1.0 - 6.0) - 3.0 * (2.5 - 12.0);
    assert!((found.potential_energy.unwrap() - energy).abs() < 1e-12);
    assert_eq!(field.properties().breaks_momentum, [false, true, true]);
    let mut far = vec![DVec3::ZERO; 2];
    let rest = field.add(at, Part::Far, Want::ENERGY, &mut vec![], &mut far).unwrap();
    assert_eq!((far, rest.potential_energy), (vec![DVec3::ZERO; 2], Some(0.0)));
}
