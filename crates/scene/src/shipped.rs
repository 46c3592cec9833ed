//! The scenes that come with the program: it finds them by name where no file has that name.

use std::io;
use std::path::{Component, Path, PathBuf};

use crate::names::nearest;

/// What the path of a shipped scene begins with: `shipped:/fluid/gas.toml`.
const MARK: &str = "shipped:/";

/// A scene of `inputs/` inside the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shipped {
    /// Folder and name without `.toml`, such as `fluid/gas`.
    pub name: &'static str,
    /// The whole file.
    pub text: &'static str,
}

static SCENES: &[Shipped] = include!(concat!(env!("OUT_DIR"), "/shipped.rs"));

/// Every shipped scene, by name.
#[must_use]
pub fn scenes() -> &'static [Shipped] {
    SCENES
}

impl Shipped {
    /// The path that stands for it in messages, and that [`locate`] takes back.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        PathBuf::from(format!("{MARK}{}.toml", self.name))
    }

    /// The first sentence of the file: what the scene shows.
    #[must_use]
    pub fn subject(&self) -> String {
        let head = self.text.lines().take_while(|line| line.starts_with('#'));
        let prose: Vec<&str> = head
            .map(|line| line.trim_start_matches('#').trim())
            .skip_while(|line| line.is_empty() || line.starts_with(':'))
            .take_while(|line| !line.is_empty())
            .collect();
        let prose = prose.join(" ");
        // A point before a small letter or a number shortens a word.
        let goes_on = |c: char| c.is_lowercase() || c.is_ascii_digit();
        let mut points = prose.match_indices(". ");
        let end = points.find(|(at, _)| !prose[at + 2..].starts_with(goes_on));
        let end = end.map_or(prose.len(), |(at, _)| at + 1);
        prose[..end].to_owned()
    }

    /// Whether the file is a study, which names its scene as `base`.
    #[must_use]
    pub fn is_study(&self) -> bool {
        is_text_of_study(self.text)
    }

    /// The command that runs the file: `run`, or for a study `sweep`, or the command of its reading.
    #[must_use]
    pub fn command(&self) -> &'static str {
        let reads = |line: &str| self.text.lines().any(|own| own == line);
        match self.is_study() {
            false => "run",
            true if reads("reading = \"chart\"") => "chart",
            true if reads("reading = \"stability\"") => "study stability",
            true if reads("reading = \"mechanics\"") => "study mechanics",
            true => "sweep",
        }
    }
}

/// The file or the shipped scene that a written path means. A file of this name comes first, then a file with `.toml` behind
/// it, then a shipped scene. A path that means none of them comes back as it is.
#[must_use]
pub fn locate(written: &Path) -> PathBuf {
    if written.is_file() {
        return written.to_owned();
    }
    let mut with_ending = written.as_os_str().to_owned();
    with_ending.push(".toml");
    let with_ending = PathBuf::from(with_ending);
    if with_ending.is_file() {
        return with_ending;
    }
    find(written).map_or_else(|| written.to_owned(), |scene| scene.path())
}

/// The shipped scene that a name means: `fluid/gas`, `inputs/fluid/gas.toml`, or `gas` where one scene alone has that name.
#[must_use]
pub fn find(written: &Path) -> Option<&'static Shipped> {
    match meant(written)[..] {
        [one] => Some(one),
        _ => None,
    }
}

/// The shipped scenes that a name fits.
fn meant(written: &Path) -> Vec<&'static Shipped> {
    let name = plain_name(written);
    let whole = SCENES.iter().find(|scene| scene.name == name);
    let last = |scene: &&Shipped| scene.name.rsplit('/').next() == Some(name.as_str());
    match whole {
        Some(scene) => vec![scene],
        None => SCENES.iter().filter(last).collect(),
    }
}

/// The name that a path has among the shipped scenes, without what stands around it.
fn plain_name(written: &Path) -> String {
    let mut parts: Vec<String> = Vec::new();
    for part in written.components() {
        match part {
            Component::ParentDir if !parts.is_empty() => drop(parts.pop()),
            Component::CurDir => {}
            other => parts.push(other.as_os_str().to_string_lossy().into_owned()),
        }
    }
    let name = parts.join("/");
    let name = name.strip_prefix(MARK).unwrap_or(&name);
    let name = name.strip_prefix("inputs/").unwrap_or(name);
    name.strip_suffix(".toml").unwrap_or(name).to_owned()
}

/// Whether a path stands for a shipped scene.
#[must_use]
pub fn is_shipped(path: &Path) -> bool {
    path.to_string_lossy().starts_with(MARK)
}

