//! One evaluation of energy, virial and pressure, for checks against reference configurations.

use lennard_core::{Configuration, DVec3, Momentum, SpeciesTable, State, rigid};
use lennard_scene::Scene;
use serde::Serialize;

use crate::confinement::Confinement;
use crate::own::OwnParts;
use crate::planar_tail::PlanarTail;
use crate::start::{self, Start};
use crate::{EngineError, build, instant};

/// Where the kinetic part of the pressure comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum KineticSource {
    /// From the velocities of the start configuration.
    Velocities,
    /// From the temperature of the scene.
    SceneTemperature,
}

/// Energy, virial and pressure of one configuration: totals for the system, in reduced units.
#[derive(Debug, Clone, Serialize)]
pub struct EnergyReport {
    /// Schema of this document.
    pub schema: &'static str,
    /// The model in words.
    pub model: String,
    /// Number of particles.
    pub atoms: usize,
    /// Number of molecules; of particles where there are none.
    pub molecules: usize,
    /// Box sides, σ.
    #[serde(rename = "box")]
    pub lengths: [f64; 3],
    /// Σ U(r_ij) over pairs within the cutoff, without tail, ε.
    pub potential_energy: f64,
    /// Tail correction of the energy, ε; zero where it is off.
    pub tail_energy: f64,
    /// W = Σ r_ij·F_ij over pairs, without a factor 1/3, ε.
    pub virial: f64,
    /// Tail correction of W, ε; zero where it is off.
    pub tail_virial: f64,
    /// Pressure ρT + (W + W_tail)/(3V), ε/σ³; over molecules where there are some.
    pub pressure: f64,
    /// Temperature of the kinetic part, ε/k_B.
    pub temperature: f64,
    /// Where that temperature comes from.
    pub temperature_from: KineticSource,
    /// Pairs with r ≤ r_cut.
    pub pairs: u64,
    /// What is to be known of the start.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<String>,
}

/// The report with the state that it belongs to, forces included.
pub struct Evaluated {
    /// The numbers.
    pub report: EnergyReport,
    /// The species of the particles.
    pub species: SpeciesTable,
    /// Box, positions, velocities (zero where the start has none) and forces.
    pub state: State,
}

/// Evaluates the start configuration of a scene once.
///
/// # Errors
/// [`EngineError`] for everything that is wrong with the scene.
pub fn evaluate_energy(scene: &Scene) -> Result<Evaluated, EngineError> {
    let scene = &OwnParts::none().enter(scene.clone())?;
    let Start { cell, positions, velocities, species, mut remarks, .. } = start::start(scene)?;
    let n = positions.len();
    let (options, provider) = build::forces(scene, cell, &species)?;
    remarks.extend(provider.plan().remark.clone());
    let has_velocities = velocities.is_some();
    let mixture = scene.mixture_of(&species);
    let (system, confinement) = Confinement::with_system(scene, &cell, species);
    let planar_tail = PlanarTail::of(scene, &cell);
    let mut forces = build::with_others(scene, confinement.beside(provider), &OwnParts::none());
    let mut velocities = velocities.unwrap_or_else(|| vec![DVec3::ZERO; n]);
    // The velocities that a run starts with.
    start::make_suit(&system, &positions, &mut velocities);
    let mut state = State::new(cell, positions, velocities);
    let at = Configuration::at_rest(&cell, &state.positions);
    let energetics = instant::evaluate(scene, &mut forces, at, &mut state.forces)?;
    let (temperature, temperature_from) = if has_velocities {
        (system.temperature(&state.velocities, Momentum::Conserved), KineticSource::Velocities)
    } else {
        (scene.system.temperature, KineticSource::SceneTemperature)
    };
    let tail = lennard_forcefield::tail_in(&options, mixture.as_ref(), n, cell.volume());
    let planar =
        planar_tail.map_or((0.0, 0.0), |tail| tail.energy_and_virial(&cell, &state.positions));
    let (tail_energy, tail_virial) = tail.map_or(planar, |t| (t.energy, t.virial));
    let virial = energetics.scalar_virial().unwrap_or(f64::NAN) - planar.1;
    let volume = cell.volume();
    let inside = rigid::intramolecular_virial(&system, &state.positions, &state.forces);
    let report = EnergyReport {
        schema: lennard_io::schema!("energy", 1),
        model: scene.model_name(),
        atoms: n,
        molecules: system.n_molecules(),
        lengths: cell.lengths().to_array(),
        potential_energy: energetics.potential_energy.unwrap_or(f64::NAN) - planar.0,
        tail_energy,
        virial,
        tail_virial,
        pressure: system.n_molecules() as f64 / volume * temperature
            + (virial - inside + tail_virial) / (3.0 * volume),
        temperature,
        temperature_from,
        pairs: energetics.pairs.unwrap_or(0),
        remarks,
    };
    state.energetics = energetics;
    Ok(Evaluated { report, species: system.species().clone(), state })
}
