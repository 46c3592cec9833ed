//! Steps of ranks over a wire that is as slow as asked for, beside the model of `lennard plan --ranks`:
//! `wire [CELLS] [key=value ...]` with the keys `ranks`, `steps` and `precision`, for a liquid of 4·CELLS³ particles.
//!
//! Ranks are threads. Each message arrives after a latency and its bytes over a bandwidth, and each decision of all ranks after
//! two latencies a round. The model takes the step of the same ranks on a wire without delays, and the time of their inner
//! chunks. In the last row the wire waits before the inner chunks run: the step has to be longer by their time.

use std::error::Error;
use std::io::{Write, stdout};
use std::process::ExitCode;
use std::sync::{Arc, Mutex};
use std::thread::{sleep, yield_now};
use std::time::{Duration, Instant};

use lennard_benches::arguments::{Arguments, exit_code};
use lennard_benches::{CASES, Case, Run};
use lennard_core::{Parcel, Team, Want, Wire, team_of_threads};
use lennard_engine::stopwatch::in_turn;
use lennard_forcefield::{KernelOptions, Precision, TruncationKind};

/// An error that may leave the thread that found it.
type Failure = Box<dyn Error + Send + Sync>;

fn main() -> ExitCode {
    exit_code(measure().map_err(|failure| failure as Box<dyn Error>))
}

/// What a network costs.
#[derive(Clone, Copy)]
struct Network {
    /// Seconds.
    latency: f64,
    /// Seconds for a byte.
    per_byte: f64,
    /// Whether work goes on while messages are under way.
    overlaps: bool,
}

/// What happened on the wire of one rank.
#[derive(Clone, Copy, Default)]
struct Seen {
    decisions: f64,
    /// Lists of words to other ranks.
    lists: f64,
    exchanges: f64,
    /// Exchanges with work beside them.
    beside: f64,
    /// Bytes that came in exchanges.
    bytes: f64,
    /// Seconds of work while messages are under way.
    meanwhile: f64,
}

/// A wire with delays.
struct Slow {
    team: Team,
    network: Network,
    seen: Arc<Mutex<Seen>>,
}

/// How often each network is measured, in turn with the others. The quickest counts: other programs disturb it least.
const ROUNDS: usize = 5;
/// Seconds that are no work.
const NOTHING: f64 = 2e-6;

/// Seconds of a decision of all ranks.
fn decision(ranks: usize, network: Network) -> f64 {
    2.0 * f64::from(ranks.next_power_of_two().ilog2()) * network.latency
}

/// Waits so long after a moment. The system wakes threads late, and the rest is waited for awake.
fn wait(start: Instant, seconds: f64) {
    const LATE: Duration = Duration::from_micros(100);
    let end = start + Duration::from_secs_f64(seconds);
    while let Some(left) = end.checked_duration_since(Instant::now()).filter(|d| !d.is_zero()) {
        if left > LATE { sleep(left - LATE) } else { yield_now() }
    }
}

impl Slow {
    fn see(&self, change: impl FnOnce(&mut Seen)) {
        change(&mut self.seen.lock().unwrap_or_else(|poisoned| poisoned.into_inner()));
    }

    fn decide(&self, act: impl FnOnce(&Team)) {
        self.see(|seen| seen.decisions += 1.0);
        act(&self.team);
        wait(Instant::now(), decision(self.ranks(), self.network));
    }
}

impl Wire for Slow {
    fn rank(&self) -> usize {
        self.team.rank()
    }

    fn ranks(&self) -> usize {
        self.team.ranks()
    }

    fn sum(&self, words: &mut [i64]) {
        self.decide(|team| team.sum(words));
    }

    fn max(&self, words: &mut [u64]) {
        self.decide(|team| team.max(words));
    }

    fn trade(&self, words: Vec<Vec<u64>>) -> Vec<Vec<u64>> {
        let found = self.team.trade(words);
        let others = (self.ranks() - 1) as f64;
        self.see(|seen| seen.lists += others);
        let bytes: usize = found.iter().map(|list| 8 * list.len()).sum();
        wait(Instant::now(), others * self.network.latency + bytes as f64 * self.network.per_byte);
        found
    }

    fn exchange(&self, outgoing: &[Parcel], incoming: &mut [Parcel], meanwhile: &mut dyn FnMut()) {
        let Network { latency, per_byte, overlaps } = self.network;
        let bytes = incoming.iter().map(|parcel| 4 * parcel.words.len()).sum::<usize>() as f64;
        let seconds = latency + bytes * per_byte;
        if !overlaps {
            wait(Instant::now(), seconds);
        }
        let start = Instant::now();
        let mut work = 0.0;
        self.team.exchange(outgoing, incoming, &mut || {
            let start = Instant::now();
            meanwhile();
            work = start.elapsed().as_secs_f64();
        });
        if overlaps {
            wait(start, seconds);
        }
        self.see(|seen| {
            seen.exchanges += 1.0;
            seen.bytes += bytes;
            seen.meanwhile += work;
            seen.beside += f64::from(u8::from(work > NOTHING));
        });
    }
}

