//! Progress on standard error: a bar with time left on a terminal, plain lines elsewhere. A run shows T, U and P as it goes.

use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use lennard_engine::{Moment, Progress};

use crate::program::watch::{History, LivePage};

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
    /// T, U and P in words, taken since the last line.
    fluid: Option<String>,
    /// T, U and P since the start, with `--watch`.
    history: Option<History>,
    /// A page of the run as it goes, with `--watch`.
    page: Option<LivePage>,
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
                    "{msg:12} {bar:20.cyan/blue} {percent:>3}%  {eta} left  step {human_pos}  {prefix}"
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
            fluid: None,
            history: None,
            page: None,
        }
    }

    /// The same with the course of T, U and P, where a page is to be kept.
    pub fn watching(mut self, page: Option<LivePage>) -> Self {
        self.history = page.is_some().then(History::default);
        self.page = page;
        self
    }
}

/// "T 0.722  U −6.070  P 0.19": what is not known at this step is left out.
fn in_words(fluid: Moment) -> String {
    let values = [("T", fluid.temperature), ("U", fluid.potential_energy), ("P", fluid.pressure)];
    let known = values.into_iter().filter(|(_, value)| value.is_finite());
    let words: Vec<String> = known
        .map(|(symbol, value)| {
            format!("{symbol} {}", lennard_studies::report::significant(value, 4))
        })
        .collect();
    words.join("  ")
}

impl Display {
    /// Time between two updates.
    fn interval(&self) -> Duration {
        if self.bar.is_some() { BAR_INTERVAL } else { LINE_INTERVAL }
    }

    /// Whether it is time to show how far things are.
    fn is_due(&self, changed: bool, ended: bool, now: Instant) -> bool {
        // A study has a stage for each variant, too many for a line each.
        let told = self.bar.is_some() || self.what == What::Steps || self.label.is_empty();
        ended || changed && told || now.duration_since(self.last) >= self.interval()
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
                if let Some(fluid) = self.fluid.take() {
                    bar.set_prefix(fluid);
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
                        let fluid =
                            self.fluid.take().map_or_else(String::new, |f| format!("; {f}"));
                        eprintln!("{stage}: step {done} of {total} ({percent:.0} %){left}{fluid}")
                    }
                    What::Share => eprintln!("{percent:.0} %{left}: {stage}"),
                }
            }
        }
    }

    fn at_row(&mut self, fluid: &dyn Fn() -> Moment) {
        self.page.take_if(|page| !page.write());
        let is_due = self.last.elapsed() >= self.interval();
        if self.silent || !(is_due || self.history.is_some()) {
            return;
        }
        let fluid = fluid();
        if let Some(history) = &mut self.history {
            history.add(fluid);
        }
        if is_due {
            let course = self.history.iter().flat_map(History::lines);
            let lines = std::iter::once(in_words(fluid)).chain(course);
            self.fluid = Some(lines.collect::<Vec<_>>().join("\n"));
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
    fn the_fluid_is_told_in_symbols_and_what_is_unknown_is_left_out() {
        let fluid = |pressure| Moment {
            temperature: 0.72213,
            kinetic_energy: 1.08,
            potential_energy: -6.0701,
            pressure,
        };
        assert_eq!(in_words(fluid(0.19)), "T 0.7221  U −6.070  P 0.1900");
        assert_eq!(in_words(fluid(f64::NAN)), "T 0.7221  U −6.070");
    }

    #[test]
    fn the_fluid_is_asked_for_only_where_a_line_is_due() {
        let mut display = Display::new(false);
        display.bar = None;
        let asked = std::cell::Cell::new(0);
        let fluid = || {
            asked.set(asked.get() + 1);
            Moment { temperature: 1.0, kinetic_energy: 1.5, potential_energy: -1.0, pressure: 0.1 }
        };
        display.at_row(&fluid);
        assert_eq!(asked.get(), 0);
        display.last -= LINE_INTERVAL;
        display.at_row(&fluid);
        assert_eq!(asked.get(), 1);
        assert_eq!(display.fluid.as_deref(), Some("T 1.000  U −1.000  P 0.1000"));
        display.history = Some(History::default());
        let mut watched = display;
        watched.at_row(&fluid);
        assert!(watched.fluid.take().unwrap().contains("\nT ▁ 1.000 to 1.000\nU ▁"));
        watched.last = Instant::now();
        watched.at_row(&fluid);
        assert_eq!((asked.get(), &watched.fluid), (3, &None), "every row is kept, few are told");
    }

    #[test]
    fn lines_are_few_where_there_is_no_terminal() {
        let lines = |what, label: &str| {
            let mut display = Display::counting(what, true);
            display.bar = None;
            label.clone_into(&mut display.label);
            display
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
