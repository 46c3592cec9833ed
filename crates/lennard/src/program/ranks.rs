//! Several ranks behind one command line: rank 0 writes and prints, and no rank goes on where another one failed.

use std::path::Path;

use lennard_core::Team;
use lennard_engine::{Control, Ending, EngineError, Outcome, RanksError};

use crate::program::commands::on_threads;
use crate::program::failure::{DONE, Failure, STOPPED};
use crate::program::signals::Signals;

/// The code of a rank on which nothing failed, where another one tells why. No process ends with it.
const ELSEWHERE: u8 = u8::MAX;

/// What a rank got, where every rank got something. Otherwise the lowest rank that failed tells why, and the others end
/// with its exit code.
pub fn together<T>(team: Option<&Team>, got: Result<T, Failure>) -> Result<T, Failure> {
    let Some(team) = team else { return got };
    let code = got.as_ref().err().map_or(DONE, |failure| failure.code);
    let codes = team.concat(&[code.into()]);
    let tells = |code: &u64| ![DONE, ELSEWHERE].map(u64::from).contains(code);
    let Some(first) = codes.iter().position(tells) else {
        return got;
    };
    match got {
        Err(failure) if first == team.rank() => Err(failure),
        _ => Err(Failure { message: String::new(), code: codes[first] as u8 }),
    }
}

/// The threads of this rank: those asked for, else what `choose` gives; with several ranks, one.
pub fn threads(
    team: Option<&Team>,
    asked: Option<u16>,
    choose: impl FnOnce(Option<u16>) -> usize,
) -> usize {
    match team {
        // How many ranks share a machine is not known.
        Some(_) => choose(asked.or(Some(1))),
        None => choose(asked),
    }
}

/// The failure of what all ranks do together before a run; a rank is silent where another one tells.
pub fn apart(error: EngineError) -> Failure {
    match error {
        EngineError::Ranks(RanksError::Elsewhere) => {
            Failure { message: String::new(), code: ELSEWHERE }
        }
        error => error.into(),
    }
}

/// What rank 0 makes for the run; nothing on the other ranks. Where it fails, all ranks fail.
pub fn made_by_first<T>(
    team: Option<&Team>,
    make: impl FnOnce() -> Result<T, Failure>,
) -> Result<Option<T>, Failure> {
    let leads = team.is_none_or(Team::leads);
    together(team, leads.then(make).transpose())
}

/// Runs beside rank 0: `steps` starts or goes on, until it is told to stop.
pub fn beside(
    team: Option<&Team>,
    threads: usize,
    signals: &Signals,
    steps: impl FnOnce(Control<'_>) -> Result<Outcome, EngineError> + Send,
) -> Result<u8, Failure> {
    signals.under_way();
    let ended = on_threads(threads, || {
        let control = Control { stop: signals.stop(), deadline: None, progress: &mut () };
        steps(control).map_err(|error| failed(team, error, Path::new("")))
    });
    match ended.map(|outcome| outcome.ending) {
        Ok(Ending::Finished) => Ok(DONE),
        Ok(Ending::Stopped | Ending::OutOfTime) => Ok(STOPPED),
        // Rank 0 tells.
        Err(failure) => Err(Failure { message: String::new(), ..failure }),
    }
}

/// The failure of a run under way. What all ranks meet alike is returned; anything else ends all ranks.
pub fn failed(team: Option<&Team>, error: EngineError, folder: &Path) -> Failure {
    let is_alike = matches!(error, EngineError::Physics(_) | EngineError::Ranks(_));
    let failure = Failure::of_run(error, folder);
    match team {
        Some(team) if !is_alike => {
            eprintln!("{}", on_rank(team.rank(), &failure.message));
            team.abort(failure.code)
        }
        _ => failure,
    }
}

/// A failure that one rank alone meets.
fn on_rank(rank: usize, message: &str) -> String {
    format!("error on rank {rank}, which ends all: {message}")
}

#[cfg(test)]
mod tests {
    use lennard_core::team_of_threads;

    use super::*;

    #[test]
    fn the_lowest_rank_that_failed_tells_why_and_all_end_with_its_code() {
        let found = team_of_threads(3, |team| {
            let got = match team.rank() {
                0 => Ok(()),
                rank => Err(Failure::new("reading", rank, 1 + rank as u8)),
            };
            let failure = together(Some(&team), got).unwrap_err();
            (failure.message, failure.code)
        });
        let silent = (String::new(), 2);
        assert_eq!(found, [silent.clone(), ("reading: 1".to_owned(), 2), silent]);
        assert!(together(None, Ok(7)).is_ok_and(|got| got == 7));
        let made = team_of_threads(2, |team| made_by_first(Some(&team), || Ok(team.rank())).ok());
        assert_eq!(made, [Some(Some(0)), Some(None)]);
        assert_eq!(
            on_rank(2, "the disk is full"),
            "error on rank 2, which ends all: the disk is full"
        );
    }
}
