//! The program `lennard-mpi`: the command line of `lennard run` and `lennard resume` on the ranks that MPI starts.
#![allow(clippy::print_stderr)] // a program says there why it cannot start

mod wire;

use std::process::ExitCode;

use lennard_core::{Team, Wire};
use mpi::Threading;

use crate::wire::World;

fn main() -> ExitCode {
    give_large_arrays_back();
    let started = mpi::initialize_with_threading(Threading::Serialized);
    if let Some(reason) = refusal(started.as_ref().map(|(_, threading)| *threading)) {
        eprintln!("{reason}");
        return ExitCode::FAILURE;
    }
    abort_where_a_rank_panics();
    let team = Team::new(Box::new(World::new()));
    let code = lennard::program::main_on_ranks(std::env::args_os(), &team);
    // Every rank comes here, with the same code: what only one rank meets ends all of them before.
    drop(started);
    code.into()
}

/// Lets the C library give the memory of large arrays back once they are freed. It would keep more and more of them for later: some
/// 35 MB on each of four ranks with 10⁶ particles.
fn give_large_arrays_back() {
    #[cfg(target_env = "gnu")]
    // SAFETY: it sets one number of the C library, before any other thread runs.
    #[allow(unsafe_code)]
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, 1 << 20);
    }
}

/// Why an MPI library cannot be used that gives so many threads; `None` where it can.
fn refusal(threading: Option<Threading>) -> Option<&'static str> {
    match threading {
        None => Some("error: starting MPI: it was started before"),
        Some(threading) if threading < Threading::Serialized => Some(
            "error: starting MPI: the library is for one thread alone; take one with MPI_THREAD_SERIALIZED",
        ),
        Some(_) => None,
    }
}

/// A rank that panics would leave the others waiting for ever.
fn abort_where_a_rank_panics() {
    let tell = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        tell(panic);
        World::new().abort(1);
    }));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_for_one_thread_is_refused() {
        assert_eq!(refusal(None), Some("error: starting MPI: it was started before"));
        let single = refusal(Some(Threading::Funneled)).unwrap();
        assert_eq!(
            single,
            "error: starting MPI: the library is for one thread alone; take one with MPI_THREAD_SERIALIZED"
        );
        assert_eq!(refusal(Some(Threading::Multiple)), None);
    }
}
