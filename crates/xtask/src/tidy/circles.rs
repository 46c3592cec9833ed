//! Files of a crate import each other in one direction: no file needs itself through others.
//!
//! An edge goes from a file to each module that its paths name: `crate::a::B`, `super::a::B`, `self::a::B`, and `a::B`
//! for a child module `a`. A path to a re-export leads to the module that defines the item. Re-exports and tests do not count.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::Path;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

use crate::workspace::Workspace;

/// Circles that stay: the crate, all files that may be in the circle (`folder/*` for every file in it), and the reason.
/// A circle with any other file is a fault.
const EXPLAINED: &[(&str, &[&str], &str)] = &[
    (
        "integrators",
        &["barostats", "barostats/*"],
        "a file of a barostat implements the trait of its list",
    ),
    ("integrators", &["bonds", "bonds/*"], "a way to hold bonds implements the trait of its list"),
    (
        "integrators",
        &["contacts/kinds", "contacts/kinds/*"],
        "a kind implements the trait of its list",
    ),
    (
        "forcefield",
        &["pair/combining", "pair/combining/*"],
        "a file of a combining rule implements the trait that the list dispatches to",
    ),
    (
        "forcefield",
        &["pair/potentials", "pair/potentials/*"],
        "a file of a potential implements the trait that the list dispatches to",
    ),
    (
        "forcefield",
        &["pair/truncations", "pair/truncations/*"],
        "a file of a truncation declares what the list dispatches to, and options hold a kind of the list",
    ),
    (
        "forcefield",
        &["pair/tabulated/file", "pair/tabulated/spline"],
        "the knots of a file make the spline, and the check of the file takes the error that the spline states",
    ),
    (
        "forcefield",
        &["walls", "walls/*"],
        "a file of a wall implements the trait that the list dispatches to",
    ),
    (
        "literature",
        &["model", "one_fluid", "virial"],
        "the list has the virial series, which stands beside the critical point of another entry",
    ),
    ("observables", &["rdf", "rdf/partial"], "its part for pairs of species"),
    (
        "observables",
        &["structure_factor", "structure_factor/partial", "wave_vectors"],
        "its part for pairs of species",
    ),
    ("observables", &["thermodynamics", "thermodynamics/species"], "its part for each species"),
    (
        "studies",
        &["bench", "bench/*"],
        "to be cut: pages and figures of the study read the study's types from the file that draws them",
    ),
    (
        "studies",
        &["chart", "chart/*"],
        "to be cut: pages and figures of the study read the study's types from the file that draws them",
    ),
];

/// A module as its path inside the crate; the crate itself has the empty path.
type Module = Vec<String>;

/// What the source of one module says about others.
#[derive(Debug, Default)]
struct Source {
    /// Absolute paths that the source names.
    paths: BTreeSet<Vec<String>>,
    /// Names that the source exports from elsewhere, with the absolute path of each; none for another crate.
    exports: BTreeMap<String, Option<Vec<String>>>,
}

/// Every circle of files in the folders below `crates` that is not explained.
pub fn faults(workspace: &Workspace) -> Result<Vec<String>, Box<dyn Error>> {
    let mut faults = Vec::new();
    let mut crates: Vec<_> = std::fs::read_dir(workspace.root.join("crates"))?
        .collect::<Result<Vec<_>, _>>()?
        .into_iter()
        .map(|entry| entry.path())
        .collect();
    crates.sort();
    for folder in crates {
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        let mut files = Vec::new();
        read_sources(&folder.join("src"), &mut Vec::new(), &mut files)?;
        for circle in circles(&files)? {
            let files: Vec<String> = circle.iter().map(|m| m.join("/")).collect();
            if !is_explained(&name, &files) {
                faults.push(format!("{name}: these files need each other: {}", files.join(", ")));
            }
        }
    }
    Ok(faults)
}

/// Whether every file of a circle is in one of the sets that are explained.
fn is_explained(name: &str, files: &[String]) -> bool {
    let is_in = |file: &String, allowed: &&str| match allowed.strip_suffix('*') {
        Some(folder) => file.strip_prefix(folder).is_some_and(|rest| !rest.contains('/')),
        None => file == allowed,
    };
    let takes = |allowed: &[&str]| files.iter().all(|f| allowed.iter().any(|a| is_in(f, a)));
    EXPLAINED.iter().any(|(of, allowed, _)| *of == name && takes(allowed))
}

