//! Exact persistence: named, typed arrays that carry what a bit-exact restart needs.

use std::collections::BTreeMap;

use glam::DVec3;

/// One named array of an archive.
#[derive(Debug, Clone, PartialEq)]
pub enum Array {
    /// Floating-point numbers, kept to the bit.
    F64(Vec<f64>),
    /// Signed integers.
    I64(Vec<i64>),
    /// Unsigned integers.
    U64(Vec<u64>),
    /// Vectors, kept to the bit.
    Vec3(Vec<DVec3>),
}

impl Array {
    /// Bytes of its values.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match self {
            Self::F64(values) => size_of_val(&values[..]),
            Self::I64(values) => size_of_val(&values[..]),
            Self::U64(values) => size_of_val(&values[..]),
            Self::Vec3(values) => size_of_val(&values[..]),
        }
    }
}

/// All arrays of a saved run, by name (`integrator/previous_positions`).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StateArchive {
    /// The arrays by full name.
    pub arrays: BTreeMap<String, Array>,
}

/// Why a saved state does not fit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RestoreError {
    /// The array is not there.
    #[error("the saved state has no entry `{0}`")]
    Missing(String),
    /// It is there with another type.
    #[error("the saved entry `{0}` has another type")]
    WrongType(String),
    /// It is there with another length or an impossible value.
    #[error("the saved entry `{name}` does not fit: {reason}")]
    Misfit {
        /// Full name.
        name: String,
        /// What is wrong.
        reason: String,
    },
}

/// Something that can be saved and restored to the bit.
pub trait Persist {
    /// Writes everything that later steps depend on.
    fn save(&self, to: &mut StateWriter<'_>);
    /// Takes it back.
    ///
    /// # Errors
    /// [`RestoreError`] where an entry is missing or does not fit.
    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError>;
}

/// Implements [`Persist`] for a type that remembers nothing between steps.
///
/// ```
/// struct Still;
/// lennard_core::remembers_nothing!(Still);
/// ```
#[macro_export]
macro_rules! remembers_nothing {
    ($type:ty) => {
        impl $crate::Persist for $type {
            fn save(&self, _to: &mut $crate::StateWriter<'_>) {}
            fn restore(
                &mut self,
                _from: &$crate::StateReader<'_>,
            ) -> Result<(), $crate::RestoreError> {
                Ok(())
            }
        }
    };
}

/// Writes arrays under a prefix.
pub struct StateWriter<'a> {
    archive: &'a mut StateArchive,
    prefix: String,
}

impl StateArchive {
    /// Bytes of the values of all arrays.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.arrays.values().map(Array::bytes).sum()
    }

    /// A writer at the top level.
    pub fn writer(&mut self) -> StateWriter<'_> {
        StateWriter { archive: self, prefix: String::new() }
    }

    /// A reader at the top level.
    #[must_use]
    pub fn reader(&self) -> StateReader<'_> {
        StateReader { archive: self, prefix: String::new() }
    }
}

impl StateWriter<'_> {
    /// A writer whose names stand under `name/`.
    pub fn section(&mut self, name: &str) -> StateWriter<'_> {
        StateWriter { prefix: format!("{}{name}/", self.prefix), archive: self.archive }
    }

    /// Saves an array.
    pub fn put(&mut self, name: &str, array: Array) {
        self.archive.arrays.insert(format!("{}{name}", self.prefix), array);
    }

    /// Saves numbers.
    pub fn put_f64(&mut self, name: &str, values: &[f64]) {
        self.put(name, Array::F64(values.to_vec()));
    }

    /// Saves unsigned integers.
    pub fn put_u64(&mut self, name: &str, values: &[u64]) {
        self.put(name, Array::U64(values.to_vec()));
    }

    /// Saves signed integers.
    pub fn put_i64(&mut self, name: &str, values: &[i64]) {
        self.put(name, Array::I64(values.to_vec()));
    }

    /// Saves vectors.
    pub fn put_vec3(&mut self, name: &str, values: &[DVec3]) {
        self.put(name, Array::Vec3(values.to_vec()));
    }
}

