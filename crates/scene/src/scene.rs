//! What a scene says, with every default filled in.

use lennard_core::random::Streams;
use lennard_core::{DVec3, Integrator, PeriodicBox, Ramp};
use lennard_forcefield::{
    ForceFieldOptions, KernelOptions, NeighborOptions, PotentialOptions, SplitOptions,
    TruncationOptions,
};
use lennard_integrators::{BarostatOptions, ExchangeOptions, IntegratorOptions, ThermostatOptions};
use lennard_io::TrajectoryFormat;
use lennard_observables::ObservableOptions;

use crate::{
    Accuracy, ContactTable, MixtureTables, Molecule, Name, ProgramParts, Source, Start, WallTable,
};

/// A scene: everything that a run depends on but the machine. Reduced units throughout.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Its name; the file's stem unless the file gives another.
    pub name: Name,
    /// Where the particles start.
    pub system: System,
    /// The species of the particles and their pairs; `None` where the scene names none: σ = ε = m = 1 for all.
    pub mixture: Option<MixtureTables>,
    /// What molecules the particles are bonded to; `None` for atoms.
    pub molecule: Option<Molecule>,
    /// The errors that are accepted, where the scene asks for an accuracy.
    pub accuracy: Option<Accuracy>,
    /// The settings that the accuracy leaves to be chosen and that no lock file has brought. While there are
    /// any, their fields hold defaults, and the scene must not be run.
    pub free: Vec<&'static str>,
    /// The pair potential.
    pub potential: PotentialOptions,
    /// How the potential ends.
    pub truncation: TruncationOptions,
    /// Whether what lies beyond the cutoff acts as a force across flat surfaces, in place of a number added to means.
    pub planar_tail: bool,
    /// How neighbors are found.
    pub neighbor: NeighborOptions,
    /// Which pair kernel computes them.
    pub kernel: KernelOptions,
    /// The method that advances time.
    pub integrator: IntegratorTable,
    /// Walls, one pair per axis at most; empty for a periodic fluid.
    pub walls: Vec<WallTable>,
    /// Contacts between bodies; `None` where particles are points.
    pub contact: Option<ContactTable>,
    /// Acceleration by a constant field, σ/τ²; zero without one.
    pub acceleration: DVec3,
    /// What happens one after the other; at least one.
    pub stages: Vec<Stage>,
    /// What is measured besides thermodynamics.
    pub observables: Vec<ObservableTable>,
    /// What is written.
    pub output: Output,
    /// When checkpoints are written.
    pub checkpoint: Checkpoint,
    /// What the program of the run added; empty for a scene that runs by itself.
    pub program: ProgramParts,
    /// Where each key was written.
    pub source: Source,
}

impl Scene {
    /// The options of the force field together, with what the integrator needs. RESPA needs forces split by
    /// distance. The bit-reversible method needs forces that are a pure function of the positions.
    #[must_use]
    pub fn force_field(&self) -> ForceFieldOptions {
        ForceFieldOptions {
            split: self.integrator.split,
            canonical: matches!(self.integrator.method, IntegratorOptions::BitReversibleVerlet(_)),
            potential: self.potential,
            truncation: self.truncation,
            neighbor: self.neighbor,
            kernel: self.kernel,
            exclusions: self.molecules().exclusions(),
        }
    }

    /// The method of a stage with its bath: a bath that stands inside the step takes the place of the integrator. It draws from
    /// a stream of its own, and serves to ask what the method is.
    #[must_use]
    pub fn method_of(&self, stage: &Stage) -> Integrator {
        let method = lennard_integrators::build(&self.integrator.method);
        match &stage.thermostat {
            Some(bath) => {
                let noise = Streams::new(0).noise("check");
                bath.couple(method, stage.temperature_ramp(0), noise)
            }
            None => method,
        }
    }

    /// The mass of the lightest species; 1 where particles are alike.
    pub(crate) fn lightest_mass(&self) -> f64 {
        let masses = self.mixture.iter().flat_map(|m| &m.species).map(|s| s.mass);
        masses.reduce(f64::min).unwrap_or(1.0)
    }

    /// The step of a stage in τ: its own, or the step of the integrator table.
    #[must_use]
    pub fn stage_dt(&self, stage: &Stage) -> f64 {
        stage.dt.unwrap_or(self.integrator.dt)
    }

    /// The steps of all stages together.
    #[must_use]
    pub fn total_steps(&self) -> u64 {
        self.steps_before(self.stages.len())
    }

    /// The steps of all stages before one.
    #[must_use]
    pub fn steps_before(&self, index: usize) -> u64 {
        self.stages[..index].iter().map(|stage| stage.steps).sum()
    }
}

/// The table `[system]`.
#[derive(Debug, Clone, PartialEq)]
pub struct System {
    /// Where the particles are at step 0.
    pub start: Start,
    /// Temperature of the first velocities in ε/k_B (where the start has none) and of every thermostat
    /// that names no other; ≥ 0.
    pub temperature: f64,
    /// Seed of every random stream.
    pub seed: u64,
    /// Particles that never move, by their numbers from 0, ascending.
    pub held: Vec<usize>,
}

lennard_core::choices! {
    /// The arrangement of the first positions.
    pub enum Lattice {
        /// Face-centred cubic, 4 particles a cell.
        #[default]
        Fcc = "fcc",
        /// Simple cubic, 1 particle a cell.
        Sc = "sc",
        /// Body-centred cubic, 2 particles a cell.
        Bcc = "bcc",
        /// At random, relaxed until nothing overlaps.
        Random = "random",
    }
}

