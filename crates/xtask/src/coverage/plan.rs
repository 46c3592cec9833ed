//! What is simulated: states, ensembles and lengths, and the scene of each.

use std::fmt::Write as _;

/// How the particles fill the box at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Filling {
    /// A gas at this density, from random points.
    Random(f64),
    /// A fluid at this density, from a lattice that melts at the temperature given with it.
    Lattice { density: f64, melt_at: f64 },
    /// A slab of liquid between vacuums.
    Slab,
}

/// A state of the fluid and how a run gets there.
#[derive(Debug, PartialEq)]
pub struct State {
    /// Its name, which is the name of its folder.
    pub name: &'static str,
    n_atoms: u32,
    filling: Filling,
    /// Temperature of the baths, ε/k_B.
    temperature: f64,
    /// Cutoff radius, σ.
    r_cut: f64,
    /// Time step, τ.
    dt: f64,
    /// Steps at the state's temperature before anything is measured.
    equilibrate: u32,
}

/// The states, in the order of their density; the slab is the last.
pub const STATES: [State; 10] = [
    gas("rho0.003-T0.9", 108, 0.003, 0.9, 4.0, 40_000),
    gas("rho0.02-T1.0", 108, 0.02, 1.0, 4.0, 30_000),
    gas("rho0.05-T2.0", 108, 0.05, 2.0, 3.5, 20_000),
    gas("rho0.1-T1.5", 128, 0.1, 1.5, 3.0, 20_000),
    gas("rho0.3-T1.5", 256, 0.3, 1.5, 2.5, 15_000),
    dense("rho0.5-T1.5", 0.5, 1.5, 0.004, 4.0),
    dense("rho0.7-T1.2", 0.7, 1.2, 0.004, 3.0),
    dense("rho0.8442-T0.722", 0.8442, 0.722, 0.004, 2.5),
    dense("rho0.9-T1.2", 0.9, 1.2, 0.003, 4.0),
    State {
        name: "slab-T0.75",
        n_atoms: 320,
        filling: Filling::Slab,
        temperature: 0.75,
        r_cut: 2.5,
        dt: 0.004,
        equilibrate: 12_000,
    },
];

const fn gas(
    name: &'static str,
    n_atoms: u32,
    density: f64,
    temperature: f64,
    r_cut: f64,
    equilibrate: u32,
) -> State {
    State {
        name,
        n_atoms,
        filling: Filling::Random(density),
        temperature,
        r_cut,
        dt: 0.004,
        equilibrate,
    }
}

const fn dense(name: &'static str, density: f64, temperature: f64, dt: f64, melt_at: f64) -> State {
    State {
        name,
        n_atoms: 256,
        filling: Filling::Lattice { density, melt_at },
        temperature,
        r_cut: 2.5,
        dt,
        equilibrate: 8000,
    }
}

impl State {
    /// Whether this is a liquid, whose longest runs may not be too short.
    #[must_use]
    pub fn is_liquid(&self) -> bool {
        const LEAST_DENSITY: f64 = 0.7;
        matches!(self.filling, Filling::Lattice { density, .. } if density >= LEAST_DENSITY)
    }
}

/// What holds in the measured stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ensemble {
    /// Constant energy.
    Energy,
    /// Stochastic velocity rescaling.
    Bussi,
    /// Langevin dynamics.
    Langevin,
}

/// All ensembles.
pub const ENSEMBLES: [Ensemble; 3] = [Ensemble::Energy, Ensemble::Bussi, Ensemble::Langevin];

impl Ensemble {
    /// Its name, which is the name of its folder.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Energy => "energy",
            Self::Bussi => "bussi",
            Self::Langevin => "langevin",
        }
    }

    fn thermostat(self) -> &'static str {
        match self {
            Self::Energy => "\"none\"",
            Self::Bussi => "{ kind = \"bussi\", tau = 1.0 }",
            Self::Langevin => "{ kind = \"langevin\", friction = 1.0 }",
        }
    }
}

/// Measured steps of a run.
pub const LENGTHS: [u64; 3] = [2500, 20_000, 200_000];

/// One cell of the plan: all its runs differ in their seed alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// The state.
    pub state: &'static State,
    /// The ensemble.
    pub ensemble: Ensemble,
    /// Measured steps.
    pub length: u64,
}

