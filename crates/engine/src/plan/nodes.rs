//! A model of one big system on several machines: the measured step, the halo of each brick, and the network.
//!
//! ```text
//!   seconds per step on P nodes = t₁/P                              particles, as measured on one node
//!                               + messages·latency + ghosts·24 B/bandwidth   halo of each step
//!                               + ⌈log₂ P⌉·latency                  whether the list is still valid, on all nodes alike
//! ```
//!
//! The box is cut into p_x × p_y × p_z equal bricks, and P = p_x·p_y·p_z. The *halo* of a brick are all particles outside it
//! that are within the list radius. Nothing is overlapped with work, and every brick has as many particles as the next.

use std::f64::consts::PI;

use lennard_core::DVec3;
use serde::Serialize;

/// Bytes of a ghost in a message: its position.
const GHOST_BYTES: f64 = 24.0;
/// More nodes pay while a node spends at least this share of its time on its particles.
const PAYS: f64 = 0.5;
/// The numbers of nodes that are looked at end here: 3·2ᵏ.
const MOST_DOUBLINGS: u32 = 20;

/// Machines of one kind, and the network between them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Network {
    /// Number of machines.
    pub nodes: usize,
    /// Time of an empty message, seconds.
    pub latency: f64,
    /// Bytes per second of one machine.
    pub bandwidth: f64,
}

/// A fluid as one machine computes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OneNode {
    /// Sides of the box, σ.
    pub lengths: DVec3,
    /// Number of particles.
    pub atoms: usize,
    /// The distance that forces and lists reach, σ.
    pub reach: f64,
    /// Measured time of a step, seconds.
    pub seconds_per_step: f64,
}

/// A step on a number of machines, as the model predicts it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OnNodes {
    /// Number of machines.
    pub nodes: usize,
    /// Bricks along x, y and z.
    pub grid: [usize; 3],
    /// Particles of each machine.
    pub atoms: f64,
    /// Particles in the halo of each machine.
    pub ghosts: f64,
    /// Seconds of a step for the particles of a machine.
    pub computing: f64,
    /// Seconds of a step for its halo.
    pub halo: f64,
    /// Seconds of a step for what all machines decide together.
    pub deciding: f64,
    /// Seconds of a step.
    pub seconds_per_step: f64,
    /// How much faster than one machine.
    pub speedup: f64,
    /// The speedup over the number of machines.
    pub efficiency: f64,
}

/// What several machines make of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nodes {
    /// The network.
    pub network: Network,
    /// The list radius, or the cutoff where there is no list, σ.
    pub reach: f64,
    /// The powers of two below the number of machines, and the number itself.
    pub steps: Vec<OnNodes>,
    /// The largest number of machines, of the form 2ᵏ or 3·2ᵏ, that spend half of their time on particles.
    pub pays_up_to: usize,
    /// The efficiency at that number.
    pub efficiency_there: f64,
    /// Whether more machines do not pay because the box has no room for their bricks.
    pub ends_with_the_box: bool,
}

/// Why a number of machines is impossible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NodesError {
    /// No grid of so many bricks has bricks that are at least as thick as their halo.
    #[error(
        "the box cannot be cut into so many bricks\n  found:   --nodes {nodes}\n  \
         allowed: a number that divides into bricks no thinner than the {reach:.3} σ that a list reaches, up to {most} here"
    )]
    NoGrid {
        /// The number asked for.
        nodes: usize,
        /// The largest number that fits.
        most: usize,
        /// The reach, σ.
        reach: f64,
    },
}

impl OneNode {
    /// Predicts steps on machines that a network joins.
    ///
    /// # Errors
    /// [`NodesError`] where the box has no room for so many bricks.
    pub fn on(&self, network: Network) -> Result<Nodes, NodesError> {
        let refused = || NodesError::NoGrid {
            nodes: network.nodes,
            most: self.most_bricks().iter().product::<usize>().min(self.atoms),
            reach: self.reach,
        };
        let last = self.step(network.nodes, network).ok_or_else(refused)?;
        let powers = (0..).map(|k| 1_usize << k);
        let below = powers.take_while(|nodes| *nodes < network.nodes);
        let steps = below.filter_map(|nodes| self.step(nodes, network));
        let steps = steps.chain([last]).collect();
        let sizes = (0..=MOST_DOUBLINGS).flat_map(|k| [1 << k, 3 << k]);
        let all: Vec<OnNodes> = sizes
            .filter_map(|nodes| self.step(nodes, network))
            .collect();
        let pays = all.iter().filter(|step| step.efficiency >= PAYS);
        let pays = pays.max_by_key(|step| step.nodes);
        let (pays_up_to, efficiency_there) = pays.map_or((1, 1.0), |s| (s.nodes, s.efficiency));
        Ok(Nodes {
            network,
            reach: self.reach,
            steps,
            pays_up_to,
            efficiency_there,
            ends_with_the_box: all.iter().all(|step| step.nodes <= pays_up_to),
        })
    }

