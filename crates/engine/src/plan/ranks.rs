//! A model of a step on several ranks: the measured step of one, the halo of a part of the box, and the network.
//!
//! ```text
//!   t = w + R + max(0, m − i·(w − l)) + 2s·(R + λ) + 0.6 µs·p + 4 ns·H/min(cores, 8) + b·builds + r·rows
//!
//!   w = 1.03·t₁/P          particles, with an imbalance of 3 %; t₁ is the step of one rank, builds included
//!   l                      the part of w that builds lists
//!   R = 2·⌈log₂ P⌉·λ       all ranks decide whether the list is still valid, before they compute forces
//!   m = λ + H·c/β          coordinates of the halo come while inner chunks run: c is 24 B, or 12 B in fixed point
//!   i = Π max(0, 1 − 2(h + 1.6 σ)/a)     the share of inner chunks: they name no halo, and have whole columns
//!   H = ρL_z·((a_x + 2h)(a_y + 2h) − a_x·a_y − (4 − π)h²)     particles of the halo; no side is wider than the box
//!   builds = H·32 B/β + 2pλ + 3R         numbers and positions of a new halo
//!   rows = R + 2·⌈log₂ P⌉·8 kB/β         exact sums of energy and virial
//! ```
//!
//! λ is the latency and β the bandwidth of a rank, h the list radius, p the number of partners, and a a side of a part.
//! b and r are the numbers of builds and of rows in a step. In s = 0.37 of the steps, as counted in a liquid at T = 1 with the
//! usual skin, ranks look for pairs that fast particles make beyond the lists. They tell each other fast particles at their faces, and
//! then the pairs: twice a count for each rank, and a short message.
//! Posting a message takes 0.3 µs, and packing a position 2 ns on each side. Particles that change their rank at a build
//! are few: 10 beside a halo of 2,340 were counted. Files are not in the model, nor are steps in cuts, nor a density that
//! varies over the box.

use std::f64::consts::PI;

use lennard_core::DVec3;
use serde::Serialize;

/// Bytes of a particle of a new halo: its number and its position.
const BUILD_BYTES: f64 = 32.0;
/// Bytes of the exact sums of a row.
const ROW_BYTES: f64 = 8e3;
/// Bytes that a rank holds for each particle of its halo.
const HALO_BYTES: f64 = 90.0;
/// Bytes of an MPI library in each rank: 10 MB of Open MPI 4.1, 17 MB of MPICH 5.0, with 4 ranks of 256 particles.
const LIBRARY_BYTES: f64 = 12e6;
/// Searches in a step.
const SEARCHES: f64 = 0.37;
/// Width of a column, σ.
const COLUMN: f64 = 1.6;
/// Particles of the rank with most work, over the mean.
const IMBALANCE: f64 = 1.03;
/// Seconds to post one message and to receive another.
const POSTING: f64 = 0.6e-6;
/// Seconds of one thread to pack and to unpack a position.
const PACKING: f64 = 4e-9;
/// Threads that pack, at most.
const PACKERS: usize = 8;
/// More ranks pay while a rank spends at least this share of its time on its particles.
const PAYS: f64 = 0.5;

/// Ranks of one kind, and the network between them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Network {
    /// Number of ranks; `None` for as many as pay.
    pub ranks: Option<usize>,
    /// Time of an empty message, seconds.
    pub latency: f64,
    /// Bytes per second of one rank.
    pub bandwidth: f64,
    /// Cores of one rank.
    pub cores: usize,
}

/// A fluid as one rank computes it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OneRank {
    /// Number of particles.
    pub atoms: usize,
    /// Sides of the box, σ.
    pub lengths: DVec3,
    /// The list radius, σ.
    pub r_list: f64,
    /// Seconds that all its cores together take for a step, builds of the list included.
    pub core_seconds: f64,
    /// Bytes of a particle in a message: its coordinates as the loops read them.
    pub coordinate_bytes: f64,
    /// The share of builds in them.
    pub building: f64,
    /// Builds of the list in a step.
    pub builds: f64,
    /// Rows of thermo.csv in a step.
    pub rows: f64,
    /// Bytes that one process holds, without the program.
    pub bytes: u64,
    /// Bytes of the program itself.
    pub program_bytes: u64,
}

