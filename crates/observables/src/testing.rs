//! States for tests.

use lennard_core::random::Streams;
use lennard_core::{DVec3, Own, PeriodicBox, Species, SpeciesTable, State, System, View};
use rand_distr::{Distribution, StandardNormal, StandardUniform};

use crate::{BuildContext, Estimate, Findings};

pub(crate) fn context(side: f64, n_atoms: usize) -> BuildContext {
    BuildContext {
        cell: PeriodicBox::new(DVec3::splat(side)).unwrap(),
        n_atoms,
        own: Own::all_of(n_atoms),
        dt: 0.01,
        every: 1,
        r_cut: 2.5,
        molecules: lennard_core::Molecules::ATOMS,
        species: SpeciesTable::one(Species::unnamed(), n_atoms),
        insertion: None,
    }
}

/// `n` particles of species A, B, …, where `of` tells the number of the species of each. Masses are 1, 2, ….
pub(crate) fn mixture(n: usize, of: impl Fn(usize) -> usize) -> SpeciesTable {
    let of: Vec<u8> = (0..n).map(|i| of(i) as u8).collect();
    let kinds = usize::from(of.iter().copied().max().unwrap_or(0)) + 1;
    let names = ["A", "B", "C", "D"];
    let species: Vec<Species> = (0..kinds)
        .map(|a| Species {
            name: names[a].to_owned(),
            mass: 1.0 + a as f64,
            element: "Ar".to_owned(),
        })
        .collect();
    SpeciesTable::new(species, &of)
}

/// Shows a state at rest with the positions given.
pub(crate) fn view_of(cell: &PeriodicBox, positions: Vec<DVec3>, mut look: impl FnMut(&View<'_>)) {
    let n = positions.len();
    let state = State::new(*cell, positions, vec![DVec3::ZERO; n]);
    look(&View::of(&state, &System::atoms(n)));
}

/// The mean of a name.
#[track_caller]
pub(crate) fn estimate(findings: &Findings, name: &str) -> Estimate {
    let found = findings.averages.iter().find(|a| a.name == name);
    found.unwrap_or_else(|| panic!("{name}: {:?}", findings.remarks)).estimate
}

/// The column of a name in the first table.
#[track_caller]
pub(crate) fn column(findings: &Findings, name: &str) -> Vec<f64> {
    findings.tables[0].numbers(name).unwrap_or_else(|| panic!("no column {name}"))
}

/// Shows samples of particles of two species whose velocities decay at these rates at T = 0.8, and returns D of each species.
///
/// D is by the trapezoidal sum of e^{−γt}, which is h/2·coth(γh/2) in place of 1/γ.
pub(crate) fn under_friction(
    context: &BuildContext,
    (seed, samples): (u64, u64),
    gamma: [f64; 2],
    mut look: impl FnMut(&View<'_>),
) -> [f64; 2] {
    let (n, h, species) = (context.n_atoms, context.dt, &context.species);
    let of = |i: usize| {
        let a = species.of(i);
        let width = (0.8 / species.species(a).mass).sqrt();
        (width, (-gamma[a] * h).exp())
    };
    let start = (0..n).map(|i| of(i).0 * normal(seed, u64::MAX, i)).collect();
    let mut state = State::new(context.cell, vec![DVec3::ZERO; n], start);
    let system = System::of_species(species.clone());
    for s in 0..samples {
        look(&View::of(&state, &system));
        for (i, v) in state.velocities.iter_mut().enumerate() {
            let (width, decay) = of(i);
            *v = decay * *v + width * (1.0 - decay * decay).sqrt() * normal(seed, s, i);
        }
    }
    [0, 1].map(|a| 0.8 / species.species(a).mass * 0.5 * h / (0.5 * gamma[a] * h).tanh())
}

/// Standard normal vectors, a pure function of (seed, step, particle).
pub(crate) fn normal(seed: u64, step: u64, particle: usize) -> DVec3 {
    let mut rng = Streams::new(seed).noise("test").at(step, particle as u32);
    DVec3::from_array(std::array::from_fn(|_| StandardNormal.sample(&mut rng)))
}

/// Uniform random positions in a cube.
pub(crate) fn random_positions(n: usize, side: f64, seed: u64) -> Vec<DVec3> {
    let mut rng = Streams::new(seed).sequential("positions");
    let mut uniform = || -> f64 { StandardUniform.sample(&mut rng) };
    (0..n).map(|_| side * DVec3::new(uniform(), uniform(), uniform())).collect()
}

/// A face-centred cubic lattice of `cells`³ unit cells with nearest neighbors at distance `d`.
pub(crate) fn fcc(cells: usize, d: f64) -> (PeriodicBox, Vec<DVec3>) {
    let a = d * 2.0_f64.sqrt();
    let basis = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
    let mut positions = Vec::new();
    for x in 0..cells {
        for y in 0..cells {
            for z in 0..cells {
                let corner = DVec3::new(x as f64, y as f64, z as f64);
                positions.extend(basis.map(|b| (corner + DVec3::from_array(b)) * a));
            }
        }
    }
    let cell = PeriodicBox::new(DVec3::splat(cells as f64 * a)).unwrap();
    (cell, positions)
}

/// The positions in an order that differs from seed to seed.
pub(crate) fn shuffled(positions: &[DVec3], seed: u64) -> Vec<DVec3> {
    let keys = random_positions(positions.len(), 1.0, seed);
    let mut order: Vec<usize> = (0..positions.len()).collect();
    order.sort_by(|i, j| keys[*i].x.total_cmp(&keys[*j].x));
    order.into_iter().map(|i| positions[i]).collect()
}
