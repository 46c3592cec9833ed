//! How the energy drifts with the time step: the jump of the force at a cutoff, and the end of stability.

use std::f64::consts::PI;

use lennard_forcefield::{Model, TruncationKind, TruncationOptions};
use lennard_scene::Scene;

use super::TuneError;
use super::sample::Sample;
use super::survey::Survey;
use super::terms::model_of;
use crate::jobs::side_by_side_quietly;
use crate::lab::{Failed, Workbench};
use crate::settings::Settings;

/// Steps at which stability is tried, as shares of the rough limit.
pub(super) const RUNGS: [f64; 7] = [0.25, 0.28, 0.32, 0.36, 0.40, 0.45, 0.50];
/// Shortest run on a rung, τ: less does not tell a drift of 10⁻⁵.
const SHORTEST_RUNG: f64 = 80.0;
/// Without a wanted drift, a step is stable that drifts less than this: 10⁻³ ε/τ per particle is a per cent of T in ten τ.
const LARGEST_DRIFT: f64 = 1e-3;
/// Standard errors from which on a drift counts as seen.
const SEEN: f64 = 3.0;

/// One try at a long step, with a truncation that ends smoothly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rung {
    /// The step, τ.
    pub dt: f64,
    /// Its drift with standard error, ε/τ per particle; `None` where the run failed.
    pub drift: Option<(f64, f64)>,
}

/// The largest step that may be taken, and the drift that a step brings.
#[derive(Debug, Clone)]
pub(super) struct Stability {
    /// ln|drift| = a − b/dt, where two rungs were seen to drift.
    law: Option<(f64, f64)>,
    /// The largest step that may be taken, τ.
    pub ceiling: f64,
}

impl Stability {
    /// Climbs the rungs at constant energy, `seconds` each.
    pub fn measure(
        sample: &Sample,
        survey: &Survey,
        wanted: Option<f64>,
        seconds: f64,
    ) -> Result<Self, TuneError> {
        let mut scene = sample.own.clone();
        scene.stages = sample.canonical.stages.clone();
        for stage in &mut scene.stages {
            stage.thermostat = None;
            stage.barostat = None;
        }
        let bench = Workbench::with_start(&scene, survey.ends[0].clone());
        let limit = sample.own.integrator.method.spec().stability_limit;
        let limit = limit.unwrap_or(super::sample::VERLET_LIMIT) / super::sample::VERLET_LIMIT;
        let r_cut = sample.careful().truncation.r_cut.min(2.5);
        let smooth = sample.careful().with_truncation(TruncationKind::Switch, r_cut, false);
        let slopes = survey.slopes();
        let climb = |share: &f64| -> Result<Rung, TuneError> {
            let dt = share * limit * sample.stable_dt;
            let settings = Settings { dt, ..smooth.clone() };
            let found = super::affordable(&bench, &settings, seconds)
                .and_then(|time| Ok(bench.measure(&settings, time.max(SHORTEST_RUNG), &slopes)?));
            match found {
                Ok(m) => Ok(Rung { dt, drift: Some((m.drift.slope, m.drift.standard_error)) }),
                Err(TuneError::Study(error)) => {
                    Failed::from_error(error)?;
                    Ok(Rung { dt, drift: None })
                }
                Err(other) => Err(other),
            }
        };
        let rungs: Vec<Rung> =
            side_by_side_quietly(&RUNGS, climb).into_iter().collect::<Result<_, _>>()?;
        Ok(Self::of(&rungs, wanted))
    }

    fn of(rungs: &[Rung], wanted: Option<f64>) -> Self {
        let limit = wanted.unwrap_or(LARGEST_DRIFT);
        // A drift that is not known to be small is not small.
        let good = |rung: &&Rung| {
            let bound = |(drift, error): (f64, f64)| drift.abs() + error;
            rung.drift.is_some_and(|found| bound(found) <= limit)
        };
        let ceiling = rungs.iter().take_while(good).last().map(|r| r.dt);
        let seen: Vec<(f64, f64)> = rungs
            .iter()
            .filter_map(|r| Some((r.dt, r.drift?)))
            .filter(|(_, (drift, error))| drift.abs() > SEEN * error)
            .map(|(dt, (drift, _))| (1.0 / dt, drift.abs().ln()))
            .collect();
        let law = match seen.as_slice() {
            [.., (x1, y1), (x2, y2)] if y2 > y1 => {
                let b = (y2 - y1) / (x1 - x2);
                Some((y2 + b * x2, b))
            }
            _ => None,
        };
        // Where even the shortest rung drifts too much, half of it is what is left to be verified.
        let shortest = rungs.first().map_or(0.0, |r| 0.5 * r.dt);
        Self { law, ceiling: ceiling.unwrap_or(shortest) }
    }

