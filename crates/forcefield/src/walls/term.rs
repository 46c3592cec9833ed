//! All walls of a slit as one force term: where their planes stand, what they exert, and what hits at them do.

use lennard_core::exact::exact_sums;
use lennard_core::parallel::for_each_piece;
use lennard_core::random::{CounterRng, NoiseStream};
use lennard_core::{
    Axis, Configuration, DMat3, DVec3, Energetics, ForceError, ForceProperties, ForceTerm, Own,
    Part, PeriodicBox, Persist, RestoreError, StateReader, StateWriter, WallReading, Want,
};

use super::{Hit, HitRule, Rebound, Surface, WallContext, WallOptions};

/// Room in σ that the walls take beyond the cutoff: soft walls let particles pass the plane by up to half of it.
pub const SHALLOWEST_ROOM: f64 = 0.1;

/// A particle that arrives by no more than so many kicks of the flight rests at a plane that takes energy.
pub const KICKS_OF_REST: f64 = 1.0 + 1e-9;

/// The planes of a pair of walls along one axis.
///
/// The box stays periodic. Along the axis it is longer than the slit by the thickness of the walls, half at each end:
///
/// ```text
/// 0      lower                       upper      L
/// |######|            slit           |######|
///  ^ thickness/2                       ^ thickness/2
/// ```
///
/// A thickness above the cutoff keeps every particle out of reach of the periodic images across the walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlitPlanes {
    /// The axis of the normal: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Coordinate of the lower plane, σ.
    pub lower: f64,
    /// Coordinate of the upper plane, σ.
    pub upper: f64,
    /// How far behind a plane a particle may be before it is in reach of its images, σ.
    pub room: f64,
}

impl SlitPlanes {
    /// The planes of walls of a thickness in a box, for forces that end at `r_cut`; all in σ.
    #[must_use]
    pub fn new(cell: &PeriodicBox, axis: usize, thickness: f64, r_cut: f64) -> Self {
        Self {
            axis,
            lower: 0.5 * thickness,
            upper: cell.lengths()[axis] - 0.5 * thickness,
            room: 0.5 * (thickness - r_cut).max(0.0),
        }
    }

    /// The distance between the planes, σ.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.upper - self.lower
    }
}

/// Two walls, at both ends of an axis.
#[derive(Debug, Clone)]
pub struct WallPair {
    planes: SlitPlanes,
    /// What the walls at the lower and at the upper end do.
    surfaces: [Surface; 2],
}

impl WallPair {
    /// Walls of a kind at these planes.
    #[must_use]
    pub fn new(options: &WallOptions, planes: SlitPlanes, context: &WallContext) -> Self {
        Self { planes, surfaces: [false, true].map(|is_upper| options.surface(context, is_upper)) }
    }

    /// Distance of a coordinate from the planes, σ: positive between them.
    fn distances(&self, r: DVec3) -> [f64; 2] {
        let x = r[self.planes.axis];
        [x - self.planes.lower, self.planes.upper - x]
    }

    /// Whether a wall is hit on the way of a flight, and not at its end.
    fn is_hit_on_the_way(&self) -> bool {
        let on_the_way = |s: &Surface| s.rule().is_some_and(HitRule::is_on_the_way);
        self.surfaces.iter().any(on_the_way)
    }

    /// Whether a wall acts in flights: it is hit, or it has a dashpot.
    fn bounds_flight(&self) -> bool {
        let is_hit = |s: &Surface| s.rule().is_some_and(|rule| rule != HitRule::ByContacts);
        let bounds = |s: &Surface| is_hit(s) || s.dashpot().is_some();
        self.surfaces.iter().any(bounds)
    }

    /// Whether contacts are to solve for a plane.
    fn needs_solved_contacts(&self) -> bool {
        let by_contacts = |s: &Surface| s.rule() == Some(HitRule::ByContacts);
        self.surfaces.iter().any(by_contacts)
    }
}

/// The walls of a slit, a duct or a closed box: one pair of walls per axis at most.
///
/// Walls that exert forces add F_z(z) of both planes to each particle. Walls that are hit bound the drift: each particle
/// flies along a straight line to the plane, takes the velocity of [`super::Rebound`], and flies on.
///
/// The virial of walls is 0 here: Σ z·F of a wall depends on the origin. The virial of a walled fluid is the virial of its
/// pairs alone.
#[derive(Debug, Clone)]
pub struct Walls {
    pairs: Vec<WallPair>,
    /// Lower and upper wall of each pair, in the order of the pairs.
    readings: Vec<WallReading>,
    noise: NoiseStream,
    /// Which particles this process keeps, where ranks share them.
    own: Option<Own>,
}

