//! The observables on a real fluid: a few hundred Lennard-Jones particles moved by the plainest loop.

use lennard_core::random::Streams;
use lennard_core::{
    DMat3, DVec3, Energetics, Momentum, Own, PeriodicBox, Species, SpeciesTable, State, System,
    View,
};
use lennard_observables::{
    BuildContext, EinsteinFrequencyOptions, Estimate, MeanSquareDisplacement, MsdOptions,
    Observable, PairEnd, RadialDistribution, RdfOptions, Recipe, Thermodynamics, VacfOptions,
    VelocityAutocorrelation,
};
use rand_distr::{Distribution, StandardNormal};

const N: usize = 108;
const R_CUT: f64 = 2.5;
const DT: f64 = 0.004;
const EVERY: u64 = 5;

/// U′(r) and U″(r) of the Lennard-Jones potential.
fn derivatives(r2: f64) -> (f64, f64) {
    let (inv_r2, r) = (1.0 / r2, r2.sqrt());
    let s6 = inv_r2.powi(3);
    (-24.0 * (2.0 * s6 * s6 - s6) / r, 24.0 * (26.0 * s6 * s6 - 7.0 * s6) * inv_r2)
}

/// Forces and totals of the plain cutoff, by the double loop.
fn forces(cell: &PeriodicBox, state: &mut State) {
    let (mut energy, mut shifted, mut laplacian) = (0.0, 0.0, 0.0);
    let mut virial = DMat3::ZERO;
    let s6 = R_CUT.powi(-6);
    let at_cut = 4.0 * (s6 * s6 - s6);
    state.forces.fill(DVec3::ZERO);
    for i in 0..state.positions.len() {
        for j in i + 1..state.positions.len() {
            let d = cell.minimum_image(state.positions[i] - state.positions[j]);
            let r2 = d.length_squared();
            if r2 > R_CUT * R_CUT {
                continue;
            }
            let (first, second) = derivatives(r2);
            let s6 = r2.powi(-3);
            let u = 4.0 * (s6 * s6 - s6);
            let f = -first / r2.sqrt() * d;
            energy += u;
            shifted += u - at_cut;
            laplacian += 2.0 * (second + 2.0 * first / r2.sqrt());
            virial += DMat3::from_cols(f * d.x, f * d.y, f * d.z);
            state.forces[i] += f;
            state.forces[j] -= f;
        }
    }
    state.energetics = Energetics {
        potential_energy: Some(energy),
        conserved_potential: Some(shifted),
        virial: Some(virial),
        laplacian: Some(laplacian),
        virial_trace: None,
        pairs: None,
        per_particle: None,
    };
}

/// A lattice of 3³ cells, stirred at ρ = 0.8 until it is a fluid near T = 1.2.
fn fluid(cell: &PeriodicBox) -> State {
    let a = cell.lengths().x / 3.0;
    let basis = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
    let positions: Vec<DVec3> = (0..N)
        .map(|i| {
            let corner = DVec3::new((i / 36) as f64, (i / 12 % 3) as f64, (i / 4 % 3) as f64);
            (corner + DVec3::from_array(basis[i % 4])) * a
        })
        .collect();
    let mut rng = Streams::new(5).sequential("velocities");
    let mut velocities: Vec<DVec3> = (0..N)
        .map(|_| DVec3::from_array(std::array::from_fn(|_| StandardNormal.sample(&mut rng))))
        .collect();
    let mean = velocities.iter().sum::<DVec3>() / N as f64;
    velocities.iter_mut().for_each(|v| *v -= mean);
    let mut state = State::new(*cell, positions, velocities);
    forces(cell, &mut state);
    let system = System::atoms(N);
    for step in 0..2500 {
        advance(cell, &mut state);
        if step < 1500 && step % 10 == 0 {
            let factor = (1.2 / system.temperature(&state.velocities, Momentum::Conserved)).sqrt();
            state.velocities.iter_mut().for_each(|v| *v *= factor);
        }
    }
    state
}

/// One step of velocity Verlet.
fn advance(cell: &PeriodicBox, state: &mut State) {
    for i in 0..state.positions.len() {
        state.velocities[i] += 0.5 * DT * state.forces[i];
        state.positions[i] += DT * state.velocities[i];
    }
    forces(cell, state);
    for i in 0..state.positions.len() {
        state.velocities[i] += 0.5 * DT * state.forces[i];
    }
    state.step += 1;
    state.time += DT;
}

