//! A nonlinear motion with a known solution: one body on an ellipse about a fixed centre.

use lennard_core::{
    Backend, Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceTerm, Part,
    PeriodicBox, State, Want,
};

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
    #[must_use]
    pub fn new(eccentricity: f64, start_anomaly: f64) -> Self {
        Self { eccentricity, start_anomaly }
    }

    /// The ellipse on which orders are measured. It is round enough for asymptotic behavior at
    /// practical steps. It starts at no point of symmetry, where errors might cancel.
    #[must_use]
    pub fn for_orders() -> Self {
        Self::new(0.2, 0.7)
    }

    /// Position and velocity at the time `t`, from Kepler's equation E − e·sin E = M by Newton's method.
    #[must_use]
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

    /// The acceleration at the time `t`.
    #[must_use]
    pub fn acceleration(&self, t: f64) -> DVec3 {
        let r = self.at(t).0;
        -r / r.length().powi(3)
    }

    /// The state at time 0.
    #[must_use]
    pub fn start(&self) -> State {
        let (x, v) = self.at(0.0);
        State::new(PeriodicBox::boundless(), vec![x], vec![v])
    }
}