/// The bytes of a file, or of the shipped scene that the path stands for.
///
/// # Errors
/// As [`std::fs::read`] has it.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    match is_shipped(path).then(|| find(path)).flatten() {
        Some(scene) => Ok(scene.text.as_bytes().to_vec()),
        None => std::fs::read(path),
    }
}

/// Whether a file is a study, which names its scene as `base`; a file that cannot be read is none.
#[must_use]
pub fn is_study(path: &Path) -> bool {
    read(path).is_ok_and(|text| is_text_of_study(&String::from_utf8_lossy(&text)))
}

fn is_text_of_study(text: &str) -> bool {
    text.parse::<toml::Table>().is_ok_and(|table| table.contains_key("base"))
}

/// The file beside `file` that is written in it, or the shipped scene of this name where there is no such file.
#[must_use]
pub fn beside(file: &Path, written: &Path) -> PathBuf {
    let joined = file.parent().unwrap_or(Path::new("")).join(written);
    if is_shipped(file) {
        return find(&joined).map_or(joined, |scene| scene.path());
    }
    let located = locate(&joined);
    if located.is_file() {
        return located;
    }
    find(written).map_or(joined, |scene| scene.path())
}

/// What may be meant by a path that is neither a file nor a shipped scene.
#[must_use]
pub fn suggestion(written: &Path) -> Option<String> {
    let several = meant(written);
    if several.len() > 1 {
        let names: Vec<&str> = several.iter().map(|scene| scene.name).collect();
        return Some(names.join(" or "));
    }
    let name = plain_name(written);
    let whole = nearest(&name, SCENES.iter().map(|scene| scene.name));
    let last_of = |scene: &Shipped| scene.name.rsplit('/').next().unwrap_or(scene.name);
    let by_last = || {
        let last = nearest(&name, SCENES.iter().map(last_of))?;
        let named = SCENES.iter().filter(|scene| last_of(scene) == last);
        Some(named.map(|scene| scene.name).collect::<Vec<_>>().join(" or "))
    };
    if name.contains('/') { whole } else { by_last().or(whole) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(written: &str) -> Option<&'static str> {
        find(Path::new(written)).map(|scene| scene.name)
    }

    #[test]
    fn a_shortened_word_does_not_end_the_subject() {
        let scene = find(Path::new("fluid/truncated-shifted")).unwrap();
        let subject = scene.subject();
        assert!(
            subject.ends_with("(Thol et al. 2015): no tail correction belongs to it."),
            "{subject}"
        );
    }

    #[test]
    fn a_scene_is_found_by_its_whole_name_and_by_its_last_where_that_is_its_own() {
        for written in [
            "fluid/gas",
            "fluid/gas.toml",
            "inputs/fluid/gas.toml",
            "./inputs/fluid/gas.toml",
            "shipped:/fluid/gas.toml",
            "shipped:/sweep/../fluid/gas.toml",
        ] {
            assert_eq!(named(written), Some("fluid/gas"), "{written}");
        }
        assert_eq!(named("triple-point"), Some("verlet-1967/triple-point"));
        assert_eq!(named("gas"), None, "a gas is in `fluid` and in `npt`");
        assert_eq!(named("bad"), None);
        assert_eq!(suggestion(Path::new("gass")).as_deref(), Some("fluid/gas or npt/gas"));
        assert_eq!(suggestion(Path::new("wombat")), None);
    }

    #[test]
    fn a_file_wins_over_a_shipped_scene_of_the_same_name() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("triple-point.toml");
        std::fs::write(&file, "mine").unwrap();
        assert_eq!(locate(&file), file);
        assert_eq!(locate(&file.with_extension("")), file);
        assert_eq!(read(&locate(&file)).unwrap(), b"mine");
        let elsewhere = Path::new("triple-point");
        assert_eq!(locate(elsewhere), Path::new("shipped:/verlet-1967/triple-point.toml"));
        assert_eq!(beside(&file, Path::new("triple-point.toml")), file);
        assert_eq!(
            beside(&file, Path::new("verlet-1967/state-point")),
            Path::new("shipped:/verlet-1967/state-point.toml")
        );
    }

    #[test]
    fn every_shipped_scene_says_what_it_shows() {
        assert!(SCENES.len() > 30, "{}", SCENES.len());
        for scene in SCENES {
            let subject = scene.subject();
            assert!(subject.len() > 20, "{}: {subject:?}", scene.name);
        }
    }
}
