//! The interface of slabs whose densities are known.

use lennard_core::random::Streams;
use lennard_core::{DMat3, Energetics, PeriodicBox, State, System};
use rand_distr::{Distribution, StandardUniform};

use super::*;

const SIDES: DVec3 = DVec3::new(9.0, 9.0, 42.0);
/// Particles in the liquid, 15 σ thick, and in the vapor.
const LIQUID: usize = 900;
const VAPOR: usize = 60;
const THICKNESS: f64 = 15.0;

fn context(n_atoms: usize) -> BuildContext {
    let cell = PeriodicBox::new(SIDES).unwrap();
    BuildContext { cell, dt: 0.004, every: 10, ..crate::testing::context(9.0, n_atoms) }
}

/// Shows independent samples without forces: a slab whose middle wanders through the box and across its end, or one phase.
fn shown(samples: u64, has_slab: bool, looks: &mut dyn FnMut(u64, &View<'_>)) {
    shown_with(samples, &|_| has_slab.then_some(LIQUID), looks);
}

/// The same with a number of particles in the liquid that may change from sample to sample; one phase for `None`.
fn shown_with(
    samples: u64,
    in_liquid: &dyn Fn(u64) -> Option<usize>,
    looks: &mut dyn FnMut(u64, &View<'_>),
) {
    let n = LIQUID + VAPOR;
    let context = context(n);
    let mut rng = Streams::new(3).sequential("slab");
    let mut state = State::new(context.cell, vec![DVec3::ZERO; n], vec![DVec3::ZERO; n]);
    let system = System::atoms(n);
    for s in 0..samples {
        let middle = 0.37 * s as f64;
        for (i, r) in state.positions.iter_mut().enumerate() {
            let part: f64 = StandardUniform.sample(&mut rng);
            let z = match in_liquid(s) {
                None => SIDES.z * part,
                Some(liquid) if i < liquid => middle + THICKNESS * (part - 0.5),
                Some(_) => middle + 0.5 * THICKNESS + (SIDES.z - THICKNESS) * part,
            };
            *r = DVec3::new(0.0, 0.0, z);
        }
        // P_N = 0.02 and γ = 0.4, with noise.
        let volume = SIDES.element_product();
        let deviate: f64 = StandardUniform.sample(&mut rng);
        let (normal, noise) = (0.02, 0.01 * (deviate - 0.5));
        let tangential = normal - 2.0 * 0.4 / SIDES.z;
        let pressures = DVec3::new(tangential + noise, tangential, normal + noise);
        state.time = 0.04 * s as f64;
        state.energetics = Energetics {
            virial: Some(DMat3::from_diagonal(pressures * volume)),
            ..Energetics::default()
        };
        looks(s, &View::of(&state, &system));
    }
}

fn mean<'a>(findings: &'a Findings, name: &str) -> &'a Average {
    let found = findings.averages.iter().find(|a| a.name == name);
    found.unwrap_or_else(|| panic!("no {name}"))
}

#[test]
fn a_wandering_slab_gives_its_densities_pressure_and_tension_with_errors_that_cover() {
    let mut interface = Interface::new(&InterfaceOptions::default(), &context(LIQUID + VAPOR));
    shown(1280, true, &mut |_, view| interface.sample(view));
    let findings = interface.finish(0.0);
    let area = SIDES.x * SIDES.y;
    for (name, exact, most) in [
        ("liquid_density", LIQUID as f64 / (area * THICKNESS), 0.004),
        ("vapor_density", VAPOR as f64 / (area * (SIDES.z - THICKNESS)), 0.002),
        ("slab_thickness", THICKNESS, 0.02),
        ("vapor_pressure", 0.02, 1e-3),
        ("surface_tension", 0.4, 0.03),
    ] {
        let average = mean(&findings, name);
        let estimate = &average.estimate;
        assert_eq!(average.doubt, None, "{name}");
        // The surface is a step, which no tangent meets: that is what `most` leaves room for.
        assert!((estimate.mean - exact).abs() < most, "{name}: {estimate:?}");
        assert!(
            estimate.standard_error > 0.0 && estimate.standard_error < most,
            "{name}: {estimate:?}"
        );
    }
    assert!(mean(&findings, "interface_thickness").estimate.mean < 1.0);
    let profile = &findings.tables[0];
    assert_eq!(profile.name, "interface_profile");
    assert!(!findings.remarks_in_words().contains("no slab"));
}

#[test]
fn a_vapor_that_still_loses_particles_is_not_in_equilibrium() {
    let doubts = |lost: usize| {
        let mut interface = Interface::new(&InterfaceOptions::default(), &context(LIQUID + VAPOR));
        // 60 particles in the vapor at the beginning.
        let in_liquid = |s: u64| Some(LIQUID + lost * s as usize / 1280);
        shown_with(1280, &in_liquid, &mut |_, view| interface.sample(view));
        let averages = interface.finish(0.0).averages;
        let doubts = averages.into_iter().map(|a| (a.name, a.doubt));
        doubts.collect::<Vec<_>>()
    };
    assert!(doubts(0).iter().all(|(_, doubt)| doubt.is_none()));
    let falling = doubts(6);
    for (name, doubt) in &falling {
        assert!(matches!(doubt, Some(Doubt::NotInEquilibrium(_))), "{name}: {doubt:?}");
    }
    let of = |name: &str| &falling.iter().find(|(n, _)| n == name).unwrap().1;
    // Pressures do not change here: the vapor alone tells.
    for name in ["vapor_pressure", "surface_tension"] {
        let Some(Doubt::NotInEquilibrium(why)) = of(name) else { panic!("{name}") };
        let begin = "the density far from the middle of the slab still falls from 0.02";
        assert!(why.starts_with(begin), "{why}");
    }
}

#[test]
fn a_fluid_in_one_phase_has_no_slab_and_says_so() {
    let mut interface = Interface::new(&InterfaceOptions::default(), &context(LIQUID + VAPOR));
    shown(200, false, &mut |_, view| interface.sample(view));
    let findings = interface.finish(0.0);
    assert!(findings.averages.is_empty());
    assert!(findings.remarks_in_words().contains("no slab"), "{findings:?}");
}

#[test]
fn nothing_seen_gives_no_number() {
    let interface = Interface::new(&InterfaceOptions::default(), &context(VAPOR));
    assert!(interface.finish(0.0).averages.is_empty());
}
