//! What particles do to each other: the formula for one pair, and the loops over lists.

use std::sync::Arc;

use lennard_core::{MOST_SPECIES, PeriodicBox};

use super::many_species::ConstantsOfPairs;
use super::{ManySpecies, NearPart, OneSpecies};
use crate::number::PairRows;
use crate::pair::{
    ByRows, Compiled, Constants, ForceShifted, Form, LawOfRows, Laws, Model, Pair, PairForm,
    Spline, Switched, TwelveSix,
};
use crate::simd::{ChunkLoop, PackedList};

/// The whole force between pairs, or its near part.
#[derive(Clone, Debug)]
pub struct Pairwise {
    model: Model,
    /// The potentials of each pair of species, where pairs differ.
    laws: Option<Arc<Laws>>,
    near: Option<NearPart>,
    /// Of a run whose list has loops in lanes.
    loops: Option<Loops>,
}

/// What loops sum, with its constants for each pair of species.
#[derive(Clone, Debug)]
struct Loops {
    law: Law,
    constants: Box<ConstantsOfPairs>,
}

/// What loops sum.
#[derive(Clone, Debug)]
enum Law {
    /// A form that they compile in.
    Formula(Compiled),
    /// Any other form.
    Rows(Arc<PairRows>),
}

/// A pair of species whose rows hold no tolerance at a distance, σ.
#[derive(Clone, Copy, Debug)]
pub struct NoRows {
    /// The distance, σ.
    pub r: f64,
}

impl Pairwise {
    /// The whole force of a model, or of the laws of a mixture; or its near part.
    pub fn new(model: Model, laws: Option<Arc<Laws>>, near: Option<NearPart>) -> Self {
        Self { model, laws, near, loops: None }
    }

    /// The same with loops in lanes.
    ///
    /// # Errors
    /// [`NoRows`] where the form is not compiled, and no number of rows holds its tolerance.
    pub fn with_loops(self) -> Result<Self, NoRows> {
        let loops = self.compiled().map_or_else(|| self.by_rows(), Ok)?;
        Ok(Self { loops: Some(loops), ..self })
    }

    /// The model: formula and largest cutoff.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The cutoff that a list serves, σ: of the whole force, or the end of the near part.
    pub fn r_cut(&self) -> f64 {
        self.near.map_or(self.model.r_cut, |near| near.end())
    }

    /// The species of each particle, where pairs differ.
    pub fn of_particle(&self) -> Option<Arc<[u8]>> {
        self.laws.as_ref().map(|laws| laws.mixture.of_particle().clone())
    }

    /// The values of particles `i` and `j` at r² = `r2` σ², ε; none beyond the cutoff of their pair.
    ///
    /// A loop itself compares r² with the largest cutoff.
    #[inline(always)]
    pub fn between(&self, i: usize, j: usize, r2: f64) -> Option<Pair<f64>> {
        let pair = match &self.laws {
            None => self.model.eval(r2),
            Some(laws) => {
                let law = laws.between(i, j);
                if r2 > law.r_cut * law.r_cut {
                    return None;
                }
                law.eval(r2)
            }
        };
        Some(self.near.map_or(pair, |near| near.of(pair, r2)))
    }

    /// U(r_cut) of particles `i` and `j`, which the conserved energy subtracts, ε; 0 where pairs are counted instead.
    pub fn energy_at_cutoff(&self, i: usize, j: usize) -> f64 {
        self.laws.as_ref().map_or(0.0, |laws| laws.between(i, j).energy_at_cutoff)
    }

