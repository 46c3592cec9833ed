//! Settings that do not go together.

use lennard_forcefield::SplitOptions;
use lennard_scene::Scene;
use lennard_studies::settings::Settings;

#[test]
fn settings_that_do_not_go_together_are_refused() {
    let text = "[system]\nn_atoms = 256\ndensity = 0.8\ntemperature = 1.0\n\n[[stage]]\nname = \"run\"\nsteps = 10\n";
    let scene = Scene::parse(text, "plain.toml", &[]).unwrap();
    let usual = Settings::of(&scene);
    assert!(usual.apply(&scene).is_ok());
    let still = Settings { dt: 0.0, ..usual.clone() };
    assert!(still.apply(&scene).is_err());
    // A split of the force belongs to `respa` alone.
    let split = Settings { split: Some(SplitOptions { r_split: 1.5, width: 0.3 }), ..usual };
    assert!(split.apply(&scene).is_err());
}
