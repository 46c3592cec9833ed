use lennard_scene::Scene;

use super::*;

fn scene(more: &str) -> Scene {
    let text = format!(
        "[system]\nn_atoms = 108\ndensity = 0.8\ntemperature = 1.0\n[truncation]\nr_cut = 2.2\n\
         [output]\nthermo_every = 10\n{more}"
    );
    Scene::parse(&text, "scene.toml", &[]).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn memory_is_counted_as_a_run_takes_it() {
    let measured = |more: &str| {
        // Each thread has a copy of few particles once it runs a chunk: one thread always has its own.
        let alone = lennard_core::parallel::pool(1).unwrap();
        let mut simulation = crate::prepare(scene(more)).unwrap();
        let bare = with_everything_off(&simulation).unwrap();
        // Builds of the list make its room grow. No clock decides here how many there are: patience is over after one step,
        // and all steps after it are counted.
        let one_step = FirstSteps::from(Instant::now() - PATIENCE);
        let costs = alone.install(|| Costs::after(one_step, bare, &mut simulation)).unwrap();
        assert_eq!(costs.steps, 0);
        costs
    };
    let stage = "[[stage]]\nname = \"a\"\nsteps = 300\n";
    let observed = format!("{stage}[[observable]]\nkind = \"momentum\"\nevery = 1\n");
    let bath = format!("{stage}thermostat = \"bussi\"\n");
    let [in_strides, step_by_step, under_a_bath] = [stage, &observed, &bath].map(measured);
    let n = 108;
    // Velocities and positions of the next step, by place. Positions lie in the room of forces, but not under a bath.
    let more = in_strides.force_bytes as f64 - step_by_step.force_bytes as f64;
    assert!(more >= (2 * 24 * n) as f64, "{more}");
    let more = under_a_bath.force_bytes as f64 - in_strides.force_bytes as f64;
    assert!(more >= (24 * n) as f64, "{more}");
    // Two steps under a bath are taken one by one.
    let short = format!("[[stage]]\nname = \"b\"\nsteps = 2\nthermostat = \"bussi\"\n{stage}");
    let after_a_short_bath = measured(&short);
    assert!(after_a_short_bath.force_bytes < in_strides.force_bytes + 12 * n);
    for costs in [in_strides, step_by_step, under_a_bath] {
        assert!(costs.force_bytes >= 24 * n);
        // Positions, velocities, forces, and positions at the last build.
        assert!(costs.checkpoint_bytes >= 4 * 24 * n as usize);
    }
}

#[test]
fn parts_are_paid_as_often_as_the_scene_says() {
    let scene = scene(
        "trajectory_every = 15\n[[stage]]\nname = \"a\"\nsteps = 300\nthermostat = \"bussi\"\n\
         [[stage]]\nname = \"b\"\nsteps = 600\n[[observable]]\nkind = \"rdf\"\nevery = 20\n",
    );
    let mut simulation = crate::prepare(scene).unwrap();
    let parts = Costs::measure(&mut simulation).unwrap().parts.unwrap();
    let calls = |name: &str| {
        let found: Vec<&Part> = parts.iter().filter(|part| part.name == name).collect();
        assert!(found.len() == 1 && found[0].of_run() >= 0.0, "{name}: {found:?}");
        found[0].calls
    };
    assert_eq!(calls("pair forces"), 900.0);
    assert_eq!(calls("neighbor list"), 900.0);
    assert_eq!(calls("integrator"), 900.0);
    assert_eq!(calls("watchdog"), 900.0);
    assert_eq!(calls("energy and virial"), 90.0);
    assert_eq!(calls("thermostat bussi of a"), 300.0);
    // The second stage alone is measured.
    assert_eq!(calls("thermodynamics"), 60.0);
    assert_eq!(calls("configurational temperature"), 60.0);
    assert_eq!(calls("rdf"), 30.0);
    assert_eq!(calls("trajectory"), 40.0);
    assert_eq!(parts.len(), 10);
    // Frames on steps 15, 30, 45, …: every second one falls on a row.
    assert_eq!(alone(15, 10), 0.5);
    // A measurement below nothing is nothing.
    assert_eq!(Part::new("frame", 3.0, -1.0).of_run(), 0.0);
}

#[test]
fn a_slow_first_step_is_followed_by_three_or_nothing_is_told_of_the_time() {
    let mut bare = with_everything_off(
        &crate::prepare(scene("[[stage]]\nname = \"a\"\nsteps = 2\n")).unwrap(),
    )
    .unwrap();
    let began = |before: Duration| FirstSteps::from(Instant::now() - before);
    // The first step has taken longer than all steps are measured for.
    let mut slow = began(Duration::from_secs(1));
    bare.follow(&mut slow).unwrap();
    assert!(slow.seconds.len() >= 3 && slow.mean().is_some());
    // The list is built again, or is as good as never built.
    let builds = bare.forces.statistics().builds;
    assert!(builds > slow.first.unwrap().builds || slow.seconds.len() >= 50);
    let mut too_slow = began(PATIENCE);
    bare.follow(&mut too_slow).unwrap();
    assert_eq!((too_slow.seconds.len(), too_slow.mean()), (0, None));
}
