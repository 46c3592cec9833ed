//! The arguments of the programs here: words first, then `key=value`.

use std::error::Error;
use std::io;
use std::process::ExitCode;

use crate::{CASES, Case};

/// An argument that cannot be meant, and why.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct BadArgument(pub String);

/// What was given.
#[derive(Debug, Clone, Default)]
pub struct Arguments {
    words: Vec<String>,
    values: Vec<(String, String)>,
}

impl Arguments {
    /// Reads arguments, of which keys are among `keys`.
    ///
    /// # Errors
    /// [`BadArgument`] for any other key.
    pub fn read(
        arguments: impl Iterator<Item = String>,
        keys: &[&str],
    ) -> Result<Self, BadArgument> {
        let mut read = Self::default();
        for argument in arguments {
            match argument.split_once('=') {
                None => read.words.push(argument),
                Some((key, value)) if keys.contains(&key) => {
                    read.values.push((key.to_owned(), value.to_owned()));
                }
                Some((key, _)) => {
                    let keys = keys.join(", ");
                    return Err(BadArgument(format!("no key `{key}`; there are {keys}")));
                }
            }
        }
        Ok(read)
    }

    /// The `n`th word, from 0, where there is one.
    #[must_use]
    pub fn word(&self, n: usize) -> Option<&str> {
        self.words.get(n).map(String::as_str)
    }

    /// The case that the first word names.
    ///
    /// # Errors
    /// [`BadArgument`] where there is none.
    pub fn case(&self) -> Result<Case, BadArgument> {
        let name = self.words.first().map(String::as_str);
        let found = CASES.iter().find(|case| Some(case.name) == name);
        let cases = || BadArgument("the first word is a case: A, B or C".to_owned());
        found.copied().ok_or_else(cases)
    }

    /// The second word, a number of steps of at least `least`.
    ///
    /// # Errors
    /// [`BadArgument`] where it is none.
    pub fn steps(&self, default: usize, least: usize) -> Result<usize, BadArgument> {
        let steps = |word: &String| number("the second word", word, least);
        self.words.get(1).map_or(Ok(default), steps)
    }

    /// The value of a key, where it was given.
    #[must_use]
    pub fn value(&self, key: &str) -> Option<&str> {
        let found = self.values.iter().find(|(k, _)| k == key);
        found.map(|(_, value)| value.as_str())
    }

    /// The value of a key, a whole number of at least `least`.
    ///
    /// # Errors
    /// [`BadArgument`] where it is none.
    pub fn number(&self, key: &str, least: usize) -> Result<Option<usize>, BadArgument> {
        self.value(key).map(|value| number(&format!("`{key}`"), value, least)).transpose()
    }

    /// The value of a key, a length in σ above zero.
    ///
    /// # Errors
    /// [`BadArgument`] where it is none.
    pub fn length(&self, key: &str) -> Result<Option<f64>, BadArgument> {
        let length = |found: &str| {
            let length = found.parse().ok().filter(|l: &f64| l.is_finite() && *l > 0.0);
            length.ok_or_else(|| {
                BadArgument(format!("`{key}` = {found} is not allowed: a length in σ above 0"))
            })
        };
        self.value(key).map(length).transpose()
    }

    /// The value of a key, or the first of some: one of them.
    ///
    /// # Errors
    /// [`BadArgument`] where it is none.
    pub fn one_of<T: Copy>(&self, key: &str, all: &[(&str, T)]) -> Result<T, BadArgument> {
        let name = self.value(key).unwrap_or(all[0].0);
        let found = all.iter().find(|(n, _)| *n == name).map(|(_, value)| *value);
        found.ok_or_else(|| {
            let names: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
            let names = names.join(", ");
            BadArgument(format!("`{key}` = {name} is not allowed: one of {names}"))
        })
    }
}

fn number(what: &str, found: &str, least: usize) -> Result<usize, BadArgument> {
    let number = found.parse().ok().filter(|n| *n >= least);
    number.ok_or_else(|| {
        BadArgument(format!("{what} = {found} is not allowed: a whole number of at least {least}"))
    })
}

/// Tells what went wrong: 2 for arguments, 1 for anything else, and nothing where whoever read the output has gone.
#[allow(clippy::print_stderr)]
#[must_use]
pub fn exit_code(result: Result<(), Box<dyn Error>>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if has_no_reader(&*error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(if error.is::<BadArgument>() { 2 } else { 1 })
        }
    }
}

fn has_no_reader(error: &(dyn Error + 'static)) -> bool {
    let error = error.downcast_ref::<io::Error>();
    error.is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn output_without_a_reader_is_no_error() {
        let gone = io::Error::from(io::ErrorKind::BrokenPipe);
        assert!(has_no_reader(&gone));
        assert!(!has_no_reader(&io::Error::from(io::ErrorKind::StorageFull)));
        assert!(!has_no_reader(&BadArgument(String::new())));
    }

    fn read(line: &str) -> Result<Arguments, BadArgument> {
        let words = line.split_whitespace().map(str::to_owned);
        Arguments::read(words, &["threads", "precision", "skin"])
    }

    #[test]
    fn what_was_given_is_found_and_the_rest_has_defaults() {
        let given = read("B threads=2 60").unwrap();
        assert_eq!(given.case().unwrap().name, "B");
        assert_eq!(given.steps(200, 1), Ok(60));
        assert_eq!(given.number("threads", 1), Ok(Some(2)));
        assert_eq!(given.value("precision"), None);
        assert_eq!(given.length("skin"), Ok(None));
        assert_eq!(read("B skin=0.3").unwrap().length("skin"), Ok(Some(0.3)));
        let precisions = [("double", 8), ("mixed", 4)];
        assert_eq!(given.one_of("precision", &precisions), Ok(8));
        assert_eq!(read("A").unwrap().steps(200, 1), Ok(200));
    }

    #[test]
    fn what_cannot_be_meant_is_refused_by_name() {
        let message = |result: Result<usize, BadArgument>| result.unwrap_err().to_string();
        assert_eq!(
            read("A thread=2").unwrap_err().to_string(),
            "no key `thread`; there are threads, precision, skin"
        );
        for bad in ["two", "0", "-1", ""] {
            let given = read(&format!("A threads={bad}")).unwrap();
            assert_eq!(
                given.number("threads", 1).unwrap_err().to_string(),
                format!("`threads` = {bad} is not allowed: a whole number of at least 1")
            );
        }
        assert!(read("D").unwrap().case().is_err() && read("").unwrap().case().is_err());
        assert_eq!(
            message(read("A many").unwrap().steps(200, 250)),
            "the second word = many is not allowed: a whole number of at least 250"
        );
        for bad in ["thick", "0", "-0.2", "inf", "NaN"] {
            let given = read(&format!("A skin={bad}")).unwrap();
            assert_eq!(
                given.length("skin").unwrap_err().to_string(),
                format!("`skin` = {bad} is not allowed: a length in σ above 0")
            );
        }
        let given = read("A precision=triple").unwrap();
        assert_eq!(
            message(given.one_of("precision", &[("double", 1), ("mixed", 2)])),
            "`precision` = triple is not allowed: one of double, mixed"
        );
    }
}
