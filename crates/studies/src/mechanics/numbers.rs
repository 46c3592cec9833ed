//! The measured numbers that judge the claims about bonds, collisions and SPOOK, by the keys of `claims.csv`.

use super::maps::DAMPING;
use super::precise::G;
use super::study::MechanicsMeasurements;
use super::unilateral;
use super::ways::MIDPOINT;
use crate::claims::Numbers;

/// All numbers.
pub(super) fn numbers(found: &MechanicsMeasurements) -> Numbers {
    let mut all = Numbers::default();
    relaxation(found, &mut all);
    ways(found, &mut all);
    spook(found, &mut all);
    collisions(found, &mut all);
    contacts(found, &mut all);
    fluids(found, &mut all);
    all
}

/// The largest size of some values.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}

fn relaxation(found: &MechanicsMeasurements, all: &mut Numbers) {
    let r = &found.relaxing;
    for rate in &r.rates {
        all.add("rate of sweeps", rate.measured)
            .of("chain", rate.chain())
            .of("n", rate.bonds)
            .of("degrees", format!("{:.0}", rate.angle.to_degrees()))
            .of("omega", format!("{:.3}", rate.over_relaxation))
            .theory(rate.theory);
    }
    let straight = r.rates.iter().filter(|rate| rate.chain() == "straight");
    let off = largest(straight.map(|rate| rate.measured / rate.theory - 1.0));
    all.add("sweeps against Gauss–Seidel", off);
    all.add("iterations over sweeps", r.chain_iterations[3] / r.chain_iterations[2]);
    all.add("distance from the direct solve", r.against_direct).of("bond", "old");
    all.add("distance from the direct solve", r.new_against_direct).of("bond", "new");
    all.add("angle of a rotor", r.rotor_off.abs());
    all.add("energy of a rotor", r.rotor_energy.abs());
    all.add("distance there and back", r.there_and_back[0]).of("bond", "old");
    all.add("distance there and back", r.there_and_back[1]).of("bond", "new");
    for slowing in &r.slowing {
        all.add("slowing of a rotor", slowing.measured)
            .of("n", slowing.step)
            .theory(slowing.theory);
    }
    let mut loose: Vec<_> = r.tolerances.iter().filter(|t| t.tolerance == 1e-3).collect();
    loose.sort_by(|a, b| a.dt.total_cmp(&b.dt));
    if let [fine, .., coarse] = loose.as_slice() {
        all.add("gain of a quarter of the step", fine.energy_rms / coarse.energy_rms);
    }
}

fn ways(found: &MechanicsMeasurements, all: &mut Numbers) {
    for way in &found.ways {
        let order = way.convergence.order().unwrap_or(f64::NAN);
        all.add("order of a bond", order).of("way", &way.name);
    }
    let limit = |name: &str| {
        let way = found.ways.iter().find(|w| w.name == name);
        way.map_or(f64::NAN, |w| w.largest_step.unwrap_or(f64::INFINITY))
    };
    // The rotor turns with Ω = 2 τ⁻¹.
    all.add("largest Ωh of a rigid rotor", 2.0 * limit("direct"));
    for (name, k) in [("spring, k = 1000", 1e3_f64), ("spring, k = 64000", 6.4e4)] {
        let largest = limit(name) * (2.0 * k).sqrt();
        all.add("largest ωh of an explicit spring", largest).of("k", k);
    }
    for (name, k) in MIDPOINT {
        let largest = 2.0 * (2.0 * k).sqrt() * limit(name).powi(2);
        all.add("largest Ω·ω·h² of a midpoint spring", largest).of("k", k);
    }
    if let [.., a, b] = found.model_errors.as_slice() {
        all.add("order of the model of a spring", (a.1 / b.1).ln() / (b.0 / a.0).ln());
    }
    for s in &found.solved {
        let number = all.add("order of a known solution", s.order);
        number.of("problem", s.problem).of("way", s.way).theory(s.theory);
    }
}

fn spook(found: &MechanicsMeasurements, all: &mut Numbers) {
    let m = &found.maps;
    let points = m.points.iter().filter(|p| p.damping > 0.0 || p.phase.is_finite());
    let off = largest(points.map(|p| p.measured / p.theory - 1.0));
    let radius = |damping: f64| {
        let point = m.points.iter().find(|p| p.damping == damping && p.phase.is_infinite());
        point.map_or(f64::NAN, |p| p.measured)
    };
    let others = DAMPING.iter().filter(|d| **d != 2.0).map(|d| radius(*d));
    all.add("difference from the closed form", m.closed_form);
    all.add("difference from the map of SPOOK", off);
    all.add("radius at τ = 2h", radius(2.0));
    all.add("radius at τ = 2h over others", radius(2.0) / others.fold(f64::INFINITY, f64::min));
    all.add("angle of an undamped spring", m.angle_off);
    all.add("length of a rotor", m.rotor_length).theory(m.rotor_theory);
    all.add("order of the strain", m.strain_orders[0]).of("damping", "2h");
    all.add("order of the strain", m.strain_orders[1]).of("damping", "fixed");
    all.add("loss of a pendulum by damping", m.pendulum[2] / m.pendulum[0]);
    all.add("drift of a rigid pendulum", m.pendulum[3].abs());
    all.add("energy of an undamped pendulum", m.undamped_pendulum / G);
}