    /// The drift that the step brings, ε/τ per particle: exponentially small below the limit.
    pub fn of_step(&self, dt: f64) -> f64 {
        self.law.map_or(0.0, |(a, b)| (a - b / dt).exp())
    }
}

/// The drift that a jump of the force at the cutoff brings, ε/τ per particle.
///
/// A pair that crosses r_cut at a share α of a step gains the energy F·v·h·(α − ½), with the jump F and the radial
/// speed v. The mean of this is zero, and its variance F²v²h²/12. The map is reversible and keeps volume in phase
/// space, so energy diffuses towards more states. The drift is half the growth of the variance over T. Pairs cross at
/// the rate ½Nρ·4πr²g(r)⟨|v|⟩, and ⟨|v|³⟩ = 2√(2/π)·(T/μ)^{3/2} for relative velocities with the reduced mass μ. Species
/// add up pair by pair.
pub(super) fn of_jump(
    scene: &Scene,
    truncation: TruncationOptions,
    survey: &Survey,
    dt: f64,
) -> Result<f64, TuneError> {
    let mut scene = scene.clone();
    scene.truncation = truncation;
    let (t, fluid) = (survey.temperature, &survey.fluid);
    // Bonds held rigid take degrees of freedom from the sites.
    let share = fluid.n_dof() / (3.0 * survey.n_atoms - 3.0);
    let mut growth = 0.0;
    for (i, kind) in fluid.kinds.iter().enumerate() {
        let [a, b] = kind.species;
        let pair = scene.species_pair(a, b);
        let model = model_of(&scene, &pair)?;
        growth += Crossing {
            model: &model,
            sigma: pair.sigma,
            epsilon: pair.epsilon,
            pairs: kind.pairs / (fluid.units() * survey.volume),
            g: survey.g(i, model.r_cut * pair.sigma),
            squared_speed: share * t * kind.inverse_mass(),
        }
        .variance_growth(dt);
    }
    Ok(0.5 * growth / t)
}

/// Pairs of one kind that cross their cutoff.
struct Crossing<'a> {
    /// f of u = ε·f(r/σ).
    model: &'a Model,
    sigma: f64,
    epsilon: f64,
    /// Pairs for each volume and each particle or molecule, σ⁻³.
    pairs: f64,
    /// g at the cutoff.
    g: f64,
    /// Mean square of a relative velocity along one axis, (σ/τ)²: T over the reduced mass.
    squared_speed: f64,
}

