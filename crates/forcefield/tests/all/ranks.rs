//! Ranks that share lists and steps have the bits of one process.

use std::hash::{DefaultHasher, Hash, Hasher};

use crate::common::*;
use lennard_core::random::Streams;
use lennard_core::{
    Array, Backend, Configuration, DVec3, ForceTerm, FrictionAndNoise, FusedBath, FusedSteps,
    Masses, Parcel, Part, PeriodicBox, Persist, SpeedLimit, StateArchive, Team, Want, Wire,
    team_of_threads,
};
use lennard_forcefield::{
    Conditions, ForceFieldOptions, KernelOptions, Mixture, PairForces, Precision, TruncationKind,
    TruncationOptions, build,
};

/// Runs `work` on each rank of a team, each with so many threads.
fn on_ranks<R: Send>(ranks: usize, threads: usize, work: impl Fn(&Team) -> R + Sync) -> Vec<R> {
    team_of_threads(ranks, |team| in_threads(threads, || work(&team)))
}

/// No particle is too fast.
const LIMIT: SpeedLimit = SpeedLimit { every: 20, largest: f64::INFINITY };

/// What happens between two evaluations.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Isolated,
    Bath(u64),
    Noise,
}

struct Fluid {
    cell: PeriodicBox,
    positions: Vec<DVec3>,
    velocities: Vec<DVec3>,
}

/// A liquid in which one particle in 40 is so fast that lists lack pairs before they expire.
fn fluid(k: [usize; 3], density: f64) -> Fluid {
    let (cell, positions) = liquid(k, density, 0.1);
    let noise = scatter(positions.len(), DVec3::splat(4.0), 0.7);
    let velocities = noise.iter().map(|v| *v - DVec3::splat(2.0)).enumerate();
    let speed = |k: usize| if k.is_multiple_of(40) { 4.0 } else { 2.0 };
    Fluid {
        cell,
        positions,
        velocities: velocities.map(|(k, v)| v.normalize() * speed(k)).collect(),
    }
}

/// A number that follows from each bit of the vectors of all ranks.
fn fingerprint(team: Option<&Team>, vectors: &[DVec3]) -> u64 {
    let words: Vec<u64> = vectors.iter().flat_map(|v| v.to_array().map(f64::to_bits)).collect();
    let words = team.map_or(words.clone(), |team| team.concat(&words));
    let mut hasher = DefaultHasher::new();
    words.hash(&mut hasher);
    hasher.finish()
}

/// Everything that a history leaves behind, to the bit: numbers are written so that each bit shows. A rank has its particles.
fn history(
    start: &Fluid,
    forces: &mut PairForces,
    kind: Kind,
    rounds: usize,
    team: Option<&Team>,
) -> Vec<String> {
    let mut cell = start.cell;
    let own = team.map_or(0..start.positions.len(), |team| team.numbers(start.positions.len()));
    let mut positions = start.positions[own.clone()].to_vec();
    let mut velocities = start.velocities[own].to_vec();
    let masses = Masses::Uniform(1.5);
    let mut bath = match kind {
        Kind::Bath(every) => Some(Sensitive { every, acted: 0 }),
        _ => None,
    };
    let noise = FrictionAndNoise {
        friction: 0.7,
        temperature: 0.9.into(),
        noise: Streams::new(5).noise("langevin"),
    };
    let mut told = Vec::new();
    let mut step = 0;
    for round in 0..rounds {
        let want = match round % 3 {
            0 => Want { per_particle: true, virial_tensor: true, ..Want::TOTALS },
            1 => Want::NOTHING,
            _ => Want::TOTALS,
        };
        let n = positions.len();
        let mut f = vec![DVec3::ZERO; n];
        let at = Configuration::at_rest(&cell, &positions);
        let mut found = forces.evaluate(at, Part::All, want, &mut f);
        // Where it fails, forces have no meaning.
        let f = found.is_ok().then(|| fingerprint(team, &f));
        let [x, v] = [&positions, &velocities].map(|vectors| fingerprint(team, vectors));
        if let Some(each) = found.as_mut().ok().and_then(|found| found.per_particle.take()) {
            let vectors = each.iter().flat_map(|(energy, virial)| {
                [DVec3::X * *energy, virial.x_axis, virial.y_axis, virial.z_axis]
            });
            told.push(fingerprint(team, &vectors.collect::<Vec<DVec3>>()).to_string());
        }
        told.push(format!("{found:?} {f:?} {x} {v}"));
        let mut steps = FusedSteps {
            cell: &cell,
            positions: &mut positions,
            velocities: &mut velocities,
            forces: &mut vec![DVec3::NAN; n],
            masses: &masses,
            dt: DT,
            steps: 17 + round as u64,
            first: 0,
            bath: match kind {
                Kind::Noise => Some(FusedBath::noise(noise, DT, step)),
                _ => bath.as_mut().map(|bath| FusedBath::scaling(bath, 12.0, DT, step)),
            },
        };
        let taken = forces.advance(&mut steps);
        // Where no step is taken, heats have no meaning.
        let heats = (taken > 0).then_some(steps.bath.map(FusedBath::into_heats));
        told.push(format!("{taken} {heats:?}"));
        step += taken;
        let mut archive = StateArchive::default();
        forces.save(&mut archive.writer());
        // Times are no part of the state.
        let kept = (archive.arrays.iter()).filter(|(name, _)| !name.ends_with("seconds"));
        if round == 0 {
            forces.restore(&archive.reader()).unwrap();
            let mut again = StateArchive::default();
            forces.save(&mut again.writer());
            assert!(kept.clone().all(|(name, array)| again.arrays[name] == *array), "{kind:?}");
        }
        told.extend(kept.map(|(name, array)| match array {
            Array::Vec3(vectors) => format!("{name} {}", fingerprint(team, vectors)),
            array => format!("{name} {array:?}"),
        }));
        if round % 4 == 3 {
            // The box changes a little, as a barostat changes it.
            let factor = DVec3::new(1.001, 0.999, 1.0005);
            cell = PeriodicBox::new(cell.lengths() * factor).unwrap();
            positions.iter_mut().for_each(|r| *r *= factor);
        }
    }
    told.push(format!("{}", forces.statistics().builds));
    told
}

