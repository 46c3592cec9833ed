//! What ranks send to each other, counted by kind and compared with the model of `lennard plan --ranks`.

use std::f64::consts::PI;
use std::sync::{Arc, Mutex};

use crate::common::*;
use lennard_core::{
    Backend, DVec3, ForceTerm, FusedSteps, Masses, Parcel, PeriodicBox, SpeedLimit, Team, Wire,
    team_of_threads,
};
use lennard_forcefield::{
    ForceFieldOptions, KernelOptions, PairForces, Precision, TruncationKind, TruncationOptions,
    build,
};

/// Calls, messages and bytes of one kind.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Traffic {
    calls: usize,
    messages: usize,
    bytes: usize,
}

impl Traffic {
    fn add(&mut self, messages: usize, bytes: usize) {
        self.calls += 1;
        self.messages += messages;
        self.bytes += bytes;
    }
}

/// What one rank sent.
#[derive(Debug, Clone, Copy, Default)]
struct Sent {
    sums: Traffic,
    largest: Traffic,
    trades: Traffic,
    exchanges: Traffic,
}

/// A wire that counts what this rank gives.
struct Counting(Team, Arc<Mutex<Sent>>);

impl Counting {
    fn count(&self, add: impl FnOnce(&mut Sent)) {
        add(&mut self.1.lock().unwrap());
    }
}

impl Wire for Counting {
    fn rank(&self) -> usize {
        self.0.rank()
    }
    fn ranks(&self) -> usize {
        self.0.ranks()
    }
    fn sum(&self, words: &mut [i64]) {
        self.count(|sent| sent.sums.add(1, 8 * words.len()));
        self.0.sum(words);
    }
    fn max(&self, words: &mut [u64]) {
        self.count(|sent| sent.largest.add(1, 8 * words.len()));
        self.0.max(words);
    }
    fn trade(&self, words: Vec<Vec<u64>>) -> Vec<Vec<u64>> {
        let others =
            (0..).zip(&words).filter(|(rank, list)| *rank != self.rank() && !list.is_empty());
        let lengths: Vec<usize> = others.map(|(_, list)| 8 * list.len()).collect();
        self.count(|sent| sent.trades.add(lengths.len(), lengths.iter().sum()));
        self.0.trade(words)
    }
    fn exchange(&self, outgoing: &[Parcel], incoming: &mut [Parcel], meanwhile: &mut dyn FnMut()) {
        let bytes = outgoing.iter().map(|parcel| 4 * parcel.words.len()).sum();
        self.count(|sent| sent.exchanges.add(outgoing.len(), bytes));
        self.0.exchange(outgoing, incoming, meanwhile);
    }
}

/// A liquid at T = 1 that has melted, in a cubic box.
fn melt(options: &ForceFieldOptions) -> (PeriodicBox, [Vec<DVec3>; 2]) {
    let (cell, positions) = liquid([24, 24, 24], DENSITY, 0.1);
    let n = positions.len();
    let [a, b] = [0.3, 0.7].map(|seed| scatter(n, DVec3::splat(3.0), seed));
    let velocities = a.iter().zip(b.iter().rev()).map(|(a, b)| *a + *b - DVec3::splat(3.0));
    let mut state = [positions, velocities.collect()];
    let mut forces = build(options, &conditions(cell, n)).unwrap();
    for _ in 0..3 {
        advance(&mut forces, &cell, &mut state, 60);
        let temperature = state[1].iter().map(|v| v.length_squared()).sum::<f64>() / (3 * n) as f64;
        state[1].iter_mut().for_each(|v| *v /= temperature.sqrt());
    }
    (cell, state)
}

fn advance(forces: &mut PairForces, cell: &PeriodicBox, state: &mut [Vec<DVec3>; 2], steps: u64) {
    let [positions, velocities] = state;
    let taken = forces.advance(&mut FusedSteps {
        cell,
        forces: &mut vec![DVec3::NAN; positions.len()],
        positions,
        velocities,
        masses: &Masses::Uniform(1.0),
        dt: DT,
        first: 1,
        steps,
        bath: None,
    });
    assert_eq!(taken, steps);
}

