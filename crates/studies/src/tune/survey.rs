//! A short run of the sample in the canonical ensemble that keeps, frame by frame, what every truncation and every time
//! step can be judged from: the pairs by distance, U, W, Σ|F|² and ∇²U.

use std::time::{Duration, Instant};

use lennard_core::Want;
use lennard_engine::{EngineError, Follower, Simulation, Verdict};
use lennard_forcefield::{Model, TruncationOptions};
use lennard_observables::{count_distances, statistics};
use lennard_scene::Scene;

use super::TuneError;
use super::sample::Sample;
use crate::jobs::side_by_side;
use crate::settings::{Slopes, Start, Value};

/// Time between two frames, τ: about that in which the pressure forgets itself.
const FRAME_INTERVAL: f64 = 0.06;
/// Width of the bins of distance, σ.
const BIN_WIDTH: f64 = 0.02;
/// The chains part for so long before they are looked at, τ: the same start with other noise.
const PARTING_TIME: f64 = 3.0;

/// One look at the fluid; totals of the system.
struct Frame {
    /// U that the forces conserve, ε.
    potential: f64,
    /// W = Σ r·F, ε.
    virial: f64,
    /// Σ|F|², ε²/σ².
    squared_force: f64,
    /// ∇²U, ε/σ².
    laplacian: f64,
    /// Pairs in each bin of distance.
    pairs: Vec<f32>,
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
    n_dof: f64,
    /// The pair terms of the run.
    run: Terms,
}

struct Watcher<'a> {
    sample: &'a Sample,
    every: u64,
    from: u64,
    end: Instant,
    frames: Vec<Frame>,
}

impl Follower for Watcher<'_> {
    fn want(&self, _scene: &Scene, step: u64, _measured: bool) -> Want {
        if step.is_multiple_of(self.every) {
            Want::TOTALS
        } else {
            Want::NOTHING
        }
    }

    fn after_step(&mut self, simulation: &mut Simulation) -> Result<Verdict, EngineError> {
        let state = &simulation.state;
        if !state.step.is_multiple_of(self.every) || state.step < self.from {
            return Ok(Verdict::Continue);
        }
        let e = &state.energetics;
        let asked = "the step was asked for totals";
        let bins = bins_within(self.sample.sight);
        let reach = bins as f64 * BIN_WIDTH;
        let counts = count_distances(&state.positions, &simulation.cell, reach, bins);
        self.frames.push(Frame {
            potential: e.conserved_potential.expect(asked),
            virial: e.scalar_virial().expect(asked),
            squared_force: state.forces.iter().map(|f| f.length_squared()).sum(),
            laplacian: e.laplacian.expect(asked),
            pairs: counts.iter().map(|c| *c as f32).collect(),
        });
        let over = Instant::now() >= self.end;
        Ok(if over {
            Verdict::Stop
        } else {
            Verdict::Continue
        })
    }
}

impl Survey {
    /// Runs one chain a thread for so long.
    pub fn run(
        sample: &Sample,
        budget: Duration,
        done: impl FnMut(f64),
    ) -> Result<Self, TuneError> {
        let chains: Vec<u64> = (0..rayon::current_num_threads() as u64).collect();
        let dt = sample.canonical.integrator.dt;
        let end = Instant::now() + budget;
        let run = |chain: &u64| -> Result<(Vec<Frame>, Start, f64), TuneError> {
            let mut scene = sample.canonical.clone();
            scene.system.seed = scene.system.seed.wrapping_add(1000 + chain);
            let mut watcher = Watcher {
                sample,
                every: ((FRAME_INTERVAL / dt).round() as u64).max(1),
                from: (PARTING_TIME / dt) as u64,
                end,
                frames: Vec::new(),
            };
            let mut simulation = lennard_engine::assembled(scene, sample.start.beginning())?;
            simulation.run(&mut watcher)?;
            let time = simulation.state.time - PARTING_TIME;
            let end = Start {
                cell: simulation.cell,
                positions: simulation.state.positions,
                velocities: simulation.state.velocities,
            };
            Ok((watcher.frames, end, time))
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
            n_dof: 3.0 * n_atoms - 3.0,
            run: Terms::of(
                &sample.canonical,
                sample.canonical.truncation,
                sample.start.len(),
                volume,
                sample.sight,
            )?,
        };
        for found in side_by_side(&chains, run, done) {
            let (frames, end, time) = found?;
            survey.frames.extend(frames);
            survey.ends.push(end);
            survey.time += time;
        }
        Ok(survey)
    }