impl Crossing<'_> {
    /// How fast the variance of the energy grows by these, ε²/τ a particle or molecule.
    fn variance_growth(&self, dt: f64) -> f64 {
        let x = self.model.r_cut;
        let r = x * self.sigma;
        let jump = self.model.eval(x * x).force * x * self.epsilon / self.sigma;
        let crossings = self.pairs * 4.0 * PI * r * r * self.g;
        let cubed_speed = 2.0 * (2.0 / PI).sqrt() * self.squared_speed.powf(1.5);
        crossings * cubed_speed * (jump * dt).powi(2) / 12.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ceiling_is_the_last_rung_before_the_drift_and_the_law_passes_through_what_is_seen() {
        let rung = |dt, drift| Rung { dt, drift };
        let rungs = vec![
            rung(0.010, Some((1e-7, 2e-7))),
            rung(0.012, Some((1e-5, 2e-7))),
            rung(0.016, Some((8e-4, 2e-7))),
            rung(0.020, None),
        ];
        let free = Stability::of(&rungs, None);
        assert_eq!(free.ceiling, 0.016);
        assert!((free.of_step(0.012) / 1e-5 - 1.0).abs() < 1e-9);
        assert!((free.of_step(0.016) / 8e-4 - 1.0).abs() < 1e-9);
        assert!(free.of_step(0.006) < 1e-10);
        assert_eq!(Stability::of(&rungs, Some(2e-5)).ceiling, 0.012);
        assert_eq!(Stability::of(&rungs[3..], None).ceiling, 0.010);
        // What a short run cannot tell is not taken for good.
        assert_eq!(Stability::of(&rungs, Some(2e-7)).ceiling, 0.005);
    }

    /// Looks at energy and neighbors of a running fluid.
    struct Looks {
        every: u64,
        schedule: lennard_engine::Schedule,
        energies: Vec<f64>,
        temperatures: Vec<f64>,
        shell: Vec<f64>,
        r_cut: f64,
    }

    impl lennard_engine::Follower for Looks {
        fn schedule(&self) -> &lennard_engine::Schedule {
            &self.schedule
        }

        fn after_step(
            &mut self,
            simulation: &mut lennard_engine::Simulation,
        ) -> Result<std::ops::ControlFlow<()>, lennard_engine::EngineError> {
            let state = &simulation.state;
            if state.step.is_multiple_of(self.every) {
                let n = state.len() as f64;
                let energy = simulation.conserved_energy_per_particle().unwrap();
                self.energies.push(energy * n);
                self.temperatures.push(simulation.view().temperature());
                // Pairs in the last twentieth of a diameter below the cutoff.
                let bins = (self.r_cut / 0.05).round() as usize;
                let counts = lennard_observables::count_distances(
                    &state.positions,
                    &simulation.state.cell,
                    self.r_cut,
                    bins,
                );
                self.shell.push(*counts.last().unwrap() as f64);
            }
            Ok(std::ops::ControlFlow::Continue(()))
        }
    }

    #[test]
    fn energy_diffuses_by_crossings_of_the_cutoff_as_the_law_says() {
        // A cutoff of 1.5 σ, where the force jumps by 1.2 ε/σ, drowns every other error of the step.
        const TEXT: &str = "[system]\nn_atoms = 256\ndensity = 0.6\ntemperature = 1.2\n\
            [truncation]\nr_cut = 1.5\n[integrator]\ndt = 0.004\n\
            [[stage]]\nname = \"heat\"\nsteps = 1500\nthermostat = \"bussi\"\n\
            [[stage]]\nname = \"p\"\nsteps = 40000\n";
        let scene = Scene::parse(TEXT, "test.toml", &[]).unwrap();
        let (dt, r_cut) = (scene.integrator.dt, scene.truncation.r_cut);
        let mut simulation = lennard_engine::prepare(scene.clone()).unwrap();
        let every = 125;
        let mut looks = Looks {
            every,
            schedule: std::iter::once(
                lennard_engine::Operation::new(
                    lennard_engine::Action::Call,
                    lennard_engine::Trigger::Every(every),
                )
                .wanting(lennard_core::Want::ENERGY),
            )
            .collect(),
            energies: vec![],
            temperatures: vec![],
            shell: vec![],
            r_cut,
        };
        simulation.run(&mut looks).unwrap();
        // The heat bath's work is counted apart; its stage is left out.
        let from = 1500 / every as usize + 1;
        let energies = &looks.energies[from..];
        let steps: Vec<f64> = energies.windows(2).map(|w| (w[1] - w[0]).powi(2)).collect();
        let time = every as f64 * dt;
        let measured = lennard_observables::statistics::mean(&steps) / (256.0 * time);
        let volume = 4.0 / 3.0 * PI * (r_cut.powi(3) - (r_cut - 0.05).powi(3));
        let pairs = lennard_observables::statistics::mean(&looks.shell[from..]);
        let g = pairs / (0.5 * 256.0 * 0.6 * volume);
        let t = lennard_observables::statistics::mean(&looks.temperatures[from..]);
        let model = Model::new(&scene.potential, &scene.truncation).unwrap();
        let law = Crossing {
            model: &model,
            sigma: 1.0,
            epsilon: 1.0,
            pairs: 0.5 * 0.6,
            g,
            squared_speed: 2.0 * t,
        }
        .variance_growth(dt);
        // 307 squares of normal increments know their mean to 8 %; the bounded error of the step adds some per cent.
        assert!((measured / law - 1.0).abs() < 0.3, "{measured:e} {law:e}");
    }
}
