//! Energy drift of a case, in ε per atom and τ:
//! `drift CASE [STEPS] [from=STEP] [precision=double,mixed] [seed=1967] [truncation=shift]`. It is the slope of a straight line
//! through the conserved energy, from `from` on, or else without the first fifth. Its standard error comes from ten block slopes.

use std::io::{Write, stdout};
use std::process::ExitCode;

use lennard_benches::arguments::{Arguments, BadArgument, exit_code};
use lennard_core::{DVec3, ForceTerm, Want};
use lennard_forcefield::{KernelOptions, Precision, TruncationKind};
use lennard_observables::statistics::drift;

/// Steps between two energies.
const EVERY: usize = 10;
/// Fewest steps that a line is drawn through, 20 energies: hardly enough for an error.
const FEWEST_STEPS: usize = 200;

const TRUNCATIONS: [(&str, TruncationKind); 4] = [
    ("shift", TruncationKind::Shift),
    ("cut", TruncationKind::Cut),
    ("force-shift", TruncationKind::ForceShift),
    ("switch", TruncationKind::Switch),
];

fn main() -> ExitCode {
    exit_code(measure())
}

fn measure() -> Result<(), Box<dyn std::error::Error>> {
    let given =
        Arguments::read(std::env::args().skip(1), &["from", "precision", "seed", "truncation"])?;
    let mut case = given.case()?;
    if let Some(seed) = given.number("seed", 0)? {
        case.seed = seed as u64;
    }
    let steps = given.steps(3000, FEWEST_STEPS + FEWEST_STEPS / 4)?;
    let from = given.number("from", 0)?.unwrap_or(steps / 5);
    if from + FEWEST_STEPS > steps {
        return Err(BadArgument(format!(
            "`from` = {from} is not allowed: a step at least {FEWEST_STEPS} before the last, {steps}"
        ))
        .into());
    }
    let truncation = given.one_of("truncation", &TRUNCATIONS)?;
    let both = [("double", Precision::Double), ("mixed", Precision::Mixed)];
    let choices = [("double,mixed", &both[..]), ("double", &both[..1]), ("mixed", &both[1..])];
    for (name, precision) in given.one_of("precision", &choices)? {
        let kernel = KernelOptions { precision: *precision, ..KernelOptions::default() };
        let mut run = case.start(kernel, None, truncation)?;
        let n = case.n_atoms() as f64;
        let mut energies = Vec::with_capacity(steps / EVERY);
        for _ in 0..steps / EVERY {
            let u = run.steps(EVERY, Want::ENERGY)?.conserved_potential;
            energies.push((u.ok_or("no energy")? + run.kinetic_energy()) / n);
        }
        let settled = from / EVERY..;
        let times: Vec<f64> = (0..energies.len()).map(|k| (k * EVERY) as f64 * case.dt).collect();
        let line = drift(&times[settled.clone()], &energies[settled]);
        let momentum = run.velocities.iter().sum::<DVec3>().length() / n;
        let s = run.provider.statistics();
        writeln!(
            stdout(),
            "{} {name} {truncation:?}, steps {from} to {steps}: drift {:+.2e} ± {:.1e} ε/atom/τ, RMS {:.1e}, momentum {momentum:.1e} per atom, {} builds",
            case.name,
            line.slope,
            line.standard_error,
            line.rms,
            s.builds
        )?;
    }
    Ok(())
}
