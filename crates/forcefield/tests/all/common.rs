//! Configurations and comparisons that the tests share.

use lennard_core::{
    BathStep, Configuration, DVec3, Energetics, ForceError, ForceTerm, Masses, Part, PeriodicBox,
    Persist, RestoreError, StateReader, StateWriter, Thermostat, ThermostatSpec, Want,
};
use lennard_forcefield::{
    Conditions, ForceFieldOptions, Isa, Kernel, KernelOptions, ListMode, Mixture, Model,
    NeighborOptions, PairForces, PotentialOptions, Precision, SpeciesPair, Table, TablePath,
    TruncationKind, TruncationOptions, build,
};

/// The step of tests that move particles, τ.
pub const DT: f64 = 0.004;

/// Reproducible numbers in [0, 1): Weyl's sequence, with one irrational number per axis.
pub fn scatter(n: usize, lengths: DVec3, seed: f64) -> Vec<DVec3> {
    let step = DVec3::new(0.819_172_513, 0.671_043_607, 0.549_700_478);
    (0..n).map(|i| ((i as f64 + 0.5 + seed) * step).fract() * lengths).collect()
}

/// A perturbed simple cubic lattice at this density: distances as in a liquid, without overlap.
pub fn liquid(k: [usize; 3], density: f64, shake: f64) -> (PeriodicBox, Vec<DVec3>) {
    let a = density.powf(-1.0 / 3.0);
    let cell = PeriodicBox::new(DVec3::new(k[0] as f64, k[1] as f64, k[2] as f64) * a).unwrap();
    let noise = scatter(k[0] * k[1] * k[2], DVec3::splat(2.0 * shake), 0.25);
    let mut positions = Vec::new();
    for x in 0..k[0] {
        for y in 0..k[1] {
            for z in 0..k[2] {
                let site = DVec3::new(x as f64, y as f64, z as f64) * a;
                positions.push(site + noise[positions.len()] - DVec3::splat(shake));
            }
        }
    }
    (cell, positions)
}

pub fn conditions(cell: PeriodicBox, n_atoms: usize) -> Conditions<'static> {
    Conditions { cell, n_atoms, temperature: 1.0, dt: DT, mixture: None }
}

pub fn verlet(skin: Option<f64>) -> NeighborOptions {
    NeighborOptions { mode: ListMode::Verlet, skin }
}

/// Every potential with every truncation.
pub fn forms() -> Vec<ForceFieldOptions> {
    forms_of(PotentialOptions::examples())
}

/// These potentials with every truncation that they go with.
pub fn forms_of(potentials: Vec<PotentialOptions>) -> Vec<ForceFieldOptions> {
    let mut all = Vec::new();
    for potential in potentials {
        for &kind in TruncationKind::ALL {
            let truncation = TruncationOptions::new(kind, 2.5);
            if Model::new(&potential, &truncation).is_err() {
                continue;
            }
            all.push(ForceFieldOptions { potential, truncation, ..ForceFieldOptions::default() });
        }
    }
    all
}

/// How far the force of a pair may be off where loops sum rows, as a share of max(|F|, ε/σ); 0 where they compile the form in.
pub fn off_by_rows(o: &ForceFieldOptions, species: usize) -> f64 {
    use TruncationKind::{Cut, ForceShift, Shift, Switch};
    match (o.potential, o.truncation.kind) {
        (PotentialOptions::LennardJones(_), Cut | Shift | ForceShift) => 0.0,
        (PotentialOptions::LennardJones(_), Switch) if species == 1 => 0.0,
        (PotentialOptions::Mie(_) | PotentialOptions::SoftSphere(_), Cut | Shift)
            if species == 1 =>
        {
            0.0
        }
        (PotentialOptions::LjSpline(_), _) if species == 1 => 0.0,
        (PotentialOptions::Wca(_), _) => 0.0,
        (PotentialOptions::Table(table), _) => table.stated_errors().unwrap().1.max(1e-9),
        _ => 1e-9,
    }
}

