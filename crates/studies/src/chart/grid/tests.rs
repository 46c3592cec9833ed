//! What a grid holds and what it leaves out.

use lennard_forcefield::TruncationKind;

use super::*;
use crate::settings::tests::TEXT;
use crate::sweep::over;

/// The grid of a shipped study over a small liquid.
fn grid_of(study: &str, text: &str, extra: &[(&str, &str)]) -> (Workbench, Grid) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("liquid.toml");
    std::fs::write(&file, text).unwrap();
    let mut all = vec![("stage.equilibrate.steps", "2")];
    all.extend_from_slice(extra);
    let all: Vec<(String, String)> = all.iter().map(|(k, v)| ((*k).into(), (*v).into())).collect();
    let bench = Workbench::new(&lennard_scene::Scene::load(&file, &all).unwrap()).unwrap();
    let study = over(format!("shipped:/studies/{study}.toml").as_ref(), &file, &all).unwrap();
    let grid = grid(&bench, &study);
    (bench, grid)
}

fn says(grid: &Grid, what: &str, why: &str) -> bool {
    let has = |l: &LeftOut| l.what.contains(what) && l.why.contains(why);
    grid.left_out.iter().any(has)
}

#[test]
fn a_grid_begins_with_the_scene_and_has_no_setting_twice() {
    let mut sizes = Vec::new();
    for study in ["chart-quick", "chart", "chart-full"] {
        let (bench, grid) = grid_of(study, TEXT, &[]);
        sizes.push(grid.settings.len());
        let has_a_tail = |s: &Settings| s.truncation.tail_correction;
        let is_cut = |s: &Settings| s.truncation.kind == TruncationKind::Cut;
        assert!(grid.settings.iter().all(|s| is_cut(s) || !has_a_tail(s)));
        // The scene itself stands first, and no name stands for two.
        assert_eq!(grid.settings[0], Settings::of(bench.scene()));
        let mut labels: Vec<String> = grid.settings.iter().map(Settings::label).collect();
        labels.sort_unstable();
        labels.dedup();
        assert_eq!(labels.len(), grid.settings.len());
        assert!(says(&grid, "rc4", "half"), "{:?}", grid.left_out);
        // Steps are multiples of the step of the scene.
        assert!(grid.settings.iter().any(|s| s.dt == 2.0 * 0.004));
    }
    assert!(sizes[0] < 25 && sizes[0] < sizes[1] && sizes[1] < sizes[2] / 5, "{sizes:?}");
}

#[test]
fn a_grid_keeps_to_what_the_scene_leaves_open() {
    let of_scene = |extra: &[(&str, &str)]| grid_of("chart", TEXT, extra).1;
    let wca = of_scene(&[("potential.kind", "wca")]);
    assert!(wca.settings.iter().all(|s| s.truncation.r_cut == 2.5));
    assert!(wca.left_out.iter().any(|l| l.why.contains("ends by itself")), "{:?}", wca.left_out);
    let slab = of_scene(&[("start.vacuum", "5.0"), ("truncation.tail_correction", "false")]);
    assert!(slab.settings.iter().all(|s| !s.truncation.tail_correction));
    let langevin = of_scene(&[("stage.production.thermostat", "langevin")]);
    assert!(langevin.settings.iter().all(|s| s.integrator.name() == "velocity-verlet"));
    assert!(langevin.left_out.iter().any(|l| l.why.contains("Langevin")));
    // What is written for another method goes with it.
    let text = TEXT.replace("dt = 0.004", "dt = 0.004\nkind = \"respa\"\ninner_steps = 3");
    let (_, respa) = grid_of("chart", &text, &[]);
    let names = |name: &str| respa.settings.iter().filter(|s| s.integrator.name() == name).count();
    assert!(names("respa") > 5 && names("velocity-verlet") > 0, "{:?}", respa.left_out);
}
