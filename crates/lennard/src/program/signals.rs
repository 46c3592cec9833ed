//! Signals that ask a program to stop.
//!
//! A run under way finishes its step, writes a checkpoint and ends with exit code 4. Start-up has no steps and nothing
//! to keep. A signal then ends the program at once, whatever it computes, and a sentence says what is left.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use lennard_io::OutputFolder;
use signal_hook::consts::{SIGINT, SIGTERM};

use crate::program::failure::{Failure, OTHER, STOPPED};

/// What a shell says of a program that SIGINT has ended.
const ENDED_BY_SIGINT: i32 = 130;

/// Held while a signal ends the program, from before files are removed.
static ENDING: Mutex<()> = Mutex::new(());

fn ending() -> MutexGuard<'static, ()> {
    ENDING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns at once, or never where a signal ends the program: what fails meanwhile may only lack files that were removed.
pub fn let_a_signal_end() {
    drop(ending());
}

/// What a signal does while nothing is under way.
pub struct StartUp {
    /// What is true then, for standard error.
    sentence: String,
    /// Exit code: 4 where the work can go on, else 1.
    code: u8,
    /// The output folder, once it is there.
    folder: Option<Arc<OutputFolder>>,
    /// What to do with it.
    leave: Leave,
    /// What is true instead where the folder holds something to go on with.
    kept: Option<Kept>,
}

/// Something in the output folder that the same command goes on with.
struct Kept {
    is_in: fn(&Path) -> bool,
    sentence: String,
}

/// What becomes of an output folder that a signal makes the program leave.
pub enum Leave {
    /// What is in it stays.
    AsItIs,
    /// The first files of a run are removed: there is no step to go with them.
    WithoutTheRun,
}

impl StartUp {
    /// Nothing was written, and nothing can be gone on with.
    pub fn of_nothing(sentence: &str) -> Self {
        Self {
            sentence: sentence.to_owned(),
            code: OTHER,
            folder: None,
            leave: Leave::AsItIs,
            kept: None,
        }
    }

    /// The work can go on.
    pub fn resumable(sentence: &str) -> Self {
        Self { code: STOPPED, ..Self::of_nothing(sentence) }
    }

    /// The same with something else to do with the output folder.
    pub fn leaving(self, leave: Leave) -> Self {
        Self { leave, ..self }
    }

    /// The same, unless the output folder holds something to go on with when the signal comes.
    pub fn unless_kept(self, is_in: fn(&Path) -> bool, sentence: String) -> Self {
        Self { kept: Some(Kept { is_in, sentence }), ..self }
    }

    fn end(&self) -> ! {
        let _until_the_exit = ending();
        let folder = self.folder.as_deref().map(OutputFolder::path);
        let kept = self.kept.as_ref().filter(|kept| folder.is_some_and(kept.is_in));
        let (sentence, code) = match kept {
            Some(kept) => (&kept.sentence, STOPPED),
            None => (&self.sentence, self.code),
        };
        if let Some(folder) = &self.folder {
            match &self.leave {
                Leave::AsItIs => {}
                Leave::WithoutTheRun => folder.abandon(),
            }
            folder.leave();
        }
        eprintln!("{sentence}");
        std::process::exit(i32::from(code))
    }
}

/// Listens for signals from its making to the end of the program.
#[derive(Clone)]
pub struct Signals(Arc<Shared>);

struct Shared {
    stop: Arc<AtomicBool>,
    /// What a signal does; absent once something is under way.
    start_up: Mutex<Option<StartUp>>,
}

impl Signals {
    /// Begins to listen, with something to do while nothing is under way.
    pub fn listen(start_up: StartUp) -> Result<Self, Failure> {
        let shared =
            Arc::new(Shared { stop: Arc::default(), start_up: Mutex::new(Some(start_up)) });
        listen(&shared).map_err(|e| Failure::new("listening for signals", e, OTHER))?;
        Ok(Self(shared))
    }

    /// Set by the first signal of a run under way.
    pub fn stop(&self) -> &Arc<AtomicBool> {
        &self.0.stop
    }

    /// Makes and claims an output folder. From then on a signal does what `then` says, or asks to stop where `then` is
    /// nothing. No signal finds a folder that is made and not yet claimed.
    pub fn claim(
        &self,
        make: impl FnOnce() -> Result<OutputFolder, Failure>,
        then: impl FnOnce(&Path) -> Option<StartUp>,
    ) -> Result<Arc<OutputFolder>, Failure> {
        let mut start_up = self.0.start_up();
        let folder = Arc::new(make()?);
        *start_up = then(folder.path())
            .map(|start_up| StartUp { folder: Some(Arc::clone(&folder)), ..start_up });
        Ok(folder)
    }

    /// From now on a signal asks to stop: there is something to keep.
    pub fn under_way(&self) {
        *self.0.start_up() = None;
    }
}

