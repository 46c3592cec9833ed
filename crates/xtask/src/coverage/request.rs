//! What is asked on the command line.

use std::path::PathBuf;

use super::plan::{self, Cell, ENSEMBLES, Ensemble, LENGTHS, STATES, State};
use super::runner::Run;

/// The help of the command.
pub const HELP: &str = "\
Runs of many seeds, and how often the long-run mean is within the printed errors.

Usage: cargo xtask coverage [OPTIONS]

  --out DIR           Folder of the runs and of coverage.json (default target/coverage/runs); finished
                      runs in it are kept
  --again DATA        Simulate nothing: conclude the finished runs in DATA with this program, from
                      copies of their checkpoints; --out then is the folder of the new records
                      (default target/coverage/again)
  --only-analyse      Simulate nothing and conclude nothing: analyse what is in --out
  --binary FILE       Use this program (default: the release build, made first)
  --states A,B        Only these states
  --ensembles A,B     Only these of energy, bussi and langevin
  --lengths A,B       Only these numbers of measured steps
  --seeds N           Runs per state, ensemble and length (default 30)
  --workers N         Runs at a time (default: processors)
  --quick             One gas and one liquid, short runs, few seeds; wide tolerances";

/// States of the short form.
const QUICK_STATES: [&str; 2] = ["rho0.1-T1.5", "rho0.7-T1.2"];

/// Where the records come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// Runs that are not there yet are made.
    Simulation,
    /// Finished runs in this folder are concluded anew.
    Checkpoints(PathBuf),
    /// They are there.
    Records,
}

/// What is asked.
#[derive(Debug)]
pub struct Request {
    /// Where the records come from.
    pub source: Source,
    /// Folder of the records; the folder of the source by default.
    pub out: Option<PathBuf>,
    /// The program, unless it is the one that is built.
    pub binary: Option<PathBuf>,
    /// Two states and few seeds.
    pub quick: bool,
    /// Runs at a time.
    pub workers: usize,
    /// Measured steps.
    pub lengths: Vec<u64>,
    states: Vec<&'static State>,
    ensembles: Vec<Ensemble>,
    seeds: u32,
}

impl Request {
    /// Everything.
    fn full() -> Self {
        Self {
            source: Source::Simulation,
            out: None,
            binary: None,
            quick: false,
            workers: std::thread::available_parallelism().map_or(1, usize::from),
            lengths: LENGTHS.to_vec(),
            states: STATES.iter().collect(),
            ensembles: ENSEMBLES.to_vec(),
            seeds: 30,
        }
    }

    /// One gas and one liquid, each with and without a bath, in runs that take a second.
    #[must_use]
    pub fn quick() -> Self {
        Self {
            quick: true,
            lengths: LENGTHS[..2].to_vec(),
            states: STATES.iter().filter(|s| QUICK_STATES.contains(&s.name)).collect(),
            ensembles: vec![Ensemble::Energy, Ensemble::Bussi],
            seeds: 8,
            ..Self::full()
        }
    }

    /// Reads the arguments.
    ///
    /// # Errors
    ///
    /// What is not known, or not allowed.
    pub fn read(arguments: &[&str]) -> Result<Self, String> {
        let mut request = if arguments.contains(&"--quick") { Self::quick() } else { Self::full() };
        let mut rest = arguments.iter();
        while let Some(&argument) = rest.next() {
            match argument {
                "--quick" => {}
                "--only-analyse" => request.source = Source::Records,
                "--out" | "--again" | "--binary" | "--states" | "--ensembles" | "--lengths"
                | "--seeds" | "--workers" => {
                    let value = rest.next().ok_or_else(|| format!("{argument} wants a value"))?;
                    request.set(argument, value)?;
                }
                other => return Err(format!("unknown argument: {other}")),
            }
        }
        Ok(request)
    }

    fn set(&mut self, argument: &str, value: &str) -> Result<(), String> {
        let whole = || {
            value
                .parse::<u32>()
                .ok()
                .filter(|&n| n > 0)
                .ok_or_else(|| format!("{argument} wants a whole number, not {value}"))
        };
        match argument {
            "--out" => self.out = Some(value.into()),
            "--again" => self.source = Source::Checkpoints(value.into()),
            "--binary" => self.binary = Some(value.into()),
            "--seeds" => self.seeds = whole()?,
            "--workers" => self.workers = whole()? as usize,
            "--states" => {
                let names: Vec<&str> = STATES.iter().map(|s| s.name).collect();
                self.states = chosen(argument, value, &names, &STATES.each_ref())?;
            }
            "--ensembles" => {
                let names = ENSEMBLES.map(Ensemble::name);
                self.ensembles = chosen(argument, value, &names, &ENSEMBLES)?;
            }
            _ => {
                let names = LENGTHS.map(|n| n.to_string());
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                self.lengths = chosen(argument, value, &names, &LENGTHS)?;
            }
        }
        Ok(())
    }

    /// All runs, in the order in which they are made.
    #[must_use]
    pub fn runs(&self) -> Vec<Run> {
        let cells = plan::in_order(&self.states, &self.ensembles, &self.lengths);
        let runs = |&cell: &Cell| (1..=self.seeds).map(move |number| Run { cell, number });
        cells.iter().flat_map(runs).collect()
    }
}

/// Entries of `all` that a list with commas names.
fn chosen<T: Copy>(
    argument: &str,
    value: &str,
    names: &[&str],
    all: &[T],
) -> Result<Vec<T>, String> {
    value
        .split(',')
        .map(|wanted| {
            names.iter().position(|name| *name == wanted).map(|i| all[i]).ok_or_else(|| {
                format!("{argument} knows no `{wanted}`; allowed: {}", names.join(", "))
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_is_taken_and_a_wrong_one_is_answered_with_what_is_allowed() {
        let request = Request::read(&[
            "--states",
            "slab-T0.75,rho0.9-T1.2",
            "--lengths",
            "2500",
            "--ensembles",
            "bussi",
            "--seeds",
            "3",
            "--again",
            "data",
        ])
        .unwrap();
        assert_eq!(request.source, Source::Checkpoints("data".into()));
        let folders: Vec<String> = request.runs().iter().map(|run| run.cell.folder()).collect();
        assert_eq!(folders.len(), 6);
        assert_eq!(folders[0], "slab-T0.75/bussi/2500");
        let fault = Request::read(&["--ensembles", "nose"]).unwrap_err();
        assert_eq!(fault, "--ensembles knows no `nose`; allowed: energy, bussi, langevin");
        for wrong in [&["--seeds", "0"][..], &["--seeds"], &["--lengths", "7"], &["--slow"]] {
            assert!(Request::read(wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn the_full_plan_has_ten_states_three_ensembles_three_lengths_and_thirty_seeds() {
        let runs = Request::read(&[]).unwrap().runs();
        assert_eq!(runs.len(), 10 * 3 * 3 * 30);
        let mut seeds: Vec<(String, u64)> = (runs.iter())
            .map(|run| {
                (
                    format!("{}/{}", run.cell.state.name, run.cell.ensemble.name()),
                    run.cell.seed(run.number),
                )
            })
            .collect();
        seeds.sort();
        seeds.dedup();
        assert_eq!(seeds.len(), runs.len(), "no two lengths share a seed");
        assert!(runs[..1800].iter().all(|run| run.cell.length < 200_000));
        assert!(runs[1800..2070].iter().all(|run| run.cell.state.is_liquid()));
        assert_eq!(Request::read(&["--quick"]).unwrap().runs().len(), 64);
    }
}
