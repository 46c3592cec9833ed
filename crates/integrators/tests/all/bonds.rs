//! Rigid bonds and springs, against answers that are known.

use lennard_core::{Backend, Momentum};
use lennard_core::{
    Bonds, Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceSum, ForceTerm,
    Integrator, Masses, Molecules, NoForces, Part, PeriodicBox, State, System, Want, rigid,
};
use lennard_integrators::bonds::{direct, relaxation, spring};
use lennard_integrators::{BondHolder, BondOptions, IntegratorOptions, build};

fn direct() -> BondOptions {
    BondOptions::Direct(direct::Options { tolerance: 1e-14, ..Default::default() })
}

fn shake(tolerance: f64) -> BondOptions {
    BondOptions::Relaxation(relaxation::Options {
        tolerance: Some(tolerance),
        ..Default::default()
    })
}

fn spook(options: lennard_integrators::bonds::spook::Options) -> BondOptions {
    BondOptions::Spook(options)
}

fn projection() -> BondOptions {
    BondOptions::Relaxation(relaxation::Options {
        tolerance: Some(1e-13),
        direction: relaxation::Direction::New,
        ..Default::default()
    })
}

fn velocity_verlet(bonds: &BondOptions, molecules: &Molecules) -> Integrator {
    let method = build(&IntegratorOptions::default());
    match bonds.build(molecules) {
        BondHolder::Drift(solver) => method.with_bonds(solver),
        BondHolder::Spook(bonds, _) => lennard_integrators::spook::with_bonds(bonds),
        BondHolder::Spring(_) => method,
        BondHolder::InDrift(solver, _) => method.with_bonds(solver),
    }
}

/// A system and a state of rigid chains in a box so wide that nothing folds.
fn start(molecules: &Molecules, x: Vec<DVec3>, v: Vec<DVec3>) -> (System, State) {
    let system = System::of_molecules(x.len(), molecules.clone());
    let cell = PeriodicBox::new(DVec3::splat(1e3)).unwrap();
    let mut state = State::new(cell, x, v);
    rigid::project_velocities(&system, &state.positions, &mut state.velocities);
    (system, state)
}

fn run(
    system: &System,
    state: &mut State,
    forces: &mut dyn Backend,
    bonds: &BondOptions,
    dt: f64,
    steps: u64,
) {
    let mut integrator = velocity_verlet(bonds, &system.molecules);
    integrator.start(system, state, forces, dt, Want::ENERGY).unwrap();
    for _ in 0..steps {
        integrator.step(system, state, forces, dt, Want::ENERGY).unwrap();
    }
}

/// Lennard-Jones forces between the sites of different molecules, without a cutoff, or a field.
#[derive(Clone)]
struct Simple {
    molecules: Molecules,
    pairs: bool,
    gravity: f64,
}

lennard_core::remembers_nothing!(Simple);

impl ForceTerm for Simple {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        _part: Part,
        _want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        forces.fill(DVec3::new(0.0, 0.0, -self.gravity));
        let mut energy: f64 = at.positions.iter().map(|x| self.gravity * x.z).sum();
        let sites = self.molecules.sites();
        for i in 0..forces.len() {
            for j in 0..i {
                if !self.pairs || i / sites == j / sites {
                    continue;
                }
                let d = at.positions[i] - at.positions[j];
                let r2 = d.length_squared();
                let s6 = r2.powi(-3);
                energy += 4.0 * (s6 * s6 - s6);
                let f = (48.0 * s6 * s6 - 24.0 * s6) / r2 * d;
                forces[i] += f;
                forces[j] -= f;
            }
        }
        Ok(Energetics {
            potential_energy: Some(energy),
            conserved_potential: Some(energy),
            ..Energetics::default()
        })
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties::default()
    }
}

impl Backend for Simple {}

/// A dumbbell of length 1 that turns by α = asin(Ωh) per step about the origin.
fn rotor(omega: f64) -> (System, State) {
    let molecules = Molecules::chains(2, 1.0, Bonds::Rigid);
    let x = vec![DVec3::new(-0.5, 0.0, 0.0), DVec3::new(0.5, 0.0, 0.0)];
    let v = vec![DVec3::new(0.0, -0.5 * omega, 0.0), DVec3::new(0.0, 0.5 * omega, 0.0)];
    start(&molecules, x, v)
}

fn angle(state: &State) -> f64 {
    let d = state.positions[1] - state.positions[0];
    d.y.atan2(d.x)
}

#[test]
fn a_free_rotor_turns_by_the_arc_sine_of_its_speed_and_keeps_its_energy() {
    for bonds in [direct(), shake(1e-14)] {
        let (system, mut state) = rotor(2.0);
        let kinetic = system.kinetic_energy(&state.velocities);
        let (dt, steps) = (0.05, 12);
        run(&system, &mut state, &mut NoForces, &bonds, dt, steps);
        let wanted = steps as f64 * (2.0_f64 * dt).asin();
        assert!((angle(&state) - wanted).abs() < 1e-12, "{}", angle(&state));
        let after = system.kinetic_energy(&state.velocities);
        assert!((after / kinetic - 1.0).abs() < 1e-12);
    }
}