#[test]
fn temperature_diffusion_and_structure_of_a_fluid_agree_by_independent_roads() {
    let cell = PeriodicBox::cubic_for_density(N, 0.8).unwrap();
    let context = BuildContext {
        cell,
        n_atoms: N,
        own: Own::all_of(N),
        dt: DT,
        every: EVERY,
        r_cut: R_CUT,
        molecules: lennard_core::Molecules::ATOMS,
        species: SpeciesTable::one(Species::unnamed(), N),
        insertion: None,
    };
    let mut thermodynamics = Thermodynamics::new(&context);
    thermodynamics.set_ends(vec![PairEnd {
        r_cut: R_CUT,
        slope: derivatives(R_CUT * R_CUT).0,
        shift: 0.0,
    }]);
    let mut msd = MeanSquareDisplacement::new(&MsdOptions::default(), &context).unwrap();
    let options = VacfOptions { window: 2.0, ..VacfOptions::default() };
    let mut vacf = VelocityAutocorrelation::new(&options, &context).unwrap();
    let mut rdf = RadialDistribution::new(&RdfOptions::default(), &context).unwrap();
    let mut einstein = EinsteinFrequencyOptions {}.build(&context).unwrap();
    let mut squared_force = 0.0;
    let mut state = fluid(&cell);
    let system = System::atoms(N);
    for step in 0..10_000_u64 {
        advance(&cell, &mut state);
        if step % EVERY != 0 {
            continue;
        }
        let view = View::of(&state, &system);
        thermodynamics.sample(&view);
        msd.sample(&view);
        vacf.sample(&view);
        einstein.sample(&view);
        squared_force += state.forces.iter().map(|f| f.length_squared()).sum::<f64>();
        if step % 50 == 0 {
            rdf.sample(&view);
        }
    }
    let all = [
        thermodynamics.finish(0.0),
        msd.finish(0.0),
        vacf.finish(0.0),
        rdf.finish(0.0),
        einstein.finish(0.0),
    ];
    let average = |name: &str| -> Estimate {
        all.iter()
            .flat_map(|f| &f.averages)
            .find(|a| a.name == name)
            .unwrap_or_else(|| panic!("no {name}"))
            .estimate
    };
    let agree = |a: Estimate, b: Estimate| {
        let apart = (a.mean - b.mean).abs() / a.standard_error.hypot(b.standard_error);
        assert!(apart < 4.0, "{a:?} {b:?}");
    };
    let temperature = average("temperature");
    agree(temperature, average("configurational_temperature"));
    assert!(temperature.standard_error < 0.006);

    // ⟨F²⟩ = m·T·⟨∇²U⟩, and the velocity forgets itself as 1 − Ω_E²·t²/2 + O(t⁴): a tenth of it at the first lag.
    let frequency = average("einstein_frequency");
    let samples = 10_000.0 / EVERY as f64 * 3.0 * N as f64;
    let by_forces = (squared_force / samples / temperature.mean).sqrt();
    assert!((frequency.mean / by_forces - 1.0).abs() < 0.01, "{frequency:?} {by_forces}");
    let remembered = all[2].tables[0].columns[1].numbers();
    let lag = EVERY as f64 * DT;
    let by_velocities = (2.0 * (1.0 - remembered[1] / remembered[0])).sqrt() / lag;
    assert!((frequency.mean / by_velocities - 1.0).abs() < 0.05, "{frequency:?} {by_velocities}");

    // Two roads to D, sampled from the same run: both have errors below 8 %.
    let diffusion = average("diffusion_coefficient_uncorrected");
    let green_kubo = average("diffusion_coefficient_green_kubo");
    agree(diffusion, green_kubo);
    assert!(diffusion.standard_error < 0.08 * diffusion.mean);
    assert!(green_kubo.standard_error < 0.08 * green_kubo.mean);

    // A dense liquid: some twelve neighbors, as in the close-packed lattice.
    let neighbors = average("coordination_number");
    assert!((11.0..13.0).contains(&neighbors.mean), "{neighbors:?}");

    // The energy once more, from g(r): U/N = ½(N − 1)/V·Σ g·U·(shell), up to the cutoff.
    let table = &all[3].tables[0];
    let radii = table.columns[0].numbers();
    let width = radii[1] - radii[0];
    let energy: f64 = radii
        .iter()
        .zip(&table.columns[1].numbers())
        .filter(|(r, _)| **r < R_CUT)
        .map(|(r, g)| {
            let (s6, shell) = (r.powi(-6), 4.0 * std::f64::consts::PI * r * r * width);
            0.5 * (N - 1) as f64 / cell.volume() * g * shell * 4.0 * (s6 * s6 - s6)
        })
        .sum();
    let direct = average("potential_energy");
    // Bins of 0.011 σ replace U by its value in the middle. This errs by w²/24·U″, with U″ up to 500 where g
    // is not zero: 1e-3 of each of a dozen pairs. g comes from every tenth sample.
    assert!(
        (energy - direct.mean).abs() < 0.02 + 4.0 * direct.standard_error,
        "{energy} {direct:?}"
    );

    let kept = thermodynamics.conservation();
    assert!(kept.energy_drift_per_atom_per_tau.abs() < 4.0 * kept.energy_drift_standard_error);
    // At this step, the conserved energy of velocity Verlet fluctuates by some 1e-4, and the kinetic energy
    // alone by 0.05.
    assert!(kept.energy_rms_per_atom < 1e-3);
    // 10,000 steps of 108 kicks of size 0.1, each rounded to 2⁻⁵³.
    assert!(kept.momentum_per_atom < 1e-13);
}
