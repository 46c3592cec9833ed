//! Options of methods: a key of a scene file is declared once, and everything else follows from it.
//!
//! [`options!`](crate::options!) declares a struct of options. From each of its fields come the key of the scene file, its default,
//! the check of its range and its row in the reference. [`choices!`](crate::choices!) declares an enum of names.

use crate::number::short;

/// The most steps that a scene may ask for: at 10⁴ steps per second, three thousand years.
pub const MOST_STEPS: i64 = 1_000_000_000_000_000;

/// The values that a key may hold.
#[derive(Debug, Clone, Copy)]
pub enum Allowed {
    /// A finite number above 0.
    Positive,
    /// A finite number, 0 or more.
    NotNegative,
    /// A number in this range, ends included.
    Between(f64, f64),
    /// A number in this range, ends included, and words on what serves beyond it.
    BetweenElse(f64, f64, &'static str),
    /// Zero, or a number in this range.
    ZeroOrBetween(f64, f64),
    /// A whole number in this range.
    Whole(i64, i64),
    /// `true` or `false`.
    Flag,
    /// One of these names.
    Names(fn() -> Vec<&'static str>),
    /// The values that the words describe.
    Words(&'static str),
}

impl Allowed {
    /// The allowed values in words, for messages and for the reference.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            Self::Positive => "a finite number above 0".to_owned(),
            Self::NotNegative => "a finite number, 0 or more".to_owned(),
            Self::Between(from, to) => format!("a number from {} to {}", short(*from), short(*to)),
            Self::BetweenElse(from, to, beyond) => {
                format!("{}; {beyond}", Self::Between(*from, *to).text())
            }
            Self::ZeroOrBetween(from, to) => {
                format!("0, or a number from {} to {}", short(*from), short(*to))
            }
            Self::Whole(from, i64::MAX) => format!("a whole number, {from} or more"),
            Self::Whole(from, to) => format!("a whole number from {from} to {to}"),
            Self::Flag => "true or false".to_owned(),
            Self::Names(names) => quoted(&names()),
            Self::Words(words) => (*words).to_owned(),
        }
    }

    /// Whether a number lies in the range. No key has a use for a negative number.
    #[must_use]
    pub fn admits(&self, x: f64) -> bool {
        match *self {
            Self::Positive => x.is_finite() && x > 0.0,
            Self::Between(from, to) | Self::BetweenElse(from, to, _) => (from..=to).contains(&x),
            Self::ZeroOrBetween(from, to) => x == 0.0 || (from..=to).contains(&x),
            Self::Whole(from, to) => (from as f64..=to as f64).contains(&x),
            Self::NotNegative | Self::Flag | Self::Names(_) | Self::Words(_) => {
                x.is_finite() && x >= 0.0
            }
        }
    }

    /// The smallest number of a range; `None` where the range has no end below.
    #[must_use]
    pub fn smallest(&self) -> Option<f64> {
        match *self {
            Self::Whole(from, _) => Some(from as f64),
            Self::Between(from, _)
            | Self::BetweenElse(from, _, _)
            | Self::ZeroOrBetween(from, _) => Some(from),
            _ => None,
        }
    }
}

/// An upper bound with four decimals, rounded down: what a user copies from a message is allowed. Meant for lengths in σ.
#[must_use]
pub fn upper_bound(largest: f64) -> String {
    ((largest * 1e4).floor() / 1e4).to_string()
}

/// Names in quotes, with commas between them.
#[must_use]
pub fn quoted(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    quoted.join(", ")
}

/// The declaration of one key of a scene file.
#[derive(Debug, Clone, Copy)]
pub struct KeySpec {
    /// The key.
    pub key: &'static str,
    /// The values that the key may hold.
    pub allowed: Allowed,
    /// The value of a key that the scene does not write, in words; a value stands in backticks.
    pub default: fn() -> String,
    /// The unit; empty for a plain number or a name.
    pub unit: &'static str,
    /// The meaning, in a sentence.
    pub meaning: &'static str,
}

/// The keys of a method without options.
pub type Keys = &'static [KeySpec];

/// A struct of options that [`options!`](crate::options!) declares.
pub trait Options: Default {
    /// The keys, in the order of the fields.
    const KEYS: Keys;

