//! What a system is, which does not change while it moves: species, masses, molecules, constraints, and the exact solution
//! where one is known.

use std::sync::Arc;

use glam::DVec3;

use crate::exact::Summand;
use crate::molecules::Molecules;
use crate::own::Own;
use crate::species::{Masses, Species, SpeciesTable};

/// A known solution of the equations of motion, against which methods are measured.
pub trait ExactSolution: Send + Sync + std::fmt::Debug {
    /// Advances positions and velocities exactly by `dt`.
    fn advance(&self, positions: &mut [DVec3], velocities: &mut [DVec3], dt: f64);
}

/// One holonomic constraint ε·λ + g(q) + τ·ġ(q) = 0 with G = ∂g/∂q
/// (Lacoursière, Ghosts and Machines, 2007; compliance ε = 1/k, damping time τ = c/k).
pub trait Constraint: Send + Sync + std::fmt::Debug {
    /// The constraint's value g(q).
    fn value(&self, positions: &[DVec3]) -> f64;
    /// Appends the non-zero entries of the gradient G = ∂g/∂q to `out`, each with its particle.
    fn gradient(&self, positions: &[DVec3], out: &mut Vec<(usize, DVec3)>);
    /// Compliance ε ≥ 0, the inverse of a stiffness.
    fn compliance(&self) -> f64;
    /// Damping time τ ≥ 0.
    fn damping_time(&self) -> f64;
}

/// Whether the motion keeps the total momentum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Momentum {
    /// Total momentum stays as it is, and is zero: its three components are not thermal.
    Conserved,
    /// Noise, walls or fields change it: its components are thermal as all others.
    Free,
}

/// What stays the same while a system moves.
#[derive(Debug, Clone)]
pub struct System {
    species: SpeciesTable,
    /// Particle masses, which follow from the species.
    pub masses: Masses,
    /// How particles are bonded to molecules.
    pub molecules: Molecules,
    /// Constraints, for the methods that solve for them.
    pub constraints: Vec<Arc<dyn Constraint>>,
    /// The exact solution, if one is known.
    pub exact: Option<Arc<dyn ExactSolution>>,
    /// Which of the particles this process keeps.
    own: Own,
    /// Axes x, y, z along which the forces keep the total momentum.
    keeps_momentum: [bool; 3],
}

impl System {
    /// `n` free particles of unit mass.
    #[must_use]
    pub fn atoms(n: usize) -> Self {
        Self::of_species(SpeciesTable::one(Species::unnamed(), n))
    }

    /// Free particles of these species, with their masses.
    #[must_use]
    pub fn of_species(species: SpeciesTable) -> Self {
        Self {
            masses: Masses::of_species(&species),
            own: Own::all_of(species.n_particles()),
            species,
            molecules: Molecules::ATOMS,
            constraints: Vec::new(),
            exact: None,
            keeps_momentum: [true; 3],
        }
    }

    /// The same system, of whose particles this process keeps some: masses and species of the others go, where they are still there.
    ///
    /// # Panics
    /// Where particles are bonded or held: that is a bug of the caller.
    #[must_use]
    pub fn keeping(self, own: Own) -> Self {
        assert!(self.molecules.are_atoms() && self.masses.n_held() == 0, "free atoms");
        let species = match self.species.n_kept() == own.len() {
            true => self.species,
            false => self.species.keeping(own.numbers()),
        };
        Self { masses: Masses::of_species(&species), species, own, ..self }
    }

    /// Which of the particles this process keeps, and the ranks that keep the others.
    #[must_use]
    pub fn own(&self) -> &Own {
        &self.own
    }

    /// The exact sum over all particles of a term for each. A rank gives the terms of the particles that it keeps.
    pub fn sum<T: Summand<N>, const N: usize>(&self, term: impl Fn(usize) -> T + Sync) -> T {
        self.own.sum(self.own.len(), term)
    }

    /// The same system under forces that change the total momentum along these axes
    /// ([`crate::ForceProperties::breaks_momentum`]).
    #[must_use]
    pub fn pushed_along(self, axes: [bool; 3]) -> Self {
        Self { keeps_momentum: axes.map(|pushed| !pushed), ..self }
    }

