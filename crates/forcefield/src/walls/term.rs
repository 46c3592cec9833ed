//! All walls of a slit as one force term.

use lennard_core::exact::exact_sums;
use lennard_core::parallel::for_each_piece;
use lennard_core::random::NoiseStream;
use lennard_core::{
    Axis, Configuration, DMat3, DVec3, Energetics, ForceError, ForceProperties, ForceTerm, Part,
    Persist, RestoreError, StateReader, StateWriter, WallReading, Want,
};

use super::{HitRule, SlitPlanes, Surface, WallContext, WallOptions};

/// Two walls, at both ends of an axis.
#[derive(Debug, Clone)]
pub struct WallPair {
    pub(super) planes: SlitPlanes,
    /// What the walls at the lower and at the upper end do.
    pub(super) surfaces: [Surface; 2],
}

impl WallPair {
    /// Walls of a kind at these planes.
    #[must_use]
    pub fn new(options: &WallOptions, planes: SlitPlanes, context: &WallContext) -> Self {
        Self { planes, surfaces: [false, true].map(|is_upper| options.surface(context, is_upper)) }
    }

    /// Distance of a coordinate from the planes, σ: positive between them.
    pub(super) fn distances(&self, r: DVec3) -> [f64; 2] {
        let x = r[self.planes.axis];
        [x - self.planes.lower, self.planes.upper - x]
    }

    /// Whether a wall is hit on the way of a flight, and not at its end.
    pub(super) fn is_hit_on_the_way(&self) -> bool {
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
    pub(super) pairs: Vec<WallPair>,
    /// Lower and upper wall of each pair, in the order of the pairs.
    pub(super) readings: Vec<WallReading>,
    pub(super) noise: NoiseStream,
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
        Self { readings: readings.collect(), pairs, noise }
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
                let deepest = match wall.acts_behind_plane() {
                    true => -pair.planes.room,
                    false => 0.0,
                };
                if z <= deepest {
                    felt.beyond = felt.beyond.or(Some((i, p, end, -z)));
                } else if z < wall.reach() {
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
        let [energy, laplacian, forces @ ..] = sums.values();
        Felt {
            energy,
            laplacian,
            forces: std::array::from_fn(|p| [forces[2 * p], forces[2 * p + 1]]),
            beyond: beyond.into_iter().flatten().next(),
        }
    }
}

/// Force of a wall on a particle at distance z, ε/σ.
fn force_at(surface: &Surface, z: f64) -> f64 {
    match surface {
        Surface::Exerts(wall) if z < wall.reach() => wall.at(z).force,
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
            if let Some((particle, pair, end, depth)) = felt.beyond {
                return Err(ForceError::BeyondWall {
                    particle,
                    axis: Axis::ALL[self.pairs[pair].planes.axis].name(),
                    end: ["lower", "upper"][end],
                    depth,
                });
            }
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
            let drags = |s: &Surface| matches!(s, Surface::Hit(wall) if wall.drags());
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
