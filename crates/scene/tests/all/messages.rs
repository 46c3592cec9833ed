//! What the scene reader says that no file of inputs/bad shows.

use lennard_scene::Scene;

const SMALL: &str = "[system]\nn_atoms = 500\ndensity = 0.8\ntemperature = 1.0\n[[stage]]\nname = \"a\"\nsteps = 10\n";

#[test]
fn mistakes_that_need_many_lines_or_an_override_are_said_clearly() {
    let stages = |n: usize, steps: u64| -> String {
        let head = &SMALL[..SMALL.find("[[stage]]").unwrap()];
        let stage = |i| format!("[[stage]]\nname = \"s{i}\"\nsteps = {steps}\n");
        head.to_owned() + &(0..n).map(stage).collect::<String>()
    };
    let most = 1_000_000_000_000_000;
    for (text, key, value, wanted) in [
        (stages(2, most), "", "", "`stage.1.steps` makes the run too long"),
        (stages(2, most), "", "", "found:   2000000000000000 steps up to the end of this stage"),
        (stages(2, most), "", "", "allowed: at most 1000000000000000 in all stages together"),
        (stages(2000, 1), "", "", "`stage` is written too often"),
        (
            SMALL.into(),
            "system..seed",
            "1",
            "names joined by dots, as `system.n_atoms` or `stage.0.steps`",
        ),
        (SMALL.into(), "truncation", "7", "`truncation` is written the wrong way"),
        (SMALL.into(), "integrator.kind", "npt", "`integrator.kind` cannot be \"npt\""),
        (SMALL.into(), "stage.0.thermostat", "nosehoover", "is not a known name"),
        (SMALL.into(), "system.box", "[1, 2]", "`system.box`"),
    ] {
        let overrides = match key {
            "" => vec![],
            key => vec![(key.to_owned(), value.to_owned())],
        };
        let message = Scene::parse(&text, "scene.toml", &overrides).unwrap_err().to_string();
        assert!(message.contains(wanted), "wanted `{wanted}` in\n{message}");
    }
}
