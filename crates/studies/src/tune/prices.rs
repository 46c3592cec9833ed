//! The cost of a step for every cutoff, from a few timings.

use lennard_forcefield::Precision;
use lennard_scene::{Scene, Stage};

use super::sample::{Sample, lattice_of};
use crate::StudyError;
use crate::lab::{Start, Workbench, costs};
use crate::settings::Settings;

/// Cutoffs timed, σ.
const NODES: [f64; 7] = [2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0];
/// Repeats of each timing, in another order each time.
const REPEATS: usize = 3;
/// Scenes of up to 4·14³ particles are timed at their own size. Larger scenes are timed at this size, where caches and
/// lists look alike.
const TIMED_UP_TO: usize = 10_976;
/// Steps that bring a larger stand-in near its equilibrium: a melted lattice has the neighbors of the fluid.
const MELTING_STEPS: u64 = 400;

/// Prices of a step by cutoff and precision.
pub(super) struct Prices {
    /// The scene, equilibrated, at the size that is timed.
    pub bench: Workbench,
    /// For each precision: r_cut³ and seconds for each particle and step.
    nodes: [Vec<(f64, f64)>; 2],
}

impl Prices {
    /// Times the main loop for some seconds in all.
    pub fn measure(sample: &Sample, seconds: f64) -> Result<Self, StudyError> {
        let bench = bench(sample)?;
        let careful = sample.careful();
        let cutoffs: Vec<f64> = match sample.own.truncation.r_cut {
            // Of a truncation that is fixed, one price is enough.
            r_cut if !crate::settings::truncation_is_free(&sample.own) => vec![r_cut],
            _ => {
                let half = bench.start().cell.largest_cutoff() / sample.own.cutoff_unit();
                let largest = sample.largest_cutoff.min(half);
                let mut nodes: Vec<f64> =
                    NODES.into_iter().filter(|r| *r < 0.97 * largest).collect();
                nodes.push(largest);
                nodes
            }
        };
        let mut all = Vec::new();
        for precision in [Precision::Double, Precision::Mixed] {
            for r_cut in &cutoffs {
                let mut settings = Settings { precision, ..careful.clone() };
                settings.truncation.r_cut = *r_cut;
                settings.truncation.switch_from = None;
                all.push(settings);
            }
        }
        let each = seconds / (REPEATS * all.len()) as f64;
        // On one thread, as prices are compared: what several gain on each other is noise of its own.
        let found = costs(&bench, &all, 1, REPEATS, each, sample.own.system.seed)?;
        let mut nodes = [Vec::new(), Vec::new()];
        for (settings, cost) in all.iter().zip(found) {
            let cost = cost.map_err(|failed| {
                StudyError::Nothing(format!("{}: {}", settings.label(), failed.reason))
            })?;
            let of = usize::from(settings.precision == Precision::Mixed);
            // The least of the repeats: what disturbs a timing only makes it longer.
            nodes[of].push((settings.truncation.r_cut.powi(3), cost.wall.lowest * settings.dt));
        }
        nodes.iter_mut().for_each(|nodes| never_falling(nodes));
        Ok(Self { bench, nodes })
    }

    /// Seconds for each particle and simulated τ: between the cutoffs timed, a straight line in r_cut³.
    pub(crate) fn of(&self, settings: &Settings) -> f64 {
        let nodes = &self.nodes[usize::from(settings.precision == Precision::Mixed)];
        let x = settings.truncation.r_cut.powi(3);
        let step = match nodes.as_slice() {
            [] => f64::NAN,
            [(_, only)] => *only,
            nodes => {
                let above =
                    nodes.iter().position(|(at, _)| *at >= x).unwrap_or(nodes.len() - 1).max(1);
                let ((x0, y0), (x1, y1)) = (nodes[above - 1], nodes[above]);
                y0 + (y1 - y0) * (x - x0) / (x1 - x0)
            }
        };
        step / settings.dt
    }
}

/// A shorter cutoff never costs more than a longer one: where it seems to, its timing was disturbed.
fn never_falling(nodes: &mut [(f64, f64)]) {
    let mut least = f64::INFINITY;
    for (_, price) in nodes.iter_mut().rev() {
        least = least.min(*price);
        *price = least;
    }
}

/// Particles of the fcc lattice that stands for a scene: no fewer than the scene has, up to [`TIMED_UP_TO`]. A cutoff that
/// fits the box of the scene then fits the box of the timings.
fn timed_atoms(scene_atoms: usize) -> usize {
    let wanted = scene_atoms.min(TIMED_UP_TO);
    (1..).map(|m: usize| 4 * m.pow(3)).find(|n| *n >= wanted).unwrap_or(TIMED_UP_TO)
}

fn bench(sample: &Sample) -> Result<Workbench, StudyError> {
    let as_it_is = sample.scene_atoms <= TIMED_UP_TO && sample.scene_atoms == sample.start.len();
    if as_it_is || !sample.has_a_lattice {
        return Ok(Workbench::with_start(&sample.own, sample.start.clone()));
    }
    let density = sample.start.density_of_molecules(&sample.own);
    // On a lattice stand particles, or the centres of molecules.
    let sites = sample.own.molecules().sites();
    let n_atoms = timed_atoms(sample.scene_atoms.min(TIMED_UP_TO) / sites);
    let mut scene: Scene = sample.own.clone();
    scene.system.start = lattice_of(n_atoms, density);
    let mut before = scene.clone();
    before.stages =
        vec![Stage { steps: MELTING_STEPS, measure: false, ..sample.canonical.stages[0].clone() }];
    let largest = 0.5 * (n_atoms as f64 / density).cbrt() / scene.cutoff_unit();
    before.truncation.r_cut = before.truncation.r_cut.min(largest);
    let start = Start::equilibrate(&before)?;
    Ok(Workbench::with_start(&scene, start))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_fits_the_box_of_the_scene_fits_that_of_its_timings() {
        // 125 is 5³, and 108 would make a shorter box.
        for (of_scene, timed) in [(1, 4), (32, 32), (33, 108), (108, 108), (125, 256), (864, 864)] {
            assert_eq!(timed_atoms(of_scene), timed);
        }
        for n in [10_975, 10_976, 10_977, 1_000_000] {
            assert_eq!(timed_atoms(n), TIMED_UP_TO);
        }
    }

    #[test]
    fn a_disturbed_timing_makes_no_cutoff_dearer_than_a_longer_one() {
        let mut nodes = [(8.0, 1.0), (15.0, 9.0), (27.0, 2.0), (64.0, 5.0)];
        never_falling(&mut nodes);
        assert_eq!(nodes.map(|(_, price)| price), [1.0, 2.0, 2.0, 5.0]);
    }
}