/// Projection along the new bond is dissipative: α_n = α₀/√(1 + 2α₀²n).
#[test]
fn projection_along_the_new_bond_slows_a_rotor_by_its_law() {
    let (dt, alpha) = (0.05, 0.1_f64);
    let (system, mut state) = rotor(alpha.sin() / dt);
    run(&system, &mut state, &mut NoForces, &projection(), dt, 100);
    let before = angle(&state);
    run(&system, &mut state, &mut NoForces, &projection(), dt, 1);
    let turned = (angle(&state) - before).rem_euclid(std::f64::consts::TAU);
    let law = alpha / (1.0 + 2.0 * alpha * alpha * 100.0).sqrt();
    assert!((turned / law - 1.0).abs() < 0.01, "{turned} against {law}");
}

#[test]
fn a_bond_that_turns_too_far_stops_the_step() {
    for bonds in [direct(), shake(1e-12)] {
        let (system, mut state) = rotor(21.0);
        let mut integrator = velocity_verlet(&bonds, &system.molecules);
        integrator.start(&system, &mut state, &mut NoForces, 0.05, Want::NOTHING).unwrap();
        let failed = (0..50).find_map(|_| {
            integrator.step(&system, &mut state, &mut NoForces, 0.05, Want::NOTHING).err()
        });
        let text = failed.expect("a bond turned too far").to_string();
        assert!(text.contains("molecule 1"), "{text}");
    }
}

fn two_dumbbells() -> (System, State, Simple) {
    let half = 0.335;
    let molecules = Molecules::chains(2, 2.0 * half, Bonds::Rigid);
    let x = vec![
        DVec3::new(-1.5, 0.1, -half),
        DVec3::new(-1.5, 0.1, half),
        DVec3::new(1.5, -0.1 - half, 0.0),
        DVec3::new(1.5, -0.1 + half, 0.0),
    ];
    let v = [1.0, 1.0, -1.0, -1.0].map(|v| DVec3::new(v, 0.0, 0.0));
    let (system, state) = start(&molecules, x, v.to_vec());
    let forces = Simple { molecules, pairs: true, gravity: 0.0 };
    (system, state, forces)
}

/// Final positions at t = 2.5 by a Runge–Kutta method of order 8 with a tolerance of 2.3e-14.
fn two_dumbbells_later() -> [DVec3; 4] {
    [
        DVec3::new(-1.641155205379, 0.029260398615, -0.335),
        DVec3::new(-1.641155205379, 0.029260398615, 0.335),
        DVec3::new(1.941570057551, -0.177503160982, 0.0),
        DVec3::new(1.340740353207, 0.118982363753, 0.0),
    ]
}

fn error_after(bonds: &BondOptions, steps: u64) -> f64 {
    let (system, mut state, mut forces) = two_dumbbells();
    run(&system, &mut state, &mut forces, bonds, 2.5 / steps as f64, steps);
    let off = state.positions.iter().zip(two_dumbbells_later());
    off.map(|(x, y)| (*x - y).length()).fold(0.0, f64::max)
}

#[test]
fn two_dumbbells_meet_their_high_precision_solution_with_order_two() {
    for bonds in [direct(), shake(1e-13)] {
        let errors: Vec<f64> =
            [1000, 2000, 4000, 8000].map(|steps| error_after(&bonds, steps)).to_vec();
        assert!(errors[3] < 8e-6, "{errors:?}");
        let order = (errors[1] / errors[3]).log2() / 2.0;
        assert!((order - 2.0).abs() < 0.05, "{order}: {errors:?}");
    }
}

/// By the differences of runs with h, h/2 and h/4: the error of a method of order p falls by 2^p.
fn order_of<T>(of: impl Fn(u64) -> T, apart: impl Fn(&T, &T) -> f64) -> f64 {
    let [a, b, c] = [2000, 4000, 8000].map(of);
    (apart(&a, &b) / apart(&b, &c)).log2()
}

#[test]
fn velocities_and_the_energy_of_two_dumbbells_are_of_order_two() {
    let after = |steps: u64| {
        let (system, mut state, mut forces) = two_dumbbells();
        let dt = 2.5 / steps as f64;
        run(&system, &mut state, &mut forces, &direct(), dt, steps);
        let kinetic = system.kinetic_energy(&state.velocities);
        let energy = kinetic + state.energetics.potential_energy.unwrap();
        (state.velocities, energy)
    };
    let of_velocities = order_of(after, |a, b| {
        let both = a.0.iter().zip(&b.0);
        both.map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max)
    });
    assert!((of_velocities - 2.0).abs() < 0.05, "{of_velocities}");
    let of_energy = order_of(after, |a, b| (a.1 - b.1).abs());
    assert!((of_energy - 2.0).abs() < 0.05, "{of_energy}");
    // The parts of the kinetic energy belong to the high-precision solution too.
    let (v, energy) = after(8000);
    let centers: f64 = v.chunks(2).map(|v| (0.5 * (v[0] + v[1])).length_squared()).sum();
    let inside: f64 = v.chunks(2).map(|v| (0.5 * (v[1] - v[0])).length_squared()).sum();
    assert!((centers - 0.760835326120).abs() < 1e-5, "{centers}");
    assert!((inside - 1.233605923153).abs() < 1e-5, "{inside}");
    assert!((energy - 1.979878613169).abs() < 1e-5, "{energy}");
}

