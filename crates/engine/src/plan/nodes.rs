//! A model of one big system on several machines: the measured step, the counted halo, and the network.
//!
//! ```text
//!   seconds per step on P nodes = t₁/P                              particles, as measured on one node
//!                               + partners·latency + halo·24 B/bandwidth     positions of each step
//!                               + g·(48 N B·(1 − 1/P)/bandwidth + ⌈log₂ P⌉·latency)  state that is gathered
//!                               + ⌈log₂ P⌉·latency                  whether the list is still valid, on all nodes alike
//! ```
//!
//! It is a model of `lennard-mpi`, which cuts the order of a list into ranges. The halo of a rank is counted in a list of the
//! scene itself. g is how often all nodes gather the whole state: at builds, and where something is observed. Nothing is
//! overlapped with work. Sorting, which every node does for all particles, is not in the model.

use lennard_core::HaloSize;
use serde::Serialize;

/// Bytes of a position in a message.
const POSITION_BYTES: f64 = 24.0;
/// Bytes of a particle where the whole state is gathered.
const STATE_BYTES: f64 = 48.0;
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

impl Network {
    /// The numbers of machines at which the model looks: 2ᵏ, 3·2ᵏ, and the number itself.
    #[must_use]
    pub fn sizes(&self) -> Vec<usize> {
        let mut sizes: Vec<usize> = (0..=MOST_DOUBLINGS)
            .flat_map(|k| [1 << k, 3 << k])
            .chain([self.nodes])
            .collect();
        sizes.sort_unstable();
        sizes.dedup();
        sizes
    }
}

/// A fluid as one machine computes it, and what its parts would need of each other.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OneNode {
    /// Number of particles.
    pub atoms: usize,
    /// Measured time of a step, seconds.
    pub seconds_per_step: f64,
    /// What a rank needs of others, by the number of ranks; nothing where forces are not shared out.
    pub halos: Vec<(usize, HaloSize)>,
    /// The largest number of ranks.
    pub most: usize,
    /// How often the whole state is gathered, in a step.
    pub gathers: f64,
    /// Bytes that one machine holds.
    pub bytes: u64,
}

/// A step on a number of machines, as the model predicts it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OnNodes {
    /// Number of machines.
    pub nodes: usize,
    /// Particles of each machine.
    pub atoms: f64,
    /// Particles in the halo of each machine.
    pub ghosts: f64,
    /// Machines that a machine gets positions from.
    pub partners: f64,
    /// Bytes that each machine holds.
    pub bytes: f64,
    /// Seconds of a step for the particles of a machine.
    pub computing: f64,
    /// Seconds of a step for its halo.
    pub halo: f64,
    /// Seconds of a step for gathering the whole state, as a mean over steps.
    pub gathering: f64,
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
    /// The powers of two below the number of machines, and the number itself.
    pub steps: Vec<OnNodes>,
    /// The largest number of machines, of the form 2ᵏ or 3·2ᵏ, that spend half of their time on particles.
    pub pays_up_to: usize,
    /// The efficiency at that number.
    pub efficiency_there: f64,
    /// Whether more machines do not pay because there are too few particles to share out.
    pub ends_with_the_particles: bool,
}

/// Why a number of machines is impossible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NodesError {
    /// Some machines would have nothing to do.
    #[error(
        "too few particles for so many machines\n  found:   --nodes {nodes}\n  allowed: up to {most} here, since each takes 48 particles or more"
    )]
    TooMany {
        /// The number asked for.
        nodes: usize,
        /// The largest number.
        most: usize,
    },
    /// The search for pairs has no shared form.
    #[error(
        "these pair forces have no form that several machines share: each would compute all of them\n  found:   --nodes {nodes}\n  allowed: forces over a Verlet list, without `integrator.kind = \"bit-reversible-verlet\"`"
    )]
    NotShared {
        /// The number asked for.
        nodes: usize,
    },
}

impl OneNode {
    /// Predicts steps on machines that a network joins.
    ///
    /// # Errors
    /// [`NodesError`] where the work cannot be shared out so.
    pub fn on(&self, network: Network) -> Result<Nodes, NodesError> {
        let nodes = network.nodes;
        if self.halos.is_empty() {
            return Err(NodesError::NotShared { nodes });
        }
        let refused = || NodesError::TooMany {
            nodes,
            most: self.most,
        };
        let last = self.step(nodes, network).ok_or_else(refused)?;
        let powers = (0..).map(|k| 1_usize << k);
        let below = powers.take_while(|below| *below < nodes);
        let steps = below.filter_map(|below| self.step(below, network));
        let steps = steps.chain([last]).collect();
        let all = self.halos.iter().map(|(nodes, _)| *nodes);
        let all: Vec<OnNodes> = all.filter_map(|n| self.step(n, network)).collect();
        let pays = all.iter().filter(|step| step.efficiency >= PAYS);
        let pays = pays.max_by_key(|step| step.nodes);
        let (pays_up_to, efficiency_there) = pays.map_or((1, 1.0), |s| (s.nodes, s.efficiency));
        Ok(Nodes {
            network,
            steps,
            pays_up_to,
            efficiency_there,
            ends_with_the_particles: all.iter().all(|step| step.nodes <= pays_up_to),
        })
    }