/// Seconds of a step of some ranks, and what a mean rank saw in it.
fn step_on(
    ranks: usize,
    steps: usize,
    network: Network,
    (start, whole): (&(dyn Fn() -> Result<Run, Failure> + Sync), &Run),
) -> Result<(f64, Seen), Failure> {
    let found = team_of_threads(ranks, |team| -> Result<(f64, Seen), Failure> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
        pool.install(|| {
            let seen = Arc::default();
            let wire = Slow { team: team.clone(), network, seen: Arc::clone(&seen) };
            let mut run = start()?;
            run.share(&Team::new(Box::new(wire)), whole)?;
            run.steps(3, Want::NOTHING)?;
            let before = Seen::clone(&seen.lock().unwrap_or_else(|poisoned| poisoned.into_inner()));
            // All begin at once.
            assert!(!team.any(false));
            let began = Instant::now();
            run.steps(steps, Want::NOTHING)?;
            let seconds = began.elapsed().as_secs_f64();
            let after = Seen::clone(&seen.lock().unwrap_or_else(|poisoned| poisoned.into_inner()));
            let of_step = |field: fn(&Seen) -> f64| (field(&after) - field(&before)) / steps as f64;
            let seen = Seen {
                decisions: of_step(|s| s.decisions),
                lists: of_step(|s| s.lists),
                exchanges: of_step(|s| s.exchanges),
                beside: of_step(|s| s.beside),
                bytes: of_step(|s| s.bytes),
                meanwhile: of_step(|s| s.meanwhile),
            };
            Ok((seconds / steps as f64, seen))
        })
    });
    // Ranks end together: the first one tells for all.
    found.into_iter().collect::<Result<Vec<_>, _>>().map(|all| all[0])
}

fn measure() -> Result<(), Failure> {
    let given = Arguments::read(std::env::args().skip(1), &["ranks", "steps", "precision"])?;
    let cells = given.word(0).map_or(Ok(20), str::parse)?;
    let ranks = given.number("ranks", 2)?.unwrap_or(2);
    let steps = given.number("steps", 1)?.unwrap_or(100);
    let precisions = [("double", Precision::Double), ("mixed", Precision::Mixed)];
    let precision = given.one_of("precision", &precisions)?;
    let case = Case { cells, ..CASES[0] };
    let kernel = KernelOptions { precision, ..KernelOptions::default() };
    let start = || Ok::<_, Failure>(case.start(kernel, None, TruncationKind::Cut)?);
    let mut whole = start()?;
    whole.steps(300, Want::NOTHING)?;
    let on = |network| step_on(ranks, steps, network, (&start, &whole));
    let network = |latency, per_byte, overlaps| Network { latency, per_byte, overlaps };
    let (_, seen) = on(network(0.0, 0.0, true))?;
    let message = |times: f64| times * seen.meanwhile / seen.beside * seen.exchanges / seen.bytes;
    let networks = [
        network(0.0, 0.0, true),
        network(1e-4, 0.0, true),
        network(0.0, message(0.5), true),
        network(0.0, message(3.0), true),
        network(1e-4, message(2.0), true),
        network(1e-4, message(2.0), false),
    ];
    let mut best = [(f64::INFINITY, Seen::default()); 6];
    in_turn(networks.len(), ROUNDS, case.seed, |turn| -> Result<(), Failure> {
        let found = on(networks[turn.item])?;
        if found.0 < best[turn.item].0 {
            best[turn.item] = found;
        }
        Ok(())
    })?;
    let (alone, seen) = best[0];
    let (bytes, inner) = (seen.bytes / seen.exchanges, seen.meanwhile / seen.beside);
    let n = case.n_atoms();
    writeln!(
        stdout(),
        "{ranks} ranks of {n} particles: a step takes {:.0} µs without delays, inner chunks {:.0} µs; {:.2} exchanges of {:.1} kB, {:.2} of them beside work, and {:.2} decisions a step",
        1e6 * alone,
        1e6 * inner,
        seen.exchanges,
        1e-3 * bytes,
        seen.beside,
        seen.decisions
    )?;
    writeln!(stdout(), "latency, µs  message, µs  step, µs  model, µs  ratio")?;
    for (network, (found, seen)) in networks.into_iter().zip(best).skip(1) {
        let Network { latency, per_byte, overlaps } = network;
        let message = latency + seen.bytes / seen.exchanges * per_byte;
        let hidden = if overlaps { seen.beside * inner.min(message) } else { 0.0 };
        let model = alone
            + seen.decisions * decision(ranks, network)
            + seen.lists * latency
            + seen.exchanges * message
            - hidden;
        writeln!(
            stdout(),
            "{:11.0}  {:11.0}  {:8.0}  {:9.0}  {:5.2}{}",
            1e6 * latency,
            1e6 * message,
            1e6 * found,
            1e6 * model,
            found / model,
            if overlaps { "" } else { "  (messages before work)" }
        )?;
    }
    Ok(())
}