/// The multipliers of both stages of a step are off by O(h), with opposite signs; their mean is off by O(h²).
#[test]
fn multipliers_of_the_stages_are_of_order_one_and_their_mean_is_of_order_two() {
    let off = |steps: u64| -> [f64; 3] {
        let (system, mut state, mut forces) = two_dumbbells();
        // Where the dumbbells are close to each other.
        let dt = 1.25 / steps as f64;
        let mut path = Vec::new();
        let mut method = velocity_verlet(&direct(), &system.molecules);
        let want = Want::ENERGY;
        method.start(&system, &mut state, &mut forces, dt, want).unwrap();
        for step in 1..=steps + 1 {
            if step >= steps {
                path.push(state.clone());
            }
            method.step(&system, &mut state, &mut forces, dt, want).unwrap();
        }
        path.push(state);
        let [before, now, after] = [&path[0], &path[1], &path[2]];
        let (d, w) = (now.positions[3] - now.positions[2], now.velocities[3] - now.velocities[2]);
        let a = now.forces[3] - now.forces[2];
        // G·M⁻¹·Gᵀ = 2|d|² for unit masses.
        let exact = -(w.length_squared() + d.dot(a)) / (2.0 * d.length_squared());
        // v½ = v + (h/2)·(F + Gᵀ·λʳ), and v = v½ + (h/2)·(F + Gᵀ·λᵛ) with v½ of the step before.
        let along = |half_kick: DVec3| d.dot(half_kick) / d.length_squared() * 2.0 / dt;
        let half_step = |a: &State, b: &State| (b.positions[3] - a.positions[3]) / dt;
        let push = 0.5 * dt * now.forces[3];
        let position = along(half_step(now, after) - now.velocities[3] - push);
        let velocity = along(now.velocities[3] - half_step(before, now) - push);
        [position, velocity, 0.5 * (position + velocity)].map(|found| found - exact)
    };
    let (coarse, fine) = (off(500), off(1000));
    assert!(coarse[0] * coarse[1] < 0.0, "{coarse:?}");
    for (stage, order) in [(0, 1.0), (1, 1.0), (2, 2.0)] {
        let found = (coarse[stage] / fine[stage]).log2();
        assert!((found - order).abs() < 0.1, "{stage}: {found}, {coarse:?}");
    }
}

#[test]
fn projection_along_the_new_bond_is_of_order_one() {
    let errors = [2000, 8000].map(|steps| error_after(&projection(), steps));
    let order = (errors[0] / errors[1]).log2() / 2.0;
    assert!((order - 1.0).abs() < 0.1, "{order}: {errors:?}");
}

#[test]
fn every_way_but_the_projection_keeps_both_momenta() {
    let spring = |scheme, damping| {
        BondOptions::Spring(spring::Options { stiffness: 4000.0, damping, scheme })
    };
    let ways = [
        (direct(), Bonds::Rigid),
        (shake(1e-12), Bonds::Rigid),
        (spook(Default::default()), Bonds::Rigid),
        (spring(spring::Scheme::Explicit, 0.0), Bonds::Springs),
        (spring(spring::Scheme::Explicit, 9.0), Bonds::Impulses),
        (spring(spring::Scheme::Midpoint, 0.0), Bonds::Impulses),
        (spring(spring::Scheme::Midpoint, 9.0), Bonds::Impulses),
        (spring(spring::Scheme::LinearlyImplicit, 0.0), Bonds::Impulses),
        (spring(spring::Scheme::LinearlyImplicit, 9.0), Bonds::Impulses),
        (projection(), Bonds::Rigid),
    ];
    for (bonds, kind) in ways {
        let (_, mut state, mut pairs) = two_dumbbells();
        let molecules = Molecules::chains(2, 0.67, kind);
        let system = System::of_molecules(4, molecules.clone());
        pairs.molecules = molecules.clone();
        state.velocities[0] += DVec3::new(0.1, 0.4, -0.2);
        rigid::project_velocities(&system, &state.positions, &mut state.velocities);
        let momentum = system.momentum(&state.velocities);
        // Velocities of SPOOK stand half a step behind the positions: positions are taken back by half a step.
        let dt = 2.5 / 4000.0;
        let lag = if matches!(bonds, BondOptions::Spook(_)) { dt } else { 0.0 };
        let angular = |state: &State| -> DVec3 {
            let both = state.positions.iter().zip(&state.velocities);
            both.map(|(x, v)| (*x - lag * *v).cross(*v)).sum()
        };
        let before = angular(&state);
        let mut forces = ForceSum::new(pairs);
        if let BondHolder::Spring(term) | BondHolder::InDrift(_, term) = bonds.build(&molecules) {
            forces.push(term);
        }
        run(&system, &mut state, &mut forces, &bonds, dt, 4000);
        let lost = (system.momentum(&state.velocities) - momentum).length();
        assert!(lost < 4e-13, "{bonds:?}: {lost:e}");
        let turned = (angular(&state) - before).length() / before.length();
        match kind == Bonds::Rigid && bonds == projection() {
            true => assert!(turned > 1e-4, "{turned:e}"),
            false => assert!(turned < 1e-12, "{bonds:?}: {turned:e}"),
        }
    }
}

#[test]
fn energy_and_momenta_of_two_dumbbells_are_kept() {
    let (system, mut state, mut forces) = two_dumbbells();
    let momentum = system.momentum(&state.velocities);
    let angular = |state: &State| -> DVec3 {
        let both = state.positions.iter().zip(&state.velocities);
        both.map(|(x, v)| x.cross(*v)).sum()
    };
    let before = angular(&state);
    run(&system, &mut state, &mut forces, &direct(), 2.5 / 8000.0, 8000);
    let energy =
        system.kinetic_energy(&state.velocities) + state.energetics.potential_energy.unwrap();
    assert!((energy - 1.979878613169).abs() < 1e-5, "{energy}");
    assert!((system.momentum(&state.velocities) - momentum).length() < 1e-13);
    assert!((angular(&state) - before).length() < 1e-12);
}

