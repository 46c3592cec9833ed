//! Molecules whose bonds are held in drifts, between walls that are hit.
//!
//! A drift flies each molecule from hit to hit. The flight over a time t is a step of the solver without forces: sites move with
//! their bonds held. The time of a hit is the root at which a site arrives at a plane. There the velocities lose their part along
//! the bonds, as after a kick, and take the impulse p along the outward normal n of the plane. It passes through the bonds:
//!
//! v ← v + p·w with w = P·M⁻¹·n, the projection P of [`rigid::project_velocities`], and κ = n·w of the site that hits.
//!
//! With p = −(1 + e)·u/κ the site leaves with −e·u. The kinetic energy changes by p·u + p²·κ/2: nothing for e = 1.
//!
//! The dashpots of soft walls act half before a flight and half after it, as for single particles. They act on the speed u of a site
//! with the mass 1/κ. Their impulse too passes through the bonds.

use std::ops::Range;

use lennard_core::random::CounterRng;
use lennard_core::{
    BondSolver, BoundDrift, DVec3, Drifted, Flight, ForceTerm, Masses, StepError, System, rigid,
};
use lennard_forcefield::{Hit, HitRule, Rebound, Surface, Walls};

use super::events::{self, Arrival, Mover};

/// Steps towards the time of a hit.
const MOST_ROOT_STEPS: usize = 100;
/// A site so near a plane, as a share of the plane's coordinate, is at the plane.
const AT_PLANE: f64 = 4.0 * f64::EPSILON;

/// Molecules that hit walls, and what holds their bonds.
pub(super) struct HeldMolecules {
    system: System,
    solver: Box<dyn BondSolver>,
    /// One molecule alone, for its flights from hit to hit.
    one: System,
    /// The planes that are hit.
    planes: Vec<usize>,
    /// The planes with a dashpot.
    damped: Vec<usize>,
    /// All sites as they were before the flight.
    before: Sites,
}

/// The sites of one molecule, or of all.
#[derive(Clone, Default)]
struct Sites {
    x: Vec<DVec3>,
    v: Vec<DVec3>,
}

impl HeldMolecules {
    /// The molecules of a system between walls; `solver` holds their bonds.
    pub(super) fn new(walls: &Walls, system: &System, solver: Box<dyn BondSolver>) -> Self {
        let molecules = system.molecules.clone();
        let is_hit = |plane: &usize| walls.surface(*plane).rule() == Some(HitRule::OnLines);
        let is_damped = |plane: &usize| walls.surface(*plane).dashpot().is_some();
        let planes = 0..walls.walls().len();
        Self {
            planes: planes.clone().filter(is_hit).collect(),
            damped: planes.filter(is_damped).collect(),
            one: System::of_molecules(molecules.sites(), molecules),
            system: system.clone(),
            solver,
            before: Sites::default(),
        }
    }

    /// Flies all molecules.
    pub(super) fn fly(
        &mut self,
        walls: &mut Walls,
        flight: Flight<'_>,
    ) -> Result<Drifted, StepError> {
        let Flight { positions, velocities, h, .. } = flight;
        let mut before = std::mem::take(&mut self.before);
        let mut at = AtWalls { of: self, walls };
        let mut heat = at.damp_all(positions, velocities, 0.5 * h, false);
        let flight = Flight { positions: &mut *positions, velocities: &mut *velocities, ..flight };
        before.x.clear();
        before.x.extend_from_slice(flight.positions);
        before.v.clear();
        before.v.extend_from_slice(flight.velocities);
        let mut drifted = at.fly_all(&before, flight)?;
        heat += at.damp_all(positions, velocities, 0.5 * h, true);
        self.before = before;
        drifted.heat += heat;
        Ok(drifted)
    }
}

/// The molecules, and the walls that they hit.
struct AtWalls<'a> {
    of: &'a mut HeldMolecules,
    walls: &'a mut Walls,
}

