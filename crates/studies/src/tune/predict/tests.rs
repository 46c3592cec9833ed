//! The ceiling of the step, and the law of the drift by crossings of the cutoff.

use super::*;

#[test]
fn the_ceiling_is_the_last_rung_before_the_drift_and_the_law_passes_through_what_is_seen() {
    let rung = |dt, drift| Rung { dt, drift };
    let drift = |mean| Some(Estimate::new(mean, 2e-7, f64::NAN));
    let rungs = vec![
        rung(0.010, drift(1e-7)),
        rung(0.012, drift(1e-5)),
        rung(0.016, drift(8e-4)),
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
    simulation.follow(&mut looks).unwrap();
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
    let pair = scene.species_pair(0, 0);
    let law = variance_growth(&model, &pair, 0.5 * 0.6 * g, 2.0 * t, dt);
    // 307 squares of normal increments know their mean to 8 %; the bounded error of the step adds some per cent.
    assert!((measured / law - 1.0).abs() < 0.3, "{measured:e} {law:e}");
}
