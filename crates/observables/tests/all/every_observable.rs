//! What holds for each entry of the list.

use glam::Vec3Swizzles;
use lennard_core::random::Streams;
use lennard_core::{
    Bonds, DMat3, DVec3, Energetics, Molecules, Own, PeriodicBox, Species, SpeciesTable, State,
    StateArchive, System, View,
};
use lennard_observables::{
    BuildContext, Insertion, MsdOptions, Observable, ObservableOptions, ObservableSpec, Suits,
    TrialEnergies, build, observables,
};
use rand_distr::{Distribution, StandardNormal};

const N: usize = 60;

fn context() -> BuildContext {
    context_of(N)
}

fn context_of(n_atoms: usize) -> BuildContext {
    BuildContext {
        cell: PeriodicBox::new(DVec3::splat(12.0)).unwrap(),
        n_atoms,
        own: Own::all_of(n_atoms),
        dt: 0.005,
        every: 10,
        r_cut: 2.5,
        molecules: lennard_core::Molecules::ATOMS,
        species: species(n_atoms, 1),
        insertion: Some(Insertion {
            temperature: 2.0,
            streams: Streams::new(3),
            energies: std::sync::Arc::new(LennardJones),
        }),
    }
}

/// Trial particles that see all species alike.
#[derive(Debug)]
struct LennardJones;

impl TrialEnergies for LennardJones {
    fn cutoff(&self, _a: usize, _b: usize) -> f64 {
        2.5
    }

    fn sum(&self, _a: usize, _b: usize, squared_distances: &[f64]) -> f64 {
        let sixth = squared_distances.iter().map(|r2| r2.powi(-3));
        sixth.map(|x| 4.0 * x * (x - 1.0)).sum()
    }

    fn tail(&self, _a: usize) -> f64 {
        -30.0
    }
}

/// Particles of `kinds` species in turn.
fn species(n_atoms: usize, kinds: usize) -> SpeciesTable {
    let names = &["A", "B", "C"][..kinds];
    let all: Vec<Species> = names
        .iter()
        .map(|name| Species { name: (*name).to_owned(), ..Species::unnamed() })
        .collect();
    let of: Vec<u8> = (0..n_atoms).map(|i| (i % kinds) as u8).collect();
    SpeciesTable::new(all, &of)
}

/// The context of an observable: chains of three sites where it is for molecules alone, and as many species as it needs.
fn context_for(options: &ObservableOptions, n_atoms: usize) -> BuildContext {
    BuildContext {
        molecules: molecules_for(options.spec()),
        species: species(n_atoms, options.spec().species[0]),
        ..context_of(n_atoms)
    }
}

fn molecules_for(spec: &ObservableSpec) -> Molecules {
    match spec.suits {
        Suits::Molecules => Molecules::chains(3, 1.0, Bonds::Springs),
        Suits::All | Suits::Atoms | Suits::OneSpecies => Molecules::ATOMS,
    }
}

/// Shows a view to an observable, as chains where it is for molecules alone.
fn sample(observable: &mut dyn Observable, view: &View<'_>) {
    let molecules = molecules_for(observable.spec());
    let system = System::of_molecules(view.state.len(), molecules);
    observable.sample(&View { system: &system, shared: Default::default(), ..*view });
}

