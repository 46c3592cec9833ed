//! Starts as a slab of liquid beside its vapor, and runs of them.

use lennard_core::{Persist, StateArchive};
use lennard_engine::{Simulation, StopAt, Unfollowed, begin};

use crate::common::{self, bits, on_threads, prepared};

const SLAB: &str = r#"
    [system]
    n_atoms = 700
    temperature = 0.8
    seed = 7
    [slab]
    [truncation]
    kind = "shift"
    r_cut = 2.5
    [integrator]
    dt = 0.004
    [[stage]]
    name = "production"
    steps = 120
    thermostat = "bussi"
    [[observable]]
    kind = "interface"
    every = 4
    [output]
    thermo_every = 7
"#;

fn build(overrides: &[(&str, &str)]) -> Simulation {
    prepared(common::scene(SLAB, overrides))
}

#[test]
fn a_slab_has_its_particles_its_two_densities_and_no_overlap() {
    for n in ["300", "701", "1500"] {
        let scene = common::scene(SLAB, &[("system.n_atoms", n)]);
        let slab = *scene.slab().unwrap();
        let beginning = begin(&scene).unwrap();
        let n: usize = n.parse().unwrap();
        assert_eq!(beginning.positions.len(), n);
        let sides = beginning.cell.lengths();
        // The saturation of Vrabec et al. 2006, and the default proportions.
        assert!((slab.liquid_density - 0.73021).abs() < 1e-4);
        assert!((slab.vapor_density - 0.019782).abs() < 1e-4);
        assert!((slab.thickness / sides.x - 1.5).abs() < 1e-9 && sides.x == sides.y);
        assert!((sides.z / slab.thickness - 3.0).abs() < 1e-9);
        let in_liquid = beginning
            .positions
            .iter()
            .filter(|r| (r.z - 0.5 * sides.z).abs() < 0.5 * slab.thickness)
            .count();
        let density = in_liquid as f64 / (sides.x * sides.y * slab.thickness);
        assert!((density - slab.liquid_density).abs() < 1.0 / slab.area());
        let vapor = slab.vapor_density * sides.x * sides.y * (sides.z - slab.thickness);
        assert!(((n - in_liquid) as f64 - vapor).abs() <= 0.5);
        for (i, a) in beginning.positions.iter().enumerate() {
            for b in &beginning.positions[..i] {
                let distance = beginning.cell.minimum_image(*a - *b).length();
                assert!(distance > 0.8, "{distance}");
            }
        }
    }
}

#[test]
fn a_slab_has_the_same_bits_on_any_number_of_threads_and_in_two_parts() {
    let run = |threads| {
        on_threads(threads, || {
            let mut s = build(&[]);
            s.run(&mut Unfollowed).unwrap_or_else(|e| panic!("{e}"));
            (bits(&s), findings(&s))
        })
    };
    let one = run(1);
    assert!(run(3) == one);
    let mut first = build(&[]);
    first
        .run(&mut StopAt::new(50))
        .unwrap_or_else(|e| panic!("{e}"));
    let mut archive = StateArchive::default();
    first.save(&mut archive.writer());
    let mut second = build(&[]);
    second.restore(&archive.reader()).unwrap();
    second
        .run(&mut Unfollowed)
        .unwrap_or_else(|e| panic!("{e}"));
    assert!((bits(&second), findings(&second)) == one);
}

/// What the observables found, as text: NaN then equals NaN.
fn findings(simulation: &Simulation) -> String {
    let interface = simulation.observable::<lennard_observables::Interface>();
    let found = lennard_core::Observable::finish(interface.unwrap(), 0.0);
    assert!(found.averages.iter().any(|a| a.name == "surface_tension"));
    format!("{found:?}")
}
