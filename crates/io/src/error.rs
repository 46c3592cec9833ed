//! Why a file cannot be read or written.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Longest piece of a file that a message repeats, in characters.
const LONGEST_EXCERPT: usize = 60;

/// Why a file cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The operating system refused.
    #[error("{}: cannot be read: {source}", file.display())]
    Io {
        /// The file.
        file: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// The content is not what the format asks for.
    #[error("{}:{line}: found {found}; allowed: {allowed}", file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// Line, counted from 1.
        line: u64,
        /// What stands there.
        found: String,
        /// What may stand there.
        allowed: String,
    },
    /// A frame of a trajectory is not what the frames before it, or its format, ask for.
    #[error("{}: frame {frame}: found {found}; allowed: {allowed}", file.display())]
    Frame {
        /// The file.
        file: PathBuf,
        /// Frame, counted from 1.
        frame: u64,
        /// What it holds.
        found: String,
        /// What it may hold.
        allowed: String,
    },
}

impl FormatError {
    pub(crate) fn io(file: &Path, source: io::Error) -> Self {
        Self::Io { file: file.to_path_buf(), source }
    }

    pub(crate) fn content(file: &Path, line: u64, found: &str, allowed: &str) -> Self {
        let (file, found, allowed) = (file.to_owned(), found.to_owned(), allowed.to_owned());
        Self::Content { file, line, found, allowed }
    }

    /// The file that cannot be read.
    #[must_use]
    pub fn file(&self) -> &Path {
        match self {
            Self::Io { file, .. } | Self::Content { file, .. } | Self::Frame { file, .. } => file,
        }
    }

    /// The line at fault, counted from 1, where the content is at fault.
    #[must_use]
    pub fn line(&self) -> Option<u64> {
        match self {
            Self::Io { .. } | Self::Frame { .. } => None,
            Self::Content { line, .. } => Some(*line),
        }
    }
}

/// What is wrong with a piece of a file: what was found, and what is allowed.
pub(crate) type Refusal = (String, String);

/// Refuses a piece of a file.
pub(crate) fn refused<T>(
    found: impl Into<String>,
    allowed: impl Into<String>,
) -> Result<T, Refusal> {
    Err((found.into(), allowed.into()))
}

/// A piece of a file as it may be shown in a message: short, printable, in quotes.
pub(crate) fn excerpt(bytes: &[u8]) -> String {
    // Four bytes a character at most, so that a long line is not converted whole.
    let head = &bytes[..bytes.len().min(4 * LONGEST_EXCERPT)];
    let text = String::from_utf8_lossy(head);
    let mut shown: String = text.chars().take(LONGEST_EXCERPT).collect();
    if shown.len() < text.len() || head.len() < bytes.len() {
        shown.push('…');
    }
    format!("`{}`", shown.escape_debug())
}

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The operating system refused; what was whole before is still whole.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was tried (`write`, `sync`).
        action: &'static str,
        /// The cause.
        source: io::Error,
    },
    /// Another rank could not give its part of a file.
    #[error("{}: another rank has numbers that cannot be written", path.display())]
    Elsewhere {
        /// The file.
        path: PathBuf,
    },
    /// A write failed and what it left half-written could not be removed either.
    #[error(
        "{}: cannot write: {source}; and cannot cut the file back to its {whole} whole bytes: {cut_back}",
        path.display()
    )]
    NotCutBack {
        /// The file.
        path: PathBuf,
        /// Bytes from the start of the file that are whole.
        whole: u64,
        /// Why writing failed.
        source: io::Error,
        /// Why cutting back failed.
        cut_back: io::Error,
    },
    /// The file was removed or replaced by another while it was being written.
    #[error("{}: the file was removed or replaced while the run was writing it", path.display())]
    Vanished {
        /// The file.
        path: PathBuf,
    },
    /// An earlier write to this file failed in a way that cannot be mended.
    #[error("{}: not written, since an earlier write to it failed", path.display())]
    GivenUp {
        /// The file.
        path: PathBuf,
    },
    /// A file to go on with is shorter than what the checkpoint says was written, or was changed.
    #[error(
        "{}: cannot go on after byte {wanted}: {reason}", path.display()
    )]
    NotResumable {
        /// The file.
        path: PathBuf,
        /// Where writing should go on.
        wanted: u64,
        /// What is wrong.
        reason: String,
    },
    /// A number that is not finite, or a position more than 2³¹ boxes away: it is never written.
    #[error("{}: {quantity} of particle {particle} is {value}: such a number is not written", path.display())]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// `position`, `velocity` or `force`.
        quantity: &'static str,
        /// The particle, counted from 0.
        particle: usize,
        /// What was found.
        value: f64,
    },
    /// What should be written cannot stand in this format.
    #[error("{}: {what}: found {found}; allowed: {allowed}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// Which part.
        what: &'static str,
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
}

