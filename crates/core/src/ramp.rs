//! A quantity that stays as it is or changes linearly with the steps of a stage.

/// What a bath holds at each step: a constant, or a straight line from one value to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    from: f64,
    to: f64,
    first: u64,
    steps: u64,
}

impl Ramp {
    /// The same value at each step.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Self::linear(value, value, 0, 0)
    }

    /// From one value at step `first` to another, `steps` steps later; constant before and after.
    #[must_use]
    pub fn linear(from: f64, to: f64, first: u64, steps: u64) -> Self {
        Self { from, to, first, steps }
    }

    /// The value at a step.
    #[must_use]
    pub fn at(&self, step: u64) -> f64 {
        let done = step.saturating_sub(self.first);
        if self.from == self.to || done >= self.steps {
            return self.to;
        }
        self.from + (self.to - self.from) * (done as f64 / self.steps as f64)
    }
}

impl From<f64> for Ramp {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_is_a_straight_line_between_its_ends() {
        let ramp = Ramp::linear(2.0, 1.0, 100, 50);
        let values = [0, 100, 125, 149, 150, 1000].map(|step| ramp.at(step));
        assert_eq!(values, [2.0, 2.0, 1.5, 2.0 - 49.0 / 50.0, 1.0, 1.0]);
        assert_eq!(Ramp::constant(0.7).at(12), 0.7);
    }
}
