//! The moves that every step is a list of, and the one loop that runs a list over particles.
//!
//! ```text
//!   kick     v ← v + (h/m)·F        noise    v ← c·v + √((1 − c²)·T/m)·R
//!   drift    x ← x + h·v            scale    v ← f·v
//! ```
//!
//! A list is a function of one component of a particle: `|c, _| c.kick(a).drift(h)`. The loop runs the whole list while the
//! component is in a register. Every operation rounds once, so that registers of any width have the same bits, and so have single
//! steps and fused steps.

use glam::DVec3;

use crate::friction::{LANES, NoiseOfMass, NoiseOfStep};
use crate::lanes::{Aligned, Simd, WithSimd, in_lanes};
use crate::parallel::{for_each_piece_of_three, for_each_piece_pair};
use crate::{Masses, Own, State};

/// Particles that a list runs over at once, at most.
pub const BLOCK: usize = LANES;

/// Components that fill whole registers: the components of eight particles.
pub const GROUP: usize = 24;

/// One component of a particle on its way through a list.
#[derive(Clone, Copy)]
pub struct Component {
    x: f64,
    v: f64,
    force: f64,
    normal: f32,
    square: f64,
}

impl Component {
    /// v ← v + factor·F, with the factor h/m.
    #[inline(always)]
    #[must_use]
    pub fn kick(self, factor: f64) -> Self {
        Self { v: self.v + factor * self.force, ..self }
    }

    /// x ← x + h·v.
    #[inline(always)]
    #[must_use]
    pub fn drift(self, h: f64) -> Self {
        Self { x: self.x + h * self.v, ..self }
    }

    /// v ← factor·v.
    #[inline(always)]
    #[must_use]
    pub fn scale(self, factor: f64) -> Self {
        Self { v: self.v * factor, ..self }
    }

    /// Friction and noise; gives what v² gains.
    #[inline(always)]
    #[must_use]
    pub fn noise(self, noise: NoiseOfMass) -> Self {
        let v = noise.next(self.v, self.normal);
        Self { v, square: v * v - self.v * self.v, ..self }
    }

    /// Gives v².
    #[inline(always)]
    #[must_use]
    pub fn square(self) -> Self {
        Self { square: self.v * self.v, ..self }
    }
}

/// What a list reports besides positions and velocities, and the noise that it takes.
pub trait Report {
    /// Whether an upper bound of the steps is asked for.
    const BOUND: bool;
    /// Whether squares are asked for.
    const SQUARES: bool = false;

    /// The normal numbers of the particles: x, y and z of one after another.
    #[inline(always)]
    fn normals(&self) -> Aligned<[f32; 3 * BLOCK]> {
        Aligned([0.0; 3 * BLOCK])
    }

    /// Takes the squares that the list gives for the components of each particle.
    #[inline(always)]
    fn take(&mut self, squares: &[f64; 3 * BLOCK]) {
        let _ = squares;
    }
}

/// Nothing.
pub struct Nothing;

impl Report for Nothing {
    const BOUND: bool = false;
}

/// A bound of the steps.
pub struct Bound;

impl Report for Bound {
    const BOUND: bool = true;
}

/// Kinetic energies of the particles, ε: ½m, which the function gives, times the sum of the squares of three components.
pub struct Energies<'a, F>(pub F, pub &'a mut [f64]);

impl<F: Fn(usize) -> f64> Report for Energies<'_, F> {
    const BOUND: bool = false;
    const SQUARES: bool = true;

    #[inline(always)]
    fn take(&mut self, squares: &[f64; 3 * BLOCK]) {
        let all = self.1.iter_mut().zip(squares.as_chunks::<3>().0);
        for (k, (energy, [x, y, z])) in all.enumerate() {
            *energy = (self.0)(k) * (x + y + z);
        }
    }
}

/// Noise with the numbers of the particles, the kinetic energies that it puts in, and a bound of the steps.
pub struct Noise<'a, F>(pub NoiseOfStep, pub &'a [u32], pub Energies<'a, F>);