/// The size of a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Geometry {
    /// A cube that holds the particles at this number density, σ⁻³.
    Density(f64),
    /// Three sides in σ.
    Box([f64; 3]),
}

/// A box with the part of it that particles fill at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// The periodic box.
    pub cell: PeriodicBox,
    /// The lower corner of the filled part, σ.
    pub corner: DVec3,
    /// The sides of the filled part, σ.
    pub filled: DVec3,
    /// Lattice cells along each axis; `None` for a random start.
    pub cells: Option<[usize; 3]>,
}

/// The table `[integrator]`.
#[derive(Debug, Clone, PartialEq)]
pub struct IntegratorTable {
    /// Time step in τ.
    pub dt: f64,
    /// The method with its own keys.
    pub method: IntegratorOptions,
    /// Where the pair force is split into a near and a far part, for a method that asks for them.
    pub split: Option<SplitOptions>,
}

/// A table `[[stage]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage {
    /// Its name; every stage has another name.
    pub name: Name,
    /// Number of steps.
    pub steps: u64,
    /// Temperature of its thermostat in ε/k_B, at the end of a ramp; the temperature of the system where none is given.
    pub temperature: f64,
    /// Temperature at the start of a ramp in ε/k_B; `None` for a constant temperature.
    pub temperature_from: Option<f64>,
    /// Its own time step in τ.
    pub dt: Option<f64>,
    /// The heat bath; `None` is constant energy.
    pub thermostat: Option<ThermostatOptions>,
    /// The pressure bath; `None` is constant volume.
    pub barostat: Option<PressureControl>,
    /// The exchange of velocities that drives a flow; `None` for a fluid at rest.
    pub exchange: Option<ExchangeOptions>,
    /// Whether observables look at it.
    pub measure: bool,
}

/// The `barostat` of a stage.
#[derive(Debug, Clone, PartialEq)]
pub struct PressureControl {
    /// Pressure in ε/σ³, at the end of a ramp.
    pub pressure: f64,
    /// Pressure at the start of a ramp in ε/σ³; `None` for a constant pressure.
    pub pressure_from: Option<f64>,
    /// The barostat with its own keys.
    pub options: BarostatOptions,
}

impl PressureControl {
    /// "P = 1.2", or "P from 0.5 to 1.2" for a ramp.
    #[must_use]
    pub fn pressure_in_words(&self) -> String {
        in_words("P", self.pressure_from, self.pressure)
    }
}

fn in_words(symbol: &str, from: Option<f64>, to: f64) -> String {
    match from {
        Some(from) => format!("{symbol} from {from} to {to}"),
        None => format!("{symbol} = {to}"),
    }
}

impl Stage {
    /// "T = 1.2", or "T from 2 to 1.2" for a ramp.
    #[must_use]
    pub fn temperature_in_words(&self) -> String {
        in_words("T", self.temperature_from, self.temperature)
    }

    /// The temperature of the bath at each step, for a stage that begins at step `first`.
    #[must_use]
    pub fn temperature_ramp(&self, first: u64) -> Ramp {
        let from = self.temperature_from.unwrap_or(self.temperature);
        Ramp::linear(from, self.temperature, first, self.steps)
    }

    /// The pressure at each step, for a stage that begins at step `first`; `None` without a barostat.
    #[must_use]
    pub fn pressure_ramp(&self, first: u64) -> Option<Ramp> {
        let control = self.barostat.as_ref()?;
        let from = control.pressure_from.unwrap_or(control.pressure);
        Some(Ramp::linear(from, control.pressure, first, self.steps))
    }

    /// Whether temperature or pressure change on the way.
    #[must_use]
    pub fn is_ramp(&self) -> bool {
        let pressure = self.barostat.as_ref().and_then(|b| b.pressure_from);
        self.temperature_from.is_some() || pressure.is_some()
    }
}

/// A table `[[observable]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservableTable {
    /// Steps between two samples.
    pub every: u64,
    /// The observable with its own keys.
    pub options: ObservableOptions,
}

/// The table `[output]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Steps between two frames of the trajectory; `None` for no trajectory.
    pub trajectory_every: Option<u64>,
    /// The format of the trajectory.
    pub format: TrajectoryFormat,
    /// Positions of a format that rounds them are multiples of σ over this number.
    pub precision: f64,
    /// Whether frames hold too what ASE looks for: momenta, masses and the energy.
    pub ase: bool,
    /// Steps between two lines of `thermo.csv`.
    pub thermo_every: u64,
    /// Element symbol of the particles in files.
    pub element: String,
    /// Whether frames hold velocities.
    pub velocities: bool,
    /// Whether frames hold forces.
    pub forces: bool,
    /// Whether positions are written unwrapped; otherwise inside the box, with image flags.
    pub unwrapped: bool,
    /// Whether the sites of a molecule are folded into the box together.
    pub whole: bool,
    /// Lengths in the trajectory are those in σ times this factor.
    pub length_scale: f64,
}

/// The table `[checkpoint]`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Checkpoint {
    /// Steps between two checkpoints.
    pub every_steps: Option<u64>,
    /// Wall-clock seconds between two checkpoints.
    pub every_seconds: Option<f64>,
}
