//! What a grid holds and what it leaves out.

use lennard_scene::Scene;

use super::*;
use crate::settings::Baths;
use crate::settings::tests::scene;

const HELD: &str = "[system]\nn_atoms = 500\ndensity = 0.65\ntemperature = 1.2\n[truncation]\nkind = \"shift\"\nr_cut = 2.5\n\
    [integrator]\ndt = 0.004\n[[stage]]\nname = \"e\"\nsteps = 2\n[[stage]]\nname = \"p\"\nsteps = 1000\n\
    thermostat = { kind = \"bussi\", tau = 0.5 }\n\
    barostat = { kind = \"stochastic-cell-rescaling\", pressure = 1.0, tau = 1.0, interval = 10 }\n";

#[test]
fn intervals_paces_and_both_barostats_are_crossed_and_what_is_refused_is_left_out_with_the_reason()
{
    let bench = Workbench::new(&Scene::parse(HELD, "t.toml", &[]).unwrap()).unwrap();
    let found = grid(&bench, Axes::Baths, Size::Default).unwrap();
    let baths = |grid: &Grid| -> Vec<Baths> {
        grid.settings.iter().map(|s| s.baths.clone().unwrap()).collect()
    };
    let all = baths(&found);
    assert_eq!(all[0], own_baths(bench.scene()).unwrap());
    let mut intervals: Vec<u64> = all.iter().map(|b| b.barostat.interval()).collect();
    intervals.sort_unstable();
    intervals.dedup();
    assert_eq!(intervals, [1, 2, 10, 50]);
    let kinds = |name: &str| all.iter().filter(|b| b.barostat.name() == name).count();
    assert!(kinds("mtk") == 5 && kinds("stochastic-cell-rescaling") >= 8, "{found:?}");
    // Every 200 steps of 0.004 τ need a τ_p of 16 τ.
    let out = found.left_out.iter().filter(|l| l.what.contains("every 200")).count();
    assert_eq!(out, 3);
    assert!(found.left_out.iter().all(|l| l.why.contains("tau")), "{found:?}");
    let full = baths(&grid(&bench, Axes::Baths, Size::Full).unwrap());
    assert!(full.len() > all.len());
    assert!(all.iter().all(|baths| full.contains(baths)));
}

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
        let grid = grid(&bench, Axes::Settings, size).unwrap();
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
    grid(&bench(extra), Axes::Settings, Size::Default).unwrap()
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
