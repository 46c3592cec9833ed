//! The flight of single particles between walls, one after the other.

use lennard_core::{DVec3, Drifted, Flight, ForceTerm, StepError, WallReading};
use lennard_forcefield::{ContactLaw, HitRule, Walls};

use super::lines::Lines;
use super::parabola::Parabola;

/// What planes do in flights, by their index.
struct Planes {
    on_the_way: Vec<WallReading>,
    /// Whether particles fly along parabolas from hit to hit.
    along_parabolas: bool,
    at_end: Vec<(usize, HitRule)>,
    dashpots: Vec<(usize, ContactLaw)>,
}

impl Planes {
    fn of(walls: &Walls) -> Self {
        let all = 0..walls.walls().len();
        let rules = all.clone().filter_map(|plane| Some((plane, walls.surface(plane).rule()?)));
        let rules: Vec<_> = rules.collect();
        let on_the_way = rules.iter().filter(|(_, rule)| rule.is_on_the_way());
        Self {
            on_the_way: on_the_way.map(|(plane, _)| walls.walls()[*plane]).collect(),
            along_parabolas: rules.iter().any(|(_, rule)| *rule == HitRule::OnParabolas),
            at_end: rules.into_iter().filter(|(_, rule)| rule.is_at_end()).collect(),
            dashpots: all
                .filter_map(|plane| Some((plane, *walls.surface(plane).dashpot()?)))
                .collect(),
        }
    }
}

/// Flies all particles.
pub(super) fn fly(walls: &mut Walls, flight: Flight<'_>) -> Result<Drifted, StepError> {
    let planes = Planes::of(walls);
    let Flight { cell, positions, velocities, forces, masses, h, step, is_later } = flight;
    let (is_damped, acts_at_end) = (!planes.dashpots.is_empty(), !planes.at_end.is_empty());
    let mut heat = 0.0;
    for i in (0..positions.len()).filter(|i| !masses.is_held(*i)) {
        let (mass, force) = (masses.of(i), forces[i]);
        let (x, v) = (&mut positions[i], &mut velocities[i]);
        let start = *x;
        if is_damped {
            heat += damp(walls, &planes, start, v, mass, 0.5 * h);
        }
        let end = start + h * *v;
        if planes.along_parabolas {
            let random = walls.noise_of(i, step, is_later);
            let free = force / mass;
            heat += Parabola { walls, x, v, mass, free, h, random, heat: 0.0 }.fly()?;
        } else if end.is_finite() && planes.on_the_way.iter().any(|p| p.distance(end) <= 0.0) {
            let flight = Flight {
                cell,
                positions: &mut positions[i..=i],
                velocities: &mut velocities[i..=i],
                forces: &forces[i..=i],
                masses,
                h,
                step,
                is_later,
            };
            heat += Lines::fly_one(walls, flight, i)?;
        } else {
            *x = end;
        }
        if acts_at_end {
            let kick = h / mass * force;
            let now = (start, &mut positions[i]);
            heat += end_one(walls, &planes, now, &mut velocities[i], kick, h, mass);
        }
        if is_damped {
            heat += damp(walls, &planes, positions[i], &mut velocities[i], mass, 0.5 * h);
        }
    }
    Ok(Drifted::with_heat(heat))
}

/// Mirrors or projects one particle that has flown from `start` to `x` in a time h; returns the kinetic energy put in.
///
/// The velocity of kick-drift-kick lacks its closing half kick here. The mirror takes the whole-step velocity v + `kick`/2,
/// which is exact in a constant field, and leaves v′ − `kick`/2. A particle that the kick of the step alone, σ/τ, pressed to a
/// plane that takes energy rests there, and no heat is counted.
fn end_one(
    walls: &mut Walls,
    planes: &Planes,
    (start, x): (DVec3, &mut DVec3),
    v: &mut DVec3,
    kick: DVec3,
    h: f64,
    mass: f64,
) -> f64 {
    let (half_kick, mut heat) = (0.5 * kick, 0.0);
    for (plane, rule) in &planes.at_end {
        let reading = walls.walls()[*plane];
        let z = reading.distance(*x);
        if z >= 0.0 {
            continue;
        }
        let (axis, outward) = (reading.axis, reading.outward());
        match rule {
            HitRule::Mirrored { restitution } => {
                x[axis] = reading.position + outward * restitution * z;
                v[axis] += half_kick[axis];
                if walls.rests(*plane, outward * v[axis], kick) {
                    x[axis] = reading.position;
                    walls.stop(*plane, v, mass);
                }
                if outward * v[axis] > 0.0 {
                    let (towards, before) = (v[axis], v.length_squared());
                    v[axis] *= -restitution;
                    walls.count_hit(*plane, outward * mass * (towards - v[axis]));
                    heat += 0.5 * mass * (v.length_squared() - before);
                }
                v[axis] -= half_kick[axis];
            }
            HitRule::Projected => {
                let before = v[axis];
                x[axis] = reading.position;
                v[axis] = (x[axis] - start[axis]) / h;
                let momentum = outward * mass * (before - v[axis]);
                if walls.rests(*plane, outward * before, kick) {
                    walls.take_momentum(*plane, momentum);
                } else {
                    walls.count_hit(*plane, momentum);
                    heat += 0.5 * mass * (v[axis] * v[axis] - before * before);
                }
            }
            HitRule::OnLines | HitRule::OnParabolas | HitRule::ByContacts => {}
        }
    }
    heat
}

/// Lets the dashpots of soft walls act on one particle for a time h; returns the kinetic energy put in, 0 or less.
fn damp(walls: &mut Walls, planes: &Planes, x: DVec3, v: &mut DVec3, mass: f64, h: f64) -> f64 {
    let mut heat = 0.0;
    for (plane, contact) in &planes.dashpots {
        let reading = walls.walls()[*plane];
        let (axis, outward) = (reading.axis, reading.outward());
        let before = outward * v[axis];
        let after = contact.damped(-reading.distance(x), before, mass, h);
        v[axis] = outward * after;
        walls.take_momentum(*plane, mass * (before - after));
        heat += 0.5 * mass * (after * after - before * before);
    }
    heat
}
