//! The state of a system and what may be asked of its forces.

use glam::{DMat3, DVec3};

use crate::PeriodicBox;

/// What an integrator advances: the particles that this process keeps ([`crate::Own`]). After `step`, everything in it belongs to `time`.
///
/// Particles keep the order of the start configuration; kernels that want another order keep a
/// private copy.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Number of steps taken since the start of the run.
    pub step: u64,
    /// Time in τ.
    pub time: f64,
    /// The box. No other owner keeps a copy that has to agree.
    pub cell: PeriodicBox,
    /// Unwrapped positions, `[N]`, σ.
    pub positions: Vec<DVec3>,
    /// Velocities, `[N]`, σ/τ.
    pub velocities: Vec<DVec3>,
    /// Forces F = −∂U/∂r at `positions`, `[N]`, ε/σ.
    pub forces: Vec<DVec3>,
    /// Energy, virial and so on at `positions`; each entry is `None` where it was not asked for on this step.
    pub energetics: Energetics,
}

// The box is the simulation's to save, and energetics belong to one step.
crate::persist!(State { step, time, positions, velocities, forces, fixed cell, energetics });

impl State {
    /// A state at step 0 and time 0 with zero forces, which an integrator's `start` then fills.
    ///
    /// # Panics
    /// Where the two arrays differ in length: that is a bug of the caller.
    #[must_use]
    pub fn new(cell: PeriodicBox, positions: Vec<DVec3>, velocities: Vec<DVec3>) -> Self {
        assert_eq!(positions.len(), velocities.len(), "one velocity for each position");
        let forces = vec![DVec3::ZERO; positions.len()];
        Self {
            step: 0,
            time: 0.0,
            cell,
            positions,
            velocities,
            forces,
            energetics: Energetics::default(),
        }
    }

    /// Number of particles that this process keeps.
    #[must_use]
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there is no particle at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }
}

/// What a force evaluation should deliver besides the forces: a set, united over all who ask.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Want {
    /// The potential energy.
    pub energy: bool,
    /// The scalar virial W = Σ r_ij·F_ij.
    pub virial: bool,
    /// The 3×3 virial Σ r_ij ⊗ F_ij, with `virial` besides: pair loops sum it more slowly.
    pub virial_tensor: bool,
    /// The Laplacian Σ_i ∇_i²U, for the configurational temperature.
    pub laplacian: bool,
    /// Energy and virial of each particle, for the heat flux.
    pub per_particle: bool,
}

impl Want {
    /// Forces alone.
    pub const NOTHING: Self = Self {
        energy: false,
        virial: false,
        virial_tensor: false,
        laplacian: false,
        per_particle: false,
    };
    /// Energy alone.
    pub const ENERGY: Self = Self { energy: true, ..Self::NOTHING };
    /// Energy and scalar virial.
    pub const ENERGY_AND_VIRIAL: Self = Self { energy: true, virial: true, ..Self::NOTHING };
    /// The virial as a tensor and as a scalar.
    pub const VIRIAL_TENSOR: Self = Self { virial: true, virial_tensor: true, ..Self::NOTHING };
    /// Energy, scalar virial and Laplacian.
    pub const TOTALS: Self = Self { laplacian: true, ..Self::ENERGY_AND_VIRIAL };

    /// Whether only forces are wanted.
    #[must_use]
    pub fn is_nothing(&self) -> bool {
        *self == Self::NOTHING
    }
}

impl std::ops::BitOr for Want {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self {
            energy: self.energy || other.energy,
            virial: self.virial || other.virial,
            virial_tensor: self.virial_tensor || other.virial_tensor,
            laplacian: self.laplacian || other.laplacian,
            per_particle: self.per_particle || other.per_particle,
        }
    }
}

impl std::ops::BitOrAssign for Want {
    fn bitor_assign(&mut self, other: Self) {
        *self = *self | other;
    }
}

/// Which part of a force to evaluate: RESPA asks for the near and the far part apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Part {
    /// The whole force.
    All,
    /// The quickly changing part, from near neighbors.
    Near,
    /// The slowly changing rest; `Near + Far = All`.
    Far,
}

