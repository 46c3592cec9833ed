//! Fused steps have the bits of single steps.

use crate::common::*;
use lennard_core::random::Streams;
use lennard_core::{
    Backend, BathStep, Configuration, DVec3, ForceError, ForceTerm, FrictionAndNoise, FusedBath,
    FusedSteps, Masses, Moving, Own, Part, PeriodicBox, System, Thermostat, Want,
};
use lennard_forcefield::{
    ForceFieldOptions, Kernel, KernelOptions, ListMode, NeighborOptions, PairForces, Precision,
    TruncationKind, TruncationOptions, build,
};

/// A fluid before the evaluation of its forces, alone or with a bath or noise.
#[derive(Clone)]
struct Fluid {
    cell: PeriodicBox,
    positions: Vec<DVec3>,
    velocities: Vec<DVec3>,
    step: u64,
    bath: Option<Sensitive>,
    noise: Option<FrictionAndNoise>,
    heats: Vec<f64>,
}

impl PartialEq for Fluid {
    fn eq(&self, other: &Self) -> bool {
        let vectors = |f: &Self| (f.positions.clone(), f.velocities.clone());
        let bath = |f: &Self| (f.step, f.bath.clone(), f.heats.clone());
        vectors(self) == vectors(other) && bath(self) == bath(other)
    }
}

impl Fluid {
    fn start(cell: PeriodicBox, positions: Vec<DVec3>) -> Self {
        let noise = scatter(positions.len(), DVec3::splat(4.0), 0.7);
        let velocities = noise.iter().map(|v| *v - DVec3::splat(2.0)).collect();
        let heats = Vec::new();
        Self { cell, positions, velocities, step: 100, bath: None, noise: None, heats }
    }

    /// One step of the sequence that fused steps promise.
    fn step(&mut self, forces: &mut PairForces, masses: &Masses) -> Result<(), ForceError> {
        let (f, _) = evaluate(forces, self.cell, &self.positions, Part::All, Want::NOTHING)?;
        let v = &mut self.velocities;
        kick(v, &f, masses, 0.5 * DT);
        if let Some(bath) = &mut self.bath
            && bath.acts_after(self.step)
        {
            let system = System::atoms(v.len()).with_masses(masses.clone());
            let kinetic = system.kinetic_energy(v);
            let factor = bath.factor(BathStep { kinetic, n_dof: 12.0, dt: DT, step: self.step });
            v.iter_mut().for_each(|v| *v *= factor);
            self.heats.push(factor * factor * kinetic - kinetic);
        }
        kick(v, &f, masses, 0.5 * DT);
        if let Some(noise) = self.noise {
            drift(&mut self.positions, v, 0.5 * DT);
            let of_step = noise.in_step(self.step, DT);
            let (positions, velocities) = (&mut self.positions[..], &mut self.velocities[..]);
            let moving = Moving { positions, velocities, forces: &f };
            self.heats.push(moving.noise(&of_step, masses, &Own::all_of(f.len())));
            drift(&mut self.positions, &self.velocities, 0.5 * DT);
        } else {
            drift(&mut self.positions, v, DT);
        }
        self.step += 1;
        Ok(())
    }

    fn stride(&mut self, forces: &mut PairForces, masses: &Masses, steps: u64) -> u64 {
        let n = self.positions.len();
        let bath = match self.noise {
            Some(noise) => Some(FusedBath::noise(noise, DT, self.step)),
            None => self.bath.as_mut().map(|bath| FusedBath::scaling(bath, 12.0, DT, self.step)),
        };
        let mut steps = FusedSteps {
            cell: &self.cell,
            positions: &mut self.positions,
            velocities: &mut self.velocities,
            forces: &mut vec![DVec3::NAN; n],
            masses,
            dt: DT,
            steps,
            first: 0,
            bath,
        };
        let taken = forces.advance(&mut steps);
        if let Some(bath) = steps.bath {
            self.heats.extend(bath.into_heats());
        }
        self.step += taken;
        taken
    }
}

/// A list with a thin skin, which is built several times in the steps below.
fn options(kernel: KernelOptions, kind: TruncationKind) -> ForceFieldOptions {
    ForceFieldOptions {
        kernel,
        truncation: TruncationOptions::new(kind, 2.3),
        neighbor: verlet(Some(0.15)),
        ..ForceFieldOptions::default()
    }
}