/// Collects the sources of a folder, which is the module `module`, without tests.
fn read_sources(
    folder: &Path,
    module: &mut Module,
    to: &mut Vec<(Module, String)>,
) -> Result<(), Box<dyn Error>> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        if stem == "tests" || stem == "bin" {
            continue;
        }
        if path.is_dir() {
            module.push(stem.into_owned());
            read_sources(&path, module, to)?;
            module.pop();
        } else if path.extension().is_some_and(|e| e == "rs") {
            let mut own = module.clone();
            if !matches!(&*stem, "mod" | "lib" | "main") {
                own.push(stem.into_owned());
            }
            to.push((own, std::fs::read_to_string(&path)?));
        }
    }
    Ok(())
}

/// The groups of modules that need each other, each in ascending order.
fn circles(files: &[(Module, String)]) -> Result<Vec<Vec<Module>>, Box<dyn Error>> {
    let modules: BTreeSet<Module> = files.iter().map(|(module, _)| module.clone()).collect();
    let mut sources: BTreeMap<Module, Source> = BTreeMap::new();
    for (module, text) in files {
        let stream: TokenStream = text.parse().map_err(|e| format!("{}: {e}", module.join("/")))?;
        let reader = Reader { modules: &modules, file: module };
        reader.read(stream, module, sources.entry(module.clone()).or_default());
    }
    let needs: BTreeMap<&Module, BTreeSet<Module>> = sources
        .iter()
        .map(|(module, source)| {
            let needed = source.paths.iter().filter_map(|path| defining(path, &sources));
            (module, needed.filter(|needed| needed != module).collect())
        })
        .collect();
    let reachable: BTreeMap<&Module, BTreeSet<Module>> =
        needs.keys().map(|module| (*module, reach(module, &needs))).collect();
    let mut circles = BTreeSet::new();
    for (module, reached) in &reachable {
        let circle: Vec<Module> =
            reached.iter().filter(|other| reachable[other].contains(*module)).cloned().collect();
        if circle.len() > 1 {
            circles.insert(circle);
        }
    }
    Ok(circles.into_iter().collect())
}

/// All modules that a module needs, directly or through others.
fn reach(from: &Module, needs: &BTreeMap<&Module, BTreeSet<Module>>) -> BTreeSet<Module> {
    let mut reached = BTreeSet::new();
    let mut open = vec![from];
    while let Some(module) = open.pop() {
        for needed in &needs[module] {
            if reached.insert(needed.clone()) {
                open.push(needed);
            }
        }
    }
    reached
}

/// The module that defines the item at an absolute path; none for an item of another crate.
fn defining(path: &[String], sources: &BTreeMap<Module, Source>) -> Option<Module> {
    let mut path = path.to_vec();
    // Each re-export leads to another module; the limit ends a circle of re-exports.
    for _ in 0..10 {
        let own = module_of(&path, sources.keys());
        let Some(item) = path.get(own.len()) else {
            return Some(own);
        };
        match sources[&own].exports.get(item) {
            Some(None) => return None,
            Some(Some(exported)) if *exported != path => path = exported.clone(),
            _ => return Some(own),
        }
    }
    Some(module_of(&path, sources.keys()))
}

/// The longest module that a path begins with.
fn module_of<'a>(path: &[String], modules: impl Iterator<Item = &'a Module>) -> Module {
    modules
        .filter(|module| path.starts_with(module))
        .max_by_key(|module| module.len())
        .cloned()
        .unwrap_or_default()
}

/// Reads the tokens of a file.
struct Reader<'a> {
    modules: &'a BTreeSet<Module>,
    file: &'a Module,
}

