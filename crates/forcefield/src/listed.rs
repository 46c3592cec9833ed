//! A Verlet list at work: positions packed into rows, validity checked before each use, pairs summed.

use glam::DVec3;
use lennard_core::{
    ForceError, FusedSteps as Stride, PeriodicBox, RestoreError, StateReader, StateWriter,
};
use lennard_neighbor::{Criterion, Given, Images, NeighborList, SharedList};

use crate::clock::Clock;
use crate::copies::{Copies, Fitness, Known, Use};
use crate::pure::{self, Nearby, PureJob};
use crate::simd::{
    DoubleRow, FixedRow, Level, Motion, Moved, Next, Output, Pace, PairList, PerParticle, Wanted,
};
use crate::sums::Totals;
use crate::terms::Terms;
use crate::truncation::PairForm;
use crate::underway::Underway;

/// A list with the private copies of the positions that its loop reads.
enum Pairs {
    /// The neighbors of each particle, for forces that are a pure function of the positions.
    Canonical(Box<NeighborList>, Folded),
    /// The neighbors of each particle.
    Rows(Box<NeighborList>, Laid<DoubleRow>),
    /// The neighbors of every four particles.
    Shared(Box<SharedList>, Laid<FixedRow>),
}

/// Particles as a loop reads them, at rest and underway.
#[derive(Default)]
struct Laid<Row> {
    copies: Copies<Row>,
    underway: Underway,
}

/// Folded positions, and sorted lists by particle.
#[derive(Default)]
struct Folded {
    wrapped: Vec<DVec3>,
    lists: Vec<Vec<u32>>,
}

/// Fewest steps that are worth laying particles out for.
const FEWEST_STEPS: u64 = 3;

/// A list with everything that belongs to it.
pub struct Listed {
    terms: Terms,
    pairs: Pairs,
}

/// Which loop a list feeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loop {
    /// Forces that are a pure function of the positions.
    Canonical,
    /// The neighbors of each particle, in double precision.
    Rows,
    /// The neighbors of every four particles, in mixed precision.
    Shared,
}

impl Listed {
    /// A list for `r_cut` and `skin` in σ.
    pub fn new(cell: PeriodicBox, r_cut: f64, skin: f64, level: Level, kind: Loop) -> Self {
        // Distances in fixed point are off by about the unit of the longest side.
        let rounding = match kind {
            Loop::Shared => {
                4.0 * cell.lengths().max_element() * f64::from(f32::EPSILON) / 256.0
                    + 4.0 * r_cut * f64::from(f32::EPSILON)
            }
            Loop::Rows | Loop::Canonical => 0.0,
        };
        let radius = r_cut + skin + rounding;
        let list = |images| Box::new(NeighborList::new(cell, radius, images, level.lanes()));
        let pairs = match kind {
            Loop::Canonical => Pairs::Canonical(list(Images::Folded), Folded::default()),
            Loop::Rows => Pairs::Rows(list(Images::Ghosts), Laid::default()),
            Loop::Shared => Pairs::Shared(
                Box::new(SharedList::new(cell, r_cut, radius)),
                Laid::default(),
            ),
        };
        let terms = Terms {
            cell,
            r_cut,
            radius,
            level,
            criterion: Criterion::new(skin),
            built: Vec::new(),
            named: Vec::new(),
        };
        Self { terms, pairs }
    }

    /// Lanes computed in one evaluation, which meets every pair from both of its ends.
    pub fn lanes(&self) -> u64 {
        match &self.pairs {
            Pairs::Canonical(list, _) | Pairs::Rows(list, _) => list.lanes_listed(),
            Pairs::Shared(list, _) => list.lanes(),
        }
    }

    /// Pairs listed, each counted once.
    pub fn listed_pairs(&self) -> u64 {
        match &self.pairs {
            Pairs::Canonical(list, _) | Pairs::Rows(list, _) => list.pairs(),
            Pairs::Shared(list, _) => list.pairs(),
        }
    }

    /// The particle at each place of the list's order.
    fn particles(&self) -> &[u32] {
        match &self.pairs {
            Pairs::Canonical(list, _) | Pairs::Rows(list, _) => &list.table().particle,
            Pairs::Shared(list, _) => &list.table().particle,
        }
    }

    /// The criterion with its counters.
    pub fn criterion(&self) -> &Criterion {
        &self.terms.criterion
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        let pairs = match &self.pairs {
            Pairs::Canonical(list, folded) => list.bytes() + folded.bytes(),
            Pairs::Rows(list, laid) => list.bytes() + laid.bytes(),
            Pairs::Shared(list, laid) => list.bytes() + laid.bytes(),
        };
        (pairs + 24 * self.terms.built.capacity()) as u64
    }

