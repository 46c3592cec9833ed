//! A short run of the sample in the canonical ensemble. Frame by frame it keeps the pairs by distance, U, W, Σ|F|² and
//! ∇²U. From these, every truncation and every time step can be judged.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use lennard_core::Want;
use lennard_engine::{Action, EngineError, Follower, Operation, Schedule, Simulation, Trigger};
use lennard_forcefield::TruncationOptions;
use lennard_observables::{Estimate, statistics};
use lennard_scene::Scene;

use super::pairs::{BIN_WIDTH, Change, Counts, Fluid, Terms, bins_within, dot};
use super::sample::Sample;
use crate::StudyError;
use crate::jobs::side_by_side;
use crate::lab::{Slopes, Start};

/// Time between two frames, τ: about that in which the pressure forgets itself.
const FRAME_INTERVAL: f64 = 0.06;
/// Frames of each chain, however little time there is: fewer have no errors.
const FEWEST_FRAMES: usize = 60;
/// Time, τ, in which the chains part before their frames count: they have one start and different noise.
const PARTING_TIME: f64 = 3.0;

/// One look at the fluid; totals of the system.
struct Frame {
    /// U that the forces conserve, ε.
    potential: f64,
    /// W = Σ r·F, ε; of molecules Σ R·F.
    virial: f64,
    /// Σ|F|²/m, ε²/(m·σ²).
    squared_force: f64,
    /// Σ∇²U/m, ε/(m·σ²), where the masses are alike; else the sums of bins have it.
    laplacian: Option<f64>,
    /// Pairs in each bin of distance.
    counts: Counts,
}

/// What a run of the sample says.
pub(super) struct Survey {
    frames: Vec<Frame>,
    /// Where each chain ended.
    pub ends: Vec<Start>,
    /// Simulated time of all chains, τ.
    pub time: f64,
    /// Temperature, ε/k_B.
    pub temperature: f64,
    /// Particles.
    pub n_atoms: f64,
    /// Volume, σ³.
    pub volume: f64,
    /// What it is made of.
    pub fluid: Fluid,
    /// The pair terms of the run.
    run: Terms,
}

struct Watcher<'a> {
    sample: &'a Sample,
    every: u64,
    schedule: Schedule,
    from: u64,
    end: Instant,
    frames: Vec<Frame>,
}

impl Follower for Watcher<'_> {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn after_step(&mut self, simulation: &mut Simulation) -> Result<ControlFlow<()>, EngineError> {
        let state = &simulation.state;
        if !state.step.is_multiple_of(self.every) || state.step < self.from {
            return Ok(ControlFlow::Continue(()));
        }
        let e = &state.energetics;
        let asked = "the step was asked for totals";
        let fluid = &self.sample.fluid;
        let masses = &fluid.system().masses;
        let inside = match fluid.has_bonds() {
            true => simulation.view().intramolecular_virial(),
            false => 0.0,
        };
        let squares = state.forces.iter().enumerate();
        self.frames.push(Frame {
            potential: e.conserved_potential.expect(asked),
            virial: e.scalar_virial().expect(asked) - inside,
            squared_force: squares.map(|(i, f)| f.length_squared() / masses.of(i)).sum(),
            laplacian: (fluid.common_mass().zip(e.laplacian)).map(|(m, laplacian)| laplacian / m),
            counts: fluid.count(state, bins_within(self.sample.sight)),
        });
        let over = Instant::now() >= self.end && self.frames.len() >= FEWEST_FRAMES;
        Ok(if over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    }
}