#[test]
fn reversed_velocities_lead_back_but_not_with_projection() {
    let back = |bonds: &BondOptions| {
        let (system, mut state, mut forces) = two_dumbbells();
        let first = state.positions.clone();
        run(&system, &mut state, &mut forces, bonds, 5e-4, 10_000);
        for v in &mut state.velocities {
            *v = -*v;
        }
        run(&system, &mut state, &mut forces, bonds, 5e-4, 10_000);
        let off = state.positions.iter().zip(&first);
        off.map(|(x, y)| (*x - *y).length()).fold(0.0, f64::max)
    };
    for bonds in [direct(), shake(1e-14)] {
        let off = back(&bonds);
        assert!(off < 1e-9, "{off:e}");
    }
    // SPOOK with damping is dissipative too.
    for bonds in [projection(), spook(Default::default())] {
        assert!(back(&bonds) > 1e-6, "{bonds:?}: {:e}", back(&bonds));
    }
}

#[test]
fn a_pendulum_comes_back_over_10_000_steps() {
    let (system, mut state, _) = hanging_chain(2);
    let system = system.holding(&[0]);
    let start = state.positions.clone();
    let mut gravity = HeldAtOneEnd(9.81);
    for _ in 0..2 {
        run(&system, &mut state, &mut gravity, &direct(), 5e-4, 10_000);
        state.velocities.iter_mut().for_each(|v| *v = -*v);
    }
    let off = (state.positions[1] - start[1]).length();
    assert!(off < 1e-9, "{off:e}");
}

#[test]
fn closed_form_bonds_keep_their_length_at_any_of_a_million_steps() {
    // Five dumbbells under forces of pairs fill a register, and leave one over.
    let molecules = Molecules::chains(2, 0.67, Bonds::Rigid);
    let x = (0..10).map(|i| DVec3::new(3.0 * f64::from(i / 2), 0.67 * f64::from(i % 2), 0.0));
    let v = (0..10).map(|i| {
        let k = f64::from(i);
        DVec3::new((1.7 * k).sin(), (0.9 * k).cos(), (2.3 * k).sin())
    });
    let (system, mut state) = start(&molecules, x.collect(), v.collect());
    let mut method = velocity_verlet(&direct(), &molecules);
    let (dt, want) = (0.01, Want::NOTHING);
    method.start(&system, &mut state, &mut NoForces, dt, want).unwrap();
    let mut worst = [0.0_f64; 2];
    for _ in 0..1_000_000 {
        let told = method.step(&system, &mut state, &mut NoForces, dt, want);
        let d = state.positions.chunks_exact(2).map(|x| (x[1] - x[0]).length());
        let off = d.map(|d| (d / 0.67 - 1.0).abs()).fold(0.0, f64::max);
        worst = [worst[0].max(off), worst[1].max(told.unwrap().residual)];
        // Free dumbbells would fly out of the range where positions have all their digits.
        if state.step % 1000 == 0 {
            for x in state.positions.chunks_mut(2) {
                let center = 0.5 * (x[0] + x[1]);
                x.iter_mut().for_each(|x| *x -= center);
            }
        }
    }
    assert!(worst[0] < 1e-14 && worst[1] < 1e-14, "{worst:?}");
}

#[test]
fn a_hanging_chain_at_rest_has_the_weight_below_as_its_tensions() {
    for n in [2_usize, 5, 12] {
        let molecules = Molecules::chains(n + 1, 0.2, Bonds::Rigid);
        let x = (0..=n).map(|k| DVec3::new(0.0, 0.0, -0.2 * k as f64)).collect();
        let (system, mut state) = start(&molecules, x, vec![DVec3::ZERO; n + 1]);
        let system = system.holding(&[0]);
        let mut gravity = HeldAtOneEnd(9.81);
        run(&system, &mut state, &mut gravity, &direct(), 1e-3, 100);
        // T_j = (n − j + 1)·m·g, so that Σ λ·|d|² is −Σ T_j·r.
        let sums = rigid::constraint_sums(&system, &state);
        let wanted = -9.81 * 0.2 * (n * (n + 1)) as f64 / 2.0;
        assert!((sums.virial.z_axis.z / wanted - 1.0).abs() < 1e-12, "{sums:?}");
        let moved = (state.positions[n].z + 0.2 * n as f64).abs();
        assert!(moved < 1e-13, "{moved:e}");
    }
}