/// Wants the bits of single steps from strides of several lengths on several numbers of threads.
fn has_the_bits_of_single_steps(
    start: &Fluid,
    fresh: &dyn Fn() -> PairForces,
    masses: &Masses,
    what: &str,
) {
    let (mut one, mut forces) = (start.clone(), fresh());
    for _ in 0..60 {
        one.step(&mut forces, masses).unwrap();
    }
    let expected = forces.statistics();
    assert!((3..40).contains(&expected.builds), "{}", expected.builds);
    assert_eq!(one.heats.len() > 12, start.bath.is_some() || start.noise.is_some());
    for (threads, lengths) in [(1, [60, 0]), (2, [59, 1]), (3, [7, 9])] {
        let (mut all, mut forces) = (start.clone(), fresh());
        let left = in_threads(threads, || {
            let mut left = 60;
            for length in lengths.into_iter().cycle() {
                left -= all.stride(&mut forces, masses, length.min(left));
                if left == 0 {
                    break;
                }
                // A method takes single steps between two strides.
                all.step(&mut forces, masses).unwrap();
                left -= 1;
            }
            left
        });
        assert_eq!(left, 0);
        assert!(all == one, "{what}, {threads} threads, {lengths:?}");
        let found = forces.statistics();
        let counts = [found, expected].map(|s| (s.builds, s.evaluations));
        assert_eq!(counts[0], counts[1], "{what}, {threads} threads, {lengths:?}");
    }
}

#[test]
fn strides_of_any_length_have_the_bits_of_single_steps() {
    let noise = FrictionAndNoise {
        friction: 2.0,
        temperature: 1.3.into(),
        noise: Streams::new(9).noise("langevin"),
    };
    let bath = |every| Some(Sensitive { every, acted: 0 });
    // The numbers are no multiples of four or of a chunk. Each thread packs the rows of the first, and all threads pack
    // the rows of the second.
    for (k, shift) in [([7, 8, 9], 0.0), ([13, 14, 13], -3e6)] {
        let (cell, start) = liquid(k, 0.8, 0.1);
        let home = shift * cell.lengths();
        let start = Fluid::start(cell, start.into_iter().map(|r| r + home).collect());
        let n = start.positions.len();
        for kernel in kernels() {
            for (kind, mass, species, bath, noise) in [
                (TruncationKind::Shift, 1.0, 1, None, None),
                (TruncationKind::Switch, 2.5, 1, None, None),
                (TruncationKind::Shift, 1.0, 2, None, None),
                (TruncationKind::ForceShift, 1.0, 3, None, None),
                (TruncationKind::Shift, 1.5, 1, bath(1), None),
                (TruncationKind::Shift, 1.5, 1, bath(3), None),
                (TruncationKind::Shift, 1.5, 1, None, Some(noise)),
            ] {
                let what = format!("{kernel:?}, {kind:?}, {species} species, {bath:?}, {noise:?}");
                let mixture = mixture_or_one(species, 2.3, n);
                let fresh = || built(&options(kernel, kind), mixture.as_ref(), cell, n);
                let start = Fluid { bath, noise, ..start.clone() };
                has_the_bits_of_single_steps(&start, &fresh, &Masses::Uniform(mass), &what);
            }
        }
    }
}

#[test]
fn a_stride_that_fails_under_a_bath_changes_no_particle() {
    let (cell, positions) = liquid([8, 8, 8], 0.8, 0.1);
    let n = positions.len();
    let mut start = Fluid::start(cell, positions);
    start.bath = Some(Sensitive { every: 1, acted: 0 });
    start.velocities = vec![DVec3::X; n];
    start.velocities[77].y = f64::INFINITY;
    let masses = Masses::Uniform(1.5);
    for kernel in kernels() {
        let options = ForceFieldOptions { kernel, ..ForceFieldOptions::default() };
        let (mut fluid, mut forces) = (start.clone(), built(&options, None, cell, n));
        assert_eq!(fluid.stride(&mut forces, &masses, 9), 0);
        assert_eq!(fluid.positions, start.positions);
        assert_eq!(fluid.velocities, start.velocities);
        assert!(fluid.bath != start.bath, "the caller gives the bath its memory back");
        // The kinetic energy of the next stride has nothing of the last one.
        let [mut other, mut alone] = [start.clone(), start.clone()].map(|mut fluid| {
            fluid.velocities[77] = DVec3::X;
            fluid
        });
        assert_eq!(other.stride(&mut forces, &masses, 9), 9);
        alone.stride(&mut built(&options, None, cell, n), &masses, 9);
        assert!(other == alone, "{kernel:?}");
    }
}