/// Where the forces are wanted.
#[derive(Debug, Clone, Copy)]
pub struct Configuration<'a> {
    /// The box.
    pub cell: &'a PeriodicBox,
    /// Unwrapped positions, `[N]`, σ.
    pub positions: &'a [DVec3],
    /// Velocities, `[N]`, σ/τ, for forces that depend on them.
    pub velocities: Option<&'a [DVec3]>,
    /// Time in τ, for forces that depend on it.
    pub time: f64,
}

impl<'a> Configuration<'a> {
    /// Positions in a box at time 0, without velocities.
    #[must_use]
    pub fn at_rest(cell: &'a PeriodicBox, positions: &'a [DVec3]) -> Self {
        Self { cell, positions, velocities: None, time: 0.0 }
    }
}

/// Totals over the system; each is `None` where it was not asked for.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Energetics {
    /// Potential energy of the model named, in ε, without any tail correction.
    pub potential_energy: Option<f64>,
    /// The energy of which the forces are the gradient, in ε. For the plain cutoff it is the shifted
    /// energy, U_cut − n_pairs·U(r_cut); otherwise it equals `potential_energy`. Conservation is judged by
    /// it.
    pub conserved_potential: Option<f64>,
    /// Virial tensor Σ_{i<j} r_ij ⊗ F_ij in ε, without a factor 1/3; its trace is W. A term may leave it out where only W is
    /// wanted.
    pub virial: Option<DMat3>,
    /// W where a loop sums it by itself, ε; see [`Energetics::scalar_virial`]. It has the same bits with and without the
    /// tensor.
    pub virial_trace: Option<f64>,
    /// Laplacian Σ_i ∇_i²U in ε/σ².
    pub laplacian: Option<f64>,
    /// Number of pairs with r ≤ r_cut; comes with the energy.
    pub pairs: Option<u64>,
    /// Energy (½ of each pair) in ε and virial tensor (½ of each pair) of each particle, `[N]`.
    pub per_particle: Option<Vec<(f64, DMat3)>>,
}

impl Energetics {
    /// The parts that `want` asks for of a term whose forces conserve the energy U, with the virial tensor and ∇²U. Energies of
    /// particles are left out.
    #[must_use]
    pub fn of(want: Want, energy: f64, virial: DMat3, laplacian: f64) -> Self {
        Self {
            potential_energy: want.energy.then_some(energy),
            conserved_potential: want.energy.then_some(energy),
            virial: want.virial.then_some(virial),
            laplacian: want.laplacian.then_some(laplacian),
            ..Self::default()
        }
    }

    /// The scalar virial W = Σ r_ij·F_ij in ε: summed by itself, or else the trace of the tensor.
    #[must_use]
    pub fn scalar_virial(&self) -> Option<f64> {
        let trace = |w: DMat3| w.x_axis.x + w.y_axis.y + w.z_axis.z;
        self.virial_trace.or(self.virial.map(trace))
    }

    /// The sum over two force terms. An entry is kept only where both terms have it. The number of pairs is kept where
    /// either term has it, since some terms have no pairs.
    #[must_use]
    pub fn with_term(&self, other: &Self) -> Self {
        let pairs = match (self.pairs, other.pairs) {
            (Some(a), Some(b)) => Some(a + b),
            (a, b) => a.or(b),
        };
        Self { pairs, ..self.plus(other) }
    }

    /// The sum of two parts (RESPA's near and far); an entry is kept only where both have it.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        fn both<T: Clone + std::ops::Add<Output = T>>(a: &Option<T>, b: &Option<T>) -> Option<T> {
            Some(a.clone()? + b.clone()?)
        }
        Self {
            potential_energy: both(&self.potential_energy, &other.potential_energy),
            conserved_potential: both(&self.conserved_potential, &other.conserved_potential),
            virial: both(&self.virial, &other.virial),
            virial_trace: both(&self.scalar_virial(), &other.scalar_virial()),
            laplacian: both(&self.laplacian, &other.laplacian),
            // The far part runs over every pair, the near part over some of the same.
            pairs: self.pairs.zip(other.pairs).map(|(a, b)| a.max(b)),
            per_particle: self
                .per_particle
                .as_ref()
                .zip(other.per_particle.as_ref())
                .map(|(a, b)| a.iter().zip(b).map(|(x, y)| (x.0 + y.0, x.1 + y.1)).collect()),
        }
    }
}
