//! Molecules whose bonds are held in drifts, between walls that are hit.

use lennard_core::random::Streams;
use lennard_core::{
    BondSolver, Bonds, DVec3, ForceSum, ForceTerm, Molecules, NoForces, PeriodicBox, State,
    StepError, StepReport, System, Want, rigid,
};
use lennard_forcefield::{
    ContactLaw, Hard, SlitPlanes, Soft, SpringLaw, WallContext, WallOptions, WallPair, Walls,
};
use lennard_integrators::{
    Bodies, BondHolder, BondOptions, Contacts, IntegratorOptions, Obstacles, Response, build,
};

use super::common::{cube, random_vectors};

const SIDE: f64 = 12.0;

fn solver(molecules: &Molecules) -> Box<dyn BondSolver> {
    match BondOptions::default().build(molecules) {
        BondHolder::Drift(solver) => solver,
        _ => panic!("the direct solution acts in drifts"),
    }
}

/// Walls across all axes, 1 σ from the ends of the box.
fn walls(options: &WallOptions) -> Walls {
    let context = WallContext { temperature: 1.3 };
    let pair = |axis| {
        let planes = SlitPlanes::new(&cube(SIDE), axis, 2.0, 0.0);
        WallPair::new(options, planes, &context)
    };
    Walls::new((0..3).map(pair).collect(), Streams::new(5).noise("walls"))
}

fn hard(restitution: f64) -> WallOptions {
    WallOptions::Hard(Hard { restitution: Some(restitution), ..Hard::default() })
}

struct Gas {
    system: System,
    state: State,
    forces: ForceSum<NoForces>,
    method: lennard_core::Integrator,
    h: f64,
    heat: f64,
    /// What the last step told.
    report: StepReport,
}

impl Gas {
    /// Chains that do not see each other, in a closed box.
    fn new(options: &WallOptions, n: usize, sites: usize, h: f64) -> Self {
        Self::touching(options, (n, sites), h, |_| None)
    }

    /// Chains whose sites are bodies with contacts.
    fn touching(
        options: &WallOptions,
        (n, sites): (usize, usize),
        h: f64,
        contacts: impl Fn(&Molecules) -> Option<Contacts>,
    ) -> Self {
        let molecules = Molecules::chains(sites, 0.8, Bonds::Rigid);
        let centers = random_vectors(n, "centers");
        let x: Vec<DVec3> = (0..n * sites)
            .map(|i| {
                let along = (i % sites) as f64 - 0.5 * (sites - 1) as f64;
                let turned = DVec3::from_array(
                    [[0.8, 0.0, 0.0], [0.0, 0.8, 0.0], [0.0, 0.0, 0.8]][i / sites % 3],
                );
                DVec3::splat(0.5 * SIDE) + 2.5 * centers[i / sites] + along * turned
            })
            .collect();
        let system = System::of_molecules(n * sites, molecules.clone());
        let mut v = random_vectors(n * sites, "velocities");
        v.iter_mut().for_each(|v| *v *= 2.0);
        rigid::project_velocities(&system, &x, &mut v);
        let walls = Obstacles::new(walls(options), contacts(&molecules));
        let walls = walls.holding(&system, solver(&molecules));
        let mut gas = Self {
            system: system.pushed_along([true; 3]),
            state: State::new(cube(SIDE), x, v),
            forces: ForceSum::new(NoForces).with(walls),
            method: build(&IntegratorOptions::default()).with_bonds(solver(&molecules)),
            h,
            heat: 0.0,
            report: StepReport::default(),
        };
        let Self { system, state, forces, method, .. } = &mut gas;
        method.start(system, state, forces, h, Want::ENERGY).unwrap();
        gas
    }

    fn step(&mut self) {
        self.tried().unwrap();
    }

    fn tried(&mut self) -> Result<(), StepError> {
        let Self { system, state, forces, method, h, heat, report } = self;
        *report = method.step(system, state, forces, *h, Want::ENERGY)?;
        *heat += report.heat;
        Ok(())
    }