    /// Whether every option lies in its range.
    ///
    /// # Errors
    /// [`OptionError`] for the first option outside its range.
    fn check(&self) -> Result<(), OptionError>;
}

/// An option with an impossible value.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{key}` = {found} is not allowed: {allowed}")]
pub struct OptionError {
    /// The key inside the table of its method (`tau`).
    pub key: &'static str,
    /// The value found.
    pub found: String,
    /// The allowed values, in words.
    pub allowed: String,
}

impl OptionError {
    /// Refuses a value that lies outside its range.
    ///
    /// # Errors
    /// [`OptionError`] with the value found and the range.
    pub fn unless_allowed(
        key: &'static str,
        value: &impl OptionValue,
        allowed: Allowed,
    ) -> Result<(), Self> {
        match value.number() {
            Some(x) if !allowed.admits(x) => {
                Err(Self { key, found: value.written(), allowed: allowed.text() })
            }
            _ => Ok(()),
        }
    }
}

/// A value that a key may hold.
pub trait OptionValue {
    /// The value as a scene file writes it: `12`, `1e-12`, `"double"`.
    fn written(&self) -> String;
    /// The value as a number; `None` for a value without a range.
    fn number(&self) -> Option<f64> {
        None
    }
}

/// The values that TOML writes as Rust prints them.
macro_rules! plain_values {
    ($($type:ty: $number:expr;)*) => {$(
        impl OptionValue for $type {
            fn written(&self) -> String {
                format!("{self:?}")
            }
            fn number(&self) -> Option<f64> {
                $number(self)
            }
        }
    )*};
}

plain_values! {
    f64: |x: &f64| Some(*x);
    u32: |x: &u32| Some(f64::from(*x));
    u64: |x: &u64| Some(*x as f64);
    usize: |x: &usize| Some(*x as f64);
    bool: |_| None;
    String: |_| None;
    Vec<f64>: |_| None;
    Vec<[u32; 2]>: |_| None;
    Vec<[f64; 3]>: |_| None;
}

impl<T: OptionValue> OptionValue for Option<T> {
    fn written(&self) -> String {
        self.as_ref().map_or_else(|| "none".to_owned(), OptionValue::written)
    }
    fn number(&self) -> Option<f64> {
        self.as_ref()?.number()
    }
}

/// Declares a struct of options with its keys.
///
/// A field is `key: type = default, allowed, in "unit";`. Its doc comment is the meaning of the key. A key without a default
/// value is an `Option` that says in words what holds instead: `key: Option<f64> = None, else "0.8·`r_cut`", …`. Behind a default value,
/// `as "…"` gives other words for it. Words between key and colon say how serde writes the value: `as "box"` gives the key another
/// name, `with "module"` names a module, and `skip "function"` says where no value is written.
///
/// ```
/// use lennard_core::options::Options;
///
/// lennard_core::options! {
///     /// Options of a bath.
///     pub struct Bath {
///         /// Relaxation time.
///         tau: f64 = 0.5, Positive, in "τ";
///     }
/// }
/// assert_eq!(Bath::KEYS[0].meaning, "Relaxation time.");
/// assert_eq!((Bath::KEYS[0].default)(), "`0.5`");
/// assert!(Bath { tau: -1.0 }.check().is_err());
/// ```
#[macro_export]
macro_rules! options {
    (
        $(#[$about:meta])*
        $vis:vis struct $name:ident {
            $(
                $(#[doc = $meaning:expr])+
                $key:ident $(as $rename:literal)? $(with $with:literal)? $(skip $skip:literal)?: $type:ty = $default:expr
                    $(, else $words:literal)? $(, as $usual:literal)?, $allowed:expr $(, in $unit:literal)?;
            )*
        }
    ) => {
        $(#[$about])*
        #[derive(Debug, Clone, PartialEq, ::serde::Serialize, ::serde::Deserialize)]
        #[serde(deny_unknown_fields, default)]
        $vis struct $name {
            $(
                $(#[doc = $meaning])+
                $(#[serde(rename = $rename)])?
                $(#[serde(with = $with)])?
                $(#[serde(skip_serializing_if = $skip)])?
                $(#[doc = concat!("\n\nBy default: ", $words, ".")] #[serde(skip_serializing_if = "Option::is_none")])?
                pub $key: $type,
            )*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($key: $default,)* }
            }
        }

        impl $crate::options::Options for $name {
            const KEYS: $crate::options::Keys = {
                #[allow(unused_imports)]
                use $crate::options::{Allowed::*, OptionValue};
                &[$($crate::options::KeySpec {
                    key: $crate::options!(@or stringify!($key) $(, $rename)?),
                    allowed: $allowed,
                    default: || $crate::options!(
                        @or format!("`{}`", OptionValue::written(&Self::default().$key))
                            $(, $words.to_owned())? $(, $usual.to_owned())?
                    ),
                    unit: $crate::options!(@or "" $(, $unit)?),
                    meaning: concat!($($meaning),+).trim_ascii(),
                },)*]
            };

            fn check(&self) -> Result<(), $crate::options::OptionError> {
                #[allow(unused_imports)]
                use $crate::options::Allowed::*;
                $($crate::options::OptionError::unless_allowed(
                    $crate::options!(@or stringify!($key) $(, $rename)?),
                    &self.$key,
                    $allowed,
                )?;)*
                Ok(())
            }
        }
    };
    (@or $usual:expr) => { $usual };
    (@or $usual:expr, $instead:expr) => { $instead };
}

/// Declares an enum of names, each of which a scene file may write: `Variant = "name"`.
#[macro_export]
macro_rules! choices {
    (
        $(#[$about:meta])*
        $vis:vis enum $name:ident {
            $($(#[$doc:meta])* $variant:ident = $text:literal,)+
        }
    ) => {
        $(#[$about])*
        #[derive(
            Clone, Copy, Debug, Default, PartialEq, Eq, Hash, ::serde::Serialize, ::serde::Deserialize,
        )]
        $vis enum $name {
            $($(#[$doc])* #[serde(rename = $text)] $variant,)+
        }

        impl $name {
            /// The names of all choices.
            #[must_use]
            pub fn names() -> Vec<&'static str> {
                vec![$($text),+]
            }

            /// The name in scene files.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $text,)+
                }
            }
        }

        impl $crate::options::OptionValue for $name {
            fn written(&self) -> String {
                format!("\"{}\"", self.name())
            }
        }
    };
}

/// Makes the enum of a list from lines `Variant: module::Options,`. Each variant holds the options of its method, which implement the
/// trait of the list, and a constant of the module declares the method. The enum serves as the trait object of the chosen method.
#[macro_export]
macro_rules! list_of_methods {
    (
        $(#[$about:meta])*
        pub enum $list:ident: $trait:ident, declared by $constant:ident: $spec:ident {
            $($(#[$doc:meta])* $variant:ident: $module:ident::$options:ident,)*
        }
    ) => {
        #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
        $(#[$about])*
        pub enum $list {
            $($(#[$doc])* $variant($module::$options),)*
        }

        impl std::ops::Deref for $list {
            type Target = dyn $trait;

            fn deref(&self) -> &Self::Target {
                match self {
                    $(Self::$variant(options) => options,)*
                }
            }
        }

        impl $list {
            /// What each method declares about itself, in the order of the list.
            pub const SPECS: &'static [$spec] = &[$($module::$constant,)*];

            /// What the chosen method declares about itself, at its default options.
            #[must_use]
            pub fn spec(&self) -> &'static $spec {
                match self {
                    $(Self::$variant(_) => &$module::$constant,)*
                }
            }

            /// The name in scene files.
            #[must_use]
            pub fn name(&self) -> &'static str {
                self.spec().name
            }

            /// Every method with its default options, in the order of the list.
            #[must_use]
            pub fn all() -> Vec<Self> {
                vec![$(Self::$variant(Default::default()),)*]
            }

            /// The scene keys of every method, by its name.
            #[must_use]
            pub fn keys() -> Vec<(&'static str, $crate::options::Keys)> {
                use $crate::options::Options;
                vec![$(($module::$constant.name, <$module::$options as Options>::KEYS),)*]
            }

            /// Whether every option has a possible value, and all of them go together.
            ///
            /// # Errors
            /// [`$crate::options::OptionError`], which names the key, what was found and what is allowed.
            pub fn check(&self) -> Result<(), $crate::options::OptionError> {
                use $crate::options::Options;
                match self {
                    $(Self::$variant(options) => Options::check(options)?,)*
                }
                self.check_together()
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_upper_bound_is_short_and_allowed_itself() {
        assert_eq!(upper_bound(3.3591923827650145), "3.3591");
        assert_eq!(upper_bound(2.5), "2.5");
        assert_eq!(upper_bound(5.0), "5");
    }
}