/// Small swings of n beads on a string have ω²·l/g at the zeros of the Laguerre polynomial L_n.
#[test]
fn small_swings_of_a_chain_have_the_frequencies_of_laguerre() {
    let (g, l) = (9.81, 0.2);
    for zeros in [&[0.585786_f64, 3.414214][..], &[0.415775, 2.294280, 6.289945]] {
        let n = zeros.len();
        for zero in zeros {
            let omega = (zero * g / l).sqrt();
            // The angle of each string in this mode, from the outermost bead inwards: the k-th from below carries k beads.
            // x_k − x_{k−1} follows from the equation of bead k.
            let mut shape = vec![1.0_f64];
            let mut next = shape[0] - zero;
            for carried in 2..=n {
                let last = shape.last().copied().unwrap_or_default();
                shape.push(next);
                let tension = carried as f64;
                next += ((tension - 1.0) * (next - last) - zero * next) / tension;
            }
            assert!(next.abs() < 1e-4, "the pivot stays: {next}");
            let amplitude = 2e-5;
            shape.reverse();
            let bead = |k: usize| {
                if k == 0 { 0.0 } else { amplitude * shape[k - 1] }
            };
            let mut x = vec![DVec3::ZERO];
            for k in 1..=n {
                let dx = bead(k) - bead(k - 1);
                let last = x[k - 1];
                x.push(last + DVec3::new(dx, 0.0, -(l * l - dx * dx).sqrt()));
            }
            let molecules = Molecules::chains(n + 1, l, Bonds::Rigid);
            let (system, mut state) = start(&molecules, x, vec![DVec3::ZERO; n + 1]);
            let system = system.holding(&[0]);
            let first: Vec<f64> = state.positions.iter().map(|x| x.x).collect();
            let steps = 4000_u32;
            let dt = std::f64::consts::TAU / omega / f64::from(steps);
            let mut gravity = HeldAtOneEnd(g);
            run(&system, &mut state, &mut gravity, &direct(), dt, u64::from(steps) / 4);
            // After a quarter of the period all beads pass through the middle.
            let largest = first.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            for (k, x) in state.positions.iter().enumerate() {
                assert!(x.x.abs() < 1e-4 * largest, "{n}, {zero}, {k}: {x}");
            }
            let quarter = u64::from(steps) / 4;
            run(&system, &mut state, &mut gravity, &direct(), dt, 3 * quarter);
            for (x, first) in state.positions.iter().zip(&first) {
                assert!((x.x - first).abs() < 1e-4 * largest, "{n}, {zero}: {x} {first}");
            }
        }
    }
}

#[test]
fn a_conical_pendulum_turns_at_its_speed_and_has_its_tension() {
    let (omega, tension) = (3.365651836049, 11.327612281500);
    let (sin, cos) = 30.0_f64.to_radians().sin_cos();
    let molecules = Molecules::chains(2, 1.0, Bonds::Rigid);
    let x = vec![DVec3::ZERO, DVec3::new(sin, 0.0, -cos)];
    let v = vec![DVec3::ZERO, DVec3::new(0.0, omega * sin, 0.0)];
    let (system, mut state) = start(&molecules, x, v);
    let system = system.holding(&[0]);
    let turn = |steps: u64| {
        let mut state = state.clone();
        let dt = std::f64::consts::TAU / omega / steps as f64;
        run(&system, &mut state, &mut HeldAtOneEnd(9.81), &direct(), dt, steps);
        (state.positions[1] - DVec3::new(sin, 0.0, -cos)).length()
    };
    let (coarse, fine) = (turn(1000), turn(2000));
    assert!(fine < 1e-5 && (coarse / fine / 4.0 - 1.0).abs() < 0.05, "{coarse} {fine}");
    state.forces = vec![DVec3::ZERO, DVec3::new(0.0, 0.0, -9.81)];
    let sums = rigid::constraint_sums(&system, &state);
    let virial = sums.virial.x_axis.x + sums.virial.y_axis.y + sums.virial.z_axis.z;
    assert!((-virial / tension - 1.0).abs() < 1e-12, "{virial}");
}

/// A chain at rest and horizontal in gravity, whose first bead is so heavy that it hardly moves.
fn hanging_chain(sites: usize) -> (System, State, Simple) {
    let molecules = Molecules::chains(sites, 0.2, Bonds::Rigid);
    let x = (0..sites).map(|k| DVec3::new(0.2 * k as f64, 0.0, 0.0)).collect();
    let (system, state) = start(&molecules, x, vec![DVec3::ZERO; sites]);
    let forces = Simple { molecules, pairs: false, gravity: 9.81 };
    (system, state, forces)
}

/// Gravity, and a force that holds the first bead: it has the weight of nothing and a mass beyond all others.
#[derive(Clone)]
struct HeldAtOneEnd(f64);

lennard_core::remembers_nothing!(HeldAtOneEnd);

impl ForceTerm for HeldAtOneEnd {
    fn evaluate(
        &mut self,
        _at: Configuration<'_>,
        _part: Part,
        _want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        forces.fill(DVec3::new(0.0, 0.0, -self.0));
        forces[0] = DVec3::ZERO;
        Ok(Energetics::default())
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties::default()
    }
}

impl Backend for HeldAtOneEnd {}

#[test]
fn a_chain_held_at_one_end_falls_as_its_high_precision_solution() {
    let (mut system, mut state, _) = hanging_chain(6);
    system.masses = Masses::Each(vec![1e15, 1.0, 1.0, 1.0, 1.0, 1.0]);
    run(&system, &mut state, &mut HeldAtOneEnd(9.81), &direct(), 5e-5, 10_000);
    let end = state.positions[5];
    let wanted = DVec3::new(-0.056664541268, 0.0, -0.975802326581);
    assert!((end - wanted).length() < 2e-6, "{end} against {wanted}");
}