fn collisions(found: &MechanicsMeasurements, all: &mut Numbers) {
    let c = &found.collisions;
    let gain = |phase: f64| {
        let hit = c.stiff.iter().find(|hit| hit.phase == phase);
        hit.map_or(f64::NAN, |hit| hit.gain)
    };
    all.add("speed that passes", c.passes[1]);
    for hit in &c.stiff {
        all.add("gain per hit", hit.gain).of("phase", hit.phase);
    }
    all.add("gain at 1.4 over 1.2", gain(1.4) / gain(1.2));
    all.add("time of a Hertz contact", c.hertz[0]);
    all.add("depth of a Hertz contact", c.hertz[1]);
    all.add("speed after a projection", c.projected);
    all.add("energy of a billiard ball", c.billiard[0]);
    all.add("trend of a billiard ball", c.billiard[1].abs());
    for hit in &c.damped {
        all.add("restitution of a damped spring", hit.mean).of("law", hit.law).of("e", hit.set);
    }
    for ball in c.bouncing.iter().filter(|ball| ball.rule == "event") {
        let off = largest(ball.energies.iter().map(|e| e - 1.0));
        all.add("energy after bounces", off).of("e", ball.restitution);
    }
    for ball in c.bouncing.iter().filter(|ball| ball.rule == "mirror") {
        let gain = ball.energies.last().map_or(f64::NAN, |e| e - 1.0);
        all.add("gain of a mirrored ball", gain);
    }
}

fn contacts(found: &MechanicsMeasurements, all: &mut Numbers) {
    let c = &found.collisions;
    for row in &c.cradles {
        let off = largest(row.velocities.iter().zip(&row.known).map(|(a, b)| a - b));
        all.add("velocities of a row of balls", off).of("rule", row.rule);
    }
    all.add("forces of a stack", c.stack);
    all.add("rebound of SPOOK alone", c.spook_alone[1]).of("damping", "2h");
    all.add("rebound of SPOOK alone", c.spook_alone[0]).of("damping", "0");
    all.add("restitution of unilateral contacts", c.unilateral.restitution.abs());
    all.add("depths of a stack", c.unilateral.sunk);
    all.add("weight of a stack", c.unilateral.weight.abs());
    let steps = unilateral::steps_of_ball(found.is_quick);
    all.add("energy of a bouncing ball", c.unilateral.energy).of("steps", steps);
    all.add("sweep over a stack", c.unilateral.sweep[0]).theory(c.unilateral.sweep[1]);
}

fn fluids(found: &MechanicsMeasurements, all: &mut Numbers) {
    let of = |way: &'static str, dt: f64| {
        found.drifts.iter().filter(move |d| d.way == way && d.dt == dt)
    };
    for run in of("relaxation, new direction", 0.002) {
        let number = all.add("drift along the new bond", run.drift).of("density", run.density);
        number.of("law", run.law).of("size", run.law.abs()).of("error", run.error);
    }
    for run in of("direct", 0.002) {
        let drift = run.drift.abs() - 3.0 * run.error;
        all.add("drift of the direct solve", drift).of("density", run.density);
    }
    let rms = |dt| of("direct", dt).next_back().map_or(f64::NAN, |run| run.rms);
    all.add("order of the energy of a fluid", (rms(0.004) / rms(0.002)).log2());
    let drift = |dt| of("spook, τ = 2h", dt).next_back().map_or(f64::NAN, |run| run.drift);
    all.add("order of the drift of SPOOK", (drift(0.004) / drift(0.002)).log2());
    all.add("pressure on walls against the virial", found.pressure.identity);
    let slack = if found.is_quick { 0.1 } else { 0.0 };
    for state in &found.states {
        let off = |(mean, error): (f64, f64), by: [f64; 2]| {
            let nearer = by.map(|e| (mean - e).abs()).into_iter().fold(f64::INFINITY, f64::min);
            nearer - 3.0 * if error.is_finite() { error } else { 0.0 }
        };
        for (of, off) in [
            ("u", off(state.energy, [state.lisal.0, state.mecke.0])),
            ("p", off(state.pressure, [state.lisal.1, state.mecke.1])),
        ] {
            let number = all.add("difference from the equation of state", off).of("of", of);
            number.of("density", state.density).of("slack", slack);
        }
    }
}