impl AtWalls<'_> {
    /// The distance of a site from a plane, σ: positive between the planes.
    fn distance(&self, plane: usize, x: DVec3) -> f64 {
        self.walls.walls()[plane].distance(x)
    }

    /// The speed of a site towards a plane, σ/τ.
    fn towards(&self, plane: usize, v: DVec3) -> f64 {
        let reading = &self.walls.walls()[plane];
        reading.outward() * v[reading.axis]
    }

    /// Whether a site lies behind a plane that is hit.
    fn is_behind(&self, x: DVec3) -> bool {
        let mut planes = self.of.planes.iter();
        planes.any(|plane| self.distance(*plane, x) < -self.rounding(*plane))
    }

    /// The molecule after a free flight over t, and what its bonds took and put in.
    fn flown(&mut self, from: &Sites, t: f64) -> Result<(Sites, Drifted), StepError> {
        let mut to = from.clone();
        if t == 0.0 {
            return Ok((to, Drifted::default()));
        }
        let still = vec![DVec3::ZERO; to.x.len()];
        let drift = BoundDrift {
            positions: &mut to.x,
            velocities: &mut to.v,
            forces: &still,
            kick: None,
            h: t,
        };
        let drifted = self.of.solver.drift(&self.of.one, drift)?;
        Ok((to, drifted))
    }

    /// The first arrival of a site at a plane in a flight over t that ends at `end`.
    fn first_arrival(
        &mut self,
        from: &Sites,
        end: &Sites,
        t: f64,
    ) -> Result<Option<Arrival>, StepError> {
        let mut first: Option<Arrival> = None;
        for site in 0..from.x.len() {
            if self.of.one.masses.is_held(site) {
                continue;
            }
            for k in 0..self.of.planes.len() {
                let plane = self.of.planes[k];
                let (before, after) =
                    (self.distance(plane, from.x[site]), self.distance(plane, end.x[site]));
                if after >= -self.rounding(plane) {
                    continue;
                }
                let approaches = self.towards(plane, from.v[site]) > 0.0;
                let time = match before > self.rounding(plane) {
                    true => self.time_of_arrival(from, (before, after), (site, plane), t)?,
                    false if approaches => 0.0,
                    // It left the plane just now, and comes back in this flight.
                    false if before >= -self.rounding(plane) => {
                        self.time_of_arrival(from, (0.0, after), (site, plane), t)?
                    }
                    false => continue,
                };
                if first.is_none_or(|other| time < other.after) {
                    first = Some(Arrival { after: time, site, plane });
                }
            }
        }
        Ok(first)
    }

    fn rounding(&self, plane: usize) -> f64 {
        AT_PLANE * self.walls.walls()[plane].position.abs().max(1.0)
    }

    /// The time at which a site comes from a distance to 0, before t, at which it is behind the plane: regula falsi by halves.
    fn time_of_arrival(
        &mut self,
        from: &Sites,
        (mut near, mut far): (f64, f64),
        (site, plane): (usize, usize),
        t: f64,
    ) -> Result<f64, StepError> {
        let (mut low, mut high, mut last) = (0.0, t, 0);
        for _ in 0..MOST_ROOT_STEPS {
            let by_line = low + near / (near - far) * (high - low);
            let middle = match near > 0.0 && by_line > low && by_line < high {
                true => by_line,
                false => 0.5 * (low + high),
            };
            if middle <= low || middle >= high {
                break;
            }
            let now = self.flown(from, middle)?.0.x[site];
            let distance = self.distance(plane, now);
            if distance.abs() <= self.rounding(plane) {
                return Ok(middle);
            }
            // The end that stays counts half, so that both ends move (the Illinois rule).
            if distance > 0.0 {
                (low, near) = (middle, distance);
                far *= if last == 1 { 0.5 } else { 1.0 };
                last = 1;
            } else {
                (high, far) = (middle, distance);
                near *= if last == -1 { 0.5 } else { 1.0 };
                last = -1;
            }
        }
        Ok(low)
    }

    /// Gives the one molecule the masses of these sites.
    fn take_masses(&mut self, own: &Range<usize>) {
        self.of.one.masses = match &self.of.system.masses {
            Masses::Each(_) => {
                Masses::Each(own.clone().map(|i| self.of.system.masses.of(i)).collect())
            }
            alike => alike.clone(),
        };
    }

    /// What a unit impulse outward at a site does to the velocities of its molecule, w = P·M⁻¹·n, and n·w.
    fn pushed(&self, x: &[DVec3], site: usize, plane: usize) -> (Vec<DVec3>, f64) {
        let normal = self.walls.walls()[plane].normal();
        let mut along = vec![DVec3::ZERO; x.len()];
        along[site] = normal / self.of.one.masses.of(site);
        self.project(x, &mut along);
        let kappa = normal.dot(along[site]);
        (along, kappa)
    }

    /// Takes the part along rigid bonds off velocities of the one molecule.
    fn project(&self, x: &[DVec3], v: &mut [DVec3]) {
        rigid::project_velocities(&self.of.one, x, v);
    }

    /// The hit of a site at a plane; returns the kinetic energy put in, ε. `is_tired` leaves no speed across the plane.
    fn hit(
        &mut self,
        sites: &mut Sites,
        Arrival { site, plane, .. }: Arrival,
        (forces, h): (&[DVec3], f64),
        random: &mut CounterRng,
        is_tired: bool,
    ) -> f64 {
        self.project(&sites.x, &mut sites.v);
        let reading = self.walls.walls()[plane];
        let (axis, normal) = (reading.axis, reading.normal());
        let masses = self.of.one.masses.clone();
        let (along, kappa) = self.pushed(&sites.x, site, plane);
        let towards = normal.dot(sites.v[site]);
        let surface = self.walls.surface(plane).clone();
        let Surface::Hit(wall) = &surface else {
            return 0.0;
        };
        let outward_momentum = |v: &[DVec3]| -> f64 {
            let each = v.iter().enumerate();
            each.map(|(k, v)| masses.moving(k) * normal.dot(*v)).sum()
        };
        let kinetic = |v: &[DVec3]| -> f64 {
            let each = v.iter().enumerate();
            each.map(|(k, v)| 0.5 * masses.moving(k) * v.length_squared()).sum()
        };
        let before = (outward_momentum(&sites.v), kinetic(&sites.v));
        let mut is_rest = false;
        let leaving = match surface.restitution() {
            _ if is_tired => 0.0,
            Some(e) => {
                let mut kick: Vec<DVec3> =
                    (forces.iter().enumerate()).map(|(k, f)| h / masses.of(k) * *f).collect();
                self.project(&sites.x, &mut kick);
                is_rest = self.walls.rests(plane, towards, kick[site]);
                if is_rest { 0.0 } else { e * towards }
            }
            None => {
                // All velocities are drawn anew. The normal speed of the site has the density of the flux of a mass 1/κ.
                for (k, v) in sites.v.iter_mut().enumerate() {
                    *v = drawn(*wall, masses.of(k), random);
                }
                self.project(&sites.x, &mut sites.v);
                let leaving = wall.leave(Hit {
                    axis,
                    outward: 1.0,
                    velocity: DVec3::ZERO,
                    mass: 1.0 / kappa,
                    random,
                });
                -leaving[axis]
            }
        };
        let impulse = (-leaving - normal.dot(sites.v[site])) / kappa;
        for (v, along) in sites.v.iter_mut().zip(&along) {
            *v += impulse * *along;
        }
        let momentum = before.0 - outward_momentum(&sites.v);
        match is_rest {
            true => self.walls.take_momentum(plane, momentum),
            false => self.walls.count_hit(plane, momentum),
        }
        if is_rest { 0.0 } else { kinetic(&sites.v) - before.1 }
    }

    /// Flies all molecules from what they were `before`.
    fn fly_all(&mut self, before: &Sites, flight: Flight<'_>) -> Result<Drifted, StepError> {
        let Flight { positions, velocities, forces, h, step, is_later, .. } = flight;
        let drift = BoundDrift {
            positions: &mut *positions,
            velocities: &mut *velocities,
            forces,
            kick: None,
            h,
        };
        let mut drifted = self.of.solver.drift(&self.of.system, drift)?;
        let sites = self.of.system.molecules.sites();
        for (molecule, first) in (0..positions.len()).step_by(sites).enumerate() {
            let own = first..first + sites;
            if !positions[own.clone()].iter().any(|x| self.is_behind(*x)) {
                continue;
            }
            self.take_masses(&own);
            let start =
                Sites { x: before.x[own.clone()].to_vec(), v: before.v[own.clone()].to_vec() };
            let numbered = |error| of_molecule(error, molecule + 1);
            let whole = self.flown(&start, h).map_err(numbered)?;
            // What the bonds put in over the whole flight is counted already.
            drifted.heat -= whole.1.heat;
            let mut mover = OneMolecule {
                random: self.walls.noise_of(first, step, is_later),
                at: &mut *self,
                sites: start,
                end: Some((h, whole)),
                drifted: Drifted::default(),
                forces: &forces[own.clone()],
                h,
            };
            events::fly(&mut mover, 1, h).map_err(numbered)?;
            let (end, by_hits) = (mover.sites, mover.drifted);
            drifted = drifted.and(by_hits);
            positions[own.clone()].copy_from_slice(&end.x);
            velocities[own].copy_from_slice(&end.v);
        }
        Ok(drifted)
    }

    /// Lets the dashpots of all walls act on all molecules for a time h, τ; returns the kinetic energy put in, 0 or less, ε.
    ///
    /// A site that moves outward with u at the depth δ takes the impulse p = (u′ − u)/κ, where u′ is the speed after the decay of a
    /// mass 1/κ. Before the flight sites come in their order and after it in reverse, so that the whole step is symmetric in time.
    fn damp_all(&mut self, x: &[DVec3], v: &mut [DVec3], h: f64, is_after: bool) -> f64 {
        if self.of.damped.is_empty() {
            return 0.0;
        }
        let sites = self.of.system.molecules.sites();
        let mut heat = 0.0;
        for first in (0..x.len()).step_by(sites) {
            let own = first..first + sites;
            let is_in_contact = |x: &DVec3| {
                let mut planes = self.of.damped.iter();
                planes.any(|plane| self.distance(*plane, *x) < 0.0)
            };
            if x[own.clone()].iter().any(is_in_contact) {
                self.take_masses(&own);
                heat += self.damp_one(&x[own.clone()], &mut v[own], h, is_after);
            }
        }
        heat
    }

    fn damp_one(&mut self, x: &[DVec3], v: &mut [DVec3], h: f64, is_after: bool) -> f64 {
        self.project(x, v);
        let mut heat = 0.0;
        let planes = self.of.damped.len();
        let all = x.len() * planes;
        for k in 0..all {
            let k = if is_after { all - 1 - k } else { k };
            let (site, plane) = (k / planes, self.of.damped[k % planes]);
            let depth = -self.distance(plane, x[site]);
            if depth <= 0.0 || self.of.one.masses.is_held(site) {
                continue;
            }
            let (along, kappa) = self.pushed(x, site, plane);
            let outward = self.towards(plane, v[site]);
            let Some(contact) = self.walls.surface(plane).dashpot() else {
                continue;
            };
            let after = contact.damped(depth, outward, 1.0 / kappa, h);
            let impulse = (after - outward) / kappa;
            for (v, along) in v.iter_mut().zip(&along) {
                *v += impulse * *along;
            }
            self.walls.take_momentum(plane, -impulse);
            heat += 0.5 * (after * after - outward * outward) / kappa;
        }
        heat
    }
}