/// What all walls felt of some particles, and what those felt.
#[derive(Debug, Clone, Copy, Default)]
struct Felt {
    energy: f64,
    laplacian: f64,
    /// Force on each wall along its outward normal, by pair and end.
    forces: [[f64; 2]; 3],
    /// The first particle beyond a wall: index, pair, end, depth.
    beyond: Option<(usize, usize, usize, f64)>,
}

impl Walls {
    /// Walls that have felt nothing; walls at a temperature draw from `noise`.
    ///
    /// # Panics
    /// Where two pairs have the same axis: that is a bug of the caller.
    #[must_use]
    pub fn new(pairs: Vec<WallPair>, noise: NoiseStream) -> Self {
        for (i, pair) in pairs.iter().enumerate() {
            let same_axis = |other: &WallPair| other.planes.axis == pair.planes.axis;
            assert!(!pairs[..i].iter().any(same_axis), "one pair of walls per axis");
        }
        let readings = pairs.iter().flat_map(|pair| {
            let SlitPlanes { axis, lower, upper, .. } = pair.planes;
            [WallReading::new(axis, false, lower), WallReading::new(axis, true, upper)]
        });
        Self { readings: readings.collect(), pairs, noise, own: None }
    }

    /// What the plane with this index in [`ForceTerm::walls`] does to particles.
    #[must_use]
    pub fn surface(&self, index: usize) -> &Surface {
        &self.pairs[index / 2].surfaces[index % 2]
    }

    /// Force of all walls on a particle at `r`, ε/σ.
    #[must_use]
    fn force_of_all(&self, r: DVec3) -> DVec3 {
        let mut force = DVec3::ZERO;
        for pair in &self.pairs {
            let [lower, upper] = pair.distances(r);
            force[pair.planes.axis] += force_at(&pair.surfaces[0], lower);
            force[pair.planes.axis] -= force_at(&pair.surfaces[1], upper);
        }
        force
    }

    /// What one particle makes the walls feel.
    fn felt_of(&self, i: usize, r: DVec3) -> Felt {
        let mut felt = Felt::default();
        for (p, pair) in self.pairs.iter().enumerate() {
            for (end, z) in pair.distances(r).into_iter().enumerate() {
                let Surface::Exerts(wall) = &pair.surfaces[end] else {
                    continue;
                };
                let deepest = match wall.contact.is_some() {
                    true => -pair.planes.room,
                    false => 0.0,
                };
                if z <= deepest {
                    felt.beyond = felt.beyond.or(Some((i, p, end, -z)));
                } else if z < wall.reach {
                    let point = wall.at(z);
                    felt.energy += point.energy;
                    felt.laplacian += point.curvature;
                    felt.forces[p][end] += point.force;
                }
            }
        }
        felt
    }

    /// What all particles make the walls feel, by exact sums.
    fn felt_of_all(&self, positions: &[DVec3]) -> Felt {
        let (sums, beyond) = exact_sums(positions.len(), |range, sums| {
            let mut beyond = None;
            for i in range {
                let felt = self.felt_of(i, positions[i]);
                let [x, y, z] = felt.forces;
                sums.add([felt.energy, felt.laplacian, x[0], x[1], y[0], y[1], z[0], z[1]]);
                beyond = beyond.or(felt.beyond);
            }
            beyond
        });
        let team = self.own.as_ref().and_then(Own::team);
        let [energy, laplacian, forces @ ..] = sums.over(team).values();
        Felt {
            energy,
            laplacian,
            forces: std::array::from_fn(|p| [forces[2 * p], forces[2 * p + 1]]),
            beyond: beyond.into_iter().flatten().next(),
        }
    }
}

impl Walls {
    /// The next hit of a particle that flies straight from `x` (σ) with `v` (σ/τ) for `left` τ. It gives the time until then, τ, and
    /// the index of the plane in [`lennard_core::ForceTerm::walls`].
    #[must_use]
    pub fn next_hit(&self, x: DVec3, v: DVec3, left: f64) -> Option<(f64, usize)> {
        self.first_hit(x, left, |z, axis, outward| {
            let towards = outward * v[axis];
            (towards > 0.0).then(|| (z / towards).max(0.0))
        })
    }

