//! What the equation of state foresees of a stage with a barostat, before its first step.

use lennard_core::PeriodicBox;
use lennard_core::number::short;
use lennard_integrators::Coupling;
use lennard_literature::{EquationOfState, Phase};
use lennard_scene::{PressureControl, Scene, Stage, model_kind};

use crate::EngineError;

/// Densities (σ⁻³) below this are called a gas where no equation of state tells.
const GAS_BELOW: f64 = 0.3;
/// The compressibility (σ³/ε) of a liquid that no equation of state describes.
const OF_A_LIQUID: f64 = 0.1;
/// Standard deviations of the volume by which the box must stay above its smallest size.
const DEVIATIONS: f64 = 4.0;

/// The equilibrium state at the pressure and the temperature of a stage.
struct Foreseen {
    equation: &'static dyn EquationOfState,
    density: f64,
    /// κ = 1/(ρ·∂p/∂ρ), σ³/ε.
    compressibility: f64,
    phase: Phase,
}

impl Foreseen {
    /// κ of the saturated liquid in σ³/ε, where a fluid that begins liquid ends as a gas.
    fn boiling_liquid(&self, stage: &Stage, start_density: f64) -> Option<f64> {
        let critical = self.equation.spec().critical.density;
        if start_density <= critical || self.density > critical {
            return None;
        }
        let saturation = self.equation.saturation(stage.temperature)?;
        Some(compressibility_at(self.equation, saturation.liquid_density, stage.temperature))
    }
}

/// κ = 1/(ρ·∂p/∂ρ) of an equation, σ³/ε.
fn compressibility_at(equation: &dyn EquationOfState, density: f64, temperature: f64) -> f64 {
    1.0 / (density * equation.at(density, temperature).dp_drho)
}

fn foreseen(scene: &Scene, stage: &Stage) -> Option<Foreseen> {
    let control = stage.barostat.as_ref()?;
    let equation = lennard_literature::equation_of_state_for(model_kind(scene)).ok()?;
    let density = equation.density(control.pressure, stage.temperature)?;
    Some(Foreseen {
        equation,
        density,
        compressibility: compressibility_at(equation, density, stage.temperature),
        phase: equation.phase(density, stage.temperature),
    })
}

/// The compressibility that sets the pace of a barostat, σ³/ε.
///
/// The scene's own comes first, then the equation of state at (T₀, P₀). Else a gas has 1/P₀, and a liquid 0.1 or 1/P₀ if that is less.
/// A liquid that will boil has the compressibility of the saturated liquid: it would accept none of the long moves of a gas.
pub(crate) fn compressibility(scene: &Scene, stage: &Stage, start_density: f64) -> f64 {
    let control = stage.barostat.as_ref();
    let given = control.and_then(|c| c.options.compressibility());
    let of_equation = || {
        let foreseen = foreseen(scene, stage)?;
        match foreseen.boiling_liquid(stage, start_density) {
            Some(liquid) => Some(liquid.min(foreseen.compressibility)),
            None => Some(foreseen.compressibility),
        }
    };
    let pressure = control.map_or(0.0, |c| c.pressure);
    let guessed = || {
        if start_density >= GAS_BELOW {
            // At high pressures κ is a part of 1/P₀ in any fluid.
            OF_A_LIQUID.min(1.0 / pressure)
        } else if pressure > 0.0 {
            1.0 / pressure
        } else {
            1.0 / (start_density * stage.temperature)
        }
    };
    given.or_else(of_equation).unwrap_or_else(guessed)
}

/// Refuses barostats that cannot work in this scene, and returns what is to be known of the others.
///
/// # Errors
/// [`EngineError::Scene`] for a box that would be too small for its cutoff, and for a fluid whose sides change apart.
pub(crate) fn foresee(
    scene: &Scene,
    cell: &PeriodicBox,
    n_atoms: usize,
    skin: f64,
) -> Result<Vec<String>, EngineError> {
    let n_atoms = n_atoms / scene.molecules().sites();
    let mut remarks = Vec::new();
    for (index, stage) in scene.stages.iter().enumerate() {
        let (Some(control), Some(foreseen)) = (&stage.barostat, foreseen(scene, stage)) else {
            continue;
        };
        keeps_its_shape(scene, index, control, &foreseen)?;
        let of_box = box_fits(scene, index, cell, n_atoms, skin, &foreseen)?;
        remarks.extend(of_box);
        remarks.extend(changes_phase(stage, control, cell, n_atoms, &foreseen));
    }
    Ok(remarks)
}

