//! The pressure on hard walls beside the pressure of the virial, as both grow sharp with time.

use lennard_core::{DVec3, State, Want};
use lennard_engine::prepare;
use lennard_integrators::{IntegratorOptions, build};
use lennard_scene::Scene;
use serde::Serialize;

use crate::StudyError;
use crate::lab::Rig;

/// Time step, τ.
const DT: f64 = 0.004;

/// Both pressures up to a time.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct AtTime {
    /// Time, τ.
    pub time: f64,
    /// Momentum of hits of both walls over 2A·t, ε/σ³.
    pub of_walls: f64,
    /// (Σ m·v_z² + Σ z·F_z)/(A·L), with half-step speeds and trapezoid weights, over the same time, ε/σ³.
    pub of_virial: f64,
    /// The same less the boundary term [Σ m·z·v_z]/(A·L·t), ε/σ³.
    pub with_boundary: f64,
}

/// A fluid between hard walls.
#[derive(Debug, Clone, Serialize)]
pub struct WallPressure {
    /// Along the run.
    pub points: Vec<AtTime>,
    /// How far the identity with the boundary term is off at the end, relative.
    pub identity: f64,
}

/// Runs a fluid of 108 atoms between hard walls, z counted from the middle of the slit.
pub(crate) fn measure(quick: bool) -> Result<WallPressure, StudyError> {
    let text = "[system]\nn_atoms = 108\ndensity = 0.6\ntemperature = 1.5\nseed = 3\n\
                [truncation]\nkind = \"shift\"\nr_cut = 2.2\n\
                [integrator]\ndt = 0.004\n\
                [[wall]]\nkind = \"hard\"\n\
                [[stage]]\nname = \"production\"\nsteps = 1\n";
    let scene = Scene::parse(text, "the fluid of the study", &[]).map_err(|e| {
        StudyError::Settings { label: "the fluid between walls".into(), reason: e.to_string() }
    })?;
    let simulation = prepare(scene)?;
    let cell = simulation.state.cell;
    let slit = simulation.scene.slits(&cell)[0];
    let (middle, area) = (0.5 * (slit.lower + slit.upper), cell.lengths().x * cell.lengths().y);
    let method = build(&IntegratorOptions::default());
    let at = (simulation.system, simulation.state);
    let mut rig = Rig::start(method, at, simulation.forces, DT, Want::NOTHING)?;
    let sum = |state: &State, of: &dyn Fn(DVec3, DVec3, DVec3) -> f64| -> f64 {
        let all = state.positions.iter().zip(&state.velocities);
        all.zip(&state.forces).map(|((r, v), f)| of(*r, *v, *f)).sum()
    };
    let moment = |state: &State| sum(state, &|r, v, _| (r.z - middle) * v.z);
    let virial = |state: &State| sum(state, &|r, _, f| (r.z - middle) * f.z);
    let steps = if quick { 2000_u32 } else { 40_000 };
    // The lattice melts first: its steps count for nothing.
    rig.steps(u64::from(steps / 4))?;
    let impulse = |rig: &Rig| rig.forces.walls().iter().map(|w| w.impulse).sum::<f64>();
    let (first_moment, first_impulse) = (moment(&rig.state), impulse(&rig));
    let (mut kinetic, mut forced, mut before) = (0.0, 0.0, virial(&rig.state));
    let mut points = Vec::new();
    let mut identity = f64::NAN;
    for step in 1..=steps {
        kinetic += DT * sum(&rig.state, &|_, v, f| (v.z + 0.5 * DT * f.z).powi(2));
        rig.step()?;
        let now = virial(&rig.state);
        forced += 0.5 * DT * (before + now);
        before = now;
        let is_shown = step.is_power_of_two() || step % (steps / 40) == 0;
        if step >= 50 && is_shown {
            let time = DT * f64::from(step);
            let volume = area * slit.width();
            let impulse = impulse(&rig) - first_impulse;
            let boundary = moment(&rig.state) - first_moment;
            let of_walls = impulse / (2.0 * area * time);
            let with_boundary = (kinetic + forced - boundary) / (volume * time);
            identity = (with_boundary - of_walls).abs() * volume * time / kinetic;
            points.push(AtTime {
                time,
                of_walls,
                of_virial: (kinetic + forced) / (volume * time),
                with_boundary,
            });
        }
    }
    Ok(WallPressure { points, identity })
}