impl<F: Fn(usize) -> f64> Report for Noise<'_, F> {
    const BOUND: bool = true;
    const SQUARES: bool = true;

    #[inline(always)]
    fn normals(&self) -> Aligned<[f32; 3 * BLOCK]> {
        self.0.normals(self.1)
    }

    #[inline(always)]
    fn take(&mut self, squares: &[f64; 3 * BLOCK]) {
        self.2.take(squares);
    }
}

/// Particles that move, with the forces on them: three arrays of one length.
pub struct Moving<'a> {
    /// Positions, σ.
    pub positions: &'a mut [DVec3],
    /// Velocities, σ/τ.
    pub velocities: &'a mut [DVec3],
    /// Forces, ε/σ.
    pub forces: &'a [DVec3],
}

impl<'a> Moving<'a> {
    /// All particles of a state.
    pub fn of(state: &'a mut State) -> Self {
        let State { positions, velocities, forces, .. } = state;
        Self { positions, velocities, forces }
    }

    /// Kick: v ← v + (h/m)·F, with `h` in τ.
    pub fn kick(self, masses: &Masses, h: f64) {
        self.by_mass(masses, move |m| h / m, |c, factor| c.kick(factor));
    }

    /// Drift: x ← x + h·v, with `h` in τ.
    pub fn drift(self, h: f64) {
        self.all(move |c| c.drift(h));
    }

    /// Kick by `kick_h` and drift by `drift_h` in one pass over memory.
    pub fn kick_and_drift(self, masses: &Masses, kick_h: f64, drift_h: f64) {
        let list = move |c: Component, factor| c.kick(factor).drift(drift_h);
        self.by_mass(masses, move |m| kick_h / m, list);
    }

    /// Scaling: v ← factor·v.
    pub fn scale(self, factor: f64) {
        self.all(move |c| c.scale(factor));
    }

    /// Friction and noise of a step; returns the kinetic energy that all particles gain, ε.
    pub fn noise(self, noise: &NoiseOfStep, masses: &Masses, own: &Own) -> f64 {
        let mut gained = vec![0.0; self.positions.len()];
        let forces = self.forces;
        for_each_piece_of_three(
            self.positions,
            self.velocities,
            &mut gained,
            |first, positions, velocities, energies| {
                let forces = &forces[first..][..positions.len()];
                let moving = Moving { positions, velocities, forces };
                let numbers_from = own.first();
                in_lanes(WithNoise { noise, masses, numbers_from, first, moving, energies });
            },
        );
        own.sum_of(&gained, |gained| *gained)
    }

    /// Runs a list over all particles, by all threads.
    pub fn all(self, list: impl Fn(Component) -> Component + Copy + Sync) {
        self.pieces::<GROUP>(move |c, _| list(c));
    }

    /// Runs a list with one number for each mass.
    fn by_mass<T: Copy + Sync>(
        self,
        masses: &Masses,
        of: impl Fn(f64) -> T + Copy + Sync,
        list: impl Fn(Component, T) -> Component + Copy + Sync,
    ) {
        match masses {
            Masses::Uniform(mass) => {
                let of = of(*mass);
                self.all(move |c| list(c, of));
            }
            Masses::Each(masses) => {
                let masses = &masses[..];
                self.pieces::<3>(move |c, i| list(c, of(masses[i])));
            }
        }
    }

    fn pieces<const N: usize>(self, list: impl Fn(Component, usize) -> Component + Copy + Sync) {
        let forces = self.forces;
        for_each_piece_pair(self.positions, self.velocities, |first, positions, velocities| {
            let forces = &forces[first..][..positions.len()];
            let moving = Moving { positions, velocities, forces };
            in_lanes(Piece::<N, _> { first, moving, list });
        });
    }

