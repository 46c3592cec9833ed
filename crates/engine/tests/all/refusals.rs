//! What goes wrong below the engine, and starts that cannot be.

use lennard_core::{Configuration, DVec3, ForceError, ForceTerm, Part, PeriodicBox, Want};
use lennard_engine::{evaluate_energy, prepare};
use lennard_forcefield::{
    Conditions, ForceFieldError as Refused, ForceFieldOptions, Isa, PotentialOptions, SplitOptions,
    TruncationKind, TruncationOptions, Wca, build, check,
};
use lennard_scene::{Arrangement, Scene};

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

fn refusal(change: impl FnOnce(&mut ForceFieldOptions, &mut Conditions<'_>)) -> Refused {
    let (mut options, mut conditions) = (ForceFieldOptions::default(), conditions());
    change(&mut options, &mut conditions);
    check(&options, &conditions).unwrap_err()
}

#[test]
fn force_fields_that_cannot_be_are_refused() {
    let wca = PotentialOptions::Wca(Wca {});
    let wide = Some(SplitOptions { r_split: 2.0, width: 2.1 });
    let short = refusal(|o, _| {
        o.potential = wca;
        o.truncation.r_cut = 1.1;
    });
    assert!(matches!(short, Refused::CutoffInsideEnd { .. }));
    let switched = refusal(|o, _| {
        o.potential = wca;
        o.truncation = TruncationOptions::new(TruncationKind::Switch, 1.2);
    });
    assert!(matches!(switched, Refused::SwitchAtOwnEnd { .. }));
    assert!(matches!(refusal(|o, _| o.split = wide), Refused::BadSplitWidth(_)));
    assert!(matches!(refusal(|_, c| c.n_atoms = 0), Refused::NoParticles));
    assert!(matches!(refusal(|_, c| c.n_atoms = 600_000_000), Refused::TooManyParticles(_)));
    for (isa, name) in [(Isa::Avx512, "avx512"), (Isa::Avx2, "avx2")] {
        let mut options = ForceFieldOptions::default();
        options.kernel.isa = isa;
        match check(&options, &conditions()) {
            Ok(()) => assert!(lennard_forcefield::available_isas().contains(&name)),
            Err(error) => assert!(matches!(error, Refused::IsaNotAvailable(n) if n == name)),
        }
    }
}

#[test]
fn forces_that_fail_say_which_particle() {
    let mut forces = build(&ForceFieldOptions::default(), &conditions()).unwrap();
    let mut evaluate = |positions: &[DVec3], part| {
        let cell = conditions().cell;
        let at = Configuration::at_rest(&cell, positions);
        let mut out = vec![DVec3::ZERO; positions.len()];
        forces.evaluate(at, part, Want::NOTHING, &mut out).unwrap_err()
    };
    let place = |i: usize| DVec3::new((i % 8) as f64, (i / 8 % 8) as f64, (i / 64) as f64) * 1.2;
    let mut positions: Vec<DVec3> = (0..500).map(place).collect();
    assert!(matches!(evaluate(&positions, Part::Near), ForceError::NotSplit));
    positions[7].x = f64::NAN;
    let error = evaluate(&positions, Part::All);
    assert!(matches!(error, ForceError::NonFinitePosition { particle: 7 }), "{error}");
    positions[7] = positions[8];
    let error = evaluate(&positions, Part::All);
    assert!(matches!(error, ForceError::NonFiniteForce { particle: 7 | 8 }), "{error}");
}

fn scene(system: &str, more: &str) -> Scene {
    let text = format!(
        "[system]\n{system}\ntemperature = 1.0\n{more}\n[[stage]]\nname = \"a\"\nsteps = 10\n"
    );
    common::scene(&text, "")
}

#[test]
fn points_that_no_descent_can_take_apart_are_refused() {
    let crowd = scene(
        "n_atoms = 60\ndensity = 60.0",
        "[start]\nkind = \"random\"\n[truncation]\nr_cut = 0.49",
    );
    let error = prepare(crowd).err().expect("refused").to_string();
    assert!(error.contains("could not be relaxed"), "{error}");
}

#[test]
fn a_start_whose_forces_are_not_finite_has_no_energy() {
    // No reader lets a place pass that is so far away that no digit of it is left within the box.
    let more = "[start]\nkind = \"positions\"\npositions = [[1.4, 2, 3], [5, 5, 5]]\n\
                [neighbor]\nmode = \"verlet\"";
    let mut scene = scene("box = 9", more);
    if let Arrangement::Listed { positions, .. } = &mut scene.system.start {
        positions[0].x = 1.4e10;
    }
    assert!(evaluate_energy(&scene).is_err());
}
