//! Stiff springs: bonds as forces.

use lennard_core::parallel::ordered_sum;
use lennard_core::{
    Bonds, Configuration, DMat3, DVec3, Energetics, ForceError, ForceProperties, ForceTerm,
    Molecules, Part, Want,
};

use super::{BondHolder, BondMethod, BondSpec};

lennard_core::options! {
    /// Options of springs.
    pub struct Options {
        /// Stiffness k of each bond.
        stiffness: f64 = 4000.0, Positive, in "ε/σ²";
    }
}

impl BondMethod for Options {
    const SPEC: BondSpec = BondSpec {
        name: "spring",
        summary: "Bonds as stiff springs: a force term, which takes no degree of freedom away.",
        equations: "U = k/2 (|d| - r)^2; omega = sqrt(k (1/m_i + 1/m_j)); the step must stay below 2/omega",
        bonds: Bonds::Springs,
        source: "Allen and Tildesley, \"Computer Simulation of Liquids\", 2nd ed. (2017), section 1.3.3",
    };

    fn build(&self, molecules: &Molecules) -> BondHolder {
        BondHolder::Spring(Box::new(Springs {
            stiffness: self.stiffness,
            molecules: *molecules,
        }))
    }

    fn frequency(&self) -> f64 {
        (2.0 * self.stiffness).sqrt()
    }
}

/// Springs U = ½k(|d| − r)² along the bonds of molecules, with the force −k(|d| − r)·d/|d| on the site at the end of d.
#[derive(Debug, Clone)]
pub struct Springs {
    stiffness: f64,
    molecules: Molecules,
}

lennard_core::remembers_nothing!(Springs);

/// Totals of a part of the bonds.
#[derive(Clone, Copy)]
struct Sums {
    energy: f64,
    virial: DMat3,
    laplacian: f64,
}

impl Sums {
    const NOTHING: Self = Self {
        energy: 0.0,
        virial: DMat3::ZERO,
        laplacian: 0.0,
    };
}

impl std::iter::Sum for Sums {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::NOTHING, |a, b| a + b)
    }
}

impl std::ops::Add for Sums {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            energy: self.energy + other.energy,
            virial: self.virial + other.virial,
            laplacian: self.laplacian + other.laplacian,
        }
    }
}

impl Springs {
    /// The force on the site at the end of a bond d, and its energy.
    fn bond(&self, d: DVec3) -> (DVec3, f64) {
        let length = d.length();
        let strain = length - self.molecules.bond_length();
        let force = (-self.stiffness * strain / length) * d;
        (force, 0.5 * self.stiffness * strain * strain)
    }

    fn add_forces(&self, positions: &[DVec3], forces: &mut [DVec3]) {
        let molecules = &self.molecules;
        molecules.for_each(molecules.sites(), forces, |m, forces| {
            let sites = &positions[molecules.sites_of(m)];
            for (c, pair) in sites.windows(2).enumerate() {
                let (f, _) = self.bond(pair[1] - pair[0]);
                forces[c] -= f;
                forces[c + 1] += f;
            }
        });
    }

    fn totals(&self, positions: &[DVec3]) -> Sums {
        ordered_sum(positions.len() / self.molecules.sites(), |range| {
            let mut sums = Sums::NOTHING;
            for m in range {
                for pair in positions[self.molecules.sites_of(m)].windows(2) {
                    let d = pair[1] - pair[0];
                    let (f, energy) = self.bond(d);
                    sums.energy += energy;
                    sums.virial += DMat3::from_cols(f * d.x, f * d.y, f * d.z);
                    // ∇²U = U″ + 2U′/|d| at each of the two ends.
                    let slope = 1.0 - self.molecules.bond_length() / d.length();
                    sums.laplacian += 2.0 * self.stiffness * (1.0 + 2.0 * slope);
                }
            }
            sums
        })
    }
}

impl ForceTerm for Springs {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        forces.fill(DVec3::ZERO);
        self.add(at, part, want, &mut Vec::new(), forces)
    }

    fn add(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        _scratch: &mut Vec<DVec3>,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        // Springs are the fastest motion: they belong to the near part.
        let sums = if part == Part::Far {
            Sums::NOTHING
        } else {
            self.add_forces(at.positions, forces);
            if want.is_nothing() {
                Sums::NOTHING
            } else {
                self.totals(at.positions)
            }
        };
        Ok(Energetics {
            potential_energy: want.energy.then_some(sums.energy),
            conserved_potential: want.energy.then_some(sums.energy),
            virial: want.virial.then_some(sums.virial),
            laplacian: want.laplacian.then_some(sums.laplacian),
            ..Energetics::default()
        })
    }

    fn force_on(&self, particle: usize, at: Configuration<'_>) -> DVec3 {
        let x = at.positions;
        let site = particle % self.molecules.sites();
        let mut force = DVec3::ZERO;
        if site > 0 {
            force += self.bond(x[particle] - x[particle - 1]).0;
        }
        if site + 1 < self.molecules.sites() {
            force -= self.bond(x[particle + 1] - x[particle]).0;
        }
        force
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties {
            splits: true,
            ..ForceProperties::default()
        }
    }
}