    /// The particles in blocks, each with the number of its first.
    #[inline(always)]
    fn blocks(self) -> impl Iterator<Item = (usize, Moving<'a>)> {
        let velocities = self.velocities.chunks_mut(BLOCK);
        let both = self.positions.chunks_mut(BLOCK).zip(velocities).zip(self.forces.chunks(BLOCK));
        both.enumerate().map(|(block, ((positions, velocities), forces))| {
            (block * BLOCK, Moving { positions, velocities, forces })
        })
    }

    /// Runs a list over at most [`BLOCK`] particles by groups of N components, with the number of the particle in the block.
    ///
    /// Returns an upper bound of their steps |x − x_before|, σ.
    #[inline(always)]
    pub fn block<const N: usize, B: Report>(
        self,
        report: &mut B,
        list: impl Fn(Component, usize) -> Component + Copy,
    ) -> f64 {
        let n = self.positions.len();
        assert!(n <= BLOCK && self.velocities.len() == n && self.forces.len() == n, "one block");
        let Aligned(normals) = &report.normals();
        let Aligned(squares) = &mut Aligned([0.0; 3 * BLOCK]);
        let (mut longest, mut longest_of_rest) = ([0.0; N], [0.0; 3]);
        let (x, x_rest) = components_mut(self.positions).as_chunks_mut::<N>();
        let (v, v_rest) = components_mut(self.velocities).as_chunks_mut::<N>();
        let (f, f_rest) = components(self.forces).as_chunks::<N>();
        let groups = x.iter_mut().zip(v).zip(f);
        let whole = groups.len();
        let beside = normals.as_chunks::<N>().0.iter().zip(squares.as_chunks_mut::<N>().0);
        for (g, (((x, v), f), (normals, squares))) in groups.zip(beside).enumerate() {
            let list = move |c, k| list(c, g * (N / 3) + k);
            run::<N, B>(list, x, v, (f, normals), squares, &mut longest);
        }
        let (x, v) = (x_rest.as_chunks_mut::<3>().0, v_rest.as_chunks_mut().0);
        let rest = x.iter_mut().zip(v).zip(f_rest.as_chunks().0);
        let beside = normals.as_chunks().0.iter().zip(squares.as_chunks_mut().0);
        let beside = beside.skip(whole * (N / 3));
        for (k, (((x, v), f), (normals, squares))) in rest.zip(beside).enumerate() {
            let list = move |c, _| list(c, whole * (N / 3) + k);
            run::<3, B>(list, x, v, (f, normals), squares, &mut longest_of_rest);
        }
        report.take(squares);
        // The factor covers the rounding of the bound.
        let of_rest = DVec3::from_array(longest_of_rest);
        longest_along_axes(longest).max(of_rest).length() * (1.0 + 1e-12)
    }
}

/// Runs a list over some components of one particle after another, and keeps the longest step of each.
// Arrays that are written are arguments of their own: in a tuple they may overlap, and the longest steps leave the registers.
#[inline(always)]
fn run<const N: usize, B: Report>(
    list: impl Fn(Component, usize) -> Component,
    x: &mut [f64; N],
    v: &mut [f64; N],
    (f, normals): (&[f64; N], &[f32; N]),
    squares: &mut [f64; N],
    longest: &mut [f64; N],
) {
    for k in 0..N {
        let before = Component { x: x[k], v: v[k], force: f[k], normal: normals[k], square: 0.0 };
        let after = list(before, k / 3);
        if B::BOUND {
            longest[k] = (after.x - before.x).abs().max(longest[k]);
        }
        x[k] = after.x;
        v[k] = after.v;
        if B::SQUARES {
            squares[k] = after.square;
        }
    }
}

/// The longest steps along x, y and z.
// The loops have lengths that a compiler knows, so that the steps stay in registers before them.
#[inline(always)]
fn longest_along_axes<const N: usize>(mut longest: [f64; N]) -> DVec3 {
    let mut half = N / 2;
    while half >= 3 {
        for k in 0..half {
            longest[k] = larger(longest[k + half], longest[k]);
        }
        half /= 2;
    }
    DVec3::new(longest[0], longest[1], longest[2])
}

