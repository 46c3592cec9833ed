//! Texts of a user in messages and in scripts.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::fmt;
use std::path::Path;

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