    /// The most bricks along each axis that are no thinner than the reach.
    fn most_bricks(&self) -> [usize; 3] {
        let most = self.lengths / self.reach.max(f64::MIN_POSITIVE);
        [0, 1, 2].map(|axis| (most[axis] as usize).max(1))
    }

    /// A step on a number of machines; `None` where the box has no room for so many bricks.
    fn step(&self, nodes: usize, network: Network) -> Option<OnNodes> {
        let grid = self.grid(nodes)?;
        let ghosts = self.ghosts(grid);
        let cut = grid.iter().filter(|parts| **parts > 1).count();
        // One message to each side of each axis that is cut; edges and corners go with them.
        let messages = 2 * cut;
        let rounds = nodes.next_power_of_two().ilog2();
        let computing = self.seconds_per_step / nodes as f64;
        let halo = messages as f64 * network.latency + ghosts * GHOST_BYTES / network.bandwidth;
        let deciding = f64::from(rounds) * network.latency;
        let seconds_per_step = computing + halo + deciding;
        let speedup = self.seconds_per_step / seconds_per_step;
        Some(OnNodes {
            nodes,
            grid,
            atoms: self.atoms as f64 / nodes as f64,
            ghosts,
            computing,
            halo,
            deciding,
            seconds_per_step,
            speedup,
            efficiency: speedup / nodes as f64,
        })
    }

    /// The grid with the fewest ghosts, among grids of bricks that are no thinner than the reach; none for more bricks than
    /// particles.
    fn grid(&self, nodes: usize) -> Option<[usize; 3]> {
        let most = self.most_bricks();
        let parts = |n: usize, axis: usize| {
            let up_to = most[axis].min(n);
            (1..=up_to).filter(move |parts| n.is_multiple_of(*parts))
        };
        let grids = (nodes <= self.atoms).then(|| parts(nodes, 0));
        let grids = grids
            .into_iter()
            .flatten()
            .flat_map(|x| parts(nodes / x, 1).map(move |y| [x, y, nodes / x / y]))
            .filter(|[_, _, z]| *z <= most[2]);
        grids.min_by(|a, b| self.ghosts(*a).total_cmp(&self.ghosts(*b)))
    }

