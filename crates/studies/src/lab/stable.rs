//! How long a step may be before the fastest motion of a scene is unstable: a rough estimate.

use lennard_core::SpeciesTable;
use lennard_engine::watchdog::fastest_pair;
use lennard_scene::Scene;

/// The step, τ, at which ω·dt of the springs of bonds is `limit`; `None` where bonds do not limit the step.
pub(crate) fn stable_dt_of_springs(scene: &Scene, limit: f64) -> Option<f64> {
    let omega = scene.molecule.as_ref()?.fastest_vibration();
    (omega > 0.0).then(|| limit / omega)
}

/// The step, τ, at which ω·dt is `limit` for the fastest of all colliding pairs, by their σ, ε and masses, and of all springs.
pub(crate) fn rough_stable_dt(
    scene: &Scene,
    species: &SpeciesTable,
    temperature: f64,
    limit: f64,
) -> f64 {
    let pair = fastest_pair(scene, species, temperature, limit);
    let of_pairs = pair.map_or(f64::INFINITY, |pair| pair.stable_dt);
    of_pairs.min(stable_dt_of_springs(scene, limit).unwrap_or(f64::INFINITY))
}

#[cfg(test)]
mod tests {
    use super::*;
    use lennard_engine::watchdog;

    fn estimate(more: &str) -> f64 {
        let text = format!(
            "[system]\nn_atoms = 32\ndensity = 0.5\ntemperature = 1.0\n[truncation]\nr_cut = 1.5\n\
             {more}[integrator]\ndt = 0.001\n[[stage]]\nname = \"production\"\nsteps = 10\n"
        );
        let scene = Scene::parse(&text, "test.toml", &[]).unwrap();
        let beginning = lennard_engine::start(&scene).unwrap();
        rough_stable_dt(&scene, &beginning.species, 1.0, 2.0)
    }

    #[test]
    fn light_particles_need_short_steps() {
        let plain = watchdog::rough_stable_dt(1.0, 2.0);
        assert_eq!(estimate(""), plain);
        let light = "[[species]]\nname = \"A\"\nfraction = 0.5\nmass = 0.01\n[[species]]\nname = \"B\"\nfraction = 0.5\n\
                     [mixing]\nrule = \"geometric\"\n";
        // Two particles of mass 0.01 are ten times as fast.
        assert!((estimate(light) / (0.1 * plain) - 1.0).abs() < 1e-12);
    }
}
