//! The sum of several force terms.

use glam::DVec3;

use crate::{
    Backend, Boundary, Configuration, Energetics, ForceError, ForceProperties, ForceStatistics,
    ForceTerm, FusedSteps, HaloSize, Part, Persist, RestoreError, StateReader, StateWriter, Team,
    TooManyRanks, WallReading, Want,
};

/// Forces that add, in a fixed order: the first may be a backend of its own, which alone takes several steps at once.
pub struct ForceSum<B> {
    first: B,
    others: Vec<Box<dyn ForceTerm>>,
    scratch: Vec<DVec3>,
}

impl<B: Backend> ForceSum<B> {
    /// One term, at the cost of that term.
    #[must_use]
    pub fn new(first: B) -> Self {
        Self { first, others: Vec::new(), scratch: Vec::new() }
    }

    /// The same sum with one term more.
    #[must_use]
    pub fn with(mut self, term: impl ForceTerm + 'static) -> Self {
        self.push(Box::new(term));
        self
    }

    /// Adds one term more.
    pub fn push(&mut self, term: Box<dyn ForceTerm>) {
        self.others.push(term);
    }

    /// The first term.
    #[must_use]
    pub fn first(&self) -> &B {
        &self.first
    }
}

impl<B: Backend> ForceTerm for ForceSum<B> {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        let mut all = self.first.evaluate(at, part, want, forces)?;
        for term in &mut self.others {
            let found = term.add(at, part, want, &mut self.scratch, forces)?;
            all = all.with_term(&found);
        }
        Ok(all)
    }

    /// The force of all terms but the first, which is checked.
    fn force_on(&self, particle: usize, at: Configuration<'_>) -> DVec3 {
        let others = self.others.iter();
        others.map(|term| term.force_on(particle, at)).sum()
    }

    fn properties(&self) -> ForceProperties {
        self.others
            .iter()
            .fold(self.first.properties(), |all, term| all.with_term(term.properties()))
    }

    fn statistics(&self) -> ForceStatistics {
        self.first.statistics()
    }

    /// One term holds all walls.
    fn walls(&self) -> &[WallReading] {
        let walls = self.others.iter().map(|term| term.walls());
        walls.max_by_key(|walls| walls.len()).unwrap_or_default()
    }

    fn boundary(&mut self) -> Option<&mut dyn Boundary> {
        self.others.iter_mut().find_map(|term| term.boundary())
    }

    fn hessian_vector(
        &mut self,
        at: Configuration<'_>,
        direction: &[DVec3],
        out: &mut [DVec3],
    ) -> Result<(), ForceError> {
        self.first.hessian_vector(at, direction, out)?;
        for term in &mut self.others {
            self.scratch.resize(out.len(), DVec3::ZERO);
            term.hessian_vector(at, direction, &mut self.scratch)?;
            for (sum, one) in out.iter_mut().zip(&self.scratch) {
                *sum += *one;
            }
        }
        Ok(())
    }
}

impl<B: Backend> Backend for ForceSum<B> {
    fn advance(&mut self, steps: &mut FusedSteps<'_>) -> u64 {
        // The first term knows nothing of the others.
        if self.others.is_empty() { self.first.advance(steps) } else { 0 }
    }

    /// The first term alone is shared: the others touch few particles, and each rank computes them.
    fn share(&mut self, team: &Team) -> Result<bool, TooManyRanks> {
        self.first.share(team)
    }

    fn halo_on(&self, ranks: usize) -> Option<HaloSize> {
        self.first.halo_on(ranks)
    }
}

impl<B: Backend> Persist for ForceSum<B> {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { first, others, scratch: _ } = self;
        first.save(to);
        for (i, term) in others.iter().enumerate() {
            term.save(&mut to.section(&format!("term-{}", i + 1)));
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.first.restore(from)?;
        for (i, term) in self.others.iter_mut().enumerate() {
            term.restore(&from.section(&format!("term-{}", i + 1)))?;
        }
        Ok(())
    }
}
