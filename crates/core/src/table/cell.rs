//! A cell of a table: a typed value, and a tone for a reader.

use serde::Serialize;
use serde::ser::{SerializeStruct, Serializer};

/// What a cell holds.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Value {
    /// Nothing: an empty field for a program, a dash for a reader.
    #[default]
    Missing,
    /// Words.
    Words(String),
    /// Figures that are written already, such as a range. They stand where numbers stand.
    Figures(String),
    /// A whole number.
    Whole(u64),
    /// A number.
    Number {
        /// The number.
        value: f64,
        /// Significant digits for a reader; `None` means as few as the number needs, four at most.
        digits: Option<usize>,
    },
    /// A number with its standard error.
    Measured {
        /// The number.
        value: f64,
        /// Its standard error; not a number where there is none.
        error: f64,
    },
}

/// What a cell says beyond its value.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Tone {
    /// Nothing.
    #[default]
    Plain,
    /// The thing holds.
    Good,
    /// The thing does not hold.
    Bad,
    /// The thing wants care.
    Careful,
    /// The thing is shown, and nothing follows from it.
    Faint,
}

/// A cell of a table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cell {
    /// What it holds.
    pub value: Value,
    /// What it says beyond that.
    pub tone: Tone,
}

impl Cell {
    /// Words.
    #[must_use]
    pub fn words(words: impl Into<String>) -> Self {
        Value::Words(words.into()).into()
    }

    /// Figures that are written already.
    #[must_use]
    pub fn figures(figures: impl Into<String>) -> Self {
        Value::Figures(figures.into()).into()
    }

    /// A number of which a reader sees so many significant digits.
    #[must_use]
    pub fn rounded(value: impl Into<Option<f64>>, digits: usize) -> Self {
        let number = |value| Value::Number { value, digits: Some(digits) };
        value.into().map_or(Value::Missing, number).into()
    }

    /// A number with its standard error.
    #[must_use]
    pub fn measured(value: f64, error: f64) -> Self {
        Value::Measured { value, error }.into()
    }

    /// The same cell in another tone.
    #[must_use]
    pub fn toned(self, tone: Tone) -> Self {
        Self { tone, ..self }
    }

    /// Figures in the place of a missing value.
    #[must_use]
    pub fn or_figures(self, figures: impl Into<String>) -> Self {
        match self.value {
            Value::Missing => Self::figures(figures).toned(self.tone),
            _ => self,
        }
    }
}

impl Value {
    /// Whether the value is a number, or stands where numbers stand.
    #[must_use]
    pub fn is_numeric(&self) -> bool {
        !matches!(self, Self::Missing | Self::Words(_))
    }

    /// The value as a number; not a number where it is none.
    #[must_use]
    pub fn number(&self) -> f64 {
        match self {
            Self::Whole(value) => *value as f64,
            Self::Number { value, .. } | Self::Measured { value, .. } => *value,
            Self::Missing | Self::Words(_) | Self::Figures(_) => f64::NAN,
        }
    }
}

impl From<Value> for Cell {
    fn from(value: Value) -> Self {
        Self { value, tone: Tone::Plain }
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        let digits = None;
        Value::Number { value, digits }.into()
    }
}

impl From<u64> for Cell {
    fn from(value: u64) -> Self {
        Value::Whole(value).into()
    }
}

impl From<u32> for Cell {
    fn from(value: u32) -> Self {
        u64::from(value).into()
    }
}

impl From<usize> for Cell {
    fn from(value: usize) -> Self {
        (value as u64).into()
    }
}

impl From<bool> for Cell {
    fn from(value: bool) -> Self {
        Self::words(value.to_string())
    }
}

impl From<&str> for Cell {
    fn from(words: &str) -> Self {
        Self::words(words)
    }
}

impl From<String> for Cell {
    fn from(words: String) -> Self {
        Self::words(words)
    }
}

impl From<&String> for Cell {
    fn from(words: &String) -> Self {
        Self::words(words)
    }
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or_else(Self::default, Into::into)
    }
}

impl Serialize for Cell {
    /// Words as a string, a number as a number, a missing value as null; the tone is for readers only.
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match &self.value {
            Value::Missing => to.serialize_none(),
            Value::Words(text) | Value::Figures(text) => to.serialize_str(text),
            Value::Whole(value) => to.serialize_u64(*value),
            Value::Number { value, .. } => to.serialize_f64(*value),
            Value::Measured { value, error } => {
                let mut both = to.serialize_struct("Measured", 2)?;
                both.serialize_field("value", value)?;
                both.serialize_field("standard_error", error)?;
                both.end()
            }
        }
    }
}
