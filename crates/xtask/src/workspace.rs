//! The workspace as cargo describes it.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use serde_json::Value;

/// A package of the workspace and the packages of the workspace that it needs to be built.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Package {
    /// Its name.
    pub name: String,
    /// Normal and build dependencies that are packages of this workspace; tests may use more.
    pub needs: Vec<String>,
    /// Names of its test binaries, without the one of the library.
    pub test_binaries: Vec<String>,
}

/// Where things are.
#[derive(Debug)]
pub struct Workspace {
    /// The folder of the workspace's Cargo.toml.
    pub root: PathBuf,
    /// Where cargo puts what it builds.
    pub target: PathBuf,
    /// All packages.
    pub packages: Vec<Package>,
    /// The program that is looked at.
    binary: PathBuf,
    /// Names of the packages that lints and tests look at; empty for all.
    selection: Vec<String>,
}

impl Workspace {
    /// The files that git tracks or would add, of the patterns or all, relative to the root.
    ///
    /// # Errors
    /// Where git cannot be started or refuses.
    pub fn tracked(&self, patterns: &[&str]) -> Result<Vec<String>, Box<dyn Error>> {
        let list = ["ls-files", "-z", "--cached", "--others", "--exclude-standard", "--"];
        let output = self
            .command("git")
            .args(list)
            .args(patterns)
            .output()
            .map_err(|e| format!("git cannot be started: {e}"))?;
        if !output.status.success() {
            return Err(format!(
                "git cannot list the files: {}",
                String::from_utf8_lossy(&output.stderr).trim()
            )
            .into());
        }
        let names = String::from_utf8(output.stdout)?;
        Ok(names.split_terminator('\0').map(str::to_owned).collect())
    }

    /// Asks cargo.
    pub fn find() -> Result<Self, Box<dyn Error>> {
        let output = Command::new(cargo())
            .args(["metadata", "--no-deps", "--format-version", "1"])
            .output()
            .map_err(|e| format!("cargo cannot be started: {e}"))?;
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into());
        }
        Self::from_metadata(&serde_json::from_slice(&output.stdout)?)
    }

    /// The workspace of what `cargo metadata` prints.
    ///
    /// # Errors
    /// Names what the metadata lack.
    pub fn from_metadata(metadata: &Value) -> Result<Self, Box<dyn Error>> {
        let text = |value: &Value, key: &str| {
            value[key]
                .as_str()
                .map(str::to_owned)
                .ok_or_else(|| format!("cargo metadata names no `{key}`"))
        };
        let list = |value: &Value, key: &str| {
            value[key].as_array().cloned().ok_or_else(|| format!("cargo metadata lists no `{key}`"))
        };
        let described = list(metadata, "packages")?;
        let names = described.iter().map(|p| text(p, "name")).collect::<Result<Vec<_>, _>>()?;
        let mut packages = Vec::new();
        for (package, name) in described.iter().zip(&names) {
            let mut needs = Vec::new();
            for dependency in list(package, "dependencies")? {
                let needed = text(&dependency, "name")?;
                if dependency["kind"].as_str() != Some("dev") && names.contains(&needed) {
                    needs.push(needed);
                }
            }
            let mut test_binaries = Vec::new();
            for target in list(package, "targets")? {
                if list(&target, "kind")?.contains(&"test".into()) {
                    test_binaries.push(text(&target, "name")?);
                }
            }
            packages.push(Package { name: name.clone(), needs, test_binaries });
        }
        let target: PathBuf = text(metadata, "target_directory")?.into();
        Ok(Self {
            root: text(metadata, "workspace_root")?.into(),
            binary: program_in(&target, "release"),
            target,
            packages,
            selection: Vec::new(),
        })
    }

    /// The same, with lints and tests of these crates alone, named with or without prefix.
    ///
    /// # Errors
    /// Where no crate is named, or a name is no crate; the message lists the crates.
    pub fn with_crates(self, names: &[&str]) -> Result<Self, String> {
        let known = || -> String {
            let short = self.packages.iter().map(|p| short_name(&p.name));
            format!("the crates are {}", short.collect::<Vec<_>>().join(", "))
        };
        if names.is_empty() {
            return Err(format!("a crate is missing: {}", known()));
        }
        let mut selection = Vec::new();
        for name in names {
            let is_named = |p: &&Package| p.name == *name || short_name(&p.name) == *name;
            let package = self.packages.iter().find(is_named);
            let package = package.ok_or_else(|| format!("no crate `{name}`: {}", known()))?;
            selection.push(package.name.clone());
        }
        Ok(Self { selection, ..self })
    }

    /// How cargo is told which packages lints and tests look at.
    #[must_use]
    pub fn package_arguments(&self) -> Vec<&str> {
        if self.selection.is_empty() {
            return vec!["--workspace"];
        }
        let named = self.selection.iter();
        named.flat_map(|name| ["--package", name]).collect()
    }

    /// The same, looking at the binary that `cargo test` has built: optimised too, with assertions, and already there.
    #[must_use]
    pub fn with_tested_binary(self) -> Self {
        let binary = program_in(&self.target, "debug");
        self.with_binary(binary)
    }

    /// The workspace with another build of the program.
    #[must_use]
    pub fn with_binary(self, binary: PathBuf) -> Self {
        Self { binary, ..self }
    }

    /// The binary that checks look at: the release one, unless [`Self::with_tested_binary`].
    #[must_use]
    pub fn binary(&self) -> PathBuf {
        self.binary.clone()
    }

    /// A command that runs in the root of the workspace.
    pub fn command(&self, program: impl AsRef<Path>) -> Command {
        let mut command = Command::new(program.as_ref());
        command.current_dir(&self.root);
        command
    }

    /// Builds a program of the workspace, optimised, and runs it: `target` names it to `cargo run`, and `arguments`
    /// are its own. Its exit code is ours.
    pub fn run_optimised(&self, target: &[&str], arguments: &[&str]) -> ExitCode {
        let mut command = self.command(cargo());
        command.args(["run", "--quiet", "--release"]);
        command.args(target).arg("--").args(arguments);
        match command.status() {
            Ok(status) => ExitCode::from(u8::try_from(status.code().unwrap_or(1)).unwrap_or(1)),
            Err(error) => {
                eprintln!("cargo cannot be started: {error}");
                ExitCode::FAILURE
            }
        }
    }
}