const DENSITY: f64 = 0.8442;
const STEPS: usize = 100;

#[test]
fn messages_are_those_of_the_model_and_no_others() {
    for precision in [Precision::Double, Precision::Mixed] {
        let options = ForceFieldOptions {
            kernel: KernelOptions { precision, ..KernelOptions::default() },
            truncation: TruncationOptions::new(TruncationKind::Shift, 2.5),
            neighbor: verlet(None),
            ..ForceFieldOptions::default()
        };
        let (cell, [positions, velocities]) = melt(&options);
        let n = positions.len();
        let limit = SpeedLimit { every: 1000, largest: 1.0 };
        for ranks in [2, 4] {
            let found = team_of_threads(ranks, |team| {
                let sent = Arc::default();
                let counting = Team::new(Box::new(Counting(team, Arc::clone(&sent))));
                let mut forces = build(&options, &conditions(cell, n)).unwrap();
                assert!(forces.share(&counting, &cell, limit).unwrap());
                let own = counting.numbers(n);
                let mut state = [&positions, &velocities].map(|all| all[own.clone()].to_vec());
                in_threads(1, || advance(&mut forces, &cell, &mut state, STEPS as u64));
                let plan = forces.plan().clone();
                let builds = forces.statistics().builds as usize;
                let sent = *sent.lock().unwrap();
                (sent, counting.statistics().halo, builds, plan)
            });
            let (_, _, builds, plan) = found[0].clone();
            let inserts = plan.kernel == "cluster";
            let of_position = if inserts { 12 } else { 24 };
            let mut bytes = 0;
            for (sent, _, _, _) in &found {
                // Each step has one exchange. Positions and velocities go to places at the begin, and to numbers at the end.
                assert_eq!(sent.exchanges.calls, STEPS + 4);
                let of_routes = sent.exchanges.messages - (ranks - 1) * STEPS;
                assert!(of_routes <= 4 * (ranks - 1), "{of_routes}");
                // Each step decides by two words, and one of each rank, whether the list is valid, once more after a build. Before a
                // build, all positions are finite; after the last step, all forces are. A build brings particles to their places,
                // and then halos. The route is made at the begin and at the end.
                let decisions = STEPS + builds - 1;
                let flags = sent.largest.calls - decisions;
                assert_eq!(sent.largest.bytes, 8 * (2 + ranks) * decisions + 8 * flags);
                assert_eq!(sent.sums.calls, 1 + builds);
                // In some steps, fast particles may meet what no list names. Ranks tell each other the fast ones at their faces.
                // They tell the pairs of them too. Where lists take no more pairs, they ask whether any rank found one.
                let [asked, told] = [flags - builds - 1, sent.trades.calls - 2 * builds - 2];
                let searches = if inserts { told / 2 } else { told };
                assert_eq!([asked, told], if inserts { [0, 2 * searches] } else { [searches; 2] });
                assert!(searches > 0 && searches < STEPS / 2, "{searches}");
                bytes += sent.exchanges.bytes;
            }
            let halo = found.iter().map(|(_, halo, _, _)| halo).sum::<f64>() / ranks as f64;
            let (h, length) = (plan.r_list, cell.lengths().x);
            let area = match ranks {
                2 => 2.0 * h * length,
                _ => 2.0 * h * length + PI * h * h,
            };
            let planned = DENSITY * area * length;
            // Two parts have straight cuts. Four have steps of one bundle, which the plan leaves out.
            let more = halo / planned - 1.0;
            let allowed = if ranks == 2 { -0.02..0.02 } else { 0.0..0.2 };
            assert!(allowed.contains(&more), "{precision:?}, {ranks} ranks: {more}");
            // A message carries the halo, and some particles beyond it that lists name. The rest takes the route.
            let halos = halo * (ranks * STEPS * of_position) as f64;
            let others = bytes as f64 - halos;
            let most = 4.0 * 24.0 * n as f64 + 0.01 * halos;
            assert!(others > 0.0 && others < most, "{others} {halos}");
        }
    }
}