fn options(kernel: KernelOptions) -> ForceFieldOptions {
    ForceFieldOptions {
        kernel,
        truncation: TruncationOptions::new(TruncationKind::Shift, 2.3),
        neighbor: verlet(Some(0.4)),
        ..ForceFieldOptions::default()
    }
}

fn compare(
    start: &Fluid,
    fresh: impl Fn() -> PairForces + Sync,
    kind: Kind,
    teams: &[[usize; 2]],
) -> Vec<String> {
    let alone = history(start, &mut fresh(), kind, 7, None);
    for [ranks, threads] in teams {
        let found = on_ranks(*ranks, *threads, |team| {
            let mut forces = fresh();
            assert!(forces.share(team, &start.cell, LIMIT).unwrap());
            (history(start, &mut forces, kind, 7, Some(team)), team.statistics())
        });
        for (rank, (told, statistics)) in found.iter().enumerate() {
            for (k, (a, b)) in told.iter().zip(&alone).enumerate() {
                let cut = |s: &String| s.chars().take(300).collect::<String>();
                assert!(
                    a == b,
                    "{kind:?}, {ranks} ranks, {threads} threads: rank {rank} differs at {k} of {}:\n{}\n{}",
                    alone.len(),
                    cut(a),
                    cut(b)
                );
            }
            assert_eq!(told.len(), alone.len());
            assert_eq!(statistics.halo > 0.0, *ranks > 1);
        }
    }
    alone
}

#[test]
fn any_number_of_ranks_and_threads_has_the_bits_of_one_process() {
    // A thin box has bundles of part of a column, and a cube has more ranks than bundles along a side.
    for (k, teams) in
        [([17, 16, 16], &[[1, 1], [2, 2], [5, 1]][..]), ([31, 29, 5], &[[3, 1], [4, 2]])]
    {
        let start = fluid(k, 0.75);
        let n = start.positions.len();
        for kernel in kernels() {
            for (kind, species) in [
                (Kind::Isolated, 1),
                (Kind::Isolated, 2),
                (Kind::Bath(1), 1),
                (Kind::Bath(10), 2),
                (Kind::Noise, 1),
            ] {
                let mixture: Option<Mixture> = mixture_or_one(species, 2.3, n);
                let fresh = || built(&options(kernel), mixture.as_ref(), start.cell, n);
                compare(&start, fresh, kind, teams);
            }
        }
    }
}

#[test]
fn particles_many_boxes_away_are_sorted_by_all_ranks_alike() {
    let mut start = fluid([16, 17, 16], 0.75);
    let n = start.positions.len();
    // Fixed point folds what is farther than 131,072 boxes.
    let away = start.cell.lengths() * DVec3::new(2e5, -3e5, 1e5);
    let some = start.positions.iter_mut().step_by(3);
    some.for_each(|r| *r += away);
    for kernel in kernels() {
        let fresh = || build(&options(kernel), &conditions(start.cell, n)).unwrap();
        let told = compare(&start, fresh, Kind::Isolated, &[[2, 1], [3, 2]]);
        // Lists are built inside of fused steps, where ranks know their own particles alone.
        let builds: u64 = told.last().unwrap().parse().unwrap();
        assert!(builds > 7, "{kernel:?}: {builds}");
    }
}

