//! Tunes scenes at eight states from gas to dense liquid, a mixture and a liquid of molecules, and puts every choice on
//! trial. Ten independent seeds are compared with tight runs. Every setting of a grid that would cost less is tried too.
//!
//! `cargo xtask accuracy`, or for one state `cargo xtask accuracy --state triple-point`; `--seconds S` for each tuning,
//! `--share X` scales the length of the runs.
#![allow(clippy::print_stdout, clippy::print_stderr)] // printing is what this program is for

use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

use lennard_scene::Scene;
use lennard_studies::Silent;
use lennard_studies::tune::TuneOptions;
use lennard_studies::tune::trial::{self, ALLOWED_FACTOR, Trial, TrialOptions};

/// What a state is made of.
#[derive(Clone, Copy)]
struct Made {
    /// The key of the number of particles or molecules.
    of: &'static str,
    /// The tables of species or of the molecule.
    tables: &'static str,
}

/// Lennard-Jones particles, all alike.
const ATOMS: Made = Made { of: "n_atoms", tables: "" };
/// Argon and krypton in equal parts, as in `mixture/argon-krypton`.
const MIXTURE: Made = Made {
    of: "n_atoms",
    tables: "[[species]]\nname = \"Ar\"\nfraction = 0.5\n\
             [[species]]\nname = \"Kr\"\nfraction = 0.5\nsigma = 1.0656\nepsilon = 1.3934\nmass = 2.098\n\
             [mixing]\nrule = \"lorentz-berthelot\"\nk = 0.01\n",
};
/// Rigid dumbbells, as in `dumbbell/liquid`.
const DUMBBELLS: Made = Made {
    of: "n_molecules",
    tables: "[molecule]\nkind = \"dumbbell\"\nbond_length = 0.67\n[bonds]\nmethod = \"direct\"\n",
};

/// A state with the errors that are accepted there.
struct State {
    name: &'static str,
    made: Made,
    density: f64,
    temperature: f64,
    /// Of U, P and the drift.
    errors: [f64; 3],
}

const fn state(name: &'static str, density: f64, temperature: f64, errors: [f64; 3]) -> State {
    State { name, made: ATOMS, density, temperature, errors }
}

impl State {
    const fn made(self, made: Made) -> Self {
        Self { made, ..self }
    }
}

const STATES: [State; 10] = [
    state("gas", 0.05, 1.2, [2e-3, 2e-4, 1e-5]),
    state("dense-gas", 0.1, 1.5, [2e-3, 5e-4, 1e-5]),
    state("supercritical", 0.3, 2.0, [2e-3, 3e-3, 2e-5]),
    state("dense-supercritical", 0.5, 1.5, [2e-3, 5e-3, 2e-5]),
    state("liquid", 0.7, 1.0, [2e-3, 1e-2, 1e-5]),
    state("cold-liquid", 0.8, 0.9, [2e-3, 1e-2, 1e-5]),
    state("triple-point", 0.8442, 0.722, [1e-3, 5e-3, 1e-5]),
    state("dense-hot-liquid", 0.9, 1.5, [2e-3, 1.5e-2, 2e-5]),
    state("argon-krypton", 0.65, 1.5, [3e-3, 1e-2, 2e-5]).made(MIXTURE),
    state("dumbbells", 0.458, 2.0, [2e-2, 3e-2, 5e-5]).made(DUMBBELLS),
];

/// Particles, or molecules, of every state.
const COUNT: usize = 864;
/// Independent seeds.
const SEEDS: u64 = 10;
/// Length of each run of the choice and of each tight run of a liquid, τ. A thin fluid costs less and its correlations
/// last longer, so it runs for longer.
const TIMES: (f64, f64) = (50.0, 25.0);
/// The density of a liquid whose runs have these lengths, σ⁻³.
const LIQUID: f64 = 0.8;

