//! Exact persistence: named, typed arrays that carry what a bit-exact restart needs.

use std::collections::BTreeMap;

use glam::DVec3;

/// One named array of an archive.
#[derive(Debug, Clone, PartialEq)]
pub enum Array {
    /// Floating-point numbers, kept to the bit.
    F64(Vec<f64>),
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
///
/// A number or an array of numbers is the entry that its section names. A type with fields is a section with an entry or a
/// section per field, which [`persist!`](crate::persist) writes and reads.
pub trait Persist {
    /// Writes everything that later steps depend on.
    fn save(&self, to: &mut StateWriter<'_>);
    /// Takes it back. Nothing has a default: what was saved has to be there.
    ///
    /// # Errors
    /// [`RestoreError`] where an entry is missing or does not fit.
    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError>;
}

/// Implements [`Persist`] for a type by the names of all its fields. A type with another field does not compile.
///
/// | Written | Meaning |
/// |---|---|
/// | `field` | saved under the name of the field |
/// | `field as "name"` | saved under another name |
/// | `[a, b] as "name"` | numbers of one type, saved as one array |
/// | `..field` | saved without a section of its own |
/// | `fixed a, b` | last of all: what the scene gives, and working space |
///
/// ```
/// struct Bath {
///     friction: f64,
///     momentum: f64,
///     heat: f64,
///     taken: Vec<u64>,
/// }
/// lennard_core::persist!(Bath { [momentum, heat] as "bath", taken, fixed friction });
/// ```
///
/// ```compile_fail
/// struct Bath {
///     friction: f64,
///     momentum: f64,
///     heat: f64,
/// }
/// lennard_core::persist!(Bath { momentum, fixed friction });
/// ```
///
/// Parameters of the type come first: `persist!([F: Flux] Coefficient<F> { .. })`.
#[macro_export]
macro_rules! persist {
    // One entry after the other: the pattern that names its fields, how it is saved, and how it is restored.
    (@ $of:tt $to:ident $from:ident [$($seen:tt)*] [$($save:tt)*] [$($restore:tt)*] ..$field:ident $(, $($more:tt)*)?) => {
        $crate::persist!(
            @ $of $to $from
            [$($seen)* $field,]
            [$($save)* $crate::Persist::save($field, $to);]
            [$($restore)* $crate::Persist::restore($field, $from)?;]
            $($($more)*)?
        );
    };
    (@ $of:tt $to:ident $from:ident [$($seen:tt)*] [$($save:tt)*] [$($restore:tt)*] [$($field:ident),+] as $name:literal $(, $($more:tt)*)?) => {
        $crate::persist!(
            @ $of $to $from
            [$($seen)* $($field,)+]
            [$($save)* $crate::Persist::save(&[$(*$field),+], &mut $to.section($name));]
            [$($restore)*
                let mut together = [$(*$field),+];
                $crate::Persist::restore(&mut together, &$from.section($name))?;
                [$(*$field),+] = together;
            ]
            $($($more)*)?
        );
    };
    (@ [[$($parameters:tt)*] $type:ty] $to:ident $from:ident [$($seen:tt)*] [$($save:tt)*] [$($restore:tt)*] $(fixed $($fixed:ident),+)? $(,)?) => {
        impl<$($parameters)*> $crate::Persist for $type {
            fn save(&self, $to: &mut $crate::StateWriter<'_>) {
                let Self { $($seen)* $($($fixed: _),+)? } = self;
                let _ = &$to;
                $($save)*
            }
            fn restore(
                &mut self,
                $from: &$crate::StateReader<'_>,
            ) -> ::core::result::Result<(), $crate::RestoreError> {
                let Self { $($seen)* $($($fixed: _),+)? } = self;
                let _ = $from;
                $($restore)*
                Ok(())
            }
        }
    };
    (@ $of:tt $to:ident $from:ident $seen:tt $save:tt $restore:tt $field:ident as $name:literal $(, $($more:tt)*)?) => {
        $crate::persist!(@ section $of $to $from $seen $save $restore $field, $name; $($($more)*)?);
    };
    (@ $of:tt $to:ident $from:ident $seen:tt $save:tt $restore:tt $field:ident $(, $($more:tt)*)?) => {
        $crate::persist!(@ section $of $to $from $seen $save $restore $field, stringify!($field); $($($more)*)?);
    };
    (@ section $of:tt $to:ident $from:ident [$($seen:tt)*] [$($save:tt)*] [$($restore:tt)*] $field:ident, $name:expr; $($more:tt)*) => {
        $crate::persist!(
            @ $of $to $from
            [$($seen)* $field,]
            [$($save)* $crate::Persist::save($field, &mut $to.section($name));]
            [$($restore)* $crate::Persist::restore($field, &$from.section($name))?;]
            $($more)*
        );
    };
    ([$($parameters:tt)*] $type:ty { $($fields:tt)* }) => {
        $crate::persist!(@ [[$($parameters)*] $type] to from [] [] [] $($fields)*);
    };
    ($type:ty { $($fields:tt)* }) => {
        $crate::persist!([] $type { $($fields)* });
    };
}

/// Implements [`Persist`] for a type that remembers nothing between steps. Where the fields are named, another field
/// does not compile.
///
/// ```
/// struct Still;
/// lennard_core::remembers_nothing!(Still);
/// struct Wave {
///     number: f64,
/// }
/// lennard_core::remembers_nothing!(Wave { number });
/// ```
#[macro_export]
macro_rules! remembers_nothing {
    ($type:ty { $($field:ident),+ }) => {
        $crate::persist!($type { fixed $($field),+ });
    };
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

/// A value of which an archive keeps arrays.
pub trait Value: Copy {
    /// The array of several values.
    fn array(values: &[Self]) -> Array;
    /// The values of an array; `None` where it has another type.
    fn values(array: &Array) -> Option<&[Self]>;
}

macro_rules! values {
    ($($type:ty => $array:ident),+) => {$(
        impl Value for $type {
            fn array(values: &[Self]) -> Array {
                Array::$array(values.to_vec())
            }
            fn values(array: &Array) -> Option<&[Self]> {
                if let Array::$array(values) = array { Some(values) } else { None }
            }
        }
    )+};
}
values!(f64 => F64, u64 => U64, DVec3 => Vec3);

/// Types that are saved as one array, each with how it becomes that array and how it comes back from a reader.
macro_rules! persist_as_array {
    ($([$($parameters:tt)*] $type:ty: |$this:ident| $array:expr, |$from:ident| $back:expr;)+) => {$(
        impl<$($parameters)*> Persist for $type {
            fn save(&self, to: &mut StateWriter<'_>) {
                let $this = self;
                to.archive.arrays.insert(to.prefix.clone(), Value::array($array));
            }
            fn restore(&mut self, $from: &StateReader<'_>) -> Result<(), RestoreError> {
                *self = $back;
                Ok(())
            }
        }
    )+};
}
persist_as_array! {
    [] f64: |value| &[*value], |from| from.exactly::<_, 1>()?[0];
    [] u64: |value| &[*value], |from| from.exactly::<_, 1>()?[0];
    [] bool: |value| &[u64::from(*value)], |from| from.exactly::<u64, 1>()?[0] == 1;
    [] DVec3: |value| &value.to_array(), |from| Self::from_array(from.exactly()?);
    [T: Value, const N: usize] [T; N]: |values| values, |from| from.exactly()?;
    [T: Value] Vec<T>: |values| values, |from| from.values()?.to_vec();
}

/// As many values as there are.
impl<T: Value> Persist for [T] {
    fn save(&self, to: &mut StateWriter<'_>) {
        to.archive.arrays.insert(to.prefix.clone(), T::array(self));
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        let values = from.values()?;
        if values.len() != self.len() {
            return Err(from.wrong_length(values.len(), self.len()));
        }
        self.copy_from_slice(values);
        Ok(())
    }
}

impl<T: Persist + ?Sized> Persist for Box<T> {
    fn save(&self, to: &mut StateWriter<'_>) {
        (**self).save(to);
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        (**self).restore(from)
    }
}

/// Whether there is any is no part of what is saved: the scene says so.
impl<T: Persist> Persist for Option<T> {
    fn save(&self, to: &mut StateWriter<'_>) {
        self.iter().for_each(|inner| inner.save(to));
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.iter_mut().try_for_each(|inner| inner.restore(from))
    }
}

/// Writes arrays under a prefix.
pub struct StateWriter<'a> {
    archive: &'a mut StateArchive,
    prefix: String,
}

impl StateArchive {
    /// Whether an array of vectors has one for each particle, so that each rank keeps a part of it.
    #[must_use]
    pub fn is_of_particles(name: &str) -> bool {
        ["state/", "forces/", "method/"].iter().any(|section| name.starts_with(section))
    }

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
        StateWriter { prefix: below(&self.prefix, name), archive: self.archive }
    }