    /// A step on a number of machines; `None` where some would have nothing to do.
    fn step(&self, nodes: usize, network: Network) -> Option<OnNodes> {
        let (_, size) = self.halos.iter().find(|(ranks, _)| *ranks == nodes)?;
        let rounds = f64::from(nodes.next_power_of_two().ilog2()) * network.latency;
        let others = 1.0 - 1.0 / nodes as f64;
        let whole = self.atoms as f64 * STATE_BYTES * others;
        let computing = self.seconds_per_step / nodes as f64;
        let halo =
            size.partners * network.latency + size.particles * POSITION_BYTES / network.bandwidth;
        let gathering = self.gathers * (whole / network.bandwidth + rounds);
        let seconds_per_step = computing + halo + gathering + rounds;
        let speedup = self.seconds_per_step / seconds_per_step;
        Some(OnNodes {
            nodes,
            atoms: self.atoms as f64 / nodes as f64,
            ghosts: size.particles,
            partners: size.partners,
            bytes: self.bytes as f64 - size.lists * (nodes as f64 - 1.0),
            computing,
            halo,
            gathering,
            deciding: rounds,
            seconds_per_step,
            speedup,
            efficiency: speedup / nodes as f64,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A liquid whose ranks are slabs with a halo of 2.8 σ on both sides.
    fn liquid(atoms: usize, seconds_per_step: f64) -> OneNode {
        let most = atoms.div_ceil(48);
        let density = 0.8442;
        let area = (atoms as f64 / density).powf(2.0 / 3.0);
        let halo = |ranks: usize| HaloSize {
            particles: match ranks {
                1 => 0.0,
                _ => (density * area * 5.6).min(atoms as f64 * (1.0 - 1.0 / ranks as f64)),
            },
            partners: [0.0, 1.0, 2.0][ranks.min(3) - 1],
            lists: 300.0 * atoms as f64 / ranks as f64,
        };
        let sizes = Network {
            nodes: 1000,
            ..FAST
        }
        .sizes()
        .into_iter();
        OneNode {
            atoms,
            seconds_per_step,
            halos: sizes.filter(|n| *n <= most).map(|n| (n, halo(n))).collect(),
            most,
            gathers: 0.1,
            bytes: 600 * atoms as u64,
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
        assert_eq!((step.ghosts, step.halo, step.gathering), (0.0, 0.0, 0.0));
        assert_eq!((step.seconds_per_step, step.efficiency), (1e-3, 1.0));
        assert_eq!(step.bytes, one.bytes as f64);
    }

    #[test]
    fn a_step_is_work_halo_gathering_and_decision() {
        let one = liquid(1_000_000, 0.1);
        let step = one.step(8, FAST).unwrap();
        let halo = 2.0 * 2e-6 + step.ghosts * 24.0 / 25e9;
        let gathering = 0.1 * (48e6 * 0.875 / 25e9 + 3.0 * 2e-6);
        let expected = 0.1 / 8.0 + halo + gathering + 3.0 * 2e-6;
        assert!((step.seconds_per_step - expected).abs() < 1e-15);
        assert!((step.efficiency - 0.1 / (8.0 * expected)).abs() < 1e-12);
        // Of 600 bytes for each particle, half are lists, which eight share out.
        assert!((step.bytes / 1e6 - 337.5).abs() < 1e-9);
        let slow = Network {
            bandwidth: 1e8,
            ..FAST
        };
        assert!(one.step(8, slow).unwrap().efficiency < 0.7 * step.efficiency);
    }

    #[test]
    fn more_machines_pay_up_to_a_number_and_particles_have_an_end() {
        // 60 ns for each particle and step on one core, and 64 cores.
        let nodes = liquid(10_000_000, 0.6 / 64.0).on(FAST).unwrap();
        assert!(nodes.pays_up_to > 1 && nodes.pays_up_to < 1000, "{nodes:?}");
        assert!(nodes.efficiency_there >= 0.5 && !nodes.ends_with_the_particles);
        let last = nodes.steps.last().unwrap();
        assert!(last.nodes == 1000 && last.efficiency < 0.5);
        let all = nodes.steps.windows(2);
        assert!(all.clone().all(|s| s[1].efficiency < s[0].efficiency));

        let small = liquid(864, 4e-5);
        assert_eq!(
            small.on(FAST).unwrap_err(),
            NodesError::TooMany {
                nodes: 1000,
                most: 18
            }
        );
        let slow = Network {
            nodes: 2,
            latency: 0.0,
            bandwidth: 1e20,
        };
        assert!(small.on(slow).unwrap().ends_with_the_particles);
        let alone = OneNode {
            halos: Vec::new(),
            ..small
        };
        let error = alone.on(FAST).unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("these pair forces have no form that several machines share"),
            "{error}"
        );
    }
}
