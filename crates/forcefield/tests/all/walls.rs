//! Walls and the constant field: formulas, hits, and what walls feel.

use lennard_core::random::Streams;
use lennard_core::{
    Configuration, DMat3, DVec3, ForceTerm, Masses, Part, PeriodicBox, Persist, StateArchive,
    WallReading, Want,
};
use lennard_forcefield::{
    ConstantField, ForcePoint, SlitPlanes, Surface, WallContext, WallOptions, WallPair, Walls,
};

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
fn exerting() -> Vec<(&'static str, lennard_forcefield::WallForce)> {
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
fn force_and_curvature_are_derivatives_of_the_energy_and_vanish_at_the_end() {
    for (name, wall) in exerting() {
        let behind = wall.contact.is_some();
        for k in 1..60 {
            let z = match behind {
                true => -0.02 * f64::from(k),
                false => 0.6 + (wall.reach - 0.62) * f64::from(k) / 60.0,
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
        assert!(wall.at(wall.reach).energy.abs() < 1e-13, "{name}");
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
    let of = |text: &str| -> lennard_forcefield::WallForce {
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
    let of = |text: &str, z: f64| -> ForcePoint {
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

#[test]
fn what_walls_felt_is_saved_and_a_state_of_other_walls_is_refused() {
    let mut archive = StateArchive::default();
    let mut saved = slit("kind = \"hard\"");
    saved.count_hit(1, 8.0);
    saved.take_momentum(0, 0.25);
    saved.save(&mut archive.writer());
    let mut walls = slit("kind = \"hard\"");
    walls.restore(&archive.reader()).unwrap();
    assert_eq!(walls.walls(), saved.walls());
    assert_eq!((walls.walls()[1].hits, walls.walls()[1].impulse), (1, 8.0));
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
