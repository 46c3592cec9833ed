//! The tail beyond the cutoff of a fluid with flat surfaces across z, as a potential between its particles.

mod cells;
mod transform;

use std::f64::consts::TAU;

use cells::Cells;
use lennard_core::{
    Configuration, DMat3, DVec3, Energetics, ForceError, ForceProperties, ForceTerm, Own, Part,
    PeriodicBox, Want, remembers_nothing,
};
use lennard_forcefield::{ForceFieldOptions, Model, TruncationOptions, tail_correction};
use lennard_scene::Scene;

use crate::EngineError;

/// The largest wave number of the sum, σ⁻¹: beyond it neither the transform nor the profile of a slab has anything left.
const LARGEST_WAVE_NUMBER: f64 = 4.0;
/// The most waves: their tables grow as the square of their number, to 0.3 GB.
const MOST_WAVES: usize = 4096;
/// The axis across the surfaces.
const Z: usize = 2;

/// One wave exp(ikz) of the box.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Mode {
    /// k = 2πn/L_z, σ⁻¹.
    k: f64,
    /// φ̂(k), ε·σ³, of the potential that the forces come from.
    phi: f64,
    /// The same of the energy that is reported, without the shift at the cutoff.
    reported: f64,
    /// k·φ̂′(k), ε·σ³.
    slope: f64,
}

/// The tail of a plain cutoff in a fluid that is homogeneous along x and y, summed over waves along z:
///
/// E = (1/2V)·[φ̂(0)·N² + 2·Σ_n φ̂(k_n)·|S_n|²] with S_n = Σ_j exp(i·k_n·z_j) and k_n = 2πn/L_z.
///
/// What the cutoff leaves out of the forces is w(r) = u(r) beyond it and u(r_cut) inside. φ(ξ) is its average over the plane, for
/// two particles at a distance ξ along z. Every finite sum over waves is the energy of a
/// Hamiltonian. F_z = −∂E/∂z is exact, and momentum is kept. W_xx = W_yy = E and W_zz = E + (1/V)·Σ_n k_n·φ̂′(k_n)·|S_n|²
/// are exact too. A homogeneous fluid has S_n = 0, and then E = V·P_tail and W/(3V) = P_tail of the usual tail correction.
/// The energy that is reported has u beyond the cutoff alone, as the usual correction has.
///
/// Source: J. Janeček, J. Phys. Chem. B 110, 6264 (2006), for the average over the plane.
#[derive(Debug, Clone)]
pub struct PlanarTail {
    /// Where the waves are summed.
    cells: Cells,
    /// k = 0.
    homogeneous: Mode,
    /// k_1, k_2, …
    modes: Vec<Mode>,
    /// Which particles this process keeps, where ranks share them.
    own: Option<Own>,
}

remembers_nothing!(PlanarTail { cells, homogeneous, modes, own });

/// Σ cos and Σ sin of each mode.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Waves(Vec<[f64; 2]>);

/// The number of waves along z in a box of some length, σ.
fn n_waves(length: f64) -> usize {
    (LARGEST_WAVE_NUMBER * length / TAU).ceil() as usize
}

impl PlanarTail {
    /// Refuses a planar tail in a box that is too long for its waves.
    pub(crate) fn check(scene: &Scene, cell: &PeriodicBox) -> Result<(), EngineError> {
        let length = cell.lengths()[Z];
        if !scene.planar_tail || n_waves(length) <= MOST_WAVES {
            return Ok(());
        }
        let most = MOST_WAVES as f64 * TAU / LARGEST_WAVE_NUMBER;
        let found = format!("\"planar\" in a box of {length} σ along z");
        let allowed = format!("a box of at most {most:.0} σ along z, or no tail correction");
        let key = "truncation.tail_correction";
        Err(scene.invalid(key, found, allowed).into())
    }

    /// The tail of a scene in a box; `None` where the scene has no planar tail, or no model that could have one.
    #[must_use]
    pub fn of(scene: &Scene, cell: &PeriodicBox) -> Option<Self> {
        let options = scene.force_field();
        let planar = scene.planar_tail.then(|| Self::new(&options, cell));
        planar.flatten()
    }

    /// The tail beyond the cutoff of some options in a box; `None` where the options make no model.
    #[must_use]
    pub fn new(options: &ForceFieldOptions, cell: &PeriodicBox) -> Option<Self> {
        let r_cut = options.truncation.r_cut;
        // The formula itself, as far as the transform looks.
        let uncut = TruncationOptions {
            r_cut: transform::FARTHEST * r_cut,
            tail_correction: false,
            ..options.truncation
        };
        let model = Model::new(&options.potential, &uncut).ok()?;
        let slope = |r: f64| -model.eval(r * r).force * r;
        let at_cutoff = model.eval(r_cut * r_cut).energy;
        let mut with_tail = *options;
        with_tail.truncation.tail_correction = true;
        let tail = tail_correction(&with_tail, 1, 1.0)?;
        let length = cell.lengths()[Z];
        let mode = |n: usize| {
            let k = TAU * n as f64 / length;
            let found = transform::transform(&slope, r_cut, k);
            let inside = at_cutoff * transform::of_sphere(r_cut, k);
            Mode { k, phi: found.value, reported: found.value - inside, slope: found.slope }
        };
        let most = n_waves(length);
        Some(Self {
            cells: Cells::new(length, most),
            homogeneous: Mode {
                k: 0.0,
                phi: 2.0 * tail.pressure,
                reported: 2.0 * tail.energy,
                slope: 0.0,
            },
            modes: (1..=most).map(mode).collect(),
            own: None,
        })
    }

