//! The scenes of `inputs/bad.toml`.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use super::common::root;

/// `inputs/bad.toml`, whose head explains it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BadInputs {
    pub bases: BTreeMap<String, String>,
    files: BTreeMap<String, String>,
    /// Files that are no text, in hexadecimal digits.
    bytes: BTreeMap<String, String>,
    pub case: Vec<Case>,
}

/// One scene and the answer to it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    pub name: String,
    base: Option<String>,
    #[serde(default)]
    change: String,
    /// Values of `--set`.
    #[serde(default)]
    pub set: Vec<String>,
    scene: Option<String>,
    pub expected: String,
}

impl BadInputs {
    /// Reads the file.
    pub fn read() -> Self {
        toml::from_str(&std::fs::read_to_string(root().join("inputs/bad.toml")).unwrap()).unwrap()
    }

    /// The case of a name.
    pub fn case(&self, name: &str) -> &Case {
        self.case.iter().find(|case| case.name == name).unwrap()
    }

    /// The text of a case's scene.
    pub fn scene(&self, case: &Case) -> String {
        match (&case.scene, &case.base) {
            (Some(scene), None) => scene.clone(),
            (None, Some(base)) => changed(&self.bases[base], &case.change),
            _ => panic!("{} has either a base or a scene", case.name),
        }
    }

    /// Writes the files that scenes name.
    pub fn write_files(&self, folder: &Path) {
        for (name, text) in &self.files {
            std::fs::write(folder.join(name), text).unwrap();
        }
        for (name, digits) in &self.bytes {
            let pairs = (0..digits.len()).step_by(2).map(|at| &digits[at..at + 2]);
            let bytes: Vec<u8> = pairs.map(|pair| u8::from_str_radix(pair, 16).unwrap()).collect();
            std::fs::write(folder.join(name), bytes).unwrap();
        }
    }
}

/// A heading with its lines; the lines above all headings have an empty one.
type Section = (String, Vec<String>);

fn sections(text: &str) -> Vec<Section> {
    let mut found = vec![(String::new(), Vec::new())];
    for line in text.lines().filter(|line| !line.is_empty()) {
        match line.trim_start_matches('-').starts_with('[') {
            true => found.push((line.to_owned(), Vec::new())),
            false => found.last_mut().unwrap().1.push(line.to_owned()),
        }
    }
    found
}

/// The base with what a change says.
fn changed(base: &str, change: &str) -> String {
    let key = |line: &str| line.split(" =").next().unwrap().to_owned();
    let mut result = sections(base);
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    for (heading, lines) in sections(change) {
        let same = |heading: &str, nth: usize, sections: &[Section]| {
            let mut places = (0..sections.len()).filter(|at| sections[*at].0 == heading);
            places.nth(nth)
        };
        if let Some(gone) = heading.strip_prefix('-') {
            result.remove(same(gone, 0, &result).unwrap());
            continue;
        }
        let count = seen.entry(heading.clone()).or_default();
        let place = same(&heading, *count, &result);
        *count += 1;
        let Some(place) = place else {
            result.push((heading, lines));
            continue;
        };
        let there = &mut result[place].1;
        for line in lines {
            let name = key(line.strip_prefix('-').unwrap_or(&line));
            match there.iter().position(|l| key(l) == name) {
                Some(at) if line.starts_with('-') => drop(there.remove(at)),
                Some(at) => there[at] = line,
                None => there.push(line),
            }
        }
    }
    let block = |(heading, lines): &Section| {
        let lines = [heading].into_iter().chain(lines).filter(|line| !line.is_empty());
        lines.map(|line| line.clone() + "\n").collect::<String>()
    };
    let blocks: Vec<String> = result.iter().map(block).filter(|block| !block.is_empty()).collect();
    blocks.join("\n")
}
