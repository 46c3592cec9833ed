//! Names of scenes, sweeps, stages, species and points.

use std::fmt;
use std::ops::Deref;
use std::path::Path;

use serde::Serialize;

/// The characters of a name beside letters and digits.
const MARKS: &str = "-_.";
/// The longest name: a folder of this name can have a number behind it.
const LONGEST: usize = 200;

/// A name that can stand in a path, a script and a table: letters, digits, `-`, `_` and `.`, beginning with a letter or digit.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(transparent)]
pub struct Name(String);

impl Name {
    /// What a name may be, for messages.
    pub const ALLOWED: &'static str =
        "at most 200 letters, digits, `-`, `_` and `.`, beginning with a letter or digit";

    /// The text as a name; `None` where it is none.
    #[must_use]
    pub fn new(text: impl Into<String>) -> Option<Self> {
        let text = text.into();
        let begins = text.starts_with(|c: char| c.is_ascii_alphanumeric());
        (begins && text.len() <= LONGEST && text.chars().all(is_allowed)).then_some(Self(text))
    }

    /// The name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The name of what a file holds: the name of the file without its ending.
    #[must_use]
    pub fn of_file(file: &Path) -> Self {
        let stem = file.file_stem().unwrap_or_default();
        Self::from(&*stem.to_string_lossy())
    }
}

/// A text of any kind as a name, with dashes for other characters.
impl From<&str> for Name {
    fn from(text: &str) -> Self {
        let plain = text.chars().map(|c| if is_allowed(c) { c } else { '-' });
        let begun = plain.skip_while(|c| !c.is_ascii_alphanumeric());
        let name: String = begun.take(LONGEST).collect();
        Self(match name.is_empty() {
            true => "scene".to_owned(),
            false => name,
        })
    }
}

fn is_allowed(c: char) -> bool {
    c.is_ascii_alphanumeric() || MARKS.contains(c)
}

impl Deref for Name {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

impl PartialEq<str> for Name {
    fn eq(&self, other: &str) -> bool {
        self.0 == other
    }
}

impl PartialEq<&str> for Name {
    fn eq(&self, other: &&str) -> bool {
        self.0 == *other
    }
}

impl AsRef<Path> for Name {
    fn as_ref(&self) -> &Path {
        Path::new(&self.0)
    }
}

impl fmt::Debug for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&self.0, f)
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_leaves_a_folder_or_a_line_is_no_name() {
        for good in ["gas", "rho0.85-T1.128", "7", "A_b", &"x".repeat(LONGEST)] {
            assert_eq!(Name::new(good).as_deref(), Some(good));
        }
        let long = "x".repeat(LONGEST + 1);
        let bad = [
            "", ".", "..", "../x", "/x", "a/b", "a\\b", "a b", "a\n", "$(a)", "'a'", ".a", "-a",
            "a\u{1b}", "ρ", &long,
        ];
        for bad in bad {
            assert_eq!(Name::new(bad), None, "{bad:?}");
        }
    }

    #[test]
    fn a_file_of_any_name_gives_a_name() {
        let of = |file: &str| Name::of_file(Path::new(file)).to_string();
        assert_eq!(of("runs/my gas.toml"), "my-gas");
        assert_eq!(of("../.x\n$(y).toml"), "x---y-");
        assert_eq!(of("..toml"), "scene");
        assert_eq!(of("ρ.toml"), "scene");
        assert_eq!(of(""), "scene");
    }
}
