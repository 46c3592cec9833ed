//! Printing that survives a reader who has gone (`lennard list integrators | head -1`).
//!
//! The standard macros panic where a line cannot be written. The macros here have the same names, remember the
//! first error and go on. A run whose output is piped into a program that ends early still comes to its end.
//! [`finish`] reports the error.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::sync::OnceLock;

use crate::failure::{Failure, OTHER};

static FIRST_ERROR: OnceLock<io::Error> = OnceLock::new();

/// A line on standard output.
macro_rules! println {
    () => { $crate::out::line(format_args!("")) };
    ($($text:tt)*) => { $crate::out::line(format_args!($($text)*)) };
}

/// A line on standard error.
macro_rules! eprintln {
    ($($text:tt)*) => { $crate::out::error_line(format_args!($($text)*)) };
}

/// Writes a line on standard output, or remembers why not.
pub fn line(text: Arguments<'_>) {
    keep(|to| writeln!(to, "{text}"));
}

/// Writes text as it is on standard output, or remembers why not.
pub fn text(text: &str) {
    keep(|to| to.write_all(text.as_bytes()));
}

fn keep(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) {
    if FIRST_ERROR.get().is_none()
        && let Err(error) = write(&mut io::stdout().lock())
    {
        let _ = FIRST_ERROR.set(error);
    }
}

/// Writes a line on standard error. Where no reader is left, the error is ignored.
pub fn error_line(text: Arguments<'_>) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Whether everything was printed. A reader who had enough is no failure; a full disk is.
pub fn finish() -> Result<(), Failure> {
    keep(|to| to.flush());
    match FIRST_ERROR.get() {
        Some(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::new("printing on standard output", error, OTHER))
        }
        _ => Ok(()),
    }
}