impl WriteError {
    pub(crate) fn io(path: &Path, action: &'static str, source: io::Error) -> Self {
        Self::Io { path: path.to_path_buf(), action, source }
    }

    /// The file that cannot be written.
    #[must_use]
    pub fn path(&self) -> &Path {
        match self {
            Self::Io { path, .. }
            | Self::NotCutBack { path, .. }
            | Self::Vanished { path }
            | Self::GivenUp { path }
            | Self::Elsewhere { path }
            | Self::NotResumable { path, .. }
            | Self::NotFinite { path, .. }
            | Self::Unwritable { path, .. } => path,
        }
    }

    /// What a user can do about it.
    #[must_use]
    pub fn advice(&self) -> &'static str {
        match self {
            Self::Io { path, source, .. }
                if source.kind() == io::ErrorKind::NotFound
                    && path.parent().is_some_and(Path::is_dir) =>
            {
                "the file is gone: leave the output folder alone while the run goes on"
            }
            Self::Io { source, .. } | Self::NotCutBack { source, .. } => advice_for(source.kind()),
            Self::Vanished { .. } => "leave the output folder alone while the run goes on",
            Self::GivenUp { .. } => "mend the cause of the first error",
            Self::NotResumable { .. } => "put the output files back as the run left them",
            Self::NotFinite { .. } | Self::Elsewhere { .. } => {
                "the run has failed; start again with a smaller time step"
            }
            Self::Unwritable { .. } => "change the value named",
        }
    }
}

/// What a user can do about a cause that the operating system named.
pub(crate) fn advice_for(kind: io::ErrorKind) -> &'static str {
    match kind {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "free space on this disk or write to another one"
        }
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "give write permission for the folder or write to another one"
        }
        io::ErrorKind::NotFound => {
            "the folder is gone: leave it alone while the run goes on, or name one that exists"
        }
        io::ErrorKind::BrokenPipe => "whoever read the output has gone: write to a file instead",
        _ => "check the disk and the folder",
    }
}

/// A text of a user as a message shows it, made by [`shown`].
#[derive(Debug, Clone)]
pub struct Shown<'a>(Cow<'a, str>);

/// A name, key or path of a user in a message: on one line, and without characters that steer a terminal.
///
/// Line ends, escape sequences and signs that turn the direction of writing become `\n` and `\u{1b}`. Any other character stays.
#[must_use]
pub fn shown<T: AsRef<OsStr> + ?Sized>(text: &T) -> Shown<'_> {
    Shown(text.as_ref().to_string_lossy())
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const KEPT: [char; 3] = ['\\', '"', '\''];
        for piece in self.0.split_inclusive(KEPT) {
            let plain = piece.trim_end_matches(KEPT);
            write!(f, "{}{}", plain.escape_debug(), &piece[plain.len()..])?;
        }
        Ok(())
    }
}

