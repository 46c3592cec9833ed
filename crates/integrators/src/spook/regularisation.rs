//! Compliance and damping of a constraint as SPOOK uses them.

use lennard_core::options::OptionError;

/// What compliance and damping become for a step h: Σ = (4/h²)·ε/(1 + 4τ/h) and γ = 1/(1 + 4τ/h).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Regularisation {
    /// Σ, in units of an inverse mass.
    pub sigma: f64,
    /// γ, between 0 and 1.
    pub gamma: f64,
}

/// The damping of constraints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// A time τ.
    Time(f64),
    /// A number of time steps.
    Steps(f64),
}

impl Damping {
    /// A damping time where one is given, else a number of steps.
    #[must_use]
    pub fn new(steps: f64, time: Option<f64>) -> Self {
        match time {
            Some(time) => Self::Time(time),
            None => Self::Steps(steps),
        }
    }

    /// The regularisation of a compliance ε with this damping for a step h.
    #[must_use]
    pub fn regularised(self, compliance: f64, dt: f64) -> Regularisation {
        let time = match self {
            Self::Time(time) => time,
            Self::Steps(steps) => steps * dt,
        };
        Regularisation::new(compliance, time, dt)
    }

    /// Whether nothing is damped.
    #[must_use]
    pub fn is_none(self) -> bool {
        let (Self::Time(damping) | Self::Steps(damping)) = self;
        damping == 0.0
    }

    /// Refuses no compliance without damping: the one-step map of a rigid constraint is then a Jordan block, and |x_n| grows as 2n + 1.
    ///
    /// # Errors
    /// [`OptionError`] that names the compliance.
    pub fn suits(self, compliance: f64) -> Result<(), OptionError> {
        if compliance == 0.0 && self.is_none() {
            return Err(OptionError {
                key: "compliance",
                found: "0 without damping, which is unstable: errors grow with each step"
                    .to_owned(),
                allowed: "damping_steps of at least 0.5, or a compliance above 0".to_owned(),
            });
        }
        Ok(())
    }
}

impl Regularisation {
    /// For compliance ε, damping time τ and step h.
    #[must_use]
    pub fn new(compliance: f64, damping_time: f64, dt: f64) -> Self {
        let gamma = 1.0 / (1.0 + 4.0 * damping_time / dt);
        Self { sigma: 4.0 / (dt * dt) * compliance * gamma, gamma }
    }
}