    /// The loop over a list in a box.
    ///
    /// # Panics
    /// Where there are no loops in lanes: that is a bug of the caller.
    pub fn over<'a, P: PackedList>(
        &'a self,
        list: &'a P,
        cell: &PeriodicBox,
    ) -> Box<dyn ChunkLoop<P::Row> + 'a> {
        let r_cut = self.r_cut();
        let loops = self.loops.as_ref().expect("a list in lanes has loops");
        match &loops.law {
            Law::Rows(rows) => self.loop_of(loops, ByRows(rows), list, r_cut, cell),
            Law::Formula(Compiled::TwelveSix) => self.loop_of(loops, TwelveSix, list, r_cut, cell),
            Law::Formula(Compiled::ForceShifted) => {
                self.loop_of(loops, ForceShifted, list, r_cut, cell)
            }
            Law::Formula(Compiled::Switched) => loops.of_one(Switched, list, r_cut, cell),
            Law::Formula(Compiled::TwoPowers(form)) => loops.of_one(*form, list, r_cut, cell),
            Law::Formula(Compiled::Spline) => loops.of_one(Spline, list, r_cut, cell),
        }
    }

    /// The loop of a form over a list.
    fn loop_of<'a, P: PackedList, F: PairForm + 'a>(
        &'a self,
        loops: &'a Loops,
        form: F,
        list: &'a P,
        r_cut: f64,
        cell: &PeriodicBox,
    ) -> Box<dyn ChunkLoop<P::Row> + 'a> {
        match &self.laws {
            None => loops.of_one(form, list, r_cut, cell),
            // As below.
            Some(_) if cfg!(test) => unreachable!("a unit test evaluates no forces"),
            Some(laws) => {
                let constants = &loops.constants;
                list.chunk_loop(ManySpecies { form, laws, constants }, r_cut, cell)
            }
        }
    }

    /// The loops of a form that is compiled.
    fn compiled(&self) -> Option<Loops> {
        let of_one_species = self.laws.is_none();
        let (form, _) = self.model.form.compiled(of_one_species).filter(|_| self.near.is_none())?;
        let constants = |form: &Form, _: [usize; 2]| {
            form.compiled(of_one_species).map_or([0.0; 3], |(_, constants)| constants)
        };
        Some(Loops { law: Law::Formula(form), constants: self.constants(constants) })
    }

    /// The constants `of` the form of each pair of species.
    fn constants(&self, of: impl Fn(&Form, [usize; 2]) -> Constants<f64>) -> Box<ConstantsOfPairs> {
        let mut constants = Box::new([[[0.0; 3]; MOST_SPECIES]; MOST_SPECIES]);
        match &self.laws {
            None => constants[0][0] = of(&self.model.form, [0; 2]),
            Some(laws) => {
                for (a, b) in pairs_of(laws) {
                    constants[a][b] = of(&laws.of_pairs[a][b].form, [a, b]);
                }
            }
        }
        constants
    }

    /// The loops over rows. Pairs of species whose laws are equal in their own units share their rows.
    fn by_rows(&self) -> Result<Loops, NoRows> {
        let mut rows_of: Vec<LawOfRows<'_>> = Vec::new();
        let mut sigmas = vec![];
        let mut number = [[0; MOST_SPECIES]; MOST_SPECIES];
        match &self.laws {
            None => rows_of.push(self.law(&self.model.form, self.model.r_cut, 1.0)),
            Some(laws) => {
                for (a, b) in pairs_of(laws) {
                    let of_pair = &laws.of_pairs[a][b];
                    let sigma = of_pair.sigma2.sqrt();
                    let law = self.law(&of_pair.form, of_pair.r_cut / sigma, sigma);
                    let known = rows_of.iter().position(|known| known.is(&law));
                    number[a][b] = known.unwrap_or(rows_of.len());
                    if known.is_none() {
                        rows_of.push(law);
                        sigmas.push(sigma);
                    }
                }
            }
        }
        let rows = PairRows::new(&rows_of)
            .map_err(|(law, r)| NoRows { r: r * sigmas.get(law).copied().unwrap_or(1.0) })?;
        let constants = |_: &Form, [a, b]: [usize; 2]| rows.constants(number[a][b]);
        let constants = self.constants(constants);
        Ok(Loops { law: Law::Rows(Arc::new(rows)), constants })
    }

    /// The law of a pair whose σ is `sigma` σ, with its cutoff, in its own units.
    fn law<'a>(&self, form: &'a Form, r_cut: f64, sigma: f64) -> LawOfRows<'a> {
        match &self.near {
            None => LawOfRows::of(form, r_cut),
            Some(near) => near.law(form, r_cut, sigma),
        }
    }
}

impl Loops {
    /// The loop of a form of one species over a list.
    fn of_one<'a, P: PackedList, F: PairForm + 'a>(
        &self,
        form: F,
        list: &'a P,
        r_cut: f64,
        cell: &PeriodicBox,
    ) -> Box<dyn ChunkLoop<P::Row> + 'a> {
        // Unit tests evaluate no forces, and tests/all does: without the loops, unit tests compile faster.
        if cfg!(test) {
            unreachable!("a unit test evaluates no forces");
        }
        list.chunk_loop(OneSpecies { form, constants: self.constants[0][0] }, r_cut, cell)
    }
}

/// Each pair of species, in both orders.
fn pairs_of(laws: &Laws) -> impl Iterator<Item = (usize, usize)> {
    let species = laws.mixture.species();
    (0..species * species).map(move |k| (k / species, k % species))
}