#[test]
fn groups_in_several_columns_see_what_lies_beside_them_in_a_thin_box() {
    let start = fluid([46, 47, 2], 0.05);
    let n = start.positions.len();
    for kernel in kernels() {
        let fresh = || build(&options(kernel), &conditions(start.cell, n)).unwrap();
        compare(&start, fresh, Kind::Isolated, &[[2, 1], [5, 1]]);
    }
}

/// A gas in which pairs that no list names fly at each other, and meet while the list still lasts.
fn meeting_pairs(k: [usize; 3]) -> Fluid {
    let Fluid { cell, mut positions, mut velocities } = fluid(k, 0.05);
    velocities.iter_mut().for_each(|v| *v = v.normalize() * 0.3);
    let toward = DVec3::ONE.normalize();
    for first in (0..30).map(|pair| 60 * pair) {
        let other = first + 30;
        positions[other] = positions[first] + toward * 2.75;
        velocities[first] = toward * 4.0;
        velocities[other] = toward * -4.0;
    }
    Fluid { cell, positions, velocities }
}

#[test]
fn pairs_that_lists_lack_are_found_and_inserted_by_all_ranks_alike() {
    for k in [[16, 17, 16], [26, 25, 26]] {
        let start = meeting_pairs(k);
        let n = start.positions.len();
        for kernel in kernels() {
            let fresh = || build(&options(kernel), &conditions(start.cell, n)).unwrap();
            for kind in [Kind::Isolated, Kind::Bath(3)] {
                let told = compare(&start, fresh, kind, &[[2, 1], [3, 2], [4, 1]]);
                let mut inserted = told.iter().filter(|line| line.starts_with("list/inserted"));
                assert_eq!(
                    inserted.any(|line| line.matches(',').count() > 20),
                    kernel.precision == Precision::Mixed,
                    "{kernel:?}, {kind:?}"
                );
            }
        }
    }
}

#[test]
fn pairs_that_one_end_alone_lacks_are_told_to_the_rank_of_that_end() {
    let mut start = fluid([26, 25, 26], 0.75);
    start.velocities.iter_mut().for_each(|v| *v *= 0.1);
    let n = start.positions.len();
    // In a dense fluid, the other end lists many of them for another member of its cluster.
    for first in (0..n - 2000).step_by(70) {
        let apart = |other: usize| {
            start.cell.minimum_image(start.positions[other] - start.positions[first])
        };
        let mut others = first + 1..first + 2000;
        let other = others.find(|k| (2.72..2.78).contains(&apart(*k).length()));
        if let Some((other, toward)) = other.map(|k| (k, apart(k).normalize())) {
            start.velocities[first] = toward * 4.0;
            start.velocities[other] = toward * -4.0;
        }
    }
    let kernel = KernelOptions { precision: Precision::Mixed, ..KernelOptions::default() };
    let fresh = || build(&options(kernel), &conditions(start.cell, n)).unwrap();
    let told = compare(&start, fresh, Kind::Isolated, &[[2, 1], [4, 1], [7, 1]]);
    let mut inserted = told.iter().filter(|line| line.starts_with("list/inserted"));
    assert!(inserted.any(|line| line.matches(',').count() > 100));
}

#[test]
fn a_rank_keeps_all_pairs_of_its_checkpoint_even_where_one_entry_serves_several() {
    let start = fluid([26, 25, 26], 0.75);
    let n = start.positions.len();
    let apart = |a: usize, b: usize| {
        start.cell.minimum_image(start.positions[a] - start.positions[b]).length()
    };
    // Neighbors of each other often share a cluster: the pair of the first one serves them all.
    let around =
        |b: usize| (0..n).filter(move |a| (2.8..3.0).contains(&apart(*a, b))).map(move |a| [a, b]);
    let saved: Vec<u64> =
        (5..n).step_by(1900).flat_map(around).flatten().map(|k| k as u64).collect();
    let kernel = KernelOptions { precision: Precision::Mixed, ..KernelOptions::default() };
    let kept = |team: Option<&Team>| {
        let own = team.map_or(0..n, |team| team.numbers(n));
        let positions = &start.positions[own];
        let mut forces = build(&options(kernel), &conditions(start.cell, n)).unwrap();
        assert!(team.is_none_or(|team| forces.share(team, &start.cell, LIMIT).unwrap()));
        let at = Configuration::at_rest(&start.cell, positions);
        let mut f = vec![DVec3::ZERO; positions.len()];
        forces.evaluate(at, Part::All, Want::NOTHING, &mut f).unwrap();
        let mut archive = StateArchive::default();
        forces.save(&mut archive.writer());
        archive.arrays.insert("list/inserted".into(), Array::U64(saved.clone()));
        forces.restore(&archive.reader()).unwrap();
        let mut again = StateArchive::default();
        forces.save(&mut again.writer());
        again.arrays["list/inserted"].clone()
    };
    assert_eq!(kept(None), Array::U64(saved.clone()));
    for ranks in [2, 4] {
        for found in on_ranks(ranks, 1, |team| kept(Some(team))) {
            assert_eq!(found, Array::U64(saved.clone()), "{ranks}");
        }
    }
}

