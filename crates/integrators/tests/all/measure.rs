//! Motions with known solutions, and what a run of a method on them shows.

use std::sync::Arc;

use glam::{DMat2, DVec2};
use lennard_core::{
    Backend, Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceTerm, FusedSteps,
    Part, Persist, RestoreError, StateReader, StateWriter, System, Want,
};
use lennard_integrators::oscillator::{ExactOscillator, HarmonicForces, OscillatorConstraint};
use lennard_integrators::{IntegratorEntry, OscillatorModel, integrators};

use crate::common::{Rig, one};

/// The methods that can run any forces F(x), with no solution known beforehand.
pub fn general_methods() -> impl Iterator<Item = &'static IntegratorEntry> {
    integrators().iter().filter(|e| e.oscillator != OscillatorModel::ExactSolution)
}

/// What a test makes of an evaluation, by its number.
pub type Spoil = fn(u64, &mut [DVec3]) -> Result<(), ForceError>;

/// Other forces, watched, and bent as a test asks.
pub struct Watched<F> {
    pub inner: F,
    /// Evaluations so far, of any part. This is what the term remembers, as another would remember its list.
    pub evaluations: u64,
    /// Products of the Hessian with a vector so far.
    pub products: u64,
    /// What the term says of itself; at first what the inner forces say.
    pub properties: ForceProperties,
    /// At first it does nothing.
    pub spoil: Spoil,
}

impl<F: ForceTerm> Watched<F> {
    pub fn new(inner: F) -> Self {
        let properties = inner.properties();
        Self { inner, evaluations: 0, products: 0, properties, spoil: |_, _| Ok(()) }
    }
}

impl<F> Persist for Watched<F> {
    fn save(&self, to: &mut StateWriter<'_>) {
        to.put_u64("evaluations", &[self.evaluations]);
    }
    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        [self.evaluations] = from.u64s("evaluations")?;
        Ok(())
    }
}

impl<F: ForceTerm> ForceTerm for Watched<F> {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        self.evaluations += 1;
        let found = self.inner.evaluate(at, part, want, forces)?;
        (self.spoil)(self.evaluations, forces)?;
        Ok(found)
    }

    fn properties(&self) -> ForceProperties {
        self.properties
    }

    fn hessian_vector(
        &mut self,
        at: Configuration<'_>,
        direction: &[DVec3],
        out: &mut [DVec3],
    ) -> Result<(), ForceError> {
        self.products += 1;
        self.inner.hessian_vector(at, direction, out)
    }
}

/// Lets a bath act, and then takes no step: as forces that meet a number that is not finite.
impl<F: ForceTerm> Backend for Watched<F> {
    fn advance(&mut self, steps: &mut FusedSteps<'_>) -> u64 {
        if let Some(bath) = &mut steps.bath {
            bath.factor(7.0);
            bath.pass(|| 7.0);
        }
        0
    }
}

/// The attraction F = −r/|r|³ of a fixed centre at the origin on a unit mass, U = −1/|r|.
///
/// For RESPA it splits by distance: near F·w(r) and far F·(1 − w(r)) with w = 1/(1 + r²), which hides
/// no constant share from the method.
#[derive(Debug, Clone, Copy, Default)]
pub struct KeplerForces;

lennard_core::remembers_nothing!(KeplerForces);

impl ForceTerm for KeplerForces {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        let mut energy = 0.0;
        for (particle, (f, r)) in forces.iter_mut().zip(at.positions).enumerate() {
            let r2 = r.length_squared();
            let near_share = 1.0 / (1.0 + r2);
            let share = match part {
                Part::All => 1.0,
                Part::Near => near_share,
                Part::Far => 1.0 - near_share,
            };
            *f = *r * (-share / (r2 * r2.sqrt()));
            if !f.is_finite() {
                return Err(ForceError::NonFiniteForce { particle });
            }
            energy -= 1.0 / r2.sqrt();
        }
        // The parts are no gradients of simple potentials: only the whole has an energy here.
        let energy = (want.energy && part == Part::All).then_some(energy);
        Ok(Energetics {
            potential_energy: energy,
            conserved_potential: energy,
            ..Energetics::default()
        })
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties { splits: true, ..ForceProperties::default() }
    }
}

impl Backend for KeplerForces {}

/// The motion on an ellipse of semi-major axis 1 (period 2π) in the x-y plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kepler {
    eccentricity: f64,
    start_anomaly: f64,
}