/// The species of `n` particles, one after another.
pub fn species_of(species: usize, n: usize) -> Vec<u8> {
    (0..n).map(|i| (i % species) as u8).collect()
}

/// A mixture in which each pair of species has σ, ε and a cutoff of its own, near σ = ε = 1.
pub fn mixture(species: usize, r_cut: f64, n: usize) -> Mixture {
    let pair = |a: usize, b: usize| {
        let (a, b) = (a as f64, b as f64);
        SpeciesPair {
            sigma: 1.0 - 0.06 * a - 0.05 * b,
            epsilon: 1.0 + 0.3 * a - 0.1 * b,
            r_cut: r_cut * (1.0 - 0.06 * a - 0.04 * b),
        }
    };
    Mixture::new(species, pair, species_of(species, n)).unwrap()
}

/// Every fast loop that this machine can run.
pub fn kernels() -> Vec<KernelOptions> {
    let mut all = Vec::new();
    for isa in [Isa::Avx512, Isa::Avx2, Isa::Portable] {
        for precision in [Precision::Double, Precision::Mixed] {
            let kernel = KernelOptions { kernel: Kernel::Auto, precision, isa };
            let options = ForceFieldOptions { kernel, ..ForceFieldOptions::default() };
            let cell = PeriodicBox::new(DVec3::splat(10.0)).unwrap();
            let built = build(&options, &conditions(cell, 800));
            // Portable loops are in double precision.
            if built.is_ok_and(|forces| forces.plan().precision == precision) {
                all.push(kernel);
            }
        }
    }
    all
}

pub fn evaluate(
    forces: &mut PairForces,
    cell: PeriodicBox,
    positions: &[DVec3],
    part: Part,
    want: Want,
) -> Result<(Vec<DVec3>, Energetics), ForceError> {
    let mut f = vec![DVec3::ZERO; positions.len()];
    let at = Configuration::at_rest(&cell, positions);
    let e = forces.evaluate(at, part, want, &mut f)?;
    Ok((f, e))
}

pub fn all(
    forces: &mut PairForces,
    cell: PeriodicBox,
    positions: &[DVec3],
    want: Want,
) -> (Vec<DVec3>, Energetics) {
    evaluate(forces, cell, positions, Part::All, want).unwrap()
}

/// Forces for the species of a mixture, where there are several.
pub fn built(
    options: &ForceFieldOptions,
    mixture: Option<&Mixture>,
    cell: PeriodicBox,
    n: usize,
) -> PairForces {
    let at = Conditions { mixture, ..conditions(cell, n) };
    build(options, &at).unwrap()
}

pub fn reference(
    options: &ForceFieldOptions,
    cell: PeriodicBox,
    positions: &[DVec3],
) -> (Vec<DVec3>, Energetics) {
    reference_of(options, None, cell, positions)
}

pub fn reference_of(
    options: &ForceFieldOptions,
    mixture: Option<&Mixture>,
    cell: PeriodicBox,
    positions: &[DVec3],
) -> (Vec<DVec3>, Energetics) {
    let options = ForceFieldOptions {
        kernel: KernelOptions { kernel: Kernel::Reference, ..KernelOptions::default() },
        neighbor: NeighborOptions::default(),
        ..*options
    };
    let want = Want { per_particle: true, virial_tensor: true, ..Want::TOTALS };
    all(&mut built(&options, mixture, cell, positions.len()), cell, positions, want)
}

/// Σ_j |F_ij| and Σ_j (|U″| + |U′/r|) of each particle: the scales of rounding errors.
pub fn magnitudes(
    options: &ForceFieldOptions,
    cell: PeriodicBox,
    positions: &[DVec3],
) -> Vec<(f64, f64)> {
    let one = Mixture::new(
        1,
        |_, _| SpeciesPair::unit(options.truncation.r_cut),
        species_of(1, positions.len()),
    );
    magnitudes_of(options, Some(&one.unwrap()), cell, positions)
}

