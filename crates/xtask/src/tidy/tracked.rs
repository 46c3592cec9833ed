//! Files that are, or are about to be, tracked: nothing of one machine, nothing large.

use std::error::Error;
use std::path::Path;

use crate::workspace::Workspace;

/// Every clone carries a tracked file for ever, and a larger file has no readers.
const LARGEST_KIB: u64 = 512;

/// Beginnings of absolute paths that exist on one machine only. Split, so that this file does not
/// find itself.
const MACHINE_PATHS: [&str; 7] = [
    concat!("/ho", "me/"),
    concat!("/ro", "ot/"),
    concat!("/Us", "ers/"),
    concat!("/wo", "rk/"),
    concat!("/t", "mp/"),
    concat!("/m", "nt/"),
    concat!(":\\Us", "ers\\"),
];

/// Settings that tie a build to one package registry.
const REGISTRY_SETTINGS: [&str; 6] = [
    concat!("index", "-url"),
    concat!("trusted", "-host"),
    concat!("replace", "-with"),
    concat!("[sou", "rce."),
    concat!("[regis", "tries"),
    concat!("PIP_", "INDEX"),
];

/// The one source that Cargo.lock may name.
const CRATES_IO: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// A check and what it found.
pub type Finding = (&'static str, Vec<String>);

/// Checks every file that git tracks or would add.
pub fn findings(workspace: &Workspace) -> Result<[Finding; 3], Box<dyn Error>> {
    let (mut machine, mut registry, mut large) = (Vec::new(), Vec::new(), Vec::new());
    for name in &workspace.tracked(&[])? {
        let path = workspace.root.join(name);
        // Deleted but still tracked, or a link to a folder.
        if !path.is_file() {
            continue;
        }
        large.extend(too_large(name, path.metadata()?.len()));
        let content = std::fs::read(&path)?;
        let Ok(text) = String::from_utf8(content) else {
            continue;
        };
        machine.extend(machine_paths(name, &text));
        registry.extend(registries(name, &text));
    }
    Ok([
        ("no path of one machine", machine),
        ("no package registry of one machine", registry),
        ("no large file", large),
    ])
}

fn too_large(name: &str, bytes: u64) -> Option<String> {
    (bytes > LARGEST_KIB * 1024)
        .then(|| format!("{name} has {} KiB, more than {LARGEST_KIB}", bytes / 1024))
}

fn machine_paths(name: &str, text: &str) -> Vec<String> {
    let within_a_word = |c: char| c.is_alphanumeric() || "._-~/".contains(c);
    let mut faults = Vec::new();
    for (i, line) in text.lines().enumerate() {
        for pattern in MACHINE_PATHS {
            let begins =
                |at: usize| pattern.starts_with(':') || !line[..at].ends_with(within_a_word);
            if line.match_indices(pattern).any(|(at, _)| begins(at)) {
                faults.push(format!("{name}:{} has a path below {pattern}", i + 1));
            }
        }
    }
    faults
}

fn registries(name: &str, text: &str) -> Vec<String> {
    let lock = Path::new(name).file_name().is_some_and(|f| f == "Cargo.lock");
    let mut faults = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let told = REGISTRY_SETTINGS.iter().find(|s| line.contains(**s));
        if let Some(setting) = told {
            faults.push(format!("{name}:{} sets `{setting}`", i + 1));
        }
        if lock && line.starts_with("source = ") && !line.contains(CRATES_IO) {
            faults.push(format!("{name}:{}: {line} is not crates.io", i + 1));
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_of_one_machine_are_found_and_others_left_alone() {
        for home in ["home", "root", "Users", "work", "tmp"] {
            let text = format!("fine\nsee \"/{home}/someone/data\"\n");
            assert_eq!(machine_paths("a.md", &text).len(), 1, "{home}");
            assert!(machine_paths("a.md", &text)[0].starts_with("a.md:2 "));
        }
        let fine = "https://example.org/home/x, crates/work/src, ~/tmp/x, ../root/x";
        assert_eq!(machine_paths("a.md", fine), Vec::<String>::new());
    }

    #[test]
    fn registries_other_than_the_public_one_are_found() {
        let lock =
            format!("source = \"{CRATES_IO}\"\nsource = \"registry+https://mirror/index\"\n");
        assert_eq!(registries("Cargo.lock", &lock).len(), 1);
        let pip = format!("--extra-{} https://mirror\nnumpy==2.4.6\n", REGISTRY_SETTINGS[0]);
        assert_eq!(registries("validation/requirements.txt", &pip).len(), 1);
        assert!(registries("validation/requirements.txt", "numpy==2.4.6\n").is_empty());
    }

    #[test]
    fn large_files_are_found() {
        assert_eq!(too_large("a", LARGEST_KIB * 1024), None);
        assert!(too_large("a", LARGEST_KIB * 1024 + 1).is_some());
    }
}