impl Survey {
    /// Runs one chain per thread until `budget` is spent.
    pub fn run(sample: &Sample, budget: Duration) -> Result<Self, StudyError> {
        let chains: Vec<u64> = (0..rayon::current_num_threads() as u64).collect();
        let dt = sample.canonical.integrator.dt;
        let end = Instant::now() + budget;
        let run = |chain: &u64| -> Result<(Vec<Frame>, Start, f64), StudyError> {
            let mut scene = sample.canonical.clone();
            scene.system.seed = scene.system.seed.wrapping_add(1000 + chain);
            let every = ((FRAME_INTERVAL / dt).round() as u64).max(1);
            let frames = Operation::new(Action::Call, Trigger::Every(every)).wanting(Want::TOTALS);
            let mut watcher = Watcher {
                sample,
                every,
                schedule: Schedule::empty().with(frames),
                from: (PARTING_TIME / dt) as u64,
                end,
                frames: Vec::new(),
            };
            let mut simulation = sample.start.simulation(scene)?;
            simulation.follow(&mut watcher)?;
            let time = simulation.state.time - PARTING_TIME;
            Ok((watcher.frames, simulation.into(), time))
        };
        let n_atoms = sample.start.len() as f64;
        let volume = sample.start.cell.volume();
        let mut survey = Self {
            frames: Vec::new(),
            ends: Vec::new(),
            time: 0.0,
            temperature: sample.temperature,
            n_atoms,
            volume,
            fluid: sample.fluid.clone(),
            run: Terms::of(
                &sample.canonical,
                sample.canonical.truncation,
                &sample.fluid,
                volume,
                sample.sight,
            )?,
        };
        for found in side_by_side(&chains, run, |_| {}) {
            let (frames, end, time) = found?;
            survey.frames.extend(frames);
            survey.ends.push(end);
            survey.time += time;
        }
        Ok(survey)
    }

    /// The pair terms of another truncation of the potential that ran.
    pub(crate) fn terms(
        &self,
        scene: &Scene,
        truncation: TruncationOptions,
    ) -> Result<Terms, StudyError> {
        let sight = self.bins() as f64 * BIN_WIDTH;
        Terms::of(scene, truncation, &self.fluid, self.volume, sight)
    }

    /// Bins of distance of each kind of pairs.
    fn bins(&self) -> usize {
        self.run.energy.len() / self.fluid.kinds.len()
    }

    /// Number density of molecules, σ⁻³; of particles where there are none.
    pub fn density(&self) -> f64 {
        self.fluid.units() / self.volume
    }

    /// g(r) of one kind of pairs at a distance, from all frames.
    pub fn g(&self, kind: usize, r: f64) -> f64 {
        let bin = ((r / BIN_WIDTH) as usize).min(self.bins() - 1);
        let at = kind * self.bins() + bin;
        let mean = statistics::mean(&self.series(|f| f64::from(f.counts.pairs[at])));
        let (low, high) = (bin as f64 * BIN_WIDTH, (bin + 1) as f64 * BIN_WIDTH);
        let shell = 4.0 / 3.0 * std::f64::consts::PI * (high.powi(3) - low.powi(3));
        mean / (self.fluid.kinds[kind].pairs / self.volume * shell)
    }

    fn series(&self, of: impl Fn(&Frame) -> f64) -> Vec<f64> {
        self.frames.iter().map(of).collect()
    }

    /// U a particle and the configurational part W/(3V) of the pressure, of the model that ran, without tail.
    fn own(&self) -> (Vec<f64>, Vec<f64>) {
        (
            self.series(|f| f.potential / self.fluid.units()),
            self.series(|f| f.virial / (3.0 * self.volume)),
        )
    }

    /// How U and P change with temperature at constant density, from their fluctuations with U:
    /// ∂⟨A⟩/∂T = ⟨δA δU⟩/T².
    pub(crate) fn slopes(&self) -> Slopes {
        let (energy, pressure) = self.own();
        let total = self.series(|f| f.potential);
        let t2 = self.temperature.powi(2);
        Slopes {
            temperature: self.temperature,
            du_dt: statistics::mean(&products(&energy, &total)) / t2,
            dp_dt: self.density() + statistics::mean(&products(&pressure, &total)) / t2,
            source: "fluctuations of the survey".into(),
        }
    }

    /// Σ∇²U/m, frame by frame, ε/(m·σ²).
    fn laplacians(&self) -> Vec<f64> {
        self.series(|f| {
            let of_bins = || dot(&f.counts.pairs, &self.run.laplacian);
            f.laplacian.unwrap_or_else(of_bins)
        })
    }