/// A step on a number of ranks, as the model predicts it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OnRanks {
    /// Number of ranks.
    pub ranks: usize,
    /// Particles of each rank.
    pub atoms: f64,
    /// Particles in the largest halo.
    pub halo: f64,
    /// Ranks that this rank exchanges positions with.
    pub partners: usize,
    /// Bytes that the largest rank holds, with the program and, on several ranks, MPI.
    pub bytes: f64,
    /// Seconds of a step for the particles of a rank.
    pub computing: f64,
    /// Seconds of a step.
    pub seconds_per_step: f64,
    /// How much faster than one rank.
    pub speedup: f64,
    /// The speedup over the number of ranks.
    pub efficiency: f64,
}

/// What several ranks make of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ranks {
    /// The network.
    pub network: Network,
    /// 1, 2, 4, … and the number asked for, or as many as pay.
    pub steps: Vec<OnRanks>,
    /// The largest power of two that pays: ranks spend half of their time on particles.
    pub pays_up_to: usize,
    /// The power of two after it; `None` where the particles cannot be cut for so many.
    pub no_more_at: Option<usize>,
}

/// A part of the cross-section of the box: its middle and its sides along x and y, σ.
#[derive(Debug, Clone, Copy)]
struct Rectangle {
    middle: [f64; 2],
    sides: [f64; 2],
}

impl Rectangle {
    /// Cuts the longer side again and again, until there is a part for each rank.
    fn cut(self, ranks: usize, parts: &mut Vec<Self>) {
        if ranks == 1 {
            return parts.push(self);
        }
        let (axis, low) = (usize::from(self.sides[1] > self.sides[0]), ranks / 2);
        let [mut a, mut b] = [self; 2];
        a.sides[axis] *= low as f64 / ranks as f64;
        b.sides[axis] -= a.sides[axis];
        a.middle[axis] -= b.sides[axis] / 2.0;
        b.middle[axis] += a.sides[axis] / 2.0;
        a.cut(low, parts);
        b.cut(ranks - low, parts);
    }

    /// The area within a distance around it, in a periodic box.
    fn area_around(&self, h: f64, lengths: [f64; 2]) -> f64 {
        let grown = [0, 1].map(|k| (self.sides[k] + 2.0 * h).min(lengths[k]));
        let has_corners = (0..2).all(|k| grown[k] < lengths[k]);
        let corners = if has_corners { (4.0 - PI) * h * h } else { 0.0 };
        grown[0] * grown[1] - self.sides[0] * self.sides[1] - corners
    }

    /// The distance of two parts in a periodic box.
    fn distance(&self, other: &Self, lengths: [f64; 2]) -> f64 {
        let [x, y] = [0, 1].map(|k| {
            let apart = (self.middle[k] - other.middle[k]).abs();
            let nearest = apart.min(lengths[k] - apart);
            (nearest - (self.sides[k] + other.sides[k]) / 2.0).max(0.0)
        });
        x.hypot(y)
    }
}

impl OneRank {
    /// Predicts steps on ranks that a network joins, of which there may be `most`.
    pub fn on(&self, network: Network, most: usize) -> Ranks {
        let step = |ranks| self.step(ranks, &network);
        let powers = (0..).map(|k| 1_usize << k);
        let pay = powers.clone().take_while(|ranks| *ranks <= most).map(step);
        let pay: Vec<OnRanks> = pay.take_while(|step| step.efficiency >= PAYS).collect();
        // One rank has an efficiency of 1.
        let pays_up_to = 1 << pay.len().saturating_sub(1);
        let steps = match network.ranks {
            None => pay,
            Some(ranks) => {
                let below = powers.take_while(|below| *below < ranks);
                below.chain([ranks]).map(step).collect()
            }
        };
        let no_more_at = Some(2 * pays_up_to).filter(|next| *next <= most);
        Ranks { network, steps, pays_up_to, no_more_at }
    }