    /// The same system with some particles held in their places: their mass is infinite. A held particle takes up any momentum,
    /// so that no component of the total momentum is kept.
    #[must_use]
    pub fn holding(self, held: &[usize]) -> Self {
        if held.is_empty() {
            return self;
        }
        let mut masses: Vec<f64> = (0..self.len()).map(|i| self.masses.of(i)).collect();
        for i in held {
            masses[*i] = f64::INFINITY;
        }
        Self { masses: Masses::Each(masses), keeps_momentum: [false; 3], ..self }
    }

    /// A velocity without its components along the axes on which the forces change the total momentum.
    #[must_use]
    pub fn kept_part(&self, v: DVec3) -> DVec3 {
        let kept = |axis: usize| {
            if self.keeps_momentum[axis] { v[axis] } else { 0.0 }
        };
        DVec3::new(kept(0), kept(1), kept(2))
    }

    /// The same system with other masses.
    #[must_use]
    pub fn with_masses(self, masses: Masses) -> Self {
        Self { masses, ..self }
    }

    /// The same number of particles as molecules.
    ///
    /// # Panics
    /// Where the particles make no whole number of molecules: that is a bug of the caller.
    #[must_use]
    pub fn of_molecules(n: usize, molecules: Molecules) -> Self {
        Self::atoms(n).bonded(molecules)
    }

    /// The same particles bonded to molecules.
    ///
    /// # Panics
    /// As [`System::of_molecules`].
    #[must_use]
    pub fn bonded(self, molecules: Molecules) -> Self {
        assert!(self.len().is_multiple_of(molecules.sites()), "whole molecules");
        Self { molecules, ..self }
    }

    /// The species, and the species of each particle.
    #[must_use]
    pub fn species(&self) -> &SpeciesTable {
        &self.species
    }

    /// Number of molecules on all ranks; the number of particles where they are not bonded.
    #[must_use]
    pub fn n_molecules(&self) -> usize {
        self.len() / self.molecules.sites()
    }

    /// Number of particles, on all ranks.
    #[must_use]
    pub fn len(&self) -> usize {
        self.species.n_particles()
    }

    /// Whether there is no particle at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Degrees of freedom n_dof in T = 2K/n_dof: three per particle, less one for each rigid constraint. One less too for each
    /// component of the total momentum that method and forces conserve, which is zero. A single particle keeps its three: it
    /// has nothing to share its momentum with. A held particle has none. A constraint of compliance ε > 0 is a spring, which takes
    /// no degree of freedom away.
    #[must_use]
    pub fn n_dof(&self, momentum: Momentum) -> f64 {
        let mut rigid = self.constraints.iter().filter(|c| c.compliance() == 0.0).count();
        if self.molecules.are_rigid() {
            rigid += self.molecules.bonds().len() * self.n_molecules();
        }
        let kept = match momentum {
            Momentum::Conserved if self.len() > 1 => {
                self.keeps_momentum.iter().filter(|kept| **kept).count()
            }
            _ => 0,
        };
        3.0 * (self.len() - self.masses.n_held()) as f64 - (rigid + kept) as f64
    }

    /// The kinetic energy K = Σ ½ m v² of all particles in ε, an exact total.
    #[must_use]
    pub fn kinetic_energy(&self, velocities: &[DVec3]) -> f64 {
        match &self.masses {
            Masses::Uniform(m) => self.own.sum_of(velocities, |v| 0.5 * m * v.length_squared()),
            Masses::Each(_) => {
                self.sum(|i| 0.5 * self.masses.moving(i) * velocities[i].length_squared())
            }
        }
    }

    /// The kinetic temperature T = 2K/n_dof, in ε/k_B.
    #[must_use]
    pub fn temperature(&self, velocities: &[DVec3], momentum: Momentum) -> f64 {
        2.0 * self.kinetic_energy(velocities) / self.n_dof(momentum)
    }

