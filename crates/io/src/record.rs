//! The record of a run, `run.json`: what was run, where, how fast, and what came out.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use lennard_observables::{Average, Doubt, Estimate, Remark, Standing, finite as number};
pub use lennard_observables::{Comparison, Conservation, StatePoint};
use serde::{Deserialize, Serialize};

use crate::FormatError;
use crate::lines::read_regular;

/// Name and version of the schema of [`RunRecord`].
pub const RUN_SCHEMA: &str = crate::schema!("run", 1);

/// The record of a run. Quantities are in reduced units, averages per atom.
///
/// A number that is not finite (a standard error of too few samples) is `null` in the file and NaN when
/// read back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// [`RUN_SCHEMA`].
    pub schema: String,
    /// Whether all steps were done.
    pub finished: bool,
    /// The scene as resolved, every default written out.
    pub scene: serde_json::Value,
    /// The model in words (`Lennard-Jones, cut at 2.5 σ, with tail correction`).
    pub model: String,
    /// The seed of all random streams.
    pub seed: u64,
    /// Version of the program.
    pub version: String,
    /// The machine.
    pub host: Host,
    /// Steps done over all stages.
    pub steps: u64,
    /// Number of particles.
    pub atoms: u64,
    /// The species of a mixture; absent where the scene names none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub species: Vec<SpeciesRecord>,
    /// What acts between each pair of species, as resolved; absent where the scene names none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<PairRecord>,
    /// Degrees of freedom: 3N − 3 − constraints where total momentum is conserved, 3N otherwise.
    pub n_dof: u64,
    /// Wall time in s.
    #[serde(with = "number")]
    pub wall_s: f64,
    /// How fast it was.
    pub performance: Performance,
    /// What the neighbor lists did, and what checks of forces against sums over all pairs found.
    pub neighbor: NeighborRecord,
    /// Means with their errors, by name.
    pub averages: BTreeMap<String, AverageRecord>,
    /// The substance that the scene names, with its σ, ε and m, and the averages in its units; absent where it names none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<serde_json::Value>,
    /// How well the conserved quantities were conserved in the measured stages.
    pub conservation: Conservation,
    /// What thermostats did in the measured stages; `null` where none was on.
    pub thermostat: Option<ThermostatRecord>,
    /// What the barostat of the last stage did; absent where none was on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub barostat: Option<BarostatRecord>,
    /// Names of the files with tables of observables; absent where there is none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tables: Vec<String>,
    /// Measured values beside values of the literature.
    pub comparison: Vec<Comparison>,
    /// Remarks that belong beside the numbers, in words.
    pub remarks: Vec<String>,
    /// The kinds and fields of those remarks that a program may ask for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub typed_remarks: Vec<Remark>,
    /// Whole frames in the trajectory; `null` where there is none. Some readers drop a truncated last frame
    /// silently: this number tells.
    pub trajectory_frames: Option<u64>,
    /// The trajectory of another program that was measured: each step is one of its frames. `None` for a run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trajectory: Option<String>,
}

/// The tables that a record lists; none where it cannot be read.
pub(crate) fn tables_in(record: &Path) -> Vec<String> {
    #[derive(Deserialize)]
    struct Listed {
        #[serde(default)]
        tables: Vec<String>,
    }
    let listed = fs::read(record).map(|bytes| serde_json::from_slice::<Listed>(&bytes));
    listed.map_or_else(|_| Vec::new(), |listed| listed.map_or_else(|_| Vec::new(), |l| l.tables))
}

/// The machine that a run was made on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Host {
    /// Name of the processor.
    pub cpu: String,
    /// Instruction set of the force kernel.
    pub isa: String,
    /// Number of threads.
    pub threads: u64,
}

/// How fast a run was.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Performance {
    /// Atoms times steps per second of wall time.
    #[serde(with = "number")]
    pub atom_steps_per_s: f64,
    /// Wall time per atom and step in ns.
    #[serde(with = "number")]
    pub ns_per_atom_step: f64,
    /// Where the time went.
    pub stages: StageSeconds,
    /// What several ranks did; absent where one process did everything.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ranks: Option<RanksRecord>,
}