#[test]
fn relaxation_and_the_direct_solution_agree_on_a_chain() {
    let after = |bonds: &BondOptions| {
        let (system, mut state, mut forces) = hanging_chain(11);
        state.velocities[10] = DVec3::new(0.3, 0.5, 1.0);
        rigid::project_velocities(&system, &state.positions, &mut state.velocities);
        run(&system, &mut state, &mut forces, bonds, 1e-3, 1000);
        state.positions
    };
    let one = after(&direct());
    let other = after(&shake(1e-13));
    let off = one.iter().zip(&other).map(|(a, b)| (*a - *b).length());
    let off = off.fold(0.0, f64::max);
    assert!(off < 1e-9, "{off:e}");
}

/// The residual that so many sweeps leave on a straight chain, drifted so that each bond is a little too long.
fn stretched(bonds: usize, sweeps: u32, over_relaxation: f64) -> f64 {
    let molecules = Molecules::chains(bonds + 1, 1.0, Bonds::Rigid);
    let along = || (0..=bonds).map(|k| DVec3::new(k as f64, 0.0, 0.0)).collect();
    let system = System::of_molecules(bonds + 1, molecules.clone());
    let cell = PeriodicBox::new(DVec3::splat(1e3)).unwrap();
    let mut state = State::new(cell, along(), along());
    let options = BondOptions::Relaxation(relaxation::Options {
        sweeps,
        over_relaxation,
        ..Default::default()
    });
    let mut integrator = velocity_verlet(&options, &molecules);
    let (dt, want) = (1e-4, Want::NOTHING);
    integrator.start(&system, &mut state, &mut NoForces, dt, want).unwrap();
    let report = integrator.step(&system, &mut state, &mut NoForces, dt, want);
    report.unwrap().residual
}

/// The rate of Gauss–Seidel on a straight chain of n bonds is cos²(π/(n + 1)).
#[test]
fn sweeps_over_a_straight_chain_converge_by_the_cosine_law() {
    for (bonds, sweeps, more) in [(2_usize, 4, 4), (5, 24, 8), (10, 60, 10)] {
        let residual = |sweeps| stretched(bonds, sweeps, 1.0);
        let rate = (residual(sweeps + more) / residual(sweeps)).powf(1.0 / f64::from(more));
        let law = (std::f64::consts::PI / (bonds as f64 + 1.0)).cos().powi(2);
        assert!((rate / law - 1.0).abs() < 0.01, "{bonds}: {rate} against {law}");
    }
}

/// Below the best over-relaxation ω, a sweep leaves ((ωμ + √(ω²μ² − 4(ω − 1)))/2)² with μ = cos(π/(n + 1)).
#[test]
fn over_relaxed_sweeps_converge_by_the_theory_of_successive_over_relaxation() {
    for (bonds, omega, sweeps, more) in [(5_usize, 1.2_f64, 16, 8), (10, 1.3, 30, 10)] {
        let residual = |sweeps| stretched(bonds, sweeps, omega);
        let rate = (residual(sweeps + more) / residual(sweeps)).powf(1.0 / f64::from(more));
        let jacobi = omega * (std::f64::consts::PI / (bonds as f64 + 1.0)).cos();
        let root = (jacobi * jacobi - 4.0 * (omega - 1.0)).sqrt();
        let law = (0.5 * (jacobi + root)).powi(2);
        assert!((rate / law - 1.0).abs() < 0.01, "{bonds}: {rate} against {law}");
    }
}

#[test]
fn multipliers_are_the_tension_of_a_turning_chain() {
    // A straight chain turning at Ω about its middle: T_j = Ω²·Σ radii of the outer beads.
    let omega = 1.7;
    let molecules = Molecules::chains(4, 1.0, Bonds::Rigid);
    let x: Vec<DVec3> = [-1.5, -0.5, 0.5, 1.5].map(|x| DVec3::new(x, 0.0, 0.0)).to_vec();
    let v = x.iter().map(|x| DVec3::new(0.0, omega * x.x, 0.0)).collect();
    let (system, state) = start(&molecules, x, v);
    let sums = rigid::constraint_sums(&system, &state);
    let tensions = [1.5, 2.0, 1.5].map(|radii| omega * omega * radii);
    // The force on the site at the end of d is λ·d, and the tension −λ|d|.
    let wanted = -tensions.iter().sum::<f64>();
    assert!((sums.virial.x_axis.x - wanted).abs() < 1e-12, "{sums:?}");
    assert!(sums.largest_residual < 1e-15);
    let squares: f64 = [1.5_f64, 0.5, 0.5, 1.5].map(|r| (omega * omega * r).powi(2)).iter().sum();
    assert!((sums.squared_forces - squares).abs() < 1e-12);
}

#[test]
fn bonds_of_many_dumbbells_keep_their_length_to_the_last_place() {
    let molecules = Molecules::chains(2, 0.67, Bonds::Rigid);
    let n = 500;
    let x = (0..2 * n)
        .map(|i| {
            let (bond, m) = (0.67 * (i % 2) as f64, i / 2);
            DVec3::new((m % 8) as f64 + bond, (m / 8 % 8) as f64, (m / 64) as f64)
        })
        .collect();
    let v = (0..2 * n)
        .map(|i| {
            let k = f64::from(i as u32);
            0.3 * DVec3::new((k * 0.7).sin(), (k * 1.3).cos(), (k * 0.3).sin())
        })
        .collect();
    let (system, mut state) = start(&molecules, x, v);
    let kinetic = system.kinetic_energy(&state.velocities);
    run(&system, &mut state, &mut NoForces, &direct(), 0.01, 2000);
    assert!(rigid::constraint_sums(&system, &state).largest_residual < 1e-14);
    let after = system.kinetic_energy(&state.velocities);
    assert!((after / kinetic - 1.0).abs() < 1e-11);
    assert_eq!(system.n_dof(Momentum::Conserved), 3.0 * 1000.0 - 500.0 - 3.0);
}

