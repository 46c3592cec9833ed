//! Virtual environments of the Python checks and of the book, and the package `lennard` in the first.

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use crate::workspace::{Workspace, cargo};

const OLDEST: (u32, u32) = (3, 11);
/// Inside the environment: what it was made from, so that it is made anew when that changes.
const STAMP: &str = "made-from.txt";

/// A virtual environment.
pub struct Environment {
    /// Its folder.
    pub folder: PathBuf,
    /// The file that pins what is in it, in the repository.
    pub requirements: &'static str,
}

impl Environment {
    /// The environment of the validation.
    pub fn validation(workspace: &Workspace) -> Self {
        Self { folder: workspace.root.join(".venv"), requirements: "validation/requirements.txt" }
    }

    /// A program in it, such as `python`.
    pub fn program(&self, name: &str) -> PathBuf {
        let programs = if cfg!(windows) { "Scripts" } else { "bin" };
        let file = format!("{name}{}", std::env::consts::EXE_SUFFIX);
        self.folder.join(programs).join(file)
    }

    /// Makes it from the pinned requirements, or leaves it as it is where nothing changed.
    pub fn prepare(&self, workspace: &Workspace) -> Result<(), Box<dyn Error>> {
        let (system, version) = find(workspace)?;
        let pinned = self.requirements;
        let requirements = fs::read_to_string(workspace.root.join(pinned))
            .map_err(|e| format!("{pinned}: {e}"))?;
        let made_from = format!("Python {}.{}\n{requirements}", version.0, version.1);
        let shown = self.folder.strip_prefix(&workspace.root);
        let shown = shown.unwrap_or(&self.folder).display();
        let stamp = self.folder.join(STAMP);
        let python = self.program("python");
        if python.exists() && fs::read_to_string(&stamp).is_ok_and(|s| s == made_from) {
            println!("{shown} is up to date");
            return Ok(());
        }
        println!("making {shown} with Python {}.{} from {pinned}", version.0, version.1);
        let status = workspace
            .command(&system)
            .args(["-m", "venv", "--clear"])
            .arg(&self.folder)
            .status()?;
        if !status.success() {
            return Err(format!(
                "`{} -m venv` failed: Python's venv module is missing or broken (on Debian and Ubuntu: apt install python3-venv)",
                system.display()
            )
            .into());
        }
        let pip = |arguments: &[&str]| -> Result<(), Box<dyn Error>> {
            let status = workspace
                .command(&python)
                .args(["-m", "pip", "--disable-pip-version-check", "--quiet"])
                .args(arguments)
                .status()?;
            if status.success() {
                Ok(())
            } else {
                Err(format!("`pip {}` failed", arguments.join(" ")).into())
            }
        };
        // Nothing but what the file pins; `check` then tells if a pin is missing.
        pip(&["install", "--no-deps", "--requirement", pinned])?;
        pip(&["check"])?;
        fs::write(&stamp, made_from)?;
        Ok(())
    }
}

/// Builds the wheel of the package and installs it into `.venv`, as a user would install one.
///
/// The profile is the one of the tests: nothing but the extension itself is compiled for it.
pub fn install_package(workspace: &Workspace) -> Result<(), Box<dyn Error>> {
    let python = Environment::validation(workspace).program("python");
    let folder = workspace.target.join("wheels");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let run = |arguments: &[&str], paths: &[&PathBuf]| -> Result<(), Box<dyn Error>> {
        let status = workspace
            .command(&python)
            .args(arguments)
            .args(paths)
            .env("CARGO", cargo())
            .status()?;
        if status.success() {
            Ok(())
        } else {
            Err(format!("`python {}` failed", arguments.join(" ")).into())
        }
    };
    let build = ["-m", "maturin", "build", "--quiet", "--profile", "dev", "--out"];
    run(&build, &[&folder])?;
    let wheels = fs::read_dir(&folder)?.collect::<Result<Vec<_>, _>>()?;
    let paths: Vec<PathBuf> = wheels.iter().map(fs::DirEntry::path).collect();
    let [wheel] = paths.as_slice() else {
        return Err(format!("maturin made {} wheels, wanted 1", paths.len()).into());
    };
    let install = [
        "-m",
        "pip",
        "--disable-pip-version-check",
        "--quiet",
        "install",
        "--no-deps",
        "--no-index",
        "--force-reinstall",
    ];
    run(&install, &[wheel])
}

/// A Python that is new enough, with its version.
fn find(workspace: &Workspace) -> Result<(PathBuf, (u32, u32)), Box<dyn Error>> {
    let mut too_old = None;
    for name in ["python3", "python"] {
        let asked = workspace
            .command(name)
            .args(["-c", "import sys; print(*sys.version_info[:2])"])
            .output();
        let Ok(output) = asked else { continue };
        if let Some(version) = version(&String::from_utf8_lossy(&output.stdout)) {
            if version >= OLDEST {
                return Ok((name.into(), version));
            }
            too_old = Some((name, version));
        }
    }
    let wanted = format!("Python {}.{} or newer is needed", OLDEST.0, OLDEST.1);
    Err(match too_old {
        Some((name, (major, minor))) => {
            format!("{wanted}, and `{name}` is {major}.{minor}")
        }
        None => format!("{wanted}, and there is neither `python3` nor `python`"),
    }
    .into())
}

fn version(printed: &str) -> Option<(u32, u32)> {
    let mut numbers = printed.split_whitespace().map(str::parse);
    Some((numbers.next()?.ok()?, numbers.next()?.ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_compared_as_numbers() {
        assert_eq!(version("3 9\n"), Some((3, 9)));
        assert!(version("3 9").unwrap() < OLDEST);
        assert!(version("3 11").unwrap() >= OLDEST);
        assert!(version("3 14").unwrap() >= OLDEST);
        assert_eq!(version(""), None);
    }
}