/// A team that loses the last word of each message between two ranks.
struct Lossy(Team);

impl Wire for Lossy {
    fn rank(&self) -> usize {
        self.0.rank()
    }
    fn ranks(&self) -> usize {
        self.0.ranks()
    }
    fn sum(&self, words: &mut [i64]) {
        self.0.sum(words);
    }
    fn max(&self, words: &mut [u64]) {
        self.0.max(words);
    }
    fn trade(&self, words: Vec<Vec<u64>>) -> Vec<Vec<u64>> {
        self.0.trade(words)
    }
    fn exchange(&self, outgoing: &[Parcel], incoming: &mut [Parcel], meanwhile: &mut dyn FnMut()) {
        let before: Vec<_> = incoming.iter().map(|p| p.words.last().copied()).collect();
        self.0.exchange(outgoing, incoming, meanwhile);
        for (parcel, before) in incoming.iter_mut().zip(before) {
            let last = parcel.words.last_mut().zip(before);
            last.into_iter().for_each(|(last, before)| *last = before);
        }
    }
}

#[test]
fn one_word_too_few_in_a_halo_is_seen_in_the_bits() {
    let start = fluid([17, 16, 16], 0.75);
    let n = start.positions.len();
    for kernel in kernels() {
        let fresh = || build(&options(kernel), &conditions(start.cell, n)).unwrap();
        let alone = history(&start, &mut fresh(), Kind::Isolated, 2, None);
        for found in on_ranks(2, 1, |team| {
            let mut forces = fresh();
            let lossy = Team::new(Box::new(Lossy(team.clone())));
            assert!(forces.share(&lossy, &start.cell, LIMIT).unwrap());
            history(&start, &mut forces, Kind::Isolated, 2, Some(team))
        }) {
            assert!(found != alone, "{kernel:?}");
        }
    }
}

#[test]
fn all_ranks_meet_a_failure_in_the_same_step() {
    let mut sound = fluid([17, 16, 16], 0.75);
    let n = sound.positions.len();
    // Two particles meet in one point after some steps.
    let at = sound.positions[300];
    sound.positions[301] = at + DVec3::X * 0.9;
    sound.velocities[300] = DVec3::ZERO;
    let mut infinite = fluid([17, 16, 16], 0.75);
    infinite.velocities[77].y = f64::INFINITY;
    let mut together = fluid([17, 16, 16], 0.75);
    together.positions[301] = together.positions[300];
    for start in [&sound, &infinite, &together] {
        for kernel in kernels() {
            for kind in [Kind::Isolated, Kind::Bath(1), Kind::Noise] {
                let fresh = || build(&options(kernel), &conditions(start.cell, n)).unwrap();
                compare(start, fresh, kind, &[[2, 1], [4, 1]]);
            }
        }
    }
}

#[test]
fn too_many_ranks_are_refused_and_other_searches_are_not_shared() {
    let start = fluid([17, 16, 16], 0.75);
    let at = conditions(start.cell, start.positions.len());
    let options = options(KernelOptions::default());
    for (n, most) in [(3999, 1), (4352, 8)] {
        let at = Conditions { n_atoms: n, ..at };
        let errors = on_ranks(9, 1, |team| {
            build(&options, &at).unwrap().share(team, &start.cell, LIMIT).unwrap_err()
        });
        for error in errors {
            let allowed = format!(
                "9 ranks for {n} particles\n  allowed: at most {most} in this box, since each rank owns a bundle of columns with 500 particles or more"
            );
            assert_eq!(error.to_string(), allowed);
        }
    }
    let canonical = ForceFieldOptions { canonical: true, ..options };
    for shared in on_ranks(2, 1, |team| {
        build(&canonical, &at).unwrap().share(team, &start.cell, LIMIT).unwrap()
    }) {
        assert!(!shared);
    }
}