    fn energy(&self) -> f64 {
        self.system.kinetic_energy(&self.state.velocities)
    }

    fn residual(&self) -> f64 {
        rigid::constraint_sums(&self.system, &self.state).largest_residual
    }

    fn outside(&self) -> f64 {
        let beyond = |x: f64| (1.0 - x).max(x - (SIDE - 1.0));
        let all = self.state.positions.iter();
        all.map(|x| beyond(x.x).max(beyond(x.y)).max(beyond(x.z))).fold(f64::NEG_INFINITY, f64::max)
    }

    fn impulse(&self) -> f64 {
        self.forces.walls().iter().map(|wall| wall.impulse).sum()
    }
}

#[test]
fn rigid_dumbbells_keep_energy_and_bonds_over_300_hits() {
    let mut gas = Gas::new(&hard(1.0), 60, 2, 0.005);
    let before = gas.energy();
    let mut worst = 0.0_f64;
    for _ in 0..4000 {
        gas.step();
        worst = worst.max((gas.energy() / before - 1.0).abs());
        assert!(gas.outside() < 1e-12, "{}", gas.outside());
    }
    assert!(worst < 1e-12, "{worst:e}");
    assert!(gas.residual() < 1e-13, "{}", gas.residual());
    assert!(gas.heat.abs() < 1e-11, "{}", gas.heat);
    assert!(gas.report.iterations > 0 && gas.report.residual < 1e-13);
    let hits: u64 = gas.forces.walls().iter().map(|wall| wall.hits).sum();
    assert!(hits > 300, "{hits}");
    // 20 τ at a speed of about 1.2: each centre hits a wall more than twice.
    assert!(gas.impulse() > 60.0 * 2.0, "{}", gas.impulse());
}

/// Contacts of soft bodies, held bonds and hits at planes in one flight: the energy of each step is off by h².
#[test]
fn soft_bodies_on_held_bonds_keep_their_energy_between_hard_walls() {
    let worst = |h: f64| {
        let mut gas = Gas::touching(&hard(1.0), (16, 2), h, |molecules| {
            let law = ContactLaw::new(SpringLaw::Linear, 2000.0, 1.0);
            let bodies = Bodies::alike(0.5, molecules.exclusions());
            Some(Contacts::new(Response::Spring(law), bodies))
        });
        let energy =
            |gas: &Gas| gas.energy() + gas.state.energetics.potential_energy.unwrap() - gas.heat;
        let (before, mut worst, mut touched) = (energy(&gas), 0.0_f64, 0);
        for _ in 0..(8.0 / h) as u32 {
            gas.step();
            worst = worst.max((energy(&gas) / before - 1.0).abs());
            touched += u32::from(gas.state.energetics.potential_energy.unwrap() > 1e-3);
        }
        let hits: u64 = gas.forces.walls().iter().map(|wall| wall.hits).sum();
        assert!(hits > 20 && touched > 100, "{hits} {touched}");
        assert!(gas.residual() < 1e-13 && gas.outside() < 1e-12);
        worst
    };
    let (coarse, fine) = (worst(0.002), worst(0.0005));
    assert!(coarse < 2e-2 && fine < coarse / 4.0, "{coarse:e} {fine:e}");
}

#[test]
fn a_bond_that_turns_too_far_between_walls_is_named_with_its_molecule() {
    let mut gas = Gas::new(&hard(1.0), 3, 2, 0.005);
    let turn = DVec3::new(0.0, 0.0, 400.0);
    gas.state.velocities[2] += turn;
    gas.state.velocities[3] -= turn;
    let error = gas.tried().unwrap_err();
    let StepError::BondTurned { molecule, bond, .. } = error else {
        panic!("{error}");
    };
    assert_eq!((molecule, bond), (2, 1));
}