    /// How many waves are summed.
    #[must_use]
    pub fn n_modes(&self) -> usize {
        self.modes.len()
    }

    /// Adds F_z to the forces.
    pub(crate) fn push(
        &self,
        cell: &PeriodicBox,
        positions: &[DVec3],
        forces: &mut [DVec3],
    ) -> Waves {
        let waves = self.waves(positions);
        let coefficients = self.coefficients(&waves, cell.volume());
        self.cells.push(&coefficients, positions, forces);
        waves
    }

    /// The energy that is reported, and the scalar virial W, of some positions, ε.
    pub(crate) fn energy_and_virial(&self, cell: &PeriodicBox, positions: &[DVec3]) -> (f64, f64) {
        let waves = self.waves(positions);
        let want = Want::ENERGY_AND_VIRIAL;
        let found = self.energetics(&waves, self.n(positions.len()), cell.volume(), want);
        let (energy, virial) = (found.potential_energy, found.scalar_virial());
        (energy.unwrap_or(f64::NAN), virial.unwrap_or(f64::NAN))
    }

    /// S_n of each mode.
    fn waves(&self, positions: &[DVec3]) -> Waves {
        Waves(self.cells.sums(positions, self.own.as_ref().and_then(Own::team)))
    }

    /// The particles on all ranks, of which so many are here.
    fn n(&self, here: usize) -> usize {
        self.own.as_ref().map_or(here, Own::all)
    }

    /// Coefficients of sin k_n·z and cos k_n·z in the force on a particle.
    fn coefficients(&self, waves: &Waves, volume: f64) -> Vec<[f64; 2]> {
        let both = self.modes.iter().zip(&waves.0);
        both.map(|(mode, [re, im])| {
            let strength = 2.0 * mode.phi * mode.k / volume;
            [strength * re, -strength * im]
        })
        .collect()
    }

    /// Energies, virial and Laplacian of the sums of `n` particles.
    fn energetics(&self, waves: &Waves, n: usize, volume: f64, want: Want) -> Energetics {
        let n = n as f64;
        let sum = |of: &dyn Fn(&Mode, f64) -> f64| -> f64 {
            let both = self.modes.iter().zip(&waves.0);
            both.map(|(mode, [re, im])| of(mode, re * re + im * im)).sum::<f64>() / volume
        };
        let homogeneous = |phi: f64| 0.5 * phi * n * n / volume;
        let energy = || homogeneous(self.homogeneous.phi) + sum(&|mode, square| mode.phi * square);
        let virial = || {
            let across = energy();
            let along = across + sum(&|mode, square| mode.slope * square);
            DMat3::from_diagonal(DVec3::new(across, across, along))
        };
        Energetics {
            potential_energy: want.energy.then(|| {
                homogeneous(self.homogeneous.reported) + sum(&|mode, square| mode.reported * square)
            }),
            conserved_potential: want.energy.then(energy),
            virial: want.virial.then(virial),
            laplacian: want
                .laplacian
                .then(|| sum(&|mode, square| 2.0 * mode.phi * mode.k * mode.k * (n - square))),
            ..Energetics::default()
        }
    }
}

impl ForceTerm for PlanarTail {
    lennard_core::evaluate_by_adding!();

    /// The tail is smooth: it belongs to the far part.
    fn add(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        _scratch: &mut Vec<DVec3>,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        let (n, volume) = (self.n(at.positions.len()), at.cell.volume());
        if part == Part::Near {
            let nothing = Waves(vec![[0.0; 2]; self.modes.len()]);
            return Ok(self.energetics(&nothing, 0, volume, want));
        }
        let waves = self.push(at.cell, at.positions, forces);
        Ok(self.energetics(&waves, n, volume, want))
    }

    fn force_on(&self, particle: usize, at: Configuration<'_>) -> DVec3 {
        let waves = self.waves(at.positions);
        let coefficients = self.coefficients(&waves, at.cell.volume());
        let mut force = [DVec3::ZERO];
        let position = [at.positions[particle]];
        self.cells.push(&coefficients, &position, &mut force);
        force[0]
    }

    fn keep(&mut self, own: &Own) {
        self.own = Some(own.clone());
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties { splits: true, ..ForceProperties::default() }
    }
}

#[cfg(test)]
mod tests;
