//! Progress on standard error: a bar with time left on a terminal, plain lines elsewhere.

use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use lennard_engine::Progress;

/// Time between two updates of the bar.
const BAR_INTERVAL: Duration = Duration::from_millis(100);
/// Time between two plain lines.
const LINE_INTERVAL: Duration = Duration::from_secs(10);

/// Shows how far a run is.
pub struct Display {
    bar: Option<ProgressBar>,
    label: String,
    started: Instant,
    last: Instant,
    silent: bool,
    what: What,
}

/// What is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum What {
    /// Steps of a run.
    Steps,
    /// The share done of a study, in thousandths.
    Share,
}

/// Parts of a whole that a study is counted in.
const SHARES: u64 = 1000;

impl Display {
    /// A bar where standard error is a terminal, lines where it is not, nothing where `quiet`.
    pub fn new(quiet: bool) -> Self {
        Self::counting(What::Steps, quiet)
    }

    /// The same for a study, which tells a share and no steps.
    pub fn of_study(quiet: bool) -> Self {
        Self::counting(What::Share, quiet)
    }

    fn counting(what: What, quiet: bool) -> Self {
        let terminal = console::user_attended_stderr();
        let bar = (terminal && !quiet).then(|| {
            let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template(match what {
                What::Steps => {
                    "{msg:16} {bar:32.cyan/blue} {percent:>3}%  {human_pos} of {human_len} steps, {eta} left"
                }
                What::Share => "{bar:32.cyan/blue} {percent:>3}%  {eta} left  {msg}",
            });
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        });
        let now = Instant::now();
        Self {
            bar,
            label: String::new(),
            started: now,
            last: now,
            silent: quiet,
            what,
        }
    }
}

impl Display {
    /// Whether it is time to show how far things are.
    fn is_due(&self, changed: bool, ended: bool, now: Instant) -> bool {
        let interval = if self.bar.is_some() {
            BAR_INTERVAL
        } else {
            LINE_INTERVAL
        };
        // A study has a stage for each variant, too many for a line each.
        let told = self.bar.is_some() || self.what == What::Steps || self.label.is_empty();
        ended || changed && told || now.duration_since(self.last) >= interval
    }
}

impl Progress for Display {
    fn update(&mut self, stage: &str, done: u64, total: u64) {
        if self.silent {
            return;
        }
        let changed = self.label != stage;
        let now = Instant::now();
        if !self.is_due(changed, done >= total, now) {
            return;
        }
        self.last = now;
        if changed {
            stage.clone_into(&mut self.label);
        }
        match &self.bar {
            Some(bar) => {
                if changed {
                    bar.set_message(stage.to_owned());
                }
                bar.set_length(total);
                bar.set_position(done);
                if done >= total {
                    bar.finish_and_clear();
                }
            }
            None => {
                let elapsed = self.started.elapsed();
                let left = elapsed.mul_f64((total - done) as f64 / done.max(1) as f64);
                let percent = 100.0 * done as f64 / total.max(1) as f64;
                // Right after the start the rate is not known yet.
                let left = if elapsed < Duration::from_secs(1) || done >= total {
                    String::new()
                } else {
                    format!(", {} left", HumanDuration(left))
                };
                match self.what {
                    What::Steps => {
                        eprintln!("{stage}: step {done} of {total} ({percent:.0} %){left}")
                    }
                    What::Share => eprintln!("{percent:.0} %{left}: {stage}"),
                }
            }
        }
    }
}

impl lennard_studies::Progress for Display {
    fn update(&mut self, label: &str, done: f64) {
        Progress::update(self, label, (done * SHARES as f64) as u64, SHARES);
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_few_where_there_is_no_terminal() {
        let lines = |what, label: &str| Display {
            bar: None,
            label: label.to_owned(),
            what,
            ..Display::counting(what, true)
        };
        let study = lines(What::Share, "a kernel");
        let soon = study.last + Duration::from_secs(1);
        assert!(!study.is_due(true, false, soon), "the next kernel");
        assert!(study.is_due(true, false, study.last + LINE_INTERVAL));
        assert!(study.is_due(false, true, soon), "the end");
        let beginning = lines(What::Share, "");
        assert!(beginning.is_due(true, false, beginning.last));
        let run = lines(What::Steps, "melting");
        assert!(run.is_due(true, false, run.last), "the next stage");
        assert!(!run.is_due(false, false, run.last));
    }
}