impl Kepler {
    /// An ellipse of the given eccentricity below 1; at time 0 the mean anomaly is `start_anomaly` (radians).
    pub fn new(eccentricity: f64, start_anomaly: f64) -> Self {
        Self { eccentricity, start_anomaly }
    }

    /// The ellipse on which orders are measured. It is round enough for asymptotic behavior at
    /// practical steps. It starts at no point of symmetry, where errors might cancel.
    pub fn for_orders() -> Self {
        Self::new(0.2, 0.7)
    }

    /// Position and velocity at the time `t`, from Kepler's equation E − e·sin E = M by Newton's method.
    pub fn at(&self, t: f64) -> (DVec3, DVec3) {
        let e = self.eccentricity;
        let mean = self.start_anomaly + t;
        let mut anomaly = mean + e * mean.sin();
        // Newton doubles the digits each time: eight rounds end at rounding for every e < 0.9.
        for _ in 0..8 {
            anomaly -= (anomaly - e * anomaly.sin() - mean) / (1.0 - e * anomaly.cos());
        }
        let (sin, cos) = anomaly.sin_cos();
        let b = (1.0 - e * e).sqrt();
        let rate = 1.0 / (1.0 - e * cos);
        (DVec3::new(cos - e, b * sin, 0.0), DVec3::new(-sin * rate, b * cos * rate, 0.0))
    }

    /// The motion by a method, from time 0 on.
    pub fn by(&self, entry: &IntegratorEntry, dt: f64) -> Rig<KeplerForces> {
        let (x, v) = self.at(0.0);
        Rig::of(entry.build(), (System::atoms(1), one(x, v)), KeplerForces, dt)
    }
}

/// Orders of positions and velocities of a method, measured on the ellipse at t = 4. At the steps chosen its leading
/// error stands clear of the next one and of rounding.
pub fn orders(entry: &IntegratorEntry) -> [f64; 2] {
    const DURATION: f64 = 4.0;
    let (coarse, fine) = match entry.spec.position_order {
        // The next error is of relative order h: it must be below 1 %.
        0 | 1 => (4_000, 16_000),
        2 | 3 => (200, 800),
        // Rounding ends at 1e-15 a step, which a method of order 4 and a small constant meets soon.
        _ => (160, 320),
    };
    let orbit = Kepler::for_orders();
    let (x, v) = orbit.at(DURATION);
    let errors = |n: u32| {
        let state = orbit.by(entry, DURATION / f64::from(n)).steps(n).state;
        [(state.positions[0] - x).length(), (state.velocities[0] - v).length()]
    };
    let (large, small) = (errors(coarse), errors(fine));
    [0, 1].map(|i| (large[i] / small[i]).ln() / (f64::from(fine) / f64::from(coarse)).ln())
}

/// Runs a method on a unit mass on a spring k with a damper c, and returns (x, v) from the start on. The oscillator has
/// the form that the method takes.
pub fn oscillation(
    entry: &IntegratorEntry,
    (stiffness, damping): (f64, f64),
    start: DVec2,
    dt: f64,
    steps: u32,
) -> Vec<DVec2> {
    let mut system = System::atoms(1);
    let mut forces = HarmonicForces::new(stiffness).with_damping(damping);
    match entry.oscillator {
        OscillatorModel::Force => {}
        OscillatorModel::ExactSolution => {
            system.exact = Some(Arc::new(ExactOscillator::new(stiffness, damping, 1.0)));
        }
        OscillatorModel::Constraint => {
            system.constraints.push(Arc::new(OscillatorConstraint::spring(stiffness, damping)));
            forces = HarmonicForces::new(0.0);
        }
    }
    let state = one(DVec3::X * start.x, DVec3::X * start.y);
    let mut rig = Rig::of(entry.build(), (system, state), forces, dt);
    let moved = (0..steps).map(|_| {
        rig.step();
        DVec2::new(rig.state.positions[0].x, rig.state.velocities[0].x)
    });
    std::iter::once(start).chain(moved).collect()
}

/// The map of (x, v) over `steps` steps of `dt` on ẍ = −k·x − c·ẋ, from the images of (1, 0) and (0, 1).
pub fn measured_map(entry: &IntegratorEntry, spring: (f64, f64), dt: f64, steps: u32) -> DMat2 {
    let end = |start| oscillation(entry, spring, start, dt, steps)[steps as usize];
    DMat2::from_cols(end(DVec2::X), end(DVec2::Y))
}