/// Several ranks in one run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct RanksRecord {
    /// Number of ranks; each had the threads of the record.
    pub ranks: u64,
    /// The share of the wall time in which rank 0 moved messages or waited for them.
    #[serde(with = "number")]
    pub communication: f64,
    /// Particles of other ranks that the lists of rank 0 might name, as a mean over its builds.
    #[serde(with = "number")]
    pub halo: f64,
}

/// Wall time by kind of work, in s.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct StageSeconds {
    /// Forces.
    #[serde(with = "number")]
    pub force: f64,
    /// Neighbor lists.
    #[serde(with = "number")]
    pub neighbor: f64,
    /// Kicks, drifts and thermostats.
    #[serde(with = "number")]
    pub integrate: f64,
    /// Observables.
    #[serde(with = "number")]
    pub observe: f64,
    /// Files.
    #[serde(with = "number")]
    pub write: f64,
}

/// What the neighbor lists did, and what checks of forces against sums over all pairs found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct NeighborRecord {
    /// Number of builds.
    pub builds: u64,
    /// How many forces were checked against sums over all pairs.
    pub checked_forces: u64,
    /// The largest difference among them, in units of what rounding explains: at most 1, or the run has failed; `null` where
    /// none was checked.
    pub largest_deviation: Option<f64>,
    /// Skin in σ; `null` for a direct sum.
    pub skin: Option<f64>,
}

impl NeighborRecord {
    /// What checks of forces found, in words.
    #[must_use]
    pub fn forces_checked(&self) -> String {
        self.largest_deviation.map_or_else(
            || "no force was checked".to_owned(),
            |largest| {
                let percent = 100.0 * largest;
                // A hundredth of a per cent tells double from mixed precision; more places say nothing.
                let places = if percent < 1.0 { 2 } else { 0 };
                format!(
                    "forces of {} particles checked against all pairs, largest deviation {percent:.places$} % of the tolerance",
                    self.checked_forces
                )
            },
        )
    }
}

/// A mean with what is known of its error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AverageRecord {
    /// The mean after the equilibration cut, with what is known of its error.
    #[serde(flatten)]
    pub estimate: Estimate,
    /// Unit.
    pub unit: String,
    /// What kind of number it is: `sound`, or why it is no result: `too-short`, `not-in-equilibrium`, `incomplete` (these have
    /// no standard error), `thermostat` (measured, but not the fluid's own).
    #[serde(default)]
    pub standing: Standing,
    /// The reason in words, empty where it is sound.
    #[serde(default)]
    pub reason: String,
}

impl AverageRecord {
    /// The record of an average of a run with so many measured steps.
    #[must_use]
    pub fn new(average: &Average, measured_steps: u64) -> Self {
        let doubt = average.doubt.as_ref();
        Self {
            estimate: average.estimate,
            unit: average.unit.clone(),
            standing: doubt.map_or(Standing::Sound, Doubt::standing),
            reason: doubt.map_or_else(String::new, |d| d.reason(measured_steps)),
        }
    }

    /// Whether nothing speaks against it.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.standing == Standing::Sound
    }
}

/// What the thermostats did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ThermostatRecord {
    /// Names in the scene (`bussi`).
    pub name: String,
    /// Σ heat put in, in ε for the whole system: E − heat is conserved.
    #[serde(with = "number")]
    pub heat: f64,
    /// The conserved quantity in words (`total energy − heat of the thermostat`).
    pub conserved_quantity: String,
}

/// What a barostat did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BarostatRecord {
    /// Name in the scene (`stochastic-cell-rescaling`).
    pub name: String,
    /// Pressure P₀ at the end of the stage, ε/σ³.
    #[serde(with = "number")]
    pub pressure: f64,
    /// Changes of the box proposed in the stage; `null` for a barostat without a test.
    pub proposed: Option<u64>,
    /// Changes accepted.
    pub accepted: Option<u64>,
    /// Box sides at the end, σ.
    pub lengths: [f64; 3],
}

