//! Each barostat against the exact distribution of the volume of an ideal gas.

use crate::common::{KS_LIMIT, distance_from_gamma};
use lennard_core::random::Streams;
use lennard_core::{
    Bonds, DVec3, Integrator, Molecules, Momentum, NoForces, PeriodicBox, PressureBath, State,
    System, Want,
};
use lennard_integrators::{
    BarostatOptions, BondHolder, BondOptions, IntegratorOptions, ThermostatOptions, barostats,
    build,
};

const N: usize = 32;
const TEMPERATURE: f64 = 1.0;
const PRESSURE: f64 = 0.1;

/// The ideal gas of the distribution: N particles in a box of about its mean volume.
fn gas() -> State {
    let side = 7.0;
    let mut rng = Streams::new(3).sequential("gas");
    let mut draw = || -> Vec<DVec3> {
        use rand_distr::{Distribution, StandardNormal};
        (0..N)
            .map(|_| DVec3::from_array([0; 3].map(|_: i32| StandardNormal.sample(&mut rng))))
            .collect()
    };
    let mut velocities = draw();
    let mean = velocities.iter().sum::<DVec3>() / N as f64;
    velocities.iter_mut().for_each(|v| *v -= mean);
    State::new(PeriodicBox::new(DVec3::splat(side)).unwrap(), draw(), velocities)
}

fn bath() -> PressureBath {
    PressureBath {
        pressure: PRESSURE.into(),
        temperature: TEMPERATURE.into(),
        tail: 0.0,
        compressibility: 1.0 / PRESSURE,
    }
}

/// A method with its baths, by the words of a scene.
fn integrator(thermostat: &str, barostat: &str, seed: u64) -> Integrator {
    let thermostat: ThermostatOptions = toml::from_str(thermostat).unwrap();
    let barostat: BarostatOptions = toml::from_str(barostat).unwrap();
    assert_eq!(barostat.check(), Ok(()));
    let streams = Streams::new(seed);
    let method = build(&IntegratorOptions::default());
    let method = thermostat.couple(method, TEMPERATURE.into(), streams.noise("thermostat"));
    barostat.couple(method, &thermostat, bath(), streams.noise("barostat"))
}

/// Volumes every `every` steps, after a start that is left out.
fn volumes(method: &mut Integrator, dt: f64, every: u64, samples: usize) -> Vec<f64> {
    let system = System::atoms(N);
    let mut state = gas();
    let mut forces = NoForces;
    method.start(&system, &mut state, &mut forces, dt, Want::NOTHING).unwrap();
    let mut sample = || {
        let end = state.step + every;
        while state.step < end {
            let left = end - state.step;
            method.stride(&system, &mut state, &mut forces, dt, left, Want::NOTHING).unwrap();
        }
        state.cell.volume()
    };
    (0..samples / 20).for_each(|_| {
        sample();
    });
    (0..samples).map(|_| sample()).collect()
}

/// Whether the samples are of Gamma(N_f/3 + 1) and not of its neighbors.
fn is_canonical(volumes: &[f64], n_dof: f64, what: &str) {
    let shape = (n_dof / 3.0).round() as u32 + 1;
    let distance =
        |shape| distance_from_gamma(volumes.iter().map(|v| PRESSURE * v / TEMPERATURE), shape);
    let right = distance(shape);
    assert!(right < KS_LIMIT, "{what}: {right}");
    for wrong in [shape - 1, shape + 1] {
        let found = distance(wrong);
        assert!(found > KS_LIMIT, "{what}, shape {wrong}: {found}");
    }
}

#[test]
fn the_volume_of_an_ideal_gas_is_gamma_distributed_at_each_interval_and_coupling() {
    let n_dof = System::atoms(N).n_dof(Momentum::Conserved);
    for coupling in ["isotropic", "z", "xy-z"] {
        for interval in [1, 50] {
            let barostat = format!(
                "kind = \"stochastic-cell-rescaling\"\ntau = 0.5\ninterval = {interval}\ncoupling = \"{coupling}\""
            );
            let mut method = integrator("kind = \"bussi\"", &barostat, 5);
            let volumes = volumes(&mut method, 0.02, 100, 2500);
            is_canonical(&volumes, n_dof, &barostat);
            let moves = method.box_moves().unwrap();
            assert!(0 < moves.accepted && moves.accepted < moves.tried);
        }
    }
}

