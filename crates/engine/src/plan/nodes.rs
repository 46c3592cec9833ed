//! A model of one big system on several machines: the measured step, the counted halo, and the network.
//!
//! ```text
//!   seconds per step on P nodes = t₁/P                              particles, as measured on one node
//!                               + partners·latency + halo·24 B/bandwidth     positions of each step
//!                               + b·((4 N B·(1 − 1/P) + halo·56 B)/bandwidth + (4·partners + 3·⌈log₂ P⌉)·latency)   builds
//!                               + r·(96 N B·(1 − 1/P)/bandwidth + 4·⌈log₂ P⌉·latency)   rows, for which all is gathered
//!                               + ⌈log₂ P⌉·latency                  whether the list is still valid, on all nodes alike
//! ```
//!
//! It is a model of `lennard-mpi`, which cuts the order of a list into ranges. The halo of a rank is counted in a list of the
//! scene itself. b and r are the numbers of builds and of rows in a step. At a build all nodes tell each other the cells of
//! their particles, and give positions for the search and for the lists. Particles that move from node to node are few. For a
//! row they gather positions, velocities, positions of the build, and forces. Nothing is overlapped with work. Sorting, which
//! every node does for all particles, is not in the model.

use lennard_core::HaloSize;
use serde::Serialize;

/// Bytes of a position in a message.
const POSITION_BYTES: f64 = 24.0;
/// Bytes of a particle of the halo at a build: its slot and its position, for the search and for the lists.
const BUILD_HALO_BYTES: f64 = 56.0;
/// Bytes of each particle that all nodes get at a build: its cell.
const CELL_BYTES: f64 = 4.0;
/// Bytes of a particle where all is gathered: position, velocity, position of the build, and force.
const STATE_BYTES: f64 = 96.0;
/// Bytes of an MPI library in each rank: 10 MB of Open MPI 4.1, 17 MB of MPICH 5.0, with 4 ranks of 256 particles.
const LIBRARY_BYTES: f64 = 12e6;
/// More nodes pay while a node spends at least this share of its time on its particles.
const PAYS: f64 = 0.5;

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
    /// The numbers of machines at which the model looks, up to the most that have something to do: 2ᵏ, 3·2ᵏ, the number
    /// itself and the most.
    pub(super) fn sizes(&self, most: usize) -> Vec<usize> {
        let doublings = 0..=most.max(1).ilog2();
        let mut sizes: Vec<usize> = doublings
            .flat_map(|k| [1 << k, 3 << k])
            .chain([self.nodes, most])
            .filter(|nodes| *nodes <= most)
            .collect();
        sizes.sort_unstable();
        sizes.dedup();
        sizes
    }
}

