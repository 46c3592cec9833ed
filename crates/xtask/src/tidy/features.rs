//! One set of features for each library, whichever packages are chosen.

use std::collections::BTreeSet;
use std::error::Error;
use std::process::Command;

use crate::workspace::{Workspace, cargo};

/// Every library that one package, built alone, would compile a second time.
pub fn faults(workspace: &Workspace) -> Result<Vec<String>, Box<dyn Error>> {
    let all = libraries(workspace, &["--workspace", "--edges", "normal,build,dev"])?;
    let mut faults = Vec::new();
    for package in &workspace.packages {
        for edges in ["normal,build", "normal,build,dev"] {
            let alone = libraries(workspace, &["--package", &package.name, "--edges", edges])?;
            // What stands below core compiles within seconds.
            if !alone.iter().any(|library| library.starts_with("lennard-core ")) {
                continue;
            }
            faults.extend(compiled_twice(&package.name, &alone, &all));
        }
    }
    faults.sort();
    faults.dedup();
    Ok(faults)
}

fn compiled_twice(package: &str, alone: &BTreeSet<String>, all: &BTreeSet<String>) -> Vec<String> {
    alone
        .difference(all)
        .map(|library| {
            format!("{package} alone asks for {library}: add the missing features to crates/core/Cargo.toml")
        })
        .collect()
}

/// Each library of a choice of packages: name, version and features.
fn libraries(workspace: &Workspace, choice: &[&str]) -> Result<BTreeSet<String>, Box<dyn Error>> {
    let mut command: Command = workspace.command(cargo());
    command.args(["tree", "--prefix", "none", "--format", "{p} with {f}"]);
    let output = command.args(choice).output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    Ok(parsed(&String::from_utf8(output.stdout)?))
}

fn parsed(tree: &str) -> BTreeSet<String> {
    let lines = tree.lines().filter(|line| !line.is_empty());
    let plain = lines.map(|line| line.replace(" (*)", "").replace(" (proc-macro)", ""));
    plain.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_with_fewer_features_is_found() {
        let all = parsed("a v1.0.0 with std\nb v2.0.0 (proc-macro) with alloc,std (*)\n");
        assert_eq!(
            compiled_twice("p", &parsed("b v2.0.0 with alloc,std"), &all),
            Vec::<String>::new()
        );
        let found = compiled_twice("p", &parsed("a v1.0.0 with "), &all);
        assert!(found[0].starts_with("p alone asks for a v1.0.0 with :"), "{found:?}");
    }
}