impl Shared {
    fn start_up(&self) -> MutexGuard<'_, Option<StartUp>> {
        self.start_up.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn received(&self, signal: i32) {
        // Held to the end: nothing gets under way meanwhile.
        if let Some(start_up) = &*self.start_up() {
            start_up.end();
        }
        // Whoever presses the keys twice does not want to wait for the step.
        if self.stop.swap(true, Ordering::SeqCst) && signal == SIGINT {
            std::process::exit(ENDED_BY_SIGINT);
        }
    }
}

#[cfg(unix)]
fn listen(shared: &Arc<Shared>) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGUSR1};
    use signal_hook::iterator::Signals;

    let mut signals = Signals::new([SIGINT, SIGTERM, SIGUSR1])?;
    if !is_ignored(SIGHUP) {
        signals.add_signal(SIGHUP)?;
    }
    let shared = Arc::clone(shared);
    std::thread::Builder::new()
        .name("signals".into())
        .spawn(move || signals.forever().for_each(|signal| shared.received(signal)))?;
    Ok(())
}

/// Lets a write beyond a limit on the size of files fail as any other write does.
///
/// The signal of that limit would end the program without a word.
pub fn let_long_files_fail() {
    #[cfg(unix)]
    {
        use signal_hook::consts::SIGXFSZ;
        if !is_ignored(SIGXFSZ) {
            // Without a handler, the program is as it would have been.
            let _ = signal_hook::flag::register(SIGXFSZ, Arc::default());
        }
    }
}

/// Whether the program was started with a signal ignored, as `nohup` does with SIGHUP: it stays ignored then.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    std::fs::read_to_string("/proc/self/status").is_ok_and(|status| ignores(&status, signal))
}

/// Whether a status of Linux has a signal among the ignored ones.
#[cfg(unix)]
fn ignores(status: &str, signal: i32) -> bool {
    status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .is_some_and(|mask| mask & (1 << (signal - 1)) != 0)
}

/// Without a way to wait for a signal: a flag that a thread looks at.
#[cfg(not(unix))]
fn listen(shared: &Arc<Shared>) -> std::io::Result<()> {
    /// Time between two looks.
    const LOOK_EVERY: std::time::Duration = std::time::Duration::from_millis(50);
    let received = [SIGINT, SIGTERM].map(|signal| (signal, Arc::new(AtomicBool::new(false))));
    for (signal, flag) in &received {
        signal_hook::flag::register(*signal, Arc::clone(flag))?;
    }
    let shared = Arc::clone(shared);
    std::thread::Builder::new().name("signals".into()).spawn(move || {
        loop {
            std::thread::sleep(LOOK_EVERY);
            for (signal, flag) in &received {
                if flag.swap(false, Ordering::Relaxed) {
                    shared.received(*signal);
                }
            }
        }
    })?;
    Ok(())
}

/// Shows progress, and tells the signals of the first step that can be kept.
pub struct FirstStep<'a, P> {
    signals: &'a Signals,
    is_done: bool,
    progress: P,
}

impl<'a, P> FirstStep<'a, P> {
    /// Nothing is done yet.
    pub fn new(signals: &'a Signals, progress: P) -> Self {
        Self { signals, is_done: false, progress }
    }

    fn done(&mut self) {
        if !self.is_done {
            self.is_done = true;
            self.signals.under_way();
        }
    }
}

impl<P: lennard_engine::Progress> lennard_engine::Progress for FirstStep<'_, P> {
    fn update(&mut self, stage: &str, done: u64, total: u64) {
        self.done();
        self.progress.update(stage, done, total);
    }

    fn at_row(&mut self, fluid: &dyn Fn() -> lennard_engine::Moment) {
        self.progress.at_row(fluid);
    }
}

impl<P: lennard_studies::Progress> lennard_studies::Progress for FirstStep<'_, P> {
    fn update(&mut self, label: &str, done: f64) {
        if done > 0.0 {
            self.done();
        }
        self.progress.update(label, done);
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_failure_waits_for_the_signal_that_ends_the_program() {
        let held = ending();
        let (tell, told) = std::sync::mpsc::channel();
        let waiting = std::thread::spawn(move || {
            let_a_signal_end();
            tell.send(()).unwrap();
        });
        let a_while = std::time::Duration::from_millis(100);
        assert!(told.recv_timeout(a_while).is_err());
        drop(held);
        told.recv().unwrap();
        waiting.join().unwrap();
    }

    #[test]
    fn what_nohup_ignores_is_seen() {
        let status = "Name:\tlennard\nSigBlk:\t0000000000000002\nSigIgn:\t0000000000000001\n";
        assert!(ignores(status, signal_hook::consts::SIGHUP));
        assert!(!ignores(status, SIGINT));
        assert!(!ignores("Name:\tlennard\n", SIGINT));
    }
}