/// The larger of two numbers; the second where one is no number.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The kick v ← v + (h/m)·F of the sites of a molecule whose first is particle `first`, by this thread.
#[inline]
pub fn kick(masses: &Masses, first: usize, v: &mut [DVec3], forces: &[DVec3], h: f64) {
    let kick = |v: &mut [DVec3], forces: &[DVec3], factor| {
        for (v, force) in components_mut(v).iter_mut().zip(components(forces)) {
            *v =
                Component { x: 0.0, v: *v, force: *force, normal: 0.0, square: 0.0 }.kick(factor).v;
        }
    };
    match masses {
        Masses::Uniform(m) => kick(v, forces, h / m),
        Masses::Each(m) => {
            for ((v, f), m) in v.iter_mut().zip(forces).zip(&m[first..]) {
                kick(std::slice::from_mut(v), std::slice::from_ref(f), h / m);
            }
        }
    }
}

/// The drift x ← x + h·v of the sites of a molecule, by this thread.
#[inline]
pub fn drift(x: &mut [DVec3], v: &[DVec3], h: f64) {
    for (x, v) in components_mut(x).iter_mut().zip(components(v)) {
        *x = Component { x: *x, v: *v, force: 0.0, normal: 0.0, square: 0.0 }.drift(h).x;
    }
}

/// The components of vectors, one after another.
#[inline(always)]
fn components(vectors: &[DVec3]) -> &[f64] {
    bytemuck::cast_slice(vectors)
}

/// The components of vectors, one after another.
#[inline(always)]
fn components_mut(vectors: &mut [DVec3]) -> &mut [f64] {
    bytemuck::cast_slice_mut(vectors)
}

/// A list over some of all particles, from the number `first` on.
struct Piece<'a, const N: usize, L> {
    first: usize,
    moving: Moving<'a>,
    list: L,
}

impl<const N: usize, L: Fn(Component, usize) -> Component + Copy> WithSimd for Piece<'_, N, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let list = self.list;
        for (block, moving) in self.moving.blocks() {
            let first = self.first + block;
            moving.block::<N, _>(&mut Nothing, move |c, k| list(c, first + k));
        }
    }
}

/// Friction and noise on some of all particles, from the number `first` on.
struct WithNoise<'a> {
    noise: &'a NoiseOfStep,
    masses: &'a Masses,
    /// The number of the particle with the index 0.
    numbers_from: usize,
    first: usize,
    moving: Moving<'a>,
    energies: &'a mut [f64],
}

impl WithNoise<'_> {
    /// Acts, where `of` gives friction and noise on a particle.
    #[inline(always)]
    fn act<const N: usize>(self, of: impl Fn(usize) -> NoiseOfMass) {
        let energies = self.energies.chunks_mut(BLOCK);
        for ((block, moving), energies) in self.moving.blocks().zip(energies) {
            let first = self.first + block;
            let numbers: [u32; BLOCK] =
                std::array::from_fn(|k| (self.numbers_from + first + k) as u32);
            let half_mass = |k| of(first + k).half_mass();
            let mut noise = Noise(*self.noise, &numbers, Energies(half_mass, energies));
            moving.block::<N, _>(&mut noise, |c, k| c.noise(of(first + k)));
        }
    }
}

