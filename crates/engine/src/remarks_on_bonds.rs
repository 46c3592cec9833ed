//! What is to be known of bonds before a run: steps that are long for their springs, and energy that they lose.

use lennard_core::number::short;
use lennard_scene::Scene;

/// ω·dt of a spring above which a step is said to be long for it.
const LONG_STEP: f64 = 0.5;

/// A remark where a step is long for the springs of bonds, though stable: the vibration is then off by (ω·dt)²/24 or more.
pub(crate) fn remark_on_springs(scene: &Scene) -> Option<String> {
    let omega = scene.molecule.as_ref()?.fastest_vibration();
    let steps = scene.stages.iter().map(|stage| scene.stage_dt(stage));
    let dt = steps.fold(0.0, f64::max);
    (omega * dt > LONG_STEP).then(|| {
        format!(
            "dt = {} τ is long for the springs of the bonds: ω·dt = {:.2}, and their vibration is off by {:.0} %; \
             at {:.2e} τ it is off by 1 %",
            short(dt),
            omega * dt,
            100.0 * (omega * dt).powi(2) / 24.0,
            LONG_STEP / omega
        )
    })
}

/// A remark where bonds lose energy: who reads a conserved energy that stays must know that the energy does not.
pub(crate) fn remark_on_damping(scene: &Scene) -> Option<String> {
    let bonds = &scene.molecule.as_ref()?.bonds;
    let counted = match bonds.spec().integrator.is_some() && scene.solves_contacts() {
        false => "the conserved energy counts it as heat",
        true => "beside contacts no heat is counted, and the conserved energy falls by it",
    };
    bonds.damps_vibrations().then(|| {
        format!(
            "[bonds] method = {:?} takes energy from vibrations: {counted}, and no bath keeps vibrations at its temperature",
            bonds.name()
        )
    })
}