    /// Random numbers of a particle in a flight that begins after `step` steps; a second flight of a step draws others.
    #[must_use]
    pub fn noise_of(&self, particle: usize, step: u64, is_later: bool) -> CounterRng {
        let counter = 2 * step + u64::from(is_later);
        self.noise.at(counter, particle as u32)
    }

    /// Counts the momentum, m·σ/τ along the outward normal, that a particle hands to a plane where it comes to rest.
    pub fn take_momentum(&mut self, index: usize, momentum: f64) {
        self.readings[index].impulse += momentum;
    }

    /// Counts a hit that hands this momentum to a plane, m·σ/τ along the outward normal.
    pub fn count_hit(&mut self, index: usize, momentum: f64) {
        self.take_momentum(index, momentum);
        self.readings[index].hits += 1;
    }

    /// Takes the speed across a plane off a particle, and hands the momentum to the wall.
    pub fn stop(&mut self, index: usize, v: &mut DVec3, mass: f64) {
        let reading = self.readings[index];
        self.take_momentum(index, reading.outward() * mass * v[reading.axis]);
        v[reading.axis] = 0.0;
    }

    /// Whether a particle that arrives at a plane with an outward speed rests there. The forces change its velocity by `kick` in a
    /// flight.
    ///
    /// It rests where the plane takes energy and the kick alone has brought the speed. That kick did no work on a particle at rest.
    #[must_use]
    pub fn rests(&self, index: usize, towards: f64, kick: DVec3) -> bool {
        let reading = &self.readings[index];
        self.takes_energy(index)
            && towards <= KICKS_OF_REST * reading.outward() * kick[reading.axis]
    }

    /// Whether hits of a plane take energy: its restitution is below 1.
    #[must_use]
    pub fn takes_energy(&self, index: usize) -> bool {
        self.surface(index).restitution().is_some_and(|e| e < 1.0)
    }

    /// The hit of a particle at a plane: it bounces, or it rests where the `kick` of the flight alone, σ/τ, pressed it there.
    ///
    /// Returns the kinetic energy put in, ε: nothing where it rests.
    pub fn hit(
        &mut self,
        index: usize,
        v: &mut DVec3,
        mass: f64,
        kick: DVec3,
        random: &mut CounterRng,
    ) -> f64 {
        let reading = &self.readings[index];
        if self.rests(index, reading.outward() * v[reading.axis], kick) {
            self.stop(index, v, mass);
            return 0.0;
        }
        let before = v.length_squared();
        self.strike(index, v, mass, random);
        0.5 * mass * (v.length_squared() - before)
    }

    /// Gives a particle at a plane the velocity after the hit, and the wall the momentum.
    pub fn strike(&mut self, index: usize, v: &mut DVec3, mass: f64, random: &mut CounterRng) {
        let Surface::Hit(wall) = &self.pairs[index / 2].surfaces[index % 2] else {
            return;
        };
        let reading = &self.readings[index];
        let (axis, outward) = (reading.axis, reading.outward());
        let after = wall.leave(Hit { axis, outward, velocity: *v, mass, random });
        self.count_hit(index, outward * mass * (v[axis] - after[axis]));
        *v = after;
    }

    /// Takes off what rounding put behind a plane.
    pub fn clamp_between_planes(&self, x: &mut DVec3) {
        for pair in self.pairs.iter().filter(|pair| pair.is_hit_on_the_way()) {
            let SlitPlanes { axis, lower, upper, .. } = pair.planes;
            x[axis] = x[axis].clamp(lower, upper);
        }
    }

    /// The earliest time within `left` τ at which a particle at x arrives at a wall that is hit, with the index of the wall.
    ///
    /// `time` gives the time of arrival at a plane from the distance, the axis and the outward direction along it.
    pub fn first_hit(
        &self,
        x: DVec3,
        left: f64,
        time: impl Fn(f64, usize, f64) -> Option<f64>,
    ) -> Option<(f64, usize)> {
        let mut first: Option<(f64, usize)> = None;
        for (p, pair) in self.pairs.iter().enumerate() {
            for (end, z) in pair.distances(x).into_iter().enumerate() {
                if !pair.surfaces[end].rule().is_some_and(HitRule::is_on_the_way) {
                    continue;
                }
                let arrival = time(z, pair.planes.axis, [-1.0, 1.0][end]);
                if let Some(time) = arrival.filter(|time| *time <= left)
                    && first.is_none_or(|(earlier, _)| time < earlier)
                {
                    first = Some((time, 2 * p + end));
                }
            }
        }
        first
    }
}