    /// Builds the list for `positions`.
    pub fn build(&mut self, positions: &[DVec3]) -> Result<(), ForceError> {
        let (terms, given) = (&mut self.terms, Given::ByParticle(positions));
        match &mut self.pairs {
            Pairs::Canonical(list, folded) => {
                terms.build(&mut **list, given)?;
                folded.list(list);
                Ok(())
            }
            Pairs::Rows(list, _) => terms.build(&mut **list, given),
            Pairs::Shared(list, _) => terms.build(&mut **list, given),
        }
    }

    /// Names pairs that the list lacks; gives whether it can.
    fn name(&mut self, pairs: &[[u32; 2]]) -> bool {
        let terms = &mut self.terms;
        match &mut self.pairs {
            Pairs::Canonical(list, _) | Pairs::Rows(list, _) => terms.name(&mut **list, pairs),
            Pairs::Shared(list, _) => terms.name(&mut **list, pairs),
        }
    }

    /// Writes forces (and `each`) at `positions` and returns the totals, which are those of `wanted`.
    pub fn evaluate<F: PairForm>(
        &mut self,
        form: F,
        positions: &[DVec3],
        wanted: Wanted,
        forces: &mut [DVec3],
        mut each: Option<&mut [PerParticle]>,
        clock: &mut Clock,
    ) -> Result<Totals, ForceError> {
        let (fitness, totals, broken) = clock.using(|clock| {
            let mut used = Use::of(wanted);
            while self.terms.built.len() == positions.len() {
                let found = self.attempt(form, positions, used, forces, each.as_deref_mut());
                match found.0 {
                    Fitness::Lacks(pairs) if self.name(&pairs) => used.known = Known::Judged,
                    Fitness::Stale | Fitness::Lacks(_) => break,
                    Fitness::Fit | Fitness::Broken => return Ok(found),
                }
            }
            clock.building(|| self.build(positions))?;
            Ok(self.attempt(form, positions, Use::of(wanted), forces, each))
        })?;
        if fitness == Fitness::Broken {
            return Err(not_finite(positions));
        }
        assert_eq!(fitness, Fitness::Fit, "a list is fit where it was built");
        if broken {
            return Err(not_finite_force(forces));
        }
        Ok(totals)
    }

    /// Judges the list at `positions`, as far as that was not done, and evaluates where it is fit; gives totals and whether a
    /// force was not finite.
    fn attempt<F: PairForm>(
        &mut self,
        form: F,
        positions: &[DVec3],
        used: Use,
        forces: &mut [DVec3],
        each: Option<&mut [PerParticle]>,
    ) -> (Fitness, Totals, bool) {
        let terms = &self.terms;
        match &mut self.pairs {
            Pairs::Canonical(list, folded) => {
                let particles = &list.table().particle;
                let moved = folded.pack(&terms.cell, terms.motion(positions, particles));
                let at = |place| positions[particles[place as usize] as usize];
                let fitness = terms.fitness(&**list, &moved, None, at);
                if fitness != Fitness::Fit {
                    return (fitness, Totals::NOTHING, false);
                }
                let job = PureJob {
                    form,
                    r_cut: terms.r_cut,
                    cell: &terms.cell,
                    wrapped: &folded.wrapped,
                    nearby: Nearby::Listed(&folded.lists),
                };
                let chunks = job.run(forces, each);
                let broken = chunks.iter().any(|c| c.broken);
                (fitness, Totals::of_chunks(&chunks), broken)
            }
            Pairs::Rows(list, laid) => {
                let output = Output::new(forces, each, list.particles(), 0);
                laid.sum(terms, &**list, form, positions, used, &output)
            }
            Pairs::Shared(list, laid) => {
                let output = Output::new(forces, each, list.particles(), 0);
                laid.sum(terms, &**list, form, positions, used, &output)
            }
        }
    }

    /// Takes steps of a stride: see [`lennard_core::Backend::advance`].
    pub fn stride<F: PairForm>(
        &mut self,
        form: F,
        stride: &mut Stride<'_>,
        pace: Pace,
        clock: &mut Clock,
    ) -> u64 {
        if stride.steps < FEWEST_STEPS {
            return 0;
        }
        let terms = &mut self.terms;
        clock.using(|clock| match &mut self.pairs {
            // Of forces that are a pure function of the positions nothing else is wanted.
            Pairs::Canonical(..) => 0,
            Pairs::Rows(list, laid) => laid.go(terms, &mut **list, form, stride, pace, clock),
            Pairs::Shared(list, laid) => laid.go(terms, &mut **list, form, stride, pace, clock),
        })
    }

    /// Writes what a restart needs: the positions of the build.
    pub fn save(&self, to: &mut StateWriter<'_>) {
        let mut by_particle = vec![DVec3::ZERO; self.terms.built.len()];
        for (particle, r) in self.particles().iter().zip(&self.terms.built) {
            by_particle[*particle as usize] = *r;
        }
        to.put_vec3("built_at", &by_particle);
        let named: Vec<u64> = self
            .terms
            .named
            .iter()
            .flatten()
            .map(|p| (*p).into())
            .collect();
        to.put_u64("named", &named);
        to.put_u64("counters", &[self.terms.criterion.builds()]);
    }