    /// The pair terms of another truncation of the potential that ran.
    pub fn terms(&self, scene: &Scene, truncation: TruncationOptions) -> Result<Terms, TuneError> {
        let sight = self.run.energy.len() as f64 * BIN_WIDTH;
        Terms::of(scene, truncation, self.n_atoms as usize, self.volume, sight)
    }

    /// Number density, σ⁻³.
    pub fn density(&self) -> f64 {
        self.n_atoms / self.volume
    }

    /// g(r) at a distance, from all frames.
    pub fn g(&self, r: f64) -> f64 {
        let bin = ((r / BIN_WIDTH) as usize).min(self.frames[0].pairs.len() - 1);
        let mean = statistics::mean(&self.series(|f| f64::from(f.pairs[bin])));
        let (low, high) = (bin as f64 * BIN_WIDTH, (bin + 1) as f64 * BIN_WIDTH);
        let shell = 4.0 / 3.0 * std::f64::consts::PI * (high.powi(3) - low.powi(3));
        mean / (0.5 * self.n_atoms * self.density() * shell)
    }

    fn series(&self, of: impl Fn(&Frame) -> f64) -> Vec<f64> {
        self.frames.iter().map(of).collect()
    }

    /// U a particle and the configurational part W/(3V) of the pressure, of the model that ran, without tail.
    fn own(&self) -> (Vec<f64>, Vec<f64>) {
        (
            self.series(|f| f.potential / self.n_atoms),
            self.series(|f| f.virial / (3.0 * self.volume)),
        )
    }

    /// How U and P change with temperature at constant density, from their fluctuations with U:
    /// ∂⟨A⟩/∂T = ⟨δA δU⟩/T².
    pub fn slopes(&self) -> Slopes {
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

    /// The coefficients of dt² in the errors of U and P that velocity Verlet makes at the kinetic temperature that it
    /// shows.
    ///
    /// Velocity Verlet samples exp(−H̃/T̃) of its shadow Hamiltonian H̃ = H + h²·(pᵀ·∇∇U·p/12 − |∇U|²/24) exactly to
    /// this order (E. Hairer, C. Lubich and G. Wanner, Geometric Numerical Integration, IX.3). Integrated over p:
    /// positions follow U + h²X with X = −|∇U|²/24 + T·∇²U/12, and the kinetic temperature shown is
    /// T = T̃·(1 − h²ω²/6) with ω² = ⟨∇²U⟩/n_dof. At that temperature A is off by
    /// h²·(ω²/(6T)·⟨δA δU⟩ − ⟨δA δX⟩/T); an oscillator gives the exact ⟨U⟩·h²ω²/4.
    pub fn step_law(&self) -> [Value; 2] {
        let t = self.temperature;
        let frequency = statistics::mean(&self.series(|f| f.laplacian)) / self.n_dof;
        let total = self.series(|f| f.potential);
        let x = self.series(|f| -f.squared_force / 24.0 + t * f.laplacian / 12.0);
        let (energy, pressure) = self.own();
        [energy, pressure].map(|a| {
            let (with_u, with_x) = (products(&a, &total), products(&a, &x));
            let z: Vec<f64> = with_u
                .iter()
                .zip(&with_x)
                .map(|(u, x)| (frequency / 6.0 * u - x) / t)
                .collect();
            statistics::estimate_stationary(&z).into()
        })
    }

    /// What a truncation changes in U and P against another one, at equal temperature: what its pairs and its tail say
    /// of the same frames, and the change of structure by the forces that differ, to first order:
    /// Δ⟨A⟩ = ⟨A_c − A_f⟩ − (⟨δA_c δ(U_c − U)⟩ − ⟨δA_f δ(U_f − U)⟩)/T, where U is the energy of the run.
    pub fn difference(&self, c: &Terms, f: &Terms) -> [Change; 2] {
        let run = &self.run;
        let (own_u, own_p) = self.own();
        let series = |weights: &[f64]| self.series(|frame| dot(&frame.pairs, weights));
        let less =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        // Energies of the whole system whose gradients differ from the forces of the run.
        let more = |terms: &Terms| series(&less(&terms.conserved, &run.conserved));
        let (more_c, more_f) = (more(c), more(f));
        let energy = (
            &own_u,
            1.0 / self.n_atoms,
            [&c.energy, &f.energy, &run.conserved],
        );
        let pressure = (
            &own_p,
            1.0 / (3.0 * self.volume),
            [&c.virial, &f.virial, &run.virial],
        );
        let tails = [c.tail[0] - f.tail[0], c.tail[1] - f.tail[1]];
        [(energy, tails[0]), (pressure, tails[1])].map(|((own, scale, weights), tail)| {
            let [in_c, in_f, in_run] = weights;
            let at = |weights: &[f64]| -> Vec<f64> {
                let more = series(&less(weights, in_run));
                own.iter()
                    .zip(more)
                    .map(|(own, more)| own + scale * more)
                    .collect()
            };
            let (a_c, a_f) = (at(in_c), at(in_f));
            let direct: Vec<f64> = less(&a_c, &a_f).iter().map(|d| d + tail).collect();
            let response: Vec<f64> = products(&a_c, &more_c)
                .iter()
                .zip(products(&a_f, &more_f))
                .map(|(c, f)| -(c - f) / self.temperature)
                .collect();
            Change {
                direct: statistics::estimate_stationary(&direct).into(),
                response: statistics::estimate_stationary(&response).into(),
            }
        })
    }
}

/// How two truncations differ in a mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Change {
    /// On the same configurations.
    pub direct: Value,
    /// By the change of structure.
    pub response: Value,
}