impl Reader<'_> {
    /// Adds what the tokens of a module say; `module` is the file or a module inside it.
    fn read(&self, stream: TokenStream, module: &[String], to: &mut Source) {
        let tokens: Vec<TokenTree> = stream.into_iter().collect();
        let mut at = 0;
        let (mut is_test, mut is_public) = (false, false);
        while at < tokens.len() {
            match &tokens[at] {
                TokenTree::Group(group) => {
                    let attribute = is_punct(tokens.get(at.wrapping_sub(1)), '#');
                    if attribute && group.stream().to_string() == "cfg (test)" {
                        is_test = true;
                    } else if is_test && group.delimiter() == Delimiter::Brace {
                        is_test = false;
                    } else if !attribute {
                        self.read(group.stream(), module, to);
                    }
                    at += 1;
                }
                TokenTree::Punct(punct) => {
                    if punct.as_char() == ';' {
                        (is_test, is_public) = (false, false);
                    }
                    at += 1;
                }
                TokenTree::Ident(ident) if *ident == "pub" => {
                    is_public = true;
                    at += 1;
                }
                TokenTree::Ident(ident) if *ident == "mod" && !is_test => {
                    let inside = tokens.get(at + 1).map(ToString::to_string);
                    if let (Some(name), Some(TokenTree::Group(group))) =
                        (inside, tokens.get(at + 2))
                    {
                        let module: Vec<String> = module.iter().cloned().chain([name]).collect();
                        self.read(group.stream(), &module, to);
                        at += 3;
                    } else {
                        at += 1;
                    }
                }
                TokenTree::Ident(ident) if *ident == "use" && !is_test => {
                    let end = (at..tokens.len())
                        .find(|k| is_punct(tokens.get(*k), ';'))
                        .unwrap_or(tokens.len());
                    let mut leaves = Vec::new();
                    tree(&tokens[at + 1..end], &mut Vec::new(), &mut leaves);
                    for (path, name) in leaves {
                        let path = self.absolute(&path, module);
                        // A module that only shows an item of another does not need it.
                        if is_public {
                            to.exports.insert(name, path);
                        } else {
                            to.paths.extend(path);
                        }
                    }
                    at = end;
                }
                TokenTree::Ident(_) => {
                    let (path, next) = path_at(&tokens, at);
                    if !is_test
                        && path.len() > 1
                        && let Some(path) = self.absolute(&path, module)
                    {
                        to.paths.insert(path);
                    }
                    at = next;
                }
                TokenTree::Literal(_) => at += 1,
            }
        }
    }

    /// The absolute path, where it leads to a module of the crate.
    fn absolute(&self, path: &[String], module: &[String]) -> Option<Vec<String>> {
        let first = path.first()?;
        let rest = path[1..].to_vec();
        match first.as_str() {
            "crate" => Some(rest),
            "self" => Some([module.to_vec(), rest].concat()),
            "super" => {
                let parent = &module[..module.len().checked_sub(1)?];
                let mut path = vec!["self".to_owned()];
                path.extend(rest);
                self.absolute(&path, parent).map(|path| {
                    let supers = path.iter().filter(|s| *s == "super").count();
                    if supers == 0 {
                        return path;
                    }
                    let kept = parent.len().saturating_sub(supers);
                    [parent[..kept].to_vec(), path[parent.len() + supers..].to_vec()].concat()
                })
            }
            child => {
                let child: Module = self.file.iter().cloned().chain([child.to_owned()]).collect();
                self.modules.contains(&child).then(|| [child, rest].concat())
            }
        }
    }
}

/// The path that begins at a token, and the index behind it.
fn path_at(tokens: &[TokenTree], mut at: usize) -> (Vec<String>, usize) {
    let mut path = Vec::new();
    while let Some(TokenTree::Ident(ident)) = tokens.get(at) {
        path.push(ident.to_string());
        at += 1;
        if !(is_punct(tokens.get(at), ':') && is_punct(tokens.get(at + 1), ':')) {
            break;
        }
        at += 2;
    }
    (path, at)
}

/// The leaves of a `use` tree: the path of each, and the name that it gets.
fn tree(tokens: &[TokenTree], prefix: &mut Vec<String>, leaves: &mut Vec<(Vec<String>, String)>) {
    let (path, at) = path_at(tokens, 0);
    prefix.extend(path.iter().cloned());
    match tokens.get(at) {
        Some(TokenTree::Group(group)) => {
            let inside: Vec<TokenTree> = group.stream().into_iter().collect();
            for part in inside.split(|token| is_punct(Some(token), ',')) {
                if !part.is_empty() {
                    tree(part, prefix, leaves);
                }
            }
        }
        Some(TokenTree::Punct(star)) if star.as_char() == '*' => {
            leaves.push((prefix.clone(), "*".to_owned()));
        }
        _ => {
            // The name behind `as`, or the last name of the path.
            let renamed = path.len() + 1 < tokens.len() && at >= 1;
            let name = match tokens.last() {
                Some(TokenTree::Ident(last)) if renamed => last.to_string(),
                _ => prefix.last().cloned().unwrap_or_default(),
            };
            leaves.push((prefix.clone(), name));
        }
    }
    prefix.truncate(prefix.len() - path.len());
}

fn is_punct(token: Option<&TokenTree>, wanted: char) -> bool {
    matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == wanted)
}

#[cfg(test)]
mod tests;
