//! Relaxation: one bond after another is brought to its length, in sweeps over the molecule.

use lennard_core::options::OptionError;
use lennard_core::{Bonds, Drifted, Molecules};

use super::molecule::{EachMolecule, MoleculeRule, MovedMolecule, NoSolution, Space};
use super::{BondHolder, BondMethod, BondSpec};

lennard_core::choices! {
    /// The direction of the correction of a bond.
    pub enum Direction {
        /// Along the bond before the drift, as SHAKE does: time-reversible where it has converged.
        #[default]
        Old = "old",
        /// Along the bond as it is now, without a velocity stage: energy drifts in proportion to the step.
        New = "new",
    }
}

lennard_core::options! {
    /// Options of relaxation.
    pub struct Options {
        /// Largest | |d|/r − 1 | at which sweeps end.
        tolerance: Option<f64> = None, else "`1e-10`, unless `sweeps` is given", Between(4e-15, 1e-2);
        /// Number of sweeps, in place of a tolerance; 0 sweeps until the tolerance.
        sweeps: u32 = 0, Whole(0, 100_000);
        /// Direction of the corrections: the bond before the drift (SHAKE), or the bond as it is now (dissipative).
        direction: Direction = Direction::Old, Names(Direction::names);
        /// Factor of each correction.
        over_relaxation: f64 = 1.0, Between(0.01, 1.99);
    }
}

const DEFAULT_TOLERANCE: f64 = 1e-10;
/// A straight chain of 64 sites takes some 10⁴ sweeps to 10⁻¹².
const MOST_SWEEPS: u32 = 100_000;

/// What this way declares about itself.
pub const SPEC: BondSpec = BondSpec {
    name: "relaxation",
    summary: "Rigid bonds by relaxation: each bond is corrected in turn until all have their length (SHAKE), or for a number of sweeps.",
    equations: "direction old: eta = w (r^2 - |s|^2)/(2 s.d_n), x_i -= eta d_n/(m_i k), x_j += eta d_n/(m_j k); direction new: f = w (|s| - r)/(|s| k), x_i += f s/m_i, x_j -= f s/m_j; k = 1/m_i + 1/m_j",
    bonds: Bonds::Rigid,
    integrator: None,
    source: "Ryckaert, Ciccotti and Berendsen, \"Numerical integration of the cartesian equations of motion of a system with constraints\", J. Comput. Phys. 23, 327 (1977)",
};

impl BondMethod for Options {
    fn build(&self, _molecules: &Molecules) -> BondHolder {
        let rule = Relaxation { options: self.clone() };
        BondHolder::Drift(Box::new(EachMolecule(rule)))
    }

    fn check_together(&self) -> Result<(), OptionError> {
        match self.tolerance {
            Some(tolerance) if self.sweeps > 0 => Err(OptionError {
                key: "sweeps",
                found: format!("{} with tolerance = {tolerance:e}", self.sweeps),
                allowed: "sweeps or a tolerance, not both".to_owned(),
            }),
            _ => Ok(()),
        }
    }

    fn no_ensemble(&self) -> Option<&'static str> {
        (self.direction == Direction::New)
            .then_some("`direction = \"new\"` does not run back in time, and its energy drifts")
    }
}

/// Relaxation: Gauss–Seidel sweeps over the bonds of each molecule, in their order.
///
/// Its asymptotic rate is the spectral radius of Gauss–Seidel on G·M⁻¹·Gᵀ: cos²(π/(n + 1)) for a straight chain of n bonds.
#[derive(Debug, Clone)]
struct Relaxation {
    options: Options,
}

impl MoleculeRule for Relaxation {
    fn solve(
        &self,
        molecule: &mut MovedMolecule<'_>,
        _space: &mut Space,
    ) -> Result<Drifted, NoSolution> {
        let options = &self.options;
        if options.sweeps == 0 {
            let tolerance = options.tolerance.unwrap_or(DEFAULT_TOLERANCE);
            return molecule.until(tolerance, MOST_SWEEPS, |molecule| sweep(molecule, options));
        }
        (0..options.sweeps).try_for_each(|_| sweep(molecule, options))?;
        let residual = molecule.residual();
        Ok(Drifted { iterations: options.sweeps, residual, ..Drifted::default() })
    }

    /// The rule along the new bond stands alone, on positions: velocities are displacements over the step.
    fn has_velocity_stage(&self) -> bool {
        self.options.direction == Direction::Old
    }
}

/// One sweep over the bonds.
fn sweep(molecule: &mut MovedMolecule<'_>, options: &Options) -> Result<(), NoSolution> {
    let topology = molecule.topology;
    for (c, bond) in topology.bonds().iter().enumerate() {
        let s = bond.vector(molecule.sites);
        let [i, j] = bond.sites.map(|site| 1.0 / molecule.masses.of(molecule.first + site));
        let correction = match options.direction {
            Direction::Old => {
                let d = molecule.before[c];
                let along = s.dot(d);
                if along.is_nan() || along <= 0.0 {
                    return Err(molecule.turned(c, s));
                }
                let off = bond.length * bond.length - s.length_squared();
                (off / (2.0 * along)) * d
            }
            Direction::New => (bond.length / s.length() - 1.0) * s,
        };
        let share = (options.over_relaxation / (i + j)) * correction;
        molecule.displace(bond.sites[0], -i * share);
        molecule.displace(bond.sites[1], j * share);
    }
    Ok(())
}
