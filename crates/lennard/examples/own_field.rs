//! A field of one's own: a gas in a standing wave, beside the barometric formula.
#![allow(clippy::print_stdout)] // printing is what this program is for

use std::f64::consts::TAU;

use lennard::parts::{
    Configuration, DMat3, DVec3, Energetics, ForceError, ForceProperties, ForceTerm, Part,
    PeriodicBox, Want, exact_sum, for_each_piece, remembers_nothing,
};
use lennard::prelude::*;

/// The potential u(z) = −A·cos(2πz/L) on each particle, with A in ε.
#[derive(Clone, Copy)]
pub(crate) struct Wave {
    pub(crate) amplitude: f64,
}

remembers_nothing!(Wave);

impl Wave {
    /// Energy in ε, force along z in ε/σ and curvature u″ in ε/σ² at a place.
    fn at(&self, r: DVec3, cell: &PeriodicBox) -> [f64; 3] {
        let k = TAU / cell.lengths().z;
        let (sin, cos) = (k * r.z).sin_cos();
        [-cos, -k * sin, k * k * cos].map(|x| self.amplitude * x)
    }
}

impl ForceTerm for Wave {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        _part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        let (wave, n) = (&*self, at.positions.len());
        let of = |i: usize| wave.at(at.positions[i], at.cell);
        for_each_piece(forces, |first, piece| {
            for (i, force) in (first..).zip(piece) {
                *force = of(i)[1] * DVec3::Z;
            }
        });
        let total = |which: usize| exact_sum(n, |i| of(i)[which]);
        let energy = want.energy.then(|| total(0));
        Ok(Energetics {
            potential_energy: energy,
            conserved_potential: energy,
            // The pressure is the work of pairs: a field has no part in it.
            virial: want.virial.then_some(DMat3::ZERO),
            laplacian: want.laplacian.then(|| total(2)),
            virial_trace: None,
            pairs: None,
            per_particle: want
                .per_particle
                .then(|| (0..n).map(|i| (of(i)[0], DMat3::ZERO)).collect()),
        })
    }

    fn force_on(&self, particle: usize, at: Configuration<'_>) -> DVec3 {
        self.at(at.positions[particle], at.cell)[1] * DVec3::Z
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties { breaks_momentum: [false, false, true], ..ForceProperties::default() }
    }
}

pub(crate) fn main() -> lennard::Result<()> {
    let (temperature, amplitude) = (2.0, 1.0);
    let scene = SceneBuilder::new()
        .set("system.n_atoms", 256)
        .set("system.density", 0.01)
        .set("system.temperature", temperature)
        .set("truncation.kind", "shift")
        .set("integrator.dt", 0.01)
        .stages([
            toml! { name = "spread" steps = 2000 thermostat = "langevin" },
            toml! { name = "production" steps = 16000 thermostat = "langevin" },
        ])
        .observables([toml! { kind = "density-profile" every = 10 bins = 10 }])
        .build()?;
    let parts = OwnParts::none().force("wave", Wave { amplitude });
    let mut gas = Simulation::with_parts(scene, parts)?;
    gas.run()?;

    let results = gas.results();
    let profile = results.table("density_profile")?;
    let (z, density) = (profile.numbers("z"), profile.numbers("density"));
    let side = gas.state.cell.lengths().z;
    for (z, density) in z.into_iter().flatten().zip(density.into_iter().flatten()) {
        // ρ(z) ∝ exp(−u/T); the mean of exp(a·cos) over a period is I₀(a), the modified Bessel function.
        let formula = 0.01 * (amplitude / temperature * (TAU * z / side).cos()).exp() / 1.063_483;
        println!("z = {z:5.2} σ: {density:.4} σ⁻³, barometric formula {formula:.4}");
        assert!((density / formula - 1.0).abs() < 0.25, "{density} and {formula}");
    }
    Ok(())
}
