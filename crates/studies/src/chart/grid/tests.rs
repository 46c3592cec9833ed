//! What a grid holds and what it leaves out.

use super::*;
use crate::settings::tests::scene;

fn bench(extra: &[(&str, &str)]) -> Workbench {
    let mut all = vec![("stage.equilibrate.steps", "2")];
    all.extend_from_slice(extra);
    Workbench::new(&scene(&all)).unwrap()
}

fn says(grid: &Grid, what: &str, why: &str) -> bool {
    let has = |l: &LeftOut| l.what.contains(what) && l.why.contains(why);
    grid.left_out.iter().any(has)
}

#[test]
fn every_setting_of_every_grid_fits_and_none_is_there_twice() {
    let bench = bench(&[]);
    let mut sizes = Vec::new();
    for size in [Size::Quick, Size::Default, Size::Full] {
        let grid = grid(&bench, size);
        sizes.push(grid.settings.len());
        for (i, s) in grid.settings.iter().enumerate() {
            bench.check(s).unwrap();
            assert!(!grid.settings[..i].contains(s), "{}", s.label());
            assert!(s.truncation.kind == TruncationKind::Cut || !s.truncation.tail_correction);
        }
        // The scene itself stands first, and no name stands for two.
        assert_eq!(grid.settings[0], Settings::of(bench.scene()));
        let mut labels: Vec<String> = grid.settings.iter().map(Settings::label).collect();
        labels.sort_unstable();
        labels.dedup();
        assert_eq!(labels.len(), grid.settings.len());
        assert!(says(&grid, "cutoffs of 4 σ", "half the shortest side"));
        assert!(says(&grid, "`analytic`", "no exact solution"));
    }
    assert!(sizes[0] < 25 && sizes[0] < sizes[1] && sizes[1] < sizes[2] / 5, "{sizes:?}");
}

fn of_scene(extra: &[(&str, &str)]) -> Grid {
    grid(&bench(extra), Size::Default)
}

#[test]
fn a_grid_keeps_to_what_the_scene_leaves_open() {
    let wca = of_scene(&[("potential.kind", "wca")]);
    assert!(says(&wca, "truncations", "ends by itself"));
    assert!(wca.settings.iter().all(|s| s.truncation.r_cut == 2.5));
    let slab = of_scene(&[("system.vacuum", "5.0"), ("truncation.tail_correction", "false")]);
    assert!(slab.settings.iter().all(|s| !s.truncation.tail_correction));
    assert!(says(&slab, "with tail", "homogeneous"));
    let langevin = of_scene(&[("stage.production.thermostat", "langevin")]);
    assert!(says(&langevin, "other methods", "Langevin"));
    assert!(langevin.settings.iter().all(|s| s.integrator.name() == "velocity-verlet"));
}
