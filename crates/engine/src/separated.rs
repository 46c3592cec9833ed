//! Whether the last state of a run has separated into vapor and liquid, though the scene names no surface.

use lennard_core::number::particles;
use lennard_observables::largest_density_wave;

use crate::Simulation;

/// A wave of the density with a larger amplitude is none of a homogeneous fluid.
const SEPARATED: f64 = 0.3;
/// A homogeneous fluid has waves of S(k) above this in one state of a thousand at most. Near a critical point S(k) is 3 on average.
const LARGEST_STRUCTURE_FACTOR: f64 = 20.0;
/// Fewer molecules say nothing.
const FEWEST_MOLECULES: usize = 100;

/// The amplitude up to which a fluid of so many molecules may be homogeneous.
fn homogeneous_up_to(molecules: usize) -> f64 {
    SEPARATED.max((4.0 * LARGEST_STRUCTURE_FACTOR / molecules as f64).sqrt())
}

/// That the last state has separated, in words; `None` where it may be homogeneous, or where the scene itself makes it
/// something else.
pub(crate) fn separated(simulation: &Simulation) -> Option<String> {
    let molecules = simulation.system.n_molecules();
    let scene = &simulation.scene;
    if molecules < FEWEST_MOLECULES || scene.not_homogeneous().is_some() {
        return None;
    }
    let state = &simulation.state;
    let wave = largest_density_wave(&state.cell, &state.positions);
    let allowed = homogeneous_up_to(molecules);
    (wave > allowed).then(|| {
        format!(
            "the density of the last state has a wave across the box of {:.0} % of its mean, where a homogeneous fluid of \
             {} has less than {:.0} %",
            100.0 * wave,
            particles(state.len(), molecules),
            100.0 * allowed
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_molecules_may_have_larger_waves() {
        assert_eq!(homogeneous_up_to(10_000), SEPARATED);
        assert!((homogeneous_up_to(320) - 0.5).abs() < 1e-12);
    }
}
