//! Forces of the fluid without a cutoff: what every truncation is judged by.

use glam::DVec3;
use lennard_forcefield::{Mixture, Model, TruncationKind, TruncationOptions};
use lennard_scene::Scene;
use rayon::prelude::*;

use super::start::Start;
use crate::StudyError;

/// Most pairs of a particle and an image in the forces of the untruncated fluid.
const MOST_PAIRS: f64 = 1.2e8;
/// The most particles at which those forces are taken, evenly chosen.
const MOST_PARTICLES: usize = 1024;
/// Points of the integral over what the sum leaves out.
const INTEGRATION_POINTS: usize = 400;

/// The forces of the fluid without a cutoff, summed over periodic images.
#[derive(Debug, Clone)]
pub struct Untruncated {
    /// The particles that they are for.
    pub particles: Vec<usize>,
    /// The forces, one for each of those, ε/σ.
    pub forces: Vec<DVec3>,
    /// Pairs up to this distance are in the sum, σ.
    pub reach: f64,
    /// An estimate of what the sum leaves out, relative to the forces: the force of neighbors beyond the reach that are
    /// placed at random.
    pub left_out: f64,
}

impl Untruncated {
    pub(super) fn at(start: &Start, scene: &Scene) -> Result<Self, StudyError> {
        let n = start.len();
        let chosen = n.min(MOST_PARTICLES);
        let particles: Vec<usize> = (0..chosen).map(|k| k * n / chosen).collect();
        let shells = |k: u32| f64::from(2 * k + 1).powi(3) * (chosen * n) as f64;
        let k = (1..=4).rev().find(|k| shells(*k) <= MOST_PAIRS).unwrap_or(0);
        // Half a box less a hair, so that no tie between two images is in the sum.
        let reach = (f64::from(k) + 0.5) * start.cell.shortest() * (1.0 - 1e-9);
        let truncation = TruncationOptions::new(TruncationKind::Cut, reach);
        let pairs = Pairs {
            model: Model::new(&scene.potential, &truncation)?,
            of_species: scene.mixture_of(&start.species),
        };
        let forces = with_images(start, &particles, &pairs, reach);
        let mean_square =
            forces.iter().map(|f| f.length_squared()).sum::<f64>() / forces.len() as f64;
        let left_out = (pairs.beyond(start, reach) * start.density() / mean_square).sqrt();
        Ok(Self { particles, forces, reach, left_out })
    }
}

/// The potential without a cutoff, of each pair of species.
struct Pairs {
    model: Model,
    of_species: Option<Mixture>,
}

impl Pairs {
    /// F(r)/r of particles of two species at r², ε/σ².
    fn force(&self, a: usize, b: usize, r2: f64) -> f64 {
        let Some(mixture) = &self.of_species else {
            return self.model.eval(r2).force;
        };
        let pair = mixture.pair(a, b);
        let inverse = 1.0 / (pair.sigma * pair.sigma);
        pair.epsilon * inverse * self.model.eval(r2 * inverse).force
    }

    /// ∫ F(r)²·4πr² dr from `reach` to ten times as far, the mean over pairs of particles: times ρ, the mean square force of
    /// neighbors placed at random.
    fn beyond(&self, start: &Start, reach: f64) -> f64 {
        let step = 10f64.ln() / INTEGRATION_POINTS as f64;
        let species = &start.species;
        let of_pair = |a: usize, b: usize| -> f64 {
            (0..INTEGRATION_POINTS)
                .map(|i| {
                    let r = reach * ((i as f64 + 0.5) * step).exp();
                    let force = self.force(a, b, r * r) * r;
                    force * force * 4.0 * std::f64::consts::PI * r.powi(3) * step
                })
                .sum()
        };
        let all = 0..species.n_species();
        let pairs = all.clone().flat_map(|a| all.clone().map(move |b| (a, b)));
        pairs.map(|(a, b)| species.fraction(a) * species.fraction(b) * of_pair(a, b)).sum()
    }
}

