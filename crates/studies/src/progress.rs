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
