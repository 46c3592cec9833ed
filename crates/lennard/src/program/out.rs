//! Printing that survives a reader who has gone (`lennard list integrators | head -1`).
//!
//! The standard macros panic where a line cannot be written. The macros here have the same names, remember the
//! first error and go on. A run whose output is piped into a program that ends early still comes to its end.
//! [`finish`] reports the error.
//!
//! What a user wrote may be in any line. A character that steers a terminal is shown and not sent ([`shown`]). Bold type is
//! added behind that.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::sync::OnceLock;

use lennard_io::shown;

use crate::program::failure::{Failure, OTHER};

static FIRST_ERROR: OnceLock<io::Error> = OnceLock::new();

/// A line on standard output.
macro_rules! println {
    () => { $crate::program::out::line(format_args!("")) };
    ($($text:tt)*) => { $crate::program::out::line(format_args!($($text)*)) };
}

/// A line on standard error.
macro_rules! eprintln {
    ($($text:tt)*) => { $crate::program::out::error_line(format_args!($($text)*)) };
}

/// The lines of a text without characters that steer a terminal.
fn plain(text: impl std::fmt::Display) -> String {
    let text = text.to_string();
    let lines = text.split('\n').map(|line| shown(line).to_string());
    lines.collect::<Vec<_>>().join("\n")
}

/// Writes a line on standard output, or remembers why not.
pub fn line(text: Arguments<'_>) {
    let text = plain(text);
    keep(|to| writeln!(to, "{text}"));
}

/// Writes a line in bold type on standard output, or remembers why not.
pub fn heading(text: impl std::fmt::Display) {
    let text = console::style(plain(text)).bold();
    keep(|to| writeln!(to, "{text}"));
}

/// Writes text as it is on standard output, or remembers why not: documents for other programs.
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

/// Writes a JSON document on standard output, or remembers why not. Its texts have `\u001b` for what steers a terminal.
pub fn json(document: &str) {
    let mut line = String::with_capacity(document.len() + 1);
    for c in document.chars() {
        if c == '\n' || "\\\"'".contains(c) || c.escape_debug().len() == 1 {
            line.push(c);
        } else {
            for unit in c.encode_utf16(&mut [0; 2]) {
                line += &format!("\\u{unit:04x}");
            }
        }
    }
    text(&(line + "\n"));
}

/// Writes a line on standard error. Where no reader is left, the error is ignored.
pub fn error_line(text: Arguments<'_>) {
    let _ = writeln!(io::stderr().lock(), "{}", plain(text));
}

/// Writes why a command failed on standard error.
pub fn failed(message: &str) {
    let error = console::style("error:").for_stderr().red().bold();
    let _ = writeln!(io::stderr().lock(), "{error} {}", plain(message));
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