#[test]
fn the_deterministic_barostat_gives_the_ideal_gas_the_same_volumes() {
    let n_dof = System::atoms(N).n_dof(Momentum::Conserved);
    let barostat = "kind = \"mtk\"\ntau = 0.5\nchain = 5";
    let thermostat = "kind = \"nose-hoover\"\ntau = 0.5\nchain = 5";
    let mut method = integrator(thermostat, barostat, 5);
    let volumes = volumes(&mut method, 0.02, 200, 2500);
    is_canonical(&volumes, n_dof, barostat);
}

#[test]
fn one_molecule_has_no_centre_that_a_box_could_feel() {
    for n in [1, 2] {
        let molecules = Molecules::chains(2, 1.0, Bonds::Rigid);
        let system = System::of_molecules(2 * n, molecules);
        let x = (0..2 * n).map(|i| DVec3::new(i as f64, 0.0, 0.0)).collect();
        let cell = PeriodicBox::new(DVec3::splat(7.0)).unwrap();
        let mut state = State::new(cell, x, vec![DVec3::ZERO; 2 * n]);
        let solver = match BondOptions::default().build(&system.molecules) {
            BondHolder::Drift(solver) => solver,
            _ => panic!("the direct solution acts in drifts"),
        };
        let method = integrator("kind = \"nose-hoover\"", "kind = \"mtk\"", 1);
        let mut method = method.with_bonds(solver);
        let started = method.start(&system, &mut state, &mut NoForces, 0.01, Want::NOTHING);
        if n == 1 {
            let words = started.unwrap_err().to_string();
            let reason = "it has one molecule, whose centre has no degree of freedom";
            assert!(words.contains(reason), "{words}");
        } else {
            started.unwrap();
        }
    }
}

#[test]
fn with_langevin_no_momentum_is_kept_and_the_shape_is_one_larger() {
    let barostat = "kind = \"stochastic-cell-rescaling\"\ntau = 0.5\ninterval = 10";
    let mut method = integrator("kind = \"langevin\"", barostat, 6);
    let volumes = volumes(&mut method, 0.02, 100, 2500);
    is_canonical(&volumes, 3.0 * N as f64, barostat);
}

#[test]
#[ignore = "five minutes: run by `cargo xtask physics`"]
fn the_volume_of_an_ideal_gas_is_gamma_distributed_for_ten_seeds() {
    let n_dof = System::atoms(N).n_dof(Momentum::Conserved);
    for seed in 10..20 {
        for spec in barostats() {
            let barostat = format!("kind = \"{}\"\ntau = 0.5", spec.name);
            let mut method = integrator("kind = \"nose-hoover\"\nchain = 5", &barostat, seed);
            let volumes = volumes(&mut method, 0.02, 300, 40_000);
            is_canonical(&volumes, n_dof, &format!("seed {seed}, {barostat}"));
        }
    }
}

#[test]
fn methods_that_remember_the_box_as_it_was_are_refused() {
    let reason = "it keeps forces of the box as it was; take \"velocity-verlet\" with a barostat";
    let barostat = BarostatOptions::all().swap_remove(0);
    let thermostat: ThermostatOptions = toml::from_str("kind = \"bussi\"").unwrap();
    let noise = Streams::new(1).noise("barostat");
    let respa = build(&IntegratorOptions::Respa(Default::default()));
    let mut method = barostat.couple(respa, &thermostat, bath(), noise);
    let started = method.start(&System::atoms(N), &mut gas(), &mut NoForces, 0.01, Want::NOTHING);
    let error = started.unwrap_err().to_string();
    assert!(error.contains(reason), "{error}");
}