#[test]
fn a_stiff_spring_swings_at_its_frequency_and_its_virial_is_its_force() {
    let stiffness = 900.0;
    let molecules = Molecules::chains(2, 1.0, Bonds::Springs);
    let options = BondOptions::Spring(spring::Options { stiffness, ..Default::default() });
    let omega = options.frequency();
    assert!((omega - (2.0 * stiffness).sqrt()).abs() < 1e-12);
    let x = vec![DVec3::new(-0.51, 0.0, 0.0), DVec3::new(0.51, 0.0, 0.0)];
    let (system, mut state) = start(&molecules, x, vec![DVec3::ZERO; 2]);
    let BondHolder::Spring(term) = options.build(&molecules) else { panic!("springs are forces") };
    let mut forces = ForceSum::new(NoForces);
    forces.push(term);
    let steps = 1000;
    let dt = std::f64::consts::TAU / omega / f64::from(steps);
    let mut integrator = velocity_verlet(&options, &molecules);
    integrator.start(&system, &mut state, &mut forces, dt, Want::TOTALS).unwrap();
    let first = state.clone();
    let virial = first.energetics.scalar_virial().unwrap();
    let wanted: f64 = first.positions.iter().zip(&first.forces).map(|(x, f)| x.dot(*f)).sum();
    assert!((virial - wanted).abs() < 1e-12, "{virial} {wanted}");
    assert!(
        (first.energetics.potential_energy.unwrap() - 0.5 * stiffness * 0.02_f64.powi(2)).abs()
            < 1e-12
    );
    for _ in 0..steps {
        integrator.step(&system, &mut state, &mut forces, dt, Want::TOTALS).unwrap();
    }
    assert!((state.positions[1] - first.positions[1]).length() < 1e-6);
}

/// The Laplacian of springs is the divergence of their forces.
#[test]
fn the_laplacian_of_springs_is_the_divergence_of_their_forces() {
    let molecules = Molecules::chains(3, 1.0, Bonds::Springs);
    let options = BondOptions::Spring(spring::Options { stiffness: 50.0, ..Default::default() });
    let BondHolder::Spring(mut term) = options.build(&molecules) else {
        panic!("springs are forces")
    };
    let x = vec![DVec3::new(0.0, 0.1, 0.2), DVec3::new(0.9, 0.3, -0.1), DVec3::new(1.2, 1.3, 0.4)];
    let cell = PeriodicBox::new(DVec3::splat(1e3)).unwrap();
    let mut at = |x: &[DVec3]| {
        let mut forces = vec![DVec3::ZERO; 3];
        let found = term
            .evaluate(Configuration::at_rest(&cell, x), Part::All, Want::TOTALS, &mut forces)
            .unwrap();
        (forces, found.laplacian.unwrap())
    };
    let (_, laplacian) = at(&x);
    let mut divergence = 0.0;
    for site in 0..3 {
        for axis in 0..3 {
            let moved = |by: f64| {
                let mut x = x.clone();
                x[site][axis] += by;
                x
            };
            let eta = 1e-5;
            divergence +=
                (at(&moved(eta)).0[site][axis] - at(&moved(-eta)).0[site][axis]) / (2.0 * eta);
        }
    }
    assert!((laplacian + divergence).abs() < 1e-6 * laplacian, "{laplacian} {divergence}");
}

/// A free dumbbell that turns by α per step is an exact fixed motion of SPOOK, at
/// |d| = r/(1 − (1 − cos α)·((1 + γ)/(4γ) + 2εμ/h²)).
#[test]
fn a_rotor_under_spook_keeps_turning_at_its_stretched_length() {
    let (alpha, dt) = (0.05_f64, 0.01);
    for (compliance, damping_steps) in [(0.0, 2.0), (0.0, 0.5), (1e-6, 4.0)] {
        let gamma = 1.0 / (1.0 + 4.0 * damping_steps);
        let mu = 0.5;
        let spring = 2.0 * compliance * mu / (dt * dt);
        let stretched =
            1.0 / (1.0 - (1.0 - alpha.cos()) * ((1.0 + gamma) / (4.0 * gamma) + spring));
        if compliance == 0.0 && damping_steps == 2.0 {
            assert!((stretched - 1.0031341411634336).abs() < 1e-15);
        }
        let molecules = Molecules::chains(2, 1.0, Bonds::Rigid);
        let half = 0.5 * stretched;
        let x = vec![DVec3::new(-half, 0.0, 0.0), DVec3::new(half, 0.0, 0.0)];
        // x(h) = x(0) + h·v(h): the velocity that led here from the position one angle before.
        let before = DVec3::new(half * alpha.cos(), -half * alpha.sin(), 0.0);
        let v = (x[1] - before) / dt;
        let (system, mut state) = start(&molecules, x, vec![DVec3::ZERO; 2]);
        state.velocities = vec![-v, v];
        let options = lennard_integrators::bonds::spook::Options {
            compliance,
            damping_steps,
            damping_time: None,
            sweeps: 0,
        };
        run(&system, &mut state, &mut NoForces, &spook(options), dt, 1000);
        let length = (state.positions[1] - state.positions[0]).length();
        assert!((length - stretched).abs() < 1e-12, "{length} against {stretched}");
        let turned = (angle(&state) - 1000.0 * alpha).rem_euclid(std::f64::consts::TAU);
        assert!(turned.min(std::f64::consts::TAU - turned) < 1e-9, "{turned}");
    }
}

