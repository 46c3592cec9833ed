//! The table `[integrator]`: the method that advances time, with its step.

use lennard_forcefield::SplitOptions;
use lennard_integrators::{IntegratorEntry, IntegratorOptions, OscillatorModel, respa};
use toml::Value;

use crate::IntegratorTable;
use crate::error::SceneError;
use crate::read::Reader;
use crate::reference::{LONGEST_SIDE, LONGEST_STEP, SHORTEST_STEP, quoted};

/// Where the near force of RESPA ends, σ, unless the scene says otherwise: beyond the first shell of neighbors.
pub const DEFAULT_SPLIT: SplitOptions = SplitOptions { r_split: 1.7, width: 0.4 };

lennard_core::options! {
    /// The keys of `[integrator]` that all methods have.
    pub(crate) struct IntegratorKeys {
        /// Time step.
        dt: f64 = 0.004, Between(SHORTEST_STEP, LONGEST_STEP), in "τ";
    }
}

lennard_core::options! {
    /// The keys of the split force, which multiple time steps bring along.
    pub(crate) struct SplitKeys {
        /// Where the near force ends; below `truncation.r_cut`.
        r_split: f64 = DEFAULT_SPLIT.r_split, Between(1e-6, LONGEST_SIDE), in "σ";
        /// Over which distance it ends; at most `r_split`.
        split_width: f64 = DEFAULT_SPLIT.width, Between(1e-6, LONGEST_SIDE), in "σ";
    }
}

/// The shared keys of `[integrator]` as a scene writes them.
#[derive(serde::Serialize)]
pub(crate) struct StepKeys {
    #[serde(flatten)]
    step: IntegratorKeys,
    #[serde(flatten)]
    split: Option<SplitKeys>,
}

impl From<&IntegratorTable> for StepKeys {
    fn from(table: &IntegratorTable) -> Self {
        Self {
            step: IntegratorKeys { dt: table.dt },
            split: table
                .split
                .map(|split| SplitKeys { r_split: split.r_split, split_width: split.width }),
        }
    }
}

impl Reader<'_> {
    pub fn integrator(&self) -> Result<IntegratorTable, SceneError> {
        let section = self.section("integrator");
        let mut table = self.table("integrator").clone();
        let IntegratorKeys { dt } = section.take(&mut table)?;
        let kind = table.get("kind").and_then(Value::as_str);
        let split = match kind == Some(respa::SPEC.name) {
            false => None,
            true => {
                let keys: SplitKeys = section.take(&mut table)?;
                Some(SplitOptions { r_split: keys.r_split, width: keys.split_width })
            }
        };
        let method = section.method(&table)?;
        self.suits_a_fluid(&method)?;
        Ok(IntegratorTable { dt, method, split })
    }

    /// Refuses methods that move nothing by pair forces.
    fn suits_a_fluid(&self, method: &IntegratorOptions) -> Result<(), SceneError> {
        let moves_fluids = |entry: &&IntegratorEntry| entry.oscillator == OscillatorModel::Force;
        let fit = lennard_integrators::integrators().iter().filter(moves_fluids);
        let names: Vec<&str> = fit.map(|entry| entry.spec.name).collect();
        // Bonds and contacts give SPOOK something to solve for; they are checked with it later.
        let solves = self.source.wrote("molecule") || self.source.wrote("contact");
        let by_spook = solves && method.name() == lennard_integrators::spook::SPEC.name;
        if by_spook || names.contains(&method.name()) {
            return Ok(());
        }
        Err(self
            .source
            .refuse(
                "integrator.kind",
                match method.name() == lennard_integrators::spook::SPEC.name {
                    true => "has nothing to solve for without `[molecule]` or `[contact]`",
                    false => "cannot move a fluid: it works on the oscillator alone",
                },
            )
            .found(format!("{:?}", method.name()))
            .allowed(quoted(&names)))
    }
}

/// The integrators that fit, as a scene names them: `integrator.kind = "leapfrog", "velocity-verlet"`.
pub(crate) fn kinds_that(fit: impl Fn(&IntegratorEntry) -> bool) -> String {
    let all = lennard_integrators::integrators().iter();
    let names: Vec<&str> = all.filter(|entry| fit(entry)).map(|entry| entry.spec.name).collect();
    format!("integrator.kind = {}", quoted(&names))
}
