//! Reversible RESPA: the near force with short steps inside long steps of the far force.

use glam::DMat2;
use lennard_core::parallel::for_each_piece;
use lennard_core::{
    DVec3, Energetics, ForceProperties, Integrator, IntegratorSpec, Method, Moving, Part, Parts,
    Step, StepError, System, Want, check_finite, persist, rigid_bonds_alone,
};

use crate::methods::MethodOptions;
use crate::oscillator::HarmonicForces;
use crate::velocity_verlet::VERLET;

lennard_core::options! {
    /// Options of RESPA. Four inner steps show the gain of the split, and stay clear of resonances in a fluid.
    pub struct Options {
        /// Steps of the near force inside one step of the far force.
        inner_steps: u32 = DEFAULT_INNER_STEPS, Whole(1, 1_000_000);
    }
}

/// Inner steps where nothing else is asked for; the one-step map of the list is for this number.
const DEFAULT_INNER_STEPS: u32 = 4;

/// What RESPA declares about itself, with its default number of inner steps.
pub static SPEC: IntegratorSpec = IntegratorSpec {
    name: "respa",
    summary: "Reversible multiple time steps: velocity Verlet on the near force inside kicks of the far force.",
    equations: "v += (h/2) a_far; n times: v += (h/2n) a_near, x += (h/n) v, v += (h/2n) a_near; v += (h/2) a_far",
    half_kicks: false,
    holds_rigid_bonds: true,
    force_evaluations: DEFAULT_INNER_STEPS + 1,
    stability_limit: Some(2.695_592),
    source: "Tuckerman, Berne and Martyna, \"Reversible multiple time scale molecular dynamics\", J. Chem. Phys. 97, 1990 (1992)",
    oscillator_map: Some(oscillator_map),
    on_ranks: false,
    ..VERLET
};

/// One step on ẍ = −ω²x as a matrix on (x, v), with the default inner steps and the oscillator's
/// spring split as [`HarmonicForces::NEAR_SHARE`] says.
#[must_use]
pub fn oscillator_map(omega: f64, dt: f64) -> DMat2 {
    split_oscillator_map(omega, dt, DEFAULT_INNER_STEPS, HarmonicForces::NEAR_SHARE)
}

/// One step on ẍ = −ω²x as a matrix on (x, v), with `inner_steps` inner steps and the share
/// `near_share` of ω² in the near force.
#[must_use]
pub fn split_oscillator_map(omega: f64, dt: f64, inner_steps: u32, near_share: f64) -> DMat2 {
    let omega_squared = omega * omega;
    let far_kick = DMat2::from_cols_array_2d(&[
        [1.0, -0.5 * dt * (1.0 - near_share) * omega_squared],
        [0.0, 1.0],
    ]);
    let near = crate::velocity_verlet::oscillator_map(
        omega * near_share.sqrt(),
        dt / f64::from(inner_steps),
    );
    let inner = (0..inner_steps).fold(DMat2::IDENTITY, |map, _| near * map);
    far_kick * inner * far_kick
}

/// Reversible RESPA; keeps the two parts of the force at the current positions apart.
#[derive(Debug, Clone)]
pub struct Respa {
    inner_steps: u32,
    near: Vec<DVec3>,
    far: Vec<DVec3>,
}

impl Respa {
    /// With the given options.
    #[must_use]
    pub fn new(options: &Options) -> Self {
        Self { inner_steps: options.inner_steps, near: Vec::new(), far: Vec::new() }
    }

    /// Exchanges the near forces with the forces of the state, which the kicks of a step give.
    fn exchange_near(&mut self, s: &mut Step<'_>) {
        std::mem::swap(&mut s.parts().state.forces, &mut self.near);
    }

    /// Evaluates the far part at the end of the step and adds it to the near one, which is already there.
    fn complete(
        &mut self,
        near: &Energetics,
        s: &mut Step<'_>,
        share: f64,
    ) -> Result<(), StepError> {
        let far = s.part_of_forces(Part::Far, share, s.want(), &mut self.far)?;
        let (near_forces, far_forces) = (&self.near, &self.far);
        let Parts { system, state, .. } = s.parts();
        for_each_piece(&mut state.forces, |first, sums| {
            for (i, sum) in (first..).zip(sums) {
                *sum = near_forces[i] + far_forces[i];
            }
        });
        check_finite(system.own(), &state.forces)?;
        state.energetics = near.plus(&far);
        Ok(())
    }
}

impl MethodOptions for Options {
    fn build(&self) -> Integrator {
        Integrator::new(Respa::new(self))
    }
}

persist!(Respa { near as "near_forces", far as "far_forces", fixed inner_steps });

impl Method for Respa {
    fn spec(&self) -> &'static IntegratorSpec {
        &SPEC
    }

    /// Inner kicks and drifts hold rigid bonds: with them each inner step is a step of RATTLE.
    fn suits(&self, system: &System, forces: ForceProperties) -> Result<(), String> {
        rigid_bonds_alone(system)?;
        if forces.splits {
            Ok(())
        } else {
            Err("its forces do not come in a near and a far part".to_owned())
        }
    }

    fn lets_box_change(&self) -> Result<(), &'static str> {
        Err("it keeps forces of the box as it was; take \"velocity-verlet\" with a barostat")
    }

    fn start(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let n = s.system().len();
        self.near.resize(n, DVec3::ZERO);
        self.far.resize(n, DVec3::ZERO);
        let near = s.part_of_forces(Part::Near, 0.0, s.want(), &mut self.near)?;
        self.complete(&near, s, 0.0)
    }

    fn step(&mut self, s: &mut Step<'_>) -> Result<(), StepError> {
        let (masses, dt) = (&s.system().masses, s.dt());
        let inner_step = f64::from(self.inner_steps).recip();
        let mut near = Energetics::default();
        // The first inner drift holds bonds, whatever this kick puts along them.
        let state = s.parts().state;
        Moving { forces: &self.far, ..Moving::of(state) }.kick(masses, 0.5 * dt);
        self.exchange_near(s);
        for inner in 1..=self.inner_steps {
            s.kick(0.5 * inner_step);
            s.drift(inner_step);
            let share = f64::from(inner) / f64::from(self.inner_steps);
            let last = inner == self.inner_steps;
            let wanted = if last { s.want() } else { Want::NOTHING };
            near = s.part_of_forces(Part::Near, share, wanted, &mut self.near)?;
            self.exchange_near(s);
            s.kick(0.5 * inner_step);
        }
        self.exchange_near(s);
        s.arrive();
        self.complete(&near, s, 1.0)?;
        let far = &mut self.far;
        std::mem::swap(&mut s.parts().state.forces, far);
        s.kick(0.5);
        std::mem::swap(&mut s.parts().state.forces, far);
        Ok(())
    }
}