    /// A step on a number of ranks.
    fn step(&self, ranks: usize, network: &Network) -> OnRanks {
        let h = self.r_list;
        let Network { latency, bandwidth, cores, .. } = *network;
        let of_one = self.core_seconds / cores as f64;
        let computing = of_one / ranks as f64;
        let (atoms, area) = (self.atoms as f64, self.lengths.x * self.lengths.y);
        let bytes = self.bytes as f64 / ranks as f64 + self.program_bytes as f64;
        let across = [self.lengths.x, self.lengths.y];
        let mut parts = Vec::with_capacity(ranks);
        Rectangle { middle: [0.0; 2], sides: across }.cut(ranks, &mut parts);
        let around = |part: &&Rectangle| part.area_around(h, across);
        let largest = parts.iter().max_by(|a, b| around(a).total_cmp(&around(b)));
        let Some(part) = largest.filter(|_| ranks > 1) else {
            return OnRanks {
                ranks,
                atoms,
                halo: 0.0,
                partners: 0,
                bytes,
                computing,
                seconds_per_step: computing,
                speedup: 1.0,
                efficiency: 1.0,
            };
        };
        let halo = around(&part) * atoms / area;
        let partners = parts.iter().filter(|p| part.distance(p, across) < h).count() - 1;
        let is_cut = |k: &usize| part.sides[*k] < across[*k];
        let margin = 2.0 * (h + COLUMN);
        let inner = (0..2).filter(is_cut).map(|k| (1.0 - margin / part.sides[k]).max(0.0));
        let inner: f64 = inner.product();
        let rounds = f64::from(ranks.next_power_of_two().ilog2());
        let work = IMBALANCE * computing;
        let decision = 2.0 * rounds * latency;
        let message = latency + self.coordinate_bytes * halo / bandwidth;
        let build =
            BUILD_BYTES * halo / bandwidth + 2.0 * partners as f64 * latency + 3.0 * decision;
        let row = decision + 2.0 * rounds * ROW_BYTES / bandwidth;
        let hidden = inner * (1.0 - self.building) * work;
        let seconds_per_step = work
            + decision
            + (message - hidden).max(0.0)
            + POSTING * partners as f64
            + PACKING * halo / cores.min(PACKERS) as f64
            + 2.0 * SEARCHES * (decision + latency)
            + self.builds * build
            + self.rows * row;
        let speedup = of_one / seconds_per_step;
        OnRanks {
            ranks,
            atoms: atoms / ranks as f64,
            halo,
            partners,
            bytes: bytes + HALO_BYTES * halo + LIBRARY_BYTES,
            computing,
            seconds_per_step,
            speedup,
            efficiency: speedup / ranks as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A liquid in a cubic box, with 60 ns for each particle and step of a core.
    fn liquid(atoms: usize) -> OneRank {
        OneRank {
            atoms,
            lengths: DVec3::splat((atoms as f64 / 0.8442).cbrt()),
            r_list: 2.8,
            core_seconds: 60e-9 * atoms as f64,
            coordinate_bytes: 24.0,
            building: 0.2,
            builds: 0.1,
            rows: 0.001,
            bytes: 600 * atoms as u64,
            program_bytes: 12_000_000,
        }
    }

    const FAST: Network = Network { ranks: None, latency: 2e-6, bandwidth: 12e9, cores: 64 };

    #[test]
    fn halos_are_as_large_as_counted_ones() {
        // Counted in a program of its own, which sends what lies within the list radius of a part.
        let step = |atoms, ranks| liquid(atoms).step(ranks, &FAST);
        for (atoms, ranks, counted) in [(6912, 2, 1919.0), (6912, 4, 2340.0)] {
            let halo = step(atoms, ranks).halo;
            assert!((halo / counted - 1.0_f64).abs() < 0.01, "{ranks}: {halo}, counted {counted}");
        }
        let partners = [1, 2, 3, 4, 6, 8, 16].map(|ranks| step(32_000, ranks).partners);
        assert_eq!(partners, [0, 1, 2, 3, 5, 5, 8]);
        // Where a halo takes the whole box, it is all that is not a rank's own.
        let most = step(4000, 64);
        assert!(most.halo < 4000.0 * 63.0 / 64.0 && most.partners < 63, "{most:?}");
        let long = OneRank { lengths: DVec3::new(100.0, 5.0, 9.0), ..liquid(4000) };
        assert_eq!(long.step(2, &FAST).halo, 4000.0 / 100.0 * 5.6);
    }

    #[test]
    fn a_step_is_a_decision_work_beside_a_halo_and_work_behind_it() {
        let one = liquid(1_000_000);
        let alone = one.step(1, &FAST);
        assert_eq!((alone.halo, alone.efficiency), (0.0, 1.0));
        assert_eq!((alone.seconds_per_step, alone.bytes), (0.06 / 64.0, 612e6));
        let step = one.step(4, &FAST);
        let halo = step.halo;
        let a = one.lengths.x / 2.0;
        assert!((halo / (0.8442 * 2.0 * a * (11.2 * a + PI * 2.8 * 2.8)) - 1.0).abs() < 1e-12);
        assert_eq!(step.bytes, 150e6 + 90.0 * halo + 24e6);
        let work = 1.03 * 0.06 / 256.0;
        // Inner work hides the halo.
        let hidden = (1.0 - 8.8 / a).powi(2) * 0.8 * work;
        assert!(hidden > 2e-6 + 24.0 * halo / 12e9);
        let build = 32.0 * halo / 12e9 + 6.0 * 2e-6 + 3.0 * 8e-6;
        let search = 2.0 * (8e-6 + 2e-6);
        let messages = 8e-6 + 3.0 * 0.6e-6 + 0.5e-9 * halo + 0.37 * search + 0.1 * build;
        let expected = work + messages + 0.001 * (8e-6 + 4.0 * 8e3 / 12e9);
        assert!((step.seconds_per_step / expected - 1.0).abs() < 1e-12);
        // A slow network hides the work.
        let slow = one.step(4, &Network { bandwidth: 1e8, ..FAST });
        let slower = 1e-8 - 1.0 / 12e9;
        let waiting = 24.0 * halo / 1e8 + 2e-6 - hidden;
        let more = waiting + 3.2 * halo * slower;
        assert!((slow.seconds_per_step / (expected + more) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn the_model_at_work_is_as_the_documents_say() {
        let text = include_str!("../../../../docs/cluster.md");
        for (atoms, name) in [(1_000_000, "10⁶"), (10_000_000, "10⁷"), (100_000_000, "10⁸")] {
            let cell = |ranks, network: &Network| {
                let [double, mixed] = [24.0, 12.0].map(|coordinate_bytes| {
                    OneRank { coordinate_bytes, ..liquid(atoms) }.step(ranks, network).efficiency
                });
                format!(" {double:.2}, {mixed:.2} |")
            };
            let core = Network { cores: 1, ..FAST };
            let of_machines = [2, 8, 64].map(|ranks| cell(ranks, &FAST));
            let of_cores = [8, 64, 512].map(|ranks| cell(ranks, &core));
            let row = format!("| {name} |{}", [of_machines, of_cores].concat().concat());
            assert!(text.contains(&row), "{row}");
        }
    }

    #[test]
    fn ranks_pay_up_to_a_number_and_particles_have_an_end() {
        let pays = liquid(10_000_000).on(FAST, 10_000);
        assert!(pays.steps.iter().all(|step| step.efficiency >= 0.5));
        assert_eq!(pays.steps.last().map(|step| step.ranks), Some(pays.pays_up_to));
        assert_eq!(pays.no_more_at, Some(2 * pays.pays_up_to));
        assert_eq!(liquid(10_000_000).on(FAST, 6).no_more_at, None);
        let asked = Network { ranks: Some(1000), ..FAST };
        let steps = liquid(10_000_000).on(asked, 10_000).steps;
        let numbers: Vec<usize> = steps.iter().map(|step| step.ranks).collect();
        assert_eq!(numbers, [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1000]);
        assert!(steps.windows(2).all(|s| s[1].efficiency < s[0].efficiency));
    }
}
