//! Temperature, energies, pressure and what ought to be conserved.

mod conservation;
mod cutoffs;
mod equilibrium;
mod remarks;
mod responses;
mod row;
mod species;
#[cfg(test)]
mod tests;

use crate::{
    BuildContext, Curvature, Ensemble, Estimate, Findings, Observable, ObservableSpec,
    heat_capacity, recipe,
};
use lennard_core::{View, Want, persist};

use crate::averages::{FEWEST_INDEPENDENT, of_fluctuations, of_series};
use crate::seen_box::SeenBox;
use crate::series::Series;
use crate::statistics::{self, Line};
use crate::thermo_series::ThermoSeries;

pub use conservation::Conservation;
pub(crate) use cutoffs::EndSums;
use cutoffs::Ends;
pub use cutoffs::PairEnd;
pub use equilibrium::{Equilibrium, HeldTemperature};
pub use remarks::Confined;
use species::SpeciesTemperatures;

const SPEC: ObservableSpec = ObservableSpec {
    name: "thermodynamics",
    summary: "temperature, energies, pressure, configurational temperature, conserved energy and momentum",
    equation: "T = 2K/n_dof on whole and on half steps; U = Σ U(r_ij)/N + u_tail; P = ρT + W/(3V) + p_tail, over molecules where there are some; T_conf = ⟨|∇U|²⟩/⟨∇²U⟩",
    source: "M. P. Allen and D. J. Tildesley, Computer Simulation of Liquids, 2nd ed. (2017), equations 2.61 and 2.68; \
             B. D. Butler, G. Ayton, O. G. Jepps and D. J. Evans, Configurational temperature, J. Chem. Phys. 109, 6519 (1998), equation 6",
    alone: None,
    ..ObservableSpec::PLAIN
};

/// Rows kept before neighbors are averaged in pairs.
const MOST_ROWS: usize = 1 << 16;

lennard_core::options! {
    /// Options of [`Thermodynamics`].
    pub struct ThermodynamicsOptions {
        /// Whether the configurational temperature is taken, for which the Laplacian of U is evaluated.
        configurational_temperature: bool = true, Flag;
    }
}

recipe!(ThermodynamicsOptions, |options, context| Thermodynamics::with_options(options, context));

/// Temperature, energies, pressure, configurational temperature and what is conserved.
///
/// - **Temperature** T = 2K/n_dof, on whole steps (`temperature`) and, for methods that kick by halves, on half steps
///   (`temperature_half_steps`).
/// - **Which temperature belongs to the positions.** A run of velocity Verlet samples positions at a temperature T̃, a
///   little higher than the temperature of whole steps. For harmonic forces T̃ is exactly the temperature of half steps
///   ([`View::half_step_kinetic_energy`]). For a fluid it follows to order h² from the shadow Hamiltonian H +
///   (h²/12)·v·∇∇U·v − (h²/24)·Σ|F|²/m. With f = n_dof, L = ⟨∇²U⟩/m and primes for slopes in T:
///   `T_whole = T̃·(1 − h²L/6f)`, `T_half = T̃·(1 + h²L/12f)`, `⟨U⟩ = U(T̃) + (h²/24)·(T·L − T²·L′)`. Hence
///   `⟨U⟩ − U(T_half) = (h²/24)·T·L·(1 − T·L′/L − 2·U′/f)`, which is zero for harmonic forces and some tenths of ⟨U⟩ −
///   U(T_whole) in a fluid. `T_conf = T̃·(1 + (h²/12)·⟨tr (∇∇U)²⟩/⟨∇²U⟩)` is above T_half, since stiff directions weigh
///   more in it.
/// - **Pressure** P = ρT + W/(3V) + p_tail with W = Σ r_ij·F_ij. For zero total momentum the mechanical
///   pressure (2K + W)/(3V) lacks the part of the centre of mass: ⟨2K⟩ = (3N − 3)T makes its ideal part
///   (N − 1)T/V. With T = 2K/n_dof the ideal part is ρT, exact for the ideal gas at every N. W depends on relative
///   positions alone, so ρT + W/(3V) is the canonical pressure. The two pressures differ by T/V. T is here the
///   temperature of half steps where there is one, since W belongs to that temperature.
/// - **Conserved energy** (K + U_conserved − Σ heat)/N, with the potential of which the forces are the
///   gradient (for a plain cutoff the shifted one). In a box that changes V·P_tail is added, the energy of the tail
///   that the motion of the box feels.
/// - **Configurational temperature** T_conf = ⟨|∇U|²⟩/⟨∇²U⟩. A force that jumps at the cutoff adds a
///   delta function to ∇²U that no pair loop can see, −2 Σ U′(r_cut)·δ(r − r_cut) over pairs. The pairs of the run that lie at the
///   cutoff give it, where [`Thermodynamics::set_ends`] has told how the potential ends.
/// - **Temperature of each species** of a mixture.
///
/// All averages share one equilibration cut ([`Thermodynamics::equilibrium`]), so that all are over the same samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Thermodynamics {
    options: ThermodynamicsOptions,
    context: BuildContext,
    seen: SeenBox,
    series: Series<ThermoSeries>,
    of_species: Option<SpeciesTemperatures>,
    energy_line: Line,
    largest_momentum: f64,
    ends: Ends,
    ensemble: Option<Ensemble>,
    bath: Option<HeldTemperature>,
    n_dof: f64,
    mass: f64,
    half_steps: bool,
    curvature: Option<Curvature>,
    confined: Option<Confined>,
}