impl Change {
    /// The sum, in which the response counts as far as it stands out of its noise: r³/(r² + e²) for r ± e, so that a
    /// response that is lost in noise adds an uncertainty and no error.
    pub fn total(&self) -> Value {
        let (r, e) = (self.response.mean, self.response.standard_error);
        let weight = if r == 0.0 {
            0.0
        } else {
            r * r / (r * r + e * e)
        };
        let unsure = e * weight.sqrt().max(0.5);
        Value {
            mean: self.direct.mean + weight * r,
            standard_error: self.direct.standard_error.hypot(unsure),
            n_effective: self.response.n_effective,
        }
    }
}

/// A truncated potential, bin by bin of distance.
#[derive(Debug, Clone)]
pub(super) struct Terms {
    /// U(r), ε.
    energy: Vec<f64>,
    /// U(r) of which the forces are the gradient, ε.
    conserved: Vec<f64>,
    /// r·F(r), ε.
    virial: Vec<f64>,
    /// Tail corrections of U a particle and of P.
    tail: [f64; 2],
}

impl Terms {
    /// Of a truncation of the scene's potential; cutoffs beyond the sight of the survey end there.
    pub fn of(
        scene: &Scene,
        truncation: TruncationOptions,
        n_atoms: usize,
        volume: f64,
        sight: f64,
    ) -> Result<Self, TuneError> {
        let bins = bins_within(sight);
        let sight = bins as f64 * BIN_WIDTH;
        let truncation = TruncationOptions {
            r_cut: truncation.r_cut.min(sight),
            ..truncation
        };
        let model = Model::new(&scene.potential, &truncation)
            .map_err(|e| scene.source.invalid(e.key(), e.found(), e.allowed()))?;
        let mut terms = Self {
            energy: vec![0.0; bins],
            conserved: vec![0.0; bins],
            virial: vec![0.0; bins],
            tail: [0.0; 2],
        };
        // Below half a diameter no pair is ever found.
        for bin in (0.5 / BIN_WIDTH) as usize..bins {
            let low = bin as f64 * BIN_WIDTH;
            let share = ((model.r_cut - low) / BIN_WIDTH).clamp(0.0, 1.0);
            if share == 0.0 {
                break;
            }
            let r = low + 0.5 * share * BIN_WIDTH;
            let pair = model.eval(r * r);
            terms.energy[bin] = share * pair.energy;
            terms.conserved[bin] = share * (pair.energy - model.energy_at_cutoff);
            terms.virial[bin] = share * r * r * pair.force;
        }
        let mut options = scene.force_field();
        options.truncation = truncation;
        let tail = lennard_forcefield::tail_correction(&options, n_atoms, volume);
        if let Some(tail) = tail {
            terms.tail = [tail.energy_per_particle, tail.pressure];
        }
        Ok(terms)
    }
}

/// Whole bins up to a distance.
fn bins_within(sight: f64) -> usize {
    // The share of a bin that rounding may take is no bin.
    (sight / BIN_WIDTH + 1e-6) as usize
}

fn dot(counts: &[f32], weights: &[f64]) -> f64 {
    counts
        .iter()
        .zip(weights)
        .map(|(c, w)| f64::from(*c) * w)
        .sum()
}

/// δa·δb, frame by frame.
fn products(a: &[f64], b: &[f64]) -> Vec<f64> {
    let (mean_a, mean_b) = (statistics::mean(a), statistics::mean(b));
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - mean_a) * (b - mean_b))
        .collect()
}
