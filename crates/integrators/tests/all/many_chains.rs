//! Chains and dumbbells that are solved for side by side: each moves as if it were alone.

use lennard_core::{
    Bonds, BoundDrift, DVec3, Drifted, Masses, Molecules, StepError, System, rigid,
};
use lennard_integrators::bonds::direct;
use lennard_integrators::{BondHolder, BondOptions};

const DT: f64 = 0.01;

/// Chains that move, under forces that stay as they are.
#[derive(Clone)]
struct Chains {
    system: System,
    x: Vec<DVec3>,
    v: Vec<DVec3>,
    f: Vec<DVec3>,
}

/// A vector of numbers without order in [−½, ½], the same at each call.
fn scattered(k: usize) -> DVec3 {
    let number = |axis: u64| {
        let mut bits = (3 * k as u64 + axis + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        bits = (bits ^ (bits >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (bits >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    DVec3::new(number(0), number(1), number(2))
}

impl Chains {
    /// Chains of bent shapes with bonds of 0.8 σ. The later a chain, the faster are its sites, and the larger its forces.
    fn new(n: usize, sites: usize, have_own_masses: bool) -> Self {
        let mut x = Vec::new();
        for m in 0..n {
            let mut at = 20.0 * scattered(m);
            for k in 0..sites {
                x.push(at);
                let direction = DVec3::X + 1.5 * scattered(1000 + m * sites + k);
                at += 0.8 * direction.normalize();
            }
        }
        let share = |i: usize| (i / sites) as f64 / n as f64;
        let v = (0..n * sites).map(|i| 4.0 * share(i) * scattered(7000 + i));
        let f = (0..n * sites).map(|i| 30.0 * share(i) * scattered(9000 + i));
        let masses = (0..n * sites).map(|i| 1.0 + scattered(5000 + i).x);
        let molecules = Molecules::chains(sites, 0.8, Bonds::Rigid);
        let mut system = System::of_molecules(n * sites, molecules);
        if have_own_masses {
            system.masses = Masses::Each(masses.collect());
        }
        let (v, f) = (v.collect(), f.collect());
        Self { system, x, v, f }
    }

    /// Molecule `m` alone.
    fn alone(&self, m: usize) -> Self {
        let sites = self.system.molecules.sites_of(m);
        let mut system = System::of_molecules(sites.len(), self.system.molecules.clone());
        system.masses = match &self.system.masses {
            Masses::Each(each) => Masses::Each(each[sites.clone()].to_vec()),
            uniform => uniform.clone(),
        };
        let of = |all: &[DVec3]| all[sites.clone()].to_vec();
        let (x, v, f) = (of(&self.x), of(&self.v), of(&self.f));
        Self { system, x, v, f }
    }

    /// Steps of velocity Verlet; what was found in the drifts.
    fn steps(&mut self, bonds: &BondOptions, steps: usize) -> Result<Vec<Drifted>, StepError> {
        let BondHolder::Drift(mut solver) = bonds.build(&self.system.molecules) else {
            panic!("bonds are held in drifts")
        };
        rigid::project_velocities(&self.system, &self.x, &mut self.v);
        let mut found = Vec::new();
        for _ in 0..steps {
            let moving = BoundDrift {
                positions: &mut self.x,
                velocities: &mut self.v,
                forces: &self.f,
                kick: Some(0.5 * DT),
                h: DT,
            };
            found.push(solver.drift(&self.system, moving)?);
            rigid::kick_and_project(&self.system, &self.x, &mut self.v, &self.f, 0.5 * DT);
        }
        Ok(found)
    }

    /// The largest | |d|/r − 1 |, and the largest |d·w| of all bonds.
    fn off(&self) -> [f64; 2] {
        let mut largest = [0.0_f64; 2];
        let sites = self.system.molecules.sites();
        for (x, v) in self.x.chunks(sites).zip(self.v.chunks(sites)) {
            for bond in self.system.molecules.bonds() {
                let (d, w) = (bond.vector(x), bond.vector(v));
                let off = [(d.length() / bond.length - 1.0).abs(), d.dot(w).abs()];
                largest = std::array::from_fn(|k| largest[k].max(off[k]));
            }
        }
        largest
    }
}

fn exact(tolerance: f64) -> BondOptions {
    BondOptions::Direct(direct::Options { tolerance, ..Default::default() })
}

#[test]
fn a_chain_has_the_same_bits_whatever_its_neighbors_do() {
    for sites in [2, 3, 10, 64] {
        for own_masses in [false, true] {
            // Neither full registers alone, nor full tasks alone.
            for n in [1, 2, 7, 11, 261] {
                let mut all = Chains::new(n, sites, own_masses);
                let begun = all.clone();
                let found = all.steps(&exact(1e-12), 5).unwrap();
                let most = found.iter().map(|d| d.iterations).max();
                for m in (0..n).filter(|m| n < 20 || m % 37 == 0 || *m > 254) {
                    let mut alone = begun.alone(m);
                    let alone_found = alone.steps(&exact(1e-12), 5).unwrap();
                    let here = all.system.molecules.sites_of(m);
                    assert_eq!(all.x[here.clone()], alone.x, "molecule {m} of {n}");
                    assert_eq!(all.v[here], alone.v, "molecule {m} of {n}");
                    assert!(alone_found.iter().map(|d| d.iterations).max() <= most);
                }
                for threads in [1, 2, 3, 8] {
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                    let mut again = begun.clone();
                    let found_again = pool.unwrap().install(|| again.steps(&exact(1e-12), 5));
                    assert_eq!((&again.x, &again.v), (&all.x, &all.v));
                    assert_eq!(found_again.unwrap(), found);
                }
            }
        }
    }
}

/// Neighbors in a register need different numbers of iterations, which is what the test above is about.
#[test]
fn chains_of_different_speeds_need_different_numbers_of_iterations() {
    let all = Chains::new(8, 10, false);
    let iterations = |m: usize| {
        let found = all.alone(m).steps(&exact(1e-12), 1).unwrap();
        found[0].iterations
    };
    let numbers: Vec<u32> = (0..8).map(iterations).collect();
    assert!(numbers.iter().any(|n| *n != numbers[0]), "{numbers:?}");
    assert!(numbers.iter().all(|n| (1..=5).contains(n)), "{numbers:?}");
}

/// A chain that is within its tolerance is done. Its matrix may have lost its positive pivots by then, and neighbors go on.
#[test]
fn a_chain_within_its_tolerance_stays_whatever_its_neighbors_need() {
    let (tolerance, length) = (1e-3, 0.8_f64);
    let mut met = 0;
    for seed in 0..200 {
        let mut both = Chains::new(2, 3, false);
        both.f.fill(DVec3::ZERO);
        both.v.fill(DVec3::ZERO);
        // The first bond turns by nearly a right angle, after which 0 < s·d < √(|s|² − r²)·r.
        let along = 0.03_f64;
        let across = (1.0 + 2.2 * along * along - along * along).sqrt();
        let d = length * DVec3::X;
        let s = length * DVec3::new(along, across, 0.0);
        both.x[..3].copy_from_slice(&[-d, DVec3::ZERO, length * DVec3::Z]);
        // The kick turns it, since velocities have no part along bonds.
        both.f[0] = (d - s) / (DT * 0.5 * DT);
        for k in 3..6 {
            both.v[k] = 60.0 * scattered(10 * seed + k);
        }
        let mut alone = [both.alone(0), both.alone(1)];
        let [found, neighbor] = alone.each_mut().map(|a| a.steps(&exact(tolerance), 1));
        let iterations = found.unwrap()[0].iterations;
        if neighbor.is_ok_and(|found| found[0].iterations > 2) && iterations <= 2 {
            both.steps(&exact(tolerance), 1).unwrap();
            assert_eq!(both.x, [&alone[0].x[..], &alone[1].x].concat());
            assert_eq!(both.v, [&alone[0].v[..], &alone[1].v].concat());
            met += 1;
        }
    }
    assert!(met > 0, "no neighbor needs more iterations");
}

/// A loose tolerance is a limit of | |d|/r − 1 | itself, and what a drift reports is what is left.
#[test]
fn what_is_left_is_within_the_tolerance_and_is_what_is_told() {
    for tolerance in (20..=130).map(|tenths| 10_f64.powf(-0.1 * f64::from(tenths))) {
        let mut chains = Chains::new(30, 10, false);
        chains.v.iter_mut().for_each(|v| *v *= 4.0);
        for _ in 0..5 {
            let found = chains.steps(&exact(tolerance), 1).unwrap();
            let [left, _] = chains.off();
            assert!(left <= tolerance, "{left:e} of {tolerance:e}");
            let told = found[0].residual;
            assert!((told - left).abs() <= left * left + 1e-15, "{told:e}, {left:e}");
        }
    }
}

#[test]
fn a_bond_that_turns_too_far_is_named_among_its_neighbors() {
    for sites in [2, 10] {
        for (n, fast) in [(11, 9), (11, 2), (300, 258), (9, 8)] {
            let mut chains = Chains::new(n, sites, false);
            let bond = sites / 2;
            let site = fast * sites + bond - 1;
            let d = chains.x[site + 1] - chains.x[site];
            let across = d.any_orthogonal_vector().normalize();
            chains.v.fill(DVec3::ZERO);
            chains.f.fill(DVec3::ZERO);
            for k in 0..sites {
                let side = if k < bond { -1.0 } else { 1.0 };
                chains.v[fast * sites + k] = 90.0 * side * across;
            }
            let text = chains.steps(&exact(1e-10), 1).unwrap_err().to_string();
            assert!(text.contains(&format!("molecule {}", fast + 1)), "{text}");
            assert!(text.contains("turned"), "{text}");
        }
    }
}

#[test]
fn what_is_no_number_stops_the_step() {
    for sites in [2, 10] {
        let mut chains = Chains::new(6, sites, false);
        chains.f[3 * sites + 1].y = f64::NAN;
        let text = chains.steps(&exact(1e-10), 2).unwrap_err().to_string();
        assert!(text.contains("molecule 4"), "{text}");
    }
}