/// A word as a shell reads it, on one line. It stands in quotes where it has more than plain letters. Bytes that no message shows
/// as they are become `\x1b` in the quotes `$'…'` of bash, ksh and zsh.
#[must_use]
pub fn in_shell<T: AsRef<OsStr> + ?Sized>(word: &T) -> String {
    let word = word.as_ref();
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,+".contains(c);
    match word.to_str() {
        Some(text) if !text.is_empty() && text.chars().all(plain) => text.to_owned(),
        Some(text) if shown(text).to_string() == text => {
            format!("'{}'", text.replace('\'', "'\\''"))
        }
        _ => {
            let escaped = word.as_encoded_bytes().iter().map(|byte| match byte {
                b' '..=b'~' if !b"\\'".contains(byte) => char::from(*byte).to_string(),
                _ => format!("\\x{byte:02x}"),
            });
            format!("$'{}'", escaped.collect::<String>())
        }
    }
}

/// A path as a shell reads it, in a command that can be typed. No program takes it for an option.
#[must_use]
pub fn path_in_shell(path: &Path) -> String {
    match path.as_os_str().as_encoded_bytes() {
        [b'-', ..] => in_shell(&Path::new(".").join(path)),
        _ => in_shell(path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn excerpts_are_short_printable_and_in_quotes() {
        assert_eq!(excerpt(b"abc\x1b[31m"), "`abc\\u{1b}[31m`");
        assert_eq!(excerpt(&[0xff, b'a']), "`\u{fffd}a`");
        let long = excerpt(&vec![b'x'; 1 << 20]);
        assert_eq!(long.chars().count(), LONGEST_EXCERPT + 3);
        assert!(long.ends_with("…`"));
    }

    #[test]
    fn a_full_disk_is_met_with_advice_to_free_space() {
        let error = WriteError::io(
            Path::new("t.xyz"),
            "write",
            io::Error::from(io::ErrorKind::StorageFull),
        );
        assert!(error.advice().contains("free space"));
        assert!(error.to_string().starts_with("t.xyz: cannot write: "));
    }

    #[test]
    fn only_names_with_more_than_plain_letters_are_quoted() {
        assert_eq!(path_in_shell(Path::new("runs/ρ=0.8-1")), "runs/ρ=0.8-1");
        assert_eq!(path_in_shell(Path::new("-x.toml")), "./-x.toml");
        assert_eq!(in_shell("my fluid.toml"), "'my fluid.toml'");
        assert_eq!(in_shell("Peter's"), r"'Peter'\''s'");
        assert_eq!(in_shell("{a=1}"), "'{a=1}'");
        assert_eq!(in_shell(""), "''");
        assert_eq!(in_shell("a\n{b}'\u{1b}"), r"$'a\x0a{b}\x27\x1b'");
    }

    #[test]
    fn what_steers_a_terminal_is_shown_and_not_done() {
        let shown = |text: &str| shown(text).to_string();
        assert_eq!(shown("\u{1b}[31m\u{9b}1m\r\n"), r"\u{1b}[31m\u{9b}1m\r\n");
        assert_eq!(shown("a\u{202e}b\u{7f}"), r"a\u{202e}b\u{7f}");
        assert_eq!(shown(r#"C:\x "ρ" 'T̄'"#), r#"C:\x "ρ" 'T̄'"#);
    }

    /// Proves with a real shell that a word stays one word, and that nothing in it is done.
    #[cfg(unix)]
    #[test]
    fn a_shell_reads_each_word_as_it_was() {
        use std::os::unix::ffi::{OsStrExt, OsStringExt};
        let hostile: [&[u8]; 9] = [
            b"a\nprintf x",
            b"$(printf x)`printf x`",
            b"it's \"quoted\" \\ ${HOME} $HOME !!",
            b"\xff\xfe\n'",
            b"; printf x # {} {#} {= print =}",
            b"\x1b[31m\t\r",
            "\u{202e}ρ é \u{9b}".as_bytes(),
            b"*?[a]~ <>|&",
            b"",
        ];
        for word in hostile {
            let quoted = in_shell(OsStr::from_bytes(word));
            assert!(!quoted.contains(char::is_control), "{quoted}");
            let output = std::process::Command::new("bash")
                .args(["-c", &format!("printf '%s.' {quoted}")])
                .output()
                .unwrap();
            let read = std::ffi::OsString::from_vec(output.stdout);
            assert_eq!(read.as_bytes(), [word, b"."].concat(), "{quoted}");
        }
    }
}
