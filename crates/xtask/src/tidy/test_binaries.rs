//! One test binary per crate: each binary is linked, and compiles the shared helpers, on its own.

use crate::workspace::Package;

/// The one test binary of a crate: its files are modules of `tests/all/main.rs`.
const NAME: &str = "all";

/// Every test binary with another name.
pub fn faults(packages: &[Package]) -> Vec<String> {
    let binaries = packages
        .iter()
        .flat_map(|package| package.test_binaries.iter().map(|name| (&package.name, name)));
    binaries
        .filter(|(_, name)| *name != NAME)
        .map(|(package, name)| {
            format!(
                "{package}: the test binary `{name}` must become a module of tests/{NAME}/main.rs"
            )
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_binary_is_found() {
        let package = |names: &[&str]| Package {
            name: "lennard-io".to_owned(),
            needs: Vec::new(),
            test_binaries: names.iter().map(|name| (*name).to_owned()).collect(),
        };
        assert_eq!(faults(&[package(&["all"]), package(&[])]), Vec::<String>::new());
        assert_eq!(faults(&[package(&["all", "csv"])]).len(), 1);
    }
}