#[test]
fn forth_and_back_molecules_come_home_through_their_hits() {
    for sites in [2, 5] {
        let mut gas = Gas::new(&hard(1.0), 6, sites, 0.005);
        let start = gas.state.positions.clone();
        for _ in 0..2 {
            (0..2000).for_each(|_| gas.step());
            gas.state.velocities.iter_mut().for_each(|v| *v = -*v);
        }
        let off = |(a, b): (&DVec3, &DVec3)| (*a - *b).length();
        let farthest = gas.state.positions.iter().zip(&start).map(off);
        let farthest = farthest.fold(0.0, f64::max);
        assert!(farthest < 1e-7, "{sites}: {farthest:e}");
        assert!(gas.impulse() > 5.0, "{}", gas.impulse());
    }
}

#[test]
fn momentum_goes_to_the_walls_and_hits_that_take_energy_count_it_as_heat() {
    let mut gas = Gas::new(&hard(0.7), 40, 3, 0.005);
    let (before, start) = (gas.energy(), gas.system.momentum(&gas.state.velocities));
    (0..4000).for_each(|_| gas.step());
    let lost = gas.energy() - before;
    // A free chain keeps its energy to the cube of the step.
    assert!((lost - gas.heat).abs() < 1e-4 * before, "{lost} {}", gas.heat);
    assert!(lost < -0.2 * before);
    let gained = gas.system.momentum(&gas.state.velocities) - start;
    for axis in 0..3 {
        let of = |wall: &lennard_core::WallReading| wall.outward() * wall.impulse;
        let walls = gas.forces.walls().iter().filter(|w| w.axis == axis);
        let taken: f64 = walls.map(of).sum();
        assert!((taken + gained[axis]).abs() < 1e-10, "{taken} {gained}");
    }
}

#[test]
fn thermal_walls_bring_molecules_to_their_temperature_in_every_degree_of_freedom() {
    let options =
        WallOptions::all().into_iter().find(|wall| wall.spec().name == "thermal").unwrap();
    let mut gas = Gas::new(&options, 400, 2, 0.02);
    (0..3000).for_each(|_| gas.step());
    let (mut centers, mut inside, mut samples) = (0.0, 0.0, 0.0);
    for _ in 0..150 {
        (0..40).for_each(|_| gas.step());
        for v in gas.state.velocities.chunks(2) {
            centers += 0.25 * (v[0] + v[1]).length_squared();
            inside += 0.25 * (v[1] - v[0]).length_squared();
            samples += 1.0;
        }
    }
    // K = M·V²/2 has three degrees of freedom for the centre, and two for the rotation.
    let (centers, inside) = (2.0 * centers / samples / 3.0, 2.0 * inside / samples / 2.0);
    // Some 400·60 independent velocities: an error of about 1 %.
    assert!((centers / 1.3 - 1.0).abs() < 0.03, "{centers}");
    assert!((inside / 1.3 - 1.0).abs() < 0.03, "{inside}");
}

#[test]
fn a_dumbbell_that_falls_flat_on_a_floor_bounces_and_rests_with_both_sites() {
    let cell: PeriodicBox = cube(SIDE);
    let molecules = Molecules::chains(2, 1.0, Bonds::Rigid);
    for e in [1.0, 0.5] {
        let system = System::of_molecules(2, molecules.clone());
        let x = vec![DVec3::new(5.0, 6.0, 2.0), DVec3::new(6.0, 6.0, 2.0)];
        let walls = Obstacles::new(walls(&hard(e)), None).holding(&system, solver(&molecules));
        let field = lennard_forcefield::ConstantField::new(DVec3::NEG_Z, system.masses.clone());
        let mut forces = ForceSum::new(NoForces).with(walls).with(field);
        let system = system.pushed_along([true; 3]);
        let mut state = State::new(cell, x, vec![DVec3::ZERO; 2]);
        let mut method = build(&IntegratorOptions::default()).with_bonds(solver(&molecules));
        let h = 0.01;
        method.start(&system, &mut state, &mut forces, h, Want::ENERGY).unwrap();
        let (mut heat, mut halfway) = (0.0, (0.0, 0.0));
        for step in 0..3000 {
            if step == 2000 {
                halfway = (heat, forces.walls().iter().map(|w| w.impulse).sum::<f64>());
            }
            let report = method.step(&system, &mut state, &mut forces, h, Want::ENERGY);
            heat += report.unwrap().heat;
        }
        let energy: f64 = (0..2)
            .map(|i| 0.5 * state.velocities[i].length_squared() + state.positions[i].z - 1.0)
            .sum();
        if e == 1.0 {
            assert!((energy - 2.0).abs() < 2.0 * 2.0_f64.sqrt() * h, "{energy}");
            continue;
        }
        assert!(energy.abs() < 1e-3, "{energy}");
        assert_eq!(heat, halfway.0);
        let weight = forces.walls().iter().map(|w| w.impulse).sum::<f64>() - halfway.1;
        assert!((weight / (10.0 * 2.0) - 1.0).abs() < 1e-9, "{weight}");
    }
}