fn scene(state: &State) -> Result<Scene, Box<dyn Error>> {
    let [u, p, drift] = state.errors;
    let text = format!(
        "accuracy = {{ potential_energy = {u:e}, pressure = {p:e}, drift = {drift:e} }}\n\
         [system]\n{} = {COUNT}\ndensity = {}\ntemperature = {}\n{}\
         [[stage]]\nname = \"melt\"\nsteps = 2000\ntemperature = {}\nthermostat = {{ kind = \"bussi\", tau = 0.1 }}\n\
         [[stage]]\nname = \"equilibrate\"\nsteps = 3000\nthermostat = {{ kind = \"bussi\", tau = 0.2 }}\n\
         [[stage]]\nname = \"production\"\nsteps = 20000\n",
        state.made.of,
        state.density,
        state.temperature,
        state.made.tables,
        2.0 * state.temperature,
    );
    Ok(Scene::parse(&text, state.name, &[])?)
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (mut only, mut seconds, mut share) = (None, 50.0, 1.0);
    for pair in arguments.chunks(2) {
        match pair {
            [key, value] if key == "--state" => only = Some(value.clone()),
            [key, value] if key == "--seconds" => seconds = value.parse()?,
            [key, value] if key == "--share" => share = value.parse()?,
            other => return Err(format!("unknown arguments: {}", other.join(" ")).into()),
        }
    }
    let threads = lennard_core::parallel::processors();
    println!(
        "cargo xtask accuracy {}\n{}, {threads} threads; {COUNT} particles or molecules, {SEEDS} seeds",
        arguments.join(" "),
        lennard_io::cpu_name(),
    );
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let (mut passed, mut tried) = (0, 0);
    let chosen = |s: &&State| only.as_ref().is_none_or(|o| o == s.name);
    for state in STATES.iter().filter(chosen) {
        let clock = Instant::now();
        let scene = scene(state)?;
        let longer = share * (LIQUID / state.density).max(1.0);
        let options = TrialOptions {
            tune: TuneOptions { seconds, threads },
            seeds: SEEDS,
            time: longer * TIMES.0,
            tight_time: longer * TIMES.1,
        };
        let trial = pool.install(|| trial::run(&scene, &options, &mut Silent))?;
        show(state, &options, &trial, clock.elapsed().as_secs_f64());
        tried += 1;
        passed += usize::from(trial.meets && trial.is_cheap());
    }
    println!(
        "\n{passed} of {tried} states: the target is met, and no settings that cost less by more than a factor of {ALLOWED_FACTOR} meet it, by their runs or by the models"
    );
    let all = passed == tried && tried > 0;
    Ok(if all { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn show(state: &State, options: &TrialOptions, trial: &Trial, seconds: f64) {
    let t = &trial.tuning;
    println!(
        "\n{}: ρ = {}, T = {}; runs of {:.0} τ, tight ones of {:.0} τ",
        state.name, state.density, state.temperature, options.time, options.tight_time
    );
    println!("  chosen in {:.0} s: {}", t.seconds, t.label);
    let relative = |cost: f64| cost / t.cost.wall.median;
    println!(
        "  cost: safest {:.1}, usual (2.5 σ, 0.004 τ, double) {:.2} times as much",
        relative(t.safest_cost.wall.median),
        t.usual_cost.map_or(f64::NAN, |c| relative(c.wall.median))
    );
    for (row, (key, target, error)) in t.rows.iter().zip(&trial.errors) {
        let j = &row.judged;
        println!(
            "  {key:<17} target {target:e}  predicted {:+.1e} ± {:.0e}  verified {:+.1e} ± {:.0e}  ten seeds {:+.1e} ± {:.0e}",
            j.predicted,
            j.predicted_error,
            j.measured,
            j.measured_error,
            error.mean,
            error.standard_error
        );
    }
    if let Some([u, p]) = &t.usual_errors {
        println!(
            "  usual settings, predicted: U {:+.1e} ± {:.0e}, P {:+.1e} ± {:.0e}",
            u.mean, u.standard_error, p.mean, p.standard_error
        );
    }
    let open: Vec<_> = trial.cheaper.iter().filter(|c| c.misses.is_none()).collect();
    println!(
        "  of the grid, {} settings cost less by more than a factor of {ALLOWED_FACTOR}; {} are not seen to miss",
        trial.cheaper.len(),
        open.len()
    );
    let nearest = trial.cheaper.iter().filter(|c| c.misses.is_some()).take(3);
    for c in nearest.chain(open) {
        let misses = match (&c.misses, &c.predicted) {
            (Some(misses), _) => misses.clone(),
            (None, Some(predicted)) => format!("not seen to miss; predicted to: {predicted}"),
            (None, None) => "NOT SEEN TO MISS".into(),
        };
        println!("    {:.2} {}: {misses}", c.cost, c.label);
    }
    for note in &t.notes {
        println!("  note: {note}");
    }
    println!("  against {}; {seconds:.0} s in all", trial.tight);
    let verdict = if trial.meets {
        "meets its target within two standard errors"
    } else {
        "MISSES its target"
    };
    println!("  {verdict}");
}