    /// The coefficients of dt² in the errors of U and P that velocity Verlet makes, at the temperature of half steps or of
    /// whole steps.
    ///
    /// Velocity Verlet samples exp(−H̃/T̃) of its shadow Hamiltonian H̃ = H + h²·(pᵀ·∇∇U·p/12 − |∇U|²/24) exactly to
    /// this order, here for unit masses (E. Hairer, C. Lubich and G. Wanner, Geometric Numerical Integration, IX.3). Integrated over p,
    /// positions follow U + h²X with X = −|∇U|²/24 + T·∇²U/12. The kinetic temperature of whole steps is T̃·(1 − h²ω²/6)
    /// with ω² = ⟨∇²U⟩/n_dof, and the temperature of half steps is higher by T·h²ω²/4. At a temperature T̃·(1 − c·h²ω²)
    /// a quantity A is off by h²·(c·ω²·⟨δA δU⟩ − ⟨δA δX⟩)/T. For an oscillator this is zero at half steps, and the exact
    /// ⟨U⟩·h²ω²/4 at whole steps. With other masses |∇U|² is Σ|∇_iU|²/m_i and ∇²U is Σ∇_i²U/m_i.
    pub(crate) fn step_law(&self, half_steps: bool) -> [Estimate; 2] {
        let t = self.temperature;
        let c = if half_steps { -1.0 / 12.0 } else { 1.0 / 6.0 };
        let laplacians = self.laplacians();
        let frequency = statistics::mean(&laplacians) / self.fluid.n_dof();
        let total = self.series(|f| f.potential);
        let frames = self.frames.iter().zip(&laplacians);
        let x: Vec<f64> =
            frames.map(|(f, laplacian)| -f.squared_force / 24.0 + t * laplacian / 12.0).collect();
        let (energy, pressure) = self.own();
        [energy, pressure].map(|a| {
            let (with_u, with_x) = (products(&a, &total), products(&a, &x));
            let z: Vec<f64> =
                with_u.iter().zip(&with_x).map(|(u, x)| (c * frequency * u - x) / t).collect();
            statistics::estimate_stationary(&z)
        })
    }

    /// What a truncation changes in U and P against another one, at equal temperature and to first order. The first
    /// term compares pairs and tails over the same frames. The second is the change of structure by the different
    /// forces: Δ⟨A⟩ = ⟨A_c − A_f⟩ − (⟨δA_c δ(U_c − U)⟩ − ⟨δA_f δ(U_f − U)⟩)/T, where U is the energy of the run.
    pub(crate) fn difference(&self, c: &Terms, f: &Terms) -> [Change; 2] {
        let run = &self.run;
        let (own_u, own_p) = self.own();
        let series = |weights: &[f64]| self.series(|frame| dot(&frame.counts.pairs, weights));
        let of_virial = |weights: &[f64]| {
            self.series(|Frame { counts, .. }| {
                dot(counts.leverage.as_ref().unwrap_or(&counts.pairs), weights)
            })
        };
        let less =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        // Energies of the whole system whose gradients differ from the forces of the run.
        let more = |terms: &Terms| series(&less(&terms.conserved, &run.conserved));
        let (more_c, more_f) = (more(c), more(f));
        let energy = (&own_u, 1.0 / self.fluid.units(), [&c.energy, &f.energy, &run.conserved]);
        let pressure = (&own_p, 1.0 / (3.0 * self.volume), [&c.virial, &f.virial, &run.virial]);
        let tails = [c.tail[0] - f.tail[0], c.tail[1] - f.tail[1]];
        let quantities = [(energy, tails[0], false), (pressure, tails[1], true)];
        quantities.map(|((own, scale, weights), tail, is_virial)| {
            let [in_c, in_f, in_run] = weights;
            let at = |weights: &[f64]| -> Vec<f64> {
                let weights = less(weights, in_run);
                let more = match is_virial {
                    true => of_virial(&weights),
                    false => series(&weights),
                };
                own.iter().zip(more).map(|(own, more)| own + scale * more).collect()
            };
            let (a_c, a_f) = (at(in_c), at(in_f));
            let direct: Vec<f64> = less(&a_c, &a_f).iter().map(|d| d + tail).collect();
            let response: Vec<f64> = products(&a_c, &more_c)
                .iter()
                .zip(products(&a_f, &more_f))
                .map(|(c, f)| -(c - f) / self.temperature)
                .collect();
            Change {
                direct: statistics::estimate_stationary(&direct),
                response: statistics::estimate_stationary(&response),
            }
        })
    }
}

/// δa·δb, frame by frame.
fn products(a: &[f64], b: &[f64]) -> Vec<f64> {
    let (mean_a, mean_b) = (statistics::mean(a), statistics::mean(b));
    a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).collect()
}

#[cfg(test)]
mod tests;