/// A state of a random walk, with everything that an observable may ask for.
fn walk(samples: u64, look: impl FnMut(u64, &View<'_>)) {
    walk_of(N, samples, look);
}

fn walk_of(n: usize, samples: u64, mut look: impl FnMut(u64, &View<'_>)) {
    let context = context_of(n);
    let noise = Streams::new(11).noise("walk");
    let normal = |step: u64, i: usize| -> DVec3 {
        let mut rng = noise.at(step, i as u32);
        DVec3::from_array(std::array::from_fn(|_| StandardNormal.sample(&mut rng)))
    };
    let start: Vec<DVec3> = (0..n).map(|i| 4.0 * normal(u64::MAX, i)).collect();
    let mut state = State::new(context.cell, start, vec![DVec3::ZERO; n]);
    let system = System::atoms(n);
    for s in 0..samples {
        for i in 0..n {
            state.velocities[i] = normal(s, i);
            state.positions[i] += 0.05 * state.velocities[i];
            state.forces[i] = 3.0 * state.velocities[i].zxy();
        }
        state.step = s * context.every;
        state.time = state.step as f64 * context.dt;
        let w = normal(s, n);
        state.energetics = Energetics {
            potential_energy: Some(-5.0 * n as f64 + w.x),
            conserved_potential: Some(-4.9 * n as f64 + w.x),
            virial: Some(DMat3::from_diagonal(w) * 100.0),
            laplacian: Some(300.0 * n as f64 + w.y),
            virial_trace: None,
            pairs: Some(1),
            per_particle: Some(
                (0..n).map(|i| (-5.0 + 0.1 * w.z * i as f64, DMat3::from_diagonal(w))).collect(),
            ),
        };
        look(s, &View { heat: 0.01 * s as f64, ..View::of(&state, &system) });
    }
}

fn saved(observable: &dyn Observable) -> StateArchive {
    let mut archive = StateArchive::default();
    observable.save(&mut archive.writer());
    archive
}

#[test]
fn the_list_the_names_and_the_scene_tables_agree() {
    let all = ObservableOptions::all();
    assert_eq!(all.len(), observables().len());
    for (options, spec) in all.iter().zip(observables()) {
        assert_eq!(options.name(), spec.name);
        assert!(options.spec().every > 0);
        let written = toml::to_string(options).unwrap();
        assert!(written.contains(&format!("kind = \"{}\"", spec.name)), "{written}");
        assert_eq!(&toml::from_str::<ObservableOptions>(&written).unwrap(), options);
        let minimal = format!("kind = \"{}\"", spec.name);
        assert_eq!(&toml::from_str::<ObservableOptions>(&minimal).unwrap(), options);
        let misspelt = format!("{minimal}\nr_maxx = 3.0");
        let error = toml::from_str::<ObservableOptions>(&misspelt).unwrap_err();
        assert!(error.to_string().contains("r_maxx"), "{error}");
        let built = build(options, &context_for(options, N)).unwrap();
        assert_eq!(built.spec().name, spec.name);
        for text in [spec.summary, spec.equation, spec.source] {
            assert!(!text.is_empty());
        }
    }
}

/// Observables that take over in the middle of a walk what others saved end with the bits of those that saw all of it.
fn go_on_to_the_bit(
    make: &dyn Fn() -> Vec<Box<dyn Observable>>,
    look: &dyn Fn(&mut dyn Observable, &View<'_>),
) {
    let (mut whole, mut first, mut second) = (make(), make(), make());
    walk(120, |s, view| {
        if s == 57 {
            for (a, b) in first.iter().zip(&mut second) {
                b.restore(&saved(a.as_ref()).reader()).unwrap();
            }
        }
        let parts = if s < 57 { &mut first } else { &mut second };
        whole.iter_mut().chain(parts).for_each(|observable| look(observable.as_mut(), view));
    });
    for (k, a) in whole.iter().enumerate() {
        let (name, archive) = (a.spec().name, saved(a.as_ref()));
        assert!(!archive.arrays.is_empty(), "{name} saves nothing");
        assert!(archive == saved(second[k].as_ref()), "{name}");
        // As text, for which NaN equals NaN.
        assert_eq!(format!("{:?}", a.finish(0.0)), format!("{:?}", second[k].finish(0.0)));
        assert!(archive != saved(first[k].as_ref()), "{name}: nothing happened after the restart");
    }
}

#[test]
fn an_observable_restored_in_the_middle_ends_with_the_same_bits() {
    // Every default, and the options under which more of the state is used.
    let mut options = ObservableOptions::all();
    options.push(ObservableOptions::Msd(MsdOptions {
        viscosity: Some(2.0),
        particles: 17,
        ..MsdOptions::default()
    }));
    go_on_to_the_bit(
        &|| options.iter().map(|o| build(o, &context_for(o, N)).unwrap()).collect(),
        &sample,
    );
}

#[test]
fn an_observable_of_a_mixture_restored_in_the_middle_ends_with_the_same_bits() {
    let context = BuildContext { species: species(N, 3), ..context() };
    let system = System::of_species(context.species.clone());
    let make = |context: &BuildContext| -> Vec<Box<dyn Observable>> {
        ObservableOptions::all()
            .iter()
            .filter(|o| molecules_for(o.spec()).are_atoms())
            .filter(|o| {
                let [least, most] = o.spec().species;
                (least..=most).contains(&context.species.n_species())
            })
            .map(|o| build(o, context).unwrap())
            .collect()
    };
    go_on_to_the_bit(&|| make(&context), &|observable, view| {
        observable.sample(&View { system: &system, shared: Default::default(), ..*view });
    });
    // What was counted by species is not taken for a pure fluid's, nor missed.
    for name in ["rdf", "msd", "vacf", "structure-factor", "kirkwood-buff", "thermodynamics"] {
        let of = |all: Vec<Box<dyn Observable>>| {
            let mut all = all.into_iter();
            all.find(|o| o.spec().name == name).unwrap()
        };
        let archive = saved(of(make(&self::context())).as_ref());
        assert!(of(make(&context)).restore(&archive.reader()).is_err(), "{name}");
    }
}

#[test]
fn a_range_beyond_half_the_box_a_window_of_few_samples_and_no_wave_vector_are_refused() {
    let built = |name: &str, key: &str, value: &str| {
        let options: ObservableOptions =
            toml::from_str(&format!("kind = {name:?}\n{key} = {value}")).unwrap();
        build(&options, &context_for(&options, N)).err().map(|error| error.key())
    };
    for name in ["rdf", "kirkwood-buff", "bond-order"] {
        assert_eq!(built(name, "r_max", "6.0"), None, "{name}");
        assert_eq!(built(name, "r_max", "6.1"), Some("r_max"), "{name}");
    }
    for name in ["vacf", "shear-viscosity", "thermal-conductivity", "mutual-diffusion"] {
        assert_eq!(built(name, "window", "0.01"), Some("window"), "{name}");
        assert_eq!(built(name, "window", "nan"), Some("window"), "{name}");
    }
    assert_eq!(built("structure-factor", "k_max", "0.1"), Some("k_max"));
}

#[test]
fn a_saved_state_of_another_run_is_refused() {
    for options in ObservableOptions::all() {
        let mut built = build(&options, &context_for(&options, N)).unwrap();
        let empty = StateArchive::default();
        assert!(built.restore(&empty.reader()).is_err(), "{}", options.name());
    }
}

#[test]
fn findings_have_the_same_bits_on_any_number_of_threads() {
    // More than one task of the exact sums.
    let n = lennard_core::parallel::CHUNK + 1;
    let run = |threads: usize| -> Vec<StateArchive> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut all: Vec<_> = ObservableOptions::all()
            .iter()
            .map(|o| build(o, &context_for(o, n)).unwrap())
            .collect();
        walk_of(n, 6, |_, view| {
            pool.install(|| all.iter_mut().for_each(|o| sample(o.as_mut(), view)));
        });
        all.iter().map(|o| saved(o.as_ref())).collect()
    };
    assert!(run(1) == run(3));
}

#[test]
fn only_what_is_needed_is_asked_of_the_forces() {
    let wants = |name: &str| {
        let options = ObservableOptions::all().into_iter().find(|o| o.name() == name).unwrap();
        build(&options, &context_for(&options, N)).unwrap().want()
    };
    for name in
        ["momentum", "rdf", "msd", "vacf", "structure-factor", "kirkwood-buff", "mutual-diffusion"]
    {
        assert!(wants(name).is_nothing(), "{name}");
    }
    let tensor = wants("pressure-tensor");
    assert!(tensor.virial_tensor && tensor.virial && !tensor.energy && !tensor.laplacian);
    assert_eq!(wants("thermodynamics"), lennard_core::Want::TOTALS);
    let without: ObservableOptions =
        toml::from_str("kind = \"thermodynamics\"\nconfigurational_temperature = false").unwrap();
    assert_eq!(build(&without, &context()).unwrap().want(), lennard_core::Want::ENERGY_AND_VIRIAL);
}

#[test]
fn every_table_has_columns_of_equal_length_and_every_average_is_a_number() {
    let mut all: Vec<_> =
        ObservableOptions::all().iter().map(|o| build(o, &context_for(o, N)).unwrap()).collect();
    for observable in &all {
        // Nothing seen: no panic, and no number that pretends to be one.
        for average in observable.finish(0.0).averages {
            assert!(average.estimate.mean.is_nan(), "{}", average.name);
        }
    }
    walk(180, |_, view| all.iter_mut().for_each(|o| sample(o.as_mut(), view)));
    let mut names = Vec::new();
    for observable in &all {
        let findings = observable.finish(0.0);
        for table in &findings.tables {
            let rows = table.rows();
            assert!(table.columns.iter().all(|c| c.cells.len() == rows), "{}", table.name);
            names.push(table.name.clone());
        }
        for average in &findings.averages {
            assert!(average.estimate.mean.is_finite(), "{}", average.name);
            assert!(average.estimate.standard_error >= 0.0, "{}", average.name);
            names.push(format!("average {}", average.name));
        }
    }
    let count = names.len();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), count, "a name is used twice: {names:?}");
}
