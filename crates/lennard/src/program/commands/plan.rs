//! `lennard plan`: what a scene computes.

use lennard_engine::Network;

use crate::program::args::PlanArgs;
use crate::program::commands::{answer, load_locked, on_threads, threads_with};
use crate::program::failure::Failure;
use crate::program::show::{self, Style};

/// Prints what a scene computes, what it leaves out and why, its memory and about how long it takes.
pub fn plan(args: &PlanArgs) -> Result<u8, Failure> {
    let (scene, lock) = load_locked(&args.scene)?;
    let mut simulation = lennard_engine::prepare(scene)?;
    let threads = threads_with(args.scene.threads, lock.as_ref(), simulation.state.len());
    let network = args.ranks.map(|ranks| Network {
        ranks: ranks.map(|ranks| ranks as usize),
        latency: args.latency.as_secs_f64(),
        bandwidth: args.bandwidth,
        cores: args.cores.map_or(threads, usize::from),
    });
    let plan =
        on_threads(threads, || Ok(lennard_engine::plan(&mut simulation, threads, network)?))?;
    answer(args.scene.json, false, &plan, || {
        let lock = lock.as_ref().map(|lock| lock.path.as_path());
        show::print(&show::plan(&plan, args.verbose, lock), Style::Ruled);
    })
}