impl BarostatRecord {
    /// What became of the proposed changes, in words; `None` for a barostat without a test.
    #[must_use]
    pub fn acceptance_in_words(&self) -> Option<String> {
        let (proposed, accepted) = (self.proposed?, self.accepted?);
        let percent = 100.0 * accepted as f64 / proposed.max(1) as f64;
        Some(format!(
            "{}: {accepted} of {proposed} changes of the box accepted ({percent:.1} %)",
            self.name
        ))
    }
}

/// Reads a run record.
///
/// # Errors
/// Where the file cannot be read, is no run record, or one of another schema.
pub fn read_run_record(path: &Path) -> Result<RunRecord, FormatError> {
    parse(&read_regular(path)?, path)
}

/// Like [`read_run_record`], from memory.
///
/// # Errors
/// Where the content is no run record, or one of another schema.
pub fn read_run_record_bytes(bytes: &[u8]) -> Result<RunRecord, FormatError> {
    parse(bytes, Path::new("run record in memory"))
}

fn parse(bytes: &[u8], path: &Path) -> Result<RunRecord, FormatError> {
    /// Looked at first: another schema may differ in everything else.
    #[derive(Deserialize)]
    struct Schema {
        schema: String,
    }
    let malformed = |e: serde_json::Error| {
        let allowed = format!("a run record of schema {RUN_SCHEMA}");
        FormatError::content(path, e.line().max(1) as u64, &e.to_string(), &allowed)
    };
    let Schema { schema } = serde_json::from_slice(bytes).map_err(malformed)?;
    if schema != RUN_SCHEMA {
        let found = format!("schema {}", crate::error::excerpt(schema.as_bytes()));
        return Err(FormatError::content(path, 1, &found, RUN_SCHEMA));
    }
    serde_json::from_slice(bytes).map_err(malformed)
}

/// The processor's own name, or the name of its architecture where it does not tell.
#[must_use]
pub fn cpu_name() -> String {
    brand()
        .or_else(|| {
            std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| from_cpuinfo(&text))
        })
        .unwrap_or_else(|| std::env::consts::ARCH.to_string())
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn brand() -> Option<String> {
    let brand = raw_cpuid::CpuId::new().get_processor_brand_string()?;
    Some(brand.as_str().trim().to_string()).filter(|name| !name.is_empty())
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
fn brand() -> Option<String> {
    None
}

/// What Linux says: the key differs from architecture to architecture.
fn from_cpuinfo(text: &str) -> Option<String> {
    ["model name", "cpu model", "Model", "Hardware", "uarch"].iter().find_map(|wanted| {
        text.lines().find_map(|line| {
            let (key, value) = line.split_once(':')?;
            (key.trim() == *wanted && !value.trim().is_empty()).then(|| value.trim().to_string())
        })
    })
}

/// A species of a mixture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SpeciesRecord {
    /// Its name.
    pub name: String,
    /// Symbol in files.
    pub element: String,
    /// Number of particles.
    pub count: u64,
    /// Mole fraction.
    pub fraction: f64,
    /// Mass of a particle, m.
    pub mass: f64,
}

/// What acts between two species.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PairRecord {
    /// Name of one species.
    pub a: String,
    /// Name of the other.
    pub b: String,
    /// σ_ab, σ.
    pub sigma: f64,
    /// ε_ab, ε.
    pub epsilon: f64,
    /// Cutoff, σ.
    pub r_cut: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_is_one_line_that_is_not_empty() {
        let name = cpu_name();
        assert!(!name.is_empty() && !name.contains('\n') && name == name.trim());
    }

    #[test]
    fn linux_tells_the_name_under_several_keys() {
        let text = "processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\n\nprocessor\t: 1\n";
        assert_eq!(from_cpuinfo(text).unwrap(), "Some CPU @ 2 GHz");
        assert_eq!(from_cpuinfo("Model\t\t: A board\n").unwrap(), "A board");
        assert_eq!(from_cpuinfo("processor : 0\n"), None);
    }
}