/// Forces on some particles from all others and from the periodic images of all, up to a distance.
///
/// This is the reference loop with images, in double precision.
fn with_images(start: &Start, particles: &[usize], pairs: &Pairs, reach: f64) -> Vec<DVec3> {
    let lengths = start.cell.lengths();
    // After the nearest image a component is at most L/2: further images reach back by that much.
    let counts = (reach / lengths + DVec3::splat(0.5)).floor().as_ivec3();
    let mut shifts = Vec::new();
    for x in -counts.x..=counts.x {
        for y in -counts.y..=counts.y {
            for z in -counts.z..=counts.z {
                shifts.push(lengths * glam::IVec3::new(x, y, z).as_dvec3());
            }
        }
    }
    let on = |i: usize| -> DVec3 {
        let mut force = DVec3::ZERO;
        for (j, other) in start.positions.iter().enumerate() {
            // The images of a particle itself pull it from all sides alike.
            if j == i {
                continue;
            }
            let (a, b) = (start.species.of(i), start.species.of(j));
            let nearest = start.cell.minimum_image(start.positions[i] - *other);
            for shift in &shifts {
                let r_ij = nearest + *shift;
                let r2 = r_ij.length_squared();
                if r2 <= reach * reach {
                    force += pairs.force(a, b, r2) * r_ij;
                }
            }
        }
        force
    };
    particles.par_iter().map(|i| on(*i)).collect()
}

#[cfg(test)]
mod tests {
    use lennard_core::{Part, PeriodicBox, Want};
    use lennard_forcefield::{Conditions, ForceFieldOptions, Kernel, KernelOptions};

    use super::*;
    use crate::settings::tests::scene;

    #[test]
    fn images_add_up_to_the_forces_of_a_box_of_boxes() {
        images_add_up(&[]);
    }

    #[test]
    fn images_of_each_species_act_by_the_potential_of_their_pair() {
        images_add_up(&[
            (
                "species",
                r#"[{ name = "A", fraction = 0.5 }, { name = "B", fraction = 0.5, sigma = 0.8, epsilon = 2.0 }]"#,
            ),
            ("mixing", r#"{ rule = "lorentz-berthelot" }"#),
        ]);
    }

    /// The same fluid as one box with images, and as 27 boxes side by side without any.
    fn images_add_up(overrides: &[(&str, &str)]) {
        let mut all = vec![
            ("stage.equilibrate.steps", "30"),
            ("system.n_atoms", "32"),
            ("truncation.r_cut", "1.5"),
        ];
        all.extend(overrides);
        let mut scene = scene(&all);
        let start = Start::equilibrate(&scene).unwrap();
        let side = start.cell.lengths().x;
        let reach = 1.49 * side;
        let truncation = TruncationOptions::new(TruncationKind::Cut, reach);
        let pairs = Pairs {
            model: Model::new(&scene.potential, &truncation).unwrap(),
            of_species: scene.mixture_of(&start.species),
        };
        let found = with_images(&start, &[0, 7], &pairs, reach);
        let of = |n: usize| start.species.of(n % start.len()) as u8;
        let numbers: Vec<u8> = (0..27 * start.len()).map(of).collect();
        let mut boxes = Start {
            cell: PeriodicBox::new(3.0 * start.cell.lengths()).unwrap(),
            positions: Vec::new(),
            velocities: Vec::new(),
            species: scene.species_table(numbers.len(), &numbers),
        };
        for n in 0..27 {
            let shift = side * DVec3::new(f64::from(n % 3), f64::from(n / 3 % 3), f64::from(n / 9));
            boxes.positions.extend(start.positions.iter().map(|r| *r + shift));
        }
        let options = ForceFieldOptions {
            truncation,
            kernel: KernelOptions { kernel: Kernel::Reference, ..KernelOptions::default() },
            ..ForceFieldOptions::default()
        };
        scene.truncation = truncation;
        let mixture = scene.mixture_of(&boxes.species);
        let conditions = Conditions {
            cell: boxes.cell,
            n_atoms: boxes.positions.len(),
            temperature: 1.0,
            dt: 0.004,
            mixture: mixture.as_ref(),
        };
        let mut forces = lennard_forcefield::build(&options, &conditions).unwrap();
        let (_, right) = boxes.evaluate(&mut forces, Part::All, Want::NOTHING).unwrap();
        // Rounding: some 600 terms of size up to 100 each.
        for (a, b) in found.iter().zip([right[0], right[7]]) {
            assert!((*a - b).length() < 1e-10, "{a} {b}");
        }
    }
}