/// As [`magnitudes`], for the species of a mixture.
pub fn magnitudes_of(
    options: &ForceFieldOptions,
    mixture: Option<&Mixture>,
    cell: PeriodicBox,
    positions: &[DVec3],
) -> Vec<(f64, f64)> {
    let Some(mixture) = mixture else {
        return magnitudes(options, cell, positions);
    };
    let models = models_of(mixture, options);
    let mut sums = vec![(0.0, 0.0); positions.len()];
    for i in 0..positions.len() {
        for j in 0..positions.len() {
            let [a, b] = [i, j].map(|i| usize::from(mixture.of_particle()[i]));
            let (pair, model) = (mixture.pair(a, b), &models[a][b]);
            let r_ij = cell.minimum_image(positions[i] - positions[j]) / pair.sigma;
            let r2 = r_ij.length_squared();
            if i != j && r2 <= model.r_cut * model.r_cut {
                let (force, stiffness) =
                    (pair.epsilon / pair.sigma, pair.epsilon / pair.sigma.powi(2));
                let at = model.eval(r2);
                sums[i].0 += force * (at.force * r2.sqrt()).abs();
                sums[i].1 += stiffness * (at.curvature.abs() + at.force.abs());
            }
        }
    }
    sums
}

/// The table of Lennard-Jones that comes along.
pub fn table() -> PotentialOptions {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../inputs/potential/lennard-jones.table");
    PotentialOptions::Table(Table {
        file: Some(TablePath::from(file.to_owned())),
        tail_exponent: Some(6),
        ..Table::default()
    })
}

/// The model of each pair of species, in units of its own σ and ε.
pub fn models_of(mixture: &Mixture, options: &ForceFieldOptions) -> Vec<Vec<Model>> {
    let model = |a: usize, b: usize| {
        let pair = mixture.pair(a, b);
        let own = TruncationOptions { r_cut: pair.r_cut / pair.sigma, ..options.truncation };
        Model::new(&options.potential, &own).unwrap()
    };
    let species = mixture.species();
    let row = |a| (0..species).map(|b| model(a, b)).collect();
    (0..species).map(row).collect()
}

/// Several species, or none where one is asked for.
pub fn mixture_or_one(species: usize, r_cut: f64, n: usize) -> Option<Mixture> {
    (species > 1).then(|| mixture(species, r_cut, n))
}

pub fn in_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// A bath whose factor shows each bit of the kinetic energy, and how often it has acted.
#[derive(Clone, PartialEq, Debug)]
pub struct Sensitive {
    pub every: u64,
    pub acted: u64,
}

impl Persist for Sensitive {
    fn save(&self, _to: &mut StateWriter<'_>) {}
    fn restore(&mut self, _from: &StateReader<'_>) -> Result<(), RestoreError> {
        Ok(())
    }
}

impl Thermostat for Sensitive {
    fn spec(&self) -> &'static ThermostatSpec {
        unreachable!("no step asks")
    }
    fn acts_after(&self, step: u64) -> bool {
        step.is_multiple_of(self.every)
    }
    fn factor(&mut self, at: BathStep) -> f64 {
        self.acted += 1;
        assert!(at.n_dof == 12.0 && at.dt == DT && at.step.is_multiple_of(self.every));
        1.0 + 0.002 * ((at.kinetic * 1e9).fract() - 0.4 - 0.1 * (self.acted % 3) as f64)
    }
    fn copy(&self) -> Box<dyn Thermostat> {
        Box::new(self.clone())
    }
}

/// The kick v ← v + (h/m)·F by the textbook.
pub fn kick(velocities: &mut [DVec3], forces: &[DVec3], masses: &Masses, h: f64) {
    for (i, (v, f)) in velocities.iter_mut().zip(forces).enumerate() {
        *v += (h / masses.of(i)) * *f;
    }
}

/// The drift x ← x + h·v by the textbook.
pub fn drift(positions: &mut [DVec3], velocities: &[DVec3], h: f64) {
    for (x, v) in positions.iter_mut().zip(velocities) {
        *x += h * *v;
    }
}