/// A fluid has no shape modulus: sides that change apart wander until one is too short.
fn keeps_its_shape(
    scene: &Scene,
    index: usize,
    control: &PressureControl,
    foreseen: &Foreseen,
) -> Result<(), EngineError> {
    // A crystal beside the fluid holds the shape of the cross-section.
    let has_surfaces = scene.surfaces().is_some() || scene.half_crystal().is_some();
    if control.options.coupling() != Coupling::XyZ || has_surfaces || !foreseen.phase.is_stable() {
        return Ok(());
    }
    Err(scene
        .invalid(
            &format!("stage.{index}.barostat.coupling"),
            format!(
                "\"xy-z\" for a {}, which has no stiffness of shape: its sides wander freely",
                foreseen.phase.describe()
            ),
            "\"isotropic\" for a fluid, \"z\" for a slab across z",
        )
        .into())
}

/// The box that the equation of state predicts, against the smallest that the cutoff allows.
fn box_fits(
    scene: &Scene,
    index: usize,
    cell: &PeriodicBox,
    n_atoms: usize,
    skin: f64,
    foreseen: &Foreseen,
) -> Result<Option<String>, EngineError> {
    let stage = &scene.stages[index];
    let volume = n_atoms as f64 / foreseen.density;
    let ratio = volume / cell.volume();
    let coupling = stage.barostat.as_ref().map(|b| b.options.coupling());
    let shortest = match coupling {
        Some(Coupling::Z) => cell.shortest().min(cell.lengths().z * ratio),
        _ => cell.shortest() * ratio.cbrt(),
    };
    let r_cut = scene.longest_cutoff();
    let deviation = (volume * stage.temperature * foreseen.compressibility).sqrt();
    let room = 1.0 + DEVIATIONS * deviation / (3.0 * volume);
    let name = &foreseen.equation.spec().name;
    if shortest < 2.0 * r_cut {
        return Err(scene.invalid(
                &format!("stage.{index}.barostat.pressure"),
                format!(
                    "a box of {shortest:.3} σ at ρ = {:.4} by {name}, below twice the cutoff of {r_cut} σ",
                    foreseen.density
                ),
                "more particles, a shorter cutoff or another pressure",
            )
            .into());
    }
    let wanted = 2.0 * (r_cut + skin) * room;
    Ok((shortest < wanted).then(|| {
        format!(
            "stage `{}`: the box shrinks to about {shortest:.2} σ by {name}, and its fluctuations want {wanted:.2} σ for the cutoff of {r_cut} σ with its list",
            stage.name
        )
    }))
}

/// Boiling or condensation that the equation of state foresees.
fn changes_phase(
    stage: &Stage,
    control: &PressureControl,
    cell: &PeriodicBox,
    n_atoms: usize,
    foreseen: &Foreseen,
) -> Option<String> {
    let saturation = foreseen.equation.saturation(stage.temperature)?;
    let critical = foreseen.equation.spec().critical.density;
    let starts_liquid = n_atoms as f64 / cell.volume() > critical;
    let ends_liquid = foreseen.density > critical;
    let what = match (starts_liquid, ends_liquid) {
        (true, false) => "below it a liquid boils in the end, and the box grows without warning",
        (false, true) => "above it a gas condenses in the end, and the box shrinks without warning",
        _ => return None,
    };
    Some(format!(
        "stage `{}`: the vapor pressure at T = {} is {:.5} ε/σ³ by {}, and P = {}: {what}",
        stage.name,
        short(stage.temperature),
        saturation.pressure,
        foreseen.equation.spec().name,
        short(control.pressure)
    ))
}
