//! A file of the book, and paths.

use std::path::{Component, Path, PathBuf};

/// A file of the book.
pub struct Page {
    /// Its path in the repository.
    pub source: String,
    /// Its path in the book.
    pub target: String,
}

impl Page {
    /// Whether it is text, and no figure.
    pub fn is_document(&self) -> bool {
        self.target.ends_with(".md")
    }

    /// Whether the settings of the book list it.
    pub fn is_in(&self, settings: &str) -> bool {
        settings.contains(&format!("= \"{}\"", self.target))
    }
}

/// A path without `.` and `..`.
pub fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir if plain.parent().is_some() => drop(plain.pop()),
            Component::CurDir => {}
            other => plain.push(other),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_listed_by_its_whole_path_and_paths_lose_their_dots() {
        let page = Page { source: "docs/a.md".into(), target: "a.md".into() };
        assert!(page.is_in("{ \"A\" = \"a.md\" }"));
        assert!(!page.is_in("{ \"A\" = \"b/a.md\" }"));
        assert_eq!(plain(Path::new("docs/../a/./b")), Path::new("a/b"));
    }
}
