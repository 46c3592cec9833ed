//! Forces that count how often they are asked.

use lennard_core::{
    Backend, Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceTerm, Part,
    Persist, RestoreError, StateReader, StateWriter, Want,
};

/// Passes everything on to other forces and counts evaluations and products with the Hessian.
#[derive(Debug, Clone)]
pub struct CountingForces<F> {
    inner: F,
    /// Evaluations so far, of any part.
    pub evaluations: u64,
    /// Products of the Hessian with a vector so far.
    pub products: u64,
}

impl<F> CountingForces<F> {
    /// Counts what `inner` is asked.
    pub fn new(inner: F) -> Self {
        Self { inner, evaluations: 0, products: 0 }
    }
}

impl<F: ForceTerm> Persist for CountingForces<F> {
    fn save(&self, to: &mut StateWriter<'_>) {
        self.inner.save(to);
    }
    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.inner.restore(from)
    }
}

impl<F: ForceTerm> ForceTerm for CountingForces<F> {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        self.evaluations += 1;
        self.inner.evaluate(at, part, want, forces)
    }

    fn properties(&self) -> ForceProperties {
        self.inner.properties()
    }

    fn hessian_vector(
        &mut self,
        at: Configuration<'_>,
        direction: &[DVec3],
        out: &mut [DVec3],
    ) -> Result<(), ForceError> {
        self.products += 1;
        self.inner.hessian_vector(at, direction, out)
    }
}

impl<F: ForceTerm> Backend for CountingForces<F> {}