/// Force of a wall on a particle at distance z, ε/σ.
fn force_at(surface: &Surface, z: f64) -> f64 {
    match surface {
        Surface::Exerts(wall) if z < wall.reach => wall.at(z).force,
        Surface::Exerts(_) | Surface::Hit(_) => 0.0,
    }
}

impl ForceTerm for Walls {
    lennard_core::evaluate_by_adding!();

    /// Walls change quickly in space: their force belongs to the near part.
    fn add(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        _scratch: &mut Vec<DVec3>,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        let positions = at.positions;
        let mut felt = Felt::default();
        // Walls that are only hit feel nothing here.
        if part != Part::Far
            && self.pairs.iter().any(|pair| pair.surfaces.iter().any(Surface::exerts))
        {
            felt = self.felt_of_all(positions);
            let beyond = felt.beyond.map_or(Ok(()), |(i, pair, end, depth)| {
                Err(ForceError::BeyondWall {
                    particle: i + self.own.as_ref().map_or(0, Own::first),
                    axis: Axis::ALL[self.pairs[pair].planes.axis].name(),
                    end: ["lower", "upper"][end],
                    depth,
                })
            });
            self.own.as_ref().map_or(beyond.clone(), |own| own.agree(beyond))?;
            let walls = &*self;
            for_each_piece(forces, |first, chunk| {
                for (f, r) in chunk.iter_mut().zip(&positions[first..]) {
                    *f += walls.force_of_all(*r);
                }
            });
            let pairs = felt.forces.iter().flatten();
            for (reading, force) in self.readings.iter_mut().zip(pairs) {
                reading.force = *force;
            }
        }
        let per_particle = |r: &DVec3| -> (f64, DMat3) {
            let alone = self.felt_of(0, *r);
            (alone.energy, DMat3::ZERO)
        };
        let each = match part {
            Part::Far => vec![(0.0, DMat3::ZERO); positions.len()],
            Part::All | Part::Near if want.per_particle => {
                positions.iter().map(per_particle).collect()
            }
            Part::All | Part::Near => Vec::new(),
        };
        Ok(Energetics {
            per_particle: want.per_particle.then_some(each),
            ..Energetics::of(want, felt.energy, DMat3::ZERO, felt.laplacian)
        })
    }

    fn force_on(&self, particle: usize, at: Configuration<'_>) -> DVec3 {
        self.force_of_all(at.positions[particle])
    }

    fn properties(&self) -> ForceProperties {
        let mut breaks_momentum = [false; 3];
        for pair in &self.pairs {
            breaks_momentum[pair.planes.axis] = true;
            let drags = |s: &Surface| matches!(s, Surface::Hit(Rebound::Draws { .. }));
            if pair.surfaces.iter().any(drags) {
                breaks_momentum = [true; 3];
            }
        }
        ForceProperties {
            splits: true,
            breaks_momentum,
            bounds_flight: self.pairs.iter().any(WallPair::bounds_flight),
            needs_solved_contacts: self.pairs.iter().any(WallPair::needs_solved_contacts),
            ..ForceProperties::default()
        }
    }

    fn keep(&mut self, own: &Own) {
        self.own = Some(own.clone());
    }

    fn walls(&self) -> &[WallReading] {
        &self.readings
    }
}

impl Persist for Walls {
    fn save(&self, to: &mut StateWriter<'_>) {
        let all = |of: fn(&WallReading) -> f64| self.readings.iter().map(of).collect::<Vec<_>>();
        to.put_f64("impulse", &all(|r| r.impulse));
        to.put_f64("force", &all(|r| r.force));
        let hits: Vec<u64> = self.readings.iter().map(|r| r.hits).collect();
        to.put_u64("hits", &hits);
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        let (impulses, forces, hits) =
            (from.f64("impulse")?, from.f64("force")?, from.u64("hits")?);
        if [impulses.len(), forces.len(), hits.len()] != [self.readings.len(); 3] {
            return Err(from.misfit("impulse", "another number of walls"));
        }
        for (i, reading) in self.readings.iter_mut().enumerate() {
            reading.impulse = impulses[i];
            reading.force = forces[i];
            reading.hits = hits[i];
        }
        Ok(())
    }
}
