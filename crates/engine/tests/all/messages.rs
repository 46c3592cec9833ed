//! What goes wrong below the engine, in the words in which a user reads it.

use lennard_core::{
    Configuration, DVec3, ForceError, ForceTerm, Part, PeriodicBox, StepError, Want,
};
use lennard_engine::{evaluate_energy, prepare};
use lennard_forcefield::{
    Conditions, ForceFieldError, ForceFieldOptions, Isa, PotentialOptions, SoftSphere,
    SplitOptions, TruncationKind, TruncationOptions, Wca, build, check,
};
use lennard_scene::{Scene, Start};

use crate::common;

fn conditions() -> Conditions<'static> {
    Conditions {
        cell: PeriodicBox::new(DVec3::splat(10.0)).unwrap(),
        n_atoms: 500,
        temperature: 1.0,
        dt: 0.004,
        mixture: None,
    }
}

fn refusal(change: impl FnOnce(&mut ForceFieldOptions, &mut Conditions<'_>)) -> String {
    let (mut options, mut conditions) = (ForceFieldOptions::default(), conditions());
    change(&mut options, &mut conditions);
    check(&options, &conditions).unwrap_err().to_string()
}

#[test]
fn every_force_field_that_cannot_be_says_why() {
    let split = |r_split, width| Some(SplitOptions { r_split, width });
    let table = [
        (
            refusal(|o, _| o.truncation.r_cut = -1.0),
            "the cutoff must be a finite positive number, found -1",
        ),
        (
            refusal(|o, _| o.truncation.r_cut = 6.0),
            "the cutoff 6 is over half the shortest side of the box, 5",
        ),
        (
            refusal(|o, _| {
                o.potential = PotentialOptions::Wca(Wca {});
                o.truncation.r_cut = 1.1;
            }),
            "the WCA potential ends at 2^(1/6) σ: a cutoff of 1.1 would cut into it",
        ),
        (
            refusal(|o, _| {
                o.potential = PotentialOptions::Wca(Wca {});
                o.truncation = TruncationOptions::new(TruncationKind::Switch, 1.2);
            }),
            "the WCA potential ends smoothly by itself and takes no switch",
        ),
        (
            refusal(|o, _| o.potential = PotentialOptions::SoftSphere(SoftSphere { exponent: 3 })),
            "the potential's `exponent` = 3 is not allowed: a whole number from 4 to 72",
        ),
        (
            refusal(|o, _| o.neighbor.skin = Some(f64::NAN)),
            "the skin must be a finite number, zero or more, found NaN",
        ),
        (
            refusal(|o, _| o.split = split(2.5, 0.2)),
            "the split radius must lie between 0 and r_cut = 2.5, found 2.5",
        ),
        (
            refusal(|o, _| o.split = split(2.0, 2.1)),
            "the split width must lie between 0 and the split radius, found 2.1",
        ),
        (refusal(|_, c| c.n_atoms = 0), "there is no particle"),
        (
            refusal(|_, c| c.n_atoms = 600_000_000),
            "600000000 particles are more than a list can number",
        ),
    ];
    for (message, wanted) in table {
        assert_eq!(message, wanted);
    }
    // Which instruction set is missing depends on the processor: none is on all of them.
    for (isa, name) in [(Isa::Avx512, "avx512"), (Isa::Avx2, "avx2")] {
        let mut options = ForceFieldOptions::default();
        options.kernel.isa = isa;
        let wanted = format!("this processor does not have the instruction set `{name}`");
        assert_eq!(ForceFieldError::IsaNotAvailable(name).to_string(), wanted);
        match check(&options, &conditions()) {
            Ok(()) => assert!(lennard_forcefield::available_isas().contains(&name)),
            Err(error) => assert_eq!(error.to_string(), wanted),
        }
    }
}

#[test]
fn forces_and_steps_that_fail_say_which_particle_and_which_method() {
    let mut forces = build(&ForceFieldOptions::default(), &conditions()).unwrap();
    let mut evaluate = |positions: &[DVec3], part| {
        let cell = conditions().cell;
        let at = Configuration::at_rest(&cell, positions);
        let mut out = vec![DVec3::ZERO; positions.len()];
        forces.evaluate(at, part, Want::NOTHING, &mut out).unwrap_err().to_string()
    };
    let place = |i: usize| DVec3::new((i % 8) as f64, (i / 8 % 8) as f64, (i / 64) as f64) * 1.2;
    let mut positions: Vec<DVec3> = (0..500).map(place).collect();
    assert_eq!(
        evaluate(&positions, Part::Near),
        "these forces cannot be split into a near and a far part"
    );
    positions[7].x = f64::NAN;
    assert_eq!(evaluate(&positions, Part::All), "the position of particle 7 is not finite");
    positions[7] = positions[8];
    let message = evaluate(&positions, Part::All);
    assert!(
        ["the force on particle 7 is not finite", "the force on particle 8 is not finite"]
            .contains(&message.as_str()),
        "{message}"
    );
    assert_eq!(
        ForceError::NeedsVelocities.to_string(),
        "the force depends on velocities, and the method gives none"
    );
    assert_eq!(
        ForceError::CutoffOverHalfBox { r_cut: 2.5, largest: 2.4 }.to_string(),
        "the box has shrunk to 4.800 σ, below twice the cutoff of 2.5 σ; take more particles, a shorter cutoff or \
         a lower pressure"
    );
    assert_eq!(
        ForceError::BoxTooWide { widest: 4300.0, largest: 4295.0 }.to_string(),
        "the box has grown to 4300.000 σ, and its pair loop resolves positions up to 4295 σ a side; take \
         `kernel.precision = \"double\"` or a higher pressure"
    );
    assert_eq!(
        lennard_neighbor::GridError::BadPosition { particle: 7 }.to_string(),
        "the position of particle 7 is not a usable number"
    );
    assert_eq!(
        PeriodicBox::new(DVec3::new(1.0, -2.0, 1.0)).unwrap_err().to_string(),
        "a box side must be a finite positive number, found -2"
    );
    let method = "some-method";
    for (error, wanted) in [
        (
            StepError::VelocityDependentForce { method },
            "`some-method` assumes that forces depend on positions alone, and these depend on velocities",
        ),
        (
            StepError::ChangingStep { method, started: 0.1, asked: 0.2 },
            "`some-method` needs a fixed step: it was started with dt = 0.1 and asked for dt = 0.2",
        ),
        (StepError::BadStep(-1.0), "dt must be a finite positive number, found -1"),
        (
            StepError::NotConverged { method, iterations: 9, residual: 1e-3, wanted: 1e-12 },
            "`some-method` did not solve its equations in 9 iterations: residual 1e-3, wanted 1e-12",
        ),
        (
            StepError::Unsuited { method, reason: "why".into() },
            "`some-method` cannot run this system: why",
        ),
    ] {
        assert_eq!(error.to_string(), wanted);
    }
}

fn scene(system: &str, more: &str) -> Scene {
    let text = format!(
        "[system]\n{system}\ntemperature = 1.0\n{more}\n[[stage]]\nname = \"a\"\nsteps = 10\n"
    );
    common::scene(&text, &[])
}

fn refused(scene: Scene) -> String {
    match prepare(scene) {
        Ok(_) => panic!("the scene was taken"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn starts_that_cannot_be_say_what_would_be() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("start.xyz");
    std::fs::write(&file, "1\nLattice=\"9 0 0 0 9 0 0 0 9\"\nAr 1 2\n").unwrap();
    let start = format!("configuration = {:?}", file.display().to_string());
    let message = refused(scene(&start, ""));
    assert!(
        message.starts_with("cannot read the start configuration: ")
            && message.contains("start.xyz:3: found"),
        "{message}"
    );

    // Points at random that no descent can take apart: more than fit.
    let message = refused(scene(
        "lattice = \"random\"\nn_atoms = 60\ndensity = 60.0",
        "[truncation]\nr_cut = 0.49",
    ));
    let wanted = [
        "found:   `random`, which could not be relaxed: ",
        "allowed: a lattice, or a lower density",
    ];
    for wanted in wanted {
        assert!(message.contains(wanted), "wanted `{wanted}` in\n{message}");
    }

    // A method that the scene lets pass and the forces do not suit: a particle outside the grid of positions.
    let far = "1\nLattice=\"9 0 0 0 9 0 0 0 9\" Properties=species:S:1:pos:R:3\nAr 1e6 2 3\n";
    std::fs::write(&file, far).unwrap();
    let mut simulation = prepare(scene(&start, "[integrator]\nkind = \"bit-reversible-verlet\""))
        .unwrap_or_else(|e| panic!("{e}"));
    let message = simulation.run(&mut lennard_engine::Unfollowed).unwrap_err().to_string();
    for wanted in [
        "`bit-reversible-verlet` cannot run this system: particle 0 lies outside the position grid, ±",
        "allowed: a method that suits the forces",
    ] {
        assert!(message.contains(wanted), "wanted `{wanted}` in\n{message}");
    }
}

#[test]
fn a_start_whose_forces_are_not_finite_has_no_energy() {
    // No reader lets a place pass that is so far away that no digit of it is left within the box.
    let text = "positions = [[1.4, 2, 3], [5, 5, 5]]\nbox = 9";
    let mut scene = scene(text, "[neighbor]\nmode = \"verlet\"");
    if let Start::Listed { positions, .. } = &mut scene.system.start {
        positions[0].x = 1.4e10;
    }
    match evaluate_energy(&scene) {
        Ok(_) => panic!("the energy was evaluated"),
        Err(error) => {
            let message = error.to_string();
            assert!(message.contains("a start configuration with finite forces"), "{message}");
        }
    }
}