impl Thermodynamics {
    /// With default options.
    #[must_use]
    pub fn new(context: &BuildContext) -> Self {
        Self::with_options(&ThermodynamicsOptions::default(), context)
    }

    /// With the options given.
    #[must_use]
    pub fn with_options(options: &ThermodynamicsOptions, context: &BuildContext) -> Self {
        Self {
            options: options.clone(),
            context: context.clone(),
            seen: SeenBox::new(&context.cell),
            series: Series::new(ThermoSeries::default(), MOST_ROWS),
            of_species: SpeciesTemperatures::new(&context.species),
            energy_line: Line::default(),
            largest_momentum: 0.0,
            ends: Ends::default(),
            ensemble: None,
            bath: None,
            n_dof: f64::NAN,
            mass: f64::NAN,
            half_steps: false,
            curvature: None,
            confined: None,
        }
    }

    /// Tells how the potential of each pair of species ends, row by row, `[species]²`. None, the default, is right where energy and
    /// force are continuous.
    pub fn set_ends(&mut self, ends: Vec<PairEnd>) {
        self.ends = Ends::new(ends);
    }

    /// Tells the ensemble that the measured stages sample, from whose fluctuations c_v is then taken;
    /// `None`, the default, where the dynamics sample none that is known (velocity scaling).
    pub fn set_ensemble(&mut self, ensemble: Option<Ensemble>) {
        self.ensemble = ensemble;
    }

    /// The time series so far.
    #[must_use]
    pub fn series(&self) -> &ThermoSeries {
        self.series.rows()
    }

    /// Whether the method has half steps, of which [`ThermoSeries::temperature_of_positions`] then is.
    #[must_use]
    pub fn has_half_steps(&self) -> bool {
        self.half_steps
    }

    /// Samples averaged in each row of [`Thermodynamics::series`].
    #[must_use]
    pub fn stride(&self) -> u64 {
        self.series.stride()
    }

    /// The cut of an estimate over rows, told in samples.
    fn in_samples(&self, estimate: Estimate) -> Estimate {
        Estimate {
            equilibration_cut: estimate.equilibration_cut * self.series.stride(),
            ..estimate
        }
    }
}

impl Observable for Thermodynamics {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn want(&self) -> Want {
        Want { laplacian: self.options.configurational_temperature, ..Want::ENERGY_AND_VIRIAL }
    }