impl WithSimd for WithNoise<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        match self.masses {
            Masses::Uniform(mass) => {
                let of = self.noise.on(*mass);
                self.act::<GROUP>(|_| of);
            }
            Masses::Each(masses) => {
                let noise = self.noise;
                self.act::<3>(|i| noise.on(masses[i]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Streams;
    use crate::{FrictionAndNoise, exact};

    fn vectors(from: usize, n: usize, scale: f64) -> Vec<DVec3> {
        let wave = |k: usize| (k as f64 * 12.9898).sin();
        let at = |k: usize| DVec3::new(wave(k), wave(k + 700), wave(k + 1400)) * scale;
        (from..from + n).map(at).collect()
    }

    /// The textbook, vector by vector.
    #[test]
    fn lists_have_the_bits_of_their_moves_one_by_one_for_any_number_of_particles() {
        for n in [0, 1, 7, 8, 47, 48, 49, 1001] {
            let each = Masses::Each((0..n).map(|i| 1.0 + 0.1 * i as f64).collect());
            for masses in [Masses::Uniform(1.5), each] {
                let (forces, start) = (vectors(333, n, 50.0), vectors(0, n, 10.0));
                let run = |list: &dyn Fn(Moving<'_>)| {
                    let (mut x, mut v) = (start.clone(), vectors(99, n, 1.0));
                    list(Moving { positions: &mut x, velocities: &mut v, forces: &forces });
                    (x, v)
                };
                let (mut x, mut v) = (start.clone(), vectors(99, n, 1.0));
                for i in 0..n {
                    v[i] += (0.002 / masses.of(i)) * forces[i];
                }
                assert_eq!(run(&|m| m.kick(&masses, 0.002)), (x.clone(), v.clone()), "{n}");
                for i in 0..n {
                    x[i] += 0.004 * v[i];
                }
                assert_eq!(run(&|m| m.kick_and_drift(&masses, 0.002, 0.004)), (x, v.clone()));
                v = vectors(99, n, 1.0).iter().map(|v| *v * 0.7).collect();
                assert_eq!(run(&|m| m.scale(0.7)), (start.clone(), v));
            }
        }
    }

    #[test]
    fn noise_on_all_particles_has_the_bits_of_noise_on_each() {
        let noise = FrictionAndNoise {
            friction: 0.7,
            temperature: 0.9.into(),
            noise: Streams::new(5).noise("langevin"),
        };
        let of_step = noise.in_step(12, 0.004);
        for n in [1, 47, 100, 1001] {
            let each =
                Masses::Each((0..n).map(|i| if i == 3 { f64::INFINITY } else { 2.0 }).collect());
            for masses in [Masses::Uniform(2.0), each] {
                let (mut x, mut v) = (vectors(0, n, 1.0), vectors(99, n, 1.0));
                let forces = vectors(333, n, 50.0);
                let moving = Moving { positions: &mut x, velocities: &mut v, forces: &forces };
                let gained = moving.noise(&of_step, &masses, &Own::all_of(n));
                let before = vectors(99, n, 1.0);
                let mut each = Vec::new();
                for i in 0..n {
                    let (of, Aligned(normals)) =
                        (of_step.on(masses.of(i)), of_step.normals(&[i as u32]));
                    for axis in 0..3 {
                        assert_eq!(v[i][axis], of.next(before[i][axis], normals[axis]));
                    }
                    let squares =
                        [0, 1, 2].map(|axis| v[i][axis].powi(2) - before[i][axis].powi(2));
                    each.push(of.half_mass() * (squares[0] + squares[1] + squares[2]));
                }
                assert_eq!((x, gained), (vectors(0, n, 1.0), exact::total(&each)), "{n}");
            }
        }
    }

    #[test]
    fn the_bound_of_steps_holds_for_the_particle_with_the_longest_step() {
        for n in [1, 3, 8, 47] {
            for fastest in 0..n {
                let (start, forces) = (vectors(0, n, 1e4), vectors(333, n, 50.0));
                let (mut x, mut v) = (start.clone(), vectors(99, n, 1.0));
                v[fastest] *= 7.0;
                let moving = Moving { positions: &mut x, velocities: &mut v, forces: &forces };
                let bound = moving.block::<GROUP, _>(&mut Bound, |c, _| c.kick(0.002).drift(0.004));
                let steps = x.iter().zip(&start).map(|(x, x0)| (x - x0).length());
                let longest = steps.fold(0.0, f64::max);
                assert!((longest..1.8 * longest).contains(&bound), "{n} {fastest}");
            }
        }
    }
}
