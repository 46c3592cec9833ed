//! Names in commands that a message shows.

use std::path::Path;

/// A word as a shell reads it: in quotes where it has more than plain letters.
#[must_use]
pub fn in_shell(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

/// A path as a shell reads it, in a command that can be typed.
#[must_use]
pub fn path_in_shell(path: &Path) -> String {
    in_shell(&path.to_string_lossy())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_names_with_more_than_plain_letters_are_quoted() {
        assert_eq!(path_in_shell(Path::new("runs/ρ=0.8-1")), "runs/ρ=0.8-1");
        assert_eq!(in_shell("my fluid.toml"), "'my fluid.toml'");
        assert_eq!(in_shell("Peter's"), r"'Peter'\''s'");
        assert_eq!(in_shell("{a=1}"), "'{a=1}'");
        assert_eq!(in_shell(""), "''");
    }
}