/// One molecule in flight.
struct OneMolecule<'a, 'w> {
    at: &'a mut AtWalls<'w>,
    sites: Sites,
    /// A flight without hits that is known: its time, the molecule at its end, and what the bonds took.
    end: Option<(f64, (Sites, Drifted))>,
    drifted: Drifted,
    forces: &'a [DVec3],
    h: f64,
    random: CounterRng,
}

impl OneMolecule<'_, '_> {
    fn flown(&mut self, t: f64) -> Result<(Sites, Drifted), StepError> {
        match self.end.take() {
            Some((time, end)) if time == t => Ok(end),
            _ => self.at.flown(&self.sites, t),
        }
    }
}

impl Mover for OneMolecule<'_, '_> {
    fn arrival(&mut self, _unit: usize, left: f64) -> Result<Option<Arrival>, StepError> {
        let end = self.flown(left)?;
        let first = self.at.first_arrival(&self.sites, &end.0, left);
        self.end = Some((left, end));
        first
    }

    fn advance(&mut self, _unit: usize, by: f64) -> Result<(), StepError> {
        let (sites, drifted) = self.flown(by)?;
        (self.sites, self.drifted) = (sites, self.drifted.and(drifted));
        Ok(())
    }

    fn hit(&mut self, _unit: usize, arrival: Arrival, _left: f64, is_tired: bool) {
        // What is known of the flight holds without the hit.
        self.end = None;
        let flight = (self.forces, self.h);
        let random = &mut self.random;
        self.drifted.heat += self.at.hit(&mut self.sites, arrival, flight, random, is_tired);
    }
}

/// What a solver said of one molecule alone, with the number that it has among all, from 1.
fn of_molecule(mut error: StepError, number: usize) -> StepError {
    if let StepError::BondTurned { molecule, .. } | StepError::BondsNotConverged { molecule, .. } =
        &mut error
    {
        *molecule = number;
    }
    error
}

/// A velocity of a mass, with three components as a wall draws them along its plane.
fn drawn(wall: Rebound, mass: f64, random: &mut CounterRng) -> DVec3 {
    let mut across =
        |axis: usize| wall.leave(Hit { axis, outward: 1.0, velocity: DVec3::ZERO, mass, random });
    let (z, x) = (across(2), across(0));
    DVec3::new(z.x, z.y, x.z)
}
