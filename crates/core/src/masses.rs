//! The masses of particles.

/// The masses of the particles.
#[derive(Debug, Clone, PartialEq)]
pub enum Masses {
    /// All particles have this mass.
    Uniform(f64),
    /// One mass per particle, `[N]`.
    Each(Vec<f64>),
}

impl Masses {
    /// The mass of particle `i`.
    #[inline]
    #[must_use]
    pub fn of(&self, i: usize) -> f64 {
        match self {
            Self::Uniform(m) => *m,
            Self::Each(m) => m[i],
        }
    }
}
