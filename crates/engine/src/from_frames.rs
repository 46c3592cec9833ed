//! A simulation that has its states from the frames of a trajectory.

use lennard_observables::Remark;

/// The name of the method whose steps are frames.
pub(crate) const NAME: &str = "frames";

/// What is known of the frames that a simulation has its states from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FromFrames {
    /// The trajectory.
    pub(crate) file: String,
    /// Whether frames have velocities; otherwise velocities stand for the temperature of the scene.
    pub(crate) has_velocities: bool,
    /// Observables of the scene that the frames cannot give.
    pub(crate) left_out: Vec<Remark>,
    /// How positions are rounded; `None` where that changes nothing.
    pub(crate) rounding: Option<Rounding>,
}

/// Rounded positions, and by how much rounding raises the means.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Rounding {
    /// The step between two positions that the file tells apart, σ.
    pub(crate) step: f64,
    /// Of U/N, ε, and of P, ε/σ³: means over some frames.
    pub(crate) bias: [f64; 2],
    /// How many frames these are.
    frames: u64,
}

impl Rounding {
    /// A step whose bias has not been found yet.
    pub(crate) fn of_step(step: f64) -> Self {
        Self { step, ..Self::default() }
    }

    /// Adds the bias of a frame to the mean.
    pub(crate) fn add(&mut self, bias: [f64; 2]) {
        self.frames += 1;
        for (mean, bias) in self.bias.iter_mut().zip(bias) {
            *mean += (bias - *mean) / self.frames as f64;
        }
    }

    pub(crate) fn in_words(&self) -> String {
        let Self { step, bias: [energy, pressure], frames } = self;
        format!(
            "positions are rounded to {step:.1e} σ, which changes U by {energy:+.1e} ε and P by {pressure:+.1e} ε/σ³ in the first \
             {frames} frames"
        )
    }
}

/// Quantities of velocities alone.
pub(crate) const OF_VELOCITIES: [&str; 3] = ["temperature", "kinetic_energy", "total_energy"];
/// The quantity that a thermostat's heat belongs to, which frames do not tell.
pub(crate) const CONSERVED: &str = "conserved_energy";

impl FromFrames {
    /// Whether a quantity is not of the frames.
    pub(crate) fn hides(&self, name: &str) -> bool {
        name == CONSERVED
            || !self.has_velocities
                && (OF_VELOCITIES.contains(&name) || name.starts_with("temperature_"))
    }
}