#[test]
fn a_stride_of_very_many_particles_has_the_bits_of_single_steps() {
    // So many that displacements are packed, by the chunks of the step before too.
    let (cell, start) = liquid([52, 51, 50], 0.8442, 0.1);
    let mut start = Fluid::start(cell, start);
    // One particle in 17 is so fast that it is a far mover for many steps of a list, and it meets others.
    for (k, v) in start.velocities.iter_mut().enumerate() {
        *v = v.normalize() * if k % 17 == 0 { 4.0 } else { 1.0 };
    }
    let kernel = KernelOptions { precision: Precision::Mixed, ..KernelOptions::default() };
    let (masses, at) = (Masses::Uniform(1.0), conditions(cell, start.positions.len()));
    let fresh = || build(&options(kernel, TruncationKind::Shift), &at).unwrap();
    let (mut one, mut forces) = (start.clone(), fresh());
    for _ in 0..36 {
        one.step(&mut forces, &masses).unwrap();
    }
    let expected = forces.statistics().builds;
    assert!((2..9).contains(&expected), "{expected}");
    let (mut all, mut forces) = (start, fresh());
    assert_eq!(all.stride(&mut forces, &masses, 36), 36);
    assert!(all == one);
    assert_eq!(forces.statistics().builds, expected);
}

#[test]
fn fused_steps_of_a_mixture_keep_the_energy() {
    let (cell, start) = liquid([8, 8, 8], 0.7, 0.05);
    let start = Fluid::start(cell, start);
    let masses = Masses::Uniform(1.0);
    let n = start.positions.len();
    let mixture = mixture_or_one(2, 2.3, n);
    for kernel in kernels() {
        let mut fluid = start.clone();
        let options = options(kernel, TruncationKind::Cut);
        let mut forces = built(&options, mixture.as_ref(), cell, n);
        // Velocities are half a step behind: half a kick brings them to the time of the positions.
        let energy = |fluid: &Fluid, forces: &mut PairForces| {
            let (f, energetics) = all(forces, cell, &fluid.positions, Want::ENERGY);
            let mut velocities = fluid.velocities.clone();
            kick(&mut velocities, &f, &masses, 0.5 * DT);
            let kinetic: f64 = velocities.iter().map(|v| 0.5 * v.length_squared()).sum();
            kinetic + energetics.conserved_potential.unwrap()
        };
        let melted = fluid.stride(&mut forces, &masses, 100);
        let mut energies = vec![energy(&fluid, &mut forces)];
        for _ in 0..4 {
            assert_eq!(fluid.stride(&mut forces, &masses, 50), 50);
            energies.push(energy(&fluid, &mut forces));
        }
        assert_eq!(melted, 100);
        let first = energies[0];
        for energy in &energies {
            let off = (energy - first).abs() / n as f64;
            assert!(off < 2e-3, "{kernel:?}: {energies:?}");
        }
    }
}

/// Takes a stride of some length, then single steps up to the step that fails.
///
/// Single steps with `fresh` forces must agree with the stride.
fn fails(start: &Fluid, fresh: impl Fn() -> PairForces, stride: u64) -> (u64, ForceError) {
    let masses = Masses::Uniform(1.0);
    let (mut fluid, mut forces) = (start.clone(), fresh());
    let mut done = fluid.stride(&mut forces, &masses, stride);
    let (mut single, mut of_single) = (start.clone(), fresh());
    for _ in 0..done {
        single.step(&mut of_single, &masses).unwrap();
    }
    assert!(fluid == single, "{done} of {stride} steps");
    loop {
        if let Err(error) = fluid.step(&mut forces, &masses) {
            return (done, error);
        }
        done += 1;
        assert!(done < 50, "nothing failed");
    }
}