/// The program in a folder of builds.
fn program_in(target: &Path, folder: &str) -> PathBuf {
    target.join(folder).join(format!("lennard{}", std::env::consts::EXE_SUFFIX))
}

/// The name of a package without the prefix of this workspace.
fn short_name(package: &str) -> &str {
    package.strip_prefix("lennard-").unwrap_or(package)
}

/// The cargo that runs us.
#[must_use]
pub fn cargo() -> String {
    std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dependencies_of_tests_do_not_count_as_needs_and_test_binaries_are_named() {
        let metadata = serde_json::json!({
            "workspace_root": "root", "target_directory": "target",
            "packages": [
                {"name": "a", "targets": [{"name": "a", "kind": ["lib"]}, {"name": "all", "kind": ["test"]}], "dependencies": [
                    {"name": "b", "kind": null}, {"name": "c", "kind": "dev"}, {"name": "serde", "kind": null}]},
                {"name": "b", "targets": [], "dependencies": []},
                {"name": "c", "targets": [], "dependencies": []},
            ]
        });
        let workspace = Workspace::from_metadata(&metadata).unwrap();
        assert_eq!(workspace.packages[0].needs, ["b"]);
        assert_eq!(workspace.packages[0].test_binaries, ["all"]);
    }

    #[test]
    fn crates_are_selected_by_name_and_messages_list_them() {
        let workspace = || {
            let metadata = serde_json::json!({
                "workspace_root": "root", "target_directory": "target",
                "packages": [
                    {"name": "lennard-core", "targets": [], "dependencies": []},
                    {"name": "xtask", "targets": [], "dependencies": []},
                ]
            });
            Workspace::from_metadata(&metadata).unwrap()
        };
        assert_eq!(workspace().package_arguments(), ["--workspace"]);
        let both = workspace().with_crates(&["core", "xtask"]).unwrap();
        assert_eq!(both.package_arguments(), ["--package", "lennard-core", "--package", "xtask"]);
        assert!(workspace().with_crates(&["lennard-core"]).is_ok());
        assert_eq!(
            workspace().with_crates(&[]).unwrap_err(),
            "a crate is missing: the crates are core, xtask"
        );
        assert_eq!(
            workspace().with_crates(&["cor"]).unwrap_err(),
            "no crate `cor`: the crates are core, xtask"
        );
    }
}
