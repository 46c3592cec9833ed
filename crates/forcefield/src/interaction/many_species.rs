//! One truncated potential for each pair of species: u_ab(r) = ε_ab·f(r/σ_ab) with one f.
//!
//! ```text
//!   species of the neighbors     1    0    0    1    1    2  ...     the padding of their rows
//!   σ² of the own species      σ²₀₁ σ²₀₀ σ²₀₀ σ²₀₁ σ²₀₁ σ²₀₂ ...     picked from a register with the row of the table
//! ```

use lennard_core::MOST_SPECIES;

use super::Interaction;
use crate::number::Number;
use crate::pair::{Constants, Laws, Pair, PairForm, PairLaw};
use crate::simd::{BySpecies, Lanes};

/// One truncated potential for each pair of species.
#[derive(Clone, Copy)]
pub struct ManySpecies<'a, F> {
    /// The formula f.
    pub form: F,
    /// The numbers of each pair.
    pub laws: &'a Laws,
    /// The constants of each pair.
    pub constants: &'a ConstantsOfPairs,
}

/// The constants of a form for each pair of species.
pub type ConstantsOfPairs = [[Constants<f64>; MOST_SPECIES]; MOST_SPECIES];

/// The numbers of a species with each other one, in units of a loop: see [`PairLaw`].
#[derive(Clone, Copy)]
pub struct Row<T> {
    r_cut2: BySpecies<T>,
    sigma2: BySpecies<T>,
    inv_sigma2: BySpecies<T>,
    epsilon: BySpecies<T>,
    stiffness: BySpecies<T>,
    constants: Constants<BySpecies<T>>,
    energy_at_cutoff: BySpecies<T>,
}

/// The numbers of all pairs of species.
pub struct Table<T> {
    rows: [Row<T>; MOST_SPECIES],
}

/// A [`Row`] in registers.
#[derive(Clone, Copy)]
pub struct OwnRow<L: Lanes> {
    r_cut2: L::Table,
    sigma2: L::Table,
    inv_sigma2: L::Table,
    epsilon: L::Table,
    stiffness: L::Table,
    constants: Constants<L::Table>,
    energy_at_cutoff: L::Table,
}

impl<T: Number> Row<T> {
    fn new<F: PairForm>(
        of: &ManySpecies<'_, F>,
        species: usize,
        unit: f64,
        r_cut: f64,
        length: f64,
    ) -> Self {
        let unit2 = length * length;
        let laws = &of.laws.of_pairs[species];
        let each = |number: &dyn Fn(&PairLaw) -> f64| {
            let mut row = [T::of(0.0); MOST_SPECIES];
            for (to, law) in row.iter_mut().zip(laws) {
                *to = T::of(number(law));
            }
            BySpecies(row)
        };
        let constant = |k: usize| {
            let of_pairs = of.constants[species].map(|c| of.form.constants::<T>(c)[k]);
            BySpecies(of_pairs.map(T::of))
        };
        Self {
            r_cut2: each(&|law| (law.r_cut * law.r_cut).min(r_cut * r_cut) / unit2),
            sigma2: each(&|law| law.sigma2 / unit2),
            inv_sigma2: each(&|law| law.inv_sigma2 * unit2),
            epsilon: each(&|law| law.epsilon),
            stiffness: each(&|law| law.stiffness),
            constants: [constant(0), constant(1), constant(2)],
            energy_at_cutoff: each(&|law| law.energy_at_cutoff / unit),
        }
    }
}

impl<F: PairForm> Interaction for ManySpecies<'_, F> {
    const UNIT: f64 = F::UNIT;
    type Numbers<T: Number> = Table<T>;
    type Own<L: Lanes> = OwnRow<L>;

    fn numbers<T: Number>(&self, r_cut: f64, length: f64) -> Table<T> {
        let row = |a: usize| Row::new(self, a, F::UNIT, r_cut, length);
        // A loop may ask at every step, and no particle has one of the other species.
        let mut rows = [row(0); MOST_SPECIES];
        for (a, to) in rows.iter_mut().enumerate().take(self.laws.mixture.species()).skip(1) {
            *to = row(a);
        }
        Table { rows }
    }

    #[inline(always)]
    fn own<L: Lanes>(isa: L::Isa, numbers: &Table<L::Number>, row: &L::Row) -> OwnRow<L> {
        let own = &numbers.rows[L::species_of(row) % MOST_SPECIES];
        OwnRow {
            r_cut2: L::table(isa, &own.r_cut2),
            sigma2: L::table(isa, &own.sigma2),
            inv_sigma2: L::table(isa, &own.inv_sigma2),
            epsilon: L::table(isa, &own.epsilon),
            stiffness: L::table(isa, &own.stiffness),
            constants: [
                L::table(isa, &own.constants[0]),
                L::table(isa, &own.constants[1]),
                L::table(isa, &own.constants[2]),
            ],
            energy_at_cutoff: L::table(isa, &own.energy_at_cutoff),
        }
    }

    #[inline(always)]
    fn r_cut2<L: Lanes>(own: &OwnRow<L>, neighbors: L::Species) -> L {
        L::pick(own.r_cut2, neighbors)
    }

    #[inline(always)]
    fn eval<L: Lanes, const IN_SIGMA: bool>(
        &self,
        own: &OwnRow<L>,
        neighbors: L::Species,
        r2: L,
    ) -> Pair<L> {
        // There is no closure here: it may be a call, and a call leaves the instruction set.
        let constants = [
            L::pick(own.constants[0], neighbors),
            L::pick(own.constants[1], neighbors),
            L::pick(own.constants[2], neighbors),
        ];
        let inv_sigma2 = L::pick(own.inv_sigma2, neighbors);
        let sigma2 = L::pick(own.sigma2, neighbors);
        let pair = self.form.eval(constants, r2 * inv_sigma2, sigma2 / r2);
        let epsilon = L::pick(own.epsilon, neighbors);
        let stiffness = L::pick(own.stiffness, neighbors);
        Pair {
            energy: epsilon * pair.energy,
            force: stiffness * pair.force,
            curvature: stiffness * pair.curvature,
        }
    }

    #[inline(always)]
    fn at_cutoff<L: Lanes>(own: &OwnRow<L>, neighbors: L::Species) -> Option<L> {
        Some(L::pick(own.energy_at_cutoff, neighbors))
    }
}