#[test]
fn a_stride_leaves_what_is_not_finite_to_single_steps() {
    // Rows packed by each thread; and by all threads, then by the chunks of the step before.
    for k in [[8, 8, 8], [13, 14, 13]] {
        let (cell, positions) = liquid(k, 0.8, 0.1);
        let n = positions.len();
        let sound = Fluid::start(cell, positions);
        // An infinite velocity, a velocity that leads too far, and two particles that meet in one point after four steps.
        // The box has room for these two far from the others.
        let (mut nowhere, mut far, mut meeting) = (sound.clone(), sound.clone(), sound);
        nowhere.velocities[77].y = f64::INFINITY;
        far.velocities[77].y = 1e12;
        for (i, x) in [(77, -0.5), (78, 0.5)] {
            let outside = 3.0 * cell.lengths().x;
            meeting.positions[i] = DVec3::new(outside + 20.0 * x, outside, outside);
            meeting.velocities[i] = DVec3::X * (-5.0 * x / DT);
        }
        let roomy = PeriodicBox::new(6.0 * cell.lengths()).unwrap();
        // The same two alone.
        meeting.cell = roomy;
        let alone = Fluid {
            positions: meeting.positions[77..79].to_vec(),
            velocities: meeting.velocities[77..79].to_vec(),
            ..meeting.clone()
        };
        for kernel in kernels() {
            for (cell, start, least) in
                [(cell, &nowhere, 1), (cell, &far, 2), (roomy, &meeting, 4), (roomy, &alone, 4)]
            {
                let at = conditions(cell, start.positions.len());
                let fresh = || build(&options(kernel, TruncationKind::Shift), &at).unwrap();
                let expected = fails(start, fresh, 0);
                assert!(expected.0 >= least, "{expected:?}");
                // Strides that end before the failure, with it, and after it.
                for stride in [3, 4, 5, 6, 50] {
                    let found = fails(start, fresh, stride);
                    assert_eq!(found, expected, "{kernel:?}, {stride} steps");
                }
            }
            // The stride that failed at its first step changed nothing.
            let (mut all, mut forces) = (
                nowhere.clone(),
                build(&options(kernel, TruncationKind::Shift), &conditions(cell, n)).unwrap(),
            );
            assert_eq!(all.stride(&mut forces, &Masses::Uniform(1.0), 9), 0);
            assert!(all == nowhere);
        }
    }
}

#[test]
fn forces_without_a_list_in_that_order_take_no_strides() {
    let (cell, positions) = liquid([8, 8, 8], 0.8, 0.1);
    let start = Fluid::start(cell, positions);
    let base = options(KernelOptions::default(), TruncationKind::Shift);
    let canonical = ForceFieldOptions { canonical: true, ..base };
    let direct = ForceFieldOptions {
        neighbor: NeighborOptions { mode: ListMode::Direct, skin: None },
        ..base
    };
    let mut reference = ForceFieldOptions { neighbor: NeighborOptions::default(), ..base };
    reference.kernel.kernel = Kernel::Reference;
    let (same, each) = (Masses::Uniform(1.0), Masses::Each(vec![1.0; 512]));
    for (options, masses) in
        [(canonical, &same), (direct, &same), (reference, &same), (base, &each)]
    {
        let mut forces = build(&options, &conditions(cell, 512)).unwrap();
        let mut fluid = start.clone();
        assert_eq!(fluid.stride(&mut forces, masses, 20), 0, "{options:?}");
        assert!(fluid == start);
        assert_eq!(forces.statistics().evaluations, 0);
    }
    // A stride of two steps is too short to be worth the gathering of particles.
    let mixed = ForceFieldOptions {
        kernel: KernelOptions { precision: Precision::Mixed, ..base.kernel },
        ..base
    };
    let mut forces = build(&mixed, &conditions(cell, 512)).unwrap();
    assert_eq!(start.clone().stride(&mut forces, &same, 2), 0);
    assert_eq!(start.clone().stride(&mut forces, &same, 20), 20);
    let at = Configuration::at_rest(&cell, &start.positions);
    // An evaluation at other positions right after a stride builds a list of its own.
    let mut f = vec![DVec3::ZERO; 512];
    forces.evaluate(at, Part::All, Want::NOTHING, &mut f).unwrap();
    let mut fresh = build(&mixed, &conditions(cell, 512)).unwrap();
    let (expected, _) = all(&mut fresh, cell, &start.positions, Want::NOTHING);
    let size: f64 = expected.iter().map(|f| f.length()).fold(0.0, f64::max);
    for (f, e) in f.iter().zip(&expected) {
        assert!((*f - *e).length() < 1e-5 * size);
    }
}