/// Mean over phases of the step of −v_out/v_in of a dumbbell that flies at a soft wall, at an angle to its plane.
fn rebound(law: SpringLaw, e: f64, along: DVec3) -> f64 {
    let (h, phases) = (0.005, 40);
    let options = WallOptions::Soft(Soft { law, stiffness: 400.0, restitution: e });
    let molecules = Molecules::chains(2, 1.0, Bonds::Rigid);
    let mut sum = 0.0;
    for k in 0..phases {
        let system = System::of_molecules(2, molecules.clone());
        let phase = (f64::from(k) + 0.5) / f64::from(phases);
        let lower = DVec3::new(5.0, 6.0, 1.0 + (2.0 + phase) * h);
        let state_v = vec![DVec3::NEG_Z; 2];
        let walls = Obstacles::new(walls(&options), None).holding(&system, solver(&molecules));
        let mut forces = ForceSum::new(NoForces).with(walls);
        let system = system.pushed_along([true; 3]);
        let mut state = State::new(cube(SIDE), vec![lower, lower + along], state_v);
        let mut method = build(&IntegratorOptions::default()).with_bonds(solver(&molecules));
        let want = Want::ENERGY;
        method.start(&system, &mut state, &mut forces, h, want).unwrap();
        let (start, mut heat) = (system.kinetic_energy(&state.velocities), 0.0);
        while state.positions[0].z <= 1.0 || state.velocities[0].z <= 0.0 {
            let report = method.step(&system, &mut state, &mut forces, h, want);
            heat += report.unwrap().heat;
            assert!(state.step < 10_000);
        }
        let lost = system.kinetic_energy(&state.velocities) - start;
        // The spring alone keeps its energy to the square of the step.
        assert!((lost - heat).abs() < 0.02, "{lost} {heat}");
        sum += 0.5 * (state.velocities[0] + state.velocities[1]).z;
    }
    sum / f64::from(phases)
}

#[test]
fn dashpots_of_soft_walls_keep_the_restitution_of_molecules_on_their_end_and_flat() {
    for law in [SpringLaw::Linear, SpringLaw::Hertz] {
        for e in [0.3, 0.5, 0.9] {
            for along in [DVec3::Z, DVec3::X] {
                let mean = rebound(law, e, along);
                assert!((mean - e).abs() < 0.005, "{law:?} {e} {along}: {mean}");
            }
        }
    }
}

#[test]
fn dashpots_take_what_they_count_from_a_gas_of_molecules() {
    let soft = WallOptions::Soft(Soft { restitution: 0.5, ..Soft::default() });
    for sites in [2, 3] {
        let mut gas = Gas::new(&soft, 30, sites, 0.002);
        let before = gas.energy();
        (0..4000).for_each(|_| gas.step());
        assert!(gas.heat < -0.3 * before, "{} of {before}", gas.heat);
        let potential = {
            let Gas { system, state, forces, method, h, .. } = &mut gas;
            let told = method.step(system, state, forces, *h, Want::ENERGY);
            gas.heat += told.unwrap().heat;
            gas.state.energetics.potential_energy.unwrap()
        };
        let left = gas.energy() + potential - gas.heat;
        assert!((left / before - 1.0).abs() < 2e-3, "{sites}: {left} {before}");
        assert!(gas.residual() < 1e-9, "{}", gas.residual());
    }
}
