//! Data goes one way: which crate may depend on which.

use crate::workspace::Package;

/// What a crate may use of this workspace.
enum May {
    /// These and nothing else.
    Use(&'static [&'static str]),
    /// Every crate above it in the table.
    UseAllAbove,
    /// Anything.
    UseAnything,
}

/// The crates in the order in which data flows; each may use only crates above it.
const TABLE: &[(&str, May)] = &[
    ("core", May::Use(&[])),
    ("neighbor", May::Use(&["core"])),
    ("forcefield", May::Use(&["core", "neighbor"])),
    ("integrators", May::Use(&["core", "neighbor", "forcefield"])),
    ("observables", May::Use(&["core", "neighbor"])),
    ("literature", May::Use(&["core", "observables"])),
    ("io", May::Use(&["core", "observables"])),
    ("scene", May::Use(&["core", "forcefield", "integrators", "observables", "literature", "io"])),
    ("engine", May::UseAllAbove),
    ("studies", May::UseAllAbove),
    (LIBRARY, May::UseAllAbove),
    ("python", May::UseAllAbove),
    ("xtask", May::Use(&[])),
    ("benches", May::UseAnything),
    ("fuzz", May::UseAnything),
];

const PREFIX: &str = "lennard-";
/// The crate that others depend on: it has the name of the program.
const LIBRARY: &str = "lennard";

/// Every dependency that the table does not allow.
pub fn faults(packages: &[Package]) -> Vec<String> {
    let place = |name: &str| TABLE.iter().position(|(n, _)| *n == name);
    let short = |name: &str| name.strip_prefix(PREFIX).unwrap_or(name).to_owned();
    let mut faults = Vec::new();
    for package in packages {
        let name = short(&package.name);
        if name == package.name && name != LIBRARY {
            faults.push(format!("{name} is not called {PREFIX}<folder>"));
        }
        let Some(own) = place(&name) else {
            faults.push(format!("{name} has no place in the table of layers"));
            continue;
        };
        for needed in package.needs.iter().map(|n| short(n)) {
            let allowed = match TABLE[own].1 {
                May::Use(list) => list.contains(&needed.as_str()),
                May::UseAllAbove => place(&needed).is_some_and(|p| p < own),
                May::UseAnything => true,
            };
            if !allowed {
                faults.push(format!("{name} must not depend on {needed}"));
            }
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::Workspace;

    fn package(name: &str, needs: &[&str]) -> Package {
        Package {
            name: format!("{PREFIX}{name}"),
            needs: needs.iter().map(|n| format!("{PREFIX}{n}")).collect(),
            test_binaries: Vec::new(),
        }
    }

    #[test]
    fn crates_of_this_workspace_depend_as_designed() {
        let workspace = Workspace::find().unwrap();
        assert!(workspace.packages.len() >= TABLE.len());
        assert_eq!(faults(&workspace.packages), Vec::<String>::new());
    }

    #[test]
    fn no_crate_may_look_upwards_or_aside() {
        for (name, needed) in [
            ("integrators", "observables"),
            ("forcefield", "integrators"),
            ("core", "io"),
            ("engine", "studies"),
            ("scene", "engine"),
            ("observables", "forcefield"),
            ("xtask", "core"),
        ] {
            assert_eq!(
                faults(&[package(name, &[needed])]),
                [format!("{name} must not depend on {needed}")]
            );
        }
        assert!(faults(&[package("engine", &["scene", "literature"])]).is_empty());
        assert!(faults(&[package("benches", &["lennard"])]).is_empty());
    }

    #[test]
    fn a_crate_without_a_place_or_without_the_prefix_is_told() {
        assert_eq!(faults(&[package("extras", &[])]).len(), 1);
        let named = |name: &str| Package { name: name.to_owned(), ..package("io", &["core"]) };
        assert_eq!(faults(&[named("io")]).len(), 1);
        assert!(faults(&[named(LIBRARY)]).is_empty());
    }
}