/// Reads arrays under a prefix.
#[derive(Debug, Clone)]
pub struct StateReader<'a> {
    archive: &'a StateArchive,
    prefix: String,
}

impl<'a> StateReader<'a> {
    /// A reader whose names stand under `name/`.
    #[must_use]
    pub fn section(&self, name: &str) -> StateReader<'a> {
        StateReader { archive: self.archive, prefix: format!("{}{name}/", self.prefix) }
    }

    fn get(&self, name: &str) -> Result<(&'a Array, String), RestoreError> {
        let full = format!("{}{name}", self.prefix);
        match self.archive.arrays.get(&full) {
            Some(array) => Ok((array, full)),
            None => Err(RestoreError::Missing(full)),
        }
    }

    /// Numbers.
    ///
    /// # Errors
    /// [`RestoreError`] where the entry is missing or of another type.
    pub fn f64(&self, name: &str) -> Result<&'a [f64], RestoreError> {
        match self.get(name)? {
            (Array::F64(v), _) => Ok(v),
            (_, full) => Err(RestoreError::WrongType(full)),
        }
    }

    /// Unsigned integers.
    ///
    /// # Errors
    /// [`RestoreError`] where the entry is missing or of another type.
    pub fn u64(&self, name: &str) -> Result<&'a [u64], RestoreError> {
        match self.get(name)? {
            (Array::U64(v), _) => Ok(v),
            (_, full) => Err(RestoreError::WrongType(full)),
        }
    }

    /// Signed integers.
    ///
    /// # Errors
    /// [`RestoreError`] where the entry is missing or of another type.
    pub fn i64(&self, name: &str) -> Result<&'a [i64], RestoreError> {
        match self.get(name)? {
            (Array::I64(v), _) => Ok(v),
            (_, full) => Err(RestoreError::WrongType(full)),
        }
    }

    /// Vectors.
    ///
    /// # Errors
    /// [`RestoreError`] where the entry is missing or of another type.
    pub fn vec3(&self, name: &str) -> Result<&'a [DVec3], RestoreError> {
        match self.get(name)? {
            (Array::Vec3(v), _) => Ok(v),
            (_, full) => Err(RestoreError::WrongType(full)),
        }
    }

    /// Exactly `N` numbers.
    ///
    /// # Errors
    /// [`RestoreError`] where the entry is missing, of another type or of another length.
    pub fn f64s<const N: usize>(&self, name: &str) -> Result<[f64; N], RestoreError> {
        let values = self.f64(name)?;
        values
            .try_into()
            .map_err(|_| self.misfit(name, format!("{} values, wanted {N}", values.len())))
    }

    /// Exactly `N` unsigned integers.
    ///
    /// # Errors
    /// [`RestoreError`] where the entry is missing, of another type or of another length.
    pub fn u64s<const N: usize>(&self, name: &str) -> Result<[u64; N], RestoreError> {
        let values = self.u64(name)?;
        values
            .try_into()
            .map_err(|_| self.misfit(name, format!("{} values, wanted {N}", values.len())))
    }

    /// An error that names an entry of this section.
    #[must_use]
    pub fn misfit(&self, name: &str, reason: impl Into<String>) -> RestoreError {
        RestoreError::Misfit { name: format!("{}{name}", self.prefix), reason: reason.into() }
    }
}

impl Persist for crate::State {
    fn save(&self, to: &mut StateWriter<'_>) {
        to.put_u64("step", &[self.step]);
        to.put_f64("time", &[self.time]);
        to.put_vec3("positions", &self.positions);
        to.put_vec3("velocities", &self.velocities);
        to.put_vec3("forces", &self.forces);
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        let n = self.len();
        for (name, target) in [
            ("positions", &mut self.positions),
            ("velocities", &mut self.velocities),
            ("forces", &mut self.forces),
        ] {
            let saved = from.vec3(name)?;
            if saved.len() != n {
                return Err(from.misfit(name, format!("{} particles, wanted {n}", saved.len())));
            }
            target.copy_from_slice(saved);
        }
        [self.step] = from.u64s("step")?;
        [self.time] = from.f64s("time")?;
        self.energetics = crate::Energetics::default();
        Ok(())
    }
}