#[test]
fn spook_is_of_order_one_at_a_fixed_damping_time() {
    let order = |options: lennard_integrators::bonds::spook::Options| {
        let errors = [2000, 8000].map(|steps| error_after(&spook(options.clone()), steps));
        (errors[0] / errors[1]).log2() / 2.0
    };
    let fixed = lennard_integrators::bonds::spook::Options {
        damping_time: Some(0.01),
        ..Default::default()
    };
    let fixed = order(fixed);
    assert!((fixed - 1.0).abs() < 0.1, "{fixed}");
    let steps = order(Default::default());
    assert!(steps > 1.7, "{steps}");
}

#[test]
fn spook_without_compliance_and_damping_is_refused() {
    let options = spook(lennard_integrators::bonds::spook::Options {
        damping_steps: 0.0,
        ..Default::default()
    });
    let error = options.check().unwrap_err();
    assert_eq!(error.key, "compliance");
    assert!(error.found.contains("unstable"), "{error}");
}

/// A chain under SPOOK: momentum is kept, and impulses hold the bonds near their length.
#[test]
fn spook_holds_a_chain_and_keeps_its_momentum() {
    let (system, mut state, mut forces) = hanging_chain(8);
    forces.gravity = 0.0;
    for (k, v) in state.velocities.iter_mut().enumerate() {
        let k = k as f64;
        *v = DVec3::new((0.9 * k).sin(), (1.7 * k).cos(), (0.4 * k).sin());
    }
    rigid::project_velocities(&system, &state.positions, &mut state.velocities);
    let momentum = system.momentum(&state.velocities);
    run(&system, &mut state, &mut forces, &spook(Default::default()), 1e-3, 2000);
    assert!((system.momentum(&state.velocities) - momentum).length() < 1e-12);
    let strain = rigid::constraint_sums(&system, &state).largest_residual;
    assert!((1e-9..0.02).contains(&strain), "{strain}");
}

#[test]
fn leapfrog_and_positions_alone_hold_bonds_as_velocity_verlet_does() {
    let dt = 0.002;
    for bonds in [direct(), shake(1e-14)] {
        let moved = |options: &IntegratorOptions| {
            let (system, mut state, mut forces) = hanging_chain(6);
            let method = build(options);
            let BondHolder::Drift(solver) = bonds.build(&system.molecules) else {
                panic!("rigid bonds are held in drifts");
            };
            let mut method = method.with_bonds(solver);
            let want = Want::ENERGY;
            method.start(&system, &mut state, &mut forces, dt, want).unwrap();
            for _ in 0..500 {
                let report = method.step(&system, &mut state, &mut forces, dt, want);
                assert!(report.unwrap().residual < 1e-13);
            }
            state
        };
        let wanted = moved(&IntegratorOptions::default());
        for method in [
            IntegratorOptions::Leapfrog(Default::default()),
            IntegratorOptions::StormerVerlet(Default::default()),
        ] {
            let found = moved(&method);
            for (a, b) in found.positions.iter().zip(&wanted.positions) {
                assert!((*a - *b).length() < 1e-9, "{method:?}: {a} {b}");
            }
            for (a, b) in found.velocities.iter().zip(&wanted.velocities) {
                assert!((*a - *b).length() < 1e-7, "{method:?}: {a} {b}");
            }
        }
    }
}

#[test]
fn positions_alone_refuse_springs_of_impulses() {
    let molecules = Molecules::chains(2, 1.0, Bonds::Impulses);
    let x = vec![DVec3::ZERO, DVec3::X];
    let (system, mut state) = start(&molecules, x, vec![DVec3::ZERO; 2]);
    let mut method = build(&IntegratorOptions::StormerVerlet(Default::default()));
    let refused = method.start(&system, &mut state, &mut NoForces, 0.01, Want::NOTHING);
    let text = refused.unwrap_err().to_string();
    assert!(text.contains("its springs leave velocities that positions do not tell"), "{text}");
}

#[test]
fn methods_without_a_form_for_rigid_bonds_say_so() {
    for (method, words) in [
        (
            IntegratorOptions::StormerVerletTimeCorrected(Default::default()),
            "it has rigid bonds, and the method has no form that holds them",
        ),
        (
            IntegratorOptions::Spook(Default::default()),
            "it has rigid bonds, and the method was told of none",
        ),
    ] {
        let (system, mut state) = rotor(1.0);
        let refused = build(&method).start(&system, &mut state, &mut NoForces, 0.01, Want::NOTHING);
        let text = refused.unwrap_err().to_string();
        assert!(text.contains(words), "{text}");
    }
    let error = lennard_core::StepError::BondsNotConverged {
        molecule: 3,
        iterations: 7,
        residual: 0.5,
        wanted: 0.25,
    };
    assert_eq!(
        error.to_string(),
        "molecule 3 (counted from 1) did not reach its bond lengths in 7 iterations: | |d|/r − 1 | is 5.00e-1, wanted 2.5e-1; take a smaller dt or `[bonds] method = \"direct\"`"
    );
}
