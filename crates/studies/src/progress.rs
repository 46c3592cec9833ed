//! How a study says how far it is.

/// Takes how far a study is; the command line shows it as a bar.
pub trait Progress {
    /// `done`, from 0 to 1, of the whole study; `label` says what is at work.
    fn update(&mut self, label: &str, done: f64);
}

/// Shows no progress.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn update(&mut self, _label: &str, _done: f64) {}
}

/// A part of a study, from one share of the whole to another.
pub(crate) struct Part<'a> {
    whole: &'a mut dyn Progress,
    from: f64,
    to: f64,
}

impl<'a> Part<'a> {
    pub(crate) fn of(whole: &'a mut dyn Progress, from: f64, to: f64) -> Self {
        Self { whole, from, to }
    }
}

impl Progress for Part<'_> {
    fn update(&mut self, label: &str, done: f64) {
        self.whole.update(label, self.from + (self.to - self.from) * done);
    }
}
