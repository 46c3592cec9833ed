//! Forces are terms that add, and baths leave steps together.

use crate::common::{Cluster, Rig, cluster, free};
use crate::measure::Watched;
use lennard_core::random::Streams;
use lennard_core::{
    Backend, Configuration, DVec3, ForceSum, ForceTerm, FusedSteps, Masses, Part, Persist, State,
    StateArchive, System, Want,
};
use lennard_integrators::oscillator::HarmonicForces;
use lennard_integrators::{IntegratorOptions, ThermostatOptions, build};

/// A cluster in a harmonic trap.
fn trapped() -> ForceSum<Cluster> {
    ForceSum::new(Cluster).with(HarmonicForces::new(0.3))
}

fn start() -> State {
    let (positions, velocities) = cluster(3, 0.5, 3);
    free(positions, velocities)
}

#[test]
fn forces_energies_and_hessians_of_terms_add() {
    let state = start();
    let at = Configuration::at_rest(&state.cell, &state.positions);
    let n = state.len();
    for part in [Part::All, Part::Near, Part::Far] {
        let mut found = vec![[DVec3::ZERO; 3]; n];
        let mut energies = [0.0; 3];
        let (mut pairs, mut trap, mut sum) = (Cluster, HarmonicForces::new(0.3), trapped());
        let terms: [&mut dyn ForceTerm; 3] = [&mut pairs, &mut trap, &mut sum];
        for (k, term) in terms.into_iter().enumerate() {
            let mut forces = vec![DVec3::ONE; n];
            let totals = term.evaluate(at, part, Want::ENERGY, &mut forces).unwrap();
            energies[k] = totals.potential_energy.unwrap();
            for (f, all) in forces.iter().zip(&mut found) {
                all[k] = *f;
            }
        }
        assert_eq!(energies[2], energies[0] + energies[1]);
        assert!(found.iter().all(|[a, b, sum]| *sum == *a + *b));
    }
    let direction: Vec<DVec3> = (0..n).map(|i| DVec3::splat((i as f64).sin())).collect();
    let product = |term: &mut dyn ForceTerm| {
        let mut out = vec![DVec3::ZERO; n];
        term.hessian_vector(at, &direction, &mut out).unwrap();
        out
    };
    let (pairs, sum) = (product(&mut Cluster), product(&mut trapped()));
    for ((a, d), s) in pairs.iter().zip(&direction).zip(&sum) {
        assert!((*a + 0.3 * *d - *s).length() < 1e-12 * (1.0 + a.length()));
    }
}

#[test]
fn a_sum_has_the_properties_of_all_its_terms_and_conserves_their_energy() {
    let damped = ForceSum::new(Cluster).with(HarmonicForces::new(1.0).with_damping(0.1));
    assert!(damped.properties().velocity_dependent && !damped.properties().splits);
    assert!(trapped().properties().splits && !trapped().properties().linear);
    let dt = 0.002;
    let method = || build(&IntegratorOptions::default());
    let mut rig = Rig::new(method(), System::atoms(27), start(), trapped(), dt);
    let first = rig.conserved();
    for _ in 0..2000 {
        rig.step();
        assert!((rig.conserved() - first).abs() < 2e-3 * first.abs());
    }
    // Without the trap the same start has another energy and another end.
    let free = Rig::of(method(), (System::atoms(27), start()), Cluster, dt).steps(2000);
    assert!(rig.state.positions[0].distance(free.state.positions[0]) > 0.1);
}

#[test]
fn one_term_takes_its_own_fused_steps_and_two_take_none() {
    let taken = |forces: &mut dyn Backend| {
        let mut state = start();
        forces.advance(&mut FusedSteps {
            cell: &state.cell,
            positions: &mut state.positions,
            velocities: &mut state.velocities,
            forces: &mut state.forces,
            masses: &Masses::Uniform(1.0),
            dt: 0.002,
            steps: 9,
            first: 0,
            bath: None,
        })
    };
    assert_eq!(taken(&mut ForceSum::new(Cluster)), 2);
    assert_eq!(taken(&mut trapped()), 0);
}

#[test]
fn each_term_of_a_sum_is_saved_under_a_name_of_its_own() {
    let term = |evaluations| Watched { evaluations, ..Watched::new(HarmonicForces::new(1.0)) };
    let sum = |a, b| ForceSum::new(Cluster).with(term(a)).with(term(b));
    let saved = |sum: &ForceSum<Cluster>| {
        let mut archive = StateArchive::default();
        sum.save(&mut archive.writer());
        archive
    };
    let whole = saved(&sum(3, 5));
    assert_eq!(whole.arrays.len(), 2);
    let mut other = sum(0, 0);
    other.restore(&whole.reader()).unwrap();
    assert_eq!(saved(&other), whole);
}

#[test]
fn steps_under_any_bath_are_taken_at_once_with_the_same_bits_and_the_same_heat() {
    let rescale: ThermostatOptions = toml::from_str("kind = \"rescale\"\nevery = 3").unwrap();
    let bussi: ThermostatOptions = toml::from_str("kind = \"bussi\"\ntau = 0.1").unwrap();
    let others =
        ["nose-hoover", "langevin"].map(|kind| toml::from_str(&format!("kind = \"{kind}\"")));
    let [chain, langevin]: [ThermostatOptions; 2] = others.map(Result::unwrap);
    for options in [rescale, bussi, chain, langevin] {
        let coupled = || {
            let noise = Streams::new(7).noise("bath");
            options.couple(build(&IntegratorOptions::default()), 0.4.into(), noise)
        };
        let rig = || Rig::of(coupled(), (System::atoms(27), start()), Cluster, 0.002);
        let (one, mut all) = (rig().steps(20), rig());
        let mut most = 0;
        while all.state.step < 20 {
            most = most.max(all.stride(20 - all.state.step).0);
        }
        assert_eq!(one.state, all.state, "{}", options.name());
        let mut vain =
            Rig::of(coupled(), (System::atoms(27), start()), Watched::new(Cluster), 0.002);
        for left in (1..=20).rev() {
            assert_eq!(vain.stride(left).0, 1);
        }
        let heat = one.heat;
        assert_eq!((&one.state, heat), (&vain.state, vain.heat), "{}", options.name());
        assert_eq!((heat, 3), (all.heat, most), "two at once, and the one that ends");
        assert!(heat != 0.0, "{}", options.name());
    }
}