    /// The total momentum Σ m v, an exact total.
    #[must_use]
    pub fn momentum(&self, velocities: &[DVec3]) -> DVec3 {
        self.sum(|i| self.masses.moving(i) * velocities[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bonds;

    #[derive(Debug)]
    struct Bond(f64);

    impl Constraint for Bond {
        fn value(&self, positions: &[DVec3]) -> f64 {
            positions[0].distance(positions[1]) - 1.0
        }
        fn gradient(&self, positions: &[DVec3], out: &mut Vec<(usize, DVec3)>) {
            let along = (positions[0] - positions[1]).normalize();
            out.extend([(0, along), (1, -along)]);
        }
        fn compliance(&self) -> f64 {
            self.0
        }
        fn damping_time(&self) -> f64 {
            0.0
        }
    }

    #[test]
    fn masses_of_a_mixture_are_one_number_where_they_are_alike() {
        let species = |mass: f64| {
            let b = Species { mass, ..Species::unnamed() };
            SpeciesTable::new([Species::unnamed(), b], &[0, 1, 1])
        };
        let alike = System::of_species(species(1.0));
        assert_eq!(alike.masses, Masses::Uniform(1.0));
        let unlike = System::of_species(species(3.0));
        assert_eq!(unlike.masses, Masses::Each(vec![1.0, 3.0, 3.0]));
        assert_eq!(unlike.momentum(&[DVec3::X; 3]), 7.0 * DVec3::X);
        assert_eq!(unlike.len(), 3);
    }

    #[test]
    fn degrees_of_freedom_follow_from_particles_constraints_and_momentum() {
        let mut system = System::atoms(10);
        assert_eq!(system.n_dof(Momentum::Conserved), 27.0);
        assert_eq!(system.n_dof(Momentum::Free), 30.0);
        assert_eq!(System::atoms(1).n_dof(Momentum::Conserved), 3.0);
        system.constraints = vec![Arc::new(Bond(0.0)), Arc::new(Bond(0.1))];
        assert_eq!(system.n_dof(Momentum::Conserved), 26.0);
        assert_eq!(system.n_dof(Momentum::Free), 29.0);
        let chains = |bonds| System::of_molecules(30, Molecules::chains(3, 1.0, bonds));
        assert_eq!(chains(Bonds::Rigid).n_dof(Momentum::Conserved), 67.0);
        assert_eq!(chains(Bonds::Springs).n_dof(Momentum::Conserved), 87.0);
        assert_eq!(chains(Bonds::Rigid).n_molecules(), 10);
        let slit = System::atoms(10).pushed_along([false, false, true]);
        assert_eq!(slit.n_dof(Momentum::Conserved), 28.0);
        assert_eq!(slit.n_dof(Momentum::Free), 30.0);
        assert_eq!(slit.kept_part(DVec3::ONE), DVec3::new(1.0, 1.0, 0.0));
    }

    #[test]
    fn held_particles_have_no_degree_of_freedom_no_energy_and_no_momentum() {
        let pendulum = System::of_molecules(2, Molecules::chains(2, 1.0, Bonds::Rigid));
        assert_eq!(pendulum.n_dof(Momentum::Conserved), 2.0);
        let pendulum = pendulum.holding(&[0]);
        assert_eq!(pendulum.n_dof(Momentum::Conserved), 2.0);
        assert_eq!(pendulum.n_dof(Momentum::Free), 2.0);
        let v = [DVec3::ZERO, 2.0 * DVec3::X];
        assert_eq!(pendulum.kinetic_energy(&v), 2.0);
        assert_eq!(pendulum.momentum(&v), v[1]);
        assert_eq!(pendulum.kept_part(v[1]), DVec3::ZERO);
        assert!(pendulum.masses.is_held(0) && !pendulum.masses.is_held(1));
        assert_eq!(pendulum.masses.reduced(0, 1), 1.0);
        // The centre of an infinite mass is where that mass is.
        let sites = [DVec3::X, 5.0 * DVec3::X];
        let center = pendulum.molecules.center(&pendulum.masses, 0, &sites);
        assert_eq!(center, DVec3::X);
        assert_eq!(System::atoms(3).holding(&[]).masses, Masses::Uniform(1.0));
    }
}