impl Cell {
    /// Its folder, relative to the folder of all data.
    #[must_use]
    pub fn folder(&self) -> String {
        format!("{}/{}/{}", self.state.name, self.ensemble.name(), self.length)
    }

    /// Seed of a run's random numbers: runs of different length share none, so that they are independent.
    #[must_use]
    pub fn seed(&self, run: u32) -> u64 {
        const APART: u64 = 1_000_000;
        self.length * APART + u64::from(run)
    }

    /// The scene. Every run melts its own crystal or starts from its own random points.
    #[must_use]
    pub fn scene(&self) -> String {
        let State { n_atoms, temperature, r_cut, dt, equilibrate, .. } = *self.state;
        let (lattice, place, truncation) = match self.state.filling {
            Filling::Random(density) => ("random", format!("density = {density}"), "cut"),
            Filling::Lattice { density, .. } => ("fcc", format!("density = {density}"), "cut"),
            Filling::Slab => ("fcc", "box = [6.84, 6.84, 8.55]\nvacuum = 10.0".to_owned(), "shift"),
        };
        let mut text = format!(
            "[system]\nlattice = \"{lattice}\"\nn_atoms = {n_atoms}\n{place}\ntemperature = {temperature}\n\
             [truncation]\nkind = \"{truncation}\"\nr_cut = {r_cut:?}\n[integrator]\ndt = {dt}\n"
        );
        let mut add = |lines: &str| {
            let _ = writeln!(text, "{lines}");
        };
        if let Filling::Lattice { melt_at, .. } = self.state.filling {
            add(&format!(
                "[[stage]]\nname = \"melt\"\nsteps = 4000\ndt = {}\ntemperature = {melt_at:?}\n\
                 thermostat = {{ kind = \"langevin\", friction = 1.0 }}",
                dt / 2.0
            ));
        }
        // A gas reaches its temperature by the bath and its structure by diffusion, so the friction is small.
        add(&format!(
            "[[stage]]\nname = \"equilibrate\"\nsteps = {equilibrate}\n\
             thermostat = {{ kind = \"langevin\", friction = 0.5 }}"
        ));
        if self.ensemble == Ensemble::Energy {
            // Equal kinetic energies leave less of the difference between the seeds' total energies.
            add(
                "[[stage]]\nname = \"settle\"\nsteps = 10\nthermostat = { kind = \"rescale\", every = 10 }",
            );
        }
        add(&format!(
            "[[stage]]\nname = \"production\"\nsteps = {}\nthermostat = {}",
            self.length,
            self.ensemble.thermostat()
        ));
        for (kind, every) in [("pressure-tensor", 10), ("msd", 10), ("vacf", 5)] {
            add(&format!("[[observable]]\nkind = \"{kind}\"\nevery = {every}"));
        }
        if self.state.filling != Filling::Slab {
            add("[[observable]]\nkind = \"rdf\"\nevery = 50");
        }
        if self.state.is_liquid() {
            add(
                "[[observable]]\nkind = \"structure-factor\"\nevery = 100\nshells = 30\ndirections = 6",
            );
        }
        // A finished run has the checkpoint of its last step, whatever the interval.
        add("[output]\nthermo_every = 10\n[checkpoint]\nevery_seconds = 1000000.0");
        text
    }
}

/// Cells in the order of their runs, so that an unfinished study is of use.
/// Short lengths come first, then the longest of the liquids, of the densest fluids, of the slab and of the gases.
#[must_use]
pub fn in_order(states: &[&'static State], ensembles: &[Ensemble], lengths: &[u64]) -> Vec<Cell> {
    let rank = |cell: &Cell| {
        let long = cell.length > LENGTHS[1];
        let kind = match cell.state.filling {
            _ if !long => 0,
            Filling::Lattice { .. } => usize::from(!cell.state.is_liquid()),
            Filling::Slab => 2,
            Filling::Random(_) => 3,
        };
        (kind, cell.length)
    };
    let mut cells = Vec::new();
    for &state in states {
        for &ensemble in ensembles {
            cells.extend(lengths.iter().map(|&length| Cell { state, ensemble, length }));
        }
    }
    cells.sort_by_key(rank);
    cells
}