    /// # Panics
    /// Where the state lacks what [`Observable::want`] asks for: that is a bug of the caller.
    fn sample(&mut self, view: &View<'_>) {
        if let Some(of_species) = &mut self.of_species {
            of_species.sample(view);
        }
        self.seen.see(view.cell());
        self.n_dof = view.n_dof();
        let n = view.system.n_molecules() as f64;
        if self.mass.is_nan() {
            let masses = &view.system.masses;
            self.mass = view.sum::<f64, 1>(|i| masses.moving(i)) / n;
        }
        self.half_steps = view.half_kick_step.is_some();
        let momentum = view.system.momentum(&view.state.velocities) / n;
        let kept = view.system.kept_part(momentum);
        self.largest_momentum = self.largest_momentum.max(kept.length());
        let row = self.row(view, momentum);
        self.energy_line.push(row.time, row.conserved_energy);
        self.series.push(row.values().as_ref());
    }

    /// As a rule, the part to discard comes from [`Thermodynamics::equilibrium`].
    fn finish(&self, discarded: f64) -> Findings {
        let rows = self.series.rows();
        let cut = (discarded * rows.time.len() as f64).round() as usize;
        let both = rows.kinetic_energy.iter().zip(&rows.potential_energy);
        let total: Vec<f64> = both.map(|(k, u)| k + u).collect();
        let energy = self.context.energy_unit();
        let mut averages = vec![of_series("temperature", "ε/k_B", &rows.temperature, cut)];
        if self.half_steps {
            averages.push(of_series(
                "temperature_half_steps",
                "ε/k_B",
                &rows.temperature_of_positions,
                cut,
            ));
        }
        if self.options.configurational_temperature {
            let (estimate, influence) =
                statistics::ratio(&rows.squared_force, &rows.laplacian, cut);
            averages.push(of_fluctuations(
                "configurational_temperature",
                "ε/k_B",
                estimate,
                &influence,
                FEWEST_INDEPENDENT,
            ));
        }
        for (name, column) in [
            ("potential_energy", &rows.potential_energy),
            ("potential_energy_without_tail", &rows.potential_energy_without_tail),
            ("kinetic_energy", &rows.kinetic_energy),
            ("total_energy", &total),
            ("conserved_energy", &rows.conserved_energy),
        ] {
            averages.push(of_series(name, energy, column, cut));
        }
        for (name, column) in
            [("pressure", &rows.pressure), ("pressure_without_tail", &rows.pressure_without_tail)]
        {
            averages.push(of_series(name, "ε/σ³", column, cut));
        }
        if let Some(ensemble) = self.ensemble {
            averages.extend(heat_capacity::average(ensemble, rows, cut, &self.context, self.n_dof));
        }
        averages.extend(self.responses(cut));
        for average in &mut averages {
            average.estimate = self.in_samples(average.estimate);
        }
        self.doubt_of_confined(&mut averages);
        let mut findings = Findings { averages, ..Findings::default() };
        // Without a sample there is nothing to say of how it was taken.
        let ensemble = self.ensemble.filter(|_| !rows.time.is_empty());
        if let Some(of_species) = &self.of_species {
            of_species.finish(discarded, &mut findings);
        }
        findings.remarks.extend(ensemble.map(|e| e.remark(&self.context, self.n_dof)));
        findings.remark(self.remark_on_responses());
        let measured = rows.measured(self.half_steps, energy);
        findings.tables.push(self.series.table("measured", "thermodynamics", measured));
        for (name, column) in [
            ("potential_energy", &rows.potential_energy),
            ("pressure", &rows.pressure),
            ("temperature", &rows.temperature),
        ] {
            findings.tables.push(
                statistics::blocking_curve(&column[cut.min(column.len())..]).table(
                    &format!("blocking_{name}"),
                    &format!(
                        "apparent standard error of the mean {name} against block size; 1 marks the plateau; a sample is the mean of {}",
                        self.series.stride()
                    ),
                ),
            );
        }
        findings
    }
}

persist!(Thermodynamics {
    series,
    ..of_species,
    seen as "box",
    energy_line as "energy",
    largest_momentum,
    n_dof,
    mass,
    half_steps,
    fixed options, context, ends, ensemble, bath, curvature, confined
});