    /// Mean number of particles outside a brick and within the reach of it (the formula of Steiner for a convex body).
    ///
    /// There is no halo along an axis that is not cut.
    #[must_use]
    pub fn ghosts(&self, grid: [usize; 3]) -> f64 {
        let h = self.reach;
        let density = self.atoms as f64 / self.lengths.element_product();
        let side = |axis: usize| self.lengths[axis] / grid[axis] as f64;
        let cut: Vec<usize> = (0..3).filter(|axis| grid[*axis] > 1).collect();
        let whole: f64 = (0..3).filter(|axis| grid[*axis] == 1).map(side).product();
        let volume = match cut[..] {
            [] => 0.0,
            [_] => 2.0 * h,
            [x, y] => 2.0 * h * (side(x) + side(y)) + PI * h * h,
            _ => {
                let [a, b, c] = [side(0), side(1), side(2)];
                2.0 * h * (a * b + b * c + c * a)
                    + PI * h * h * (a + b + c)
                    + 4.0 / 3.0 * PI * h.powi(3)
            }
        };
        // Around a brick as wide as half the box, both sides of the halo can meet.
        let others = self.atoms as f64 * (1.0 - 1.0 / grid.iter().product::<usize>() as f64);
        (density * volume * whole).min(others)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn liquid(atoms: usize, seconds_per_step: f64) -> OneNode {
        OneNode {
            lengths: DVec3::splat((atoms as f64 / 0.8442).cbrt()),
            atoms,
            reach: 2.8,
            seconds_per_step,
        }
    }

    const FAST: Network = Network {
        nodes: 1000,
        latency: 2e-6,
        bandwidth: 25e9,
    };

    #[test]
    fn one_machine_has_no_halo_and_its_measured_step() {
        let one = liquid(32_000, 1e-3);
        let nodes = one.on(Network { nodes: 1, ..FAST }).unwrap();
        let [step] = &nodes.steps[..] else {
            panic!("one step")
        };
        assert_eq!((step.grid, step.ghosts, step.halo), ([1; 3], 0.0, 0.0));
        assert_eq!((step.seconds_per_step, step.efficiency), (1e-3, 1.0));
    }

    #[test]
    fn a_step_is_work_halo_and_decision() {
        let one = liquid(1_000_000, 0.1);
        let step = one.step(8, FAST).unwrap();
        // Cubes of half a side have as large a surface, and more edges.
        assert_eq!(step.grid, [1, 2, 4]);
        let (length, h) = (one.lengths.x, 2.8);
        let shell = (2.0 * h * 0.75 * length + PI * h * h) * length;
        assert!((step.ghosts - 0.8442 * shell).abs() < 1e-6 * step.ghosts);
        assert!(step.ghosts < one.ghosts([2; 3]));
        let expected = 0.1 / 8.0 + 4.0 * 2e-6 + step.ghosts * 24.0 / 25e9 + 3.0 * 2e-6;
        assert!((step.seconds_per_step - expected).abs() < 1e-15);
        assert!((step.efficiency - 0.1 / (8.0 * expected)).abs() < 1e-12);
        // A slow network is felt.
        let slow = Network {
            bandwidth: 1e8,
            ..FAST
        };
        assert!(one.step(8, slow).unwrap().efficiency < 0.7 * step.efficiency);
    }

    #[test]
    fn more_machines_pay_up_to_a_number_and_the_box_has_an_end() {
        // 60 ns for each particle and step on one core, and 64 cores.
        let nodes = liquid(1_000_000, 0.06 / 64.0).on(FAST).unwrap();
        assert!(nodes.pays_up_to > 8 && nodes.pays_up_to < 1000, "{nodes:?}");
        assert!(nodes.efficiency_there >= 0.5 && !nodes.ends_with_the_box);
        let last = nodes.steps.last().unwrap();
        assert!(last.nodes == 1000 && last.efficiency < 0.5);
        let all = nodes.steps.windows(2);
        assert!(all.clone().all(|s| s[1].efficiency < s[0].efficiency));
        let more = liquid(100_000_000, 6.0 / 64.0).on(FAST).unwrap();
        assert!(more.pays_up_to > nodes.pays_up_to);

        let small = liquid(864, 4e-5);
        let error = small.on(FAST).unwrap_err();
        assert_eq!(
            error,
            NodesError::NoGrid {
                nodes: 1000,
                most: 27,
                reach: 2.8
            }
        );
        // Along each axis there is room for three bricks, and 5 is a prime number.
        assert!(small.on(Network { nodes: 5, ..FAST }).is_err());
        let few = OneNode { atoms: 3, ..small };
        assert!(few.step(2, FAST).is_some() && few.step(4, FAST).is_none());
        let slow = Network {
            nodes: 2,
            latency: 0.0,
            bandwidth: 1e20,
        };
        assert!(small.on(slow).unwrap().ends_with_the_box);
    }

    #[test]
    fn ghosts_are_as_many_as_a_count_finds() {
        use lennard_core::random::Streams;
        use rand::RngExt;
        let one = OneNode {
            lengths: DVec3::new(30.0, 36.0, 42.0),
            atoms: 40_000,
            reach: 2.8,
            seconds_per_step: 1.0,
        };
        let mut random = Streams::new(11).sequential("positions");
        let positions: Vec<DVec3> = (0..one.atoms)
            .map(|_| one.lengths * DVec3::from_array(std::array::from_fn(|_| random.random())))
            .collect();
        for grid in [[2, 1, 1], [1, 2, 2], [2, 2, 2], [3, 4, 3], [1, 1, 5]] {
            let sides = one.lengths / DVec3::from_array(grid.map(|parts| parts as f64));
            let bricks: usize = grid.iter().product();
            let mut ghosts = 0;
            for brick in 0..bricks {
                let number = [
                    brick % grid[0],
                    brick / grid[0] % grid[1],
                    brick / grid[0] / grid[1],
                ];
                let middle = sides * (DVec3::from_array(number.map(|k| k as f64)) + 0.5);
                ghosts += positions
                    .iter()
                    .filter(|r| {
                        let d = **r - middle;
                        let d = d - one.lengths * (d / one.lengths).round();
                        let beyond = (d.abs() - 0.5 * sides).max(DVec3::ZERO);
                        let beyond2 = beyond.length_squared();
                        beyond2 > 0.0 && beyond2 <= one.reach * one.reach
                    })
                    .count();
            }
            let ratio = ghosts as f64 / bricks as f64 / one.ghosts(grid);
            assert!((ratio - 1.0).abs() < 0.02, "{grid:?}: {ratio}");
        }
    }
}