/// A fluid as one machine computes it, and what its parts would need of each other.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OneNode {
    /// Number of particles.
    pub atoms: usize,
    /// Measured time of a step, seconds.
    pub seconds_per_step: f64,
    /// What a rank needs of others, by the number of ranks; nothing where forces are not shared out.
    pub halos: Vec<(usize, HaloSize)>,
    /// The largest number of ranks.
    pub most: usize,
    /// Builds of the list in a step.
    pub builds: f64,
    /// How often the whole state is gathered, in a step.
    pub gathers: f64,
    /// Bytes that one machine holds.
    pub bytes: u64,
    /// The bytes of them that only the machine needs which writes the files.
    pub bytes_to_write: u64,
    /// Bytes of the program itself, which each machine holds besides.
    pub program_bytes: u64,
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
    /// Bytes that the machine holds which writes the files, with the program and, on several machines, MPI.
    pub bytes: f64,
    /// Bytes that each of the other machines holds.
    pub bytes_of_others: f64,
    /// Seconds of a step for the particles of a machine.
    pub computing: f64,
    /// Seconds of a step for its halo.
    pub halo: f64,
    /// Seconds of a step for messages of builds and for gathering the whole state, as a mean over steps.
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
    /// The largest number of machines, of those looked at, that spend half of their time on particles.
    pub pays_up_to: usize,
    /// The efficiency at that number.
    pub efficiency_there: f64,
    /// The next number that was looked at, which does not pay; none where there are too few particles for more machines.
    pub no_more_at: Option<usize>,
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
        "these pair forces have no form that several machines share: each would compute all of them\n  found:   --nodes {nodes}\n  allowed: forces over a Verlet list"
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
        let refused = || NodesError::TooMany { nodes, most: self.most };
        let last = self.step(nodes, network).ok_or_else(refused)?;
        let powers = (0..).map(|k| 1_usize << k);
        let below = powers.take_while(|below| *below < nodes);
        let steps = below.filter_map(|below| self.step(below, network));
        let steps = steps.chain([last]).collect();
        let all = self.halos.iter().map(|(nodes, _)| *nodes);
        let all: Vec<OnNodes> = all.filter_map(|n| self.step(n, network)).collect();
        let pays = all.iter().rposition(|step| step.efficiency >= PAYS);
        // One machine has an efficiency of 1.
        let pays = pays.unwrap_or(0);
        Ok(Nodes {
            network,
            steps,
            pays_up_to: all[pays].nodes,
            efficiency_there: all[pays].efficiency,
            no_more_at: all.get(pays + 1).map(|step| step.nodes),
        })
    }

    /// A step on a number of machines; `None` where some would have nothing to do.
    fn step(&self, nodes: usize, network: Network) -> Option<OnNodes> {
        let (_, size) = self.halos.iter().find(|(ranks, _)| *ranks == nodes)?;
        let rounds = f64::from(nodes.next_power_of_two().ilog2()) * network.latency;
        let others = 1.0 - 1.0 / nodes as f64;
        let of_others = self.atoms as f64 * others / network.bandwidth;
        let computing = self.seconds_per_step / nodes as f64;
        let halo =
            size.partners * network.latency + size.particles * POSITION_BYTES / network.bandwidth;
        let build = CELL_BYTES * of_others
            + BUILD_HALO_BYTES * size.particles / network.bandwidth
            + 4.0 * size.partners * network.latency
            + 3.0 * rounds;
        let whole = STATE_BYTES * of_others + 4.0 * rounds;
        let gathering = self.builds * build + self.gathers * whole;
        let seconds_per_step = computing + halo + gathering + rounds;
        let speedup = self.seconds_per_step / seconds_per_step;
        let library = if nodes > 1 { LIBRARY_BYTES } else { 0.0 };
        let bytes = (self.bytes + self.program_bytes) as f64 + library
            - size.lists * (nodes as f64 - 1.0)
            + size.buffers;
        Some(OnNodes {
            nodes,
            atoms: self.atoms as f64 / nodes as f64,
            ghosts: size.particles,
            partners: size.partners,
            bytes,
            bytes_of_others: bytes - self.bytes_to_write as f64,
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
            buffers: match ranks {
                1 => 0.0,
                _ => 50.0 * atoms as f64,
            },
        };
        let sizes = FAST.sizes(most).into_iter();
        OneNode {
            atoms,
            seconds_per_step,
            halos: sizes.map(|n| (n, halo(n))).collect(),
            most,
            builds: 0.1,
            gathers: 0.01,
            bytes: 600 * atoms as u64,
            bytes_to_write: 100 * atoms as u64,
            program_bytes: 12_000_000,
        }
    }

    const FAST: Network = Network { nodes: 1000, latency: 2e-6, bandwidth: 25e9 };

    #[test]
    fn one_machine_has_no_halo_and_its_measured_step() {
        let one = liquid(32_000, 1e-3);
        let nodes = one.on(Network { nodes: 1, ..FAST }).unwrap();
        let [step] = &nodes.steps[..] else { panic!("one step") };
        assert_eq!((step.ghosts, step.halo, step.gathering), (0.0, 0.0, 0.0));
        assert_eq!((step.seconds_per_step, step.efficiency), (1e-3, 1.0));
        assert_eq!(step.bytes, (one.bytes + one.program_bytes) as f64);
    }

    #[test]
    fn a_step_is_work_halo_gathering_and_decision() {
        let one = liquid(1_000_000, 0.1);
        let step = one.step(8, FAST).unwrap();
        let halo = 2.0 * 2e-6 + step.ghosts * 24.0 / 25e9;
        let build = (4e6 * 0.875 + 56.0 * step.ghosts) / 25e9 + (4.0 * 2.0 + 3.0 * 3.0) * 2e-6;
        let gathering = 0.1 * build + 0.01 * (96e6 * 0.875 / 25e9 + 4.0 * 3.0 * 2e-6);
        let expected = 0.1 / 8.0 + halo + gathering + 3.0 * 2e-6;
        assert!((step.seconds_per_step - expected).abs() < 1e-15);
        assert!((step.efficiency - 0.1 / (8.0 * expected)).abs() < 1e-12);
        // Of 600 bytes for each particle, half are lists, which eight share out. Sharing takes 50 more, and programs 24 MB.
        assert!((step.bytes / 1e6 - (387.5 + 24.0)).abs() < 1e-9);
        assert!((step.bytes_of_others / 1e6 - (287.5 + 24.0)).abs() < 1e-9);
        let slow = Network { bandwidth: 1e8, ..FAST };
        assert!(one.step(8, slow).unwrap().efficiency < 0.7 * step.efficiency);
    }

    #[test]
    fn the_model_at_work_is_as_the_documents_say() {
        let text = include_str!("../../../../docs/cluster.md");
        let cells = |row: &str| -> Vec<String> {
            let cells = row.trim_matches('|').split('|');
            cells.map(|cell| cell.trim().to_owned()).collect()
        };
        let mut without = Vec::new();
        for (atoms, name) in [(1_000_000, "10⁶"), (10_000_000, "10⁷"), (100_000_000, "10⁸")] {
            // 60 ns on each of 64 cores; a list lasts 12 steps, and rows come every 100.
            let one = OneNode {
                builds: 1.0 / 12.0,
                gathers: 1.0 / 100.0,
                ..liquid(atoms, 60e-9 / 64.0 * atoms as f64)
            };
            let efficiency = |n: usize| format!("{:.2}", one.step(n, FAST).unwrap().efficiency);
            let row = text.lines().find(|line| line.starts_with(&format!("| {name} |")));
            let found = [2, 4, 8, 16].map(efficiency);
            assert_eq!(cells(row.unwrap())[1..], found, "{name}");
            let no_rows = OneNode { gathers: 0.0, ..one };
            let efficiency = no_rows.step(8, FAST).unwrap().efficiency;
            without.push(format!("{efficiency:.2}"));
        }
        let [a, b, c] = &without[..] else { panic!("three rows") };
        let words = format!("8 machines would have {a}, {b} and {c}.");
        assert!(text.contains(&words), "{words}");
    }

    #[test]
    fn more_machines_pay_up_to_a_number_and_particles_have_an_end() {
        // 60 ns for each particle and step on one core, and 64 cores.
        let nodes = liquid(10_000_000, 0.6 / 64.0).on(FAST).unwrap();
        assert!(nodes.pays_up_to > 1 && nodes.pays_up_to < 1000, "{nodes:?}");
        assert!(nodes.efficiency_there >= 0.5);
        let more = FAST.sizes(usize::MAX).into_iter().find(|n| *n > nodes.pays_up_to);
        assert_eq!(nodes.no_more_at, more);
        let last = nodes.steps.last().unwrap();
        assert!(last.nodes == 1000 && last.efficiency < 0.5);
        let all = nodes.steps.windows(2);
        assert!(all.clone().all(|s| s[1].efficiency < s[0].efficiency));

        let small = liquid(864, 4e-5);
        assert_eq!(small.on(FAST).unwrap_err(), NodesError::TooMany { nodes: 1000, most: 18 });
        let slow = Network { nodes: 2, latency: 0.0, bandwidth: 1e20 };
        let nodes = small.on(slow).unwrap();
        assert_eq!((nodes.pays_up_to, nodes.no_more_at), (18, None));
        let alone = OneNode { halos: Vec::new(), ..small };
        let error = alone.on(FAST).unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("these pair forces have no form that several machines share"),
            "{error}"
        );
    }
}