    /// Builds the list of the saved run again, from the positions that it was built at, and names what was named since.
    pub fn restore(&mut self, from: &StateReader<'_>, n: usize) -> Result<(), RestoreError> {
        let built = from.vec3("built_at")?;
        if !built.is_empty() {
            if built.len() != n {
                return Err(
                    from.misfit("built_at", format!("{} particles, wanted {n}", built.len()))
                );
            }
            self.build(built)
                .map_err(|e| from.misfit("built_at", e.to_string()))?;
            self.restore_named(from, n)?;
        } else {
            self.terms.built.clear();
        }
        match from.u64("counters")? {
            // The second is of a version that counted something else besides.
            [builds] | [builds, _] => {
                self.terms.criterion.set_builds(*builds);
                Ok(())
            }
            other => Err(from.misfit("counters", format!("{} numbers, wanted 1", other.len()))),
        }
    }

    fn restore_named(&mut self, from: &StateReader<'_>, n: usize) -> Result<(), RestoreError> {
        let named = match from.u64("named") {
            // Of a run by a version that named nothing.
            Err(RestoreError::Missing(_)) => &[],
            named => named?,
        };
        if named.is_empty() {
            return Ok(());
        }
        let (pairs, rest) = named.as_chunks::<2>();
        let is_pair = |[a, b]: &[u64; 2]| a < b && *b < n as u64;
        let pairs: Vec<[u32; 2]> = pairs
            .iter()
            .filter(|pair| is_pair(pair))
            .map(|pair| pair.map(|place| place as u32))
            .collect();
        if 2 * pairs.len() == named.len() && rest.is_empty() && self.name(&pairs) {
            return Ok(());
        }
        Err(from.misfit(
            "named",
            format!("no pairs of {n} places that this list can name"),
        ))
    }
}

impl Folded {
    fn bytes(&self) -> usize {
        let lists = self.lists.iter().map(|l| 24 + 4 * l.capacity());
        24 * self.wrapped.capacity() + lists.sum::<usize>()
    }

    /// Takes over a list that was just built.
    fn list(&mut self, list: &NeighborList) {
        self.lists = list.neighbors();
        for list in &mut self.lists {
            list.dedup();
        }
    }

    /// Folds positions; gives the displacements since the build.
    fn pack(&mut self, cell: &PeriodicBox, motion: Motion<'_>) -> Moved {
        pure::wrap(cell, motion.positions, &mut self.wrapped);
        let moved = motion.order.iter().zip(motion.built);
        let squares: Vec<f64> = moved
            .map(|(particle, at)| (motion.positions[*particle as usize] - *at).length_squared())
            .collect();
        let mut moved = Moved::NOTHING;
        moved.include(0, &squares, motion.far2);
        moved
    }
}

impl<Row: Copy + Default + Send + Sync> Laid<Row> {
    fn bytes(&self) -> usize {
        self.copies.bytes() + self.underway.bytes()
    }

    /// Packs, judges, and runs all chunks where the list is fit.
    fn sum<P: PairList<Row = Row>, F: PairForm>(
        &mut self,
        terms: &Terms,
        list: &P,
        form: F,
        positions: &[DVec3],
        used: Use,
        output: &Output<'_>,
    ) -> (Fitness, Totals, bool) {
        let job = list.job(form, terms.r_cut, terms.cell.lengths());
        let run = |rows: &[Row], _: Option<&Next<'_, Row>>, c| {
            P::run(terms.level, &job, rows, c, used.wanted, output)
        };
        let lists = (list, &mut self.copies);
        terms.use_list(lists, || positions, list.particles(), used, &run)
    }

    /// See [`Underway::go`].
    fn go<P: PairList<Row = Row>, F: PairForm>(
        &mut self,
        terms: &mut Terms,
        list: &mut P,
        form: F,
        stride: &mut Stride<'_>,
        pace: Pace,
        clock: &mut Clock,
    ) -> u64 {
        let lists = (list, &mut self.copies);
        self.underway.go(terms, lists, form, stride, pace, clock)
    }
}

/// The error that names the first particle whose position is not finite.
pub fn not_finite(positions: &[DVec3]) -> ForceError {
    ForceError::NonFinitePosition {
        particle: positions
            .iter()
            .position(|r| !r.is_finite())
            .unwrap_or_default(),
    }
}

/// The error that names the first particle whose force is not finite.
pub fn not_finite_force(forces: &[DVec3]) -> ForceError {
    ForceError::NonFiniteForce {
        particle: forces
            .iter()
            .position(|f| !f.is_finite())
            .unwrap_or_default(),
    }
}