    /// Saves an array.
    pub fn put(&mut self, name: &str, array: Array) {
        self.archive.arrays.insert(below(&self.prefix, name), array);
    }

    /// Saves numbers.
    pub fn put_f64(&mut self, name: &str, values: &[f64]) {
        self.put(name, Array::F64(values.to_vec()));
    }

    /// Saves unsigned integers.
    pub fn put_u64(&mut self, name: &str, values: &[u64]) {
        self.put(name, Array::U64(values.to_vec()));
    }

    /// Saves vectors.
    pub fn put_vec3(&mut self, name: &str, values: &[DVec3]) {
        self.put(name, Array::Vec3(values.to_vec()));
    }
}

/// The full name of an entry or a section.
fn below(prefix: &str, name: &str) -> String {
    if prefix.is_empty() { name.to_owned() } else { format!("{prefix}/{name}") }
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
        StateReader { archive: self.archive, prefix: below(&self.prefix, name) }
    }

    /// The values of the array that this section names.
    fn values<T: Value>(&self) -> Result<&'a [T], RestoreError> {
        let name = || self.prefix.clone();
        let array = self.archive.arrays.get(&self.prefix);
        let array = array.ok_or_else(|| RestoreError::Missing(name()))?;
        T::values(array).ok_or_else(|| RestoreError::WrongType(name()))
    }

    fn exactly<T: Value, const N: usize>(&self) -> Result<[T; N], RestoreError> {
        let values = self.values()?;
        values.try_into().map_err(|_| self.wrong_length(values.len(), N))
    }

    fn wrong_length(&self, found: usize, wanted: usize) -> RestoreError {
        let reason = format!("{found} values, wanted {wanted}");
        RestoreError::Misfit { name: self.prefix.clone(), reason }
    }

    /// Numbers.
    ///
    /// # Errors
    /// [`RestoreError`] where the entry is missing or of another type.
    pub fn f64(&self, name: &str) -> Result<&'a [f64], RestoreError> {
        self.section(name).values()
    }

    /// Unsigned integers.
    ///
    /// # Errors
    /// [`RestoreError`] where the entry is missing or of another type.
    pub fn u64(&self, name: &str) -> Result<&'a [u64], RestoreError> {
        self.section(name).values()
    }

    /// Vectors.
    ///
    /// # Errors
    /// [`RestoreError`] where the entry is missing or of another type.
    pub fn vec3(&self, name: &str) -> Result<&'a [DVec3], RestoreError> {
        self.section(name).values()
    }

    /// Exactly `N` numbers.
    ///
    /// # Errors
    /// [`RestoreError`] where the entry is missing, of another type or of another length.
    pub fn f64s<const N: usize>(&self, name: &str) -> Result<[f64; N], RestoreError> {
        self.section(name).exactly()
    }

    /// Exactly `N` unsigned integers.
    ///
    /// # Errors
    /// [`RestoreError`] where the entry is missing, of another type or of another length.
    pub fn u64s<const N: usize>(&self, name: &str) -> Result<[u64; N], RestoreError> {
        self.section(name).exactly()
    }

    /// An error that names an entry of this section.
    #[must_use]
    pub fn misfit(&self, name: &str, reason: impl Into<String>) -> RestoreError {
        RestoreError::Misfit { name: below(&self.prefix, name), reason: reason.into() }
    }
}
