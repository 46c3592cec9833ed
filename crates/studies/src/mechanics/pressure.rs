//! The pressure on hard walls beside the pressure of the virial, as both grow sharp with time.

use lennard_core::{DVec3, State, Want};
use lennard_engine::prepare;
use lennard_integrators::{IntegratorOptions, build};
use lennard_observables::Table;

use super::fluid;
use crate::StudyError;
use crate::lab::Rig;
use crate::measured::Measured;

/// Time step, τ.
const DT: f64 = 0.004;

/// Runs a fluid of 108 atoms between hard walls, z counted from the middle of the slit.
///
/// The pressure of the walls is the momentum of their hits over 2A·t. The virial's is (Σ m·v_z² + Σ z·F_z)/(A·L), with half-step
/// speeds and trapezoid weights. The boundary term is [Σ m·z·v_z]/(A·L·t).
pub(super) fn measure(quick: bool, all: &mut Measured) -> Result<(), StudyError> {
    let text = "[system]\nn_atoms = 108\ndensity = 0.6\ntemperature = 1.5\nseed = 3\n\
                [truncation]\nkind = \"shift\"\nr_cut = 2.2\n\
                [integrator]\ndt = 0.004\n\
                [[wall]]\nkind = \"hard\"\n\
                [[stage]]\nname = \"production\"\nsteps = 1\n";
    let simulation = prepare(fluid::scene(text)?)?;
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
            let of_virial = (kinetic + forced) / (volume * time);
            points.push([time, of_walls, of_virial, with_boundary]);
        }
    }
    all.numbers.add("pressure on walls against the virial", identity);
    let table = Table::rows_of("wall-pressure", &points)
        .column("time [tau]", |p| p[0])
        .column("P of walls", |p| p[1])
        .column("P of virial", |p| p[2])
        .column("P of virial less boundary term", |p| p[3]);
    all.tables.push(table.table());
    Ok(())
}
