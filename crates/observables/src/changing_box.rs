//! Volume, density and enthalpy of a box that a barostat changes.

use crate::{Findings, Observable, ObservableSpec};
use lennard_core::{Ramp, View, Want, persist};

use crate::series::{Series, columns};

const SPEC: ObservableSpec = ObservableSpec {
    name: "changing_box",
    summary: "volume, density, sides and enthalpy of a run at constant pressure",
    equation: "V = Lx·Ly·Lz; ρ = N/V; h = (K + U + P₀V)/N",
    source: "M. P. Allen and D. J. Tildesley, Computer Simulation of Liquids, 2nd ed. (2017), section 2.2",
    alone: None,
    ..ObservableSpec::PLAIN
};

/// Rows kept before neighbors are averaged in pairs.
const MOST_ROWS: usize = 1 << 16;

columns! {
    struct Columns { time, volume, density, enthalpy, side_x, side_y, side_z }
}

/// Volume, density and enthalpy of a run at constant pressure, per particle or per molecule; every such run has it.
///
/// The enthalpy is h = (K + U + P₀V)/N with the pressure P₀ of the barostat, U with its tail at the present volume.
#[derive(Debug, Clone, PartialEq)]
pub struct ChangingBox {
    pressure: Ramp,
    energy_unit: &'static str,
    series: Series<Columns>,
}

impl ChangingBox {
    /// For a barostat that holds this pressure, ε/σ³, with energies in ε per particle or per molecule.
    #[must_use]
    pub fn new(pressure: Ramp, energy_unit: &'static str) -> Self {
        Self { pressure, energy_unit, series: Series::new(Columns::default(), MOST_ROWS) }
    }

    /// The mean density in σ⁻³ after a part of the run, with its standard error.
    #[must_use]
    pub fn density(&self, discarded: f64) -> crate::Average {
        let rows = self.series.rows();
        self.series.average("density", "σ⁻³", &rows.density, self.cut(discarded))
    }

    fn cut(&self, discarded: f64) -> usize {
        (discarded * self.series.len() as f64).round() as usize
    }
}

impl Observable for ChangingBox {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn want(&self) -> Want {
        Want::ENERGY_AND_VIRIAL
    }

    /// # Panics
    /// Where the state lacks the energy: that is a bug of the caller.
    fn sample(&mut self, view: &View<'_>) {
        let n = view.system.n_molecules() as f64;
        let (volume, sides) = (view.cell().volume(), view.cell().lengths());
        let potential = view.state.energetics.potential_energy;
        let potential = potential.expect("the force evaluation gives what the observable wants");
        let tail = view.tail.unwrap_or_default().energy_per_particle;
        let work = self.pressure.at(view.state.step) * volume;
        let enthalpy = (view.kinetic_energy() + potential + work) / n + tail;
        self.series.push(&[
            view.state.time,
            volume,
            n / volume,
            enthalpy,
            sides.x,
            sides.y,
            sides.z,
        ]);
    }

    fn finish(&self, discarded: f64) -> Findings {
        let (rows, cut) = (self.series.rows(), self.cut(discarded));
        let averages = vec![
            self.series.average("volume", "σ³", &rows.volume, cut),
            self.density(discarded),
            self.series.average("enthalpy", self.energy_unit, &rows.enthalpy, cut),
        ];
        let columns = [
            ("volume", "σ³", &rows.volume),
            ("density", "σ⁻³", &rows.density),
            ("enthalpy", self.energy_unit, &rows.enthalpy),
            ("side_x", "σ", &rows.side_x),
            ("side_y", "σ", &rows.side_y),
            ("side_z", "σ", &rows.side_z),
        ];
        let table = self.series.table("box", "the box", columns);
        Findings { averages, tables: vec![table], ..Findings::default() }
    }
}

persist!(ChangingBox { series, fixed pressure, energy_unit });

#[cfg(test)]
mod tests {
    use super::*;
    use lennard_core::{DVec3, Energetics, PeriodicBox, State, System, TailCorrection};

    #[test]
    fn volume_density_and_enthalpy_follow_the_box_at_each_sample() {
        let mut seen = ChangingBox::new(0.5.into(), "ε per particle");
        let system = System::atoms(2);
        for side in [4.0, 5.0] {
            let cell = PeriodicBox::new(DVec3::new(side, 2.0, 1.0)).unwrap();
            let mut state = State::new(cell, vec![DVec3::ZERO; 2], vec![DVec3::X; 2]);
            state.energetics = Energetics { potential_energy: Some(-6.0), ..Energetics::default() };
            seen.sample(&View {
                tail: Some(TailCorrection { energy_per_particle: -0.25, pressure: 0.0 }),
                ..View::of(&state, &system)
            });
        }
        let means: Vec<f64> = seen.finish(0.0).averages.iter().map(|a| a.estimate.mean).collect();
        // K = 1, U = −6, P₀V = 4 and 5 for two particles, and the tail.
        let enthalpy = 0.5 * (-0.5 + 0.0) - 0.25;
        assert_eq!(means, [9.0, 0.5 * (0.25 + 0.2), enthalpy]);
    }
}
